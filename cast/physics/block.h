/* block.h - records of a row's neighbours laid out field by field, so that the loop over pairs is plain vector code.
 * Copying them four by four with swaps in registers costs less than a gather instruction for each field: the 12 fields
 * of a neighbour lie in one or two cache lines and take 3 loads. */
#ifndef CAST_PHYSICS_BLOCK_H
#define CAST_PHYSICS_BLOCK_H

#include "cast/kernel/pair.h"
#include "cast/particles/particles.h"

enum { BLOCK_PAIRS = 256, BLOCK_LANES = 16 };

typedef union Block {
  _Alignas(64) float value[RECORD_SIZE][BLOCK_PAIRS];
  _Alignas(64) uint32_t place[RECORD_SIZE][BLOCK_PAIRS];
} Block;

typedef float BlockQuad __attribute__((vector_size(16), may_alias));

/* Fields [first, first + 4) of four records to places [k, k + 4). */
PAIR_INLINE void block_put_four(Block *block, int first, ptrdiff_t k, const RecordField *const record[4])
{
  const BlockQuad a = *(const BlockQuad *)(const void *)(record[0] + first),
                  b = *(const BlockQuad *)(const void *)(record[1] + first),
                  c = *(const BlockQuad *)(const void *)(record[2] + first),
                  d = *(const BlockQuad *)(const void *)(record[3] + first);
  const BlockQuad ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5),
                  ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7),
                  cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5),
                  cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  *(BlockQuad *)&block->value[first][k] = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
  *(BlockQuad *)&block->value[first + 1][k] = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
  *(BlockQuad *)&block->value[first + 2][k] = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
  *(BlockQuad *)&block->value[first + 3][k] = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

/* Fill the block with the first `fields` fields (a multiple of 4) of the records of n <= BLOCK_PAIRS neighbours. Up to
 * BLOCK_LANES - 1 places behind them are filled with `filler`, a record whose pair terms are zero, so that the loop
 * runs over whole vectors; returns n rounded up. */
PAIR_INLINE ptrdiff_t block_fill(Block *block, int fields, const RecordField *record, const int32_t *index, ptrdiff_t n,
                                 const RecordField *filler)
{
  const ptrdiff_t whole = n / 4 * 4, rounded = (n + BLOCK_LANES - 1) / BLOCK_LANES * BLOCK_LANES;
  for (ptrdiff_t k = 0; k < whole; k += 4) {
    const RecordField *const four[4] = {
        record + (ptrdiff_t)index[k] * RECORD_SIZE, record + (ptrdiff_t)index[k + 1] * RECORD_SIZE,
        record + (ptrdiff_t)index[k + 2] * RECORD_SIZE, record + (ptrdiff_t)index[k + 3] * RECORD_SIZE};
    for (int first = 0; first < fields; first += 4) block_put_four(block, first, k, four);
  }
  for (ptrdiff_t k = whole; k < rounded; k += 4) {
    const RecordField *four[4];
    for (ptrdiff_t l = 0; l < 4; l++) four[l] = k + l < n ? record + (ptrdiff_t)index[k + l] * RECORD_SIZE : filler;
    for (int first = 0; first < fields; first += 4) block_put_four(block, first, k, four);
  }
  return rounded;
}

#endif
