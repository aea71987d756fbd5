/* Heat between melt and mould: conserved to rounding, on the area that is wet, to the patch that is near; stable. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/assert_close.h"
#include "tests/support/melt_on_mould.h"
#include "tests/support/shaped_mould.h"
#include "tests/support/voxel_mould.h"

static const double dx = 1e-4;

/* Aluminium bronze on phosphate. */
static MeltCase bronze(CouplingKind kind, double h_contact)
{
  return (MeltCase){.spacing = dx,
                    .columns = 8,
                    .layers = 10,
                    .slab = {.depth = 2e-3,
                             .kappa = 1.0,
                             .rho = 1800.0,
                             .c = 1100.0,
                             .h_bottom = 50.0,
                             .modes = 400,
                             .band = 0.6e-3,
                             .band_layers = 24,
                             .cells = {1, 1}},
                    .coupling = {.kind = kind, .h_contact = h_contact},
                    .kappa = 30.0,
                    .rho = 7000.0,
                    .c = 560.0,
                    .hot = 1423.0,
                    .preheat = 1073.0,
                    .ambient = 300.0};
}

/* A block in the middle of a slab of 4 x 4 patches, 30 spacings wide. */
static MeltCase free_block(CouplingKind kind, int across, int high)
{
  MeltCase given = bronze(kind, 2000.0);
  given.columns = 0;
  given.slab.size[0] = given.slab.size[1] = 30.0 * dx;
  given.slab.patches[0] = given.slab.patches[1] = 4;
  given.slab.modes = 20;
  given.slab.modes_lateral[0] = given.slab.modes_lateral[1] = 6;
  given.corner[0] = given.corner[1] = 0.5 * (30 - across) * dx;
  given.count[0] = given.count[1] = across;
  given.count[2] = high;
  return given;
}

static double uniform(uint64_t *seed) // in [0, 1)
{
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1p-53;
}

static void shake(MeltOnMould *melt, double most) // places and temperatures
{
  uint64_t seed = 7;
  Particles *p = &melt->particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    for (int d = 0; d < 3; d++) p->x[d][i] += most * dx * (uniform(&seed) - 0.5);
    p->E[i] = material_enthalpy(&melt->melt, 1000.0 + 500.0 * uniform(&seed));
  }
  sph_initialise(&melt->sph, p);
  melt_on_mould_rebuild(melt);
}

static double total_flow(const MeltOnMould *melt)
{
  double sum = 0.0;
  for (size_t l = 0; l < melt->rom->m; l++) sum += coupling_flow(melt->coupling)[l];
  return sum;
}

static double total_wetted(const MeltOnMould *melt)
{
  double sum = 0.0;
  for (size_t l = 0; l < melt->rom->m; l++) sum += coupling_wetted_area(melt->coupling, l);
  return sum;
}

static void exchange(MeltOnMould *melt) // alone: without conduction in the melt
{
  memset(melt->particles.heat, 0, (size_t)melt->particles.n_fluid * sizeof(double));
  coupling_exchange(melt->coupling, melt->mould, &melt->particles, melt->neighbours);
}

/* ---- what is exchanged ---- */

static void what_the_melt_loses_the_patches_get(void **state)
{
  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    const MeltCase given = free_block((CouplingKind)kind, 12, 6);
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    shake(&melt, 0.3);
    exchange(&melt);
    double fluid = 0.0, size = 0.0;
    for (ptrdiff_t i = 0; i < melt.particles.n_fluid; i++) {
      fluid += melt.particles.heat[i];
      size += fabs(melt.particles.heat[i]);
    }
    assert_true(size > 0.0);
    assert_close(fluid + total_flow(&melt), 0.0, 1e-14 * size); // rounding of some thousand terms
    melt_on_mould_destroy(&melt);
  }
}

