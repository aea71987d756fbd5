/* picture.c - the page: title, panels, colour bars, legend; text; saving. */
#include "common/picture/picture_private.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const PictureColour WHITE = {1.0, 1.0, 1.0};

void picture_set_colour(cairo_t *cairo, PictureColour colour)
{
  cairo_set_source_rgb(cairo, colour.red, colour.green, colour.blue);
}

void picture_rectangle(cairo_t *cairo, PictureBox box, PictureColour colour)
{
  picture_set_colour(cairo, colour);
  cairo_rectangle(cairo, box.x, box.y, box.width, box.height);
  cairo_fill(cairo);
}

static void select_font(cairo_t *cairo, double size, bool bold)
{
  cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, size);
}

static double advance(cairo_t *cairo, const char *text)
{
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, text, &extents);
  return extents.x_advance;
}

/* A hyphen before a digit is set as a minus sign. */
static void typeset(const char *text, char *set, size_t size)
{
  size_t n = 0;
  for (const char *c = text; *c && n + 4 < size; c++) {
    const bool minus = *c == '-' && c[1] >= '0' && c[1] <= '9' && (c == text || c[-1] == ' ' || c[-1] == '(');
    if (minus)
      n += (size_t)snprintf(set + n, size - n, "\xe2\x88\x92");
    else
      set[n++] = *c;
  }
  set[n] = '\0';
}

/* "1.5e-05" and "10^-3" end in a power of ten: the part before it, and the exponent. False: plain text. */
static bool split_power(const char *text, char base[64], char exponent[16])
{
  const char *caret = strchr(text, '^'), *e = NULL;
  int power = 0;
  if (caret && strncmp(text, "10", 2) == 0 && sscanf(caret + 1, "%d", &power) == 1) {
    snprintf(base, 64, "10");
  } else {
    char *end = NULL;
    if (strtod(text, &end) == 0.0 || end == text || *end || !(e = strchr(text, 'e'))) return false;
    power = atoi(e + 1);
    char number[32], set[48];
    snprintf(number, sizeof number, "%.*s", (int)(e - text), text);
    typeset(number, set, sizeof set);
    snprintf(base, 64,
             "%s\xc2\xb7"
             "10",
             set);
  }
  snprintf(exponent, 16, "%s%d", power < 0 ? "\xe2\x88\x92" : "", abs(power));
  return true;
}

double picture_text_width(cairo_t *cairo, const char *text, double size)
{
  char base[64], exponent[16], set[512];
  select_font(cairo, size, false);
  if (!split_power(text, base, exponent)) {
    typeset(text, set, sizeof set);
    return advance(cairo, set);
  }
  const double width = advance(cairo, base);
  cairo_set_font_size(cairo, 0.72 * size);
  return width + advance(cairo, exponent);
}

double picture_text(cairo_t *cairo, double x, double y, const char *text, PictureFont font)
{
  char base[64], exponent[16], set[512];
  const bool power = split_power(text, base, exponent);
  typeset(text, set, sizeof set);
  double width = picture_text_width(cairo, text, font.size);
  select_font(cairo, font.size, font.bold);
  if (!power) width = advance(cairo, set);
  const double left = font.anchor == PICTURE_LEFT ? x : font.anchor == PICTURE_CENTRE ? x - 0.5 * width : x - width;
  cairo_set_source_rgb(cairo, font.grey, font.grey, font.grey);
  cairo_move_to(cairo, left, y);
  cairo_show_text(cairo, power ? base : set);
  if (power) {
    cairo_rel_move_to(cairo, 0.0, -0.42 * font.size);
    cairo_set_font_size(cairo, 0.72 * font.size);
    cairo_show_text(cairo, exponent);
  }
  return width;
}

static void draw_bar(Picture *picture, const PictureScale *scale, PictureBox box)
{
  cairo_t *cairo = picture->cairo;
  const double u = picture->unit;
  const int strips = (int)fmax(2.0, box.height);
  for (int i = 0; i < strips; i++) {
    const double value = scale->high + (scale->low - scale->high) * (i + 0.5) / strips;
    const double top = box.y + box.height * i / strips;
    picture_rectangle(cairo, (PictureBox){box.x, top, box.width, box.height / strips + 0.6},
                      picture_colour(scale, value));
  }
  cairo_set_line_width(cairo, fmax(1.0, 0.06 * u));
  cairo_set_source_rgb(cairo, 0.3, 0.3, 0.3);
  cairo_rectangle(cairo, box.x, box.y, box.width, box.height);
  cairo_stroke(cairo);
  PictureTicks ticks;
  picture_ticks_linear(scale->low, scale->high, 5, &ticks);
  for (int i = 0; i < ticks.n; i++) {
    const double y = box.y + box.height * (scale->high - ticks.value[i]) / (scale->high - scale->low);
    cairo_set_source_rgb(cairo, 0.3, 0.3, 0.3);
    cairo_move_to(cairo, box.x + box.width, y);
    cairo_line_to(cairo, box.x + box.width + 0.35 * u, y);
    cairo_stroke(cairo);
    picture_text(cairo, box.x + box.width + 0.6 * u, y + 0.33 * u, ticks.label[i],
                 (PictureFont){0.92 * u, false, PICTURE_LEFT, 0.1});
  }
  picture_text(cairo, box.x, box.y - 0.7 * u, scale->title ? scale->title : "",
               (PictureFont){u, false, PICTURE_LEFT, 0.0});
}

