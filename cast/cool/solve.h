/* solve.h - one backward Euler step of melt and mould together. Internal to cool/. */
#ifndef CAST_COOL_SOLVE_H
#define CAST_COOL_SOLVE_H

#include "cast/cool/cool.h"
#include "cast/cool/graph.h"
#include "cast/cool/mould_response.h"

enum { COOL_WORK = 10 };

typedef struct CoolSolver {
  const SphParameters *sph; // borrowed, as all pointers to the next blank line
  Particles *p;
  Coupling *coupling;
  RomState *state;

  double accuracy; // J/kg, what the enthalpies may lack of fulfilling the step's equations
  CoolGraph graph;
  MouldResponse response;
  CouplingContacts contacts;
  int32_t *owner; // [contacts] the fluid particle of each
  double *work[COOL_WORK];
  double *E_start, *T, *slope, *given, *diagonal, *step; // [n], in `work`: J/kg, K, K kg/J, W, W/K, K
  double *conductance;                                   // [n] W/K, to the wall
  double *residual, *direction, *image;                  // [n] of the conjugate gradients
  double *flow, *sums, *answer;                          // [m] W; W/K K; K
  long newton, gradients;                                // iterations so far
} CoolSolver;

/* The lists and contacts are up to date. Errors: CAST_ERR_MEMORY. */
CastStatus cool_solver_create(const CoolSystem *system, CoolSolver *solver, CastError *err);
void cool_solver_destroy(CoolSolver *solver);
/* Enthalpies and mould from now to dt later; conductivities and contacts are those of the start. solver->flow: the mean
 * flows. The heat that a particle gives up is exactly what its neighbours and patches get, however well the equations
 * are solved.
 *   guess      [n] J/kg, enthalpies to begin with
 *   converged  out: false: nothing was changed, try a shorter step
 * Errors: those of mould_response_prepare. */
CastStatus cool_solver_step(CoolSolver *solver, const double *guess, double dt, bool *converged, CastError *err);

#endif
