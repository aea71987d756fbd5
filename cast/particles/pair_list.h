/* pair_list.h - filling the rows of a PairList in parallel. */
#ifndef CAST_PARTICLES_PAIR_LIST_H
#define CAST_PARTICLES_PAIR_LIST_H

#include <stdbool.h>
#include "cast/particles/neighbours.h"

typedef struct RowBuffer {
  int32_t *index;
  ptrdiff_t n, capacity;
} RowBuffer;

/* Room for `more` entries behind those there; false if there is no memory. */
bool row_buffer_reserve(RowBuffer *buffer, ptrdiff_t more);

/* Appends the entries of one row to the buffer; false if there is no memory. Called from several threads. */
typedef bool (*FillRow)(const void *context, ptrdiff_t row, RowBuffer *buffer);

/* Fill `rows` rows. Each thread takes a contiguous share into a buffer of its own, then the shares are put one behind
 * the other: the list is the same for any number of threads. Errors: CAST_ERR_MEMORY. */
CastStatus pair_list_build(PairList *list, ptrdiff_t rows, FillRow fill, const void *context, CastError *err);
void pair_list_free(PairList *list);

#endif