/* Melt that conducts so well that only the contact resists: q = h A (T_melt - T_mould). */
static void contact_resistance_alone_gives_h_area_difference(void **state)
{
  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    MeltCase given = bronze((CouplingKind)kind, 2000.0);
    given.kappa = given.slab.kappa = 1e7;
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    exchange(&melt);
    const double area = 64.0 * dx * dx, exact = 2000.0 * area * 350.0;
    // surface: areas add up to the wetted area. embedded: as good as sums over particles stand for integrals
    assert_close(coupling_flow(melt.coupling)[0], exact, (kind == 0 ? 1e-6 : 0.01) * exact);
    assert_close(coupling_flow(melt.coupling)[1], 0.0, 0.0); // the outer patches get nothing
    melt_on_mould_destroy(&melt);
  }
}

/* With the volumes of whole cells, dx^3, a half-filled uppermost layer would count for twice the wall. */
static void embedded_flux_does_not_depend_on_where_the_wall_cuts_the_lattice(void **state)
{
  (void)state;
  const double shifts[] = {0.1, 0.3, 0.5, 0.7, 0.9};
  for (size_t s = 0; s < sizeof shifts / sizeof *shifts; s++) {
    MeltCase given = bronze(COUPLING_EMBEDDED, 2000.0);
    given.kappa = given.slab.kappa = 1e7;
    given.shift = shifts[s];
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    exchange(&melt);
    const double exact = 2000.0 * 64.0 * dx * dx * 350.0;
    assert_close(coupling_flow(melt.coupling)[0], exact, 0.035 * exact); // sums over particles for integrals
    melt_on_mould_destroy(&melt);
  }
}

/* A linear temperature through melt, contact and mould carries kappa dT/dz everywhere. */
static void embedded_flux_of_a_linear_temperature_is_kappa_times_its_slope(void **state)
{
  (void)state;
  MeltCase given = bronze(COUPLING_EMBEDDED, 10000.0);
  given.slab.h_bottom = 2000.0; // with a steady flow the mould's temperature is linear
  given.ambient = given.preheat;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const double area = 64.0 * dx * dx, flux = 1e5, q[] = {flux * area, 0.0, 0.0};
  for (int n = 0; n < 100; n++) rom_state_step(melt.mould, q, 1e3);
  const double wall = given.preheat + flux * (1.0 / 2000.0 + 2e-3 / 1.0);
  Particles *p = &melt.particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    p->E[i] = material_enthalpy(&melt.melt, wall + flux * (1.0 / 10000.0 + p->x[2][i] / 30.0));
  sph_initialise(&melt.sph, p);
  exchange(&melt);
  assert_close(coupling_flow(melt.coupling)[0], flux * area, 0.01 * flux * area); // sums over particles for integrals
  melt_on_mould_destroy(&melt);
}

static void embedded_walls_have_the_mould_s_temperature_at_their_place(void **state)
{
  (void)state;
  const MeltCase given = bronze(COUPLING_EMBEDDED, 2000.0);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const double q[] = {0.05, 0.0, 0.0};
  rom_state_step(melt.mould, q, 0.5);
  exchange(&melt);
  const Particles *p = &melt.particles;
  double *points = malloc(melt.rom->n_points * sizeof *points);
  rom_state_point_temperature(melt.mould, points);
  const double rise = rom_state_patch_temperature(melt.mould)[0] - given.preheat, layer = 0.6e-3 / 24;
  assert_true(rise > 10.0);
  for (ptrdiff_t k = 0; k < p->n - p->n_fluid; k++) {
    if (p->depth[k] > 2.0 * dx) continue; // beyond reach of the melt: shown with the patch's temperature
    double nearest = INFINITY, T = 0.0;   // point of the mesh at the depth of this particle: layers are uniform
    for (size_t n = 0; n < melt.rom->n_points; n++) {
      const double off = fabs(melt.rom->points[3 * n + 2] - p->x[2][p->n_fluid + k]);
      if (off < nearest) {
        nearest = off;
        T = points[n];
      }
    }
    assert_true(nearest < 1e-3 * layer || nearest < 0.51 * layer);
    // half a layer off at most, on a slope of rise/(1 mm) or less
    assert_close(p->T[p->n_fluid + k], T, 2e-5 * rise + rise * nearest / 0.4e-3);
  }
  free(points);
  melt_on_mould_destroy(&melt);
}

