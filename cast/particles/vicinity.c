#include "cast/particles/vicinity.h"

#include <string.h>

#include "cast/kernel/dispatch.h"

enum { LANES = 8 };

void vicinity_move_to(Vicinity *v, const SortedPoints *points, const double x[3])
{
  int32_t cell[3];
  cells_locate(points->cells, x, cell);
  if (v->known && memcmp(v->cell, cell, sizeof cell) == 0) return;
  memcpy(v->cell, cell, sizeof cell);
  v->known = true;
  v->n_runs = cells_runs(points->cells, x, v->run);
  v->room = LANES;
  for (int r = 0; r < v->n_runs; r++) v->room += v->run[r].end - v->run[r].first;
}

ptrdiff_t vicinity_select_plain(const Vicinity *v, const SortedPoints *points, const double x[3], double reach2,
                                int32_t *index)
{
  ptrdiff_t n = 0;
  for (const CellRun *run = v->run; run < v->run + v->n_runs; run++)
    for (ptrdiff_t k = run->first; k < run->end; k++) { // no branch: a third of the points is near, at random
      double r2 = 0.0;
      for (int d = 0; d < 3; d++) {
        const double to = points->sorted[d][k] - (x[d] - run->shift[d]);
        r2 += to * to;
      }
      index[n] = points->base + (points->order ? points->order[k] : (int32_t)k);
      n += r2 < reach2;
    }
  return n;
}

#ifdef DISPATCH_X86
#include <immintrin.h>

/* Eight points at a time: the numbers of the near ones are squeezed together in a register. */
__attribute__((target("avx512f,avx512vl,popcnt"))) static ptrdiff_t
select_avx512(const Vicinity *v, const SortedPoints *points, const double x[3], double reach2, int32_t *index)
{
  const __m512d limit = _mm512_set1_pd(reach2);
  const __m256i base = _mm256_set1_epi32(points->base), count = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  ptrdiff_t n = 0;
  for (const CellRun *run = v->run; run < v->run + v->n_runs; run++) {
    __m512d from[3];
    for (int d = 0; d < 3; d++) from[d] = _mm512_set1_pd(x[d] - run->shift[d]);
    for (ptrdiff_t k = run->first; k < run->end; k += LANES) {
      const ptrdiff_t left = run->end - k;
      const __mmask8 there = (__mmask8)(left < LANES ? (1 << left) - 1 : 0xff);
      __m512d r2 = _mm512_setzero_pd();
      for (int d = 0; d < 3; d++) {
        const __m512d to = _mm512_sub_pd(_mm512_maskz_loadu_pd(there, points->sorted[d] + k), from[d]);
        r2 = _mm512_fmadd_pd(to, to, r2);
      }
      const __mmask8 near = _mm512_mask_cmp_pd_mask(there, r2, limit, _CMP_LT_OQ);
      const __m256i place = points->order ? _mm256_maskz_loadu_epi32(there, points->order + k)
                                          : _mm256_add_epi32(count, _mm256_set1_epi32((int32_t)k));
      const __m256i hits = _mm256_maskz_compress_epi32(near, _mm256_add_epi32(base, place));
      _mm256_storeu_si256((__m256i *)(void *)(index + n), hits);
      n += __builtin_popcount(near);
    }
  }
  return n;
}
#endif

ptrdiff_t vicinity_select(const Vicinity *v, const SortedPoints *points, const double x[3], double reach2,
                          int32_t *index)
{
#ifdef DISPATCH_X86
  if (__builtin_cpu_supports("avx512vl")) return select_avx512(v, points, x, reach2, index);
#endif
  return vicinity_select_plain(v, points, x, reach2, index);
}
