/* box_mould.h - a box of mould material as a distributed DMPlex of graded tetrahedra, for tests that need no mesher.
 * The cavity wall is the face z = 0, cut into patches[0] x patches[1] equal rectangles (patches first, row by row in
 * x); two outer surfaces follow: "sides" (x and y faces) and "top" (z = size[2]). */
#ifndef TESTS_SUPPORT_BOX_MOULD_H
#define TESTS_SUPPORT_BOX_MOULD_H

#include "reduce/mesh/mould_mesh.h"

typedef struct BoxMould {
  double size[3];                  // m
  int cells[3];                    // bricks along each axis, six tetrahedra each
  double grading;                  // z = size[2] (k/cells[2])^grading: above 1 the layers are thin at the cavity wall
  int patches[2];                  // of the cavity wall; must divide cells[0], cells[1]
  double h_cavity, h_sides, h_top; // W/(m2 K)
  double interface;                // m: tetrahedra wholly above this height are region 1; 0: one region
  double kappa[2], rho[2], c[2];   // of the regions
} BoxMould;

/* The mesh and the config that belongs to it (reduction settings left zero). Caller destroys both with
 * box_mould_destroy. Collective. */
PetscErrorCode box_mould_create(MPI_Comm comm, const BoxMould *box, MouldMesh **mesh, ReduceConfig **config);
PetscErrorCode box_mould_destroy(MouldMesh **mesh, ReduceConfig **config);

#endif
