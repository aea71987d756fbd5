#include "cast/results/wall_maps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cast/particles/cells.h"
#include "common/vector.h"

const char *const wall_map_surface = "surface";
static const double REACH = 2.5, SUNK = 0.2, WET = 1.6; // spacings: of a mean; of melt that stands on the wall

static const VtkField OWN[WALL_MAPS_OWN] = {
    {"surface", "1", "number of the named cavity surface, in the order of the summary; -1: outer", 1, true},
    {"fill_time", "s", "when the melt first came; NaN: it did not", 1, false},
    {"front_temperature", "K", "of the melt that first came", 1, false},
    {"front_solid_fraction", "1", "of the melt that first came", 1, false},
    {"misrun", "1", "index: 1 dry, 0 the melt came liquid", 1, false},
    {"cold_shut", "1", "solid fraction where fronts met; NaN: elsewhere", 1, false},
};

static CastStatus allocate(const RomData *rom, WallMaps *maps, CastError *err)
{
  *maps = (WallMaps){0};
  memcpy(maps->field, OWN, sizeof OWN);
  for (int f = 0; f < FREEZING_FIELDS; f++) {
    const FreezingText *text = &freezing_texts[f];
    maps->field[WALL_MAPS_OWN + f] = (VtkField){text->name, text->units, text->description, 1, false};
  }
  for (int k = 0; k < WALL_MAPS; k++) {
    maps->values[k] = malloc((rom->n_triangles + 1) * sizeof(float));
    CAST_CHECK(maps->values[k], err, CAST_ERR_MEMORY, "no memory for maps of %zu triangles", rom->n_triangles);
    for (size_t t = 0; t < rom->n_triangles; t++)
      if (k == 0)
        ((int32_t *)maps->values[k])[t] = -1;
      else
        ((float *)maps->values[k])[t] = NAN;
  }
  return CAST_OK;
}

static int32_t surface_number(const WallMapsInput *in, int32_t triangle)
{
  const char *name = in->rom->patch[in->rom->triangle_patch[triangle]].surface;
  const CavityCells *cells = filling_cells(in->filling);
  for (size_t s = 0; s < cells->n_surfaces; s++)
    if (strcmp(cells->names[s], name) == 0) return (int32_t)s;
  return -1;
}

/* The largest cold-shut index of the cells at the triangle, NAN: none. */
static double cold_shut_at(const WallMapsInput *in, ptrdiff_t i)
{
  const CavityCells *cells = filling_cells(in->filling);
  double x[3], most = (double)NAN;
  vec_axpy(0.5 * cells->cell, arrival_triangle_normal(in->arrival, i), arrival_triangle_place(in->arrival, i), x);
  const ptrdiff_t cell = filling_cell_of(in->filling, x);
  for (int k = 0; k < 27 && cell >= 0; k++) {
    const ptrdiff_t j = filling_neighbour(in->filling, cell, (const int[3]){k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1});
    if (j >= 0) most = fmax(most, in->defects->cold_shut[j]);
  }
  return most;
}

typedef struct Before { // the melt before a triangle
  bool wet;
  double weight[FREEZING_FIELDS], sum[FREEZING_FIELDS];
} Before;

static void add_particle(const WallMapsInput *in, ptrdiff_t i, ptrdiff_t k, Before *before)
{
  const Particles *p = in->particles;
  const double x[3] = {p->x[0][k], p->x[1][k], p->x[2][k]};
  double way[3];
  vec_between(arrival_triangle_place(in->arrival, i), x, way);
  const double height = vec_dot(way, arrival_triangle_normal(in->arrival, i)) / in->spacing;
  const double r = vec_norm(way) / in->spacing, near = 1.0 - r / REACH;
  if (height < -SUNK || near <= 0.0) return;
  before->wet = before->wet || r < WET;
  for (int f = 0; f < FREEZING_FIELDS; f++) {
    const double value = freezing_value(in->freezing, (FreezingField)f, p->id[k]);
    if (isnan(value)) continue;
    before->weight[f] += near * near;
    before->sum[f] += near * near * value;
  }
}

static void set_triangle(const WallMapsInput *in, const Cells *cells, ptrdiff_t i, WallMaps *maps)
{
  const int32_t t = arrival_triangles(in->arrival)[i];
  CellRun run[CELLS_RUNS];
  Before before = {0};
  const int runs = cells_runs(cells, arrival_triangle_place(in->arrival, i), run);
  for (int r = 0; r < runs; r++)
    for (ptrdiff_t k = run[r].first; k < run[r].end; k++) add_particle(in, i, cells->order[k], &before);
  const double T = arrival_triangle_temperature(in->arrival, i);
  const bool freezes = in->melt->solid_fraction.n > 0;
  const double fs = isnan(T) ? T : freezes ? table_evaluate(&in->melt->solid_fraction, T) : 0.0;
  const double own[WALL_MAPS_OWN] = {0.0, arrival_triangle_time(in->arrival, i),    T,
                                     fs,  defects_misrun(in->melt, before.wet, fs), cold_shut_at(in, i)};
  ((int32_t *)maps->values[0])[t] = surface_number(in, t);
  for (int k = 1; k < WALL_MAPS_OWN; k++) ((float *)maps->values[k])[t] = (float)own[k];
  for (int f = 0; f < FREEZING_FIELDS; f++)
    if (before.weight[f] > 0.0)
      ((float *)maps->values[WALL_MAPS_OWN + f])[t] = (float)(before.sum[f] / before.weight[f]);
}

CastStatus wall_maps_create(const WallMapsInput *in, WallMaps *maps, CastError *err)
{
  Cells cells = {0};
  const double none[3] = {0.0, 0.0, 0.0};
  CastStatus status = allocate(in->rom, maps, err);
  if (status == CAST_OK)
    status = cells_sort(&cells, in->particles->n_fluid, in->particles->x, REACH * in->spacing, none, err);
  if (status == CAST_OK) {
#pragma omp parallel for schedule(dynamic, 64)
    for (ptrdiff_t i = 0; i < (ptrdiff_t)arrival_n_triangles(in->arrival); i++) set_triangle(in, &cells, i, maps);
  }
  cells_free(&cells);
  if (status != CAST_OK) wall_maps_free(maps);
  return status;
}

void wall_maps_free(WallMaps *maps)
{
  for (int k = 0; k < WALL_MAPS; k++) free(maps->values[k]);
  *maps = (WallMaps){0};
}
