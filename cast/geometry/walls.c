/* walls.c - the set of wall particles: which lattice cells, in which order, and what is merged.
 * Blocks of cells are filled independently and put together in their order: the same set at any thread count. */
#include "cast/geometry/walls.h"

#include <stdlib.h>
#include <string.h>
#include "cast/geometry/walls_cells.h"

enum { BLOCK = 8, LEAF = 2, LEAVES = BLOCK / LEAF, MOST_CANDIDATES = 48 };
static const double SLIVER = 0.05; // of a cell

typedef struct BlockGrid { // blocks of BLOCK^3 cells over the cavity wall and what lies within 2 reach of it
  int32_t first[3], n[3];
} BlockGrid;

static BlockGrid lay_blocks(const WallLattice *lattice)
{
  BlockGrid blocks;
  for (int k = 0; k < 3; k++) {
    const double edge = BLOCK * lattice->spacing, margin = 2.0 * lattice->reach;
    blocks.first[k] = (int32_t)floor((lattice->surface->cavity_low[k] - margin - lattice->origin[k]) / edge);
    const int32_t last = (int32_t)floor((lattice->surface->cavity_high[k] + margin - lattice->origin[k]) / edge);
    blocks.n[k] = last - blocks.first[k] + 1;
  }
  return blocks;
}

/* The rim's outer faces bear melt to one reach from the cavity wall, and are one reach deep: 2 reach in all. */
static bool block_is_near(const WallLattice *lattice, const int32_t corner[3])
{
  double centre[3];
  for (int k = 0; k < 3; k++) centre[k] = lattice->origin[k] + (corner[k] + 0.5 * BLOCK) * lattice->spacing;
  const NearestQuery query = {
      .reach = 2.0 * lattice->reach + 0.5 * sqrt(3.0) * BLOCK * lattice->spacing, .guess = -1, .cavity_only = true};
  SurfaceHit hit;
  return surface_nearest_query(lattice->surface, centre, &query, &hit);
}

/* Is some part of the cube near a thin wall? */
static bool cube_is_near_thin(const Surface *s, const double centre[3], double half)
{
  double low[3], high[3];
  int32_t first[3], last[3], at[3];
  for (int k = 0; k < 3; k++) {
    low[k] = centre[k] - half * (1.0 + 1.0e-6);
    high[k] = centre[k] + half * (1.0 + 1.0e-6);
  }
  if (!s->any_thin || !grid_range(&s->grid, low, high, first, last)) return false;
  for (at[2] = first[2]; at[2] <= last[2]; at[2]++)
    for (at[1] = first[1]; at[1] <= last[1]; at[1]++)
      for (at[0] = first[0]; at[0] <= last[0]; at[0]++)
        if (s->grid.flags[grid_index(&s->grid, at)] & CELL_NEAR_THIN) return true;
  return false;
}

/* Which cells of a block may have particles, and what is near them: for each cube of LEAF^3 cells the candidates of a
 * search for the nearest triangle. */
typedef struct BlockPlan {
  int32_t corner[3];
  struct LeafPlan {
    bool wanted;
    NearestQuery near;
    int32_t candidate[MOST_CANDIDATES];
  } leaf[LEAVES][LEAVES][LEAVES];
} BlockPlan;

/* Cube by cube, each cut in eight, a block is left out where the surface is beyond reach of all its cells, and where
 * all of them are void and no echo can stand in them. */
static void plan_cube(const WallLattice *lattice, const int32_t at[3], int32_t edge, int32_t guess, BlockPlan *plan)
{
  double centre[3];
  for (int k = 0; k < 3; k++)
    centre[k] = lattice->origin[k] + (plan->corner[k] + at[k] + 0.5 * edge) * lattice->spacing;
  const double half_diagonal = 0.5 * sqrt(3.0) * edge * lattice->spacing * (1.0 + 1.0e-9);
  const NearestQuery query = {.reach = lattice->reach + half_diagonal, .guess = guess};
  SurfaceHit hit;
  if (!surface_nearest_query(lattice->surface, centre, &query, &hit)) return;
  if (hit.distance > half_diagonal && !cube_is_near_thin(lattice->surface, centre, 0.5 * edge * lattice->spacing))
    return;
  if (edge == LEAF) {
    struct LeafPlan *leaf = &plan->leaf[at[2] / LEAF][at[1] / LEAF][at[0] / LEAF];
    const int n = surface_candidates(lattice->surface, centre, half_diagonal, fabs(hit.distance), leaf->candidate,
                                     MOST_CANDIDATES);
    leaf->wanted = true;
    leaf->near = (NearestQuery){
        .guess = hit.triangle, .candidate = n < 0 ? NULL : leaf->candidate, .n_candidates = n < 0 ? 0 : n};
    return;
  }
  for (int child = 0; child < 8; child++) {
    int32_t next[3];
    for (int k = 0; k < 3; k++) next[k] = at[k] + (child >> k & 1) * edge / 2;
    plan_cube(lattice, next, edge / 2, hit.triangle, plan);
  }
}

