#include "reduce/io/matrix_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Text of 10 digits or more; a difference above this is meant. */
static const double SAME = 1e-9;

static CastStatus check_square(const MarketMatrix *A, const char *name, PetscInt n, CastError *err)
{
  CAST_CHECK(A->rows == A->columns, err, CAST_ERR_FORMAT, "%s: %s has %lld rows and %lld columns, as many are expected",
             A->path, name, (long long)A->rows, (long long)A->columns);
  CAST_CHECK(A->rows == n, err, CAST_ERR_FORMAT, "%s: %s has %lld rows, E has %lld", A->path, name, (long long)A->rows,
             (long long)n);
  return CAST_OK;
}

static double value_at(const MarketMatrix *A, PetscInt row, PetscInt column)
{
  const MarketEntry *entry = market_find(A, row, column);
  return entry ? entry->value : 0.0;
}

/* Makes what differs by rounding exactly symmetric. */
static CastStatus check_symmetric(MarketMatrix *A, const char *name, CastError *err)
{
  double largest = 0.0;
  for (size_t i = 0; i < A->n; i++) largest = fmax(largest, fabs(A->entry[i].value));
  for (size_t i = 0; i < A->n; i++) {
    MarketEntry *a = &A->entry[i], *b = market_find(A, a->column, a->row);
    const double mirrored = b ? b->value : 0.0, size = fmax(fabs(a->value), fabs(mirrored));
    CAST_CHECK(fabs(a->value - mirrored) <= SAME * size + 1e-14 * largest, err, CAST_ERR_FORMAT,
               "%s:%ld: %s is not symmetric: entry (%lld, %lld) is %g, but (%lld, %lld) is %g. Only symmetric systems "
               "are reduced (heat conduction is one; a mould that moves or is flown through is not)",
               A->path, a->line, name, (long long)a->row + 1, (long long)a->column + 1, a->value,
               (long long)a->column + 1, (long long)a->row + 1, mirrored);
    if (b && a->row < a->column) a->value = b->value = 0.5 * (a->value + mirrored);
  }
  return CAST_OK;
}

/* What a positive (semi-)definite matrix, times `sign`, has at least: a diagonal that is positive (not negative), and
 * no |a_ij| above sqrt(a_ii a_jj). The rest shows when it is factorised. */
static CastStatus check_definite(const MarketMatrix *A, const char *name, double sign, bool semi, CastError *err)
{
  for (PetscInt i = 0; i < A->rows; i++) {
    const double diagonal = sign * value_at(A, i, i);
    CAST_CHECK(semi ? diagonal >= 0.0 : diagonal > 0.0, err, CAST_ERR_FORMAT,
               "%s: entry (%lld, %lld) of %s is %g: %s is expected on the diagonal, for %s must be positive %sdefinite",
               A->path, (long long)i + 1, (long long)i + 1, name, value_at(A, i, i),
               sign < 0.0 ? "a negative number (or 0)"
               : semi     ? "a positive number (or 0)"
                          : "a positive number",
               sign < 0.0 ? "-A" : name, semi ? "semi-" : "");
  }
  for (size_t k = 0; k < A->n; k++) {
    const MarketEntry *a = &A->entry[k];
    if (a->row >= a->column) continue;
    const double bound = sqrt(value_at(A, a->row, a->row) * value_at(A, a->column, a->column));
    CAST_CHECK(fabs(a->value) <= bound * (1.0 + SAME), err, CAST_ERR_FORMAT,
               "%s:%ld: entry (%lld, %lld) of %s is %g, but %g at most can stand beside these entries on the diagonal: "
               "%s is not positive %sdefinite",
               A->path, a->line, (long long)a->row + 1, (long long)a->column + 1, name, a->value, bound,
               sign < 0.0 ? "-A" : name, semi ? "semi-" : "");
  }
  return CAST_OK;
}

/* Sums of the columns; 0 where a column is empty. transposed: of the rows. */
static double *add_columns(const MarketMatrix *A, bool transposed)
{
  double *sum = calloc((size_t)(transposed ? A->rows : A->columns), sizeof *sum);
  for (size_t i = 0; sum && i < A->n; i++) sum[transposed ? A->entry[i].row : A->entry[i].column] += A->entry[i].value;
  return sum;
}

/* Columns of B to sum 1, so that an input is watts; a column's sum is the patch's area where the input was a flux. */
static CastStatus scale_inputs(const MatricesConfig *config, MatrixFiles *files, CastError *err)
{
  for (PetscInt l = 0; l < files->m; l++) {
    const double sum = files->area[l];
    CAST_CHECK(sum > 0.0, err, CAST_ERR_FORMAT,
               "%s: column %lld of B sums to %g: more than 0 is expected, for heat that enters must stay",
               files->B.path, (long long)l + 1, sum);
    if (config->flux) continue;
    CAST_CHECK(fabs(sum - 1.0) <= 1e-6, err, CAST_ERR_FORMAT,
               "%s: column %lld of B sums to %.10g, 1 is expected where an input is in W: each watt enters once. With "
               "'inputs: flux' columns are those of a flux in W/m2, their sums the patches' areas in m2",
               files->B.path, (long long)l + 1, sum);
  }
  for (size_t i = 0; i < files->B.n; i++) files->B.entry[i].value /= files->area[files->B.entry[i].column];
  for (PetscInt l = 0; !config->flux && l < files->m; l++) files->area[l] = 1.0;
  return CAST_OK;
}

