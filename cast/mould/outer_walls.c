/* outer_walls.c
 * Method  Linearly implicit: with D = -dQ/dT at T, T_free the temperature at the step's end without Q, and
 *         G(dt) = B^T phi B between the walls' own patches, T_end = T_free + G Q and Q = Q(T) - D (T_end - T):
 *         (1 + D G) Q = Q(T) - D (T_free - T). D may be negative (less cooling than in K); 1 + D G stays regular, for K
 * + B D B^T is positive semi-definite as long as the whole coefficient is not negative. */
#include "cast/mould/outer_walls.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double STEFAN_BOLTZMANN = 5.670374419e-8; // W/(m2 K4), exact since 2019

typedef struct Wall {
  size_t patch;
  double area, h, h_reference, ambient, reference, emissivity;
} Wall;

struct OuterWalls {
  const RomData *rom;
  const char *input; // borrowed, while the walls are made
  size_t n;
  Wall *wall;
  double *B;      // [r*n] row-major: the patches' columns
  double dt;      // s, of G
  double *G;      // [n*n] K/W
  double *matrix; // [n*(n + 1)]
};

/* ---- life ---- */

static CastStatus no_such_surface(const RomData *rom, const char *where, const OuterWall *given, CastError *err)
{
  char names[1024] = "";
  for (size_t l = 0; l < rom->m; l++)
    if (rom->patch[l].outer && (l == 0 || strcmp(rom->patch[l].surface, rom->patch[l - 1].surface) != 0) &&
        strlen(names) + ROM_NAME_LENGTH + 3 < sizeof names) {
      if (names[0]) strcat(names, ", ");
      strcat(names, rom->patch[l].surface);
    }
  return cast_error_set(err, CAST_ERR_INPUT, "%swalls.%s: the ROM has no outer surface of this name; it has %s", where,
                        given->surface, names[0] ? names : "none at all");
}

static bool is_on(const RomPatch *patch, const OuterWall *given)
{
  return patch->outer && strcmp(patch->surface, given->surface) == 0;
}

static size_t count_patches(const RomData *rom, const OuterWall *given)
{
  size_t n = 0;
  for (size_t l = 0; l < rom->m; l++) n += is_on(&rom->patch[l], given);
  return n;
}

/* The walls of all patches of a surface, from wall[*next] on. */
static CastStatus fill_surface(OuterWalls *walls, const OuterWall *given, double ambient, size_t *next, CastError *err)
{
  const RomData *rom = walls->rom;
  char where[4200] = "";
  if (walls->input) snprintf(where, sizeof where, "%.4096s:%d: ", walls->input, given->line);
  if (count_patches(rom, given) == 0) return no_such_surface(rom, where, given, err);
  for (size_t l = 0; l < rom->m; l++) {
    const RomPatch *patch = &rom->patch[l];
    if (!is_on(patch, given)) continue;
    CAST_CHECK(!patch->fixed, err, CAST_ERR_INPUT,
               "%swalls.%s: the surface has a fixed temperature in the ROM, as a coefficient of %.3g W/(m2 K): another "
               "condition would be the difference of two large numbers. Make the ROM with type: robin there",
               where, given->surface, patch->h);
    walls->wall[(*next)++] = (Wall){.patch = l,
                                    .area = patch->area,
                                    .h = isnan(given->h) ? patch->h : given->h,
                                    .h_reference = patch->h,
                                    .ambient = isnan(given->ambient) ? ambient : given->ambient,
                                    .reference = ambient,
                                    .emissivity = given->emissivity};
  }
  return CAST_OK;
}

static CastStatus fill(OuterWalls *walls, size_t n_given, const OuterWall *given, double ambient, CastError *err)
{
  const RomData *rom = walls->rom;
  size_t n = 0, next = 0;
  for (size_t i = 0; i < n_given; i++) n += count_patches(rom, &given[i]);
  walls->n = n;
  walls->wall = calloc(n + 1, sizeof *walls->wall);
  walls->B = malloc((rom->r * n + 1) * sizeof *walls->B);
  walls->G = malloc((n * n + 1) * sizeof *walls->G);
  walls->matrix = malloc((n * (n + 1) + 1) * sizeof *walls->matrix);
  CAST_CHECK(walls->wall && walls->B && walls->G && walls->matrix, err, CAST_ERR_MEMORY,
             "no memory for %zu outer walls", n);
  for (size_t i = 0; i < n_given; i++) CAST_CALL(fill_surface(walls, &given[i], ambient, &next, err));
  for (size_t k = 0; k < rom->r; k++)
    for (size_t i = 0; i < n; i++) walls->B[k * n + i] = rom->B[k * rom->m + walls->wall[i].patch];
  return CAST_OK;
}

