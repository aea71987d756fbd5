// The demonstration of the founding paper: a cylindrical mould, 47 mm across and 55 mm high. The paper gives these two
// lengths, the 8 mm cube of melt and two sprue channels with micro-structures at the bottom; the rest is ours: a
// pouring basin, channels 3 mm across, a runner, and twelve pins 1 mm across below it.
// Lengths in mm. z = 0 is the mould's foot; gravity along -z.
SetFactory("OpenCASCADE");

radius = 23.5; height = 55;
basin = 10; basin_floor = 44;   // square basin, open at the top
channel_r = 1.5; channel_x = 2.5;
runner_x = 12; runner_y = 4; runner_low = 22; runner_high = 24;
pin_r = 0.5; pin_low = 18;

Cylinder(1) = {0, 0, 0, 0, 0, height, radius};
Box(2) = {-basin / 2, -basin / 2, basin_floor, basin, basin, height - basin_floor + 1};
Cylinder(3) = {-channel_x, 0, runner_high - 0.5, 0, 0, basin_floor - runner_high + 1, channel_r};
Cylinder(4) = {channel_x, 0, runner_high - 0.5, 0, 0, basin_floor - runner_high + 1, channel_r};
Box(5) = {-runner_x / 2, -runner_y / 2, runner_low, runner_x, runner_y, runner_high - runner_low};
For i In {0:5}
  Cylinder(6 + 2 * i) = {-5 + 2 * i, -1, pin_low, 0, 0, runner_low - pin_low + 0.5, pin_r};
  Cylinder(7 + 2 * i) = {-5 + 2 * i, 1, pin_low, 0, 0, runner_low - pin_low + 0.5, pin_r};
EndFor
mould() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2:17}; Delete; };
Physical Volume("mould") = {mould()};

e = 1e-3;
walls() = Abs(Boundary{ Volume{mould()}; });
foot() = Surface In BoundingBox {-radius - e, -radius - e, -e, radius + e, radius + e, e};
rim() = Surface In BoundingBox {-radius - e, -radius - e, height - e, radius + e, radius + e, height + e};
inner() = Surface In BoundingBox {-radius + 1, -radius + 1, e, radius - 1, radius - 1, height + e};
side() = walls(); side() -= inner(); side() -= foot(); side() -= rim();
basin_walls() = Surface In BoundingBox {-basin / 2 - e, -basin / 2 - e, basin_floor - e, basin / 2 + e, basin / 2 + e, height + e};
channels() = Surface In BoundingBox {-channel_x - channel_r - e, -channel_r - e, runner_high - e, channel_x + channel_r + e, channel_r + e, basin_floor + e};
channels() -= basin_walls();
runner() = Surface In BoundingBox {-runner_x / 2 - e, -runner_y / 2 - e, runner_low - e, runner_x / 2 + e, runner_y / 2 + e, runner_high + e};
pins() = Surface In BoundingBox {-runner_x / 2, -runner_y / 2, pin_low - e, runner_x / 2, runner_y / 2, runner_low + e};
pins() -= runner();
Physical Surface("basin") = {basin_walls()};
Physical Surface("channels") = {channels()};
Physical Surface("runner") = {runner()};
Physical Surface("pins") = {pins()};
Physical Surface("foot") = {foot()};
Physical Surface("rim") = {rim()};
Physical Surface("side") = {side()};
