/* cavity_mask.c - which lattice cells belong to the cavity.
 * Method: within the box round the cavity wall, void cells at the wall belong to the cavity if nothing but cavity wall
 * is nearest to them; from them the cavity spreads through void cells face to face. The box ends at the openings' rims,
 * so the open air beyond them stays out.
 * Cubes of cells, each cut in eight, are mould or void as a whole where no surface is near; only the cells of the
 * smallest cubes at the surface are looked at one by one, among the triangles that are near their cube. Blocks are
 * worked on independently: the same at any thread count. */
#include "cast/geometry/cavity_mask.h"

#include <stdlib.h>
#include <string.h>

enum { CELL_SOLID = 0, CELL_CAVITY = 1, CELL_VOID = 2 }; // CELL_VOID: void, not known to be the cavity's
enum { BLOCK = 8, LEAF = 2, MOST_CANDIDATES = 48 };
static const double AT_WALL = 1.01, EMPTY = 1.0e-9; // spacings

ptrdiff_t cavity_mask_size(const CavityMask *mask)
{
  return (ptrdiff_t)mask->n[0] * mask->n[1] * mask->n[2];
}

/* The cell's box cut to the box round the cavity wall; false if nothing is left. */
static bool cell_box(const CavityMask *mask, ptrdiff_t cell, CutBox *box)
{
  const int32_t at[3] = {(int32_t)(cell % mask->n[0]), (int32_t)(cell / mask->n[0] % mask->n[1]),
                         (int32_t)(cell / mask->n[0] / mask->n[1])};
  for (int k = 0; k < 3; k++) {
    const double low = mask->origin[k] + (mask->first[k] + at[k]) * mask->spacing;
    box->low[k] = fmax(low, mask->surface->cavity_low[k]);
    box->high[k] = fmin(low + mask->spacing, mask->surface->cavity_high[k]);
    if (box->high[k] - box->low[k] <= EMPTY * mask->spacing) return false;
  }
  return true;
}

void cavity_mask_whole(const CavityMask *mask, ptrdiff_t cell, CutPart *part)
{
  CutBox box;
  *part = (CutPart){0};
  if (cell_box(mask, cell, &box)) cut_whole(&box, part);
}

/* ---- cells at the surface ---- */

typedef struct NearCells { // of one block, later of one layer of blocks
  MaskCell *cell;
  ptrdiff_t n, capacity;
  bool failed; // no memory
} NearCells;

static void keep_near(NearCells *near, const MaskCell *cell)
{
  if (near->n == near->capacity) {
    const ptrdiff_t capacity = near->capacity ? 2 * near->capacity : 64;
    MaskCell *grown = realloc(near->cell, (size_t)capacity * sizeof *grown);
    if (!grown) {
      near->failed = true;
      return;
    }
    near->cell = grown;
    near->capacity = capacity;
  }
  near->cell[near->n++] = *cell;
}

/* The void part of a box that the surface may cut. */
typedef struct VoidPart {
  CutPart part;
  bool cut, near; // near: to the surface
  SurfaceHit hit; // where it is near: from the part's centroid
} VoidPart;

/* False if the box is all mould. */
static bool find_void(const CavityMask *mask, const CutBox *box, NearestQuery *query, VoidPart *out)
{
  const Surface *s = mask->surface;
  double centre[3], half_diagonal = 0.0;
  for (int k = 0; k < 3; k++) {
    centre[k] = 0.5 * (box->low[k] + box->high[k]);
    half_diagonal += 0.25 * (box->high[k] - box->low[k]) * (box->high[k] - box->low[k]);
  }
  half_diagonal = sqrt(half_diagonal);
  query->reach = AT_WALL * mask->spacing;
  out->near = surface_nearest_query(s, centre, query, &out->hit);
  cut_whole(box, &out->part);
  out->cut = out->near && fabs(out->hit.distance) <= half_diagonal;
  if (!out->near) return !surface_inside_mould(s, centre);
  if (!out->cut) return out->hit.distance > 0.0;
  CutPart mould;
  cut_box(s, box, NULL, &mould);
  cut_add(&out->part, -1.0, &mould);
  if (out->part.volume < 1.0e-6 * mask->spacing * mask->spacing * mask->spacing) return false;
  double x[3];
  for (int k = 0; k < 3; k++) x[k] = out->part.moment[k] / out->part.volume;
  query->guess = out->hit.triangle;
  out->near = surface_nearest_query(s, x, query, &out->hit);
  return true;
}

