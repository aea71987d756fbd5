/* The box mould's shape: flat faces of cavity and pin, cut into a grid of patches, carved out of a block of cells. */
#include "tests/support/synthetic_box.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FLOOR, WALL_X0, WALL_X1, WALL_Y0, WALL_Y1, BOTTOM, PIN_X0, PIN_X1, PIN_Y0, PIN_Y1 };

static void set_face(Box *box, int number, int axis, const double low[3], const double high[3])
{
  Face *face = &box->face[number];
  face->axis = axis;
  for (int d = 0; d < 3; d++) {
    face->low[d] = low[d];
    face->high[d] = high[d];
  }
  const double size = box->given.patch_size;
  for (int d = 0; d < 2; d++) {
    const int along = (axis + 1 + d) % 3;
    face->grid[d] = size > 0.0 ? (size_t)fmax(1.0, round((high[along] - low[along]) / size)) : 1;
  }
  face->first = box->n_grid;
  box->n_grid += face->grid[0] * face->grid[1];
}

/* Floor (or bottom) and four walls of the box low..high, numbered from `number`. */
static void set_faces(Box *box, int number, const double low[3], const double high[3])
{
  const double ground[3] = {high[0], high[1], low[2]};
  set_face(box, number, 2, low, ground);
  for (int axis = 0; axis < 2; axis++)
    for (int side = 0; side < 2; side++) {
      double from[3] = {low[0], low[1], low[2]}, to[3] = {high[0], high[1], high[2]};
      from[axis] = to[axis] = side ? high[axis] : low[axis];
      set_face(box, number + 1 + 2 * axis + side, axis, from, to);
    }
}

static void list_faces(Box *box)
{
  const SyntheticBox *given = &box->given;
  const double *cavity = given->cavity;
  const double low[3] = {-0.5 * cavity[0], -0.5 * cavity[1], -cavity[2]},
               high[3] = {0.5 * cavity[0], 0.5 * cavity[1], 0};
  set_faces(box, FLOOR, low, high);
  if (given->pin_depth <= 0.0) return;
  const double half = 0.5 * given->pin_width;
  set_faces(box, BOTTOM, (double[3]){-half, -half, -cavity[2] - given->pin_depth}, (double[3]){half, half, -cavity[2]});
}

/* The number, among the grid cells of all faces, of the one that holds this piece of the boundary. */
static size_t grid_cell(const Box *box, const VoxelFace *piece)
{
  const SyntheticBox *given = &box->given;
  const double z = 0.5 * (piece->low[2] + piece->high[2]), ground = -given->cavity[2];
  const bool pin = given->pin_depth > 0.0 && z < ground - 1e-9 * given->cavity[2];
  // the mould looks at the cavity: on the wall at low x it looks along +x
  const int number = piece->axis == 2 ? FLOOR : WALL_X0 + 2 * piece->axis + (piece->sign < 0);
  const Face *face = &box->face[number + (pin ? BOTTOM : 0)];
  size_t at[2];
  for (int d = 0; d < 2; d++) {
    const int along = (face->axis + 1 + d) % 3;
    const double middle = 0.5 * (piece->low[along] + piece->high[along]);
    const double part = (middle - face->low[along]) / (face->high[along] - face->low[along]);
    at[d] = (size_t)(part * (double)face->grid[d]);
    if (at[d] >= face->grid[d]) at[d] = face->grid[d] - 1;
  }
  return face->first + at[0] + face->grid[0] * at[1];
}

static int32_t box_patch(const void *context, const VoxelFace *piece)
{
  const Box *box = context;
  if (piece->inside) return box->patch_of[grid_cell(box, piece)];
  return (int32_t)box->n_cavity + (piece->axis == 2 && piece->sign > 0 ? 0 : 1);
}

/* Lines from a to b: no step above `cell`; with growth, steps get longer away from the end that is marked fine. */
static void add_lines(double *lines, size_t *n, double to, double cell, int fine_end, double fine_width)
{
  const double from = lines[*n];
  if (to - from <= 0.0) return;
  double steps[512], sum = 0.0, step = cell;
  size_t count = 0;
  while (sum < (to - from) * (1.0 - 1e-9) && count < 512) {
    if (fine_end != 0 && sum >= fine_width) step *= 1.4;
    steps[count++] = step;
    sum += step;
  }
  for (size_t i = 0; i < count; i++) {
    const double share = steps[fine_end < 0 ? i : fine_end > 0 ? count - 1 - i : i] * (to - from) / sum;
    lines[*n + 1] = i + 1 == count ? to : lines[*n] + share;
    ++*n;
  }
}

static double *box_lines(const Box *box, int axis, size_t *n)
{
  const SyntheticBox *given = &box->given;
  const double cell = given->cell, fine = given->band + cell;
  double *lines = synthetic_array(4096, sizeof(double));
  *n = 0;
  const double pin = given->pin_depth > 0.0 ? 0.5 * given->pin_width : 0.0;
  if (axis == 2) {
    lines[0] = -given->outer[2];
    add_lines(lines, n, -given->cavity[2] - given->pin_depth, cell, 1, fine);
    add_lines(lines, n, -given->cavity[2], cell, 0, 0.0);
    add_lines(lines, n, 0.0, cell, 0, 0.0);
    return lines;
  }
  lines[0] = -0.5 * given->outer[axis];
  add_lines(lines, n, -0.5 * given->cavity[axis], cell, 1, fine);
  add_lines(lines, n, -pin, cell, 0, 0.0);
  add_lines(lines, n, pin, cell, 0, 0.0);
  add_lines(lines, n, 0.5 * given->cavity[axis], cell, 0, 0.0);
  add_lines(lines, n, 0.5 * given->outer[axis], cell, -1, fine);
  return lines;
}