CastStatus outer_walls_create(const RomData *rom, size_t n, const OuterWall *wall, const char *input, double ambient,
                              OuterWalls **out, CastError *err)
{
  OuterWalls *walls = *out = calloc(1, sizeof *walls);
  CAST_CHECK(walls, err, CAST_ERR_MEMORY, "no memory");
  walls->rom = rom;
  walls->input = input;
  walls->dt = -1.0;
  const CastStatus status = fill(walls, n, wall, ambient, err);
  if (status != CAST_OK) outer_walls_destroy(out);
  return status;
}

void outer_walls_destroy(OuterWalls **walls)
{
  if (!walls || !*walls) return;
  free((*walls)->wall);
  free((*walls)->B);
  free((*walls)->G);
  free((*walls)->matrix);
  free(*walls);
  *walls = NULL;
}

size_t outer_walls_n(const OuterWalls *walls)
{
  return walls->n;
}

size_t outer_walls_patch(const OuterWalls *walls, size_t i)
{
  return walls->wall[i].patch;
}

/* ---- flows ---- */

static void set_step(OuterWalls *walls, double dt, const double *of_mode)
{
  const size_t n = walls->n;
  if (dt == walls->dt) return;
  memset(walls->G, 0, n * n * sizeof *walls->G);
  for (size_t k = 0; k < walls->rom->r; k++) {
    const double phi = of_mode[k], *row = walls->B + k * n;
    for (size_t i = 0; i < n; i++)
      for (size_t j = 0; j < n; j++) walls->G[i * n + j] += phi * row[i] * row[j];
  }
  walls->dt = dt;
}

/* Q at T, and how it falls with T, W/K. */
static double flow_at(const Wall *wall, double T, double *slope)
{
  const double radiation = wall->emissivity * STEFAN_BOLTZMANN, T3 = T * T * T, a = wall->ambient;
  *slope = wall->area * (wall->h - wall->h_reference + 4.0 * radiation * T3);
  return wall->area *
         (wall->h * (a - T) + radiation * (a * a * a * a - T3 * T) - wall->h_reference * (wall->reference - T));
}

/* Gauss with row pivoting on [n x n+1]; a handful of patches, tens at most. */
static void eliminate(double *A, size_t n)
{
  const size_t width = n + 1;
  for (size_t p = 0; p < n; p++) {
    size_t best = p;
    for (size_t i = p + 1; i < n; i++)
      if (fabs(A[i * width + p]) > fabs(A[best * width + p])) best = i;
    for (size_t j = 0; j < width && best != p; j++) {
      const double swap = A[p * width + j];
      A[p * width + j] = A[best * width + j];
      A[best * width + j] = swap;
    }
    for (size_t i = 0; i < n; i++) {
      if (i == p) continue;
      const double factor = A[i * width + p] / A[p * width + p];
      for (size_t j = p; j < width; j++) A[i * width + j] -= factor * A[p * width + j];
    }
  }
}

void outer_walls_flows(OuterWalls *walls, const OuterStep *step, double *flow)
{
  const size_t n = walls->n, width = n + 1;
  set_step(walls, step->dt, step->phi);
  for (size_t i = 0; i < n; i++) {
    double slope, *row = walls->matrix + i * width;
    const double T = step->T[walls->wall[i].patch];
    row[n] = flow_at(&walls->wall[i], T, &slope);
    row[n] -= slope * (step->T_free[i] - T);
    for (size_t j = 0; j < n; j++) row[j] = slope * walls->G[i * n + j] + (i == j ? 1.0 : 0.0);
  }
  eliminate(walls->matrix, n);
  for (size_t i = 0; i < n; i++) flow[i] = walls->matrix[i * width + n] / walls->matrix[i * width + i];
}
