/* shaped_mould.h - closed surfaces for tests of the geometry: a block out of which boxes are cut and into which boxes
 * are put back, bent by a map if wished. Only the geometry of the ROM is filled, with two patches: "cavity" (0), the
 * faces of the block's cells that look at a void within the block, and "outer" (1), the block's own faces. */
#ifndef TESTS_SUPPORT_SHAPED_MOULD_H
#define TESTS_SUPPORT_SHAPED_MOULD_H

#include "common/rom/rom.h"

typedef struct ShapedBox {
  double low[3], high[3]; // m
  bool solid;
} ShapedBox;

typedef struct ShapedMould {
  double low[3], high[3]; // m, the block
  int n_boxes;
  const ShapedBox *box;                           // one after the other
  double cell;                                    // m, largest edge of the grid along an axis
  void (*bend)(const void *context, double x[3]); // moves each point; must keep the orientation. NULL: none
  const void *context;
} ShapedMould;

RomData *shaped_mould_create(const ShapedMould *shape); // caller: rom_destroy

/* Maps for bend. */
typedef struct Turn {
  double axis[3], angle, shift[3]; // unit, rad, m: rotate about the origin, then shift
} Turn;
void bend_turn(const void *turn, double x[3]);
/* The cube [-a, a]^3 becomes a ball of radius a, and cubes around it smoothly go over to cubes; a square prism of half
 * width a along z becomes a cylinder. context: double a, and the half width b beyond which nothing moves. */
void bend_ball(const void *a_and_b, double x[3]);
void bend_cylinder(const void *a_and_b, double x[3]);

#endif
