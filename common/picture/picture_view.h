/* picture_view.h - from the scene's metres to the raster's samples. */
#ifndef COMMON_PICTURE_PICTURE_VIEW_H
#define COMMON_PICTURE_PICTURE_VIEW_H

#include "common/picture/picture_raster.h"
#include "common/vector.h"

typedef struct PictureView {
  double right[3], up[3], near[3]; // unit vectors of the page, `near` towards the viewer
  double scale;                    // samples per m
  double middle[2];                // m along right and up, in the middle of the raster
  double half[2];                  // samples, half the raster
} PictureView;

RasterVertex picture_project(const PictureView *view, const double x[3]);
double picture_beyond_cut(const PictureScene *scene, const double x[3]); // m, > 0: taken away
void picture_draw_section(const PictureScene *scene, const PictureView *view, Raster *raster);

#endif
