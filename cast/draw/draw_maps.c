/* draw_maps.c - fill-time.png, solidification-time.png, niyama.png: maps on the cavity wall, which is the casting's
 * skin, seen from the front and from below, in the colours of mould.vtkhdf's cell data. Grey: the melt did not come, or
 * nothing is known. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cast/draw/draw_private.h"
#include "cast/results/wall_maps.h"
#include "common/picture/picture.h"

enum { PANEL = 620, BAR = 200, TITLE = 40 };

typedef struct Skin {
  size_t n_points, n; // triangles of the cavity wall
  double *point;      // [n_points*3] m
  int32_t *triangle;  // [n*3]
  int32_t *of_file;   // [n] numbers in the file
  char *title;
} Skin;

typedef struct Map {
  const char *name, *title, *file;
  double factor; // to the unit of the title
} Map;
static const Map MAPS[] = {
    {"fill_time", "melt came, ms", "fill-time.png", 1e3},
    {"solidus_time", "solid at, s", "solidification-time.png", 1.0},
    {"niyama", "Niyama, K^0.5 s^0.5/mm", "niyama.png", 1e-3},
};

/* ---- reading ---- */

/* Keep the triangles that belong to a named surface of the cavity. */
static CastStatus keep_cavity(Skin *skin, size_t n_all, const int32_t *all, const int32_t *surface, CastError *err)
{
  skin->triangle = malloc((3 * n_all + 1) * sizeof *skin->triangle);
  skin->of_file = malloc((n_all + 1) * sizeof *skin->of_file);
  CAST_CHECK(skin->triangle && skin->of_file, err, CAST_ERR_MEMORY, "no memory for %zu triangles", n_all);
  for (size_t t = 0; t < n_all; t++) {
    if (surface[t] < 0) continue;
    for (size_t k = 0; k < 3; k++) {
      const int32_t point = all[3 * t + k];
      CAST_CHECK(point >= 0 && (size_t)point < skin->n_points, err, CAST_ERR_FORMAT, "mould.vtkhdf: bad triangle");
      skin->triangle[3 * skin->n + k] = point;
    }
    skin->of_file[skin->n++] = (int32_t)t;
  }
  CAST_CHECK(skin->n > 0, err, CAST_ERR_FORMAT, "mould.vtkhdf: no triangle is of the cavity");
  return CAST_OK;
}

static CastStatus read_skin(hid_t file, Skin *skin, CastError *err)
{
  char name[128];
  hsize_t points[2] = {0, 3}, triangles[2] = {0, 3}, surfaces[1] = {0};
  void *read = NULL, *all = NULL, *surface = NULL;
  CAST_CALL(h5_read(file, "VTKHDF/Points", H5T_NATIVE_DOUBLE, 2, points, &read, err));
  skin->point = read;
  skin->n_points = points[0];
  CAST_CALL(h5_read(file, "castrun/triangles", H5T_NATIVE_INT32, 2, triangles, &all, err));
  snprintf(name, sizeof name, "VTKHDF/CellData/%s", wall_map_surface);
  surfaces[0] = triangles[0];
  CastStatus status = h5_read(file, name, H5T_NATIVE_INT32, 1, surfaces, &surface, err);
  if (status == CAST_OK) status = keep_cavity(skin, triangles[0], all, surface, err);
  free(all);
  free(surface);
  return status;
}

static CastStatus read_map(hid_t file, const Map *map, const Skin *skin, double **values, CastError *err)
{
  char name[128];
  hsize_t shape[1] = {0};
  void *read = NULL;
  snprintf(name, sizeof name, "VTKHDF/CellData/%s", map->name);
  *values = NULL;
  CAST_CALL(h5_read(file, name, H5T_NATIVE_FLOAT, 1, shape, &read, err));
  *values = malloc((skin->n + 1) * sizeof **values);
  bool fits = true;
  for (size_t i = 0; i < skin->n && *values; i++) {
    fits = fits && (hsize_t)skin->of_file[i] < shape[0];
    if (fits) (*values)[i] = map->factor * (double)((const float *)read)[skin->of_file[i]];
  }
  free(read);
  CAST_CHECK(*values, err, CAST_ERR_MEMORY, "no memory for a map");
  CAST_CHECK(fits, err, CAST_ERR_FORMAT, "mould.vtkhdf: %s does not fit its triangles", name);
  return CAST_OK;
}

/* ---- drawing ---- */