/* Is no outer face nearer than the cavity wall? At the rim both are equally near. */
static bool is_at_cavity_wall(const CavityMask *mask, const VoidPart *part)
{
  if (!part->near || !mask->surface->outer[part->hit.triangle]) return part->near;
  double x[3];
  for (int k = 0; k < 3; k++) x[k] = part->part.moment[k] / part->part.volume;
  const NearestQuery wall = {
      .reach = fabs(part->hit.distance) * (1.0 + 1.0e-9) + mask->surface->tiny, .guess = -1, .cavity_only = true};
  SurfaceHit hit;
  return surface_nearest_query(mask->surface, x, &wall, &hit);
}

/* `near`: the guess and candidates of a search from anywhere in the cell. */
static uint8_t classify(const CavityMask *mask, ptrdiff_t cell, const NearestQuery *near, NearCells *kept)
{
  CutBox box;
  VoidPart part;
  NearestQuery query = *near;
  if (!cell_box(mask, cell, &box) || !find_void(mask, &box, &query, &part)) return CELL_SOLID;
  if (part.cut) keep_near(kept, &(MaskCell){(int32_t)cell, part.part});
  return is_at_cavity_wall(mask, &part) ? CELL_CAVITY : CELL_VOID;
}

/* ---- cubes ---- */

/* The cells of a cube, cut to the lattice. */
static void cube_end(const CavityMask *mask, const int32_t at[3], int32_t edge, int32_t end[3])
{
  for (int k = 0; k < 3; k++) end[k] = at[k] + edge < mask->n[k] ? at[k] + edge : mask->n[k];
}

static ptrdiff_t cell_number(const CavityMask *mask, int32_t x, int32_t y, int32_t z)
{
  return ((ptrdiff_t)z * mask->n[1] + y) * mask->n[0] + x;
}

static void set_cube(CavityMask *mask, const int32_t at[3], int32_t edge, uint8_t state)
{
  int32_t end[3];
  cube_end(mask, at, edge, end);
  for (int32_t z = at[2]; z < end[2]; z++)
    for (int32_t y = at[1]; y < end[1]; y++)
      memset(mask->is_cavity + cell_number(mask, at[0], y, z), state, (size_t)(end[0] - at[0]));
}

static void classify_leaf(CavityMask *mask, const int32_t at[3], const NearestQuery *near, NearCells *kept)
{
  int32_t end[3];
  cube_end(mask, at, LEAF, end);
  for (int32_t z = at[2]; z < end[2]; z++)
    for (int32_t y = at[1]; y < end[1]; y++)
      for (int32_t x = at[0]; x < end[0]; x++) {
        const ptrdiff_t cell = cell_number(mask, x, y, z);
        mask->is_cavity[cell] = classify(mask, cell, near, kept);
      }
}

static void classify_cube(CavityMask *mask, const int32_t at[3], int32_t edge, int32_t guess, NearCells *kept)
{
  double centre[3];
  for (int k = 0; k < 3; k++) {
    if (at[k] >= mask->n[k]) return;
    centre[k] = mask->origin[k] + (mask->first[k] + at[k] + 0.5 * edge) * mask->spacing;
  }
  const double half_diagonal = 0.5 * sqrt(3.0) * edge * mask->spacing * (1.0 + 1.0e-9);
  const NearestQuery query = {.reach = AT_WALL * mask->spacing + half_diagonal, .guess = guess};
  SurfaceHit hit;
  if (!surface_nearest_query(mask->surface, centre, &query, &hit)) {
    set_cube(mask, at, edge, surface_inside_mould(mask->surface, centre) ? CELL_SOLID : CELL_VOID);
    return;
  }
  if (edge == LEAF) {
    int32_t candidate[MOST_CANDIDATES];
    const int n =
        surface_candidates(mask->surface, centre, half_diagonal, fabs(hit.distance), candidate, MOST_CANDIDATES);
    const NearestQuery near = {
        .guess = hit.triangle, .candidate = n < 0 ? NULL : candidate, .n_candidates = n < 0 ? 0 : n};
    classify_leaf(mask, at, &near, kept);
    return;
  }
  for (int child = 0; child < 8; child++) {
    int32_t next[3];
    for (int k = 0; k < 3; k++) next[k] = at[k] + (child >> k & 1) * edge / 2;
    classify_cube(mask, next, edge / 2, hit.triangle, kept);
  }
}

