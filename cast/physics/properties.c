#include "cast/physics/properties.h"

#include "cast/physics/solidification.h"

enum { ROWS_PER_TASK = 512 };

void properties_of_rows(const Material *melt, Particles *p, ptrdiff_t first, ptrdiff_t end)
{
  if (!melt) return;
  const Solidification freezing = solidification_of(melt);
  for (ptrdiff_t i = first; i < end; i++) {
    p->T[i] = material_temperature(melt, p->E[i]);
    p->kappa[i] = table_evaluate(&melt->conductivity_of_t, p->T[i]);
    p->mu[i] = table_evaluate(&melt->viscosity_of_t, p->T[i]);
    if (p->T[i] < freezing.liquidus)
      p->mu[i] *= solidification_thickening(table_evaluate(&melt->solid_fraction, p->T[i]), freezing.packing);
  }
}

void properties_update(const Material *melt, Particles *p)
{
#pragma omp parallel for
  for (ptrdiff_t first = 0; first < p->n_fluid; first += ROWS_PER_TASK)
    properties_of_rows(melt, p, first, first + ROWS_PER_TASK < p->n_fluid ? first + ROWS_PER_TASK : p->n_fluid);
}