static void a_cold_melt_takes_heat_from_the_mould(void **state)
{
  (void)state;
  MeltCase given = bronze(COUPLING_SURFACE, 2000.0);
  given.hot = 900.0;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  melt_on_mould_step(&melt, 1e-3);
  assert_true(coupling_flow(melt.coupling)[0] < 0.0);
  assert_true(rom_state_patch_temperature(melt.mould)[0] < given.preheat);
  assert_true(melt_on_mould_temperature(&melt, 0.5 * dx) > 900.0);
  melt_on_mould_destroy(&melt);
}

/* Melt that rises by a tenth of a spacing, between two rebuilds: its distance follows. */
static void distances_follow_the_melt_between_rebuilds(void **state)
{
  (void)state;
  MeltCase given = bronze(COUPLING_SURFACE, (double)INFINITY);
  given.layers = 1;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  exchange(&melt);
  const double before = total_flow(&melt);
  for (ptrdiff_t i = 0; i < melt.particles.n_fluid; i++) melt.particles.x[2][i] += 0.1 * dx;
  exchange(&melt);
  assert_close(total_flow(&melt), before * 0.5 / 0.6, 1e-9 * before); // kappa A dT/d
  melt_on_mould_destroy(&melt);
}

static void an_empty_mould_exchanges_nothing(void **state)
{
  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    const MeltCase given = free_block((CouplingKind)kind, 0, 0);
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    CastError err = {0};
    assert_int_equal(coupling_advance(melt.coupling, melt.mould, &melt.particles, melt.neighbours, 1e-3, &err),
                     CAST_OK);
    assert_true(total_flow(&melt) == 0.0 && total_wetted(&melt) == 0.0);
    assert_true(rom_state_time(melt.mould) == 1e-3);
    melt_on_mould_destroy(&melt);
  }
}

/* ---- wetting ---- */

static void a_block_wets_the_wall_under_it(void **state)
{
  (void)state;
  for (int high = 1; high <= 4; high += 3) { // a film of one layer as well as a block
    const MeltCase given = free_block(COUPLING_SURFACE, 12, high);
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    const double exact = 144.0 * dx * dx, edge = 4.0 * 12.0 * dx * dx;
    // along its edge the end of the melt is known no better than to a fifth of a spacing
    assert_close(total_wetted(&melt), exact, 0.2 * edge);
    double contact = 0.0;
    for (size_t l = 0; l < melt.rom->m; l++) contact += coupling_contact_area(melt.coupling, l);
    assert_close(contact, total_wetted(&melt), 0.01 * exact);
    melt_on_mould_destroy(&melt);
  }
}

static void a_lone_particle_wets_the_square_of_the_spacing(void **state)
{
  (void)state;
  const MeltCase given = free_block(COUPLING_SURFACE, 1, 1);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  assert_close(total_wetted(&melt), dx * dx, 0.05 * dx * dx); // samples are a spacing apart
  melt_on_mould_destroy(&melt);
}

static void melt_that_left_the_wall_wets_nothing_and_gives_nothing(void **state)
{
  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    const MeltCase given = free_block((CouplingKind)kind, 6, 3);
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    assert_true(total_wetted(&melt) > 0.0);
    for (ptrdiff_t i = 0; i < melt.particles.n_fluid; i++) melt.particles.x[2][i] += 4.0 * dx;
    melt_on_mould_rebuild(&melt);
    exchange(&melt);
    assert_true(total_wetted(&melt) == 0.0 && total_flow(&melt) == 0.0);
    melt_on_mould_destroy(&melt);
  }
}

/* A box cavity filled to the rim: floor and walls are wet to their edges, and in contact all over. */
static void a_full_cavity_is_wet_to_its_corners(void **state)
{
  (void)state;
  MeltCase given = bronze(COUPLING_SURFACE, 2000.0);
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
  exchange(&melt);
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
  MeltCase given = bronze(COUPLING_SURFACE, 2000.0);
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
    MeltCase given = bronze((CouplingKind)kind, 2000.0);
    given.rom = two_slots();
    given.columns = 0;
    given.count[0] = 8;
    given.count[1] = given.count[2] = 16;
    given.corner[0] = -8.5 * dx;
    given.corner[1] = -8.0 * dx;
    given.corner[2] = -16.0 * dx;
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    exchange(&melt);
    assert_true(coupling_flow(melt.coupling)[0] > 0.0);
    assert_true(coupling_flow(melt.coupling)[1] == 0.0);
    assert_true(coupling_wetted_area(melt.coupling, 1) == 0.0);
    melt_on_mould_destroy(&melt);
  }
}

