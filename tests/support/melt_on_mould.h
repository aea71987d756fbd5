/* melt_on_mould.h - a block of melt at rest on a mould: particles, walls, lists, coupling and mould, as a run has them.
 * For tests of the exchange. Nothing moves by itself: flow is frozen.
 *   columns > 0: melt on the flat top of a slab. The block repeats in x and y every `columns` spacings, which is also
 *     the size of the slab; its lowest layer stands half a spacing above the wall; wall particles fill the lattice
 *     below z = 0, which may be shifted so that the wall cuts cells. So everything depends on z alone.
 *   columns == 0: a free block of `count` particles, the lattice beginning at `corner`, on the slab, whose size is
 *     given, or in another mould; wall particles are made from the geometry. */
#ifndef TESTS_SUPPORT_MELT_ON_MOULD_H
#define TESTS_SUPPORT_MELT_ON_MOULD_H

#include "cast/cool/cool.h"
#include "tests/support/synthetic_rom.h"

typedef struct MeltCase {
  double spacing;      // m
  double support;      // of the kernel, in spacings; 0: 3
  int columns;         // or 0
  int layers;          // of melt, above z = 0 (columns > 0)
  RomData *rom;        // another mould than the slab (columns == 0); handed over
  double corner[3];    // m (columns == 0)
  int count[3];        // particles (columns == 0)
  bool clear_of_mould; // leave out those in the mould or too near its wall (columns == 0)
  double shift;        // of the wall's lattice, spacings, 0 to 1: what is left of the uppermost cells (0: whole cells)
  SyntheticSlab slab;  // size filled in for columns > 0
  CouplingParameters coupling;
  RomScheme scheme;
  double kappa, rho, c;         // of the melt
  const char *material;         // its YAML, a flow map, instead of these three; NULL: they hold
  double hot, preheat, ambient; // K
} MeltCase;

typedef struct MeltOnMould {
  MeltCase given;
  RomData *rom;
  Surface *surface;
  Material melt;
  SphParameters sph;
  Particles particles;
  Neighbours *neighbours;
  Coupling *coupling;
  RomState *mould;
  double time; // s
} MeltOnMould;

/* In place: parts point to each other. Fails the test where anything fails. */
void melt_on_mould_create(const MeltCase *given, MeltOnMould *melt);
void melt_on_mould_destroy(MeltOnMould *melt);
void melt_on_mould_rebuild(MeltOnMould *melt);           // neighbour lists and contacts, after particles were moved
void melt_on_mould_step(MeltOnMould *melt, double dt);   // conduction, exchange, mould, enthalpies
/* For steps of cool_step; the caller destroys it. */
Cool *melt_on_mould_begin_cooling(MeltOnMould *melt, double tolerance, double first_step);
/* In implicit steps until the time `until`, s. Returns what it took. */
CoolCounts melt_on_mould_cool(MeltOnMould *melt, double tolerance, double first_step, double until);
double melt_on_mould_time_step(const MeltOnMould *melt); // s, the run's own choice
/* Temperature of the melt at height z of a layered block: linear between layers (of the mean over each). */
double melt_on_mould_temperature(const MeltOnMould *melt, double z);

#endif
