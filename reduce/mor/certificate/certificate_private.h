/* certificate_private.h - what the certificate knows of the full model, and how its bounds use it. */
#ifndef REDUCE_MOR_CERTIFICATE_CERTIFICATE_PRIVATE_H
#define REDUCE_MOR_CERTIFICATE_CERTIFICATE_PRIVATE_H

#include "reduce/mor/certificate/certificate.h"
#include "reduce/mor/certificate/error_model.h"

struct Certificate {
  const ThermalSystem *system; // borrowed
  const ModalModel *model;     // borrowed
  Residual *residual;
  PetscReal w_first, w_last;
  PetscInt m, p, n_nodes;
  PetscReal *node, *G;     // [n_nodes] rad/s, [n_nodes x p x p]
  PetscReal *plain, *heat; // [n_nodes x p x p] see residual_energy
  PetscReal *solved;       // [n_nodes] what the defect's size is by solves over what it is by sums; 1: none were made
  PetscReal slip;          // largest
  ErrorModel *error;       // of G; owned; NULL: too many inputs
  PetscReal mismatch;      // by how much it misses the nodes, share of the residual's energy there
  PetscReal spoilt;        // largest share of the residual that R_0 Phi leaves out
  PetscReal *Phi[2];       // [p x p] factor of the residual, its columns scaled by `weight`
  PetscReal *product[2];   // [p x p]
  PetscReal *part[2][2];   // [node below or above][P or S] [p x p]
  PetscReal *weight;       // [p] area^(1/2), 0 for the ambient
};

/* Phi(iw) D to Phi. */
PetscErrorCode certificate_take_factor(const Certificate *certificate, PetscReal w);
/* P + iS = (Phi D)^H G (Phi D), Hermitian; G [p x p] symmetric; on the way product = G Phi D. */
PetscErrorCode certificate_energy(const Certificate *certificate, const PetscReal *G, PetscReal *P, PetscReal *S);

#endif
