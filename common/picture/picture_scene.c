/* picture_scene.c - orthographic scenes: projection, the cut through solids, scale bar and axes.
 * A solid's surface shows its outside; where a cut takes the near part away and the first surface met is seen from
 * behind, the sight line lies within the solid at the cut, so the cut face is drawn there. */
#include "common/picture/picture_view.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

static void aim(const PictureScene *scene, PictureView *view)
{
  const double azimuth = scene->azimuth * M_PI / 180.0, elevation = scene->elevation * M_PI / 180.0;
  const double near[3] = {cos(elevation) * cos(azimuth), cos(elevation) * sin(azimuth), sin(elevation)};
  const double right[3] = {-sin(azimuth), cos(azimuth), 0.0};
  for (int d = 0; d < 3; d++) {
    view->near[d] = near[d];
    view->right[d] = right[d];
  }
  vec_cross(near, right, view->up);
}

typedef struct Frame { // m, along right and up
  double low[2], high[2];
} Frame;

static void include(const PictureView *view, const double x[3], double margin, Frame *frame)
{
  const double place[2] = {vec_dot(x, view->right), vec_dot(x, view->up)};
  for (int d = 0; d < 2; d++) {
    frame->low[d] = fmin(frame->low[d], place[d] - margin);
    frame->high[d] = fmax(frame->high[d], place[d] + margin);
  }
}

static Frame measure(const PictureScene *scene, const PictureView *view)
{
  Frame frame = {{DBL_MAX, DBL_MAX}, {-DBL_MAX, -DBL_MAX}};
  if (scene->framed) {
    for (int corner = 0; corner < 8; corner++) {
      const double x[3] = {corner & 1 ? scene->high[0] : scene->low[0], corner & 2 ? scene->high[1] : scene->low[1],
                           corner & 4 ? scene->high[2] : scene->low[2]};
      include(view, x, 0.0, &frame);
    }
    return frame;
  }
  for (size_t s = 0; s < scene->n_surfaces; s++)
    for (size_t p = 0; p < scene->surfaces[s].n_points; p++)
      include(view, scene->surfaces[s].points + 3 * p, 0.0, &frame);
  for (size_t c = 0; c < scene->n_clouds; c++) {
    const PictureCloud *cloud = &scene->clouds[c];
    for (size_t i = 0; i < cloud->n; i++)
      include(view, (double[3]){cloud->x[0][i], cloud->x[1][i], cloud->x[2][i]}, cloud->radius, &frame);
  }
  return frame;
}

double picture_beyond_cut(const PictureScene *scene, const double x[3])
{
  const double from[3] = {x[0] - scene->cut_point[0], x[1] - scene->cut_point[1], x[2] - scene->cut_point[2]};
  return vec_dot(from, scene->cut_normal);
}

static double beyond_cut(const PictureScene *scene, bool clipped, const double x[3])
{
  return scene->cut && clipped ? picture_beyond_cut(scene, x) : -1.0;
}

RasterVertex picture_project(const PictureView *view, const double x[3])
{
  return (RasterVertex){.x = view->half[0] + (vec_dot(x, view->right) - view->middle[0]) * view->scale,
                        .y = view->half[1] - (vec_dot(x, view->up) - view->middle[1]) * view->scale,
                        .z = vec_dot(x, view->near) * view->scale};
}

/* Cosine to a lamp a little to the upper left of the viewer, between `ambient` and 1. */
static double lighting(const PictureView *view, const double normal[3], double ambient)
{
  const double length = sqrt(vec_dot(normal, normal));
  const double toward =
      0.94 * vec_dot(normal, view->near) + 0.28 * vec_dot(normal, view->up) - 0.18 * vec_dot(normal, view->right);
  return ambient + (1.0 - ambient) * fmax(0.0, toward / length);
}

static void draw_triangle(const PictureScene *scene, const PictureSurface *surface, size_t t, const PictureView *view,
                          Raster *raster)
{
  static const PictureColour cut_grey = {0.83, 0.82, 0.80};
  const double *corner[3];
  RasterVertex vertex[3];
  for (size_t k = 0; k < 3; k++) {
    const size_t p = (size_t)surface->triangles[3 * t + k];
    corner[k] = surface->points + 3 * p;
    vertex[k] = picture_project(view, corner[k]);
    vertex[k].beyond = beyond_cut(scene, surface->clipped, corner[k]);
    if (surface->point_values) vertex[k].value = surface->point_values[p];
  }
  double u[3], v[3], normal[3];
  for (int d = 0; d < 3; d++) {
    u[d] = corner[1][d] - corner[0][d];
    v[d] = corner[2][d] - corner[0][d];
  }
  vec_cross(u, v, normal);
  const bool behind = vec_dot(normal, view->near) < 0.0;
  const PictureColour *inside = &surface->inside;
  const bool grey = inside->red + inside->green + inside->blue == 0.0;
  RasterPaint paint = {.colour = surface->colours ? surface->colours[t] : surface->colour,
                       .scale = surface->colours || !surface->point_values ? NULL : surface->scale,
                       .group = surface->groups ? surface->groups[t] : 0};
  if (behind && surface->two_sided)
    for (int d = 0; d < 3; d++) normal[d] = -normal[d];
  paint.light = lighting(view, normal, paint.scale ? 0.75 : 0.6);
  if (behind && !surface->two_sided) paint = (RasterPaint){grey ? cut_grey : *inside, NULL, 1.0, RASTER_CUT};
  raster_triangle(raster, vertex, &paint);
}

