/* cavity_results.h - /castrun/cavity in results.vtkhdf: what happened in each cell of the cavity, once a run is over.
 */
#ifndef CAST_RESULTS_CAVITY_RESULTS_H
#define CAST_RESULTS_CAVITY_RESULTS_H

#include "cast/results/defects.h"

/*  results  path of the file, which is there. Errors: CAST_ERR_IO, CAST_ERR_MEMORY. */
CastStatus cavity_results_write(const char *results, const Filling *filling, const Arrival *arrival,
                                const Defects *defects, CastError *err);
#endif
