#include "reduce/mor/krylov/shift_blocks.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "reduce/linear/dense_block.h"
#include "reduce/petsc/petsc_compat.h"

enum { PATH_ROOM = 4096, LINE_ROOM = 1024 };

static PetscMPIInt rank_of(const ShiftBlocks *blocks)
{
  PetscMPIInt rank = 0;
  return MPI_Comm_rank(blocks->comm, &rank) ? 0 : rank;
}

static void block_path(const ShiftBlocks *blocks, PetscInt i, char path[PATH_ROOM])
{
  snprintf(path, PATH_ROOM, "%s/block-%d.%d", blocks->folder, (int)i, (int)rank_of(blocks));
}

static void moments_path(const ShiftBlocks *blocks, PetscInt i, char path[PATH_ROOM])
{
  snprintf(path, PATH_ROOM, "%s/moments-%d", blocks->folder, (int)i);
}

/* Every rank learns of a fault on one of them. */
static PetscErrorCode agree(const ShiftBlocks *blocks, int fault, const char *what, const char *path)
{
  int worst = fault;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_INT, MPI_MAX, blocks->comm));
  PetscCheck(worst == 0, blocks->comm, PETSC_ERR_FILE_WRITE, "%s '%s': %s", what, path, strerror(worst));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* 0, or errno */
static int write_numbers(FILE *file, const PetscScalar *x, size_t n)
{
  return fwrite(x, sizeof *x, n, file) == n ? 0 : errno ? errno : EIO;
}

static int write_block(const char *path, const PetscScalar *x, PetscInt n, PetscInt k, PetscInt ld)
{
  FILE *file = fopen(path, "wb");
  int fault = file ? 0 : errno;
  for (PetscInt c = 0; c < k && !fault; c++) fault = write_numbers(file, x + (size_t)c * (size_t)ld, (size_t)n);
  if (file && fclose(file) && !fault) fault = errno;
  return fault;
}

static int read_block(const char *path, PetscScalar *x, PetscInt n, PetscInt k, PetscInt ld)
{
  FILE *file = fopen(path, "rb");
  int fault = file ? 0 : errno;
  for (PetscInt c = 0; c < k && !fault; c++)
    if (fread(x + (size_t)c * (size_t)ld, sizeof *x, (size_t)n, file) != (size_t)n) fault = EIO;
  if (file) fclose(file);
  return fault;
}

