// Ring tree in a flask of phosphate-bonded investment, for a centrifuge with an upright axis. Lengths in mm.
// x points away from the axis; melt comes from x = 0. Three rings stand round a stem, each fed by one gate.
SetFactory("OpenCASCADE");

radius = 20; length = 38;                    // flask
cup_r = 6; cup_depth = 8;                    // open towards the axis
stem_r = 2; stem_end = 31;
ring_x = 24; ring_off = 9.5;                 // middle of a ring: along the flask, and off the stem's axis
ring_r = 5.8; wire_r = 0.9;                  // 11.6 mm across the middle of a wire of 1.8 mm

Cylinder(1) = {0, 0, 0, length, 0, 0, radius};
Cylinder(2) = {-1, 0, 0, cup_depth + 1, 0, 0, cup_r};
Cylinder(3) = {cup_depth - 0.5, 0, 0, stem_end - cup_depth + 0.5, 0, 0, stem_r};
For i In {0:2}
  ring = 10 + i; gate = 20 + i;
  Torus(ring) = {0, 0, 0, ring_r, wire_r};
  Rotate {{1, 0, 0}, {0, 0, 0}, Pi / 2} { Volume{ring}; }
  Translate {ring_x, 0, ring_off} { Volume{ring}; }
  Cylinder(gate) = {ring_x, 0, 0, 0, 0, ring_off - ring_r, wire_r};
  Rotate {{1, 0, 0}, {0, 0, 0}, 2 * i * Pi / 3} { Volume{ring, gate}; }
EndFor
mould() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2, 3, 10:12, 20:22}; Delete; };
Physical Volume("investment") = {mould()};

e = 1e-3;
walls() = Abs(Boundary{ Volume{mould()}; });
rim() = Surface In BoundingBox {-e, -radius - e, -radius - e, e, radius + e, radius + e};
foot() = Surface In BoundingBox {length - e, -radius - e, -radius - e, length + e, radius + e, radius + e};
inner() = Surface In BoundingBox {-e, -radius + 0.5, -radius + 0.5, length - e, radius - 0.5, radius - 0.5};
side() = walls(); side() -= rim(); side() -= foot(); side() -= inner();
cup() = Surface In BoundingBox {-e, -cup_r - e, -cup_r - e, cup_depth + e, cup_r + e, cup_r + e};
cup() -= rim();
stem() = Surface In BoundingBox {cup_depth - e, -stem_r - e, -stem_r - e, stem_end + e, stem_r + e, stem_r + e};
rings() = inner(); rings() -= cup(); rings() -= stem(); rings() -= rim();
Physical Surface("cup") = {cup()};
Physical Surface("stem") = {stem()};
Physical Surface("rings") = {rings()};
Physical Surface("rim") = {rim()};
Physical Surface("foot") = {foot()};
Physical Surface("side") = {side()};
