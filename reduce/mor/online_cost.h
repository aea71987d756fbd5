/* online_cost.h - what a step of a reduced model costs castrun. */
#ifndef REDUCE_MOR_ONLINE_COST_H
#define REDUCE_MOR_ONLINE_COST_H

#include "reduce/mor/reduced_model.h"

typedef struct OnlineCost {
  PetscReal multiplications; // of one step: decay and input of each state, B q and B^T z
  PetscReal seconds;         // measured on this rank, one thread, the model in cache as far as it fits
} OnlineCost;

PetscErrorCode online_cost_measure(const ReducedModel *model, OnlineCost *cost);

#endif
