// Micro casting: a block of phosphate-bonded investment with a small feeder over two square pins of 0.2 mm.
// Lengths in mm. z = 0 is the block's foot; melt flows along -z.
SetFactory("OpenCASCADE");

width = 6; depth = 4; height = 18.2;
feeder = 0.8; feeder_floor = 16;                 // square, open at the top
pin = 0.2; pin_x = 0.2; long = 14; short = 3;     // side of a pin, its place beside the middle, lengths

Box(1) = {-width / 2, -depth / 2, 0, width, depth, height};
Box(2) = {-feeder / 2, -feeder / 2, feeder_floor, feeder, feeder, height - feeder_floor + 1};
Box(3) = {-pin_x - pin / 2, -pin / 2, feeder_floor - long, pin, pin, long + 0.1};
Box(4) = {pin_x - pin / 2, -pin / 2, feeder_floor - short, pin, pin, short + 0.1};
mould() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2:4}; Delete; };
Physical Volume("investment") = {mould()};

e = 1e-3;
walls() = Abs(Boundary{ Volume{mould()}; });
foot() = Surface In BoundingBox {-width, -depth, -e, width, depth, e};
rim() = Surface In BoundingBox {-width, -depth, height - e, width, depth, height + e};
inner() = Surface In BoundingBox {-width / 2 + 1, -depth / 2 + 1, e, width / 2 - 1, depth / 2 - 1, height + e};
side() = walls(); side() -= inner(); side() -= foot(); side() -= rim();
long_pin() = Surface In BoundingBox {-pin_x - pin / 2 - e, -pin, 0, -pin_x + pin / 2 + e, pin, feeder_floor + e};
short_pin() = Surface In BoundingBox {pin_x - pin / 2 - e, -pin, 0, pin_x + pin / 2 + e, pin, feeder_floor + e};
feeder_walls() = Surface In BoundingBox {-feeder / 2 - e, -feeder / 2 - e, feeder_floor - e, feeder / 2 + e, feeder / 2 + e, height + e};
Physical Surface("feeder") = {feeder_walls()};
Physical Surface("long pin") = {long_pin()};
Physical Surface("short pin") = {short_pin()};
Physical Surface("foot") = {foot()};
Physical Surface("rim") = {rim()};
Physical Surface("side") = {side()};
