/* mould_results.h - mould.vtkhdf and mould.xmf: the mould's temperature, reprojected from the reduced state, on its
 * surface (both files) and in the near-wall band (tetrahedra, .xmf), on the same points. */
#ifndef CAST_RESULTS_MOULD_RESULTS_H
#define CAST_RESULTS_MOULD_RESULTS_H

#include "cast/io/vtk_series.h"
#include "cast/mould/rom_state.h"

typedef struct MouldResults MouldResults;

/*  rom  borrowed;  n_steps  0: begin anew; else go on after the first n_steps of the files there */
CastStatus mould_results_open(const char *folder, const RomData *rom, size_t n_steps, MouldResults **results,
                              CastError *err);
CastStatus mould_results_append(MouldResults *results, double time, const RomState *state, CastError *err);
/* Maps of what happened at the wall, when no step follows any more.
 *   field  copied (not its texts);  values  [n] arrays [triangles of the ROM], float or int32_t */
CastStatus mould_results_set_maps(MouldResults *results, size_t n, const VtkField *field, void *const *values,
                                  CastError *err);
CastStatus mould_results_finish(MouldResults *results, CastError *err);
size_t mould_results_n_steps(const MouldResults *results);
void mould_results_close(MouldResults **results);

#endif
