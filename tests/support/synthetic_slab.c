/* synthetic_slab.c - the exact modes of a slab, insulated at its sides, heated on top (z = 0), Robin or insulated
 * below. phi_ijk = cos(i pi x/Lx) cos(j pi y/Ly) cos(mu_k z/L)/sqrt(C n_i n_j n_k),  C = rho c Lx Ly L, n the mean
 * squares lambda_ijk = alpha ((i pi/Lx)^2 + (j pi/Ly)^2 + (mu_k/L)^2) What the modes in depth leave over of the
 * constant, w = 1 - sum_k c_k phi_00k, is E- and K-orthogonal to each of them (phi^T K w = lambda phi^T E w = 0), so it
 * is one more state, with lambda_w = w^T K 1/w^T E w = h A w(-L)/|w|^2. */
#include "tests/support/synthetic_rom.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/support/assert_ok.h"
#include "tests/support/voxel_mould.h"

typedef struct Mode {
  size_t i, j, k; // k == modes in depth: the rest w
  double lambda;
} Mode;

typedef struct Slab {
  SyntheticSlab given; // with defaults filled in
  double capacity;     // J/K
  double *mu;          // [modes]
  double *mean_square; // [modes] of cos(mu z/L) over the depth
  double rest_square;  // |w|^2, J/K; 0: none
  size_t r;
  Mode *mode; // [r] ascending
} Slab;

static double sinc(double x)
{
  return x == 0.0 ? 1.0 : sin(x) / x;
}

/* mu tan mu = biot in [k pi, k pi + pi/2] */
static double robin_root(size_t k, double biot)
{
  double low = (double)k * M_PI, high = low + M_PI_2;
  const double side = k % 2 ? -1.0 : 1.0;
  for (int step = 0; step < 200; step++) {
    const double middle = 0.5 * (low + high);
    if (side * (middle * sin(middle) - biot * cos(middle)) < 0.0)
      low = middle;
    else
      high = middle;
  }
  return 0.5 * (low + high);
}

static double depth_mean_square(double mu)
{
  return mu == 0.0 ? 1.0 : 0.5 + sin(2.0 * mu) / (4.0 * mu);
}

/* |w|^2 = sum of c_k^2 over the modes left out: terms fall as k^-4, the far tail by its integral. */
static double rest_square(size_t modes, double biot, double capacity)
{
  const size_t last = 64 * modes + 1024;
  double sum = 0.0, term = 0.0;
  for (size_t k = modes; k < last; k++) {
    const double mu = robin_root(k, biot);
    term = capacity * sinc(mu) * sinc(mu) / depth_mean_square(mu);
    sum += term;
  }
  return sum + term * (double)last / 3.0;
}

static double rest_value(const Slab *slab, double z) // w(z)
{
  double sum = 0.0;
  for (size_t k = 0; k < slab->given.modes; k++)
    sum += sinc(slab->mu[k]) / slab->mean_square[k] * cos(slab->mu[k] * z / slab->given.depth);
  return 1.0 - sum;
}

static double depth_value(const Slab *slab, size_t k, double z) // of an E-normalised mode, but for the lateral factors
{
  if (k == slab->given.modes) return rest_value(slab, z) / sqrt(slab->rest_square);
  return cos(slab->mu[k] * z / slab->given.depth) / sqrt(slab->capacity * slab->mean_square[k]);
}

static double depth_mean(const Slab *slab, size_t k)
{
  if (k == slab->given.modes) return sqrt(slab->rest_square) / slab->capacity;
  return sinc(slab->mu[k]) / sqrt(slab->capacity * slab->mean_square[k]);
}

static double lateral_value(size_t i, double x, double size)
{
  return i == 0 ? 1.0 : M_SQRT2 * cos((double)i * M_PI * x / size);
}

/* Mean of the lateral factor over part p of n equal parts. */
static double lateral_mean(size_t i, size_t p, size_t n)
{
  if (i == 0) return 1.0;
  const double a = (double)i * M_PI * (double)p / (double)n, b = (double)i * M_PI * (double)(p + 1) / (double)n;
  return M_SQRT2 * (sin(b) - sin(a)) / (b - a);
}

static int compare_modes(const void *left, const void *right)
{
  const Mode *a = left, *b = right;
  if (a->lambda != b->lambda) return a->lambda < b->lambda ? -1 : 1;
  if (a->k != b->k) return a->k < b->k ? -1 : 1;
  if (a->j != b->j) return a->j < b->j ? -1 : 1;
  return (a->i > b->i) - (a->i < b->i);
}

static void fill_defaults(SyntheticSlab *given)
{
  for (int d = 0; d < 2; d++) {
    if (given->modes_lateral[d] == 0) given->modes_lateral[d] = 1;
    if (given->patches[d] == 0) given->patches[d] = 1;
    if (given->cells[d] == 0) given->cells[d] = 2;
  }
  if (given->band == 0.0) given->band = 0.25 * given->depth;
  if (given->band_layers == 0) given->band_layers = 8;
  if (given->growth == 0.0) given->growth = 1.0;
}