static void fill_block(const WallLattice *lattice, const int32_t corner[3], WallBuffer *out)
{
  BlockPlan plan;
  int32_t at[3];
  memcpy(plan.corner, corner, sizeof plan.corner);
  for (int k = 0; k < LEAVES * LEAVES * LEAVES; k++)
    plan.leaf[k / LEAVES / LEAVES][k / LEAVES % LEAVES][k % LEAVES].wanted = false;
  plan_cube(lattice, (const int32_t[3]){0, 0, 0}, BLOCK, -1, &plan);
  for (at[2] = 0; at[2] < BLOCK; at[2]++)
    for (at[1] = 0; at[1] < BLOCK; at[1]++)
      for (at[0] = 0; at[0] < BLOCK; at[0]++) {
        const int32_t cell[3] = {corner[0] + at[0], corner[1] + at[1], corner[2] + at[2]};
        const struct LeafPlan *leaf = &plan.leaf[at[2] / LEAF][at[1] / LEAF][at[0] / LEAF];
        if (leaf->wanted) wall_cell_fill(lattice, cell, &leaf->near, out);
      }
}

static void fill_blocks(const WallLattice *lattice, const BlockGrid *blocks, WallBuffer *buffers)
{
  const ptrdiff_t n = (ptrdiff_t)blocks->n[0] * blocks->n[1] * blocks->n[2];
#pragma omp parallel for schedule(dynamic, 4)
  for (ptrdiff_t b = 0; b < n; b++) {
    const int32_t corner[3] = {BLOCK * (blocks->first[0] + (int32_t)(b % blocks->n[0])),
                               BLOCK * (blocks->first[1] + (int32_t)(b / blocks->n[0] % blocks->n[1])),
                               BLOCK * (blocks->first[2] + (int32_t)(b / blocks->n[0] / blocks->n[1]))};
    if (block_is_near(lattice, corner)) fill_block(lattice, corner, &buffers[b]);
  }
}

/* One list in the order of the blocks; the buffers are emptied. */
static CastStatus join_buffers(WallBuffer *buffers, ptrdiff_t n, WallBuffer *all, CastError *err)
{
  ptrdiff_t total = 0;
  for (ptrdiff_t b = 0; b < n; b++) {
    CAST_CHECK(!buffers[b].failed, err, CAST_ERR_MEMORY, "no memory for the wall particles");
    total += buffers[b].n;
  }
  CAST_CHECK(total < INT32_MAX, err, CAST_ERR_INPUT, "%td wall particles are more than a run can number", total);
  all->particle = malloc((size_t)(total ? total : 1) * sizeof *all->particle);
  CAST_CHECK(all->particle, err, CAST_ERR_MEMORY, "no memory for %td wall particles", total);
  all->capacity = total;
  for (ptrdiff_t b = 0; b < n; b++) {
    for (ptrdiff_t k = 0; k < buffers[b].n; k++) all->particle[all->n++] = buffers[b].particle[k];
    free(buffers[b].particle);
    buffers[b].particle = NULL;
  }
  return CAST_OK;
}

typedef struct CellEntry {
  int32_t cell[3], particle;
} CellEntry;

static int compare_cells(const int32_t a[3], const int32_t b[3])
{
  for (int k = 2; k >= 0; k--)
    if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
  return 0;
}

static int compare_entries(const void *left, const void *right)
{
  const CellEntry *a = left, *b = right;
  const int order = compare_cells(a->cell, b->cell);
  return order ? order : (a->particle > b->particle) - (a->particle < b->particle);
}