static PetscErrorCode move_block(ShiftBlocks *blocks, PetscInt i, Mat X, PetscBool write)
{
  char path[PATH_ROOM];
  PetscScalar *x;
  PetscInt n, k, ld;

  PetscFunctionBeginUser;
  block_path(blocks, i, path);
  PetscCall(MatGetLocalSize(X, &n, NULL));
  PetscCall(MatGetSize(X, NULL, &k));
  PetscCall(MatDenseGetLDA(X, &ld));
  PetscCall(MatDenseGetArray(X, &x));
  const int fault = write ? write_block(path, x, n, k, ld) : read_block(path, x, n, k, ld);
  PetscCall(MatDenseRestoreArray(X, &x));
  PetscCall(agree(blocks, fault, write ? "the reduction's vectors cannot be written to" : "cannot be read:", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what is complete ---- */

static int write_manifest(const ShiftBlocks *blocks, const char *signature)
{
  char path[PATH_ROOM], temporary[PATH_ROOM + 8];
  snprintf(path, sizeof path, "%s/manifest", blocks->folder);
  snprintf(temporary, sizeof temporary, "%s.new", path);
  FILE *file = fopen(temporary, "w");
  if (!file) return errno;
  int fault = fprintf(file, "%s\n", signature) < 0 ? EIO : 0;
  for (PetscInt i = 0; i < blocks->n_shifts && !fault; i++)
    if (fprintf(file, "%.17g %d\n", (double)blocks->shift[i].s, (int)blocks->shift[i].q) < 0) fault = EIO;
  if (fclose(file) && !fault) fault = errno;
  if (!fault && rename(temporary, path)) fault = errno;
  return fault;
}

static int write_moments(const ShiftBlocks *blocks, PetscInt i)
{
  const ShiftMoments *shift = &blocks->shift[i];
  const size_t p = (size_t)blocks->p, q = (size_t)shift->q;
  char path[PATH_ROOM];
  moments_path(blocks, i, path);
  FILE *file = fopen(path, "wb");
  int fault = file ? write_numbers(file, shift->mu, 2 * q * p * p) : errno;
  if (!fault) fault = write_numbers(file, shift->heat, 2 * q * p);
  if (file && fclose(file) && !fault) fault = errno;
  return fault;
}

static PetscErrorCode append_shift(ShiftBlocks *blocks, const ShiftMoments *moments)
{
  PetscFunctionBeginUser;
  PetscCall(PetscRealloc((size_t)(blocks->n_shifts + 1) * sizeof *blocks->shift, &blocks->shift));
  blocks->shift[blocks->n_shifts++] = *moments;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One shift of the manifest: its moments, the same on every rank. False: the file is not whole. */
static PetscErrorCode read_moments(ShiftBlocks *blocks, PetscReal s, PetscInt q, PetscBool *whole)
{
  const size_t p = (size_t)blocks->p, n_mu = 2 * (size_t)q * p * p, n_heat = 2 * (size_t)q * p;
  ShiftMoments shift = {.s = s, .q = q};
  int good = 1;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1(n_mu, &shift.mu));
  PetscCall(PetscMalloc1(n_heat, &shift.heat));
  if (rank_of(blocks) == 0) {
    char path[PATH_ROOM];
    moments_path(blocks, blocks->n_shifts, path);
    FILE *file = fopen(path, "rb");
    good = file && fread(shift.mu, sizeof(PetscReal), n_mu, file) == n_mu &&
           fread(shift.heat, sizeof(PetscReal), n_heat, file) == n_heat;
    if (file) fclose(file);
  }
  for (PetscInt k = 0; k < 2 * q; k++)
    PetscCallMPI(MPI_Bcast(shift.mu + (size_t)k * p * p, (int)(p * p), MPIU_REAL, 0, blocks->comm));
  PetscCallMPI(MPI_Bcast(shift.heat, (int)n_heat, MPIU_REAL, 0, blocks->comm));
  for (PetscInt k = 0; k < q && good; k++) {
    char path[PATH_ROOM];
    block_path(blocks, blocks->n + k, path);
    good = access(path, R_OK) == 0;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &good, 1, MPI_INT, MPI_MIN, blocks->comm));
  *whole = (PetscBool)(good != 0);
  if (*whole) {
    PetscCall(append_shift(blocks, &shift));
    blocks->n += q;
  } else {
    PetscCall(PetscFree(shift.mu));
    PetscCall(PetscFree(shift.heat));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Text before a bar is to be the same, numbers after it to 1e-9: what several ranks add up differs in its last digits
 * from run to run. */
static bool same_problem(const char *found, const char *signature)
{
  const size_t text = strcspn(signature, "|");
  if (strncmp(found, signature, text) != 0 || found[text] != signature[text]) return false;
  if (signature[text] == '\0') return true;
  const char *a = found + text + 1, *b = signature + text + 1;
  for (;;) {
    char *end_a, *end_b;
    const double x = strtod(a, &end_a), y = strtod(b, &end_b);
    if (end_b == b) return end_a == a;
    if (end_a == a || fabs(x - y) > 1e-9 * fabs(y)) return false;
    a = end_a;
    b = end_b;
  }
}

/* The shifts listed there, if the signature is ours. */
static PetscErrorCode take_over(ShiftBlocks *blocks, const char *signature)
{
  char path[PATH_ROOM], line[LINE_ROOM];
  FILE *file = NULL;
  PetscBool whole = PETSC_TRUE;

  PetscFunctionBeginUser;
  snprintf(path, sizeof path, "%s/manifest", blocks->folder);
  if (rank_of(blocks) == 0) {
    file = fopen(path, "r");
    const bool any = file && fgets(line, sizeof line, file);
    if (any) line[strcspn(line, "\n")] = '\0';
    if (file && (!any || !same_problem(line, signature))) {
      fclose(file);
      file = NULL;
    }
  }
  for (;;) {
    double s = 0.0;
    int q = 0, found = file && fscanf(file, "%lf %d", &s, &q) == 2;
    PetscCallMPI(MPI_Bcast(&found, 1, MPI_INT, 0, blocks->comm));
    if (!found || !whole) break;
    PetscCallMPI(MPI_Bcast(&s, 1, MPI_DOUBLE, 0, blocks->comm));
    PetscCallMPI(MPI_Bcast(&q, 1, MPI_INT, 0, blocks->comm));
    PetscCall(read_moments(blocks, s, q, &whole));
  }
  if (file) fclose(file);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- life ---- */

PetscErrorCode shift_blocks_create(Mat like, PetscInt p, const char *folder, const char *signature, ShiftBlocks **out)
{
  ShiftBlocks *blocks;

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&blocks));
  *out = blocks;
  blocks->comm = PetscObjectComm((PetscObject)like);
  blocks->p = p;
  blocks->in_window = -1;
  PetscCall(dense_block_create(like, p, &blocks->window));
  if (!folder) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscStrallocpy(folder, &blocks->folder));
  const int fault = rank_of(blocks) == 0 && mkdir(folder, 0777) && errno != EEXIST ? errno : 0;
  PetscCall(agree(blocks, fault, "no folder for the reduction's vectors at", folder));
  PetscCall(take_over(blocks, signature));
  PetscCall(agree(blocks, rank_of(blocks) == 0 ? write_manifest(blocks, signature) : 0, "cannot write in", folder));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode shift_blocks_add(ShiftBlocks *blocks, Mat X)
{
  PetscFunctionBeginUser;
  if (blocks->folder) {
    PetscCall(move_block(blocks, blocks->n, X, PETSC_TRUE));
  } else {
    PetscCall(PetscRealloc((size_t)(blocks->n + 1) * sizeof *blocks->block, &blocks->block));
    PetscCall(dense_block_create(blocks->window, blocks->p, &blocks->block[blocks->n]));
    PetscCall(dense_block_copy(blocks->block[blocks->n], 0, X, NULL, blocks->p));
  }
  blocks->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The manifest's first line stays as it is. */
static int rewrite_manifest(const ShiftBlocks *blocks)
{
  char path[PATH_ROOM], line[LINE_ROOM];
  snprintf(path, sizeof path, "%s/manifest", blocks->folder);
  FILE *file = fopen(path, "r");
  if (!file) return errno;
  const bool whole = fgets(line, sizeof line, file) != NULL;
  fclose(file);
  if (!whole) return EIO;
  line[strcspn(line, "\n")] = '\0';
  return write_manifest(blocks, line);
}

PetscErrorCode shift_blocks_complete(ShiftBlocks *blocks, const ShiftMoments *moments)
{
  int fault = 0;

  PetscFunctionBeginUser;
  PetscCall(append_shift(blocks, moments));
  if (!blocks->folder) PetscFunctionReturn(PETSC_SUCCESS);
  if (rank_of(blocks) == 0) fault = write_moments(blocks, blocks->n_shifts - 1);
  if (rank_of(blocks) == 0 && !fault) fault = rewrite_manifest(blocks);
  PetscCall(agree(blocks, fault, "cannot write in", blocks->folder));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode shift_blocks_get(ShiftBlocks *blocks, PetscInt i, Mat *X)
{
  PetscFunctionBeginUser;
  if (!blocks->folder) {
    *X = blocks->block[i];
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (i != blocks->in_window) PetscCall(move_block(blocks, i, blocks->window, PETSC_FALSE));
  blocks->in_window = i;
  *X = blocks->window;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void remove_files(const ShiftBlocks *blocks)
{
  char path[PATH_ROOM];
  for (PetscInt i = 0; i < blocks->n; i++) {
    block_path(blocks, i, path);
    unlink(path);
  }
  MPI_Barrier(blocks->comm);
  if (rank_of(blocks) != 0) return;
  for (PetscInt i = 0; i < blocks->n_shifts; i++) {
    moments_path(blocks, i, path);
    unlink(path);
  }
  snprintf(path, sizeof path, "%s/manifest", blocks->folder);
  unlink(path);
  rmdir(blocks->folder);
}

PetscErrorCode shift_blocks_destroy(ShiftBlocks **blocks, PetscBool finished)
{
  ShiftBlocks *b = *blocks;

  PetscFunctionBeginUser;
  if (!b) PetscFunctionReturn(PETSC_SUCCESS);
  if (finished && b->folder) remove_files(b);
  for (PetscInt i = 0; i < b->n && !b->folder; i++) PetscCall(MatDestroy(&b->block[i]));
  for (PetscInt i = 0; i < b->n_shifts; i++) {
    PetscCall(PetscFree(b->shift[i].mu));
    PetscCall(PetscFree(b->shift[i].heat));
  }
  PetscCall(PetscFree(b->block));
  PetscCall(PetscFree(b->shift));
  PetscCall(PetscFree(b->folder));
  PetscCall(MatDestroy(&b->window));
  PetscCall(PetscFree(b));
  *blocks = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}
