/* rom_state_private.h - what the files of the mould's state share. */
#ifndef CAST_MOULD_ROM_STATE_PRIVATE_H
#define CAST_MOULD_ROM_STATE_PRIVATE_H

#include "cast/mould/rom_state.h"

RomScheme rom_state_scheme(const RomState *state);
/* phi of a mode, s: what it gains by an input of 1 over dt. */
double rom_state_gain(RomScheme scheme, double lambda, double dt);

#endif
