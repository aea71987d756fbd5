// A cavity of 60 x 20 x 20 mm in a block of investment, 100 x 60 x 60 mm: nothing but size and number of patches varies.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 100, 60, 60};
Box(2) = {20, 20, 20, 60, 20, 20};
mould() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("investment") = {mould()};
e = 1e-3;
walls() = Abs(Boundary{ Volume{mould()}; });
cavity() = Surface In BoundingBox {20 - e, 20 - e, 20 - e, 80 + e, 40 + e, 40 + e};
outside() = walls(); outside() -= cavity();
Physical Surface("cavity") = {cavity()};
Physical Surface("outside") = {outside()};
