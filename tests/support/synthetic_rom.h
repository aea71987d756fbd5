/* synthetic_rom.h - valid ROMs made from closed forms, without a mesh generator and without finite elements, for tests
 * of everything that reads a ROM. The caller destroys them with rom_destroy. */
#ifndef TESTS_SUPPORT_SYNTHETIC_ROM_H
#define TESTS_SUPPORT_SYNTHETIC_ROM_H

#include "common/rom/rom.h"

/* A slab of mould 0 <= x <= size[0], 0 <= y <= size[1], -depth <= z <= 0. The melt stands on its top face z = 0, the
 * cavity wall, cut into patches[0] x patches[1] equal patches "top/1".. (x runs fastest); the outer patches are
 * "bottom" (h_bottom; 0: insulated) and "sides" (insulated).
 * The states are the exact modes cos(i pi x/size[0]) cos(j pi y/size[1]) cos(mu_k z/depth), mu_k tan mu_k = h
 * depth/kappa (mu_k = k pi where insulated), and for h > 0 what the modes in depth leave over of the constant
 * temperature. Truncation makes the wall of a slab too cold by 2 q depth/(kappa pi^2 modes) K under a heat flux q W/m2
 * that began earlier than the last mode's 1/lambda ago: modes > 20 depth/sqrt(alpha t) is ample at the time t. */
typedef struct SyntheticSlab {
  double size[2], depth;   // m
  double kappa, rho, c;    // W/(m K), kg/m3, J/(kg K)
  double h_bottom;         // W/(m2 K)
  size_t modes;            // in depth, >= 1
  size_t modes_lateral[2]; // in x and y, >= 1 (0 counts as 1: uniform over the face)
  size_t patches[2];       // >= 1 (0 counts as 1)
  size_t cells[2];         // of the surface mesh along x and y for each patch; 0: 2
  double band;             // m, tetrahedra reach this deep; 0: depth/4
  size_t band_layers;      // of cells over the band; 0: 8
  double growth;           // ratio of successive layers' heights, >= 1; 0: 1
} SyntheticSlab;
CastStatus synthetic_rom_slab(const SyntheticSlab *slab, RomData **rom, CastError *err);
RomData *
synthetic_rom_small(void); // a slab of few modes, with all arrays of the certificate; aborts the test on failure

/* A box of mould with a box cavity open at the top: the rim is the plane z = 0, the axis of the opening is x = y = 0.
 *   mould   -outer[0]/2 <= x <= outer[0]/2, the same in y, -outer[2] <= z <= 0
 *   cavity  -cavity[0]/2 <= x <= cavity[0]/2, the same in y, -cavity[2] <= z <= 0
 *   pin     a square blind hole of width pin_width, centred in the cavity's floor, going down by pin_depth (0: no pin)
 * Cavity patches: surface "cavity" (floor and walls) and surface "pin" (walls and bottom), each flat face one patch or,
 * with patch_size > 0, a grid of patches of about that size. Outer patches: "rim" (the top face) and "outside" (sides
 * and bottom, Robin with h_outside).
 * The thermal model is a network: behind each cavity patch a column of nodes to the depth `reach` (linear finite
 * volumes of the patch's area), all joined to one node that is the rest of the mould and loses to the surroundings. So
 * patches warm like a slab at first, heat is conserved exactly, and geometry is exact. Points of the band take the
 * temperature of their nearest patch's column at their depth. */
typedef struct SyntheticBox {
  double outer[3], cavity[3];  // m
  double pin_width, pin_depth; // m
  double cell;                 // m, largest edge of the surface mesh
  double patch_size;           // m; 0: one patch for each flat face
  double kappa, rho, c;
  double h_outside; // W/(m2 K)
  double reach;     // m, depth of the columns; 0: a quarter of the thinnest mould wall
  size_t nodes;     // of each column, >= 1; 0: 6
  double band;      // m; tetrahedra of all cells nearer than this to the cavity; 0: 3 cells
} SyntheticBox;
CastStatus synthetic_rom_box_cavity(const SyntheticBox *box, RomData **rom, CastError *err);

#endif
