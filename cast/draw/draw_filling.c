/* draw_filling.c - filling.png, speed.png, pressure.png: frames of the filling. The melt's particles coloured by one of
 * their fields, in the mould cut through the middle: the far half of its surface, and the cut through the near-wall
 * band, with the melt's temperature in that of the mould, else grey. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cast/draw/draw_private.h"
#include "cast/io/vtk_series.h"
#include "common/picture/picture.h"

enum { MOST_FRAMES = 6, ACROSS = 3, PANEL = 500, BARS = 200, TITLE = 40 };
static const double ZERO_CELSIUS = 273.15; // K

typedef struct MeltField {
  const char *data; // in the results
  int components;   // of more than one the size is drawn
  double zero, unit;
  PictureMap colours;
  const char *label;
  double clipped; // this part of the values may lie beyond either end of the scale
} MeltField;

static const MeltField FIELDS[] = {
    [DRAW_TEMPERATURE] = {"PointData/temperature", 1, 273.15, 1.0, PICTURE_HEAT, "melt, degC", 0.0},
    [DRAW_SPEED] = {"PointData/velocity", 3, 0.0, 1.0, PICTURE_VIRIDIS, "speed, m/s", 0.002},
    [DRAW_PRESSURE] = {"PointData/pressure", 1, 0.0, 1e3, PICTURE_VIRIDIS, "pressure, kPa", 0.01},
};

typedef struct Range {
  double low, high;
} Range;

typedef struct Mould {
  bool there;
  hid_t file;
  size_t n_steps;
  VtkStep *step;
  size_t n_points, n_triangles, n_tetrahedra;
  double *point; // [n_points*3]
  int32_t *triangle, *tetrahedron;
  double *T; // [n_points] degC, of the frame in hand
} Mould;

typedef struct Filling {
  hid_t file;
  size_t n_steps;
  VtkStep *step;
  double spacing; // m
  char *title;
  Mould mould;
  double low[3], high[3]; // m, the box of mould and melt at the start
  const MeltField *field;
  Range melt, mould_T; // in the field's unit, degC
} Filling;

/* The melt of one step; y and z follow x in the same room. */
typedef struct Melt {
  size_t n;
  double *x[3], *value; // m, in the field's unit
} Melt;

/* ---- reading ---- */

static CastStatus read_cells(hid_t file, const char *name, int corners, size_t *n, int32_t **cells, CastError *err)
{
  if (!h5_exists(file, name)) return CAST_OK; // a mould without a band
  hsize_t shape[2] = {0, (hsize_t)corners};
  void *read = NULL;
  CAST_CALL(h5_read(file, name, H5T_NATIVE_INT32, 2, shape, &read, err));
  *n = shape[0];
  *cells = read;
  return CAST_OK;
}

static CastStatus check_cells(const Mould *m, CastError *err)
{
  for (size_t i = 0; i < 3 * m->n_triangles; i++)
    CAST_CHECK(m->triangle[i] >= 0 && (size_t)m->triangle[i] < m->n_points, err, CAST_ERR_FORMAT,
               "mould.vtkhdf: bad triangle");
  for (size_t i = 0; i < 4 * m->n_tetrahedra; i++)
    CAST_CHECK(m->tetrahedron[i] >= 0 && (size_t)m->tetrahedron[i] < m->n_points, err, CAST_ERR_FORMAT,
               "mould.vtkhdf: bad tetrahedron");
  return CAST_OK;
}

static CastStatus open_mould(const char *folder, Mould *m, CastError *err)
{
  char path[4200];
  snprintf(path, sizeof path, "%s/mould.vtkhdf", folder);
  m->there = access(path, F_OK) == 0;
  if (!m->there) return CAST_OK;
  hsize_t shape[2] = {0, 3};
  void *read = NULL;
  CAST_CALL(h5_file_open(path, &m->file, err));
  CAST_CALL(vtk_series_read_steps(m->file, &m->n_steps, &m->step, err));
  CAST_CALL(h5_read(m->file, "VTKHDF/Points", H5T_NATIVE_DOUBLE, 2, shape, &read, err));
  m->point = read;
  m->n_points = shape[0];
  CAST_CALL(read_cells(m->file, "castrun/triangles", 3, &m->n_triangles, &m->triangle, err));
  CAST_CALL(read_cells(m->file, "castrun/tetrahedra", 4, &m->n_tetrahedra, &m->tetrahedron, err));
  return check_cells(m, err);
}

static CastStatus open_files(const char *folder, Filling *f, CastError *err)
{
  char path[4200];
  void *read = NULL;
  snprintf(path, sizeof path, "%s/results.vtkhdf", folder);
  CAST_CALL(h5_file_open(path, &f->file, err));
  CAST_CALL(vtk_series_read_steps(f->file, &f->n_steps, &f->step, err));
  CAST_CHECK(f->n_steps > 0, err, CAST_ERR_FORMAT, "%s: holds no step yet", path);
  CAST_CALL(h5_read(f->file, "castrun/spacing", H5T_NATIVE_DOUBLE, 0, NULL, &read, err));
  f->spacing = *(double *)read;
  free(read);
  CAST_CALL(h5_read_text(f->file, "castrun/title", &f->title, err));
  return open_mould(folder, &f->mould, err);
}