/* First entry of the cell, or n. */
static ptrdiff_t find_cell(const CellEntry *entries, ptrdiff_t n, const int32_t cell[3])
{
  ptrdiff_t low = 0, high = n;
  while (low < high) {
    const ptrdiff_t middle = (low + high) / 2;
    if (compare_cells(entries[middle].cell, cell) < 0)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* The fullest particle of the sliver's own cell and the six next to it whose normal is no farther from the sliver's
 * than `alike` (a cosine); -1 if there is none. */
static int32_t find_host(const WallBuffer *all, const CellEntry *entries, ptrdiff_t n, int32_t sliver, double alike)
{
  static const int32_t step[7][3] = {{0, 0, 0}, {-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  const WallParticle *small = &all->particle[sliver];
  int32_t host = -1;
  for (int k = 0; k < 7; k++) {
    const int32_t cell[3] = {small->cell[0] + step[k][0], small->cell[1] + step[k][1], small->cell[2] + step[k][2]};
    for (ptrdiff_t e = find_cell(entries, n, cell); e < n && compare_cells(entries[e].cell, cell) == 0; e++) {
      const WallParticle *other = &all->particle[entries[e].particle];
      if (entries[e].particle == sliver || other->volume == 0.0) continue;
      if (vec_dot(other->normal, small->normal) < alike) continue;
      if (host < 0 || other->volume > all->particle[host].volume) host = entries[e].particle;
    }
  }
  return host;
}

/* Volume and first moment are kept; the host's foot is looked up anew. */
static void merge_into(const Surface *surface, WallParticle *host, WallParticle *sliver)
{
  const double sum = host->volume + sliver->volume;
  for (int k = 0; k < 3; k++) host->x[k] = (host->volume * host->x[k] + sliver->volume * sliver->x[k]) / sum;
  host->volume = sum;
  sliver->volume = 0.0;
  SurfaceHit hit;
  if (!surface_nearest(surface, host->x, 2.0 * host->depth + surface->reach, &hit) || hit.distance >= 0.0) return;
  vec_copy(hit.foot, host->foot);
  vec_copy(hit.normal, host->normal);
  host->depth = -hit.distance;
  host->patch = hit.patch;
}

static CastStatus merge_slivers(const WallLattice *lattice, WallBuffer *all, CastError *err)
{
  const double least = SLIVER * lattice->spacing * lattice->spacing * lattice->spacing;
  CellEntry *entries = malloc((size_t)(all->n ? all->n : 1) * sizeof *entries);
  CAST_CHECK(entries, err, CAST_ERR_MEMORY, "no memory to merge %td wall particles", all->n);
  ptrdiff_t n = 0;
  for (ptrdiff_t k = 0; k < all->n; k++) {
    const WallParticle *p = &all->particle[k];
    if (!p->echo) entries[n++] = (CellEntry){{p->cell[0], p->cell[1], p->cell[2]}, (int32_t)k};
  }
  qsort(entries, (size_t)n, sizeof *entries, compare_entries);
  for (ptrdiff_t k = 0; k < all->n; k++) {
    if (all->particle[k].echo || all->particle[k].volume >= least) continue;
    int32_t host = find_host(all, entries, n, (int32_t)k, 0.5);
    if (host < 0) host = find_host(all, entries, n, (int32_t)k, -0.1); // round a convex edge, never through a thin wall
    if (host >= 0) merge_into(lattice->surface, &all->particle[host], &all->particle[k]);
  }
  free(entries);
  return CAST_OK;
}

static CastStatus allocate_walls(WallSet *walls, ptrdiff_t n, CastError *err)
{
  const size_t size = (size_t)(n ? n : 1);
  bool ok = true;
  double **const fields[] = {&walls->x[0],      &walls->x[1],    &walls->x[2],      &walls->foot[0],
                             &walls->foot[1],   &walls->foot[2], &walls->normal[0], &walls->normal[1],
                             &walls->normal[2], &walls->volume,  &walls->depth};
  for (size_t k = 0; k < sizeof fields / sizeof *fields; k++) {
    *fields[k] = malloc(size * sizeof(double));
    ok = ok && *fields[k];
  }
  walls->patch = malloc(size * sizeof *walls->patch);
  walls->echo = malloc(size);
  walls->n = n;
  CAST_CHECK(ok && walls->patch && walls->echo, err, CAST_ERR_MEMORY, "no memory for %td wall particles", n);
  return CAST_OK;
}

static CastStatus export_walls(const WallBuffer *all, WallSet *walls, CastError *err)
{
  ptrdiff_t n = 0;
  for (ptrdiff_t k = 0; k < all->n; k++) n += all->particle[k].volume > 0.0;
  CAST_CALL(allocate_walls(walls, n, err));
  ptrdiff_t i = 0;
  for (ptrdiff_t k = 0; k < all->n; k++) {
    const WallParticle *p = &all->particle[k];
    if (!(p->volume > 0.0)) continue;
    for (int axis = 0; axis < 3; axis++) {
      walls->x[axis][i] = p->x[axis];
      walls->foot[axis][i] = p->foot[axis];
      walls->normal[axis][i] = p->normal[axis];
    }
    walls->volume[i] = p->volume;
    walls->depth[i] = p->depth;
    walls->patch[i] = p->patch;
    walls->echo[i++] = p->echo ? 1 : 0;
  }
  return CAST_OK;
}

static CastStatus check_input(const WallLattice *lattice, CastError *err)
{
  const Surface *s = lattice->surface;
  CAST_CHECK(lattice->spacing > 0.0 && lattice->reach > 0.0 && isfinite(lattice->spacing + lattice->reach), err,
             CAST_ERR_ARGUMENT, "walls: spacing %g m and reach %g m must be positive", lattice->spacing,
             lattice->reach);
  CAST_CHECK(s->cavity_low[0] <= s->cavity_high[0], err, CAST_ERR_INPUT, "the mould has no cavity wall");
  double extent = 0.0;
  for (int k = 0; k < 3; k++) extent = fmax(extent, s->cavity_high[k] - s->cavity_low[k]);
  CAST_CHECK(lattice->spacing < extent, err, CAST_ERR_INPUT,
             "a particle spacing of %g m cannot resolve a cavity of %g m across", lattice->spacing, extent);
  for (int k = 0; k < 3; k++)
    CAST_CHECK((s->cavity_high[k] - s->cavity_low[k]) / lattice->spacing < 1.0e5, err, CAST_ERR_INPUT,
               "a particle spacing of %g m is too fine for a cavity of %g m across", lattice->spacing, extent);
  return CAST_OK;
}

CastStatus walls_generate(const Surface *surface, double spacing, double reach, const double origin[3], WallSet *walls,
                          CastError *err)
{
  const WallLattice lattice = {surface, spacing, reach, {origin[0], origin[1], origin[2]}};
  *walls = (WallSet){0};
  CAST_CALL(check_input(&lattice, err));
  const BlockGrid blocks = lay_blocks(&lattice);
  const ptrdiff_t n_blocks = (ptrdiff_t)blocks.n[0] * blocks.n[1] * blocks.n[2];
  WallBuffer all = {0}, *buffers = calloc((size_t)n_blocks, sizeof *buffers);
  CAST_CHECK(buffers, err, CAST_ERR_MEMORY, "no memory for %td blocks of wall cells", n_blocks);
  fill_blocks(&lattice, &blocks, buffers);
  CastStatus status = join_buffers(buffers, n_blocks, &all, err);
  if (status == CAST_OK) status = merge_slivers(&lattice, &all, err);
  if (status == CAST_OK) status = export_walls(&all, walls, err);
  for (ptrdiff_t b = 0; b < n_blocks; b++) free(buffers[b].particle);
  free(buffers);
  free(all.particle);
  if (status != CAST_OK) walls_destroy(walls);
  return status;
}

void walls_destroy(WallSet *walls)
{
  for (int k = 0; k < 3; k++) {
    free(walls->x[k]);
    free(walls->foot[k]);
    free(walls->normal[k]);
  }
  free(walls->volume);
  free(walls->depth);
  free(walls->patch);
  free(walls->echo);
  *walls = (WallSet){0};
}

bool walls_seen(const Surface *surface, const double x[3], const double place[3], const double foot[3],
                const double normal[3], bool echo)
{
  if (!surface_thin_near(surface, x)) return !echo;
  SurfaceHit end = {0};
  vec_copy(foot, end.foot);
  vec_copy(normal, end.normal);
  if (!echo) return !surface_hides(surface, x, place, &end);
  double lifted[3];
  vec_axpy(1.0e-3 * surface->reach, normal, foot, lifted);
  return !surface_hides(surface, x, lifted, NULL) && surface_hides(surface, x, place, NULL);
}
