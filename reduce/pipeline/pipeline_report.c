#include "reduce/pipeline/pipeline_report.h"

#include <math.h>
#include <petscdmplex.h>
#include <string.h>
#include "reduce/mesh/tets/resolution.h"
#include "reduce/petsc/petsc_compat.h"

enum { FEW_TRIANGLES = 4 };
static const double POOR_QUALITY = 0.05; // radius ratio

static PetscErrorCode count_cells(DM dm, PetscInt *n_cells)
{
  PetscInt first, last;

  PetscFunctionBeginUser;
  PetscCall(DMPlexGetHeightStratum(dm, 0, &first, &last));
  *n_cells = last - first; // no overlap: each cell is on one rank
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, n_cells, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)dm)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void report_surfaces(const MouldMesh *mesh, const ReduceConfig *config, Log *log)
{
  PetscInt l = 0;
  for (size_t s = 0; s < config->n_cavity; s++) {
    const PetscInt first = l;
    double total = 0.0, least = INFINITY, most = 0.0;
    for (; l < mesh->n_cavity && strcmp(mesh->patch[l].surface, config->cavity[s].name) == 0; l++) {
      total += mesh->patch[l].area;
      least = fmin(least, mesh->patch[l].area);
      most = fmax(most, mesh->patch[l].area);
    }
    log_info(log, "  cavity surface %s: %.4g mm2, %" PetscInt_FMT " patches of %.3g to %.3g mm2",
             config->cavity[s].name, total * 1e6, l - first, least * 1e6, most * 1e6);
  }
}

/* The layer must suit each material; which of them stand at the wall is not known here. */
static void judge_first_layer(const MouldMesh *mesh, const ReduceConfig *config, Log *log)
{
  static const double TARGET = 0.01;
  const Material *worst = NULL;
  double error = 0.0;
  for (size_t i = 0; i < config->n_regions; i++) {
    const Material *material = &config->region[i].material;
    const double of_this = resolution_error(config, material, mesh->thick_layer);
    if (worst && of_this <= error) continue;
    worst = material;
    error = of_this;
  }
  if (!worst || error <= TARGET) return;
  const double depth = resolution_depth(worst, config->reduction.t_start);
  log_warn(
      log,
      "the elements at the cavity wall are %.3g mm high (median; 95 %% of the area below %.3g mm), but by t_start = "
      "%.3g s heat has gone only %.3g mm into the mould: about %.0f %% of error in early wall temperatures%s comes "
      "from the mesh. 'layers: auto' under cavity, or a first layer of %.2g mm, brings it below 1 %%%s",
      mesh->first_layer * 1e3, mesh->thick_layer * 1e3, config->reduction.t_start, depth * 1e3, 100.0 * error,
      config->contact > 0 ? " (over the difference to the melt, behind the contact expected)" : "",
      1e3 * resolution_layer(config, worst),
      config->contact > 0 ? "" : "; 'contact', the best that is expected, tells what is really needed");
}

static void warn_small_patches(const MouldMesh *mesh, Log *log)
{
  PetscInt few = 0, worst = -1;
  for (PetscInt l = 0; mesh->triangles && l < mesh->n_cavity; l++) {
    if (mesh->triangles[l] >= FEW_TRIANGLES) continue;
    few++;
    if (worst < 0 || mesh->triangles[l] < mesh->triangles[worst]) worst = l;
  }
  if (few == 0) return;
  log_warn(log,
           "%" PetscInt_FMT " of %" PetscInt_FMT " cavity patches have fewer than %d triangles (%s has %" PetscInt_FMT
           "): a finer mesh_size or a larger patch_size is better",
           few, mesh->n_cavity, FEW_TRIANGLES, mesh->patch[worst].name, mesh->triangles[worst]);
}

PetscErrorCode pipeline_report_mesh(const MouldMesh *mesh, const ReduceConfig *config, double seconds, Log *log)
{
  PetscInt n_cells;

  PetscFunctionBeginUser;
  PetscCall(count_cells(mesh->dm, &n_cells));
  log_info(log,
           "mesh: %" PetscInt_FMT " tetrahedra, %.6g cm3, shortest cavity edge %.3g mm, first layer %.3g mm, worst "
           "quality %.2f at (%.4g, %.4g, %.4g) mm (%.1f s)",
           n_cells, mesh->volume * 1e6, mesh->shortest_edge * 1e3, mesh->first_layer * 1e3, mesh->worst_quality,
           mesh->worst_place[0] * 1e3, mesh->worst_place[1] * 1e3, mesh->worst_place[2] * 1e3, seconds);
  if (mesh->n_layer_cells > 0)
    log_info(log,
             "  %" PetscInt_FMT " of them in thin layers at the cavity wall; 95 %% of its area have a first layer "
             "below %.3g mm",
             mesh->n_layer_cells, mesh->thick_layer * 1e3);
  report_surfaces(mesh, config, log);
  judge_first_layer(mesh, config, log);
  warn_small_patches(mesh, log);
  if (mesh->worst_quality < POOR_QUALITY)
    log_warn(log, "the worst tetrahedron, at (%.4g, %.4g, %.4g) mm, has a radius ratio of %.3g (a regular one has 1)",
             mesh->worst_place[0] * 1e3, mesh->worst_place[1] * 1e3, mesh->worst_place[2] * 1e3, mesh->worst_quality);
  PetscFunctionReturn(PETSC_SUCCESS);
}

void pipeline_report_geometry(const MouldGeometry *geometry, FILE *out)
{
  const ReduceConfig *config = geometry->config;
  for (size_t r = 0; r < config->n_regions; r++) {
    size_t n = 0;
    for (size_t i = 0; i < geometry->n_volumes; i++) n += geometry->volume[i].name == (int)r;
    fprintf(out, "geometry                region %s: %zu %s\n", config->region[r].name, n,
            n == 1 ? "volume" : "volumes");
  }
  for (size_t s = 0; s < config->n_cavity + config->n_boundaries; s++) {
    size_t n = 0;
    for (size_t i = 0; i < geometry->n_surfaces; i++) n += geometry->surface[i].name == (int)s;
    fprintf(out, "geometry                %s %s: %zu %s\n", s < config->n_cavity ? "cavity surface" : "boundary",
            reduce_config_surface_name(config, s), n, n == 1 ? "surface" : "surfaces");
  }
}