/* ---- stability ---- */

/* Perfect contact of a good conductor: the plain exchange swings with growing size, sub-steps follow the exact
 * contact. */
static MeltCase stiff_case(void)
{
  MeltCase given = bronze(COUPLING_SURFACE, (double)INFINITY);
  given.layers = 40;
  given.slab.modes = 4000;
  given.slab.h_bottom = 0.0;
  return given;
}

static void a_stiff_exchange_blows_up_without_sub_steps(void **state)
{
  (void)state;
  const MeltCase given = stiff_case();
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const double dt = 0.25 * melt_on_mould_time_step(&melt); // the particles alone are stable
  double stiffness = 0.0, most = 0.0;
  for (int n = 0; n < 40; n++) {
    sph_rates(&melt.sph, &melt.particles, melt.neighbours);
    coupling_exchange(melt.coupling, melt.mould, &melt.particles, melt.neighbours);
    if (n == 0) assert_false(coupling_check_stability(melt.coupling, melt.mould, dt, &stiffness));
    coupling_step_mould(melt.coupling, melt.mould, &melt.particles, dt);
    CastError err = {0};
    if (sph_finish(&melt.sph, &melt.particles, dt, &err) != CAST_OK) break; // colder than 0 K
    most = fmax(most, rom_state_patch_temperature(melt.mould)[0]);
  }
  assert_true(stiffness > 1.0);
  assert_true(most > given.hot + 1000.0); // hotter than anything was
  melt_on_mould_destroy(&melt);
}

static void a_stiff_exchange_is_right_with_sub_steps(void **state)
{
  (void)state;
  const MeltCase given = stiff_case();
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const double dt = melt_on_mould_time_step(&melt), e_melt = sqrt(30.0 * 7000.0 * 560.0),
               e_mould = sqrt(1800.0 * 1100.0);
  const double exact = (e_melt * given.hot + e_mould * given.preheat) / (e_melt + e_mould);
  while (melt.time < 0.01) {
    melt_on_mould_step(&melt, dt);
    assert_true(rom_state_patch_temperature(melt.mould)[0] < given.hot);
  }
  assert_true(coupling_substeps(melt.coupling) > 1);
  assert_close(rom_state_patch_temperature(melt.mould)[0], exact, 0.005 * 350.0); // row H4
  melt_on_mould_destroy(&melt);
}

/* A step so long that a plain exchange would take more from a particle than it has to give. */
static void sub_steps_keep_a_particle_above_the_wall_s_temperature(void **state)
{
  (void)state;
  MeltCase given = bronze(COUPLING_SURFACE, 1e5);
  given.coupling.mould_frozen = true;
  given.layers = 1;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const double contact = coupling_contact_area(melt.coupling, 0) / 64.0 / (1e-5 + 0.5 * dx / 30.0);
  const double rate = contact / (7000.0 * 560.0 * dx * dx * dx), dt = 3.0 / rate;
  melt_on_mould_step(&melt, dt);
  assert_true(coupling_substeps(melt.coupling) >= 6);
  const double T = melt_on_mould_temperature(&melt, 0.5 * dx), n = (double)coupling_substeps(melt.coupling);
  assert_close(T, given.preheat + 350.0 * pow(1.0 - rate * dt / n, n), 1e-9); // explicit sub-steps of one layer
  melt_on_mould_destroy(&melt);
}

static void stiffness_of_a_covered_patch_is_conductance_times_step_response(void **state)
{
  (void)state;
  const MeltCase given = bronze(COUPLING_SURFACE, 2000.0);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  exchange(&melt);
  double stiffness;
  assert_true(coupling_check_stability(melt.coupling, melt.mould, 1e-4, &stiffness));
  const double expected = rom_state_stiffness(melt.mould, coupling_conductance(melt.coupling), 1e-4);
  assert_close(stiffness, expected, 1e-9 * expected);
  melt_on_mould_destroy(&melt);
}

