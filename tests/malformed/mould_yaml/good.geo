// A block with a square cup; the inputs beside it spoil something else.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 4, 4, 4};
Box(2) = {1, 1, 2, 2, 2, 3};
body() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; };
e = 1e-3;
foot() = Surface In BoundingBox{-e, -e, -e, 4 + e, 4 + e, e};
cup() = Surface In BoundingBox{1 - e, 1 - e, 2 - e, 3 + e, 3 + e, 4 + e};
hull() = Surface{:};
hull() -= cup();
hull() -= foot();
Physical Volume("body") = {body()};
Physical Surface("foot") = {foot()};
Physical Surface("cup") = {cup()};
Physical Surface("hull") = {hull()};
