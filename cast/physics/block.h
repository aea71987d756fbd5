/* block.h - records of a row's neighbours laid out field by field, so that the loop over pairs is plain vector code.
 * Copying them two by two with in-register swaps costs less than a gather instruction for each field: 12 fields of a
 * neighbour lie in two cache lines and take 6 loads. */
#ifndef CAST_PHYSICS_BLOCK_H
#define CAST_PHYSICS_BLOCK_H

#include "cast/kernel/pair.h"
#include "cast/particles/particles.h"

enum { BLOCK_PAIRS = 128, BLOCK_LANES = 8 };

typedef struct Block {
  _Alignas(64) double field[RECORD_SIZE][BLOCK_PAIRS];
} Block;

typedef double BlockPair __attribute__((vector_size(16)));
typedef double BlockPairUnaligned __attribute__((vector_size(16), aligned(8)));
typedef int64_t BlockMask __attribute__((vector_size(16)));

PAIR_INLINE void block_put_two(Block *block, ptrdiff_t k, const double *a, const double *b)
{
  for (int f = 0; f < RECORD_SIZE; f += 2) {
    const BlockPair u = *(const BlockPairUnaligned *)(a + f), w = *(const BlockPairUnaligned *)(b + f);
    *(BlockPair *)&block->field[f][k] = __builtin_shuffle(u, w, (BlockMask){0, 2});
    *(BlockPair *)&block->field[f + 1][k] = __builtin_shuffle(u, w, (BlockMask){1, 3});
  }
}

/* Fill the block with the records of n <= BLOCK_PAIRS neighbours. Up to BLOCK_LANES - 1 places behind them are filled
 * with `filler`, a record whose pair terms are zero, so that the loop runs over whole vectors; returns n rounded up. */
PAIR_INLINE ptrdiff_t block_fill(Block *block, const double *record, const int32_t *index, ptrdiff_t n,
                                 const double *filler)
{
  for (ptrdiff_t k = 0; k + 1 < n; k += 2)
    block_put_two(block, k, record + (ptrdiff_t)index[k] * RECORD_SIZE, record + (ptrdiff_t)index[k + 1] * RECORD_SIZE);
  const ptrdiff_t rounded = (n + BLOCK_LANES - 1) / BLOCK_LANES * BLOCK_LANES;
  for (ptrdiff_t k = n / 2 * 2; k < rounded; k += 2)
    block_put_two(block, k, k < n ? record + (ptrdiff_t)index[k] * RECORD_SIZE : filler, filler);
  return rounded;
}

#endif
