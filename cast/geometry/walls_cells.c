/* walls_cells.c - the wall particles of one lattice cell: its own part of the mould, and the echoes of thin walls. */
#include "cast/geometry/walls_cells.h"

#include <stdlib.h>
#include "cast/geometry/cut.h"

enum { MAX_FEET = 12, MAX_SPLIT = 3 };
static const double NOTHING = 1.0e-6; // of a cell: less than this is rounding
static const double LEAST_ECHO = 1.0e-3;

static void append(WallBuffer *out, const WallParticle *particle)
{
  if (out->n == out->capacity) {
    const ptrdiff_t capacity = out->capacity ? 2 * out->capacity : 64;
    WallParticle *grown = realloc(out->particle, (size_t)capacity * sizeof *grown);
    if (!grown) {
      out->failed = true;
      return;
    }
    out->particle = grown;
    out->capacity = capacity;
  }
  out->particle[out->n++] = *particle;
}

/* Cavity wall, or outer face within reach of the rim of an opening. */
static bool bears_melt(const WallLattice *lattice, const SurfaceHit *foot)
{
  if (!lattice->surface->outer[foot->triangle]) return true;
  SurfaceHit rim;
  const NearestQuery query = {.reach = lattice->reach, .guess = -1, .cavity_only = true};
  return surface_nearest_query(lattice->surface, foot->foot, &query, &rim);
}

static void add_particle(const WallLattice *lattice, const int32_t cell[3], const CutPart *part, const SurfaceHit *foot,
                         bool echo, WallBuffer *out)
{
  WallParticle particle = {.volume = part->volume, .patch = foot->patch, .echo = echo};
  for (int k = 0; k < 3; k++) {
    particle.x[k] = part->moment[k] / part->volume;
    particle.cell[k] = cell[k];
  }
  vec_copy(foot->foot, particle.foot);
  vec_copy(foot->normal, particle.normal);
  particle.depth = fmax(sqrt(vec_distance2(particle.x, foot->foot)), 1.0e-3 * lattice->spacing);
  if (particle.depth <= lattice->reach && bears_melt(lattice, foot)) append(out, &particle);
}

/* A part whose centroid lies in the void (round a concave corner, on both sides of a slot) is halved until it does not:
 * no foot would be right for all of it. */
static void add_part(const WallLattice *lattice, const int32_t cell[3], const CutBox *box, const CutPart *part,
                     int level, const NearestQuery *near, WallBuffer *out)
{
  const double least = NOTHING * lattice->spacing * lattice->spacing * lattice->spacing;
  if (part->volume <= least) return;
  double x[3];
  for (int k = 0; k < 3; k++) x[k] = part->moment[k] / part->volume;
  SurfaceHit hit;
  NearestQuery query = *near;
  query.reach = lattice->reach + lattice->spacing;
  if (!surface_nearest_query(lattice->surface, x, &query, &hit)) return;
  query.guess = hit.triangle;
  if (hit.distance < 0.0 || level == MAX_SPLIT) {
    add_particle(lattice, cell, part, &hit, false, out);
    return;
  }
  for (int side = 0; side < 2; side++) {
    CutBox half = *box;
    *(side ? &half.low[level] : &half.high[level]) = 0.5 * (box->low[level] + box->high[level]);
    CutPart share;
    cut_box(lattice->surface, &half, NULL, &share);
    add_part(lattice, cell, &half, &share, level + 1, &query, out);
  }
}

static void lift(const SurfaceHit *foot, double height, double out[3])
{
  vec_axpy(height, foot->normal, foot->foot, out);
}

/* The sheet's foot for a particle at x near the point it was found for; the sheet's triangle stays. */
static void add_echo(const WallLattice *lattice, const int32_t cell[3], const CutPart *part, const SurfaceHit *sheet,
                     WallBuffer *out)
{
  double x[3];
  for (int k = 0; k < 3; k++) x[k] = part->moment[k] / part->volume;
  SurfaceHit foot = *sheet;
  FacetFeature feature;
  facet_closest(&lattice->surface->facet[sheet->triangle], x, foot.foot, &feature);
  add_particle(lattice, cell, part, &foot, true, out);
}

