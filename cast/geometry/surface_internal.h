/* surface_internal.h - what the files of the surface share; not for other folders.
 * surface.c      storage, topology, pseudo-normals       surface_grid.c   the search grid
 * surface_query.c nearest point, inside                  surface_cross.c  crossings, what hides what
 * surface_thin.c where the mould is thin                 surface_samples.c points spread over the cavity wall
 * surface_sight.c what one place surely sees */
#ifndef CAST_GEOMETRY_SURFACE_INTERNAL_H
#define CAST_GEOMETRY_SURFACE_INTERNAL_H

#include "cast/geometry/sight.h"
#include "cast/geometry/surface.h"
#include "common/vector.h"

typedef struct Facet {
  double corner[3][3];      // m; the same bits in every triangle that shares the point
  double normal[3];         // unit, out of the mould
  double centre[3], radius; // m, of a sphere that holds it
} Facet;

enum {
  CELL_INSIDE = 1,     // no triangle here, all of it mould
  CELL_OPEN = 2,       // no triangle here, all of it void
  CELL_HOLDS_THIN = 4, // holds a triangle of a thin mould wall
  CELL_NEAR_THIN = 8   // within reach of one
};

typedef struct SearchGrid {
  double low[3], cell, per_cell; // m, m, 1/m
  int32_t n[3];
  int32_t *start; // [cells + 1] into item
  int32_t *item;  // triangles that touch a cell (a hair's breadth around it included)
  uint8_t *flags; // [cells] CELL_*
  uint8_t *steps; // [cells] cells to go (king's moves) to the nearest cell with a triangle, at most 255
} SearchGrid;

struct Surface {
  ptrdiff_t n_points, n_triangles;
  double (*point)[3];         // m
  int32_t (*triangle)[3];     // into point
  Facet *facet;               // [n_triangles]
  double (*edge_normal)[3];   // [3 n_triangles] unit; edge k runs from corner k to corner k + 1
  double (*vertex_normal)[3]; // [n_points] unit, weighted by angle
  int32_t *fan_start, *fan;   // triangles round each point
  int32_t *patch;             // [n_triangles]
  uint8_t *outer;             // [n_triangles] 1: not cavity wall
  uint8_t *thin;              // [n_triangles] 1: another sheet faces away behind it within reach
  bool any_thin;
  double low[3], high[3];               // m
  double cavity_low[3], cavity_high[3]; // m, of the cavity wall alone
  double reach;                         // m
  double tiny;                          // m, a length that rounding may produce
  SearchGrid grid;
};

/* Closest point of one triangle: its squared distance, and on what it lies. */
typedef enum FacetFeature {
  FEATURE_CORNER_0,
  FEATURE_CORNER_1,
  FEATURE_CORNER_2,
  FEATURE_EDGE_0,
  FEATURE_EDGE_1,
  FEATURE_EDGE_2,
  FEATURE_FACE
} FacetFeature;
double facet_closest(const Facet *facet, const double x[3], double foot[3], FacetFeature *feature);

CastStatus surface_grid_create(Surface *surface, CastError *err);
CastStatus surface_grid_classify(Surface *surface, CastError *err); // flags of the cells without triangles
CastStatus surface_thin_mark(Surface *surface, CastError *err);

static inline ptrdiff_t grid_cells(const SearchGrid *grid)
{
  return (ptrdiff_t)grid->n[0] * grid->n[1] * grid->n[2];
}

static inline ptrdiff_t grid_index(const SearchGrid *grid, const int32_t at[3])
{
  return ((ptrdiff_t)at[2] * grid->n[1] + at[1]) * grid->n[0] + at[0];
}

/* floor, kept inside int32 (NaN: the lowest); floor, fmin and fmax of the library are calls. */
static inline int32_t grid_floor(double place)
{
  const double above = place > -1.0e9 ? place : -1.0e9, kept = above < 1.0e9 ? above : 1.0e9;
  const int32_t toward_zero = (int32_t)kept;
  return toward_zero - (kept < toward_zero);
}

/* The cell that holds x, kept inside int32 but not inside the grid. */
static inline void grid_locate(const SearchGrid *grid, const double x[3], int32_t at[3])
{
  for (int k = 0; k < 3; k++) at[k] = grid_floor((x[k] - grid->low[k]) * grid->per_cell);
}

static inline bool grid_holds(const SearchGrid *grid, const int32_t at[3])
{
  return at[0] >= 0 && at[0] < grid->n[0] && at[1] >= 0 && at[1] < grid->n[1] && at[2] >= 0 && at[2] < grid->n[2];
}

/* Cells that the box [low, high] overlaps, cut to the grid; false if none. */
static inline bool grid_range(const SearchGrid *grid, const double low[3], const double high[3], int32_t first[3],
                              int32_t last[3])
{
  grid_locate(grid, low, first);
  grid_locate(grid, high, last);
  for (int k = 0; k < 3; k++) {
    if (first[k] < 0) first[k] = 0;
    if (last[k] > grid->n[k] - 1) last[k] = grid->n[k] - 1;
    if (first[k] > last[k]) return false;
  }
  return true;
}

/* What a search for the nearest point starts from. */
typedef struct NearestQuery {
  double reach;     // m; INFINITY: whatever the distance
  int32_t guess;    // a triangle likely to be near, or -1; makes the search faster, never another answer
  bool cavity_only; // skip the outer faces
  // NULL, or triangles that surface_candidates found for a ball that holds x: no others are looked at
  const int32_t *candidate;
  int n_candidates;
} NearestQuery;
bool surface_nearest_query(const Surface *surface, const double x[3], const NearestQuery *query, SurfaceHit *hit);
/* All triangles that are the nearest one to some point at most `radius` m from `centre`, whose own nearest point is
 * `distance` m away; returns how many, or -1: more than `most`. */
int surface_candidates(const Surface *surface, const double centre[3], double radius, double distance,
                       int32_t *candidate, int most);

/* One passage of a straight line through the surface. */
typedef struct Crossing {
  double t; // along the line, 0 at a and 1 at b
  int32_t triangle;
  bool leaving; // from the mould into the void
} Crossing;

/* A line from a to b, sheared so that it becomes the axis: see surface_cross.c. */
typedef struct SheetLine {
  double origin[3], direction[3];
  int axis[3];
  double shear[3];
} SheetLine;
void line_create(const double a[3], const double b[3], SheetLine *line);
bool line_crosses(const SheetLine *line, const Facet *facet, double *t, bool *leaving);

/* Does the mould stand between a and b, where b is known to lie under `end` (its foot and normal) if it is in the
 * mould? end == NULL: looked up when needed. */
bool surface_hides(const Surface *surface, const double a[3], const double b[3], const SurfaceHit *end);
/* Would a straight way that enters the mould at p (normal n) and leaves it at q (normal m) only clip a convex edge, and
 * so leave its ends in sight of each other? */
bool surface_clips(const Surface *surface, const double p[3], const double n[3], const double q[3], const double m[3]);
double surface_overhang(const Surface *surface); // m, how far beyond its ends a way is looked at
double surface_facing_alike(void);               // cosine: entered and left by faces so alike, mould hides nothing
/* First passage of the ray from a along unit d, at most `length` m away; false if none. */
bool surface_first_crossing(const Surface *surface, const double a[3], const double d[3], double length,
                            double *distance, int32_t *triangle);

/* All feet of x on thin walls within reach where x is behind the sheet and no point of the sheet nearby is closer:
 * at most `most`, nearest first. */
int surface_thin_feet(const Surface *surface, const double x[3], double reach, SurfaceHit *feet, int most);

#endif
