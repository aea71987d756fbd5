/* picture.h - pictures as PNG files: 3D scenes of surfaces and particles, and plots of curves, one or several to a
 * page. Knows nothing of moulds or melts: callers hand over points, triangles, values. Everything handed over is
 * borrowed for the call only. Same input, same pixels.
 *
 *   Picture *picture;
 *   CAST_CALL(picture_create(&(PicturePage){.width = 1200, .height = 600, .columns = 2, .scale = {&melt}}, &picture,
 * err)); CAST_CALL(picture_draw_scene(picture, 0, &scene, err)); CAST_CALL(picture_draw_plot(picture, 1, &plot, err));
 *   status = picture_save(picture, "filling.png", err);
 *   picture_destroy(&picture); */
#ifndef COMMON_PICTURE_PICTURE_H
#define COMMON_PICTURE_PICTURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "common/error.h"

typedef struct Picture Picture;

typedef struct PictureColour {
  double red, green, blue; // 0 to 1
} PictureColour;

/* --- colour --- */

typedef enum PictureMap {
  PICTURE_HEAT,    // black, violet, red, orange, pale yellow: temperatures of the melt
  PICTURE_VIRIDIS, // violet, blue, green, yellow: any other field
  PICTURE_WARM,    // pale grey to dark red: how much the mould has warmed
  PICTURE_DIVERGE  // blue, white, red: differences about zero
} PictureMap;

typedef struct PictureScale {
  PictureMap map;
  double low, high;  // values at the ends, in the unit that the title names
  const char *title; // "melt, degC", shown beside the bar
} PictureScale;

PictureColour picture_colour(const PictureScale *scale, double value); // clamped; NaN: mid grey
PictureColour picture_category(size_t i); // well told apart, also by the colour-blind; repeats after 8, then lighter

/* --- page --- */

typedef struct PictureLegend { // a swatch and what it stands for
  PictureColour colour;
  const char *text;
} PictureLegend;

typedef struct PicturePage {
  int width, height;            // pixels, 64 to 16384
  int columns, rows;            // of panels; 0 counts as 1
  const char *title;            // NULL: none
  const PictureScale *scale[2]; // colour bars at the right, NULL: none
  size_t n_legend;
  const PictureLegend *legend; // under the colour bars at the right
} PicturePage;

/* A white page with its title, bars and legend. Errors: CAST_ERR_ARGUMENT, CAST_ERR_MEMORY. */
CastStatus picture_create(const PicturePage *page, Picture **picture, CastError *err);
void picture_destroy(Picture **picture);
/* Written beside `path`, then renamed. Errors: CAST_ERR_IO. */
CastStatus picture_save(Picture *picture, const char *path, CastError *err);

/* --- scenes: orthographic, hidden surfaces removed pixel by pixel, light from behind the viewer --- */

typedef struct PictureSurface { // triangles; those seen from behind are the inside of a solid and are drawn as its cut
  size_t n_points, n_triangles;
  const double *points;         // [n_points*3] m
  const int32_t *triangles;     // [n_triangles*3], normals out of the solid
  const PictureColour *colours; // [n_triangles]; or NULL and
  const double *point_values;   // [n_points] through `scale`; or NULL: `colour`
  const PictureScale *scale;
  PictureColour colour;
  const int32_t *groups; // [n_triangles] a fine line is drawn where the group changes; NULL: none
  bool clipped;          // the scene's cut takes part of it away
  bool two_sided;        // not a solid: both sides are shown alike, no cut face
  PictureColour inside;  // of the cut face; all zero: light grey
} PictureSurface;

typedef struct PictureCloud { // particles, drawn as balls
  size_t n;
  const double *x[3];   // [n] m
  double radius;        // m
  const double *values; // [n] through `scale`; NULL: `colour`
  const PictureScale *scale;
  PictureColour colour;
  bool clipped; // those whose centre the scene's cut takes away are not drawn
} PictureCloud;

typedef struct PictureSection { // tetrahedra: shown where the scene's cut goes through them, in colours of their values
  size_t n_tetrahedra;
  const double *points;      // [*3] m
  const int32_t *tetrahedra; // [n_tetrahedra*4]
  const double *point_values;
  const PictureScale *scale;
} PictureSection;

typedef struct PictureScene {
  double azimuth, elevation; // degrees; (0, 0) looks from +x, (-90, 0) from -y, (any, 90) from above; z is up
  bool cut;                  // what lies at (x - cut_point) . cut_normal > 0 is taken away
  double cut_point[3], cut_normal[3];
  bool framed;            // show the box low..high rather than all there is
  double low[3], high[3]; // m
  size_t n_surfaces, n_clouds;
  const PictureSurface *surfaces;
  const PictureCloud *clouds;
  const PictureSection *section; // NULL: none
  const char *caption;           // above the panel: "t = 20 ms"; NULL: none
  bool no_scale_bar, no_axes;
} PictureScene;

/*  panel  from 0, row by row
 * Errors: CAST_ERR_ARGUMENT (nothing to show, numbers that are not finite), CAST_ERR_MEMORY. */
CastStatus picture_draw_scene(Picture *picture, int panel, const PictureScene *scene, CastError *err);

/* --- plots --- */

typedef enum PictureLine { PICTURE_SOLID, PICTURE_DASHED, PICTURE_DOTTED, PICTURE_NO_LINE } PictureLine;

typedef struct PictureCurve {
  size_t n;
  const double *x, *y; // [n]; a NaN (on a logarithmic axis also <= 0) interrupts the curve
  const char *label;   // NULL: not in the legend
  PictureLine line;
  bool markers;
  int colour;   // 1: picture_category(0), and so on; 0: by the curve's place in the list
  double width; // pixels on a page 1200 wide; 0: 2
} PictureCurve;

typedef struct PicturePlot {
  const char *title, *x_label, *y_label; // NULL: none
  bool log_x, log_y;
  bool x_limits, y_limits; // use those given below; else what the curves need
  double x_low, x_high, y_low, y_high;
  size_t n_curves;
  const PictureCurve *curves;
} PicturePlot;

/* Errors: CAST_ERR_ARGUMENT: no point that can be shown, limits that are none. */
CastStatus picture_draw_plot(Picture *picture, int panel, const PicturePlot *plot, CastError *err);

#endif