static double draw_legend(Picture *picture, const PicturePage *page, double x, double y)
{
  const double u = picture->unit;
  for (size_t i = 0; i < page->n_legend; i++, y += 1.5 * u) {
    picture_rectangle(picture->cairo, (PictureBox){x, y, u, u}, page->legend[i].colour);
    picture_text(picture->cairo, x + 1.5 * u, y + 0.85 * u, page->legend[i].text,
                 (PictureFont){0.92 * u, false, PICTURE_LEFT, 0.1});
  }
  return y;
}

/* Width of what stands at the right of the panels, pixels. */
static double side_width(Picture *picture, const PicturePage *page)
{
  const double u = picture->unit;
  double width = 0.0;
  for (int i = 0; i < 2; i++) {
    if (!page->scale[i]) continue;
    const char *title = page->scale[i]->title ? page->scale[i]->title : "";
    width = fmax(width, fmax(5.0 * u, picture_text_width(picture->cairo, title, u)));
  }
  for (size_t i = 0; i < page->n_legend; i++)
    width = fmax(width, 1.5 * u + picture_text_width(picture->cairo, page->legend[i].text, 0.92 * u));
  return width > 0.0 ? width + 2.0 * u : 0.0;
}

static void draw_page(Picture *picture, const PicturePage *page)
{
  const double u = picture->unit, side = side_width(picture, page);
  picture_rectangle(picture->cairo, (PictureBox){0, 0, picture->width, picture->height}, WHITE);
  const double top = page->title ? 2.8 * u : 0.6 * u, bottom = 0.6 * u;
  picture->content = (PictureBox){0.6 * u, top, picture->width - 1.2 * u - side, picture->height - top - bottom};
  if (page->title)
    picture_text(picture->cairo, 1.2 * u, 2.0 * u, page->title, (PictureFont){1.25 * u, true, PICTURE_LEFT, 0.0});
  const double x = picture->width - side;
  const int bars = (page->scale[0] != NULL) + (page->scale[1] != NULL);
  const double legend = page->n_legend > 0 ? 1.5 * u * (double)page->n_legend + u : 0.0;
  const double room = picture->content.height - legend - 2.0 * u;
  const double share = bars ? fmin(room / bars, 22.0 * u) : 0.0;
  double y = picture->content.y + 2.2 * u;
  for (int i = 0; i < 2; i++) {
    if (!page->scale[i]) continue;
    draw_bar(picture, page->scale[i], (PictureBox){x, y, 1.3 * u, share - 3.2 * u});
    y += share;
  }
  draw_legend(picture, page, x, y);
}

CastStatus picture_create(const PicturePage *page, Picture **picture, CastError *err)
{
  *picture = NULL;
  CAST_CHECK(page->width >= 64 && page->width <= 16384 && page->height >= 64 && page->height <= 16384, err,
             CAST_ERR_ARGUMENT, "a picture of %d x %d pixels, 64 to 16384 each are possible", page->width,
             page->height);
  for (int i = 0; i < 2; i++)
    CAST_CHECK(!page->scale[i] || page->scale[i]->low < page->scale[i]->high, err, CAST_ERR_ARGUMENT,
               "a colour scale from %g to %g, an ascending one is needed", page->scale[i]->low, page->scale[i]->high);
  Picture *made = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory for a picture");
  made->width = page->width;
  made->height = page->height;
  made->columns = page->columns > 0 ? page->columns : 1;
  made->rows = page->rows > 0 ? page->rows : 1;
  made->unit = page->width / 75.0;
  made->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, page->width, page->height);
  made->cairo = cairo_create(made->surface);
  if (cairo_status(made->cairo) != CAIRO_STATUS_SUCCESS) {
    picture_destroy(&made);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for a picture of %d x %d pixels", page->width, page->height);
  }
  draw_page(made, page);
  *picture = made;
  return CAST_OK;
}

void picture_destroy(Picture **picture)
{
  if (!picture || !*picture) return;
  cairo_destroy((*picture)->cairo);
  cairo_surface_destroy((*picture)->surface);
  free(*picture);
  *picture = NULL;
}

CastStatus picture_save(Picture *picture, const char *path, CastError *err)
{
  char temporary[4096];
  const int length = snprintf(temporary, sizeof temporary, "%s.%ld.part", path, (long)getpid());
  CAST_CHECK(length > 0 && (size_t)length < sizeof temporary, err, CAST_ERR_IO, "%s: the path is too long", path);
  cairo_surface_flush(picture->surface);
  const cairo_status_t status = cairo_surface_write_to_png(picture->surface, temporary);
  if (status == CAIRO_STATUS_SUCCESS && rename(temporary, path) == 0) return CAST_OK;
  unlink(temporary);
  return cast_error_set(err, CAST_ERR_IO, "%s: the picture cannot be written%s%s", path,
                        status == CAIRO_STATUS_SUCCESS ? "" : ": ",
                        status == CAIRO_STATUS_SUCCESS ? "" : cairo_status_to_string(status));
}

CastStatus picture_panel(const Picture *picture, int panel, PictureBox *box, CastError *err)
{
  CAST_CHECK(panel >= 0 && panel < picture->columns * picture->rows, err, CAST_ERR_ARGUMENT,
             "panel %d of a picture that has %d", panel, picture->columns * picture->rows);
  const double gap = 0.8 * picture->unit;
  const double width = (picture->content.width - gap * (picture->columns - 1)) / picture->columns;
  const double height = (picture->content.height - gap * (picture->rows - 1)) / picture->rows;
  *box = (PictureBox){picture->content.x + (panel % picture->columns) * (width + gap),
                      picture->content.y + (panel / picture->columns) * (height + gap), width, height};
  return CAST_OK;
}
