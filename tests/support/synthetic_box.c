/* synthetic_box.c - a box mould with a box cavity and a network of heat capacities behind its patches.
 * Each cavity patch of area A has a column of n nodes at depths i delta, delta = reach/n, with the heat capacities
 * rho c A delta (half of it for the first) and the conductances kappa A/delta; the node beyond the last is shared by
 * all columns, holds the rest of the mould's heat capacity and loses h A_outside. With E diagonal the modes are those
 * of E^-1/2 K E^-1/2, found by Jacobi rotations; no mode is left out, so constant^T B = 1 holds to rounding. */
#include "tests/support/symmetric_eigen.h"
#include "tests/support/synthetic_rom.h"
#include "tests/support/voxel_mould.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FLOOR, WALL_X0, WALL_X1, WALL_Y0, WALL_Y1, BOTTOM, PIN_X0, PIN_X1, PIN_Y0, PIN_Y1, FACES };

typedef struct Face { // a flat part of the cavity wall, cut into a grid of patches
  double low[3], high[3];
  int axis;       // of its normal
  size_t grid[2]; // along the other two axes, in the order (axis + 1) % 3, (axis + 2) % 3
  size_t first;   // number of its first grid cell among those of all faces
} Face;

typedef struct Box {
  SyntheticBox given; // with defaults filled in
  Face face[FACES];
  size_t n_grid;     // grid cells of all faces
  int32_t *patch_of; // [n_grid] patch; -1: none (over the pin's hole)
  size_t n_cavity;   // cavity patches
  double *part;      // [n_cavity*6] low and high corner of each
  size_t n;          // nodes of the network
  double *E, *K, *V; // [n], [n*n], [n*n] rows: nodes, columns: modes
} Box;

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

/* Distance between the cell low..high and the box from..to. */
static double box_gap(const double low[3], const double high[3], const double from[3], const double to[3])
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

static void couple(Box *box, size_t a, size_t b, double conductance)
{
  box->K[a * box->n + a] += conductance;
  box->K[b * box->n + b] += conductance;
  box->K[a * box->n + b] -= conductance;
  box->K[b * box->n + a] -= conductance;
}

static void build_network(Box *box, const RomData *rom)
{
  const SyntheticBox *given = &box->given;
  const size_t nodes = given->nodes, core = box->n_cavity * nodes;
  const double delta = given->reach / (double)nodes, *outer = given->outer, *cavity = given->cavity;
  double rest = outer[0] * outer[1] * outer[2] - cavity[0] * cavity[1] * cavity[2] -
                given->pin_width * given->pin_width * given->pin_depth;
  box->n = core + 1;
  box->E = synthetic_array(box->n, sizeof(double));
  box->K = synthetic_array(box->n * box->n, sizeof(double));
  for (size_t l = 0; l < box->n_cavity; l++)
    for (size_t i = 0; i < nodes; i++) {
      const double volume = rom->patch[l].area * delta * (i == 0 ? 0.5 : 1.0);
      rest -= volume;
      box->E[l * nodes + i] = given->rho * given->c * volume;
      couple(box, l * nodes + i, i + 1 < nodes ? l * nodes + i + 1 : core, given->kappa * rom->patch[l].area / delta);
    }
  box->E[core] = given->rho * given->c * rest;
  box->K[core * box->n + core] += given->h_outside * rom->patch[rom->m - 1].area;
}

typedef struct Rank {
  double lambda;
  size_t column;
} Rank;

static int compare_ranks(const void *left, const void *right)
{
  const Rank *a = left, *b = right;
  if (a->lambda != b->lambda) return a->lambda < b->lambda ? -1 : 1;
  return (a->column > b->column) - (a->column < b->column);
}

/* Diagonalise: E-orthonormal modes in ascending order into box->V, and the model in their coordinates. */
static void fill_model(Box *box, RomData *rom)
{
  const size_t n = box->n, core = n - 1;
  double *U = synthetic_array(n * n, sizeof(double));
  Rank *rank = synthetic_array(n, sizeof *rank);
  box->V = synthetic_array(n * n, sizeof(double));
  for (size_t p = 0; p < n; p++)
    for (size_t q = 0; q < n; q++) box->K[p * n + q] /= sqrt(box->E[p] * box->E[q]);
  symmetric_eigenvectors(n, box->K, U);
  for (size_t k = 0; k < n; k++) rank[k] = (Rank){fmax(0.0, box->K[k * n + k]), k};
  qsort(rank, n, sizeof *rank, compare_ranks);
  rom->r = n;
  rom->lambda = synthetic_array(n, sizeof(double));
  rom->constant = synthetic_array(n, sizeof(double));
  rom->ambient = synthetic_array(n, sizeof(double));
  rom->B = synthetic_array(n * rom->m, sizeof(double));
  const double loss = box->given.h_outside * rom->patch[rom->m - 1].area;
  for (size_t k = 0; k < n; k++) {
    rom->lambda[k] = rank[k].lambda;
    for (size_t p = 0; p < n; p++) {
      box->V[p * n + k] = U[p * n + rank[k].column] / sqrt(box->E[p]);
      rom->constant[k] += box->V[p * n + k] * box->E[p];
    }
    rom->ambient[k] = loss * box->V[core * n + k];
    for (size_t l = 0; l < rom->m; l++)
      rom->B[k * rom->m + l] = box->V[(l < box->n_cavity ? l * box->given.nodes : core) * n + k];
  }
  for (size_t p = 0; p < n; p++) rom->heat_capacity += box->E[p];
  free(U);
  free(rank);
}

