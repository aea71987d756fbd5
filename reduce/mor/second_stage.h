/* second_stage.h - balanced truncation of the modal model, whose Gramian is closed. */
#ifndef REDUCE_MOR_SECOND_STAGE_H
#define REDUCE_MOR_SECOND_STAGE_H

#include "reduce/mor/certificate/step_reference.h"
#include "reduce/mor/model/modal_model.h"

typedef struct SecondStage {
  PetscReal *weight;      // [p] scale of each port in the Gramian
  PetscReal early_weight; // p of the Gramian, see second_stage.c: 0 balanced truncation
  PetscBool singular;     // as in modal_model_create
  PetscInt n_times;
  const PetscReal *time;          // [n_times] s
  PetscReal allowed;              // of the step responses' rise
  const StepReference *reference; // the full model's responses; NULL: none are known
  PetscReal limit;                // of the error against these
  PetscReal reached;              // out: by how much they differ; 0 without a smaller model
  PetscReal bound;                // out, early_weight 0: twice the sum of the Hankel values dropped, K/W
} SecondStage;

/* The smallest model whose step responses, for every input over the times, stay within stage->allowed of the response's
 * largest rise so far from those of `model` (of more than 64 inputs: of 64), and within stage->limit of the
 * reference's. The constant temperature stays in the space exactly. With balanced truncation ||H(iw) - H_r(iw)||_2 <=
 * bound where K is singular, for then the constant is a mode of its own; else the bound holds for the part that is
 * balanced, and the constant, added to its space, only lessens the error at real s. smaller == NULL: nothing can be
 * dropped. */
PetscErrorCode second_stage_truncate(const ModalModel *model, SecondStage *stage, ModalModel **smaller);

#endif
