/* mould_pace.h - the mould stepped less often than the melt: the heat of several steps is gathered and given to the
 * reduced model at once; until then the patch temperatures that the melt feels are predicted (docs/theory, 12a-12c). */
#ifndef CAST_MOULD_MOULD_PACE_H
#define CAST_MOULD_MOULD_PACE_H

#include "cast/mould/rom_state.h"

typedef struct MouldPace MouldPace;

/*  rom  borrowed. Errors: CAST_ERR_MEMORY. */
CastStatus mould_pace_create(const RomData *rom, MouldPace **pace, CastError *err);
void mould_pace_destroy(MouldPace **pace);
/* The heat of the flows q [m] W over dt s, kept until the mould's next step. */
void mould_pace_gather(MouldPace *pace, const RomState *state, const double *q, double dt);
double mould_pace_elapsed(const MouldPace *pace); // s since the mould's last step
double mould_pace_heat(const MouldPace *pace);    // J gathered, not yet in the state
/* Patch temperatures now, K [m]: the state's right after a step, predicted later. */
const double *mould_pace_temperature(const MouldPace *pace, const RomState *state);
/* The mould's step, up to now. Nothing where nothing was gathered. */
void mould_pace_step(MouldPace *pace, RomState *state);
/* The state was stepped by someone else: what was known of its course no longer holds. Nothing may be gathered. */
void mould_pace_forget(MouldPace *pace);
/* For checkpoints. */
size_t mould_pace_size(const MouldPace *pace); // doubles
void mould_pace_save(const MouldPace *pace, double *buffer);
/*  state  restored before */
void mould_pace_restore(MouldPace *pace, const RomState *state, const double *buffer);
#endif