/* The nearest cavity patch: bounding boxes of flat patches are the patches. */
static size_t nearest_patch(const Box *box, const double x[3], double *distance)
{
  size_t nearest = 0;
  *distance = INFINITY;
  for (size_t l = 0; l < box->n_cavity; l++) {
    const double gap = box_gap(x, x, box->part + 6 * l, box->part + 6 * l + 3);
    if (gap >= *distance) continue;
    *distance = gap;
    nearest = l;
  }
  return nearest;
}

static void bound_patches(Box *box, const RomData *rom)
{
  box->part = synthetic_array(6 * box->n_cavity, sizeof(double));
  for (size_t l = 0; l < box->n_cavity; l++)
    for (int d = 0; d < 6; d++) box->part[6 * l + (size_t)d] = d < 3 ? INFINITY : -INFINITY;
  for (size_t t = 0; t < rom->n_triangles; t++) {
    const size_t l = (size_t)rom->triangle_patch[t];
    for (size_t k = 0; k < 3 && l < box->n_cavity; k++)
      for (size_t d = 0; d < 3; d++) {
        const double x = rom->points[3 * (size_t)rom->triangles[3 * t + k] + d];
        double *part = box->part + 6 * l;
        part[d] = fmin(part[d], x);
        part[d + 3] = fmax(part[d + 3], x);
      }
  }
}

/* Between two nodes of a column temperature is linear. */
static void fill_basis(Box *box, RomData *rom)
{
  const size_t n = box->n, nodes = box->given.nodes, core = n - 1;
  rom->basis = synthetic_array(rom->n_points * n, sizeof(float));
  bound_patches(box, rom);
  for (size_t p = 0; p < rom->n_points; p++) {
    double depth = 0.0;
    const size_t l = nearest_patch(box, rom->points + 3 * p, &depth);
    const double place = fmin(depth / box->given.reach, 1.0) * (double)nodes;
    const size_t i = place < (double)nodes ? (size_t)place : nodes - 1;
    const double share = place - (double)i;
    const double *here = box->V + (l * nodes + i) * n;
    const double *next = box->V + (i + 1 < nodes ? l * nodes + i + 1 : core) * n;
    for (size_t k = 0; k < n; k++) rom->basis[p * n + k] = (float)((1.0 - share) * here[k] + share * next[k]);
  }
}

static void fill_defaults(SyntheticBox *given)
{
  const double below = given->outer[2] - given->cavity[2] - given->pin_depth;
  const double beside = 0.5 * fmin(given->outer[0] - given->cavity[0], given->outer[1] - given->cavity[1]);
  if (given->nodes == 0) given->nodes = 6;
  if (given->reach == 0.0) given->reach = 0.25 * fmin(below, beside);
  if (given->band == 0.0) given->band = 3.0 * given->cell;
}

static CastStatus check_given(const SyntheticBox *given, CastError *err)
{
  for (int d = 0; d < 3; d++)
    CAST_CHECK(given->cavity[d] > 0.0 && given->outer[d] > given->cavity[d], err, CAST_ERR_ARGUMENT,
               "the mould must be larger than its cavity");
  CAST_CHECK(given->pin_depth >= 0.0 && (given->pin_depth == 0.0 || given->pin_width > 0.0) &&
                 given->pin_width < fmin(given->cavity[0], given->cavity[1]) &&
                 given->cavity[2] + given->pin_depth < given->outer[2],
             err, CAST_ERR_ARGUMENT, "the pin's hole must fit into the cavity's floor and the mould");
  CAST_CHECK(given->cell > 0.0 && fmax(given->outer[0], fmax(given->outer[1], given->outer[2])) < 400.0 * given->cell,
             err, CAST_ERR_ARGUMENT, "a cell of %g m is too small for this mould", given->cell);
  CAST_CHECK(given->kappa > 0.0 && given->rho > 0.0 && given->c > 0.0 && given->h_outside >= 0.0, err,
             CAST_ERR_ARGUMENT, "material properties must be positive");
  return CAST_OK;
}

CastStatus synthetic_rom_box_cavity(const SyntheticBox *given, RomData **rom, CastError *err)
{
  *rom = NULL;
  CAST_CALL(check_given(given, err));
  Box box = {.given = *given};
  fill_defaults(&box.given);
  RomData *made = synthetic_array(1, sizeof *made);
  list_faces(&box);
  VoxelMould mould = carve(&box);
  number_patches(&box, &mould);
  name_patches(&box, made);
  voxel_mould_geometry(&mould, box_patch, &box, made);
  made->band = box.given.band;
  build_network(&box, made);
  CastStatus status = CAST_OK;
  if (box.E[box.n - 1] > 0.0) {
    fill_model(&box, made);
    fill_basis(&box, made);
    synthetic_particulars(made, "synthetic box cavity", given->kappa, given->rho, given->c);
    status = rom_check(made, err);
  } else {
    status = cast_error_set(err, CAST_ERR_ARGUMENT, "the columns to the depth reach hold more than the whole mould");
  }
  voxel_mould_destroy(&mould);
  void *arrays[] = {box.patch_of, box.part, box.E, box.K, box.V};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++) free(arrays[i]);
  if (status == CAST_OK)
    *rom = made;
  else
    rom_destroy(&made);
  return status;
}