/* ---- books ---- */

static void a_frozen_mould_keeps_its_temperature_and_the_books_close(void **state)
{
  (void)state;
  MeltCase given = bronze(COUPLING_SURFACE, 2000.0);
  given.coupling.mould_frozen = true;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  for (int n = 0; n < 50; n++) melt_on_mould_step(&melt, 1e-4);
  assert_true(rom_state_patch_temperature(melt.mould)[0] == given.preheat);
  const EnergyLedger ledger = coupling_ledger(melt.coupling, melt.mould, &melt.particles);
  assert_true(ledger.exchanged > 0.0 && ledger.mould_now == 0.0);
  assert_close(ledger.residual, 0.0, 1e-9 * ledger.exchanged);
  melt_on_mould_destroy(&melt);
}

static void melt_that_leaves_is_in_the_books(void **state)
{
  (void)state;
  const MeltCase given = free_block(COUPLING_SURFACE, 6, 3);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  for (int n = 0; n < 20; n++) melt_on_mould_step(&melt, 1e-4);
  Particles *p = &melt.particles;
  coupling_record_removed(melt.coupling, p->mass[p->n_fluid - 1] * p->E[p->n_fluid - 1]);
  p->mass[p->n_fluid - 1] = 0.0;
  const EnergyLedger ledger = coupling_ledger(melt.coupling, melt.mould, p);
  assert_true(ledger.removed > 100.0 * ledger.exchanged / 108.0);
  assert_close(ledger.residual, 0.0, 1e-9 * ledger.exchanged);
  melt_on_mould_destroy(&melt);
}

static void books_saved_and_restored_go_on(void **state)
{
  (void)state;
  const MeltCase given = bronze(COUPLING_SURFACE, 2000.0);
  MeltOnMould melt, other;
  melt_on_mould_create(&given, &melt);
  melt_on_mould_create(&given, &other);
  for (int n = 0; n < 20; n++) melt_on_mould_step(&melt, 1e-4);
  double *buffer = malloc(coupling_size(melt.coupling) * sizeof *buffer);
  coupling_save(melt.coupling, buffer);
  coupling_restore(other.coupling, melt.mould, buffer);
  free(buffer);
  const EnergyLedger a = coupling_ledger(melt.coupling, melt.mould, &melt.particles);
  const EnergyLedger b = coupling_ledger(other.coupling, melt.mould, &melt.particles);
  assert_memory_equal(&a, &b, sizeof a);
  melt_on_mould_destroy(&melt);
  melt_on_mould_destroy(&other);
}

static void the_exchange_has_the_same_bits_on_any_number_of_threads(void **state)
{
  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    double *heat[2], *flow[2];
    size_t n = 0, m = 0;
    for (int run = 0; run < 2; run++) {
      omp_set_num_threads(run == 0 ? 1 : 3);
      const MeltCase given = free_block((CouplingKind)kind, 12, 4);
      MeltOnMould melt;
      melt_on_mould_create(&given, &melt);
      shake(&melt, 0.3);
      for (int step = 0; step < 5; step++) melt_on_mould_step(&melt, 1e-4);
      n = (size_t)melt.particles.n_fluid;
      m = melt.rom->m;
      heat[run] = malloc(n * sizeof(double));
      flow[run] = malloc(m * sizeof(double));
      memcpy(heat[run], melt.particles.E, n * sizeof(double));
      memcpy(flow[run], coupling_flow(melt.coupling), m * sizeof(double));
      melt_on_mould_destroy(&melt);
    }
    assert_memory_equal(heat[0], heat[1], n * sizeof(double));
    assert_memory_equal(flow[0], flow[1], m * sizeof(double));
    for (int run = 0; run < 2; run++) {
      free(heat[run]);
      free(flow[run]);
    }
    omp_set_num_threads(1);
  }
}

/* ---- what is refused ---- */

