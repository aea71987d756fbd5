/* synthetic_box.h - what the files of the synthetic box mould share: its shape (synthetic_box_shape.c) and the network
 * of heat capacities behind it (synthetic_box.c). For tests: synthetic_rom.h. */
#ifndef TESTS_SUPPORT_SYNTHETIC_BOX_H
#define TESTS_SUPPORT_SYNTHETIC_BOX_H

#include "tests/support/synthetic_rom.h"
#include "tests/support/voxel_mould.h"

enum { BOX_FACES = 10 };

typedef struct Face { // a flat part of the cavity wall, cut into a grid of patches
  double low[3], high[3];
  int axis;       // of its normal
  size_t grid[2]; // along the other two axes, in the order (axis + 1) % 3, (axis + 2) % 3
  size_t first;   // number of its first grid cell among those of all faces
} Face;

typedef struct Box {
  SyntheticBox given; // with defaults filled in
  Face face[BOX_FACES];
  size_t n_grid;     // grid cells of all faces
  int32_t *patch_of; // [n_grid] patch; -1: none (over the pin's hole)
  size_t n_cavity;   // cavity patches
  double *part;      // [n_cavity*6] low and high corner of each
  size_t n;          // nodes of the network
  double *E, *K, *V; // [n], [n*n], [n*n] rows: nodes, columns: modes
} Box;

/* Faces, patches and their names into box and rom, and the rom's geometry; the caller destroys the cells. */
VoxelMould box_shape(Box *box, RomData *rom);
/* Distance, m, between the cell low..high and the box from..to. */
double box_gap(const double low[3], const double high[3], const double from[3], const double to[3]);

#endif
