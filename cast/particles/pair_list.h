/* pair_list.h - filling the rows of a PairList in parallel. */
#ifndef CAST_PARTICLES_PAIR_LIST_H
#define CAST_PARTICLES_PAIR_LIST_H

#include <stdbool.h>
#include "cast/particles/neighbours.h"
#include "cast/particles/vicinity.h"

typedef struct RowBuffer { // of one thread
  int32_t *index;
  ptrdiff_t n, capacity;
  Vicinity vicinity; // scratch of the rows' filler
} RowBuffer;

/* Kept from build to build: fresh memory would cost more than the search. */
typedef struct RowBuffers {
  RowBuffer *of_thread;
  int n;
} RowBuffers;
bool row_buffers_reserve(RowBuffers *buffers, int threads); // false if there is no memory
void row_buffers_free(RowBuffers *buffers);

/* Room for `more` entries behind those there; false if there is no memory. */
bool row_buffer_reserve(RowBuffer *buffer, ptrdiff_t more);

/* Appends the entries of one row to the buffer; false if there is no memory. Called from several threads. */
typedef bool (*FillRow)(const void *context, ptrdiff_t row, RowBuffer *buffer);

/* Fill `rows` rows. Each thread takes a contiguous share into a buffer of its own, then the shares are put one behind
 * the other: the list is the same for any number of threads. Errors: CAST_ERR_MEMORY. */
CastStatus pair_list_build(PairList *list, ptrdiff_t rows, FillRow fill, const void *context, RowBuffers *buffers,
                           CastError *err);
/* The same pairs by their other end: to has rows 0..rows, row k holds in ascending order the rows of `from` that hold
 * base + k. Errors: CAST_ERR_MEMORY. */
CastStatus pair_list_transpose(const PairList *from, int32_t base, ptrdiff_t rows, PairList *to, CastError *err);
void pair_list_free(PairList *list);

#endif
