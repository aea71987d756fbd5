// Preheat study: a steel die with a pouring cup over one blind strip, 1 mm thick, 3 mm wide, 16 mm long.
// Lengths in mm. z = 0 is the die's foot; melt falls along -z.
SetFactory("OpenCASCADE");

width = 18; depth = 14; height = 24;
cup_x = 6; cup_y = 4; cup_floor = 18;
thin = 1.0; strip_y = 3; strip_low = 2;
thin_at = 0;

Box(1) = {-width / 2, -depth / 2, 0, width, depth, height};
Box(2) = {-cup_x / 2, -cup_y / 2, cup_floor, cup_x, cup_y, height - cup_floor + 1};
Box(3) = {thin_at - thin / 2, -strip_y / 2, strip_low, thin, strip_y, cup_floor - strip_low + 0.5};
mould() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2:3}; Delete; };
Physical Volume("die") = {mould()};

e = 1e-3;
walls() = Abs(Boundary{ Volume{mould()}; });
foot() = Surface In BoundingBox {-width, -depth, -e, width, depth, e};
rim() = Surface In BoundingBox {-width, -depth, height - e, width, depth, height + e};
inner() = Surface In BoundingBox {-width / 2 + 1, -depth / 2 + 1, e, width / 2 - 1, depth / 2 - 1, height + e};
side() = walls(); side() -= inner(); side() -= foot(); side() -= rim();
strip() = Surface In BoundingBox {thin_at - thin / 2 - e, -strip_y, strip_low - e, thin_at + thin / 2 + e, strip_y, cup_floor + e};
cup_walls() = Surface In BoundingBox {-cup_x / 2 - e, -cup_y / 2 - e, cup_floor - e, cup_x / 2 + e, cup_y / 2 + e, height + e};
Physical Surface("cup") = {cup_walls()};
Physical Surface("strip") = {strip()};
Physical Surface("foot") = {foot()};
Physical Surface("rim") = {rim()};
Physical Surface("side") = {side()};