static double interval_gap(double low, double high, double from, double to)
{
  return fmax(0.0, fmax(from - high, low - to));
}

double box_gap(const double low[3], const double high[3], const double from[3], const double to[3])
{
  double square = 0.0;
  for (int d = 0; d < 3; d++) {
    const double gap = interval_gap(low[d], high[d], from[d], to[d]);
    square += gap * gap;
  }
  return sqrt(square);
}

static bool within(const double x[3], const double from[3], const double to[3])
{
  for (int d = 0; d < 3; d++)
    if (x[d] < from[d] || x[d] > to[d]) return false;
  return true;
}

static void carve_cell(const Box *box, VoxelMould *mould, const size_t at[3])
{
  const SyntheticBox *given = &box->given;
  const double half = 0.5 * given->pin_width, ground = -given->cavity[2];
  const double cavity_low[3] = {-0.5 * given->cavity[0], -0.5 * given->cavity[1], ground};
  const double cavity_high[3] = {0.5 * given->cavity[0], 0.5 * given->cavity[1], 0.0};
  const double pin_low[3] = {-half, -half, ground - given->pin_depth}, pin_high[3] = {half, half, ground};
  double low[3], high[3], middle[3];
  for (int d = 0; d < 3; d++) {
    low[d] = mould->lines[d][at[d]];
    high[d] = mould->lines[d][at[d] + 1];
    middle[d] = 0.5 * (low[d] + high[d]);
  }
  const bool pin = given->pin_depth > 0.0;
  const size_t cell = voxel_cell(mould, at[0], at[1], at[2]);
  mould->solid[cell] = !within(middle, cavity_low, cavity_high) && !(pin && within(middle, pin_low, pin_high));
  double gap = box_gap(low, high, cavity_low, cavity_high);
  if (pin) gap = fmin(gap, box_gap(low, high, pin_low, pin_high));
  mould->band[cell] = mould->solid[cell] && gap < given->band * (1.0 - 1e-9);
}

static VoxelMould carve(const Box *box)
{
  size_t n[3], at[3];
  double *lines[3];
  for (int d = 0; d < 3; d++) lines[d] = box_lines(box, d, &n[d]);
  VoxelMould mould = voxel_mould_create(n, lines);
  for (at[2] = 0; at[2] < n[2]; at[2]++)
    for (at[1] = 0; at[1] < n[1]; at[1]++)
      for (at[0] = 0; at[0] < n[0]; at[0]++) carve_cell(box, &mould, at);
  return mould;
}

static int32_t note_grid_cell(const void *context, const VoxelFace *piece)
{
  const Box *box = context;
  if (piece->inside) box->patch_of[grid_cell(box, piece)] = 1;
  return 0;
}

/* Number the grid cells that own some boundary, face by face. */
static void number_patches(Box *box, const VoxelMould *mould)
{
  box->patch_of = synthetic_array(box->n_grid, sizeof(int32_t));
  RomData scratch = {.m = 1, .patch = synthetic_array(1, sizeof(RomPatch))};
  voxel_mould_geometry(mould, note_grid_cell, box, &scratch);
  free(scratch.patch);
  free(scratch.points);
  free(scratch.triangles);
  free(scratch.triangle_patch);
  free(scratch.tetrahedra);
  for (size_t g = 0; g < box->n_grid; g++) box->patch_of[g] = box->patch_of[g] ? (int32_t)box->n_cavity++ : -1;
}

static void name_patches(Box *box, RomData *rom)
{
  const size_t first_pin = box->given.pin_depth > 0.0 ? box->face[BOTTOM].first : box->n_grid;
  rom->m = box->n_cavity + 2;
  rom->patch = synthetic_array(rom->m, sizeof(RomPatch));
  size_t count[2] = {0, 0};
  for (size_t g = 0; g < box->n_grid; g++) {
    if (box->patch_of[g] < 0) continue;
    RomPatch *patch = &rom->patch[box->patch_of[g]];
    const char *surface = g >= first_pin ? "pin" : "cavity";
    snprintf(patch->surface, ROM_NAME_LENGTH, "%s", surface);
    snprintf(patch->name, ROM_NAME_LENGTH, "%s/%zu", surface, ++count[g >= first_pin]);
  }
  for (size_t l = box->n_cavity; l < rom->m; l++) {
    rom->patch[l].outer = true;
    snprintf(rom->patch[l].name, ROM_NAME_LENGTH, "%s", l == box->n_cavity ? "rim" : "outside");
    snprintf(rom->patch[l].surface, ROM_NAME_LENGTH, "%s", l == box->n_cavity ? "rim" : "outside");
  }
  rom->patch[rom->m - 1].h = box->given.h_outside;
}

VoxelMould box_shape(Box *box, RomData *rom)
{
  list_faces(box);
  VoxelMould mould = carve(box);
  number_patches(box, &mould);
  name_patches(box, rom);
  voxel_mould_geometry(&mould, box_patch, box, rom);
  return mould;
}
