/* sim_tension.c - surface tension as the input has it: one contact angle, or several by named cavity surface. */
#include <math.h>
#include <stdlib.h>

#include "cast/coupling/cavity_patches.h"
#include "cast/sim/sim_private.h"

static CastStatus set_angles(Sim *sim, double *angle, int32_t *of_patch, CastError *err)
{
  const CastConfig *c = sim->config;
  for (size_t l = 0; l < sim->rom->m; l++) of_patch[l] = -1;
  for (size_t k = 0; k < c->n_angles; k++) {
    angle[k] = c->angle[k].contact_angle;
    CAST_CALL(cavity_patches_set(sim->rom, "surface_tension.surfaces", c->angle[k].surface, (int32_t)k, of_patch, err));
  }
  return tension_set_angles(sim->tension, c->n_angles, angle, sim->rom->m, of_patch, err);
}

CastStatus sim_tension_create(Sim *sim, CastError *err)
{
  const CastConfig *c = sim->config;
  if (!c->tension) return CAST_OK;
  CAST_CALL(tension_create(c->kernel, sim->sph.h, c->spacing, &c->melt.surface_tension_of_t, c->contact_angle,
                           &sim->tension, err));
  sim->sph.wall_pull = tension_wall_pull(sim->tension);
  if (c->n_angles == 0) return CAST_OK;
  double *angle = malloc(c->n_angles * sizeof *angle);
  int32_t *of_patch = malloc(sim->rom->m * sizeof *of_patch);
  const CastStatus status = angle && of_patch ? set_angles(sim, angle, of_patch, err)
                                              : cast_error_set(err, CAST_ERR_MEMORY, "no memory for contact angles");
  free(angle);
  free(of_patch);
  return status;
}

static double degrees(double angle)
{
  return angle * 180.0 / pair_pi;
}

void sim_tension_report(const Sim *sim)
{
  const CastConfig *c = sim->config;
  if (!c->tension) return;
  const double sigma = table_evaluate(&c->melt.surface_tension_of_t, c->melt_temperature);
  double widest = c->contact_angle;
  for (size_t k = 0; k < c->n_angles; k++) widest = fmax(widest, c->angle[k].contact_angle);
  const double back = -2.0 * sigma * cos(widest) / sim->gap;
  log_info(sim->log, "tension   %.3g N/m, contact angle %.4g deg: %s %.3g kPa in a slot as wide as the thinnest gap",
           sigma, degrees(widest), back > 0.0 ? "holds back" : "draws in with", 1e-3 * fabs(back));
  for (size_t k = 0; k < c->n_angles; k++)
    log_info(sim->log, "tension   contact angle %.4g deg on '%s', %.4g deg elsewhere",
             degrees(c->angle[k].contact_angle), c->angle[k].surface, degrees(c->contact_angle));
  if (back > 0.0)
    log_warn(sim->log,
             "walls hold melt back up to a seventh less or more in the simulation (rows C2 of docs/validation.md): "
             "compare that pressure with what drives the melt");
}