/* Cells that lie outside the box round the cavity wall but for rounding: nothing, wherever a cube was set as a whole.
 */
static void drop_empty_faces(CavityMask *mask)
{
  for (int axis = 0; axis < 3; axis++)
    for (int side = 0; side < 2; side++) {
      int32_t at[3] = {0, 0, 0}, end[3] = {mask->n[0], mask->n[1], mask->n[2]};
      at[axis] = side ? mask->n[axis] - 1 : 0;
      end[axis] = at[axis] + 1;
      CutBox box;
      const double low = mask->origin[axis] + (mask->first[axis] + at[axis]) * mask->spacing;
      box.low[axis] = fmax(low, mask->surface->cavity_low[axis]);
      box.high[axis] = fmin(low + mask->spacing, mask->surface->cavity_high[axis]);
      if (box.high[axis] - box.low[axis] > EMPTY * mask->spacing) continue;
      for (int32_t z = at[2]; z < end[2]; z++)
        for (int32_t y = at[1]; y < end[1]; y++)
          memset(mask->is_cavity + cell_number(mask, at[0], y, z), CELL_SOLID, (size_t)(end[0] - at[0]));
    }
}

static int compare_cells(const void *left, const void *right)
{
  const MaskCell *a = left, *b = right;
  return (a->cell > b->cell) - (a->cell < b->cell);
}

/* Those of n blocks behind each other at `to`, in the order of their cells; returns how many. */
static ptrdiff_t gather_layer(const NearCells *block, ptrdiff_t n, MaskCell *to)
{
  ptrdiff_t count = 0;
  for (ptrdiff_t b = 0; b < n; b++) {
    if (block[b].n > 0) memcpy(to + count, block[b].cell, (size_t)block[b].n * sizeof *to);
    count += block[b].n;
  }
  qsort(to, (size_t)count, sizeof *to, compare_cells);
  return count;
}

/* Cells of a layer of blocks all come before those of the next: sorted layer by layer they are sorted. */
static CastStatus join_blocks(CavityMask *mask, const NearCells *block, ptrdiff_t per_layer, ptrdiff_t layers,
                              CastError *err)
{
  ptrdiff_t *start = calloc((size_t)layers + 1, sizeof *start);
  CAST_CHECK(start, err, CAST_ERR_MEMORY, "no memory for the cavity's cells");
  bool failed = false;
  for (ptrdiff_t l = 0; l < layers; l++) {
    start[l + 1] = start[l];
    for (ptrdiff_t b = l * per_layer; b < (l + 1) * per_layer; b++) {
      start[l + 1] += block[b].n;
      failed = failed || block[b].failed;
    }
  }
  mask->n_near = start[layers];
  mask->near = failed ? NULL : malloc((size_t)(mask->n_near + 1) * sizeof *mask->near);
  if (mask->near) {
#pragma omp parallel for schedule(dynamic, 1)
    for (ptrdiff_t l = 0; l < layers; l++) gather_layer(block + l * per_layer, per_layer, mask->near + start[l]);
  }
  free(start);
  CAST_CHECK(mask->near, err, CAST_ERR_MEMORY, "no memory for %td cells at the cavity's wall", mask->n_near);
  return CAST_OK;
}

static CastStatus classify_blocks(CavityMask *mask, CastError *err)
{
  const int32_t blocks[3] = {(mask->n[0] + BLOCK - 1) / BLOCK, (mask->n[1] + BLOCK - 1) / BLOCK,
                             (mask->n[2] + BLOCK - 1) / BLOCK};
  const ptrdiff_t per_layer = (ptrdiff_t)blocks[0] * blocks[1], n = per_layer * blocks[2];
  NearCells *kept = calloc((size_t)n, sizeof *kept);
  CAST_CHECK(kept, err, CAST_ERR_MEMORY, "no memory for %td blocks of the cavity's lattice", n);
#pragma omp parallel for schedule(dynamic, 4)
  for (ptrdiff_t b = 0; b < n; b++) {
    const int32_t at[3] = {BLOCK * (int32_t)(b % blocks[0]), BLOCK * (int32_t)(b / blocks[0] % blocks[1]),
                           BLOCK * (int32_t)(b / per_layer)};
    classify_cube(mask, at, BLOCK, -1, &kept[b]);
  }
  drop_empty_faces(mask);
  const CastStatus status = join_blocks(mask, kept, per_layer, blocks[2], err);
  for (ptrdiff_t b = 0; b < n; b++) free(kept[b].cell);
  free(kept);
  return status;
}

