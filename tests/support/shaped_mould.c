#include "tests/support/shaped_mould.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "tests/support/voxel_mould.h"

static int compare_doubles(const void *left, const void *right)
{
  const double a = *(const double *)left, b = *(const double *)right;
  return (a > b) - (a < b);
}

/* Lines of the grid along one axis: every face of a box, and what the cell size asks for between them. */
static double *make_lines(const ShapedMould *shape, int axis, size_t *cells)
{
  const size_t most = 2 * (size_t)shape->n_boxes + 2;
  double *breaks = synthetic_array(most, sizeof *breaks);
  size_t n = 0;
  breaks[n++] = shape->low[axis];
  breaks[n++] = shape->high[axis];
  for (int b = 0; b < shape->n_boxes; b++) {
    const double ends[2] = {shape->box[b].low[axis], shape->box[b].high[axis]};
    for (int k = 0; k < 2; k++)
      if (ends[k] > shape->low[axis] && ends[k] < shape->high[axis]) breaks[n++] = ends[k];
  }
  qsort(breaks, n, sizeof *breaks, compare_doubles);
  const double size = shape->high[axis] - shape->low[axis];
  double *lines = synthetic_array(n + (size_t)(size / shape->cell) + n + 2, sizeof *lines);
  *cells = 0;
  lines[0] = breaks[0];
  for (size_t k = 1; k < n; k++) {
    const double gap = breaks[k] - breaks[k - 1];
    if (gap < 1e-12 * size) continue;
    const size_t parts = (size_t)ceil(gap / shape->cell * (1.0 - 1e-9));
    for (size_t p = 1; p <= parts; p++)
      lines[++*cells] = p == parts ? breaks[k] : breaks[k - 1] + gap * (double)p / (double)parts;
  }
  free(breaks);
  return lines;
}

static void carve(VoxelMould *mould, const ShapedBox *box)
{
  size_t at[3];
  for (at[2] = 0; at[2] < mould->n[2]; at[2]++)
    for (at[1] = 0; at[1] < mould->n[1]; at[1]++)
      for (at[0] = 0; at[0] < mould->n[0]; at[0]++) {
        bool within = true;
        for (int d = 0; d < 3; d++) {
          const double centre = 0.5 * (mould->lines[d][at[d]] + mould->lines[d][at[d] + 1]);
          within = within && centre > box->low[d] && centre < box->high[d];
        }
        if (within) mould->solid[voxel_cell(mould, at[0], at[1], at[2])] = box->solid;
      }
}

static int32_t inner_or_outer(const void *context, const VoxelFace *face)
{
  (void)context;
  return face->inside ? 0 : 1;
}

RomData *shaped_mould_create(const ShapedMould *shape)
{
  size_t n[3];
  double *lines[3];
  for (int d = 0; d < 3; d++) lines[d] = make_lines(shape, d, &n[d]);
  VoxelMould mould = voxel_mould_create(n, lines);
  for (int b = 0; b < shape->n_boxes; b++) carve(&mould, &shape->box[b]);
  RomData *rom = synthetic_array(1, sizeof *rom);
  rom->m = 2;
  rom->patch = synthetic_array(2, sizeof *rom->patch);
  snprintf(rom->patch[0].name, ROM_NAME_LENGTH, "cavity/1");
  snprintf(rom->patch[0].surface, ROM_NAME_LENGTH, "cavity");
  snprintf(rom->patch[1].name, ROM_NAME_LENGTH, "outer");
  snprintf(rom->patch[1].surface, ROM_NAME_LENGTH, "outer");
  rom->patch[1].outer = true;
  voxel_mould_geometry(&mould, inner_or_outer, NULL, rom);
  voxel_mould_destroy(&mould);
  for (size_t p = 0; p < rom->n_points && shape->bend; p++) shape->bend(shape->context, rom->points + 3 * p);
  return rom;
}

void bend_turn(const void *context, double x[3])
{
  const Turn *turn = context; // Rodrigues
  const double c = cos(turn->angle), s = sin(turn->angle), *k = turn->axis;
  const double along = (k[0] * x[0] + k[1] * x[1] + k[2] * x[2]) * (1.0 - c);
  const double cross[3] = {k[1] * x[2] - k[2] * x[1], k[2] * x[0] - k[0] * x[2], k[0] * x[1] - k[1] * x[0]};
  for (int d = 0; d < 3; d++) x[d] = c * x[d] + s * cross[d] + along * k[d] + turn->shift[d];
}

/* Move x, whose largest component is `size`, along its ray so that |x| = size; less and less from a to b. */
static void round_off(const double ab[2], int dimensions, double x[3])
{
  double size = 0.0, square = 0.0;
  for (int d = 0; d < dimensions; d++) {
    size = fmax(size, fabs(x[d]));
    square += x[d] * x[d];
  }
  if (!(size > 0.0) || size >= ab[1]) return;
  const double share = size <= ab[0] ? 1.0 : (ab[1] - size) / (ab[1] - ab[0]);
  for (int d = 0; d < dimensions; d++) x[d] *= 1.0 + share * (size / sqrt(square) - 1.0);
}

void bend_ball(const void *a_and_b, double x[3])
{
  round_off(a_and_b, 3, x);
}

void bend_cylinder(const void *a_and_b, double x[3])
{
  round_off(a_and_b, 2, x);
}