static void expect_refusal(MeltOnMould *melt, const CouplingParameters *parameters, const Surface *surface,
                           CastStatus status, const char *word)
{
  CastError err = {0};
  Coupling *coupling = NULL;
  assert_int_equal(coupling_create(parameters, &melt->sph, melt->rom, surface, &melt->particles, &coupling, &err),
                   status);
  assert_null(coupling);
  if (!strstr(err.message, word)) fail_msg("'%s' says nothing of '%s'", err.message, word);
}

static void impossible_couplings_are_refused(void **state)
{
  (void)state;
  const MeltCase given = bronze(COUPLING_SURFACE, 2000.0);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const CouplingParameters none = {.h_contact = 0.0}, nan = {.h_contact = (double)NAN}, good = {.h_contact = 1.0},
                           embedded = {.kind = COUPLING_EMBEDDED, .h_contact = 1.0};
  expect_refusal(&melt, &none, melt.surface, CAST_ERR_INPUT, "h_contact");
  expect_refusal(&melt, &nan, melt.surface, CAST_ERR_INPUT, "h_contact");
  expect_refusal(&melt, &good, NULL, CAST_ERR_ARGUMENT, "surface");
  const size_t n = melt.rom->n_tetrahedra;
  melt.rom->n_tetrahedra = 0;
  expect_refusal(&melt, &embedded, melt.surface, CAST_ERR_INPUT, "band");
  melt.rom->n_tetrahedra = n;
  melt_on_mould_destroy(&melt);
}

/* ---- contact laws ---- */

/* Flow into the only patch after one step, W. */
static double flow_with(CouplingKind kind, double h_contact, const ContactLaws *laws)
{
  MeltCase given = bronze(kind, h_contact);
  given.coupling.contact = laws;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  melt_on_mould_step(&melt, 1e-5);
  const double flow = coupling_flow(melt.coupling)[0];
  melt_on_mould_destroy(&melt);
  return flow;
}

static void a_named_surface_has_its_own_contact(void **state)
{
  (void)state;
  double T[2] = {1400.0, 1450.0}, h[2] = {1500.0, 1500.0}; // the melt is at 1423 K: 1500 there too
  SurfaceContact top = {.surface = "top", .law = {.h = 500.0}};
  const ContactLaws laws = {.elsewhere = {.h = 3000.0}, .n = 1, .surface = &top};
  const ContactLaws table = {.elsewhere = {.basis = CONTACT_OF_TEMPERATURE, .table = {2, T, h}}};
  for (int kind = COUPLING_SURFACE; kind <= COUPLING_EMBEDDED; kind++) {
    assert_true(flow_with(kind, NAN, &laws) == flow_with(kind, 500.0, NULL));
    assert_true(flow_with(kind, NAN, &table) == flow_with(kind, 1500.0, NULL));
  }
}

/* At 1423 K the table gives 10, but 1e7 a little colder: sub-steps must be ready for that. */
static void sub_steps_are_those_of_the_largest_conductance_that_can_occur(void **state)
{
  (void)state;
  double T[3] = {1380.0, 1400.0, 1420.0}, h[3] = {1e7, 1e7, 10.0};
  const ContactLaws rising = {.elsewhere = {.basis = CONTACT_OF_TEMPERATURE, .table = {3, T, h}}};
  long substeps[2];
  double conductance[2];
  for (int k = 0; k < 2; k++) {
    MeltCase given = bronze(COUPLING_SURFACE, 1e7);
    if (k == 1) given.coupling.contact = &rising;
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    melt_on_mould_step(&melt, 1e-3);
    substeps[k] = coupling_substeps(melt.coupling);
    conductance[k] = coupling_conductance(melt.coupling);
    melt_on_mould_destroy(&melt);
  }
  assert_true(substeps[0] > 1);
  assert_int_equal(substeps[1], substeps[0]);
  assert_close(conductance[1], conductance[0], 1e-12 * conductance[0]);
}

