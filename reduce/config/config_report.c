/* config_report.c - mould.yaml as it was understood. */
#include "reduce/config/config.h"

#include <math.h>

static void print_matrices(const MatricesConfig *matrices, FILE *out)
{
  fprintf(out, "matrices.E              %s, in J/K\n", matrices->E);
  fprintf(out, "matrices.%s              %s, in W/K\n", matrices->K_is_A ? "A" : "K", matrices->K);
  fprintf(out, "matrices.B              %s, %s\n", matrices->B,
          matrices->flux ? "of a flux in W/m2: each column is divided by its sum, the patch's area in m2"
                         : "of watts: each column sums to 1");
  fprintf(out, "matrices.C              %s\n", matrices->C ? matrices->C : "B^T");
}

static void print_geometry(const ReduceConfig *config, FILE *out)
{
  fprintf(out, "geometry.file           %s\n", config->geometry_path);
  fprintf(out, "geometry.sha256         %s\n", config->geometry_sha256);
  fprintf(out, "geometry.unit           %g m\n", config->geometry_unit);
  const FlaskConfig *flask = &config->flask;
  if (flask->kind == FLASK_BLOCK)
    fprintf(out, "geometry.flask          block of %g m x %g m x %g m from (%g, %g, %g) m\n", flask->size[0],
            flask->size[1], flask->size[2], flask->corner[0], flask->corner[1], flask->corner[2]);
  if (flask->kind == FLASK_CYLINDER)
    fprintf(out, "geometry.flask          cylinder of radius %g m, height %g m, on (%g, %g, %g) m\n", flask->radius,
            flask->height, flask->base[0], flask->base[1], flask->base[2]);
  if (flask->kind != FLASK_NONE) fprintf(out, "geometry.split_angle    %g deg\n", config->split_angle * 180.0 / M_PI);
  for (size_t i = 0; i < config->n_groups; i++) {
    const GroupConfig *group = &config->group[i];
    fprintf(out, "geometry.groups         %s: %s", group->name, group->dimension == 2 ? "surfaces" : "volumes");
    for (size_t k = 0; k < group->n_tags; k++) fprintf(out, " %d", group->tags[k]);
    if (group->has_box)
      fprintf(out, " within (%g, %g, %g) to (%g, %g, %g) m", group->box[0], group->box[1], group->box[2], group->box[3],
              group->box[4], group->box[5]);
    fprintf(out, "%s\n", group->rest ? " that no other group holds" : "");
  }
}

static void print_regions(const ReduceConfig *config, FILE *out)
{
  for (size_t i = 0; i < config->n_regions; i++) {
    const Material *material = &config->region[i].material;
    fprintf(out, "regions                 %s: %s, %g W/(m K), %g kg/m3, %g J/(kg K)", config->region[i].name,
            material->name, material->conductivity, material->density, material->specific_heat);
    if (isnan(material->reference_temperature))
      fprintf(out, ", temperature of these values not stated\n");
    else
      fprintf(out, ", taken at %g K\n", material->reference_temperature);
  }
}

static void print_layers(const CavitySurfaceConfig *surface, FILE *out)
{
  const LayersConfig *layers = &surface->layers;
  if (layers->kind == LAYERS_NONE) return;
  fprintf(out, "cavity.surfaces         %s: layers, the first ", surface->name);
  if (layers->first > 0)
    fprintf(out, "%g m", layers->first);
  else
    fprintf(out, "by the thermal depth at the first time");
  fprintf(out, ", growing by %g, %d at most\n", layers->growth, layers->count);
}

static void print_surfaces(const ReduceConfig *config, FILE *out)
{
  for (size_t i = 0; i < config->n_boundaries; i++) {
    const BoundaryConfig *boundary = &config->boundary[i];
    if (boundary->kind == BOUNDARY_ROBIN)
      fprintf(out, "boundaries              %s: robin, h = %g W/(m2 K)", boundary->name, boundary->h);
    else
      fprintf(out, "boundaries              %s: %s", boundary->name,
              boundary->kind == BOUNDARY_FIXED ? "fixed at the ambient temperature" : "insulated");
    if (boundary->patch_size > 0) fprintf(out, ", patches of %g m x %g m", boundary->patch_size, boundary->patch_size);
    fprintf(out, "\n");
  }
  for (size_t i = 0; i < config->n_cavity; i++) {
    const CavitySurfaceConfig *surface = &config->cavity[i];
    fprintf(out, "cavity.surfaces         %s: ", surface->name);
    if (surface->patch_size > 0)
      fprintf(out, "patches of %g m x %g m", surface->patch_size, surface->patch_size);
    else
      fprintf(out, "one patch");
    if (surface->mesh_size > 0) fprintf(out, ", mesh size %g m", surface->mesh_size);
    fprintf(out, "\n");
    print_layers(surface, out);
  }
  if (config->contact > 0) fprintf(out, "cavity.contact          %g W/(m2 K) at best\n", config->contact);
}

static void print_reduction(const ReductionConfig *reduction, FILE *out)
{
  fprintf(out, "reduction.method        %s\n", reduce_config_method(reduction->method));
  fprintf(out, "reduction.times         %g s to %g s\n", reduction->t_start, reduction->t_end);
  fprintf(out, "reduction.tolerance     %g\n", reduction->tolerance);
  if (reduction->method == REDUCTION_ARNOLDI)
    fprintf(out, "reduction.moments       %ld at s0 = %g 1/s\n", reduction->moments, reduction->s0);
  else if (reduction->method == REDUCTION_MODAL && reduction->modes == 0)
    fprintf(out, "reduction.modes         five an input\n");
  else if (reduction->method == REDUCTION_MODAL)
    fprintf(out, "reduction.modes         %ld\n", reduction->modes);
  else if (reduction->n_shifts == 0)
    fprintf(out, "reduction.shifts        chosen by the program\n");
  for (size_t i = 0; i < reduction->n_shifts; i++)
    fprintf(out, "reduction.shifts        %g 1/s\n", reduction->shifts[i]);
  fprintf(out, "reduction.deflation     %g\n", reduction->deflation);
  fprintf(out, "reduction.second_stage  %s\n", reduction->second_stage ? "yes" : "no");
  if (reduction->second_stage) fprintf(out, "reduction.second_stage_weight  %g\n", reduction->early_weight);
  fprintf(out, "reduction.solver        %s, tolerance %g where it iterates\n",
          reduction->iterative ? "iterative" : "automatic", reduction->solver_rtol);
  if (reduction->method == REDUCTION_RATIONAL)
    fprintf(out, "reduction.basis         %s\n",
            reduction->basis == BASIS_MEMORY ? "memory"
            : reduction->basis == BASIS_DISK ? "disk"
                                             : "in memory up to 4 GB, else on disk");
}

void reduce_config_print(const ReduceConfig *config, FILE *out)
{
  fprintf(out, "title                   %s\n", config->title);
  if (config->matrices) {
    print_matrices(config->matrices, out);
  } else {
    print_geometry(config, out);
    print_regions(config, out);
    print_surfaces(config, out);
  }
  if (!config->matrices && config->geometry_kind != GEOMETRY_MESH)
    fprintf(out, "mesh                    grows by %g per length from the cavity wall, up to %g m\n", config->growth,
            config->outside_size);
  fprintf(out, "mesh.order              %d\n", config->order);
  print_reduction(&config->reduction, out);
  fprintf(out, "output.file             %s\n", config->rom_path);
  if (!config->matrices) fprintf(out, "output.band             %g m\n", config->band);
  if (!config->matrices) fprintf(out, "output.basis_budget     %g bytes\n", config->basis_budget);
}
