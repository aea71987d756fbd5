#include "cast/particles/pair_list.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

bool row_buffer_reserve(RowBuffer *buffer, ptrdiff_t more)
{
  if (buffer->n + more <= buffer->capacity) return true;
  const ptrdiff_t wanted = 2 * (buffer->n + more) + 1024;
  int32_t *index = realloc(buffer->index, (size_t)wanted * sizeof *index);
  if (!index) return false;
  buffer->index = index;
  buffer->capacity = wanted;
  return true;
}

static bool reserve_rows(PairList *list, ptrdiff_t rows)
{
  if (list->start && rows <= list->n) {
    list->n = rows;
    return true;
  }
  free(list->start);
  list->start = malloc((size_t)(rows + 1) * sizeof *list->start);
  list->n = list->start ? rows : 0;
  return list->start != NULL;
}

static bool reserve_entries(PairList *list, ptrdiff_t entries)
{
  if (list->index && entries <= list->capacity) return true;
  const ptrdiff_t wanted = entries + entries / 8 + 64;
  free(list->index);
  list->index = malloc((size_t)wanted * sizeof *list->index);
  list->capacity = list->index ? wanted : 0;
  return list->index != NULL;
}

/* Rows of this thread's share into its buffer; start[row + 1] holds the row's length for now. */
static bool fill_share(PairList *list, ptrdiff_t first, ptrdiff_t end, FillRow fill, const void *context,
                       RowBuffer *buffer)
{
  for (ptrdiff_t row = first; row < end; row++) {
    const ptrdiff_t before = buffer->n;
    if (!fill(context, row, buffer)) return false;
    list->start[row + 1] = buffer->n - before;
  }
  return true;
}

CastStatus pair_list_build(PairList *list, ptrdiff_t rows, FillRow fill, const void *context, CastError *err)
{
  bool ok = reserve_rows(list, rows);
  CAST_CHECK(ok, err, CAST_ERR_MEMORY, "neighbour lists: no memory for %td rows", rows);
  list->start[0] = 0;
#pragma omp parallel
  {
    const ptrdiff_t threads = omp_get_num_threads(), thread = omp_get_thread_num();
    const ptrdiff_t first = rows * thread / threads, end = rows * (thread + 1) / threads;
    RowBuffer buffer = {0};
    const bool filled = fill_share(list, first, end, fill, context, &buffer);
#pragma omp critical(pair_list_ok)
    ok = ok && filled;
#pragma omp barrier
#pragma omp single
    if (ok) {
      for (ptrdiff_t row = 0; row < rows; row++) list->start[row + 1] += list->start[row];
      ok = reserve_entries(list, list->start[rows]);
    }
    if (ok && buffer.n > 0)
      memcpy(list->index + list->start[first], buffer.index, (size_t)buffer.n * sizeof *buffer.index);
    free(buffer.index);
  }
  CAST_CHECK(ok, err, CAST_ERR_MEMORY, "neighbour lists: no memory for the pairs of %td rows", rows);
  return CAST_OK;
}

void pair_list_free(PairList *list)
{
  free(list->start);
  free(list->index);
  *list = (PairList){0};
}
