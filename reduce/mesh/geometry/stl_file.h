/* stl_file.h - a closed surface of triangles from an STL file, text or binary. */
#ifndef REDUCE_MESH_GEOMETRY_STL_FILE_H
#define REDUCE_MESH_GEOMETRY_STL_FILE_H

#include <stddef.h>
#include <stdint.h>
#include "common/error.h"

enum { STL_NAME = 64 };

typedef struct StlSurface {
  size_t n_points, n_triangles, n_solids;
  double *x;              // [n_points*3] in the file's unit; points that coincide are one
  int32_t *triangle;      // [n_triangles*3]
  int32_t *solid;         // [n_triangles]
  char (*name)[STL_NAME]; // [n_solids] as the file has them; "" if it gives none
} StlSurface;

/* Errors: CAST_ERR_IO, CAST_ERR_INPUT with line or byte, CAST_ERR_MEMORY. */
CastStatus stl_read(const char *path, StlSurface **surface, CastError *err);
void stl_destroy(StlSurface **surface);

/* Is it the boundary of a body? Closed, wound outwards all over, without triangles of no area, nowhere through itself.
 * Errors: CAST_ERR_INPUT with all such faults and where they are; `unit` m. */
CastStatus stl_check(const StlSurface *surface, const char *path, double unit, CastError *err);
double stl_volume(const StlSurface *surface); // in the file's unit

#endif
