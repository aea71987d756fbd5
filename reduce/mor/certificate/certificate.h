/* certificate.h - what is known of a reduced model's error, from real symmetric positive definite solves only. */
#ifndef REDUCE_MOR_CERTIFICATE_CERTIFICATE_H
#define REDUCE_MOR_CERTIFICATE_CERTIFICATE_H

#include "reduce/mor/certificate/residual.h"
#include "reduce/mor/certificate/step_reference.h"

typedef struct Certificate Certificate;

/* With more inputs the error's model (error_model.h), one state an input and decade, costs more than it is worth. */
enum { CERTIFICATE_MOST_PORTS = 256 };

/* What the bounds need of the full model: a preconditioner and p solves at about one rate a decade of the band
 * w_first to w_last, rad/s, while the basis is there. model: of the basis as it stands; borrowed for the certificate's
 * life. */
PetscErrorCode certificate_create(const KrylovBasis *basis, const ModalModel *model, ShiftedSolver *solver,
                                  PetscReal w_first, PetscReal w_last, Certificate **certificate);
/* Upper bounds of ||H(iw) - H_r(iw)||_2/||H_r(iw)||_2, H weighted with the patches' areas,
 * H = D B^T (iw E + K)^-1 B D, D = diag(area)^(1/2), at log-spaced frequencies that begin and end with the band. They
 * are raised by what their log-log interpolation was seen to miss, so that it holds between them too.
 *   last                  what a second stage made of the model, or the model itself
 *   frequency, bound [n]  out: one PetscMalloc2; free with PetscFree2(frequency, bound) */
PetscErrorCode certificate_transfer_bounds(const Certificate *certificate, const ModalModel *last, PetscInt *n,
                                           PetscReal **frequency, PetscReal **bound);
/* The full model's step responses: those of the model, and what they lack (error_model.h). The reference's own error
 * is what every other rate of the certificate would have made of it. At most CERTIFICATE_MOST_PORTS inputs. */
PetscErrorCode certificate_correct(const Certificate *certificate, StepReference *reference);
/* Of the basis and the model that the certificate was created with; borrowed. */
const Residual *certificate_get_residual(const Certificate *certificate);
PetscErrorCode certificate_destroy(Certificate **certificate);

#endif