static int compare_doubles(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Ends of the scale: all but the outermost two per cent of what is known, which a few odd triangles would else decide.
 * False: nothing is known. */
static bool measure(const Skin *skin, const double *values, double *low, double *high)
{
  double *known = malloc((skin->n + 1) * sizeof *known);
  size_t n = 0;
  for (size_t i = 0; i < skin->n && known; i++)
    if (!isnan(values[i])) known[n++] = values[i];
  if (n > 0) {
    qsort(known, n, sizeof *known, compare_doubles);
    *low = known[(size_t)(0.02 * (double)(n - 1))];
    *high = known[(size_t)(0.98 * (double)(n - 1))];
    if (!(*high > *low)) *high = *low + fmax(1e-3 * fabs(*low), 1e-12);
  }
  free(known);
  return n > 0;
}

static CastStatus draw_views(Picture *picture, const Skin *skin, const PictureColour *colours, CastError *err)
{
  static const struct {
    double azimuth, elevation;
    const char *caption;
  } views[2] = {{-78.0, 14.0, "from the front"}, {-78.0, -38.0, "from below"}};
  const PictureSurface surface = {.n_points = skin->n_points,
                                  .n_triangles = skin->n,
                                  .points = skin->point,
                                  .triangles = skin->triangle,
                                  .colours = colours,
                                  .two_sided = true};
  for (int k = 0; k < 2; k++) {
    PictureScene scene = {.azimuth = views[k].azimuth,
                          .elevation = views[k].elevation,
                          .framed = true,
                          .low = {HUGE_VAL, HUGE_VAL, HUGE_VAL},
                          .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL},
                          .n_surfaces = 1,
                          .surfaces = &surface,
                          .caption = views[k].caption,
                          .no_axes = true};
    for (size_t i = 0; i < 3 * skin->n; i++)
      for (int d = 0; d < 3; d++) {
        const double x = skin->point[3 * skin->triangle[i] + d];
        scene.low[d] = fmin(scene.low[d], x);
        scene.high[d] = fmax(scene.high[d], x);
      }
    CAST_CALL(picture_draw_scene(picture, k, &scene, err));
  }
  return CAST_OK;
}

static CastStatus draw_map(const char *folder, const Skin *skin, const Map *map, const double *values, Log *log,
                           CastError *err)
{
  PictureScale scale = {PICTURE_VIRIDIS, 0.0, 1.0, map->title};
  if (!measure(skin, values, &scale.low, &scale.high)) return CAST_OK; // nothing froze: no picture of it
  PictureColour *colours = malloc((skin->n + 1) * sizeof *colours);
  CAST_CHECK(colours, err, CAST_ERR_MEMORY, "no memory for a map");
  for (size_t i = 0; i < skin->n; i++) colours[i] = picture_colour(&scale, values[i]);
  const PicturePage page = {.width = 2 * PANEL + BAR,
                            .height = PANEL + TITLE,
                            .columns = 2,
                            .rows = 1,
                            .title = skin->title,
                            .scale = {&scale, NULL}};
  Picture *picture = NULL;
  char path[4200];
  snprintf(path, sizeof path, "%.4000s/%s", folder, map->file);
  CastStatus status = picture_create(&page, &picture, err);
  if (status == CAST_OK) status = draw_views(picture, skin, colours, err);
  if (status == CAST_OK) status = picture_save(picture, path, err);
  if (status == CAST_OK) log_info(log, "drawn: %s", path);
  picture_destroy(&picture);
  free(colours);
  return status;
}

static CastStatus read_title(const char *folder, char **title, CastError *err)
{
  char path[4200];
  hid_t file = -1;
  snprintf(path, sizeof path, "%.4000s/results.vtkhdf", folder);
  CAST_CALL(h5_file_open(path, &file, err));
  const CastStatus status = h5_read_text(file, "castrun/title", title, err);
  h5_file_close(&file, NULL); // only read: nothing can be lost
  return status;
}

static CastStatus draw_all(const char *folder, hid_t file, Skin *skin, Log *log, CastError *err)
{
  CAST_CALL(read_title(folder, &skin->title, err));
  CAST_CALL(read_skin(file, skin, err));
  for (size_t k = 0; k < sizeof MAPS / sizeof *MAPS; k++) {
    double *values = NULL;
    CastStatus status = read_map(file, &MAPS[k], skin, &values, err);
    if (status == CAST_OK) status = draw_map(folder, skin, &MAPS[k], values, log, err);
    free(values);
    CAST_CALL(status);
  }
  return CAST_OK;
}

CastStatus draw_maps(const char *folder, Log *log, CastError *err)
{
  char path[4200], name[128];
  snprintf(path, sizeof path, "%.4000s/mould.vtkhdf", folder);
  if (access(path, F_OK) != 0) return CAST_OK; // output.mould_fields: false
  hid_t file = -1;
  Skin skin = {0};
  CAST_CALL(h5_file_open(path, &file, err));
  snprintf(name, sizeof name, "VTKHDF/CellData/%s", wall_map_surface);
  const CastStatus status = h5_exists(file, name) ? draw_all(folder, file, &skin, log, err) : CAST_OK; // else not over
  h5_file_close(&file, NULL);
  free(skin.point);
  free(skin.triangle);
  free(skin.of_file);
  free(skin.title);
  return status;
}
