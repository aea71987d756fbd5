#include "common/rom/rom_picture.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/picture/picture.h"

enum { MOST_SURFACES = 24 };

typedef struct Painted { // everything the views need
  PictureColour *colour; // [n_triangles]
  int32_t *cavity,
      *patch; // the cavity's triangles, turned over so that they enclose the casting; [n_cavity*3], [n_cavity]
  PictureColour *cavity_colour;
  size_t n_cavity;
  double low[3], high[3]; // m, of the cavity
  double mould_low[3], mould_high[3];
  size_t n_surfaces;
  const char *surface[MOST_SURFACES];
  size_t patches[MOST_SURFACES];
} Painted;

static size_t surface_number(const Painted *painted, const char *name)
{
  size_t s = 0;
  while (s < painted->n_surfaces && strcmp(painted->surface[s], name) != 0) s++;
  return s;
}

/* Shades of the surface's colour, neighbouring numbers far apart. */
static PictureColour patch_colour(size_t surface, size_t number)
{
  static const double shade[5] = {0.0, 0.42, 0.18, 0.58, 0.30};
  PictureColour colour = picture_category(surface);
  const double pale = shade[number % 5];
  colour.red += pale * (1.0 - colour.red);
  colour.green += pale * (1.0 - colour.green);
  colour.blue += pale * (1.0 - colour.blue);
  return colour;
}

static void colour_triangles(const RomData *rom, const PictureColour *patch_colours, Painted *painted)
{
  for (size_t t = 0; t < rom->n_triangles; t++) {
    const int32_t l = rom->triangle_patch[t], *corner = rom->triangles + 3 * t;
    painted->colour[t] = patch_colours[l];
    if (rom->patch[l].outer) continue;
    int32_t *turned = painted->cavity + 3 * painted->n_cavity;
    turned[0] = corner[0];
    turned[1] = corner[2];
    turned[2] = corner[1];
    painted->patch[painted->n_cavity] = l;
    painted->cavity_colour[painted->n_cavity++] = patch_colours[l];
  }
}

static void colour_patches(const RomData *rom, PictureColour *patch_colours, Painted *painted)
{
  static const PictureColour outer = {0.80, 0.78, 0.74};
  for (size_t l = 0; l < rom->m; l++) {
    patch_colours[l] = outer;
    if (rom->patch[l].outer) continue;
    const size_t s = surface_number(painted, rom->patch[l].surface);
    if (s == painted->n_surfaces && s < MOST_SURFACES) painted->surface[painted->n_surfaces++] = rom->patch[l].surface;
    if (s < MOST_SURFACES)
      patch_colours[l] = patch_colour(s, painted->patches[s]++);
    else
      patch_colours[l] = patch_colour(s, l);
  }
}

static void measure(const RomData *rom, Painted *painted)
{
  for (int d = 0; d < 3; d++) {
    painted->low[d] = painted->mould_low[d] = DBL_MAX;
    painted->high[d] = painted->mould_high[d] = -DBL_MAX;
  }
  for (size_t i = 0; i < 3 * rom->n_triangles; i++)
    for (size_t d = 0; d < 3; d++) {
      const double x = rom->points[3 * (size_t)rom->triangles[i] + d];
      painted->mould_low[d] = fmin(painted->mould_low[d], x);
      painted->mould_high[d] = fmax(painted->mould_high[d], x);
      if (rom->patch[rom->triangle_patch[i / 3]].outer) continue;
      painted->low[d] = fmin(painted->low[d], x);
      painted->high[d] = fmax(painted->high[d], x);
    }
}

