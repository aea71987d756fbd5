/* block.h - records of a row's neighbours laid out field by field, so that the loop over pairs is plain vector code.
 * Copying them eight by eight with swaps in registers costs less than a gather instruction for each field: the 12
 * fields of a neighbour lie in one or two cache lines and take 3 loads. Two records share a register of 32 bytes, half
 * the swaps and stores that 16 bytes take; the second is put in as it is loaded, what gcc 12 does for pairs of integers
 * of 128 bits alone. */
#ifndef CAST_PHYSICS_BLOCK_H
#define CAST_PHYSICS_BLOCK_H

#include "cast/kernel/pair.h"
#include "cast/particles/particles.h"

enum { BLOCK_PAIRS = 256, BLOCK_LANES = 16, BLOCK_STEP = 8 };

typedef union Block {
  _Alignas(64) float value[RECORD_SIZE][BLOCK_PAIRS];
  _Alignas(64) uint32_t place[RECORD_SIZE][BLOCK_PAIRS];
} Block;

__extension__ typedef __int128 BlockQuad __attribute__((may_alias)); // four fields of a record
typedef BlockQuad BlockPair __attribute__((vector_size(32)));
typedef float BlockOct __attribute__((vector_size(32), may_alias));

/* Fields [first, first + 4) of eight records to places [k, k + 8). */
PAIR_INLINE void block_put_eight(Block *block, int first, ptrdiff_t k, const RecordField *const record[BLOCK_STEP])
{
  BlockOct pair[4];
  for (int l = 0; l < 4; l++)
    pair[l] = (BlockOct)(BlockPair){*(const BlockQuad *)(const void *)(record[l] + first),
                                    *(const BlockQuad *)(const void *)(record[l + 4] + first)};
  const BlockOct a = pair[0], b = pair[1], c = pair[2], d = pair[3];
  const BlockOct ab_low = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13),
                 ab_high = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15),
                 cd_low = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13),
                 cd_high = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  *(BlockOct *)&block->value[first][k] = __builtin_shufflevector(ab_low, cd_low, 0, 1, 8, 9, 4, 5, 12, 13);
  *(BlockOct *)&block->value[first + 1][k] = __builtin_shufflevector(ab_low, cd_low, 2, 3, 10, 11, 6, 7, 14, 15);
  *(BlockOct *)&block->value[first + 2][k] = __builtin_shufflevector(ab_high, cd_high, 0, 1, 8, 9, 4, 5, 12, 13);
  *(BlockOct *)&block->value[first + 3][k] = __builtin_shufflevector(ab_high, cd_high, 2, 3, 10, 11, 6, 7, 14, 15);
}

/* Fill the block with the first `fields` fields (a multiple of 4) of the records of n <= BLOCK_PAIRS neighbours. Up to
 * BLOCK_LANES - 1 places behind them are filled with `filler`, a record whose pair terms are zero, so that the loop
 * runs over whole vectors; returns n rounded up. */
PAIR_INLINE ptrdiff_t block_fill(Block *block, int fields, const RecordField *record, const int32_t *index, ptrdiff_t n,
                                 const RecordField *filler)
{
  const ptrdiff_t whole = n / BLOCK_STEP * BLOCK_STEP, rounded = (n + BLOCK_LANES - 1) / BLOCK_LANES * BLOCK_LANES;
  const RecordField *step[BLOCK_STEP];
  for (ptrdiff_t k = 0; k < whole; k += BLOCK_STEP) {
    for (ptrdiff_t l = 0; l < BLOCK_STEP; l++) step[l] = record + (ptrdiff_t)index[k + l] * RECORD_SIZE;
    for (int first = 0; first < fields; first += 4) block_put_eight(block, first, k, step);
  }
  for (ptrdiff_t k = whole; k < rounded; k += BLOCK_STEP) {
    for (ptrdiff_t l = 0; l < BLOCK_STEP; l++)
      step[l] = k + l < n ? record + (ptrdiff_t)index[k + l] * RECORD_SIZE : filler;
    for (int first = 0; first < fields; first += 4) block_put_eight(block, first, k, step);
  }
  return rounded;
}

#endif
