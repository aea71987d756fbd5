/* h5_private.h - what the h5_*.c files share. */
#ifndef COMMON_H5_H5_PRIVATE_H
#define COMMON_H5_H5_PRIVATE_H

#include "common/h5/h5.h"

/* Why the last HDF5 call failed: the operating system's words where it quotes them (then true), else its innermost
 * message. Call before any other H5 function, which clears it. */
bool h5_reason(char *buffer, size_t size);
/* The path of the file that `object` is in. */
CastStatus h5_file_name(hid_t object, char *path, size_t size);
/* After a write that the system refused: let everything of the file that `object` is in be closed without touching the
 * disk again. */
void h5_abandon(hid_t object);
#endif