static void close_files(Filling *f)
{
  Mould *m = &f->mould;
  h5_file_close(&f->file, NULL); // only read: nothing can be lost
  h5_file_close(&m->file, NULL);
  void *const all[] = {f->step, f->title, m->step, m->point, m->triangle, m->tetrahedron, m->T};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
}

/* The mould's temperatures at the step nearest in time. */
static CastStatus read_mould_step(Mould *m, double time, CastError *err)
{
  size_t nearest = 0;
  for (size_t s = 1; s < m->n_steps; s++)
    if (fabs(m->step[s].time - time) < fabs(m->step[nearest].time - time)) nearest = s;
  free(m->T);
  m->T = NULL;
  CAST_CHECK(m->n_steps > 0 && m->step[nearest].n_points == (long long)m->n_points, err, CAST_ERR_FORMAT,
             "mould.vtkhdf: holds no step that fits its mesh");
  float *T = NULL;
  CAST_CALL(vtk_series_read_rows(m->file, "PointData/temperature", m->step[nearest].first_value,
                                 m->step[nearest].n_points, 1, &T, err));
  m->T = malloc((m->n_points + 1) * sizeof *m->T);
  for (size_t i = 0; i < m->n_points && m->T; i++) m->T[i] = (double)T[i] - ZERO_CELSIUS;
  free(T);
  CAST_CHECK(m->T, err, CAST_ERR_MEMORY, "no memory for the mould's temperatures");
  return CAST_OK;
}

static void free_melt(Melt *melt)
{
  free(melt->x[0]);
  *melt = (Melt){0};
}

static double value_of(const MeltField *field, const float *value, size_t i)
{
  if (field->components == 1) return ((double)value[i] - field->zero) / field->unit;
  double sum = 0.0;
  for (int d = 0; d < field->components; d++) {
    const double one = (double)value[(size_t)field->components * i + (size_t)d];
    sum += one * one;
  }
  return sqrt(sum) / field->unit;
}

static CastStatus read_melt(const Filling *f, const VtkStep *step, Melt *melt, CastError *err)
{
  const MeltField *field = f->field;
  float *x = NULL, *value = NULL;
  CastStatus status = vtk_series_read_rows(f->file, "Points", step->first_point, step->n_points, 3, &x, err);
  if (status == CAST_OK)
    status =
        vtk_series_read_rows(f->file, field->data, step->first_value, step->n_points, field->components, &value, err);
  *melt = (Melt){.n = (size_t)step->n_points};
  double *room = status == CAST_OK ? malloc((4 * melt->n + 1) * sizeof *room) : NULL;
  if (status == CAST_OK && !room) status = cast_error_set(err, CAST_ERR_MEMORY, "no memory for %zu particles", melt->n);
  if (room) {
    for (size_t d = 0; d < 3; d++) melt->x[d] = room + d * melt->n;
    melt->value = room + 3 * melt->n;
    for (size_t i = 0; i < melt->n; i++) {
      for (size_t d = 0; d < 3; d++) melt->x[d][i] = (double)x[3 * i + d];
      melt->value[i] = value_of(field, value, i);
    }
  }
  free(x);
  free(value);
  return status;
}

/* ---- ranges and view ---- */

static void widen(Range *range, double value)
{
  range->low = fmin(range->low, value);
  range->high = fmax(range->high, value);
}

static size_t frame_of(const Filling *f, int k, int n_frames)
{
  return n_frames > 1 ? (size_t)llround((double)k * (double)(f->n_steps - 1) / (n_frames - 1)) : 0;
}

static int compare(const void *a, const void *b)
{
  const double u = *(const double *)a, w = *(const double *)b;
  return (u > w) - (u < w);
}

static CastStatus measure_frames(Filling *f, int n_frames, CastError *err)
{
  f->melt = f->mould_T = (Range){INFINITY, -INFINITY};
  for (int k = 0; k < n_frames; k++) {
    const VtkStep *step = &f->step[frame_of(f, k, n_frames)];
    Melt melt;
    CAST_CALL(read_melt(f, step, &melt, err));
    if (melt.n > 0) {
      qsort(melt.value, melt.n, sizeof *melt.value, compare);
      const size_t beyond = (size_t)(f->field->clipped * (double)melt.n);
      widen(&f->melt, melt.value[beyond]);
      widen(&f->melt, melt.value[melt.n - 1 - beyond]);
    }
    free_melt(&melt);
    if (!f->mould.there) continue;
    CAST_CALL(read_mould_step(&f->mould, step->time, err));
    for (size_t i = 0; i < f->mould.n_points; i++) widen(&f->mould_T, f->mould.T[i]);
  }
  return CAST_OK;
}

