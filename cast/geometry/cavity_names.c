/* cavity_names.c - the named surface that is nearest to each cell of the cavity.
 * Method: cubes of cells, each cut in eight. A triangle can be the nearest one to some point of a cube of radius r
 * round c only if it is at most d(c) + 2 r from c, d(c) being the distance of the nearest; a cube keeps those of its
 * parent's triangles. As soon as all of them have one name so have its cells; only at the borders between names single
 * cells are looked at. Exact, and cubes are independent: the same at any thread count. */
#include "cast/geometry/cavity_names.h"

#include <stdlib.h>

static const double SAME = 1.0e-9; // of a distance: rounding
enum { TOP = 32, LEVELS = 6 };     // edges 32, 16, 8, 4, 2, and single cells

typedef struct Naming {
  const CavityMask *mask;
  const int32_t *list, *name_of_patch;
  ptrdiff_t *row; // [n1 n2 + 1] first of the list in each row of the lattice
  CavityCells *cells;
} Naming;

typedef struct Candidates { // of one thread
  int32_t *triangle[LEVELS];
  double *distance; // [triangles] m; NAN: not asked for
} Candidates;

/* ---- rows of cells ---- */

static CastStatus find_rows(Naming *naming, CastError *err)
{
  const int32_t *n = naming->mask->n;
  const ptrdiff_t rows = (ptrdiff_t)n[1] * n[2];
  naming->row = malloc((size_t)(rows + 1) * sizeof *naming->row);
  CAST_CHECK(naming->row, err, CAST_ERR_MEMORY, "no memory to name the cavity's cells");
  ptrdiff_t i = 0;
  for (ptrdiff_t r = 0; r <= rows; r++) {
    while (i < naming->cells->n && naming->list[i] < r * n[0]) i++;
    naming->row[r] = i;
  }
  return CAST_OK;
}