static void solve_depth(Slab *slab)
{
  const SyntheticSlab *given = &slab->given;
  const double biot = given->h_bottom * given->depth / given->kappa;
  slab->mu = synthetic_array(given->modes, sizeof(double));
  slab->mean_square = synthetic_array(given->modes, sizeof(double));
  for (size_t k = 0; k < given->modes; k++) {
    slab->mu[k] = biot > 0.0 ? robin_root(k, biot) : (double)k * M_PI;
    slab->mean_square[k] = depth_mean_square(slab->mu[k]);
  }
  slab->rest_square = biot > 0.0 ? rest_square(given->modes, biot, slab->capacity) : 0.0;
}

static void list_modes(Slab *slab)
{
  const SyntheticSlab *given = &slab->given;
  const double alpha = given->kappa / (given->rho * given->c);
  const size_t *lateral = given->modes_lateral;
  slab->mode = synthetic_array(lateral[0] * lateral[1] * given->modes + 1, sizeof(Mode));
  for (size_t k = 0; k < given->modes; k++)
    for (size_t j = 0; j < lateral[1]; j++)
      for (size_t i = 0; i < lateral[0]; i++) {
        const double wave[3] = {(double)i * M_PI / given->size[0], (double)j * M_PI / given->size[1],
                                slab->mu[k] / given->depth};
        slab->mode[slab->r++] = (Mode){i, j, k, alpha * (wave[0] * wave[0] + wave[1] * wave[1] + wave[2] * wave[2])};
      }
  if (slab->rest_square > 0.0) {
    const double loss = given->h_bottom * given->size[0] * given->size[1] * rest_value(slab, -given->depth);
    slab->mode[slab->r++] = (Mode){0, 0, given->modes, loss / slab->rest_square};
  }
  qsort(slab->mode, slab->r, sizeof(Mode), compare_modes);
}

static double side_mean(const Slab *slab, const Mode *mode)
{
  const double *size = slab->given.size;
  const double both_x = mode->j > 0 ? 0.0 : (mode->i == 0 ? 1.0 : mode->i % 2 ? 0.0 : M_SQRT2);
  const double both_y = mode->i > 0 ? 0.0 : (mode->j == 0 ? 1.0 : mode->j % 2 ? 0.0 : M_SQRT2);
  return (size[1] * both_x + size[0] * both_y) / (size[0] + size[1]) * depth_mean(slab, mode->k);
}

static void fill_state(const Slab *slab, size_t s, RomData *rom)
{
  const SyntheticSlab *given = &slab->given;
  const Mode *mode = &slab->mode[s];
  const bool uniform = mode->i == 0 && mode->j == 0;
  const double bottom = uniform ? depth_value(slab, mode->k, -given->depth) : 0.0;
  const double top = depth_value(slab, mode->k, 0.0);
  double *row = rom->B + s * rom->m;
  rom->lambda[s] = mode->lambda;
  rom->constant[s] = uniform ? slab->capacity * depth_mean(slab, mode->k) : 0.0;
  rom->ambient[s] = given->h_bottom * given->size[0] * given->size[1] * bottom;
  for (size_t q = 0; q < given->patches[1]; q++)
    for (size_t p = 0; p < given->patches[0]; p++)
      *row++ = top * lateral_mean(mode->i, p, given->patches[0]) * lateral_mean(mode->j, q, given->patches[1]);
  *row++ = bottom;
  *row = side_mean(slab, mode);
}

static void fill_model(const Slab *slab, RomData *rom)
{
  rom->r = slab->r;
  rom->lambda = synthetic_array(rom->r, sizeof(double));
  rom->constant = synthetic_array(rom->r, sizeof(double));
  rom->ambient = synthetic_array(rom->r, sizeof(double));
  rom->B = synthetic_array(rom->r * rom->m, sizeof(double));
  for (size_t s = 0; s < rom->r; s++) {
    fill_state(slab, s, rom);
    rom->heat_capacity += rom->constant[s] * rom->constant[s];
  }
}

static void fill_patches(const SyntheticSlab *given, RomData *rom)
{
  const size_t top = given->patches[0] * given->patches[1];
  rom->m = top + 2;
  rom->patch = synthetic_array(rom->m, sizeof(RomPatch));
  for (size_t l = 0; l < top; l++) {
    snprintf(rom->patch[l].name, ROM_NAME_LENGTH, "top/%zu", l + 1);
    snprintf(rom->patch[l].surface, ROM_NAME_LENGTH, "top");
  }
  for (size_t l = top; l < rom->m; l++) {
    rom->patch[l].outer = true;
    snprintf(rom->patch[l].name, ROM_NAME_LENGTH, "%s", l == top ? "bottom" : "sides");
    snprintf(rom->patch[l].surface, ROM_NAME_LENGTH, "%s", l == top ? "bottom" : "sides");
  }
  rom->patch[top].h = given->h_bottom;
}

