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
  free(list->near);
  list->start = malloc((size_t)(rows + 1) * sizeof *list->start);
  list->near = malloc((size_t)(rows + 1) * sizeof *list->near);
  list->n = list->start && list->near ? rows : 0;
  return list->start && list->near;
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

bool row_buffers_reserve(RowBuffers *buffers, int threads)
{
  if (threads <= buffers->n) return true;
  RowBuffer *more = realloc(buffers->of_thread, (size_t)threads * sizeof *more);
  if (!more) return false;
  memset(more + buffers->n, 0, (size_t)(threads - buffers->n) * sizeof *more);
  buffers->of_thread = more;
  buffers->n = threads;
  return true;
}

void row_buffers_free(RowBuffers *buffers)
{
  for (int t = 0; t < buffers->n; t++) free(buffers->of_thread[t].index);
  free(buffers->of_thread);
  *buffers = (RowBuffers){0};
}

/* All entries of all rows count. */
static void keep_all(PairList *list)
{
#pragma omp parallel for simd
  for (ptrdiff_t row = 0; row < list->n; row++) list->near[row] = (int32_t)(list->start[row + 1] - list->start[row]);
}

CastStatus pair_list_build(PairList *list, ptrdiff_t rows, FillRow fill, const void *context, RowBuffers *buffers,
                           CastError *err)
{
  const int most = omp_get_max_threads();
  bool ok = reserve_rows(list, rows) && row_buffers_reserve(buffers, most);
  CAST_CHECK(ok, err, CAST_ERR_MEMORY, "neighbour lists: no memory for %td rows", rows);
  list->start[0] = 0;
#pragma omp parallel num_threads(most)
  {
    const ptrdiff_t threads = omp_get_num_threads(), thread = omp_get_thread_num();
    const ptrdiff_t first = rows * thread / threads, end = rows * (thread + 1) / threads;
    RowBuffer *buffer = &buffers->of_thread[thread];
    buffer->n = 0;
    buffer->vicinity.known = false;
    const bool filled = fill_share(list, first, end, fill, context, buffer);
#pragma omp critical(pair_list_ok)
    ok = ok && filled;
#pragma omp barrier
#pragma omp single
    if (ok) {
      for (ptrdiff_t row = 0; row < rows; row++) list->start[row + 1] += list->start[row];
      ok = reserve_entries(list, list->start[rows]);
    }
    if (ok && buffer->n > 0)
      memcpy(list->index + list->start[first], buffer->index, (size_t)buffer->n * sizeof *buffer->index);
  }
  CAST_CHECK(ok, err, CAST_ERR_MEMORY, "neighbour lists: no memory for the pairs of %td rows", rows);
  keep_all(list);
  return CAST_OK;
}

/* ---- the other way round ---- */

/* Each thread counts what its share of the rows has for each row of the result; these counts, thread after thread, then
 * say where it puts them: the same order whatever the number of threads. */
typedef struct Transpose {
  const PairList *from;
  PairList *to;
  int32_t base;
  int32_t *count; // [threads * rows of to] first numbers of pairs, then places within the row
} Transpose;

static void count_share(const Transpose *t, ptrdiff_t first, ptrdiff_t end, int32_t *count)
{
  memset(count, 0, (size_t)t->to->n * sizeof *count);
  for (ptrdiff_t k = t->from->start[first]; k < t->from->start[end]; k++) count[t->from->index[k] - t->base]++;
}

static void add_counts(const Transpose *t, ptrdiff_t threads, ptrdiff_t row)
{
  int32_t sum = 0;
  for (ptrdiff_t thread = 0; thread < threads; thread++) {
    int32_t *count = &t->count[thread * t->to->n + row];
    const int32_t here = *count;
    *count = sum;
    sum += here;
  }
  t->to->start[row + 1] = sum;
}

static void put_share(const Transpose *t, ptrdiff_t first, ptrdiff_t end, int32_t *place)
{
  for (ptrdiff_t row = first; row < end; row++)
    for (ptrdiff_t k = t->from->start[row]; k < t->from->start[row + 1]; k++) {
      const ptrdiff_t to = t->from->index[k] - t->base;
      t->to->index[t->to->start[to] + place[to]++] = (int32_t)row;
    }
}

CastStatus pair_list_transpose(const PairList *from, int32_t base, ptrdiff_t rows, PairList *to, CastError *err)
{
  const int most = omp_get_max_threads();
  const bool ok = reserve_rows(to, rows) && reserve_entries(to, from->start[from->n]);
  int32_t *count = ok ? malloc((size_t)(rows > 0 ? rows : 1) * (size_t)most * sizeof *count) : NULL;
  CAST_CHECK(count, err, CAST_ERR_MEMORY, "neighbour lists: no memory for the pairs of %td rows", rows);
  const Transpose t = {from, to, base, count};
  to->start[0] = 0;
#pragma omp parallel num_threads(most)
  {
    const ptrdiff_t threads = omp_get_num_threads(), thread = omp_get_thread_num();
    const ptrdiff_t first = from->n * thread / threads, end = from->n * (thread + 1) / threads;
    count_share(&t, first, end, count + thread * rows);
#pragma omp barrier
#pragma omp for
    for (ptrdiff_t row = 0; row < rows; row++) add_counts(&t, threads, row);
#pragma omp single
    for (ptrdiff_t row = 0; row < rows; row++) to->start[row + 1] += to->start[row];
    put_share(&t, first, end, count + thread * rows);
  }
  free(count);
  keep_all(to);
  return CAST_OK;
}

void pair_list_free(PairList *list)
{
  free(list->start);
  free(list->index);
  free(list->near);
  *list = (PairList){0};
}
