/* symmetric_eigen.h - all eigenvalues of a small dense symmetric matrix, for tests. */
#ifndef TESTS_SUPPORT_SYMMETRIC_EIGEN_H
#define TESTS_SUPPORT_SYMMETRIC_EIGEN_H

#include <stddef.h>

/* Eigenvectors of the symmetric A [n*n] into the columns of V [n*n, zero on entry]; A becomes diagonal, its eigenvalues
 * in no order. Jacobi rotations, cyclic by rows: exact to rounding, time grows as n^3 (n = 600: seconds). */
void symmetric_eigenvectors(size_t n, double *A, double *V);
#endif
