/* synthetic_box.c - a box mould with a box cavity and a network of heat capacities behind its patches.
 * Each cavity patch of area A has a column of n nodes at depths i delta, delta = reach/n, with the heat capacities
 * rho c A delta (half of it for the first) and the conductances kappa A/delta; the node beyond the last is shared by
 * all columns, holds the rest of the mould's heat capacity and loses h A_outside. With E diagonal the modes are those
 * of E^-1/2 K E^-1/2, found by Jacobi rotations; no mode is left out, so constant^T B = 1 holds to rounding. */
#include "tests/support/synthetic_box.h"

#include <math.h>
#include <stdlib.h>

#include "tests/support/symmetric_eigen.h"

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
  VoxelMould mould = box_shape(&box, made);
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
