/* defects.h - where a casting may not be sound (docs/theory, section 9), cell by cell of the cavity:
 *   front fraction  solid fraction of the melt that first came there; NAN: none came
 *   misrun          1 where no melt stands; else min(1, front fraction/coherency fraction): 0 where the melt came
 *                   liquid, 1 where it could only just have moved
 *   cold shut       the front fraction where two fronts met, NAN elsewhere. Fronts met in a cell if along one of the 13
 *                   directions through it the fronts two cells to either side ran towards it, within 60 degrees. */
#ifndef CAST_RESULTS_DEFECTS_H
#define CAST_RESULTS_DEFECTS_H

#include "cast/results/arrival.h"
#include "cast/results/filling.h"
#include "common/material/material.h"

extern const double cold_shut_fraction; // from this solid fraction on fronts that meet are counted as a cold shut

typedef struct Defects {
  ptrdiff_t n;                                 // cells
  double *front_fraction, *misrun, *cold_shut; // [n] 1
} Defects;

/* The filling is taken as it was at its last look. Errors: CAST_ERR_MEMORY. */
CastStatus defects_find(const Filling *filling, const Arrival *arrival, const Material *melt, Defects *defects,
                        CastError *err);
void defects_free(Defects *defects);
double defects_misrun(const Material *melt, bool filled, double front_fraction); // the index of one place

typedef struct FeatureDefects {
  double misrun;           // mean of the cells' index by volume
  double unfilled;         // 1, by volume
  double front_coldest;    // K, of the fronts; NAN: none came
  double front_solid;      // 1, largest front fraction
  double cold_shut;        // 1, the largest; NAN: no fronts met
  double cold_shut_volume; // m3, of cells whose index is at least cold_shut_fraction
  double cold_shut_at[3];  // m, where it is largest
} FeatureDefects;
/* feature as in filling.h. */
FeatureDefects defects_of_feature(const Filling *filling, const Arrival *arrival, const Defects *defects,
                                  size_t feature);
#endif
