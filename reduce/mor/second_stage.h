/* second_stage.h - balanced truncation of the modal model, whose Gramian is closed. */
#ifndef REDUCE_MOR_SECOND_STAGE_H
#define REDUCE_MOR_SECOND_STAGE_H

#include "reduce/mor/modal_model.h"

/* The smallest model whose step responses, for every input over the times, stay within `allowed` of the response's
 * largest rise so far from those of `model`. The constant temperature stays in the space exactly.
 *   weight [p]      scale of each port in the Gramian
 *   reached         out: by how much they differ; 0 without a smaller model
 * smaller == NULL: nothing can be dropped. */
PetscErrorCode second_stage_truncate(const ModalModel *model, const PetscReal *weight, PetscBool singular,
                                     PetscInt n_times, const PetscReal *time, PetscReal allowed, PetscReal *reached,
                                     ModalModel **smaller);

#endif
