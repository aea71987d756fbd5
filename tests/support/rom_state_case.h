/* rom_state_case.h - a slab that loses heat through its bottom, and its state, for tests of the mould's modal state.
 * What fails, fails the test. */
#ifndef TESTS_SUPPORT_ROM_STATE_CASE_H
#define TESTS_SUPPORT_ROM_STATE_CASE_H

#include "cast/mould/rom_state.h"
#include "tests/support/assert_ok.h"
#include "tests/support/synthetic_rom.h"

static const double preheat = 973.0, ambient = 300.0; // K

static const SyntheticSlab losing = {.size = {4e-3, 2e-3},
                                     .depth = 5e-3,
                                     .kappa = 1.0,
                                     .rho = 1800.0,
                                     .c = 1100.0,
                                     .h_bottom = 100.0,
                                     .modes = 60,
                                     .modes_lateral = {4, 2},
                                     .patches = {2, 1}};

static inline RomData *slab(const SyntheticSlab *given)
{
  CastError err = {0};
  RomData *rom = NULL;
  ok(synthetic_rom_slab(given, &rom, &err), &err);
  return rom;
}

static inline RomState *start(const RomData *rom, RomScheme scheme, double outside)
{
  CastError err = {0};
  RomState *state = NULL;
  ok(rom_state_create(rom, scheme, preheat, outside, &state, &err), &err);
  return state;
}

#endif
