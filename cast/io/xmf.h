/* xmf.h - the XDMF side file of a VtkSeries: ParaView 5.11 and older read the same HDF5 data sets through it.
 * Each step is a slab of rows of the appendable sets. Written to a temporary name and renamed. */
#ifndef CAST_IO_XMF_H
#define CAST_IO_XMF_H

#include "cast/io/vtk_series.h"

typedef struct XmfPart {       // cells of a mesh that stays; the set holds [n_cells, corners] integers of 4 bytes
  const char *name, *topology; // "cavity and outer surface", "Triangle"
  const char *set;             // path in the HDF5 file
  size_t n_cells;
  int corners;
  size_t n_maps;       // values of its cells, the same at all steps
  const VtkField *map; // [n_maps] in CellData
} XmfPart;

/* `path` of the side file; it names the series' file relative to its own folder (both must lie in the same one).
 *   n_parts  0: each point is a vertex
 * Errors: CAST_ERR_IO. */
CastStatus xmf_write(const char *path, const VtkSeries *series, size_t n_parts, const XmfPart *part, CastError *err);

#endif
