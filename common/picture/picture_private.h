/* picture_private.h - what the picture_*.c files share. */
#ifndef COMMON_PICTURE_PICTURE_PRIVATE_H
#define COMMON_PICTURE_PICTURE_PRIVATE_H

#include <cairo.h>
#include "common/picture/picture.h"

typedef struct PictureBox { // pixels, y down
  double x, y, width, height;
} PictureBox;

struct Picture {
  cairo_surface_t *surface;
  cairo_t *cairo;
  int width, height, columns, rows;
  double unit;        // pixels: everything is sized in these, so that a page looks the same at any resolution
  PictureBox content; // where the panels are
};

typedef enum PictureAnchor { PICTURE_LEFT, PICTURE_CENTRE, PICTURE_RIGHT } PictureAnchor;
typedef struct PictureFont {
  double size; // pixels
  bool bold;
  PictureAnchor anchor;
  double grey; // 0: black
} PictureFont;

enum { PICTURE_MOST_TICKS = 64 };
typedef struct PictureTicks {
  int n;
  double value[PICTURE_MOST_TICKS];
  char label[PICTURE_MOST_TICKS][24]; // empty: a minor tick; "10^-3" stands for a power
} PictureTicks;

/* The panel's box. Errors: CAST_ERR_ARGUMENT: no such panel. */
CastStatus picture_panel(const Picture *picture, int panel, PictureBox *box, CastError *err);
void picture_set_colour(cairo_t *cairo, PictureColour colour);
/* Text with its baseline at y; returns its width. "10^-3" is set as a power. */
double picture_text(cairo_t *cairo, double x, double y, const char *text, PictureFont font);
double picture_text_width(cairo_t *cairo, const char *text, double size);
void picture_rectangle(cairo_t *cairo, PictureBox box, PictureColour colour);
double picture_nice_step(double span, int parts); // 1, 2 or 5 times a power of ten, about span/parts
void picture_ticks_linear(double low, double high, int parts, PictureTicks *ticks);
void picture_ticks_log(double low, double high, PictureTicks *ticks);

#endif
