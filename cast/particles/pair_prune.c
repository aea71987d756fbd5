#include "cast/particles/pair_prune.h"

#include <omp.h>
#include <string.h>

#include "cast/kernel/dispatch.h"

enum { ROWS_PER_TASK = 256 };

PrunePlaces prune_places(const Particles *p, double reach, const double period[3], PrunePlace *room)
{
  PrunePlaces places = {.place = room};
  for (int d = 0; d < 3; d++) {
    const double unit = period[d] > 0.0 ? 0x1p-32 * period[d] : 0x1p-24 * reach, per_unit = 1.0 / unit;
    places.step[d] = (float)unit;
#pragma omp parallel for
    for (ptrdiff_t i = 0; i < p->n; i++) room[i].at[d] = (uint32_t)(int64_t)(p->x[d][i] * per_unit);
  }
  return places;
}

ptrdiff_t prune_row_plain(const PrunePlaces *places, const PrunePlace *me, float reach2, int32_t *row, ptrdiff_t n,
                          int32_t *far)
{
  ptrdiff_t n_near = 0, n_far = 0;
  for (ptrdiff_t k = 0; k < n; k++) {
    const int32_t j = row[k];
    float r2 = 0.0F;
    for (int d = 0; d < 3; d++) {
      const float way = (float)(int32_t)(me->at[d] - places->place[j].at[d]) * places->step[d];
      r2 += way * way;
    }
    row[n_near] = far[n_far] = j;
    n_near += r2 < reach2;
    n_far += !(r2 < reach2);
  }
  memcpy(row + n_near, far, (size_t)n_far * sizeof *far);
  return n_near;
}

#ifdef DISPATCH_X86
#include <immintrin.h>

#define FOR_AVX512 __attribute__((target("avx512f,avx512bw,avx512vl,avx512dq,popcnt")))

/* Four places, one from each group of four entries: the k-th of each. */
FOR_AVX512 static inline __m512i four_places(const PrunePlace *place, const int32_t *entry, int k)
{
  __m512i all = _mm512_castsi128_si512(_mm_load_si128((const __m128i *)(const void *)&place[entry[k]]));
  all = _mm512_inserti32x4(all, _mm_load_si128((const __m128i *)(const void *)&place[entry[k + 4]]), 1);
  all = _mm512_inserti32x4(all, _mm_load_si128((const __m128i *)(const void *)&place[entry[k + 8]]), 2);
  return _mm512_inserti32x4(all, _mm_load_si128((const __m128i *)(const void *)&place[entry[k + 12]]), 3);
}

FOR_AVX512 static inline __m512 square_of(__m512i mine, __m512i other, float step)
{
  const __m512 way = _mm512_mul_ps(_mm512_cvtepi32_ps(_mm512_sub_epi32(mine, other)), _mm512_set1_ps(step));
  return _mm512_mul_ps(way, way);
}

/* Squares of the distances to 16 entries, in their order. */
FOR_AVX512 static inline __m512 distances2(const PrunePlaces *places, const PrunePlace *me, const int32_t *entry)
{
  const __m512i a = four_places(places->place, entry, 0), b = four_places(places->place, entry, 1),
                c = four_places(places->place, entry, 2), d = four_places(places->place, entry, 3);
  const __m512i ab_low = _mm512_unpacklo_epi32(a, b), ab_high = _mm512_unpackhi_epi32(a, b),
                cd_low = _mm512_unpacklo_epi32(c, d), cd_high = _mm512_unpackhi_epi32(c, d);
  const __m512i x = _mm512_unpacklo_epi64(ab_low, cd_low), y = _mm512_unpackhi_epi64(ab_low, cd_low),
                z = _mm512_unpacklo_epi64(ab_high, cd_high);
  __m512 r2 = square_of(_mm512_set1_epi32((int32_t)me->at[0]), x, places->step[0]);
  r2 = _mm512_add_ps(r2, square_of(_mm512_set1_epi32((int32_t)me->at[1]), y, places->step[1]));
  return _mm512_add_ps(r2, square_of(_mm512_set1_epi32((int32_t)me->at[2]), z, places->step[2]));
}