/* Put what was seen of the solids' insides where the cut face is, so that balls before and behind it are told apart. */
static void raise_cut(const PictureScene *scene, const PictureView *view, Raster *raster)
{
  const double slope = scene->cut ? vec_dot(scene->cut_normal, view->near) : 0.0;
  if (slope <= 0.0) return;
  const double level = vec_dot(scene->cut_normal, scene->cut_point);
  const double along = vec_dot(scene->cut_normal, view->right), upward = vec_dot(scene->cut_normal, view->up);
  for (int y = 0; y < raster->height; y++)
    for (int x = 0; x < raster->width; x++) {
      const size_t i = (size_t)y * (size_t)raster->width + (size_t)x;
      if (raster->group[i] != RASTER_CUT) continue;
      const double r = view->middle[0] + (x + 0.5 - view->half[0]) / view->scale;
      const double u = view->middle[1] - (y + 0.5 - view->half[1]) / view->scale;
      raster->depth[i] = (float)((level - along * r - upward * u) / slope * view->scale);
    }
}

static void draw_cloud(const PictureScene *scene, const PictureCloud *cloud, const PictureView *view, Raster *raster)
{
  for (size_t i = 0; i < cloud->n; i++) {
    const double x[3] = {cloud->x[0][i], cloud->x[1][i], cloud->x[2][i]};
    if (beyond_cut(scene, cloud->clipped, x) > 0.0) continue;
    const RasterVertex at = picture_project(view, x);
    const PictureColour colour = cloud->values ? picture_colour(cloud->scale, cloud->values[i]) : cloud->colour;
    raster_ball(raster, at.x, at.y, at.z, cloud->radius * view->scale, colour);
  }
}

static CastStatus check_surface(const PictureSurface *surface, CastError *err)
{
  for (size_t i = 0; i < 3 * surface->n_points; i++)
    CAST_CHECK(isfinite(surface->points[i]), err, CAST_ERR_ARGUMENT, "point %zu of a surface is not finite", i / 3);
  for (size_t i = 0; i < 3 * surface->n_triangles; i++)
    CAST_CHECK(surface->triangles[i] >= 0 && (size_t)surface->triangles[i] < surface->n_points, err, CAST_ERR_ARGUMENT,
               "triangle %zu of a surface names point %d of %zu", i / 3, (int)surface->triangles[i], surface->n_points);
  CAST_CHECK(!surface->point_values || surface->colours || surface->scale, err, CAST_ERR_ARGUMENT,
             "a surface has values but no scale");
  return CAST_OK;
}

static CastStatus check_scene(const PictureScene *scene, CastError *err)
{
  size_t things = 0;
  for (size_t s = 0; s < scene->n_surfaces; s++) {
    CAST_CALL(check_surface(&scene->surfaces[s], err));
    things += scene->surfaces[s].n_triangles;
  }
  for (size_t c = 0; c < scene->n_clouds; c++) {
    const PictureCloud *cloud = &scene->clouds[c];
    CAST_CHECK(!cloud->values || cloud->scale, err, CAST_ERR_ARGUMENT, "particles have values but no scale");
    for (size_t i = 0; i < cloud->n; i++)
      CAST_CHECK(isfinite(cloud->x[0][i]) && isfinite(cloud->x[1][i]) && isfinite(cloud->x[2][i]), err,
                 CAST_ERR_ARGUMENT, "the place of particle %zu is not finite", i);
    things += cloud->n;
  }
  CAST_CHECK(!scene->section || (scene->section->scale && scene->section->point_values), err, CAST_ERR_ARGUMENT,
             "a section has no values or no scale");
  CAST_CHECK(things > 0 || scene->framed, err, CAST_ERR_ARGUMENT, "a scene with nothing in it");
  return CAST_OK;
}