static CastStatus draw_views(const RomData *rom, const Painted *painted, Picture *picture, CastError *err)
{
  const PictureSurface mould = {.n_points = rom->n_points,
                                .n_triangles = rom->n_triangles,
                                .points = rom->points,
                                .triangles = rom->triangles,
                                .colours = painted->colour,
                                .groups = rom->triangle_patch,
                                .clipped = true};
  const PictureSurface casting = {.n_points = rom->n_points,
                                  .n_triangles = painted->n_cavity,
                                  .points = rom->points,
                                  .triangles = painted->cavity,
                                  .colours = painted->cavity_colour,
                                  .groups = painted->patch,
                                  .two_sided = true};
  PictureScene cut = {.azimuth = -62.0,
                      .elevation = 24.0,
                      .cut = true,
                      .cut_normal = {0.0, -1.0, 0.0},
                      .n_surfaces = 1,
                      .surfaces = &mould,
                      .caption = "mould cut open across y"};
  // a hair off the middle, where symmetric meshes have their edges
  for (int d = 0; d < 3; d++)
    cut.cut_point[d] = 0.5 * (painted->low[d] + painted->high[d]) + 1e-4 * (painted->high[d] - painted->low[d]);
  CAST_CALL(picture_draw_scene(picture, 0, &cut, err));
  cut.azimuth = 28.0;
  cut.cut_normal[0] = 1.0;
  cut.cut_normal[1] = 0.0;
  cut.caption = "cut open across x";
  CAST_CALL(picture_draw_scene(picture, 1, &cut, err));
  const PictureScene below = {.azimuth = -62.0,
                              .elevation = -28.0,
                              .framed = true,
                              .low = {painted->low[0], painted->low[1], painted->low[2]},
                              .high = {painted->high[0], painted->high[1], painted->high[2]},
                              .n_surfaces = 1,
                              .surfaces = &casting,
                              .caption = "cavity from below"};
  return picture_draw_scene(picture, 2, &below, err);
}

static CastStatus draw_page(const RomData *rom, const Painted *painted, const char *path, CastError *err)
{
  PictureLegend legend[MOST_SURFACES + 1];
  char text[MOST_SURFACES][ROM_NAME_LENGTH + 32], title[256];
  for (size_t s = 0; s < painted->n_surfaces; s++) {
    snprintf(text[s], sizeof text[s], "%s, %zu patch%s", painted->surface[s], painted->patches[s],
             painted->patches[s] == 1 ? "" : "es");
    legend[s] = (PictureLegend){picture_category(s), text[s]};
  }
  legend[painted->n_surfaces] = (PictureLegend){{0.83, 0.82, 0.80}, "mould"};
  snprintf(title, sizeof title, "%.200s", rom->title && rom->title[0] ? rom->title : "mould");
  Picture *picture = NULL;
  CAST_CALL(picture_create(&(PicturePage){.width = 1500,
                                          .height = 560,
                                          .columns = 3,
                                          .title = title,
                                          .n_legend = painted->n_surfaces + 1,
                                          .legend = legend},
                           &picture, err));
  CastStatus status = draw_views(rom, painted, picture, err);
  if (status == CAST_OK) status = picture_save(picture, path, err);
  picture_destroy(&picture);
  return status;
}

CastStatus rom_picture(const RomData *rom, const char *path, CastError *err)
{
  CAST_CHECK(rom->n_triangles > 0, err, CAST_ERR_ARGUMENT, "the ROM has no geometry to show");
  Painted painted = {.colour = malloc(rom->n_triangles * sizeof(PictureColour)),
                     .cavity = malloc(3 * rom->n_triangles * sizeof(int32_t)),
                     .patch = malloc(rom->n_triangles * sizeof(int32_t)),
                     .cavity_colour = malloc(rom->n_triangles * sizeof(PictureColour))};
  PictureColour *patch_colours = malloc(rom->m * sizeof *patch_colours);
  CastStatus status = CAST_OK;
  if (painted.colour && painted.cavity && painted.patch && painted.cavity_colour && patch_colours) {
    colour_patches(rom, patch_colours, &painted);
    colour_triangles(rom, patch_colours, &painted);
    measure(rom, &painted);
    status = draw_page(rom, &painted, path, err);
  } else {
    status = cast_error_set(err, CAST_ERR_MEMORY, "no memory for a picture of %zu triangles", rom->n_triangles);
  }
  free(patch_colours);
  free(painted.colour);
  free(painted.cavity);
  free(painted.patch);
  free(painted.cavity_colour);
  return status;
}
