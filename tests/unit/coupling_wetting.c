/* Heat between melt and mould: on the area that is wet, to the patch that is near. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/assert_close.h"
#include "tests/support/coupling_case.h"
#include "tests/support/shaped_mould.h"
#include "tests/support/voxel_mould.h"

static const double dx = COUPLING_CASE_SPACING;

/* ---- wetting ---- */

static void a_block_wets_the_wall_under_it(void **state)
{
  (void)state;
  for (int high = 1; high <= 4; high += 3) { // a film of one layer as well as a block
    const MeltCase given = coupling_case_block(COUPLING_SURFACE, 12, high);
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    const double exact = 144.0 * dx * dx, edge = 4.0 * 12.0 * dx * dx;
    // along its edge the end of the melt is known no better than to a fifth of a spacing
    assert_close(coupling_case_wetted(&melt), exact, 0.2 * edge);
    double contact = 0.0;
    for (size_t l = 0; l < melt.rom->m; l++) contact += coupling_contact_area(melt.coupling, l);
    assert_close(contact, coupling_case_wetted(&melt), 0.01 * exact);
    melt_on_mould_destroy(&melt);
  }
}

static void a_lone_particle_wets_the_square_of_the_spacing(void **state)
{
  (void)state;
  const MeltCase given = coupling_case_block(COUPLING_SURFACE, 1, 1);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  assert_close(coupling_case_wetted(&melt), dx * dx, 0.05 * dx * dx); // samples are a spacing apart
  melt_on_mould_destroy(&melt);
}

static void melt_that_left_the_wall_wets_nothing_and_gives_nothing(void **state)
{
  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    const MeltCase given = coupling_case_block((CouplingKind)kind, 6, 3);
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    assert_true(coupling_case_wetted(&melt) > 0.0);
    for (ptrdiff_t i = 0; i < melt.particles.n_fluid; i++) melt.particles.x[2][i] += 4.0 * dx;
    melt_on_mould_rebuild(&melt);
    coupling_case_exchange(&melt);
    assert_true(coupling_case_wetted(&melt) == 0.0 && coupling_case_flow(&melt) == 0.0);
    melt_on_mould_destroy(&melt);
  }
}

/* A box cavity filled to the rim: floor and walls are wet to their edges, and in contact all over. */
static void a_full_cavity_is_wet_to_its_corners(void **state)
{
  (void)state;
  MeltCase given = coupling_case_bronze(COUPLING_SURFACE, 2000.0);
  const SyntheticBox box = {.outer = {40 * dx, 40 * dx, 30 * dx},
                            .cavity = {12 * dx, 12 * dx, 12 * dx},
                            .cell = 2 * dx,
                            .kappa = 1.0,
                            .rho = 1800.0,
                            .c = 1100.0,
                            .h_outside = 10.0};
  CastError err = {0};
  if (synthetic_rom_box_cavity(&box, &given.rom, &err) != CAST_OK) fail_msg("%s", err.message);
  given.columns = 0;
  for (int d = 0; d < 3; d++) given.count[d] = 12;
  given.corner[0] = given.corner[1] = -6.0 * dx;
  given.corner[2] = -12.0 * dx;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  coupling_case_exchange(&melt);
  for (size_t l = 0; l < melt.rom->m; l++) {
    const RomPatch *patch = &melt.rom->patch[l];
    if (patch->outer) continue;
    // the walls' upper edge is the melt's free surface: half a spacing of 12
    assert_close(coupling_wetted_area(melt.coupling, l), patch->area, 0.05 * patch->area);
    assert_close(coupling_contact_area(melt.coupling, l), coupling_wetted_area(melt.coupling, l), 1e-12 * patch->area);
    // conductance 1/(1/h + d/kappa) with d below three spacings
    const double most = 2000.0 * 350.0 * patch->area;
    assert_in_range((long)(1000.0 * coupling_flow(melt.coupling)[l] / most), 930, 1000);
  }
  melt_on_mould_destroy(&melt);
}

/* A model of one temperature for a mould of which only the geometry is given. */
static void give_one_temperature(RomData *rom)
{
  rom->r = 1;
  rom->lambda = synthetic_array(1, sizeof(double));
  rom->ambient = synthetic_array(1, sizeof(double));
  rom->constant = synthetic_array(1, sizeof(double));
  rom->B = synthetic_array(rom->m, sizeof(double));
  rom->heat_capacity = rom->constant[0] = 1.0;
  for (size_t l = 0; l < rom->m; l++) rom->B[l] = 1.0;
}

