/* melt_results.h - results.vtkhdf and results.xmf: the melt's particles over time. */
#ifndef CAST_RESULTS_MELT_RESULTS_H
#define CAST_RESULTS_MELT_RESULTS_H

#include "cast/io/vtk_series.h"
#include "cast/particles/particles.h"
#include "cast/results/arrival.h"
#include "cast/results/filling.h"
#include "cast/results/freezing.h"
#include "common/material/material.h"

typedef struct MeltResults MeltResults;

/*  folder  holds both files;  melt  borrowed
 *  n_ids   ids of particles are below it
 *  n_steps 0: begin anew; else go on after the first n_steps of the files there */
CastStatus melt_results_open(const char *folder, const Material *melt, ptrdiff_t n_ids, size_t n_steps,
                             MeltResults **results, CastError *err);
/* From now on frames tell how particles froze and when melt came to where they stand. All borrowed. */
void melt_results_follow(MeltResults *results, const Freezing *freezing, const Filling *filling,
                         const Arrival *arrival);
/* One step: particles in the order of their ids, so that row i stays the same particle while none leaves. */
CastStatus melt_results_append(MeltResults *results, double time, const Particles *particles, CastError *err);
/* Bring the side file up to date (appending does so only now and then once there are many steps). */
CastStatus melt_results_finish(MeltResults *results, CastError *err);
size_t melt_results_n_steps(const MeltResults *results);
const char *melt_results_path(const MeltResults *results);
void melt_results_close(MeltResults **results);

#endif
