/* outer_walls.h - outer surfaces of the mould under other conditions than those the ROM was made with: another
 * heat-transfer coefficient, other surroundings, radiation. The ROM's K keeps its reference; what differs goes in as a
 * heat flow through each of the surface's patches, at the patch's mean temperature T:
 *   Q = A [h (T_amb - T) + eps sigma (T_amb^4 - T^4) - h_K (T_ref - T)],  T_ref the run's ambient.
 *                                                                                       (docs/theory, mould online) */
#ifndef CAST_MOULD_OUTER_WALLS_H
#define CAST_MOULD_OUTER_WALLS_H

#include "common/rom/rom.h"

typedef struct OuterWall { // as the input has it
  char surface[ROM_NAME_LENGTH];
  double h;          // W/(m2 K); NAN: as in the ROM
  double ambient;    // K; NAN: the run's
  double emissivity; // 0: no radiation
  int line;          // of the input, for messages
} OuterWall;

typedef struct OuterWalls OuterWalls;

/*  rom  borrowed, must outlive the walls; ambient: the run's, K; input: the file that the walls stand in, for messages,
 *       or NULL
 * Errors: CAST_ERR_INPUT for a surface that the ROM does not have or that is no outer one, or has a fixed temperature
 * there; CAST_ERR_MEMORY. */
CastStatus outer_walls_create(const RomData *rom, size_t n, const OuterWall *wall, const char *input, double ambient,
                              OuterWalls **walls, CastError *err);
void outer_walls_destroy(OuterWalls **walls);
/* Patches of all walls, a surface's one after the other; the ROM's number of the i-th. */
size_t outer_walls_n(const OuterWalls *walls);
size_t outer_walls_patch(const OuterWalls *walls, size_t i);
typedef struct OuterStep { // a step of the mould without these walls' flows
  double dt;               // s
  const double *phi;       // [r] s, what a mode gains by an input of 1
  const double *T;         // [m] K, patches at its start
  const double *T_free;    // [outer_walls_n] K, the walls' patches at its end
} OuterStep;

/* Flows [outer_walls_n] W into the mould, constant over the step: those of the walls' temperatures at its end, which
 * they themselves lead to, so that no step is too long for them. */
void outer_walls_flows(OuterWalls *walls, const OuterStep *step, double *flow);

#endif