/* A ball of melt on a lattice that nowhere fits the wall: the first particles stand from 0.4 to 1.4 spacings off. */
static void melt_that_does_not_fit_the_wall_is_in_contact_nearly_everywhere(void **state)
{
  (void)state;
  const double half = 8.0 * dx, bend[2] = {half, 2.0 * half}, area = 4.0 * M_PI * half * half;
  const ShapedBox hole = {{-half, -half, -half}, {half, half, half}, false};
  const ShapedMould shape = {.low = {-2.5 * half, -2.5 * half, -2.5 * half},
                             .high = {2.5 * half, 2.5 * half, 2.5 * half},
                             .n_boxes = 1,
                             .box = &hole,
                             .cell = half / 6.0,
                             .bend = bend_ball,
                             .context = bend};
  MeltCase given = coupling_case_bronze(COUPLING_SURFACE, 2000.0);
  given.columns = 0;
  given.clear_of_mould = true;
  given.rom = shaped_mould_create(&shape);
  give_one_temperature(given.rom);
  for (int d = 0; d < 3; d++) {
    given.count[d] = 18;
    given.corner[d] = -9.0 * dx;
  }
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const double wetted = coupling_wetted_area(melt.coupling, 0);
  assert_true(wetted > 0.85 * area && wetted < 1.01 * area); // steps of the lattice leave gaps of more than a spacing
  assert_close(coupling_contact_area(melt.coupling, 0), wetted, 1e-12 * area);
  melt_on_mould_destroy(&melt);
}

/* Two slots side by side with a wall of one spacing between them; their own patches. */
static int32_t slot_patch(const void *context, const VoxelFace *face)
{
  (void)context;
  if (!face->inside) return 2;
  return face->low[0] + face->high[0] < 0.0 ? 0 : 1;
}

static RomData *two_slots(void)
{
  const double x[] = {-20, -8.5, -0.5, 0.5, 8.5, 20}, y[] = {-20, -8, 8, 20}, z[] = {-30, -16, 0};
  const double *const given[3] = {x, y, z};
  const size_t n[3] = {5, 3, 2};
  double *lines[3];
  for (int d = 0; d < 3; d++) {
    lines[d] = synthetic_array(n[d] + 1, sizeof(double));
    for (size_t i = 0; i <= n[d]; i++) lines[d][i] = given[d][i] * dx;
  }
  VoxelMould mould = voxel_mould_create(n, lines);
  mould.solid[voxel_cell(&mould, 1, 1, 1)] = mould.solid[voxel_cell(&mould, 3, 1, 1)] = 0;
  memset(mould.band, 1, n[0] * n[1] * n[2]);
  for (size_t cell = 0; cell < n[0] * n[1] * n[2]; cell++) mould.band[cell] = mould.solid[cell];
  RomData *rom = synthetic_array(1, sizeof *rom);
  rom->m = 3;
  rom->patch = synthetic_array(3, sizeof *rom->patch);
  rom->patch[2].outer = true;
  voxel_mould_geometry(&mould, slot_patch, NULL, rom);
  voxel_mould_destroy(&mould);
  give_one_temperature(rom);
  rom->basis = synthetic_array(rom->n_points, sizeof(float));
  for (size_t p = 0; p < rom->n_points; p++) rom->basis[p] = 1.0F;
  rom->band = 20.0 * dx;
  synthetic_particulars(rom, "two slots", 1.0, 1800.0, 1100.0);
  return rom;
}

static void heat_does_not_pass_through_a_thin_wall_to_the_patch_behind_it(void **state)
{
  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    MeltCase given = coupling_case_bronze((CouplingKind)kind, 2000.0);
    given.rom = two_slots();
    given.columns = 0;
    given.count[0] = 8;
    given.count[1] = given.count[2] = 16;
    given.corner[0] = -8.5 * dx;
    given.corner[1] = -8.0 * dx;
    given.corner[2] = -16.0 * dx;
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    coupling_case_exchange(&melt);
    assert_true(coupling_flow(melt.coupling)[0] > 0.0);
    assert_true(coupling_flow(melt.coupling)[1] == 0.0);
    assert_true(coupling_wetted_area(melt.coupling, 1) == 0.0);
    melt_on_mould_destroy(&melt);
  }
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_block_wets_the_wall_under_it),
      cmocka_unit_test(a_lone_particle_wets_the_square_of_the_spacing),
      cmocka_unit_test(melt_that_left_the_wall_wets_nothing_and_gives_nothing),
      cmocka_unit_test(a_full_cavity_is_wet_to_its_corners),
      cmocka_unit_test(melt_that_does_not_fit_the_wall_is_in_contact_nearly_everywhere),
      cmocka_unit_test(heat_does_not_pass_through_a_thin_wall_to_the_patch_behind_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