ptrdiff_t cavity_mask_find(const CavityMask *mask, ptrdiff_t cell)
{
  ptrdiff_t low = 0, high = mask->n_near;
  while (low < high) {
    const ptrdiff_t middle = (low + high) / 2;
    if (mask->near[middle].cell < cell)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* ---- all of it ---- */

static void spread(CavityMask *mask, int32_t *stack)
{
  static const int32_t step[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  const ptrdiff_t cells = cavity_mask_size(mask);
  ptrdiff_t height = 0;
  for (ptrdiff_t c = 0; c < cells; c++)
    if (mask->is_cavity[c] == CELL_CAVITY) stack[height++] = (int32_t)c;
  while (height > 0) {
    const int32_t c = stack[--height];
    const int32_t at[3] = {c % mask->n[0], c / mask->n[0] % mask->n[1], c / mask->n[0] / mask->n[1]};
    for (int k = 0; k < 6; k++) {
      const int32_t to[3] = {at[0] + step[k][0], at[1] + step[k][1], at[2] + step[k][2]};
      bool within = true;
      for (int axis = 0; axis < 3; axis++) within = within && to[axis] >= 0 && to[axis] < mask->n[axis];
      if (!within) continue;
      const ptrdiff_t next = ((ptrdiff_t)to[2] * mask->n[1] + to[1]) * mask->n[0] + to[0];
      if (mask->is_cavity[next] != CELL_VOID) continue;
      mask->is_cavity[next] = CELL_CAVITY;
      stack[height++] = (int32_t)next;
    }
  }
  for (ptrdiff_t c = 0; c < cells; c++)
    if (mask->is_cavity[c] != CELL_CAVITY) mask->is_cavity[c] = CELL_SOLID;
}

static CastStatus lay_cells(CavityMask *mask, CastError *err)
{
  const Surface *s = mask->surface;
  CAST_CHECK(mask->spacing > 0.0 && isfinite(mask->spacing), err, CAST_ERR_ARGUMENT, "spacing %g m must be positive",
             mask->spacing);
  CAST_CHECK(s->cavity_low[0] <= s->cavity_high[0], err, CAST_ERR_INPUT, "the mould has no cavity wall");
  double cells = 1.0;
  for (int k = 0; k < 3; k++)
    cells *= floor((s->cavity_high[k] - mask->origin[k]) / mask->spacing) -
             floor((s->cavity_low[k] - mask->origin[k]) / mask->spacing) + 1.0;
  CAST_CHECK(cells < 2.0e9, err, CAST_ERR_INPUT,
             "a lattice of %g m over the cavity would have %g cells, at most 2e9 are possible", mask->spacing, cells);
  for (int k = 0; k < 3; k++) {
    mask->first[k] = (int32_t)floor((s->cavity_low[k] - mask->origin[k]) / mask->spacing);
    mask->n[k] = (int32_t)floor((s->cavity_high[k] - mask->origin[k]) / mask->spacing) - mask->first[k] + 1;
  }
  return CAST_OK;
}

CastStatus cavity_mask_create(const Surface *surface, double spacing, const double origin[3], CavityMask *mask,
                              CastError *err)
{
  *mask = (CavityMask){.surface = surface, .spacing = spacing, .origin = {origin[0], origin[1], origin[2]}};
  CAST_CALL(lay_cells(mask, err));
  const ptrdiff_t cells = cavity_mask_size(mask);
  mask->is_cavity = malloc((size_t)cells);
  int32_t *stack = malloc((size_t)cells * sizeof *stack);
  if (!mask->is_cavity || !stack) {
    free(stack);
    cavity_mask_destroy(mask);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for a lattice of %td cells over the cavity", cells);
  }
  const CastStatus status = classify_blocks(mask, err);
  if (status == CAST_OK)
    spread(mask, stack);
  else
    cavity_mask_destroy(mask);
  free(stack);
  return status;
}

void cavity_mask_destroy(CavityMask *mask)
{
  free(mask->is_cavity);
  free(mask->near);
  mask->is_cavity = NULL;
  mask->near = NULL;
}
