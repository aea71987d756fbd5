/* surface.h - the closed triangulated boundary of the mould, as the melt meets it.
 * Built from a ROM's geometry; constant once created, so threads may share it. Triangles wind so that their normal
 * points out of the mould: signed distance is positive in the cavity and the open air, negative inside the mould. */
#ifndef CAST_GEOMETRY_SURFACE_H
#define CAST_GEOMETRY_SURFACE_H

#include <stdbool.h>
#include "common/rom/rom.h"

typedef struct Surface Surface;

typedef struct SurfaceHit {
  int32_t triangle;
  int32_t patch;    // ROM patch of the triangle (cavity or outer)
  double distance;  // m, signed
  double foot[3];   // m, nearest point of the surface
  double normal[3]; // unit, out of the mould, of the face or (angle-weighted) of the edge or corner that is nearest
} SurfaceHit;

/*  reach  m: the largest distance at which surface_nearest will be asked; sizes the search grid
 * Errors: CAST_ERR_FORMAT (not closed), CAST_ERR_MEMORY. */
CastStatus surface_create(const RomData *rom, double reach, Surface **surface, CastError *err);
void surface_destroy(Surface **surface);
void surface_bounds(const Surface *surface, double low[3], double high[3]);
double surface_reach(const Surface *surface);

/* The nearest point of the surface within `reach`; false if there is none. Sign by angle-weighted pseudo-normals
 * (Baerentzen & Aanaes 2005), exact at edges and corners. */
bool surface_nearest(const Surface *surface, const double x[3], double reach, SurfaceHit *hit);
/* Distance to one triangle's plane-bounded region and its foot, without a search (for a particle whose nearest triangle
 * is known from the last rebuild). Unsigned. */
double surface_triangle_distance(const Surface *surface, int32_t triangle, const double x[3], double foot[3]);
/* Is x inside the mould's solid? Right at any distance: cells of the grid away from the surface know their side. */
bool surface_inside_mould(const Surface *surface, const double x[3]);
/* Does the mould stand between a and b, so that melt at one does not feel what is at the other? True if the straight
 * way passes through the mould, unless it only clips a convex edge blunter than 60 degrees (melt meets round it). Right
 * for ends up to surface_reach apart: elsewhere than near a wall thinner than that nothing stands between, and the
 * answer is one grid look-up. An end that lies in the mould counts for the side nearest to it. Nothing passes between
 * triangles. For a wall particle see walls_seen. */
bool surface_separates(const Surface *surface, const double a[3], const double b[3]);
/* May surface_separates be true for any pair with one end at x and length below reach? (The quick test.) */
bool surface_thin_near(const Surface *surface, const double x[3]);

/* Points spread evenly over the CAVITY wall, one for about each spacing^2, each with its area; the areas of a patch add
 * up to the patch's. Used for the wetted area and the filling. */
typedef struct SurfaceSamples {
  ptrdiff_t n;
  double *x[3]; // m
  double *area; // m2
  int32_t *patch;
} SurfaceSamples;
CastStatus surface_samples_create(const Surface *surface, double spacing, SurfaceSamples *samples, CastError *err);
void surface_samples_destroy(SurfaceSamples *samples);

#endif
