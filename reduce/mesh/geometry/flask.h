/* flask.h - the closed surface of a mould: a block or a cylinder of mould material about the body of an STL file. */
#ifndef REDUCE_MESH_GEOMETRY_FLASK_H
#define REDUCE_MESH_GEOMETRY_FLASK_H

#include "reduce/config/config.h"
#include "reduce/mesh/geometry/stl_file.h"
#include "reduce/mesh/surface/surface_remesh.h"

typedef enum FlaskSide { FLASK_TOP, FLASK_BOTTOM, FLASK_SIDE, FLASK_SIDES } FlaskSide;
extern const char *const FLASK_NAMES[FLASK_SIDES]; // "top", "bottom", "side"

typedef struct FlaskSurface {
  RemeshSurface surface; // in the STL file's unit; owned. Tags: a FlaskSide, or FLASK_SIDES + solid
  double volume;         // of mould material
} FlaskSurface;

/* The body must lie within the flask. It may touch the flask's top in triangles that lie in it: there the cavity is
 * open, they are left out and the top has holes. gmsh, which must be open, triangulates top and bottom in a model of
 * its own. Errors: CAST_ERR_INPUT (with the place), CAST_ERR_MEMORY. */
CastStatus flask_create(const FlaskConfig *config, double unit, const StlSurface *body, FlaskSurface **flask,
                        CastError *err);
void flask_destroy(FlaskSurface **flask);

/* The steps. */

typedef struct FlaskOpenings { // loops of the body's points round its openings in the top
  size_t n;
  size_t *start;  // [n + 1] owned: where each begins in point
  int32_t *point; // owned: points of the body, in order
  bool *island;   // [n] owned: encloses a piece of the top
} FlaskOpenings;

/* Which triangles of the body lie in the plane z = top (left_out [n_triangles]), and the loops about them. */
CastStatus flask_find_openings(const StlSurface *body, double top, double unit, bool *left_out, FlaskOpenings *openings,
                               CastError *err);
void flask_free_openings(FlaskOpenings *openings);

/* Plane polygons as triangles, by gmsh: polygon 0 with the others as holes, but for islands, which are pieces of their
 * own. x [n*2] all polygons' points; start [n_polygons + 1]. Points that gmsh adds follow: more [*n_more*2]. Caller
 * frees *triangle [*n_triangles*3] and *more. */
typedef struct FlaskPolygons {
  size_t n_polygons;
  const size_t *start;
  const double *x;
  const bool *island;
} FlaskPolygons;
CastStatus flask_triangulate(const FlaskPolygons *polygons, int32_t **triangle, size_t *n_triangles, double **more,
                             size_t *n_more, CastError *err);

#endif
