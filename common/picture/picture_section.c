/* picture_section.c - where a plane cuts tetrahedra: a triangle or a quadrangle in each, with values between its
 * corners'. */
#include "common/picture/picture_view.h"

/* The point where the edge from a to b goes through the plane; `above` are the corners' distances from it. */
static RasterVertex cross_edge(const PictureSection *section, const PictureView *view, const int32_t *corner,
                               const double above[4], int a, int b)
{
  const double share = above[a] / (above[a] - above[b]);
  const size_t p = (size_t)corner[a], q = (size_t)corner[b];
  double x[3];
  for (size_t d = 0; d < 3; d++) x[d] = (1.0 - share) * section->points[3 * p + d] + share * section->points[3 * q + d];
  RasterVertex vertex = picture_project(view, x);
  vertex.z += 0.05; // samples: before the plain cut face, which lies in the same plane
  vertex.value = (1.0 - share) * section->point_values[p] + share * section->point_values[q];
  return vertex;
}

static void draw_cut(const PictureSection *section, const PictureView *view, const int32_t *corner,
                     const double above[4], Raster *raster)
{
  int low[4], high[4], n_low = 0, n_high = 0;
  for (int k = 0; k < 4; k++) {
    if (above[k] > 0.0)
      high[n_high++] = k;
    else
      low[n_low++] = k;
  }
  if (n_low == 0 || n_high == 0) return;
  const RasterPaint paint = {.scale = section->scale, .light = 1.0, .group = RASTER_CUT};
  if (n_low == 2) { // a quadrangle, its corners in turn
    const RasterVertex quad[4] = {cross_edge(section, view, corner, above, low[0], high[0]),
                                  cross_edge(section, view, corner, above, low[0], high[1]),
                                  cross_edge(section, view, corner, above, low[1], high[1]),
                                  cross_edge(section, view, corner, above, low[1], high[0])};
    raster_triangle(raster, (RasterVertex[3]){quad[0], quad[1], quad[2]}, &paint);
    raster_triangle(raster, (RasterVertex[3]){quad[0], quad[2], quad[3]}, &paint);
    return;
  }
  const int alone = n_low == 1 ? low[0] : high[0], *others = n_low == 1 ? high : low;
  RasterVertex triangle[3];
  for (int k = 0; k < 3; k++) triangle[k] = cross_edge(section, view, corner, above, alone, others[k]);
  raster_triangle(raster, triangle, &paint);
}

void picture_draw_section(const PictureScene *scene, const PictureView *view, Raster *raster)
{
  const PictureSection *section = scene->section;
  if (vec_dot(scene->cut_normal, view->near) <= 0.0) return; // the cut face looks away
  for (size_t t = 0; t < section->n_tetrahedra; t++) {
    const int32_t *corner = section->tetrahedra + 4 * t;
    double above[4];
    for (int k = 0; k < 4; k++) above[k] = picture_beyond_cut(scene, section->points + 3 * (size_t)corner[k]);
    draw_cut(section, view, corner, above, raster);
  }
}
