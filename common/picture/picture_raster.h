/* picture_raster.h - a depth buffer: the nearest piece of surface at each sample, several samples to a pixel. */
#ifndef COMMON_PICTURE_PICTURE_RASTER_H
#define COMMON_PICTURE_PICTURE_RASTER_H

#include "common/picture/picture_private.h"

enum { RASTER_SAMPLES = 3 };                                     // along each side of a pixel
enum { RASTER_NOTHING = -1, RASTER_CUT = -2, RASTER_BALL = -3 }; // groups that are not the caller's

typedef struct Raster {
  int width, height; // samples
  float *depth;      // towards the viewer; -INFINITY: nothing there
  uint32_t *colour;  // 0xRRGGBB
  int32_t *group;
} Raster;

typedef struct RasterVertex {
  double x, y, z; // samples, y down; z towards the viewer
  double beyond;  // m beyond the cut; > 0: taken away
  double value;   // of the scale, where used
} RasterVertex;

typedef struct RasterPaint { // how a triangle looks
  PictureColour colour;
  const PictureScale *scale; // colour from the vertices' values; NULL: `colour`
  double light;              // factor on the colour
  int32_t group;
} RasterPaint;

CastStatus raster_create(int width, int height, Raster *raster, CastError *err); // in pixels
void raster_destroy(Raster *raster);
void raster_triangle(Raster *raster, const RasterVertex vertex[3], const RasterPaint *paint);
/* A ball seen from afar; radius in samples. */
void raster_ball(Raster *raster, double x, double y, double z, double radius, PictureColour colour);
/* Darken the samples on the line between two groups. */
void raster_outline(Raster *raster, double strength, int width);
/* Average the samples into the picture, at (left, top). */
void raster_paint(const Raster *raster, Picture *picture, int left, int top);

#endif