static CastStatus measure_box(Filling *f, CastError *err)
{
  Melt melt;
  CAST_CALL(read_melt(f, &f->step[0], &melt, err));
  for (size_t d = 0; d < 3; d++) {
    Range range = {INFINITY, -INFINITY};
    for (size_t i = 0; i < f->mould.n_points; i++) widen(&range, f->mould.point[3 * i + d]);
    for (size_t i = 0; i < melt.n; i++) widen(&range, melt.x[d][i]);
    f->low[d] = range.low;
    f->high[d] = range.high;
  }
  free_melt(&melt);
  return CAST_OK;
}

/* ---- the picture ---- */

typedef struct Page {
  Picture *picture;
  PictureScale melt, mould;
  int n_frames;
} Page;

/* Does the mould show its temperature? Beside the melt's flow it is grey. */
static bool is_thermal(const Filling *f)
{
  return f->field == &FIELDS[DRAW_TEMPERATURE];
}

static void set_scales(const Filling *f, Page *page)
{
  page->melt = (PictureScale){f->field->colours, f->melt.low, f->melt.high, f->field->label};
  page->mould = (PictureScale){PICTURE_VIRIDIS, f->mould_T.low, f->mould_T.high, "mould, degC"};
  PictureScale *const both[] = {&page->melt, &page->mould};
  for (int k = 0; k < 2; k++)
    if (!(both[k]->high > both[k]->low + 0.1)) both[k]->high = both[k]->low + 0.1; // uniform: a bar needs some width
}

static CastStatus draw_frame(Filling *f, int k, const Page *page, CastError *err)
{
  const VtkStep *step = &f->step[frame_of(f, k, page->n_frames)];
  const Mould *m = &f->mould;
  const bool thermal = is_thermal(f);
  Melt melt;
  CAST_CALL(read_melt(f, step, &melt, err));
  const CastStatus status = m->there ? read_mould_step(&f->mould, step->time, err) : CAST_OK;
  char caption[64];
  snprintf(caption, sizeof caption, "t = %.3g ms", 1e3 * step->time);
  const PictureSurface surface = {.n_points = m->n_points,
                                  .n_triangles = m->n_triangles,
                                  .points = m->point,
                                  .triangles = m->triangle,
                                  .point_values = thermal ? m->T : NULL,
                                  .scale = &page->mould,
                                  .colour = {0.8, 0.8, 0.78},
                                  .clipped = true};
  const PictureSection section = {m->n_tetrahedra, m->point, m->tetrahedron, m->T, &page->mould};
  const PictureCloud cloud = {.n = melt.n,
                              .x = {melt.x[0], melt.x[1], melt.x[2]},
                              .radius = 0.55 * f->spacing,
                              .values = melt.value,
                              .scale = &page->melt};
  PictureScene scene = {.azimuth = -78.0,
                        .elevation = 14.0,
                        .cut = true,
                        .cut_normal = {0.0, -1.0, 0.0},
                        .framed = true,
                        .n_surfaces = m->there ? 1 : 0,
                        .surfaces = &surface,
                        .n_clouds = melt.n > 0 ? 1 : 0,
                        .clouds = &cloud,
                        .section = thermal && m->n_tetrahedra > 0 ? &section : NULL,
                        .caption = caption,
                        .no_axes = true}; // axes would take room from one panel
  for (int d = 0; d < 3; d++) {
    scene.low[d] = f->low[d];
    scene.high[d] = f->high[d];
    scene.cut_point[d] = 0.5 * (f->low[d] + f->high[d]);
  }
  const CastStatus drawn = status == CAST_OK ? picture_draw_scene(page->picture, k, &scene, err) : status;
  free_melt(&melt);
  return drawn;
}

static CastStatus draw_all(Filling *f, const char *path, CastError *err)
{
  Page page = {.n_frames = f->n_steps < MOST_FRAMES ? (int)f->n_steps : MOST_FRAMES};
  const int across = page.n_frames < ACROSS ? page.n_frames : ACROSS, down = (page.n_frames + ACROSS - 1) / ACROSS;
  CAST_CALL(measure_frames(f, page.n_frames, err));
  CAST_CALL(measure_box(f, err));
  set_scales(f, &page);
  const PicturePage made = {.width = across * PANEL + BARS,
                            .height = down * PANEL + TITLE,
                            .columns = across,
                            .rows = down,
                            .title = f->title,
                            .scale = {&page.melt, f->mould.there && is_thermal(f) ? &page.mould : NULL}};
  CAST_CALL(picture_create(&made, &page.picture, err));
  CastStatus status = CAST_OK;
  for (int k = 0; k < page.n_frames && status == CAST_OK; k++) status = draw_frame(f, k, &page, err);
  if (status == CAST_OK) status = picture_save(page.picture, path, err);
  picture_destroy(&page.picture);
  return status;
}

CastStatus draw_filling(const char *folder, DrawField field, const char *picture_path, CastError *err)
{
  Filling filling = {.file = -1, .mould = {.file = -1}, .field = &FIELDS[field]};
  CastStatus status = open_files(folder, &filling, err);
  if (status == CAST_OK) status = draw_all(&filling, picture_path, err);
  close_files(&filling);
  return status;
}
