#include "common/picture/picture_raster.h"

#include <math.h>
#include <stdlib.h>

CastStatus raster_create(int width, int height, Raster *raster, CastError *err)
{
  raster->width = width * RASTER_SAMPLES;
  raster->height = height * RASTER_SAMPLES;
  const size_t n = (size_t)raster->width * (size_t)raster->height;
  raster->depth = malloc(n * sizeof *raster->depth);
  raster->colour = malloc(n * sizeof *raster->colour);
  raster->group = malloc(n * sizeof *raster->group);
  if (!raster->depth || !raster->colour || !raster->group) {
    raster_destroy(raster);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for a scene of %d x %d pixels", width, height);
  }
  for (size_t i = 0; i < n; i++) {
    raster->depth[i] = -INFINITY;
    raster->colour[i] = 0xffffff;
    raster->group[i] = RASTER_NOTHING;
  }
  return CAST_OK;
}

void raster_destroy(Raster *raster)
{
  free(raster->depth);
  free(raster->colour);
  free(raster->group);
  *raster = (Raster){0};
}

static uint32_t channel(double value)
{
  return (uint32_t)(255.0 * fmin(fmax(value, 0.0), 1.0) + 0.5);
}

static uint32_t pack(PictureColour colour, double light)
{
  return channel(colour.red * light) << 16 | channel(colour.green * light) << 8 | channel(colour.blue * light);
}

static void put(Raster *raster, int x, int y, double z, uint32_t colour, int32_t group)
{
  const size_t i = (size_t)y * (size_t)raster->width + (size_t)x;
  if ((float)z <= raster->depth[i]) return;
  raster->depth[i] = (float)z;
  raster->colour[i] = colour;
  raster->group[i] = group;
}

static int clamp_sample(double value, int limit)
{
  return value < 0.0 ? 0 : value > limit ? limit : (int)value;
}

static double least3(double a, double b, double c)
{
  return fmin(a, fmin(b, c));
}

void raster_triangle(Raster *raster, const RasterVertex vertex[3], const RasterPaint *paint)
{
  const RasterVertex *a = &vertex[0], *b = &vertex[1], *c = &vertex[2];
  const double area = (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
  if (area == 0.0 || (a->beyond > 0.0 && b->beyond > 0.0 && c->beyond > 0.0)) return;
  const int left = clamp_sample(floor(least3(a->x, b->x, c->x)), raster->width);
  const int right = clamp_sample(ceil(-least3(-a->x, -b->x, -c->x)) + 1.0, raster->width);
  const int top = clamp_sample(floor(least3(a->y, b->y, c->y)), raster->height);
  const int bottom = clamp_sample(ceil(-least3(-a->y, -b->y, -c->y)) + 1.0, raster->height);
  const uint32_t flat = pack(paint->colour, paint->light);
  for (int y = top; y < bottom; y++)
    for (int x = left; x < right; x++) {
      // shares of the corners at the sample's centre: areas of the part-triangles over the whole
      const double px = x + 0.5, py = y + 0.5;
      const double wa = ((b->x - px) * (c->y - py) - (b->y - py) * (c->x - px)) / area;
      const double wb = ((c->x - px) * (a->y - py) - (c->y - py) * (a->x - px)) / area;
      const double wc = 1.0 - wa - wb;
      if (wa < 0.0 || wb < 0.0 || wc < 0.0) continue;
      if (wa * a->beyond + wb * b->beyond + wc * c->beyond > 0.0) continue;
      const double z = wa * a->z + wb * b->z + wc * c->z;
      const uint32_t colour =
          paint->scale ? pack(picture_colour(paint->scale, wa * a->value + wb * b->value + wc * c->value), paint->light)
                       : flat;
      put(raster, x, y, z, colour, paint->group);
    }
}

void raster_ball(Raster *raster, double x, double y, double z, double radius, PictureColour colour)
{
  const int left = clamp_sample(floor(x - radius), raster->width),
            right = clamp_sample(x + radius + 1.0, raster->width);
  const int top = clamp_sample(floor(y - radius), raster->height);
  const int bottom = clamp_sample(y + radius + 1.0, raster->height);
  for (int j = top; j < bottom; j++)
    for (int i = left; i < right; i++) {
      const double u = (i + 0.5 - x) / radius, v = (j + 0.5 - y) / radius, square = u * u + v * v;
      if (square > 1.0) continue;
      const double w = sqrt(1.0 - square); // towards the viewer; the light comes a little from the upper left
      const double light = 0.62 + 0.38 * fmax(0.0, 0.87 * w - 0.30 * u - 0.40 * v);
      put(raster, i, j, z + radius * w, pack(colour, light), RASTER_BALL);
    }
}

/* Lines where one of the caller's groups ends, and round the cut face; balls have none. */
static bool differs(int32_t a, int32_t b)
{
  return a != b && a != RASTER_BALL && b != RASTER_BALL;
}

static void darken(uint32_t *colour, double strength)
{
  uint32_t dark = 0;
  for (int shift = 0; shift <= 16; shift += 8) {
    const double part = (double)(*colour >> shift & 0xff) * (1.0 - strength);
    dark |= (uint32_t)(part + 0.5) << shift;
  }
  *colour = dark;
}

void raster_outline(Raster *raster, double strength, int width)
{
  for (int y = 0; y < raster->height; y++)
    for (int x = 0; x < raster->width; x++) {
      const size_t i = (size_t)y * (size_t)raster->width + (size_t)x;
      bool line = false;
      for (int step = 1; step <= width && !line; step++)
        line = (x + step < raster->width && differs(raster->group[i], raster->group[i + (size_t)step])) ||
               (y + step < raster->height &&
                differs(raster->group[i], raster->group[i + (size_t)step * (size_t)raster->width]));
      if (line) darken(&raster->colour[i], strength);
    }
}

static uint32_t average(const Raster *raster, int x, int y)
{
  uint32_t sum[3] = {0, 0, 0};
  for (int j = 0; j < RASTER_SAMPLES; j++)
    for (int i = 0; i < RASTER_SAMPLES; i++) {
      const size_t row = (size_t)(y * RASTER_SAMPLES + j) * (size_t)raster->width;
      const uint32_t colour = raster->colour[row + (size_t)(x * RASTER_SAMPLES + i)];
      for (int k = 0; k < 3; k++) sum[k] += colour >> (8 * k) & 0xff;
    }
  enum { N = RASTER_SAMPLES * RASTER_SAMPLES };
  uint32_t mean = 0;
  for (int k = 0; k < 3; k++) mean |= ((sum[k] + N / 2) / N) << (8 * k);
  return mean;
}

void raster_paint(const Raster *raster, Picture *picture, int left, int top)
{
  cairo_surface_flush(picture->surface);
  unsigned char *data = cairo_image_surface_get_data(picture->surface);
  const int stride = cairo_image_surface_get_stride(picture->surface);
  for (int y = 0; y < raster->height / RASTER_SAMPLES; y++) {
    if (top + y < 0 || top + y >= picture->height) continue;
    uint32_t *row = (uint32_t *)(void *)(data + (ptrdiff_t)(top + y) * stride);
    for (int x = 0; x < raster->width / RASTER_SAMPLES; x++)
      if (left + x >= 0 && left + x < picture->width) row[left + x] = average(raster, x, y);
  }
  cairo_surface_mark_dirty(picture->surface);
}
