/* sim_defects.c - where the casting may not be sound: maps for the files, numbers for the summary. */
#include <math.h>
#include <stdio.h>

#include "cast/results/cavity_results.h"
#include "cast/results/defects.h"
#include "cast/results/wall_maps.h"
#include "cast/sim/sim_private.h"

CastStatus sim_write_maps(Sim *sim, const char *results, MouldResults *mould, CastError *err)
{
  Defects defects;
  CAST_CALL(defects_find(sim->filling, sim->arrival, &sim->config->melt, &defects, err));
  CastStatus status = cavity_results_write(results, sim->filling, sim->arrival, &defects, err);
  if (status == CAST_OK && mould) {
    const WallMapsInput input = {sim->rom,     &sim->config->melt, &sim->particles, sim->config->spacing,
                                 sim->filling, sim->arrival,       &defects,        sim->freezing};
    WallMaps maps;
    status = wall_maps_create(&input, &maps, err);
    if (status == CAST_OK) {
      status = mould_results_set_maps(mould, WALL_MAPS, maps.field, maps.values, err);
      wall_maps_free(&maps);
    }
  }
  defects_free(&defects);
  return status;
}

void sim_print_defects(FILE *out, const Sim *sim)
{
  const Filling *f = sim->filling;
  Defects defects;
  CastError err;
  if (defects_find(f, sim->arrival, &sim->config->melt, &defects, &err) != CAST_OK) return;
  fputs("Soundness     unfilled  misrun index  coldest front  solid in it  cold shut  in volume\n", out);
  for (size_t s = 0; s <= filling_n_features(f); s++) {
    const FeatureDefects d = defects_of_feature(f, sim->arrival, &defects, s);
    fprintf(out, "  %-12s %6.1f %%  %12.3f  %11.2f K  %11.3f", filling_name(f, s), 100.0 * d.unfilled, d.misrun,
            d.front_coldest, d.front_solid);
    if (isnan(d.cold_shut))
      fputs("         --\n", out);
    else
      fprintf(out, "  %9.3f  %.3g mm3 (worst at %.3g, %.3g, %.3g mm)\n", d.cold_shut, 1e9 * d.cold_shut_volume,
              1e3 * d.cold_shut_at[0], 1e3 * d.cold_shut_at[1], 1e3 * d.cold_shut_at[2]);
  }
  fprintf(out, "  (docs/theory, section 9; a cold shut counts from a solid fraction of %g on)\n", cold_shut_fraction);
  defects_free(&defects);
}

static json_t *number(double value)
{
  return isfinite(value) ? json_real(value) : json_null();
}

void sim_add_defects(const Sim *sim, json_t *features)
{
  const Filling *f = sim->filling;
  Defects defects;
  CastError err;
  if (defects_find(f, sim->arrival, &sim->config->melt, &defects, &err) != CAST_OK) return;
  for (size_t s = 0; s <= filling_n_features(f); s++) {
    const FeatureDefects d = defects_of_feature(f, sim->arrival, &defects, s);
    json_t *feature = json_object_get(features, filling_name(f, s));
    json_object_set_new(feature, "unfilled", number(d.unfilled));
    json_object_set_new(feature, "misrun", number(d.misrun));
    json_object_set_new(feature, "front_coldest_K", number(d.front_coldest));
    json_object_set_new(feature, "front_solid_fraction", number(d.front_solid));
    json_object_set_new(feature, "cold_shut", number(d.cold_shut));
    json_object_set_new(feature, "cold_shut_m3", number(d.cold_shut_volume));
  }
  defects_free(&defects);
}
