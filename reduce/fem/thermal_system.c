/* thermal_system.c - E, K, B and the ambient column from PETSc's finite-element layer (P1 or P2 on simplices). */
#include "reduce/fem/conduction_forms.h"
#include "reduce/fem/thermal_system.h"
#include "reduce/petsc/petsc_compat.h"

#include <petscfe.h>
#include <petscsnes.h>

/* The temperature field: one component of the order asked for; gives the DM its section. */
static PetscErrorCode set_temperature_field(DM dm, PetscInt order, PetscDS *ds, PetscFE *fe)
{
  PetscInt dim;

  PetscFunctionBeginUser;
  PetscCall(DMGetDimension(dm, &dim));
  PetscCall(PetscFECreateLagrange(PetscObjectComm((PetscObject)dm), dim, 1, PETSC_TRUE, order, PETSC_DETERMINE, fe));
  PetscCall(PetscObjectSetName((PetscObject)*fe, "temperature"));
  PetscCall(DMSetField(dm, 0, NULL, (PetscObject)*fe));
  PetscCall(DMCreateDS(dm));
  PetscCall(DMGetDS(dm, ds));
  PetscCall(conduction_forms_set(*ds));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* (kappa, rho c) of each cell by its region, as a local vector on a clone of the DM. */
static PetscErrorCode fill_material_field(DM dm_aux, const ReduceConfig *config, Vec material)
{
  DMLabel label;
  PetscInt first, last;
  PetscScalar *values;

  PetscFunctionBeginUser;
  PetscCall(DMGetLabel(dm_aux, "region", &label));
  PetscCheck(label, PetscObjectComm((PetscObject)dm_aux), PETSC_ERR_ARG_WRONGSTATE,
             "mesh: it has no label \"region\", so no cell has a material");
  PetscCall(DMPlexGetHeightStratum(dm_aux, 0, &first, &last));
  PetscCall(VecGetArray(material, &values));
  for (PetscInt cell = first; cell < last; cell++) {
    PetscInt region;
    PetscScalar *of_cell;
    PetscCall(DMLabelGetValue(label, cell, &region));
    PetscCheck(region >= 0 && (size_t)region < config->n_regions, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
               "mesh: cell %" PetscInt_FMT " is in region %" PetscInt_FMT ", but the input has %zu regions", cell,
               region, config->n_regions);
    const Material *of_region = &config->region[region].material;
    PetscCall(DMPlexPointLocalRef(dm_aux, cell, values, &of_cell));
    of_cell[AUX_CONDUCTIVITY] = of_region->conductivity;
    of_cell[AUX_HEAT_CAPACITY] = of_region->density * of_region->specific_heat;
  }
  PetscCall(VecRestoreArray(material, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode check_materials(MPI_Comm comm, const ReduceConfig *config)
{
  PetscFunctionBeginUser;
  for (size_t r = 0; r < config->n_regions; r++) {
    const Material *of_region = &config->region[r].material;
    PetscCheck(of_region->conductivity > 0 && of_region->density > 0 && of_region->specific_heat > 0, comm,
               PETSC_ERR_ARG_OUTOFRANGE,
               "region \"%s\": conductivity %g W/(m K), density %g kg/m3 and specific heat %g J/(kg K) must all be "
               "above zero",
               config->region[r].name, of_region->conductivity, of_region->density, of_region->specific_heat);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode attach_materials(DM dm, PetscFE fe, const ReduceConfig *config)
{
  DM dm_aux;
  PetscFE fe_aux;
  Vec material;
  PetscInt dim;

  PetscFunctionBeginUser;
  PetscCall(check_materials(PetscObjectComm((PetscObject)dm), config));
  PetscCall(DMGetDimension(dm, &dim));
  PetscCall(DMClone(dm, &dm_aux));
  PetscCall(
      PetscFECreateLagrange(PetscObjectComm((PetscObject)dm), dim, AUX_COUNT, PETSC_TRUE, 0, PETSC_DETERMINE, &fe_aux));
  PetscCall(PetscFECopyQuadrature(fe, fe_aux));
  PetscCall(DMSetField(dm_aux, 0, NULL, (PetscObject)fe_aux));
  PetscCall(DMCreateDS(dm_aux));
  PetscCall(DMCreateLocalVector(dm_aux, &material));
  PetscCall(fill_material_field(dm_aux, config, material));
  PetscCall(DMSetAuxiliaryVec(dm, NULL, 0, 0, material));
  PetscCall(VecDestroy(&material));
  PetscCall(PetscFEDestroy(&fe_aux));
  PetscCall(DMDestroy(&dm_aux));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode mark_symmetric(Mat A)
{
  PetscFunctionBeginUser;
  PetscCall(MatSetOption(A, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(MatSetOption(A, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  PetscCall(MatSetOption(A, MAT_SPD, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* PETSc hangs what it knows of each cell's geometry, 1.5 KB of it, on the list of cells that the depth label holds, and
 * clones of the DM share the list: one of its own before integration and another one after let go of it. */
static PetscErrorCode renew_cell_list(DM dm)
{
  DMLabel depth;
  IS cells, copy;
  PetscInt dim;

  PetscFunctionBeginUser;
  PetscCall(DMGetDimension(dm, &dim));
  PetscCall(DMPlexGetDepthLabel(dm, &depth));
  PetscCall(DMLabelGetStratumIS(depth, dim, &cells));
  PetscCall(ISDuplicate(cells, &copy));
  PetscCall(ISDestroy(&cells));
  PetscCall(DMLabelSetStratumIS(depth, dim, copy));
  PetscCall(ISDestroy(&copy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Volume integrals: E with the storage form alone, K with the conduction form alone. */
static PetscErrorCode integrate_cells(DM dm, PetscDS ds, Mat E, Mat K)
{
  Vec at;

  PetscFunctionBeginUser;
  PetscCall(DMGetLocalVector(dm, &at)); // the forms are linear: the point of linearisation does not enter
  PetscCall(VecZeroEntries(at));
  PetscCall(renew_cell_list(dm));
  PetscCall(conduction_forms_select(ds, PETSC_FALSE, PETSC_TRUE, 0.0));
  PetscCall(DMPlexSNESComputeJacobianFEM(dm, at, E, E, NULL));
  PetscCall(conduction_forms_select(ds, PETSC_TRUE, PETSC_FALSE, 0.0));
  PetscCall(DMPlexSNESComputeJacobianFEM(dm, at, K, K, NULL));
  PetscCall(renew_cell_list(dm));
  PetscCall(DMRestoreLocalVector(dm, &at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* share[i] = int phi_i/area over one (flat) face, i in the order of the face's closure, [n_share] */
static PetscErrorCode face_shares(PetscFE fe, PetscInt *n_share, PetscReal **share)
{
  PetscFE of_face;
  PetscQuadrature quadrature;
  PetscTabulation table;
  const PetscReal *points, *weights;
  PetscInt n_points;
  PetscReal total = 0.0;

  PetscFunctionBeginUser;
  PetscCall(PetscFEGetHeightSubspace(fe, 1, &of_face));
  PetscCall(PetscFEGetFaceQuadrature(fe, &quadrature));
  PetscCall(PetscQuadratureGetData(quadrature, NULL, NULL, &n_points, &points, &weights));
  PetscCall(PetscFECreateTabulation(of_face, 1, n_points, points, 0, &table));
  PetscCall(PetscFEGetDimension(of_face, n_share));
  PetscCall(PetscCalloc1((size_t)*n_share, share));
  for (PetscInt q = 0; q < n_points; q++) {
    total += weights[q];
    for (PetscInt i = 0; i < *n_share; i++) (*share)[i] += weights[q] * table->T[0][q * *n_share + i];
  }
  for (PetscInt i = 0; i < *n_share; i++) (*share)[i] /= total;
  PetscCall(PetscTabulationDestroy(&table));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* int_Gamma_l phi_i dA as a global vector [m2]. Only the patch's own faces are visited: PETSc's boundary residual goes
 * through the whole mesh for each of m patches. */
static PetscErrorCode integrate_patch(DM dm, DMLabel label, PetscInt patch, PetscInt n_share, const PetscReal *of_face,
                                      Vec share)
{
  Vec local;
  IS faces;
  const PetscInt *face;
  PetscInt n_faces = 0;
  PetscScalar *values;

  PetscFunctionBeginUser;
  PetscCall(DMGetLocalVector(dm, &local));
  PetscCall(VecZeroEntries(local));
  PetscCall(PetscMalloc1((size_t)n_share, &values));
  PetscCall(DMLabelGetStratumIS(label, patch, &faces));
  if (faces) {
    PetscCall(ISGetLocalSize(faces, &n_faces));
    PetscCall(ISGetIndices(faces, &face));
    for (PetscInt f = 0; f < n_faces; f++) {
      PetscReal area;
      PetscCall(DMPlexComputeCellGeometryFVM(dm, face[f], &area, NULL, NULL));
      for (PetscInt i = 0; i < n_share; i++) values[i] = area * of_face[i];
      PetscCall(DMPlexVecSetClosure(dm, NULL, local, face[f], values, ADD_VALUES));
    }
    PetscCall(ISRestoreIndices(faces, &face));
  }
  PetscCall(ISDestroy(&faces));
  PetscCall(PetscFree(values));
  PetscCall(VecZeroEntries(share));
  PetscCall(DMLocalToGlobal(dm, local, ADD_VALUES, share));
  PetscCall(DMRestoreLocalVector(dm, &local));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Surface integrals: the columns of B, the ambient column, and the Robin walls' share of K. */
static PetscErrorCode integrate_patches(MouldMesh *mesh, PetscDS ds, PetscFE fe, ThermalSystem *system)
{
  DMLabel label;
  PetscInt n_share;
  PetscReal *of_face;
  PetscWeakForm form;
  Vec share, at;

  PetscFunctionBeginUser;
  PetscCall(DMGetLabel(mesh->dm, "patch", &label));
  PetscCheck(label, PetscObjectComm((PetscObject)mesh->dm), PETSC_ERR_ARG_WRONGSTATE,
             "mesh: it has no label \"patch\", so no heat can enter");
  PetscCall(PetscDSGetWeakForm(ds, &form));
  PetscCall(face_shares(fe, &n_share, &of_face));
  PetscCall(DMGetGlobalVector(mesh->dm, &share));
  PetscCall(DMGetLocalVector(mesh->dm, &at));
  PetscCall(VecZeroEntries(at));
  for (PetscInt l = 0; l < mesh->n_patches; l++) {
    PetscReal area, h = mesh->patch[l].h;
    Vec column;
    PetscCall(integrate_patch(mesh->dm, label, l, n_share, of_face, share));
    PetscCall(VecSum(share, &area));
    PetscCheck(area > 0, PetscObjectComm((PetscObject)mesh->dm), PETSC_ERR_ARG_OUTOFRANGE,
               "patch %" PetscInt_FMT " (\"%s\"): its area is %g m2", l, mesh->patch[l].name, (double)area);
    system->area[l] = area;
    PetscCall(MatDenseGetColumnVecWrite(system->B, l, &column));
    PetscCall(VecCopy(share, column));
    PetscCall(VecScale(column, 1.0 / area));
    PetscCall(MatDenseRestoreColumnVecWrite(system->B, l, &column));
    PetscCheck(h >= 0, PetscObjectComm((PetscObject)mesh->dm), PETSC_ERR_ARG_OUTOFRANGE,
               "patch %" PetscInt_FMT " (\"%s\"): heat transfer coefficient %g W/(m2 K) is below zero", l,
               mesh->patch[l].name, (double)h);
    if (h == 0) continue;
    PetscCall(VecAXPY(system->ambient, h, share));
    PetscCall(conduction_forms_set_wall(ds, label, l));
    PetscCall(conduction_forms_select(ds, PETSC_FALSE, PETSC_FALSE, h));
    PetscCall(DMPlexComputeBdJacobianSingle(mesh->dm, 0.0, form, label, 1, &l, 0, at, NULL, 0.0, system->K, system->K));
    system->singular = PETSC_FALSE;
  }
  PetscCall(PetscFree(of_face));
  PetscCall(DMRestoreLocalVector(mesh->dm, &at));
  PetscCall(DMRestoreGlobalVector(mesh->dm, &share));
  PetscCall(MatAssemblyBegin(system->B, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(system->B, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyBegin(system->K, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(system->K, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A matrix of zeros with the pattern of the elements, found by one pass over the cells. (DMCreateMatrix finds it by the
 * neighbours of each mesh point, in several times the time of the assembly itself.) */
static PetscErrorCode create_matrix(DM dm, Mat *A)
{
  Mat pattern;
  PetscSection local, global;
  PetscInt first, last, n, N;

  PetscFunctionBeginUser;
  PetscCall(DMSetMatrixPreallocateSkip(dm, PETSC_TRUE));
  PetscCall(DMCreateMatrix(dm, A));
  PetscCall(MatGetLocalSize(*A, &n, NULL));
  PetscCall(MatGetSize(*A, &N, NULL));
  PetscCall(MatCreate(PetscObjectComm((PetscObject)dm), &pattern));
  PetscCall(MatSetType(pattern, MATPREALLOCATOR));
  PetscCall(MatSetSizes(pattern, n, n, N, N));
  PetscCall(MatSetUp(pattern));
  PetscCall(DMGetLocalSection(dm, &local));
  PetscCall(DMGetGlobalSection(dm, &global));
  PetscCall(DMPlexGetHeightStratum(dm, 0, &first, &last));
  for (PetscInt cell = first; cell < last; cell++) {
    PetscInt k, *index;
    PetscScalar *zeros;
    PetscCall(DMPlexGetClosureIndices(dm, local, global, cell, PETSC_TRUE, &k, &index, NULL, NULL));
    PetscCall(DMGetWorkArray(dm, k * k, MPIU_SCALAR, &zeros));
    PetscCall(PetscArrayzero(zeros, k * k));
    PetscCall(MatSetValues(pattern, k, index, k, index, zeros, INSERT_VALUES));
    PetscCall(DMRestoreWorkArray(dm, k * k, MPIU_SCALAR, &zeros));
    PetscCall(DMPlexRestoreClosureIndices(dm, local, global, cell, PETSC_TRUE, &k, &index, NULL, NULL));
  }
  PetscCall(MatAssemblyBegin(pattern, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(pattern, MAT_FINAL_ASSEMBLY));
  PetscCall(MatPreallocatorPreallocate(pattern, PETSC_TRUE, *A));
  PetscCall(MatDestroy(&pattern));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode allocate(MouldMesh *mesh, ThermalSystem *system)
{
  PetscInt n_local;

  PetscFunctionBeginUser;
  PetscCall(create_matrix(mesh->dm, &system->E));
  PetscCall(MatDuplicate(system->E, MAT_DO_NOT_COPY_VALUES, &system->K));
  PetscCall(MatCreateVecs(system->E, NULL, &system->ambient));
  PetscCall(VecZeroEntries(system->ambient));
  PetscCall(VecGetLocalSize(system->ambient, &n_local));
  PetscCall(VecGetSize(system->ambient, &system->n));
  system->m = mesh->n_patches;
  PetscCall(MatCreateDense(PetscObjectComm((PetscObject)mesh->dm), n_local, PETSC_DECIDE, system->n, system->m, NULL,
                           &system->B));
  PetscCall(PetscCalloc1(system->m, &system->area));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode thermal_system_create(MouldMesh *mesh, const ReduceConfig *config, ThermalSystem **out)
{
  ThermalSystem *system;
  PetscDS ds;
  PetscFE fe;

  PetscFunctionBeginUser;
  PetscCheck(config->order == 1 || config->order == 2, PetscObjectComm((PetscObject)mesh->dm), PETSC_ERR_SUP,
             "elements of order %d: only orders 1 and 2 are there", config->order);
  PetscCheck(mesh->n_patches > 0, PetscObjectComm((PetscObject)mesh->dm), PETSC_ERR_ARG_OUTOFRANGE,
             "mesh: it has no patch, so no heat can enter");
  PetscCall(PetscNew(&system));
  *out = system;
  system->singular = PETSC_TRUE;
  PetscCall(set_temperature_field(mesh->dm, config->order, &ds, &fe));
  PetscCall(attach_materials(mesh->dm, fe, config));
  PetscCall(allocate(mesh, system));
  PetscCall(integrate_cells(mesh->dm, ds, system->E, system->K));
  PetscCall(integrate_patches(mesh, ds, fe, system));
  PetscCall(mark_symmetric(system->E));
  PetscCall(mark_symmetric(system->K));
  PetscCall(PetscFEDestroy(&fe));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* K 1 = 0 to rounding: nothing fixes the temperature. */
static PetscErrorCode detect_singular(ThermalSystem *system)
{
  Vec ones, K_ones;
  PetscReal of_ones, of_K;

  PetscFunctionBeginUser;
  PetscCall(MatCreateVecs(system->K, &ones, &K_ones));
  PetscCall(VecSet(ones, 1.0));
  PetscCall(MatMult(system->K, ones, K_ones));
  PetscCall(VecNorm(K_ones, NORM_INFINITY, &of_ones));
  PetscCall(MatNorm(system->K, NORM_INFINITY, &of_K));
  system->singular = (PetscBool)(of_ones <= 1e-12 * of_K);
  PetscCall(VecDestroy(&ones));
  PetscCall(VecDestroy(&K_ones));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode thermal_system_wrap(Mat E, Mat K, Mat B, Vec ambient, const PetscReal *area, ThermalSystem **out)
{
  ThermalSystem *system;

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&system));
  *out = system;
  PetscCall(PetscObjectReference((PetscObject)E));
  PetscCall(PetscObjectReference((PetscObject)K));
  PetscCall(PetscObjectReference((PetscObject)B));
  system->E = E;
  system->K = K;
  system->B = B;
  PetscCall(MatGetSize(B, &system->n, &system->m));
  if (ambient) {
    PetscCall(PetscObjectReference((PetscObject)ambient));
    system->ambient = ambient;
  } else {
    PetscCall(MatCreateVecs(E, NULL, &system->ambient));
    PetscCall(VecZeroEntries(system->ambient));
  }
  PetscCall(PetscMalloc1(system->m, &system->area));
  for (PetscInt l = 0; l < system->m; l++) system->area[l] = area ? area[l] : 1.0;
  PetscCall(mark_symmetric(E));
  PetscCall(mark_symmetric(K));
  PetscCall(detect_singular(system));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode thermal_system_destroy(ThermalSystem **system)
{
  PetscFunctionBeginUser;
  if (!*system) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatDestroy(&(*system)->E));
  PetscCall(MatDestroy(&(*system)->K));
  PetscCall(MatDestroy(&(*system)->B));
  PetscCall(VecDestroy(&(*system)->ambient));
  PetscCall(PetscFree((*system)->area));
  PetscCall(PetscFree(*system));
  PetscFunctionReturn(PETSC_SUCCESS);
}