static CastStatus compare_outputs(const MarketMatrix *C, const MarketMatrix *B, const double *sum, CastError *err)
{
  static const char why[] =
      "only C = B^T, up to a positive factor for each row, keeps the reduced model passive: power "
      "in and power out are then the same product";
  for (size_t i = 0; i < C->n; i++) {
    const MarketEntry *c = &C->entry[i];
    CAST_CHECK(sum[c->row] > 0.0, err, CAST_ERR_FORMAT, "%s: row %lld of C sums to %g, more than 0 is expected; %s",
               C->path, (long long)c->row + 1, sum[c->row], why);
    const double b = value_at(B, c->column, c->row), scaled = c->value / sum[c->row];
    CAST_CHECK(
        fabs(scaled - b) <= SAME * fmax(fabs(b), fabs(scaled)) + 1e-14, err, CAST_ERR_FORMAT,
        "%s:%ld: entry (%lld, %lld) of C is %g over the sum of its row, but (%lld, %lld) of B is %g over the sum "
        "of its column; %s",
        C->path, c->line, (long long)c->row + 1, (long long)c->column + 1, scaled, (long long)c->column + 1,
        (long long)c->row + 1, b, why);
  }
  for (size_t i = 0; i < B->n; i++)
    CAST_CHECK(market_find(C, B->entry[i].column, B->entry[i].row) || fabs(B->entry[i].value) <= 1e-14, err,
               CAST_ERR_FORMAT, "%s: C has no entry (%lld, %lld), but B has (%lld, %lld) in line %ld of %s; %s",
               C->path, (long long)B->entry[i].column + 1, (long long)B->entry[i].row + 1,
               (long long)B->entry[i].row + 1, (long long)B->entry[i].column + 1, B->entry[i].line, B->path, why);
  return CAST_OK;
}

/* C only has to agree with B: it is not used. */
static CastStatus check_outputs(const char *path, const MatrixFiles *files, CastError *err)
{
  MarketMatrix C;
  CAST_CALL(market_read(path, &C, err));
  double *sum = add_columns(&C, true);
  CastStatus status;
  if (!sum)
    status = cast_error_set(err, CAST_ERR_MEMORY, "no memory to check %s", path);
  else if (C.rows != files->m || C.columns != files->n)
    status = cast_error_set(err, CAST_ERR_FORMAT, "%s: C has %lld rows and %lld columns, %lld and %lld are expected",
                            path, (long long)C.rows, (long long)C.columns, (long long)files->m, (long long)files->n);
  else
    status = compare_outputs(&C, &files->B, sum, err);
  free(sum);
  market_free(&C);
  return status;
}

static CastStatus read_files(const MatricesConfig *config, MatrixFiles *files, CastError *err)
{
  const char *K = config->K_is_A ? "A" : "K";
  CAST_CALL(market_read(config->E, &files->E, err));
  files->n = files->E.rows;
  CAST_CALL(check_square(&files->E, "E", files->n, err));
  CAST_CALL(check_symmetric(&files->E, "E", err));
  CAST_CALL(check_definite(&files->E, "E", 1.0, false, err));
  CAST_CALL(market_read(config->K, &files->K, err));
  CAST_CALL(check_square(&files->K, K, files->n, err));
  CAST_CALL(check_symmetric(&files->K, K, err));
  CAST_CALL(check_definite(&files->K, K, config->K_is_A ? -1.0 : 1.0, true, err));
  CAST_CALL(market_read(config->B, &files->B, err));
  CAST_CHECK(files->B.rows == files->n, err, CAST_ERR_FORMAT, "%s: B has %lld rows, E has %lld", files->B.path,
             (long long)files->B.rows, (long long)files->n);
  files->m = files->B.columns;
  CAST_CHECK(files->m <= files->n, err, CAST_ERR_FORMAT, "%s: B has %lld columns for %lld unknowns", files->B.path,
             (long long)files->m, (long long)files->n);
  files->area = add_columns(&files->B, false);
  CAST_CHECK(files->area, err, CAST_ERR_MEMORY, "no memory for %lld inputs", (long long)files->m);
  CAST_CALL(scale_inputs(config, files, err));
  return config->C ? check_outputs(config->C, files, err) : CAST_OK;
}

CastStatus matrix_files_read(const MatricesConfig *config, MatrixFiles *files, CastError *err)
{
  *files = (MatrixFiles){0};
  const CastStatus status = read_files(config, files, err);
  if (status != CAST_OK) matrix_files_free(files);
  return status;
}

void matrix_files_free(MatrixFiles *files)
{
  market_free(&files->E);
  market_free(&files->K);
  market_free(&files->B);
  free(files->area);
  *files = (MatrixFiles){0};
}
