/* coupling_private.h - what the files of the coupling share.
 * coupling.c  life, contacts and wetted areas, books       conductance.c  of the pairs, once a step
 * exchange.c  powers, flows, the mould's step, sub-steps */
#ifndef CAST_COUPLING_COUPLING_PRIVATE_H
#define CAST_COUPLING_COUPLING_PRIVATE_H

#include <math.h>

#include "cast/coupling/contacts.h"
#include "cast/coupling/coupling.h"
#include "cast/coupling/wall_temperature.h"
#include "cast/coupling/wetting.h"
#include "cast/mould/mould_pace.h"

enum { STEP_TABLE = 320, STEP_ZERO = 200, STEPS_PER_OCTAVE = 4 };
static const double coupling_stable = 0.5; // limit of the stiffness and of a particle's share

typedef struct Total { // a compensated sum
  double value, low;
} Total;

struct Coupling {
  CouplingParameters parameters;
  const SphParameters *sph;
  const RomData *rom;
  ContactLaws uniform;    // of h_contact, where no laws are given
  const ContactLaw **law; // [m]
  ContactRules rules;
  Contacts contacts;
  Wetting *wetting;         // NULL without a surface
  WallTemperature *walls;   // embedded
  double mould_kappa;       // W/(m K), embedded
  double period[3];         // m
  long builds;              // of the neighbour lists that the contacts were made from
  double *flow;             // [m] W
  double *sum;              // [m] W/K, conductance of each patch, with the largest h of its law
  double conductance;       // W/(m2 K), the largest sum over its patch's area
  double *wetted, *touched; // [m] m2
  double *T, *E;            // [n_near] K, J/kg of the particles near walls during a step
  double *mean;             // [n_near] W, what the wall takes from them, mean over the sub-steps
  double *mean_flow;        // [m] W
  ptrdiff_t room;
  double particle_rate;          // 1/s, max K_i/(m_i c), with the largest h
  double least_heat;             // J/(kg K), c above; 0: temperatures do not follow the enthalpy
  double eigenvalue[STEP_TABLE]; // m2 K/W, g(dt) at dt = 2^((index - STEP_ZERO)/STEPS_PER_OCTAVE) s; NAN: not yet known
  long substeps;
  MouldPace *pace;
  double interval; // s, between the mould's steps, as planned at its last
  double melt_start;                  // J
  Total exchanged, removed, added, absorbed; // J
};

/* Conductances of the contacts' pairs, W/K, and what of them the time step depends on: from the particles' places, T
 * and kappa. */
void coupling_set_conductances(Coupling *coupling, const Particles *particles);

static inline void total_add(Total *total, double term)
{
  const double sum = total->value + term;
  total->low += fabs(total->value) >= fabs(term) ? (total->value - sum) + term : (term - sum) + total->value;
  total->value = sum;
}

static inline double total_of(const Total *total)
{
  return total->value + total->low;
}

#endif
