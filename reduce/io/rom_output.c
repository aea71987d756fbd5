#include "reduce/io/rom_output.h"

#include <stdlib.h>
#include <string.h>
#include "reduce/io/provenance.h"
#include "reduce/io/wall_geometry.h"
#include "reduce/petsc/collective.h"
#include "reduce/petsc/petsc_compat.h"

/* 1^T E 1, J/K */
static PetscErrorCode measure_heat_capacity(const ThermalSystem *system, double *capacity)
{
  Vec ones, E_ones;
  PetscScalar sum;

  PetscFunctionBeginUser;
  PetscCall(MatCreateVecs(system->E, &ones, &E_ones));
  PetscCall(VecSet(ones, 1.0));
  PetscCall(MatMult(system->E, ones, E_ones));
  PetscCall(VecSum(E_ones, &sum));
  PetscCall(VecDestroy(&ones));
  PetscCall(VecDestroy(&E_ones));
  *capacity = PetscRealPart(sum);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static CastStatus describe_materials(const ReduceConfig *config, RomData *rom, CastError *err)
{
  rom->n_materials = config->n_regions;
  rom->material = calloc(config->n_regions + 1, sizeof *rom->material); // none is no reason for NULL
  CAST_CHECK(rom->material, err, CAST_ERR_MEMORY, "no memory for the ROM's materials");
  for (size_t i = 0; i < config->n_regions; i++) {
    const Material *from = &config->region[i].material;
    RomMaterial *to = &rom->material[i];
    snprintf(to->region, sizeof to->region, "%s", config->region[i].name);
    snprintf(to->name, sizeof to->name, "%s", from->name);
    memcpy(to->sha256, from->sha256, sizeof to->sha256);
    to->conductivity = from->conductivity;
    to->density = from->density;
    to->specific_heat = from->specific_heat;
    to->reference_temperature = from->reference_temperature;
  }
  return CAST_OK;
}

static void describe_model(const ThermalSystem *system, const ReducedModel *model, RomData *rom)
{
  rom->r = (size_t)model->r;
  rom->m = (size_t)model->m;
  rom->n_full = (size_t)system->n;
  rom->lambda = model->lambda;
  rom->B = model->B;
  rom->ambient = model->ambient;
  rom->constant = model->constant;
  rom->n_shifts = (size_t)model->n_shifts;
  rom->shifts = model->shifts;
  rom->moments = model->moments;
  rom->certificate = model->certificate;
}

static void describe_geometry(const MouldMesh *mesh, const WallGeometry *geometry, RomData *rom)
{
  rom->patch = mesh->patch;
  rom->min_edge = mesh->shortest_edge;
  rom->band = geometry->band;
  rom->n_points = geometry->n_points;
  rom->points = geometry->points;
  rom->basis = geometry->basis;
  rom->n_triangles = geometry->n_triangles;
  rom->triangles = geometry->triangles;
  rom->triangle_patch = geometry->triangle_patch;
  rom->n_tetrahedra = geometry->n_tetrahedra;
  rom->tetrahedra = geometry->tetrahedra;
}

/* Inputs of a model from matrices: all that is known of them is their area. */
static CastStatus describe_inputs(const ThermalSystem *system, RomData *rom, CastError *err)
{
  rom->patch = calloc((size_t)system->m, sizeof *rom->patch);
  CAST_CHECK(rom->patch, err, CAST_ERR_MEMORY, "no memory for %d inputs", (int)system->m);
  for (PetscInt l = 0; l < system->m; l++) {
    snprintf(rom->patch[l].name, sizeof rom->patch[l].name, "inputs/%d", (int)l + 1);
    snprintf(rom->patch[l].surface, sizeof rom->patch[l].surface, "inputs");
    rom->patch[l].area = system->area[l];
  }
  return CAST_OK;
}

static void describe_task(const ReduceConfig *config, RomData *rom)
{
  rom->title = config->title;
  rom->tolerance = config->reduction.tolerance;
  rom->t_start = config->reduction.t_start;
  rom->t_end = config->reduction.t_end;
  snprintf(rom->method, sizeof rom->method, "%s", reduce_config_method(config->reduction.method));
}

static void tell_band(const ReduceConfig *config, const WallGeometry *geometry, Log *log)
{
  const double megabytes = 1e-6 * (double)sizeof(float) * (double)geometry->n_points * (double)geometry->r;
  log_info(log,
           "near-wall geometry: %zu triangles, %zu tetrahedra within %.3g mm of the cavity, %zu points, basis %.3g MB",
           geometry->n_triangles, geometry->n_tetrahedra, geometry->band * 1e3, geometry->n_points, megabytes);
  if (geometry->band < config->band)
    log_warn(
        log,
        "the near-wall band is %.3g mm thick, not %.3g mm: its basis would have taken more than output.basis_budget, "
        "%.4g MB. Coupling 'embedded' and pictures of the mould reach no deeper",
        geometry->band * 1e3, config->band * 1e3, 1e-6 * config->basis_budget);
}

/* `rom` holds what mesh, system and model gave; everything in it is borrowed but materials and provenance. */
static CastStatus write_file(const ReduceConfig *config, const ReducedModel *model, const RomOutputRun *run,
                             RomData *rom, CastError *err)
{
  const int ranks = rom->provenance.ranks;
  describe_task(config, rom);
  CAST_CALL(describe_materials(config, rom, err));
  CastStatus status = provenance_create(config, run->command, &rom->provenance, err);
  rom->provenance.ranks = ranks;
  rom->provenance.seconds_mesh = run->seconds_mesh;
  rom->provenance.seconds_assembly = run->seconds_assembly;
  rom->provenance.seconds_reduction = model->seconds_reduction;
  rom->provenance.seconds_certificate = model->seconds_certificate;
  if (status == CAST_OK) status = rom_write(rom, config->rom_path, err);
  provenance_destroy(&rom->provenance);
  free(rom->material);
  return status;
}

PetscErrorCode rom_output_write(const ReduceConfig *config, const MouldMesh *mesh, const ThermalSystem *system,
                                const ReducedModel *model, const RomOutputRun *run)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)system->E);
  CastError err = {CAST_OK, ""};
  CastStatus status = CAST_OK;
  WallGeometry geometry = {0};
  RomPatch *inputs = NULL;
  RomData rom = {0};
  PetscMPIInt rank;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &rom.provenance.ranks));
  PetscCall(measure_heat_capacity(system, &rom.heat_capacity));
  describe_model(system, model, &rom);
  if (mesh) {
    const ModelBasis basis = {model->V, model->basis, model->modes, model->r};
    PetscCall(wall_geometry_gather(mesh, &basis, config->band, config->basis_budget, &geometry));
    PetscCheck(geometry.r == model->r, comm, PETSC_ERR_ARG_INCOMP,
               "the basis has %" PetscInt_FMT " columns for %" PetscInt_FMT " states", geometry.r, model->r);
    describe_geometry(mesh, &geometry, &rom);
  } else {
    status = describe_inputs(system, &rom, &err);
    inputs = rom.patch;
  }
  if (rank == 0 && status == CAST_OK) {
    status = write_file(config, model, run, &rom, &err);
    if (status == CAST_OK && mesh) tell_band(config, &geometry, run->log);
  }
  free(inputs);
  PetscCall(wall_geometry_destroy(&geometry));
  PetscCall(collective_check(comm, status, &err));
  PetscFunctionReturn(PETSC_SUCCESS);
}
