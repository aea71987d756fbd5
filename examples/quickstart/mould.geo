// Quickstart mould: a cylinder of phosphate-bonded investment with a cup, one sprue, a disc and five pins below it.
// Lengths in mm. z = 0 is the mould's foot; melt flows along -z.
SetFactory("OpenCASCADE");

radius = 13; height = 26;       // mould
cup = 9; cup_floor = 22;        // square cup, open at the top
sprue_r = 2.2;                  // sprue from the cup down to the disc
disc_r = 4.2; disc_low = 13; disc_high = 14.4;
pin_r = 0.55; pin_low = 8.5;    // five pins, 1.1 mm across, 4.5 mm long

Cylinder(1) = {0, 0, 0, 0, 0, height, radius};
Box(2) = {-cup / 2, -cup / 2, cup_floor, cup, cup, height - cup_floor + 1};
Cylinder(3) = {0, 0, disc_low + 0.5, 0, 0, cup_floor - disc_low, sprue_r};
Cylinder(4) = {0, 0, disc_low, 0, 0, disc_high - disc_low, disc_r};
Cylinder(5) = {0, 0, pin_low, 0, 0, disc_low - pin_low + 0.5, pin_r};
For i In {0:3}
  Cylinder(6 + i) = {3.2 * Cos(i * Pi / 2), 3.2 * Sin(i * Pi / 2), pin_low, 0, 0, disc_low - pin_low + 0.5, pin_r};
EndFor
mould() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2:9}; Delete; };
Physical Volume("investment") = {mould()};

e = 1e-3;
walls() = Abs(Boundary{ Volume{mould()}; });
foot() = Surface In BoundingBox {-radius - e, -radius - e, -e, radius + e, radius + e, e};
rim() = Surface In BoundingBox {-radius - e, -radius - e, height - e, radius + e, radius + e, height + e};
inner() = Surface In BoundingBox {-radius + 1, -radius + 1, e, radius - 1, radius - 1, height + e};
side() = walls(); side() -= inner(); side() -= foot(); side() -= rim();
cup_walls() = Surface In BoundingBox {-cup / 2 - e, -cup / 2 - e, cup_floor - e, cup / 2 + e, cup / 2 + e, height + e};
sprue() = Surface In BoundingBox {-sprue_r - e, -sprue_r - e, disc_high - e, sprue_r + e, sprue_r + e, cup_floor + e};
disc() = Surface In BoundingBox {-disc_r - e, -disc_r - e, disc_low - e, disc_r + e, disc_r + e, disc_high + e};
pins() = Surface In BoundingBox {-disc_r, -disc_r, pin_low - e, disc_r, disc_r, disc_low + e};
pins() -= disc();
Physical Surface("cup") = {cup_walls()};
Physical Surface("sprue") = {sprue()};
Physical Surface("disc") = {disc()};
Physical Surface("pins") = {pins()};
Physical Surface("foot") = {foot()};
Physical Surface("rim") = {rim()};
Physical Surface("side") = {side()};