static void contact_laws_that_fit_neither_mould_nor_melt_are_refused(void **state)
{
  (void)state;
  const MeltCase given = bronze(COUPLING_SURFACE, 2000.0);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  double x[1] = {0.5}, h[1] = {100.0}, zero[1] = {0.0};
  SurfaceContact wrong = {.surface = "pins", .law = {.h = 500.0}};
  const ContactLaws unknown = {.elsewhere = {.h = 1.0}, .n = 1, .surface = &wrong};
  const ContactLaws fraction = {.elsewhere = {.basis = CONTACT_OF_SOLID_FRACTION, .table = {1, x, h}}};
  const ContactLaws nothing = {.elsewhere = {.basis = CONTACT_OF_TEMPERATURE, .table = {1, x, zero}}};
  const CouplingParameters a = {.contact = &unknown}, b = {.contact = &fraction}, c = {.contact = &nothing};
  expect_refusal(&melt, &a, melt.surface, CAST_ERR_INPUT, "it has: top");
  expect_refusal(&melt, &b, melt.surface, CAST_ERR_INPUT, "solid fraction");
  expect_refusal(&melt, &c, melt.surface, CAST_ERR_INPUT, "above zero");
  melt_on_mould_destroy(&melt);
}

static void a_step_without_new_contacts_after_a_rebuild_is_refused(void **state)
{
  (void)state;
  const MeltCase given = bronze(COUPLING_SURFACE, 2000.0);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  CastError err = {0};
  assert_int_equal(neighbours_update(melt.neighbours, &melt.particles, true, NULL, &err), CAST_OK);
  assert_int_equal(coupling_advance(melt.coupling, melt.mould, &melt.particles, melt.neighbours, 1e-4, &err),
                   CAST_ERR_ARGUMENT);
  assert_non_null(strstr(err.message, "coupling_rebuild"));
  melt_on_mould_destroy(&melt);
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_the_melt_loses_the_patches_get),
      cmocka_unit_test(contact_resistance_alone_gives_h_area_difference),
      cmocka_unit_test(embedded_flux_does_not_depend_on_where_the_wall_cuts_the_lattice),
      cmocka_unit_test(embedded_flux_of_a_linear_temperature_is_kappa_times_its_slope),
      cmocka_unit_test(embedded_walls_have_the_mould_s_temperature_at_their_place),
      cmocka_unit_test(a_cold_melt_takes_heat_from_the_mould),
      cmocka_unit_test(distances_follow_the_melt_between_rebuilds),
      cmocka_unit_test(an_empty_mould_exchanges_nothing),
      cmocka_unit_test(a_block_wets_the_wall_under_it),
      cmocka_unit_test(a_lone_particle_wets_the_square_of_the_spacing),
      cmocka_unit_test(melt_that_left_the_wall_wets_nothing_and_gives_nothing),
      cmocka_unit_test(a_full_cavity_is_wet_to_its_corners),
      cmocka_unit_test(melt_that_does_not_fit_the_wall_is_in_contact_nearly_everywhere),
      cmocka_unit_test(heat_does_not_pass_through_a_thin_wall_to_the_patch_behind_it),
      cmocka_unit_test(a_stiff_exchange_blows_up_without_sub_steps),
      cmocka_unit_test(a_stiff_exchange_is_right_with_sub_steps),
      cmocka_unit_test(sub_steps_keep_a_particle_above_the_wall_s_temperature),
      cmocka_unit_test(stiffness_of_a_covered_patch_is_conductance_times_step_response),
      cmocka_unit_test(a_frozen_mould_keeps_its_temperature_and_the_books_close),
      cmocka_unit_test(melt_that_leaves_is_in_the_books),
      cmocka_unit_test(books_saved_and_restored_go_on),
      cmocka_unit_test(the_exchange_has_the_same_bits_on_any_number_of_threads),
      cmocka_unit_test(impossible_couplings_are_refused),
      cmocka_unit_test(a_named_surface_has_its_own_contact),
      cmocka_unit_test(sub_steps_are_those_of_the_largest_conductance_that_can_occur),
      cmocka_unit_test(contact_laws_that_fit_neither_mould_nor_melt_are_refused),
      cmocka_unit_test(a_step_without_new_contacts_after_a_rebuild_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
