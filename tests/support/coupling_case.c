#include "tests/support/coupling_case.h"
#include "tests/support/random_numbers.h"

#include <string.h>

static const double dx = COUPLING_CASE_SPACING;

MeltCase coupling_case_bronze(CouplingKind kind, double h_contact)
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

MeltCase coupling_case_block(CouplingKind kind, int across, int high)
{
  MeltCase given = coupling_case_bronze(kind, 2000.0);
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

void coupling_case_shake(MeltOnMould *melt, double most)
{
  uint64_t seed = 7;
  Particles *p = &melt->particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    for (int d = 0; d < 3; d++) p->x[d][i] += most * dx * (random_unit(&seed) - 0.5);
    p->E[i] = material_enthalpy(&melt->melt, 1000.0 + 500.0 * random_unit(&seed));
  }
  sph_initialise(&melt->sph, p);
  melt_on_mould_rebuild(melt);
}

double coupling_case_flow(const MeltOnMould *melt)
{
  double sum = 0.0;
  for (size_t l = 0; l < melt->rom->m; l++) sum += coupling_flow(melt->coupling)[l];
  return sum;
}

double coupling_case_wetted(const MeltOnMould *melt)
{
  double sum = 0.0;
  for (size_t l = 0; l < melt->rom->m; l++) sum += coupling_wetted_area(melt->coupling, l);
  return sum;
}

void coupling_case_exchange(MeltOnMould *melt)
{
  memset(melt->particles.heat, 0, (size_t)melt->particles.n_fluid * sizeof(double));
  coupling_exchange(melt->coupling, melt->mould, &melt->particles, melt->neighbours);
}
