#include "cast/results/defects.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/vector.h"

const double cold_shut_fraction = 0.1;
static const double FACING = 0.5; // cosine of 60 degrees

double defects_misrun(const Material *melt, bool filled, double front_fraction)
{
  if (!filled || isnan(front_fraction)) return 1.0;
  const double most = isnan(melt->coherency_fraction) ? 1.0 : melt->coherency_fraction;
  return fmin(front_fraction / most, 1.0);
}

/* ---- fronts that meet ---- */

/* Which way the front ran through each cell: the gradient of the arrival time over the cells around, [3*n]; zero where
 * too few are known. Least squares, so that the raggedness of single cells evens out. */
static void set_directions(const Filling *filling, const Arrival *arrival, double *direction)
{
  const CavityCells *cells = filling_cells(filling);
#pragma omp parallel for schedule(dynamic, 256)
  for (ptrdiff_t i = 0; i < cells->n; i++) {
    double *run = direction + 3 * i;
    for (int k = 0; k < 27; k++) {
      const int step[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
      const ptrdiff_t j = filling_neighbour(filling, i, step);
      if (j < 0 || j == i) continue;
      const double later = arrival_cell_time(arrival, j) - arrival_cell_time(arrival, i);
      for (int d = 0; d < 3 && !isnan(later); d++) run[d] += later * step[d];
    }
    vec_normalise(run);
  }
}

/* Did the front on the side `step` of cell i run towards it? */
static bool comes_from(const Filling *filling, const Arrival *arrival, const double *direction, ptrdiff_t i,
                       const int step[3])
{
  const ptrdiff_t j = filling_neighbour(filling, i, step);
  if (j < 0 || !(arrival_cell_time(arrival, j) < arrival_cell_time(arrival, i))) return false;
  const double way[3] = {-step[0], -step[1], -step[2]};
  return vec_dot(direction + 3 * j, way) > FACING * vec_norm(way);
}

static bool fronts_meet(const Filling *filling, const Arrival *arrival, const double *direction, ptrdiff_t i)
{
  for (int k = 0; k < 13; k++) { // one of each two opposite directions
    const int step[3] = {2 * (k % 3 - 1), 2 * (k / 3 % 3 - 1), 2 * (k / 9 - 1)};
    const int back[3] = {-step[0], -step[1], -step[2]};
    if (comes_from(filling, arrival, direction, i, step) && comes_from(filling, arrival, direction, i, back))
      return true;
  }
  return false;
}

CastStatus defects_find(const Filling *filling, const Arrival *arrival, const Material *melt, Defects *defects,
                        CastError *err)
{
  const ptrdiff_t n = filling_cells(filling)->n;
  const bool freezes = melt->solid_fraction.n > 0;
  *defects = (Defects){.n = n};
  double *room = malloc((3 * (size_t)n + 1) * sizeof *room), *direction = calloc(3 * (size_t)n + 1, sizeof *direction);
  if (!room || !direction) {
    free(room);
    free(direction);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory to look for defects in %td cells", n);
  }
  defects->front_fraction = room;
  defects->misrun = room + n;
  defects->cold_shut = room + 2 * n;
  set_directions(filling, arrival, direction);
#pragma omp parallel for schedule(dynamic, 256)
  for (ptrdiff_t i = 0; i < n; i++) {
    const double T = arrival_cell_temperature(arrival, i);
    const double fs = isnan(T) ? T : freezes ? table_evaluate(&melt->solid_fraction, T) : 0.0;
    defects->front_fraction[i] = fs;
    defects->misrun[i] = defects_misrun(melt, filling_cell_is_filled(filling, i), fs);
    defects->cold_shut[i] = fronts_meet(filling, arrival, direction, i) ? fs : (double)NAN;
  }
  free(direction);
  return CAST_OK;
}

void defects_free(Defects *defects)
{
  free(defects->front_fraction);
  *defects = (Defects){0};
}

FeatureDefects defects_of_feature(const Filling *filling, const Arrival *arrival, const Defects *defects,
                                  size_t feature)
{
  const CavityCells *cells = filling_cells(filling);
  FeatureDefects f = {.front_coldest = (double)NAN, .cold_shut = (double)NAN};
  double volume = 0.0;
  for (ptrdiff_t i = 0; i < cells->n; i++) {
    if (!filling_cell_is_in(filling, i, feature)) continue;
    const double share = cells->volume[i];
    volume += share;
    f.misrun += share * defects->misrun[i];
    f.unfilled += filling_cell_is_filled(filling, i) ? 0.0 : share;
    f.front_coldest = fmin(f.front_coldest, arrival_cell_temperature(arrival, i)); // fmin passes NAN over
    f.front_solid = fmax(f.front_solid, defects->front_fraction[i]);
    const double shut = defects->cold_shut[i];
    if (shut >= cold_shut_fraction) f.cold_shut_volume += share;
    if (isnan(shut) || shut <= f.cold_shut) continue;
    f.cold_shut = shut;
    for (int d = 0; d < 3; d++) f.cold_shut_at[d] = cells->x[d][i];
  }
  if (volume > 0.0) f.misrun /= volume;
  if (volume > 0.0) f.unfilled /= volume;
  return f;
}
