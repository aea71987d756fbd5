/* Contents that make no mould: rom_check refuses them and rom_write does not write them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "common/rom/rom.h"
#include "tests/support/synthetic_rom.h"

typedef struct Fault {
  const char *says;
  void (*spoil)(RomData *rom);
} Fault;

// one fault a line
// clang-format off
static void no_states(RomData *rom) { rom->r = 0; }
static void too_many_states(RomData *rom) { rom->r = SIZE_MAX / 16; }
static void no_patches(RomData *rom) { rom->m = 0; }
static void no_array(RomData *rom) { free(rom->ambient); rom->ambient = NULL; }
static void lambda_nan(RomData *rom) { rom->lambda[3] = NAN; }
static void lambda_negative(RomData *rom) { rom->lambda[0] = -1e-9; }
static void lambda_disordered(RomData *rom) { rom->lambda[4] = 2 * rom->lambda[5]; }
static void input_infinite(RomData *rom) { rom->B[7] = INFINITY; }
static void input_loses_heat(RomData *rom) { rom->B[0] *= 1.0 + 1e-6; }
static void ambient_nan(RomData *rom) { rom->ambient[1] = NAN; }
static void ambient_inconsistent(RomData *rom) { rom->ambient[0] *= 1.01; }
static void constant_nan(RomData *rom) { rom->constant[0] = NAN; }
static void capacity_zero(RomData *rom) { rom->heat_capacity = 0.0; }
static void capacity_inconsistent(RomData *rom) { rom->heat_capacity *= 1.0001; }
static void capacity_of_another_material(RomData *rom) { rom->material[0].density *= 1.5; }
static void name_empty(RomData *rom) { rom->patch[1].name[0] = '\0'; }
static void name_endless(RomData *rom) { memset(rom->patch[1].name, 'x', ROM_NAME_LENGTH); }
static void name_twice(RomData *rom) { strcpy(rom->patch[3].name, rom->patch[1].name); }
static void surface_empty(RomData *rom) { rom->patch[1].surface[0] = '\0'; }
static void area_zero(RomData *rom) { rom->patch[2].area = 0.0; }
static void area_wrong(RomData *rom) { rom->patch[2].area *= 1.00001; }
static void centroid_nan(RomData *rom) { rom->patch[2].centroid[1] = NAN; }
static void h_negative(RomData *rom) { rom->patch[4].h = -5.0; }
static void fixed_without_h(RomData *rom) { rom->patch[5].fixed = true; }
static void outer_first(RomData *rom) { rom->patch[1].outer = true; }
static void all_outer(RomData *rom) { for (size_t l = 0; l < rom->m; l++) rom->patch[l].outer = true; }
static void material_without_kappa(RomData *rom) { rom->material[0].conductivity = 0.0; }
static void material_density_nan(RomData *rom) { rom->material[0].density = NAN; }
static void material_c_negative(RomData *rom) { rom->material[0].specific_heat = -1.0; }
static void material_cold(RomData *rom) { rom->material[0].reference_temperature = -3.0; }
static void material_unnamed(RomData *rom) { rom->material[0].name[0] = '\0'; }
static void no_material(RomData *rom) { rom->n_materials = 0; }
static void point_infinite(RomData *rom) { rom->points[5] = INFINITY; }
static void triangle_index(RomData *rom) { rom->triangles[4] = (int32_t)rom->n_points; }
static void triangle_index_negative(RomData *rom) { rom->triangles[4] = -1; }
static void triangle_patch_index(RomData *rom) { rom->triangle_patch[0] = (int32_t)rom->m; }
static void triangle_missing(RomData *rom) { rom->n_triangles--; }
static void triangle_turned(RomData *rom) { const int32_t a = rom->triangles[0]; rom->triangles[0] = rom->triangles[1]; rom->triangles[1] = a; }
static void triangle_collapsed(RomData *rom) { rom->triangles[1] = rom->triangles[0]; }
static void triangle_twice(RomData *rom) { memcpy(rom->triangles, rom->triangles + 3, 3 * sizeof(int32_t)); }
static void boundary_inside_out(RomData *rom) { for (size_t t = 0; t < rom->n_triangles; t++) { int32_t *v = rom->triangles + 3 * t; const int32_t a = v[0]; v[0] = v[1]; v[1] = a; } }
static void tetrahedron_index(RomData *rom) { rom->tetrahedra[2] = 1 << 30; }
static void tetrahedron_inverted(RomData *rom) { const int32_t a = rom->tetrahedra[0]; rom->tetrahedra[0] = rom->tetrahedra[1]; rom->tetrahedra[1] = a; }
static void tetrahedra_missing(RomData *rom) { rom->n_tetrahedra = 0; }
static void points_missing(RomData *rom) { rom->n_points = 3; }
static void basis_nan(RomData *rom) { rom->basis[11] = NAN; }
static void basis_of_other_points(RomData *rom) { for (size_t k = 0; k < rom->r; k++) rom->basis[k] = 0.5f * rom->basis[k]; }
static void band_zero(RomData *rom) { rom->band = 0.0; }
static void edge_nan(RomData *rom) { rom->min_edge = NAN; }
static void method_empty(RomData *rom) { rom->method[0] = '\0'; }
static void full_smaller_than_reduced(RomData *rom) { rom->n_full = rom->r - 1; }
static void moments_negative(RomData *rom) { rom->moments = -1; }
static void shift_negative(RomData *rom) { rom->shifts[0] = -1.0; }
static void shifts_absurd(RomData *rom) { rom->n_shifts = (size_t)1 << 40; }
static void tolerance_zero(RomData *rom) { rom->tolerance = 0.0; }
static void t_start_zero(RomData *rom) { rom->t_start = 0.0; }
static void t_end_before_start(RomData *rom) { rom->t_end = 0.5 * rom->t_start; }
static void bound_negative(RomData *rom) { rom->certificate.transfer_bound[0] = -1e-3; }
static void frequency_nan(RomData *rom) { rom->certificate.frequency[0] = NAN; }
static void step_error_negative(RomData *rom) { rom->certificate.step_error[0] = -1e-3; }
static void time_infinite(RomData *rom) { rom->certificate.time[0] = INFINITY; }
static void error_max_negative(RomData *rom) { rom->certificate.step_error_max = -1.0; }
static void sampled_negative(RomData *rom) { rom->certificate.sampled_patches = -1; }
static void met_without_proof(RomData *rom) { rom->certificate.met = true; }

static const Fault faults[] = {
  {"model/lambda: 0 states", no_states},
  {"model/lambda: ", too_many_states},
  {"patches/name: 0 patches", no_patches},
  {"model/ambient: is missing", no_array},
  {"model/lambda: entry 3 is nan", lambda_nan},
  {"model/lambda: entry 0 is -1e-09 1/s; a negative rate", lambda_negative},
  {"model/lambda: entry 5 (", lambda_disordered},
  {"model/B: entry 7 is inf", input_infinite},
  {"model/B: constant^T B is 1.0000", input_loses_heat},
  {"model/ambient: entry 1 is nan", ambient_nan},
  {"model/ambient: differs from Lambda constant", ambient_inconsistent},
  {"model/constant: entry 0 is nan", constant_nan},
  {"model/heat_capacity: is 0 J/K", capacity_zero},
  {"model/heat_capacity: is ", capacity_inconsistent},
  {"the materials have", capacity_of_another_material},
  {"patches/name: entry 1 is empty", name_empty},
  {"patches/name: entry 1 has no end", name_endless},
  {"patches/name: 'top/2' appears twice", name_twice},
  {"patches/surface: entry 1 is empty", surface_empty},
  {"patches/area: top/3 has 0 m2", area_zero},
  {"patches/area: top/3 has ", area_wrong},
  {"patches/centroid: entry 1 is nan", centroid_nan},
  {"patches/h: bottom has -5 W/(m2 K)", h_negative},
  {"patches/fixed: sides has a fixed temperature but h = 0", fixed_without_h},
  {"patches/outer: cavity patch 2 (top/3) stands after an outer one", outer_first},
  {"patches/outer: there is no cavity patch", all_outer},
  {"materials/conductivity: synthetic has 0 W/(m K)", material_without_kappa},
  {"materials/density: synthetic has nan kg/m3", material_density_nan},
  {"materials/specific_heat: synthetic has -1 J/(kg K)", material_c_negative},
  {"materials/reference_temperature: synthetic has -3 K", material_cold},
  {"materials/name: entry 0 is empty", material_unnamed},
  {"materials/name: there is none", no_material},
  {"geometry/points: entry 5 is inf", point_infinite},
  {"geometry/triangles: entry 4 is ", triangle_index},
  {"geometry/triangles: entry 4 is -1", triangle_index_negative},
  {"geometry/triangle_patch: entry 0 is 6", triangle_patch_index},
  {"belongs to one triangle only: the boundary is not closed", triangle_missing},
  {"is wound the same way by both its triangles", triangle_turned},
  {"uses point", triangle_collapsed},
  {"geometry/triangles: the edge from", triangle_twice},
  {"geometry/triangles: they enclose -", boundary_inside_out},
  {"geometry/tetrahedra: entry 2 is ", tetrahedron_index},
  {"geometry/tetrahedra: tetrahedron 0 at", tetrahedron_inverted},
  {"geometry/tetrahedra: there are none", tetrahedra_missing},
  {"on 3 points cannot close", points_missing},
  {"geometry/basis: entry 0, 11 is nan", basis_nan},
  {"geometry/basis: the constant temperature of 1 K is 0.5 K at point 0", basis_of_other_points},
  {"geometry/band: is 0 m", band_zero},
  {"geometry/min_edge: is nan m", edge_nan},
  {"reduction/method: is empty", method_empty},
  {"reduction/n_full: ", full_smaller_than_reduced},
  {"reduction/moments: is -1", moments_negative},
  {"reduction/shifts: entry 0 is -1 1/s", shift_negative},
  {"reduction/shifts: 1099511627776 entries", shifts_absurd},
  {"reduction/tolerance: is 0", tolerance_zero},
  {"reduction/t_start: is 0 s", t_start_zero},
  {"reduction/t_end: 0.0005 s", t_end_before_start},
  {"certificate/transfer_bound: -0.001 is negative", bound_negative},
  {"certificate/frequency: entry 0 is nan", frequency_nan},
  {"certificate/step_error: -0.001 is negative", step_error_negative},
  {"certificate/time: entry 0 is inf", time_infinite},
  {"certificate/step_error_max: -1 is negative", error_max_negative},
  {"certificate/sampled_patches: is -1", sampled_negative},
  {"certificate/met: says that the tolerance 0.001 is met, but step_error_max is nan", met_without_proof},
};
// clang-format on

static void wrong_contents_are_refused_and_not_written(void **state)
{
  (void)state;
  char folder[] = "/tmp/castrom_XXXXXX", path[64];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/a.rom.h5", folder);
  for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
    CastError err = {0};
    RomData *rom = synthetic_rom_small();
    faults[i].spoil(rom);
    assert_int_equal(rom_check(rom, &err), CAST_ERR_FORMAT);
    if (!strstr(err.message, faults[i].says)) fail_msg("'%s' does not say '%s'", err.message, faults[i].says);
    assert_int_equal(rom_write(rom, path, &err), CAST_ERR_FORMAT);
    rom_destroy(&rom);
  }
  assert_int_equal(rmdir(folder), 0); // fails unless empty
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(wrong_contents_are_refused_and_not_written)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
