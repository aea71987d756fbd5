// Tank of Martin & Moyce's dam break, a = 57.15 mm: 5 a long, a/2 across, open at the top. Lengths in mm.
SetFactory("OpenCASCADE");

a = 57.15;
long = 5 * a; across = 0.5 * a; high = 2.5 * a; wall = 10;

Box(1) = {-wall, -wall, -wall, long + 2 * wall, across + 2 * wall, high + wall};
Box(2) = {0, 0, 0, long, across, high + 1};
tank() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("tank") = {tank()};

e = 1e-3;
walls() = Abs(Boundary{ Volume{tank()}; });
inner() = Surface In BoundingBox {-e, -e, -e, long + e, across + e, high + e};
outer() = walls(); outer() -= inner();
Physical Surface("inside") = {inner()};
Physical Surface("outside") = {outer()};
