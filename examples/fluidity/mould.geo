// Fluidity test against gravity: a steel die with a cup, from whose foot a blind channel of 1 x 1 mm leads aside and up.
// Lengths in mm. z = 0 is the die's foot.
SetFactory("OpenCASCADE");

left = -9; right = 5; depth = 10; height = 32;
cup_x = 5; cup_y = 4; cup_floor = 4;                     // open at the top, from x = -cup_x - 1 to -1
channel = 1; channel_end = 28;                           // upright part from x = 0 to 1

Box(1) = {left, -depth / 2, 0, right - left, depth, height};
Box(2) = {-cup_x - 1, -cup_y / 2, cup_floor, cup_x, cup_y, height - cup_floor + 1};
Box(3) = {-1.1, -channel / 2, cup_floor, 1.1 + channel, channel, channel};
Box(4) = {0, -channel / 2, cup_floor, channel, channel, channel_end - cup_floor};
mould() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2:4}; Delete; };
Physical Volume("die") = {mould()};

e = 1e-3;
walls() = Abs(Boundary{ Volume{mould()}; });
foot() = Surface In BoundingBox {left - e, -depth, -e, right + e, depth, e};
rim() = Surface In BoundingBox {left - e, -depth, height - e, right + e, depth, height + e};
inner() = Surface In BoundingBox {left + 1, -depth / 2 + 1, e, right - 1, depth / 2 - 1, height + e};
side() = walls(); side() -= inner(); side() -= foot(); side() -= rim();
cup_walls() = Surface In BoundingBox {-cup_x - 1 - e, -cup_y / 2 - e, cup_floor - e, -1 + e, cup_y / 2 + e, height + e};
channel_walls() = inner(); channel_walls() -= cup_walls(); channel_walls() -= rim();
Physical Surface("cup") = {cup_walls()};
Physical Surface("channel") = {channel_walls()};
Physical Surface("foot") = {foot()};
Physical Surface("rim") = {rim()};
Physical Surface("side") = {side()};
