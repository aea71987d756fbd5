/* field_file.c
 * Format: VTKHDF 1.0 UnstructuredGrid (VTK file formats, "VTKHDF"): each rank is a partition, its sizes in NumberOf...,
 * its points, connectivity and offsets behind those of the ranks before it. */
#include "reduce/replay/field_file.h"

#include <errno.h>
#include <hdf5.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#include "common/vector.h"
#include "reduce/petsc/collective.h"
#include "reduce/petsc/petsc_compat.h"

enum { VTK_TETRAHEDRON = 10, CORNERS = 4 };

typedef struct Part { // of this rank
  long long n_points, n_cells;
  double *points;       // [n_points*3] m
  float *temperature;   // [n_points] K
  long long *cells;     // [n_cells*4] into this part's points
  long long *offsets;   // [n_cells + 1]
  unsigned char *types; // [n_cells]
} Part;

static PetscErrorCode list_points(DM dm, Vec theta, PetscReal preheat, Part *part)
{
  PetscInt first, last;
  PetscSection section, of_coordinates;
  Vec coordinates, local;
  const PetscScalar *x, *T;

  PetscFunctionBeginUser;
  PetscCall(DMPlexGetDepthStratum(dm, 0, &first, &last));
  part->n_points = last - first;
  PetscCall(PetscMalloc2(3 * (size_t)part->n_points, &part->points, (size_t)part->n_points, &part->temperature));
  PetscCall(DMGetLocalSection(dm, &section));
  PetscCall(DMGetCoordinateSection(dm, &of_coordinates));
  PetscCall(DMGetCoordinatesLocal(dm, &coordinates));
  PetscCall(DMGetLocalVector(dm, &local));
  PetscCall(DMGlobalToLocal(dm, theta, INSERT_VALUES, local));
  PetscCall(VecGetArrayRead(coordinates, &x));
  PetscCall(VecGetArrayRead(local, &T));
  for (PetscInt v = first; v < last; v++) {
    PetscInt place, entry;
    PetscCall(PetscSectionGetOffset(of_coordinates, v, &place));
    PetscCall(PetscSectionGetOffset(section, v, &entry));
    PetscCall(PetscArraycpy(part->points + 3 * (v - first), x + place, 3));
    part->temperature[v - first] = (float)(preheat + T[entry]);
  }
  PetscCall(VecRestoreArrayRead(local, &T));
  PetscCall(VecRestoreArrayRead(coordinates, &x));
  PetscCall(DMRestoreLocalVector(dm, &local));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* VTK wants the fourth corner on the side that the other three wind towards. */
static void turn(const double *points, long long cell[CORNERS])
{
  const double *a = points + 3 * cell[0];
  double edge[3][3], normal[3];
  for (int k = 0; k < 3; k++) vec_between(a, points + 3 * cell[k + 1], edge[k]);
  vec_cross(edge[0], edge[1], normal);
  if (vec_dot(normal, edge[2]) > 0.0) return;
  const long long swap = cell[2];
  cell[2] = cell[3];
  cell[3] = swap;
}

static PetscErrorCode list_cells(DM dm, Part *part)
{
  PetscInt first, last, first_vertex, last_vertex;

  PetscFunctionBeginUser;
  PetscCall(DMPlexGetHeightStratum(dm, 0, &first, &last));
  PetscCall(DMPlexGetDepthStratum(dm, 0, &first_vertex, &last_vertex));
  part->n_cells = last - first;
  PetscCall(PetscMalloc3(CORNERS * (size_t)part->n_cells, &part->cells, (size_t)part->n_cells + 1, &part->offsets,
                         (size_t)part->n_cells, &part->types));
  part->offsets[0] = 0;
  for (PetscInt c = first; c < last; c++) {
    PetscInt n, *closure = NULL, corners = 0;
    long long *cell = part->cells + CORNERS * (c - first);
    PetscCall(DMPlexGetTransitiveClosure(dm, c, PETSC_TRUE, &n, &closure));
    for (PetscInt i = 0; i < n && corners < CORNERS; i++)
      if (closure[2 * i] >= first_vertex && closure[2 * i] < last_vertex)
        cell[corners++] = closure[2 * i] - first_vertex;
    PetscCall(DMPlexRestoreTransitiveClosure(dm, c, PETSC_TRUE, &n, &closure));
    turn(part->points, cell);
    part->offsets[c - first + 1] = CORNERS * (c - first + 1);
    part->types[c - first] = VTK_TETRAHEDRON;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct FieldSet {
  const char *name;
  hid_t type;      // in memory and in the file
  long long rows;  // of this rank
  hsize_t columns; // 1: rank 1
  const void *data;
} FieldSet;

/* Rows of all ranks one behind the other. */
static PetscBool write_set(MPI_Comm comm, hid_t group, const FieldSet *set)
{
  long long before = 0, total = 0;
  int rank;
  MPI_Comm_rank(comm, &rank);
  MPI_Exscan(&set->rows, &before, 1, MPI_LONG_LONG, MPI_SUM, comm);
  if (rank == 0) before = 0;
  MPI_Allreduce(&set->rows, &total, 1, MPI_LONG_LONG, MPI_SUM, comm);
  const int dimensions = set->columns > 1 ? 2 : 1;
  const hsize_t shape[2] = {(hsize_t)total, set->columns}, start[2] = {(hsize_t)before, 0};
  const hsize_t count[2] = {(hsize_t)set->rows, set->columns};
  const hid_t space = H5Screate_simple(dimensions, shape, NULL), memory = H5Screate_simple(dimensions, count, NULL);
  const hid_t transfer = H5Pcreate(H5P_DATASET_XFER);
  H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
  if (set->rows > 0)
    H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL);
  else {
    H5Sselect_none(space);
    H5Sselect_none(memory);
  }
  const hid_t file_set = H5Dcreate2(group, set->name, set->type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const PetscBool ok =
      (PetscBool)(file_set >= 0 && H5Dwrite(file_set, set->type, memory, space, transfer, set->data) >= 0);
  if (file_set >= 0) H5Dclose(file_set);
  H5Pclose(transfer);
  H5Sclose(memory);
  H5Sclose(space);
  return ok;
}

static PetscBool write_head(hid_t group)
{
  const long long version[2] = {1, 0};
  const hsize_t two[1] = {2};
  const char type[] = "UnstructuredGrid";
  const hid_t text = H5Tcopy(H5T_C_S1), scalar = H5Screate(H5S_SCALAR), pair = H5Screate_simple(1, two, NULL);
  H5Tset_size(text, sizeof type - 1);
  H5Tset_strpad(text, H5T_STR_NULLPAD);
  const hid_t of_type = H5Acreate2(group, "Type", text, scalar, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t of_version = H5Acreate2(group, "Version", H5T_NATIVE_LLONG, pair, H5P_DEFAULT, H5P_DEFAULT);
  const PetscBool ok = (PetscBool)(of_type >= 0 && of_version >= 0 && H5Awrite(of_type, text, type) >= 0 &&
                                   H5Awrite(of_version, H5T_NATIVE_LLONG, version) >= 0);
  if (of_type >= 0) H5Aclose(of_type);
  if (of_version >= 0) H5Aclose(of_version);
  H5Tclose(text);
  H5Sclose(scalar);
  H5Sclose(pair);
  return ok;
}

static PetscBool write_contents(MPI_Comm comm, hid_t file, const Part *part, double time)
{
  const long long ids = CORNERS * part->n_cells;
  int rank;
  MPI_Comm_rank(comm, &rank);
  const hid_t group = H5Gcreate2(file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (group < 0) return PETSC_FALSE;
  const hid_t data = H5Gcreate2(group, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t field = H5Gcreate2(group, "FieldData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const FieldSet sets[] = {{"NumberOfPoints", H5T_NATIVE_LLONG, 1, 1, &part->n_points},
                           {"NumberOfCells", H5T_NATIVE_LLONG, 1, 1, &part->n_cells},
                           {"NumberOfConnectivityIds", H5T_NATIVE_LLONG, 1, 1, &ids},
                           {"Points", H5T_NATIVE_DOUBLE, part->n_points, 3, part->points},
                           {"Connectivity", H5T_NATIVE_LLONG, ids, 1, part->cells},
                           {"Offsets", H5T_NATIVE_LLONG, part->n_cells + 1, 1, part->offsets},
                           {"Types", H5T_NATIVE_UCHAR, part->n_cells, 1, part->types}};
  PetscBool ok = (PetscBool)(data >= 0 && field >= 0 && write_head(group));
  for (size_t i = 0; ok && i < sizeof sets / sizeof *sets; i++) ok = write_set(comm, group, &sets[i]);
  const FieldSet temperature = {"temperature", H5T_NATIVE_FLOAT, part->n_points, 1, part->temperature};
  const FieldSet at = {"TimeValue", H5T_NATIVE_DOUBLE, rank == 0, 1, &time};
  if (ok) ok = write_set(comm, data, &temperature);
  if (ok) ok = write_set(comm, field, &at);
  if (data >= 0) H5Gclose(data);
  if (field >= 0) H5Gclose(field);
  H5Gclose(group);
  return ok;
}

static PetscBool write_file(MPI_Comm comm, const Part *part, double time, const char *path)
{
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  H5Pset_fapl_mpio(access, comm, MPI_INFO_NULL);
  const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
  H5Pclose(access);
  if (file < 0) return PETSC_FALSE;
  const PetscBool ok = write_contents(comm, file, part, time);
  return (PetscBool)(H5Fclose(file) >= 0 && ok);
}

PetscErrorCode field_file_write(DM dm, Vec theta, PetscReal preheat, PetscReal time, const char *path)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)dm);
  CastError err = {CAST_OK, ""};
  CastStatus status = CAST_OK;
  char temporary[PETSC_MAX_PATH_LEN];
  Part part = {0};
  PetscMPIInt rank;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  snprintf(temporary, sizeof temporary, "%.4000s.part", path);
  PetscCall(list_points(dm, theta, preheat, &part));
  PetscCall(list_cells(dm, &part));
  errno = 0;
  if (!write_file(comm, &part, time, temporary) || (rank == 0 && rename(temporary, path) != 0)) {
    status = cast_error_set(&err, CAST_ERR_IO, "'%s' cannot be written: %s", path,
                            errno ? strerror(errno) : "HDF5 refused it");
    unlink(temporary);
  }
  PetscCall(PetscFree2(part.points, part.temperature));
  PetscCall(PetscFree3(part.cells, part.offsets, part.types));
  PetscCall(collective_check(comm, status, &err));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode field_file_write_series(const char *path, PetscInt n, char *const *names, const PetscReal *time)
{
  FILE *file = fopen(path, "w");

  PetscFunctionBeginUser;
  PetscCheck(file, PETSC_COMM_SELF, PETSC_ERR_USER, "'%s' cannot be written: %s", path, strerror(errno));
  fprintf(file, "{ \"file-series-version\": \"1.0\", \"files\": [\n");
  for (PetscInt i = 0; i < n; i++)
    fprintf(file, "  { \"name\": \"%s\", \"time\": %.9g }%s\n", names[i], (double)time[i], i + 1 < n ? "," : "");
  fprintf(file, "] }\n");
  PetscCheck(fclose(file) == 0, PETSC_COMM_SELF, PETSC_ERR_USER, "'%s' cannot be written: %s", path, strerror(errno));
  PetscFunctionReturn(PETSC_SUCCESS);
}