/* A bar of a round length, at the lower right of the box. */
static void draw_scale_bar(Picture *picture, PictureBox box, double pixels_per_m)
{
  cairo_t *cairo = picture->cairo;
  const double u = picture->unit, span = 0.22 * box.width / pixels_per_m;
  const double length = picture_nice_step(5.0 * span, 5);
  const double width = length * pixels_per_m, x = box.x + box.width - width - u, y = box.y + box.height - 0.5 * u;
  char label[32];
  if (length < 0.9999e-3)
    snprintf(label, sizeof label, "%g \xc2\xb5m", 1e6 * length);
  else
    snprintf(label, sizeof label, "%g mm", 1e3 * length);
  picture_rectangle(cairo, (PictureBox){x, y - 0.3 * u, width, 0.3 * u}, (PictureColour){0.1, 0.1, 0.1});
  picture_text(cairo, x + 0.5 * width, y - 0.7 * u, label, (PictureFont){0.9 * u, false, PICTURE_CENTRE, 0.1});
}

/* Where x, y and z point, at the lower left of the box. */
static void draw_axes(Picture *picture, PictureBox box, const PictureView *view)
{
  static const char *const names[3] = {"x", "y", "z"};
  cairo_t *cairo = picture->cairo;
  const double u = picture->unit, x = box.x + 2.6 * u, y = box.y + box.height - 1.7 * u;
  cairo_set_line_width(cairo, fmax(1.0, 0.11 * u));
  for (int d = 0; d < 3; d++) {
    const double dx = 1.3 * u * view->right[d], dy = -1.3 * u * view->up[d];
    if (hypot(dx, dy) < 0.3 * u) continue; // points at the viewer
    cairo_set_source_rgb(cairo, 0.35, 0.35, 0.35);
    cairo_move_to(cairo, x, y);
    cairo_line_to(cairo, x + dx, y + dy);
    cairo_stroke(cairo);
    const double stretch = 1.0 + 0.6 * u / hypot(dx, dy);
    picture_text(cairo, x + stretch * dx, y + stretch * dy + 0.3 * u, names[d],
                 (PictureFont){0.85 * u, false, PICTURE_CENTRE, 0.25});
  }
}

static void fit(const Frame *frame, PictureBox box, PictureView *view)
{
  const double width = fmax(frame->high[0] - frame->low[0], 1e-12),
               height = fmax(frame->high[1] - frame->low[1], 1e-12);
  view->scale = 0.96 * RASTER_SAMPLES * fmin(box.width / width, box.height / height);
  for (int d = 0; d < 2; d++) view->middle[d] = 0.5 * (frame->low[d] + frame->high[d]);
}

CastStatus picture_draw_scene(Picture *picture, int panel, const PictureScene *scene, CastError *err)
{
  PictureBox box;
  PictureView view = {.scale = 1.0};
  Raster raster = {0};
  CAST_CALL(picture_panel(picture, panel, &box, err));
  CAST_CALL(check_scene(scene, err));
  const double u = picture->unit, top = scene->caption ? 1.9 * u : 0.0;
  const double bottom = scene->no_axes ? (scene->no_scale_bar ? 0.0 : 2.2 * u) : 3.9 * u;
  const PictureBox inner = {floor(box.x), floor(box.y + top), floor(box.width), floor(box.height - top - bottom)};
  CAST_CHECK(inner.height >= 8.0 && inner.width >= 8.0, err, CAST_ERR_ARGUMENT, "the panels are too small for a scene");
  aim(scene, &view);
  const Frame frame = measure(scene, &view);
  fit(&frame, inner, &view);
  CAST_CALL(raster_create((int)inner.width, (int)inner.height, &raster, err));
  view.half[0] = 0.5 * raster.width;
  view.half[1] = 0.5 * raster.height;
  for (size_t s = 0; s < scene->n_surfaces; s++)
    for (size_t t = 0; t < scene->surfaces[s].n_triangles; t++)
      draw_triangle(scene, &scene->surfaces[s], t, &view, &raster);
  raise_cut(scene, &view, &raster);
  if (scene->cut && scene->section) picture_draw_section(scene, &view, &raster);
  raster_outline(&raster, 0.45, (int)fmax(1.0, round(0.1 * u)));
  for (size_t c = 0; c < scene->n_clouds; c++) draw_cloud(scene, &scene->clouds[c], &view, &raster);
  raster_paint(&raster, picture, (int)inner.x, (int)inner.y);
  raster_destroy(&raster);
  if (scene->caption)
    picture_text(picture->cairo, box.x + 0.5 * box.width, box.y + 1.1 * u, scene->caption,
                 (PictureFont){1.05 * u, false, PICTURE_CENTRE, 0.0});
  if (!scene->no_scale_bar) draw_scale_bar(picture, box, view.scale / RASTER_SAMPLES);
  if (!scene->no_axes) draw_axes(picture, box, &view);
  return CAST_OK;
}