/* Is the foot in sight of one that is kept already? Then they belong to one side of the wall, and the nearer stands. */
static bool seen_from_kept(const Surface *surface, const double *lifted, double (*kept)[3], int n_kept)
{
  for (int k = 0; k < n_kept; k++)
    if (!surface_hides(surface, lifted, kept[k], NULL)) return true;
  return false;
}

/* The echoes in a cell: for each thin sheet that has the cell behind it within reach and does not see it,
 *   volume behind that sheet, less the mould's own part where that stands for the same sheet.
 * own: the mould's part of the cell; at: its centroid, or the cell's centre where it has none. */
static void add_echoes(const WallLattice *lattice, const int32_t cell[3], const CutBox *box, const CutPart *own,
                       const double at[3], WallBuffer *out)
{
  const Surface *s = lattice->surface;
  const double least = LEAST_ECHO * lattice->spacing * lattice->spacing * lattice->spacing;
  SurfaceHit feet[MAX_FEET], primary;
  const int n = surface_thin_feet(s, at, lattice->reach, feet, MAX_FEET);
  if (n == 0) return;
  const bool has_own = own->volume > least && surface_nearest(s, at, INFINITY, &primary) && primary.distance < 0.0;
  double kept[MAX_FEET][3];
  int n_kept = 0;
  for (int k = 0; k < n; k++) {
    const bool same = has_own && vec_distance2(feet[k].foot, primary.foot) < 1.0e-12 * s->reach * s->reach;
    double lifted[3], x[3];
    lift(&feet[k], 1.0e-3 * lattice->reach, lifted);
    if (!same && !surface_hides(s, lifted, at, has_own ? &primary : NULL)) continue;
    if (!same && seen_from_kept(s, lifted, kept, n_kept)) continue;
    CutPart part;
    cut_box(s, box, &feet[k], &part);
    if (same) cut_add(&part, -1.0, own);
    if (part.volume <= least) continue;
    for (int axis = 0; axis < 3; axis++) x[axis] = part.moment[axis] / part.volume;
    if (same && !surface_hides(s, lifted, x, NULL)) continue;
    add_echo(lattice, cell, &part, &feet[k], out);
    vec_copy(lifted, kept[n_kept++]);
  }
}

/* Void cells need to know only whether the surface passes through them; most of them learn here that it does not. */
static bool is_clear_void(const Surface *s, const double centre[3], double half_diagonal)
{
  int32_t at[3];
  grid_locate(&s->grid, centre, at);
  if (!grid_holds(&s->grid, at)) return true;
  const uint8_t flags = s->grid.flags[grid_index(&s->grid, at)];
  if (!(flags & CELL_OPEN) || (flags & CELL_NEAR_THIN)) return false;
  SurfaceHit hit;
  return !surface_nearest(s, centre, half_diagonal, &hit);
}

void wall_cell_fill(const WallLattice *lattice, const int32_t cell[3], const NearestQuery *near, WallBuffer *out)
{
  const double half_diagonal = 0.5 * sqrt(3.0) * lattice->spacing;
  CutBox box;
  double centre[3];
  for (int k = 0; k < 3; k++) {
    box.low[k] = lattice->origin[k] + cell[k] * lattice->spacing;
    box.high[k] = lattice->origin[k] + (cell[k] + 1) * lattice->spacing;
    centre[k] = lattice->origin[k] + (cell[k] + 0.5) * lattice->spacing;
  }
  if (is_clear_void(lattice->surface, centre, half_diagonal)) return;
  SurfaceHit hit;
  NearestQuery query = *near;
  query.reach = lattice->reach + half_diagonal;
  if (!surface_nearest_query(lattice->surface, centre, &query, &hit)) return;
  query.guess = hit.triangle;
  CutPart part = {0};
  if (hit.distance <= -half_diagonal) {
    cut_whole(&box, &part);
    add_particle(lattice, cell, &part, &hit, false, out); // its centroid is the centre: the foot is found
  } else if (hit.distance < half_diagonal) {
    cut_box(lattice->surface, &box, NULL, &part);
    add_part(lattice, cell, &box, &part, 0, &query, out);
  }
  if (!surface_thin_near(lattice->surface, centre)) return;
  if (part.volume > LEAST_ECHO * lattice->spacing * lattice->spacing * lattice->spacing)
    for (int k = 0; k < 3; k++) centre[k] = part.moment[k] / part.volume;
  add_echoes(lattice, cell, &box, &part, centre, out);
}
