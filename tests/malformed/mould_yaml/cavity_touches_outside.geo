// The cup, turned by 45 degrees, has an edge of its own on the outside.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 4, 4, 4};
Box(2) = {1, 1, 1, 1.4142135623730951, 1.4142135623730951, 2};
Rotate {{0, 0, 1}, {1, 1, 1}, Pi/4} { Volume{2}; }
Translate {1, 0, 0} { Volume{2}; }
Translate {1.0, 0, 0} { Volume{2}; }
body() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; };
e = 1e-3;
Physical Volume("body") = {body()};
foot() = Surface In BoundingBox{-e, -e, -e, 4 + e, 4 + e, e};
cup() = Surface In BoundingBox{2 - e, 1-e, 1 - e, 4 + e, 3 + e, 3 + e};
hull() = Surface{:}; hull() -= cup(); hull() -= foot();
Physical Surface("foot") = {foot()};
Physical Surface("cup") = {cup()};
Physical Surface("hull") = {hull()};
