/* voxel_mould.h - a mould of box-shaped cells on a rectangular grid, split into tetrahedra: geometry for synthetic
 * ROMs. */
#ifndef TESTS_SUPPORT_VOXEL_MOULD_H
#define TESTS_SUPPORT_VOXEL_MOULD_H

#include "common/rom/rom.h"

typedef struct VoxelMould {
  size_t n[3];          // cells along each axis
  double *lines[3];     // [n + 1] m, ascending, owned
  unsigned char *solid; // [n0*n1*n2], x fastest, owned: 1 where the mould is
  unsigned char *band;  // the same: 1 for the solid cells whose tetrahedra go into the ROM
} VoxelMould;

/* The face of a solid cell that looks along +axis or -axis at void. `inside`: the void is a cell of the grid. */
typedef struct VoxelFace {
  int axis, sign;
  bool inside;
  double low[3], high[3]; // m, equal along axis
} VoxelFace;

/* Cells for the given lines (handed over), all solid, none in the band. */
VoxelMould voxel_mould_create(const size_t n[3], double *const lines[3]);
void voxel_mould_destroy(VoxelMould *mould);
size_t voxel_cell(const VoxelMould *mould, size_t i, size_t j, size_t k);

/* Fill points, triangles, tetrahedra and min_edge of rom, whose patches exist, and the areas and centroids of the
 * patches. patch_of tells the patch of a face. Each cell is split along its diagonal from low to high (Kuhn), so that
 * neighbours match. */
void voxel_mould_geometry(const VoxelMould *mould, int32_t (*patch_of)(const void *context, const VoxelFace *face),
                          const void *context, RomData *rom);

/* calloc that does not return when there is no memory: for test code. */
void *synthetic_array(size_t n, size_t size);
/* What a ROM file wants beyond model and geometry: texts, one material, reduction and certificate ("not computed"). */
void synthetic_particulars(RomData *rom, const char *title, double kappa, double rho, double c);
#endif