static int32_t slab_patch(const void *context, const VoxelFace *face)
{
  const SyntheticSlab *given = context;
  const size_t *patches = given->patches;
  if (face->axis != 2) return (int32_t)(patches[0] * patches[1] + 1);
  if (face->sign < 0) return (int32_t)(patches[0] * patches[1]);
  size_t part[2];
  for (int d = 0; d < 2; d++)
    part[d] = (size_t)(0.5 * (face->low[d] + face->high[d]) / given->size[d] * (double)patches[d]);
  return (int32_t)(part[0] + patches[0] * part[1]);
}

/* Layers of the band, then layers growing by at least a half down to the bottom. */
static double *depth_lines(const SyntheticSlab *given, size_t *n)
{
  enum { MOST = 4096 };
  double heights[MOST], sum = 0.0, height = 1.0;
  size_t layers = given->band_layers < MOST / 2 ? given->band_layers : MOST / 2;
  for (size_t i = 0; i < layers; i++, height *= given->growth) sum += heights[i] = height;
  for (size_t i = 0; i < layers; i++) heights[i] *= given->band / sum;
  double reached = given->band, last = heights[layers - 1];
  while (given->depth - reached > 1e-9 * given->depth && layers < MOST) {
    last *= 1.5;
    const double left = given->depth - reached;
    heights[layers++] = left < 1.7 * last ? left : last;
    reached += heights[layers - 1];
  }
  double *lines = synthetic_array(layers + 1, sizeof(double));
  for (size_t i = 0; i < layers; i++) lines[layers - 1 - i] = lines[layers - i] - heights[i];
  lines[0] = -given->depth;
  *n = layers;
  return lines;
}

static VoxelMould slab_mould(const SyntheticSlab *given)
{
  size_t n[3];
  double *lines[3];
  for (int d = 0; d < 2; d++) {
    n[d] = given->patches[d] * given->cells[d];
    lines[d] = synthetic_array(n[d] + 1, sizeof(double));
    for (size_t i = 0; i <= n[d]; i++) lines[d][i] = given->size[d] * (double)i / (double)n[d];
  }
  lines[2] = depth_lines(given, &n[2]);
  VoxelMould mould = voxel_mould_create(n, lines);
  for (size_t k = n[2] - given->band_layers; k < n[2]; k++)
    for (size_t cell = 0; cell < n[0] * n[1]; cell++) mould.band[cell + n[0] * n[1] * k] = 1;
  return mould;
}

static void fill_basis(const Slab *slab, RomData *rom)
{
  const double *size = slab->given.size;
  rom->basis = synthetic_array(rom->n_points * rom->r, sizeof(float));
  for (size_t p = 0; p < rom->n_points; p++) {
    const double *x = rom->points + 3 * p;
    for (size_t s = 0; s < rom->r; s++) {
      const Mode *mode = &slab->mode[s];
      rom->basis[p * rom->r + s] = (float)(lateral_value(mode->i, x[0], size[0]) *
                                           lateral_value(mode->j, x[1], size[1]) * depth_value(slab, mode->k, x[2]));
    }
  }
}

CastStatus synthetic_rom_slab(const SyntheticSlab *given, RomData **rom, CastError *err)
{
  *rom = NULL;
  CAST_CHECK(given->size[0] > 0 && given->size[1] > 0 && given->depth > 0 && given->kappa > 0 && given->rho > 0 &&
                 given->c > 0 && given->h_bottom >= 0 && given->modes >= 1 && given->band <= given->depth &&
                 given->band_layers <= 2048,
             err, CAST_ERR_ARGUMENT, "a slab needs positive sizes and properties, a mode, and a band within its depth");
  Slab slab = {.given = *given};
  fill_defaults(&slab.given);
  slab.capacity = given->rho * given->c * given->size[0] * given->size[1] * given->depth;
  RomData *made = synthetic_array(1, sizeof *made);
  fill_patches(&slab.given, made);
  solve_depth(&slab);
  list_modes(&slab);
  fill_model(&slab, made);
  VoxelMould mould = slab_mould(&slab.given);
  voxel_mould_geometry(&mould, slab_patch, &slab.given, made);
  made->band = slab.given.band;
  fill_basis(&slab, made);
  synthetic_particulars(made, "synthetic slab", given->kappa, given->rho, given->c);
  voxel_mould_destroy(&mould);
  free(slab.mu);
  free(slab.mean_square);
  free(slab.mode);
  const CastStatus status = rom_check(made, err);
  if (status == CAST_OK)
    *rom = made;
  else
    rom_destroy(&made);
  return status;
}

RomData *synthetic_rom_small(void)
{
  static const SyntheticSlab slab = {.size = {2e-3, 1e-3},
                                     .depth = 5e-3,
                                     .kappa = 1.0,
                                     .rho = 1800.0,
                                     .c = 1100.0,
                                     .h_bottom = 15.0,
                                     .modes = 8,
                                     .modes_lateral = {2, 2},
                                     .patches = {2, 2}};
  CastError err = {0};
  RomData *rom = NULL;
  ok(synthetic_rom_slab(&slab, &rom, &err), &err);
  rom->certificate.n_times = rom->certificate.n_frequencies = rom->n_shifts = 1; // arrays of one zero
  return rom;
}
