/* matrix_mould.h - a small mould as matrices: a block of nx x ny x nz cells (finite volumes), heat entering through the
 * cells of one face, cut into patches, the opposite face losing heat to the surroundings. Written as Matrix Market files
 * and kept dense, so that tests can solve it by elimination. */
#ifndef TESTS_SUPPORT_MATRIX_MOULD_H
#define TESTS_SUPPORT_MATRIX_MOULD_H

#include <stddef.h>

typedef struct MatrixMould {
  size_t n, m;
  double *E, *K, *B; // [n*n], [n*n], [n*m] row-major; J/K, W/K, columns of B sum to 1
  double area;       // m2 of each patch
} MatrixMould;

/* A cube of `cells` cells an edge with 2 x 2 patches; cells even. h = 0: insulated. */
void matrix_mould_create(size_t cells, double h, MatrixMould *mould);
void matrix_mould_destroy(MatrixMould *mould);
/* Write A [rows x columns] to path; form: "coordinate real general", "coordinate real symmetric", "array real general". */
void matrix_write(const char *path, const char *form, size_t rows, size_t columns, const double *A, double factor);
/* H(s) = B^T (s E + K)^-1 B, [m*m] row-major, by Cholesky's elimination. */
void matrix_mould_transfer(const MatrixMould *mould, double s, double *H);

#endif