/* Near and far entries are squeezed together in registers. What is stored behind the near ones of a row lies in places
 * that were read already, but for the row's last entries. */
FOR_AVX512 static ptrdiff_t prune_avx512(const PrunePlaces *places, const PrunePlace *me, float reach2, int32_t *row,
                                         ptrdiff_t n, int32_t *far)
{
  const __m512 limit = _mm512_set1_ps(reach2);
  const ptrdiff_t whole = n / PRUNE_LANES * PRUNE_LANES;
  ptrdiff_t n_near = 0, n_far = 0;
  for (ptrdiff_t k = 0; k < whole; k += PRUNE_LANES) {
    const __m512i entry = _mm512_loadu_si512(row + k);
    const __mmask16 near = _mm512_cmp_ps_mask(distances2(places, me, row + k), limit, _CMP_LT_OQ);
    _mm512_storeu_si512(row + n_near, _mm512_maskz_compress_epi32(near, entry));
    _mm512_storeu_si512(far + n_far, _mm512_maskz_compress_epi32((__mmask16)~near, entry));
    const int count = __builtin_popcount(near);
    n_near += count;
    n_far += PRUNE_LANES - count;
  }
  if (whole < n) {
    const unsigned there = (1U << (n - whole)) - 1U;
    const __m512i entry = _mm512_maskz_loadu_epi32((__mmask16)there, row + whole);
    int32_t last[PRUNE_LANES];
    _mm512_storeu_si512(last, entry); // beyond the row: entry 0, whose distance is not used
    const unsigned near = _mm512_cmp_ps_mask(distances2(places, me, last), limit, _CMP_LT_OQ) & there;
    const int count = __builtin_popcount(near);
    _mm512_mask_storeu_epi32(row + n_near, (__mmask16)((1U << count) - 1U),
                             _mm512_maskz_compress_epi32((__mmask16)near, entry));
    _mm512_storeu_si512(far + n_far, _mm512_maskz_compress_epi32((__mmask16)(there & ~near), entry));
    n_near += count;
  }
  memcpy(row + n_near, far, (size_t)(n - n_near) * sizeof *far);
  return n_near;
}
#endif

ptrdiff_t prune_row(const PrunePlaces *places, const PrunePlace *me, float reach2, int32_t *row, ptrdiff_t n,
                    int32_t *far)
{
#ifdef DISPATCH_X86
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq"))
    return prune_avx512(places, me, reach2, row, n, far);
#endif
  return prune_row_plain(places, me, reach2, row, n, far);
}

CastStatus pair_list_prune(PairList *list, const PrunePlaces *places, ptrdiff_t base, double reach, RowBuffers *buffers,
                           CastError *err)
{
  const float reach2 = (float)(reach * reach);
  const int most = omp_get_max_threads();
  bool ok = row_buffers_reserve(buffers, most);
  CAST_CHECK(ok, err, CAST_ERR_MEMORY, "neighbour lists: no memory");
#pragma omp parallel for schedule(dynamic) num_threads(most) reduction(&& : ok)
  for (ptrdiff_t first = 0; first < list->n; first += ROWS_PER_TASK) {
    RowBuffer *buffer = &buffers->of_thread[omp_get_thread_num()];
    const ptrdiff_t end = first + ROWS_PER_TASK < list->n ? first + ROWS_PER_TASK : list->n;
    buffer->n = 0;
    for (ptrdiff_t row = first; row < end; row++) {
      const ptrdiff_t n = list->start[row + 1] - list->start[row];
      ok = ok && row_buffer_reserve(buffer, n + PRUNE_LANES);
      if (ok && n > 0)
        list->near[row] = (int32_t)prune_row(places, &places->place[base + row], reach2, list->index + list->start[row],
                                             n, buffer->index);
    }
  }
  CAST_CHECK(ok, err, CAST_ERR_MEMORY, "neighbour lists: no memory");
  return CAST_OK;
}