/* First of row r's cells at or behind x. */
static ptrdiff_t find_in_row(const Naming *naming, ptrdiff_t r, int32_t x)
{
  ptrdiff_t low = naming->row[r], high = naming->row[r + 1];
  const ptrdiff_t cell = r * naming->mask->n[0] + x;
  while (low < high) {
    const ptrdiff_t middle = (low + high) / 2;
    if (naming->list[middle] < cell)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

typedef struct Cube {
  int32_t at[3], edge;
} Cube;

/* Cells [*first, *end) of the list lie in line k of the cube; false if that line is outside the lattice. */
static bool cube_line(const Naming *naming, const Cube *cube, int32_t k, ptrdiff_t *first, ptrdiff_t *end)
{
  const int32_t *n = naming->mask->n, y = cube->at[1] + k % cube->edge, z = cube->at[2] + k / cube->edge;
  if (y >= n[1] || z >= n[2] || cube->at[0] >= n[0]) return false;
  const int32_t last = cube->at[0] + cube->edge < n[0] ? cube->at[0] + cube->edge : n[0];
  *first = find_in_row(naming, (ptrdiff_t)z * n[1] + y, cube->at[0]);
  *end = find_in_row(naming, (ptrdiff_t)z * n[1] + y, last);
  return true;
}

static bool holds_cells(const Naming *naming, const Cube *cube)
{
  ptrdiff_t first, end;
  for (int32_t k = 0; k < cube->edge * cube->edge; k++)
    if (cube_line(naming, cube, k, &first, &end) && first < end) return true;
  return false;
}

static void name_cube(const Naming *naming, const Cube *cube, int32_t name)
{
  ptrdiff_t first, end;
  for (int32_t k = 0; k < cube->edge * cube->edge; k++)
    if (cube_line(naming, cube, k, &first, &end))
      for (ptrdiff_t i = first; i < end; i++) naming->cells->surface[i] = name;
}

/* ---- triangles ---- */

static double facet_distance(const Naming *naming, int32_t t, const double x[3])
{
  double foot[3];
  FacetFeature feature;
  return sqrt(facet_closest(&naming->mask->surface->facet[t], x, foot, &feature));
}

/* No farther from x than this. */
static double least_distance(const Naming *naming, int32_t t, const double x[3])
{
  const Facet *facet = &naming->mask->surface->facet[t];
  return vec_distance(facet->centre, x) - facet->radius;
}

/* Those of n triangles that may be the nearest to a point within `radius` of x, the nearest to x first: it rules out
 * most others; returns how many. */
static ptrdiff_t choose(const Naming *naming, const double x[3], double radius, const int32_t *from, ptrdiff_t n,
                        double *distance, int32_t *to)
{
  double best = INFINITY;
  ptrdiff_t nearest = 0, kept = 0;
  for (ptrdiff_t k = 0; k < n; k++) {
    distance[k] = (double)NAN;
    if (least_distance(naming, from[k], x) >= best) continue;
    distance[k] = facet_distance(naming, from[k], x);
    if (distance[k] >= best) continue;
    best = distance[k];
    nearest = k;
  }
  const double far = (best + 2.0 * radius) * (1.0 + 1.0e-9);
  to[kept++] = from[nearest];
  for (ptrdiff_t k = 0; k < n; k++) {
    if (k == nearest || (isnan(distance[k]) && least_distance(naming, from[k], x) > far)) continue;
    if ((isnan(distance[k]) ? facet_distance(naming, from[k], x) : distance[k]) <= far) to[kept++] = from[k];
  }
  return kept;
}

static int32_t name_of(const Naming *naming, int32_t t)
{
  return naming->name_of_patch[naming->mask->surface->patch[t]];
}

static bool have_one_name(const Naming *naming, const int32_t *triangle, ptrdiff_t n)
{
  for (ptrdiff_t k = 1; k < n; k++)
    if (name_of(naming, triangle[k]) != name_of(naming, triangle[0])) return false;
  return true;
}

/* Where an edge or a corner is nearest, several triangles are equally near: the one that x stands highest over has it,
 * so that the space before an edge is halved between the surfaces that meet there; of equals, the lowest number. */
static void name_cell(const Naming *naming, ptrdiff_t i, const int32_t *triangle, ptrdiff_t n)
{
  const CavityCells *cells = naming->cells;
  const double x[3] = {cells->x[0][i], cells->x[1][i], cells->x[2][i]};
  double best = INFINITY, highest = 0.0;
  int32_t chosen = -1;
  for (ptrdiff_t k = 0; k < n; k++) {
    if (least_distance(naming, triangle[k], x) > best * (1.0 + SAME)) continue;
    const Facet *facet = &naming->mask->surface->facet[triangle[k]];
    const double distance = facet_distance(naming, triangle[k], x);
    double to[3];
    vec_sub(x, facet->corner[0], to);
    const double height = fabs(vec_dot(to, facet->normal)), least = SAME * distance;
    if (chosen >= 0 && fabs(distance - best) <= least) {
      const bool as_high = fabs(height - highest) <= least;
      if (as_high ? triangle[k] > chosen : height < highest) continue;
    } else if (distance > best) {
      continue;
    }
    best = distance < best ? distance : best;
    highest = height;
    chosen = triangle[k];
  }
  cells->surface[i] = name_of(naming, chosen);
}

/* from: the parent's n triangles. */
static void descend(const Naming *naming, const Cube *cube, const int32_t *from, ptrdiff_t n, int level,
                    Candidates *room)
{
  const CavityMask *mask = naming->mask;
  ptrdiff_t first, end;
  if (cube->edge == 1) {
    if (cube_line(naming, cube, 0, &first, &end) && first < end) name_cell(naming, first, from, n);
    return;
  }
  if (!holds_cells(naming, cube)) return;
  double centre[3];
  for (int k = 0; k < 3; k++)
    centre[k] = mask->origin[k] + (mask->first[k] + cube->at[k] + 0.5 * cube->edge) * mask->spacing;
  int32_t *own = room->triangle[level];
  const ptrdiff_t kept =
      choose(naming, centre, 0.5 * sqrt(3.0) * cube->edge * mask->spacing, from, n, room->distance, own);
  if (have_one_name(naming, own, kept)) {
    name_cube(naming, cube, name_of(naming, own[0]));
    return;
  }
  for (int child = 0; child < 8; child++) {
    Cube part = {.edge = cube->edge / 2};
    for (int k = 0; k < 3; k++) part.at[k] = cube->at[k] + (child >> k & 1) * part.edge;
    descend(naming, &part, own, kept, level + 1, room);
  }
}

/* ---- all of it ---- */

static bool make_room(ptrdiff_t n, Candidates *room)
{
  room->distance = malloc((size_t)n * sizeof *room->distance);
  bool ok = room->distance != NULL;
  for (int level = 0; level < LEVELS; level++) ok = (room->triangle[level] = malloc((size_t)n * sizeof(int32_t))) && ok;
  return ok;
}

static void free_room(Candidates *room)
{
  free(room->distance);
  for (int level = 0; level < LEVELS; level++) free(room->triangle[level]);
}

static bool name_cubes(const Naming *naming, const int32_t *triangle, ptrdiff_t n)
{
  const int32_t *cells = naming->mask->n;
  const ptrdiff_t cubes[3] = {(cells[0] + TOP - 1) / TOP, (cells[1] + TOP - 1) / TOP, (cells[2] + TOP - 1) / TOP};
  bool ok = true;
#pragma omp parallel reduction(&& : ok)
  {
    Candidates room;
    const bool ready = make_room(n, &room);
    ok = ready;
#pragma omp for schedule(dynamic, 1)
    for (ptrdiff_t c = 0; c < cubes[0] * cubes[1] * cubes[2]; c++) {
      const Cube cube = {{TOP * (int32_t)(c % cubes[0]), TOP * (int32_t)(c / cubes[0] % cubes[1]),
                          TOP * (int32_t)(c / cubes[0] / cubes[1])},
                         TOP};
      if (ready) descend(naming, &cube, triangle, n, 0, &room);
    }
    free_room(&room);
  }
  return ok;
}

CastStatus cavity_name_cells(const CavityMask *mask, const int32_t *list, const int32_t *name_of_patch,
                             CavityCells *cells, CastError *err)
{
  const Surface *s = mask->surface;
  for (ptrdiff_t i = 0; i < cells->n; i++) cells->surface[i] = 0;
  if (cells->n_surfaces < 2 || cells->n == 0) return CAST_OK;
  Naming naming = {.mask = mask, .list = list, .name_of_patch = name_of_patch, .cells = cells};
  CAST_CALL(find_rows(&naming, err));
  int32_t *triangle = malloc((size_t)s->n_triangles * sizeof *triangle);
  ptrdiff_t n = 0;
  for (ptrdiff_t t = 0; triangle && t < s->n_triangles; t++)
    if (!s->outer[t]) triangle[n++] = (int32_t)t;
  const bool ok = triangle && name_cubes(&naming, triangle, n);
  free(triangle);
  free(naming.row);
  CAST_CHECK(ok, err, CAST_ERR_MEMORY, "no memory to name the cavity's cells");
  return CAST_OK;
}
