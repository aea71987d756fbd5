/* Pictures: their size, their colours where these are known, and what hides what. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cairo.h>
#include <cmocka.h>

#include "common/picture/picture.h"
#include "common/rom/rom_picture.h"
#include "tests/support/assert_ok.h"
#include "tests/support/synthetic_rom.h"

/* fontconfig keeps what it found. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
  return "leak:libfontconfig";
}

typedef struct Image {
  int width, height, stride;
  unsigned char *data;
  cairo_surface_t *surface;
} Image;

static Image load(const char *path)
{
  Image image = {.surface = cairo_image_surface_create_from_png(path)};
  assert_int_equal(cairo_surface_status(image.surface), CAIRO_STATUS_SUCCESS);
  image.width = cairo_image_surface_get_width(image.surface);
  image.height = cairo_image_surface_get_height(image.surface);
  image.stride = cairo_image_surface_get_stride(image.surface);
  image.data = cairo_image_surface_get_data(image.surface);
  return image;
}

static uint32_t pixel(const Image *image, int x, int y)
{
  uint32_t colour = 0;
  memcpy(&colour, image->data + (ptrdiff_t)y * image->stride + (ptrdiff_t)x * 4, sizeof colour);
  return colour & 0xffffff;
}

static int part(uint32_t colour, int shift)
{
  return (int)(colour >> shift & 0xff);
}

static bool is_reddish(uint32_t c)
{
  return part(c, 16) > 100 && part(c, 8) < 40 && part(c, 0) < 40;
}

static bool is_bluish(uint32_t c)
{
  return part(c, 0) > 100 && part(c, 8) < 40 && part(c, 16) < 40;
}

static const PictureColour RED = {1, 0, 0}, BLUE = {0, 0, 1};

/* Draw the scene alone on a page of 200 x 200 and read it back. */
static Image draw(const PictureScene *scene)
{
  CastError err = {0};
  Picture *picture = NULL;
  char path[] = "/tmp/picture_XXXXXX";
  const int descriptor = mkstemp(path);
  assert_true(descriptor >= 0);
  close(descriptor);
  ok(picture_create(&(PicturePage){.width = 200, .height = 200}, &picture, &err), &err);
  ok(picture_draw_scene(picture, 0, scene, &err), &err);
  ok(picture_save(picture, path, &err), &err);
  picture_destroy(&picture);
  assert_null(picture);
  const Image image = load(path);
  unlink(path);
  return image;
}

static const double zero[2] = {0, 0};

static void nearer_ball_hides_the_farther_from_either_side(void **state)
{
  (void)state;
  const double at[1] = {0.0}, front[1] = {-1.0}, back[1] = {1.0};
  const PictureCloud clouds[2] = {{.n = 1, .x = {at, front, at}, .radius = 0.5, .colour = RED},
                                  {.n = 1, .x = {at, back, at}, .radius = 0.5, .colour = BLUE}};
  PictureScene scene = {.azimuth = -90.0, .n_clouds = 2, .clouds = clouds, .no_axes = true, .no_scale_bar = true};
  Image image = draw(&scene); // from -y: red is nearer
  assert_int_equal(image.width, 200);
  assert_int_equal(image.height, 200);
  assert_true(is_reddish(pixel(&image, 100, 100)));
  assert_int_equal(pixel(&image, 8, 8), 0xffffff);
  cairo_surface_destroy(image.surface);
  scene.azimuth = 90.0; // from +y: blue is nearer
  image = draw(&scene);
  assert_true(is_bluish(pixel(&image, 100, 100)));
  cairo_surface_destroy(image.surface);
}

static void axes_of_the_page_follow_the_view(void **state)
{
  (void)state;
  const double left[1] = {-1.0}, right[1] = {1.0};
  const PictureCloud along_x[2] = {{.n = 1, .x = {left, zero, zero}, .radius = 0.5, .colour = RED},
                                   {.n = 1, .x = {right, zero, zero}, .radius = 0.5, .colour = BLUE}};
  PictureScene scene = {.azimuth = -90.0, .n_clouds = 2, .clouds = along_x, .no_axes = true, .no_scale_bar = true};
  Image image = draw(&scene); // from -y, x runs to the right
  assert_true(is_reddish(pixel(&image, 40, 100)));
  assert_true(is_bluish(pixel(&image, 160, 100)));
  cairo_surface_destroy(image.surface);
  const PictureCloud along_z[2] = {{.n = 1, .x = {zero, zero, left}, .radius = 0.5, .colour = RED},
                                   {.n = 1, .x = {zero, zero, right}, .radius = 0.5, .colour = BLUE}};
  scene.clouds = along_z;
  image = draw(&scene); // z runs upwards
  assert_true(is_bluish(pixel(&image, 100, 40)));
  assert_true(is_reddish(pixel(&image, 100, 160)));
  cairo_surface_destroy(image.surface);
}

/* A cube -1..1 with its normals outwards. */
static const double cube[24] = {-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1, -1, -1, 1, 1, -1, 1, -1, 1, 1, 1, 1, 1};
static const int32_t cube_triangles[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                           2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};

static void solid_hides_a_ball_inside_until_it_is_cut(void **state)
{
  (void)state;
  const double high[1] = {0.5}, near[1] = {-0.4};
  const PictureSurface solid = {.n_points = 8,
                                .n_triangles = 12,
                                .points = cube,
                                .triangles = cube_triangles,
                                .colour = BLUE,
                                .clipped = true,
                                .inside = {0.2, 0.8, 0.2}};
  const PictureCloud clouds[2] = {{.n = 1, .x = {zero, zero, zero}, .radius = 0.3, .colour = RED},
                                  {.n = 1, .x = {high, near, high}, .radius = 0.2, .colour = RED}};
  PictureScene scene = {.azimuth = -90.0,
                        .n_surfaces = 1,
                        .surfaces = &solid,
                        .n_clouds = 2,
                        .clouds = clouds,
                        .no_axes = true,
                        .no_scale_bar = true,
                        .cut_normal = {0, -1, 0},
                        .cut_point = {0, 0.1, 0}};
  Image image = draw(&scene);
  assert_true(is_bluish(pixel(&image, 100, 100)));
  cairo_surface_destroy(image.surface);
  scene.cut = true; // everything nearer than y = 0.1 is gone: the cut face, and a ball half sunk in it
  image = draw(&scene);
  assert_true(is_reddish(pixel(&image, 100, 100)));
  assert_true(is_reddish(pixel(&image, 146, 54)));
  const uint32_t face = pixel(&image, 40, 160);
  assert_int_equal(face, 0x33cc33);
  cairo_surface_destroy(image.surface);
  scene.cut_point[1] = -0.7; // now the cut face lies before both balls
  image = draw(&scene);
  assert_int_equal(pixel(&image, 100, 100), 0x33cc33);
  assert_int_equal(pixel(&image, 146, 54), 0x33cc33);
  cairo_surface_destroy(image.surface);
}

static void section_shows_values_on_the_cut_face(void **state)
{
  (void)state;
  // one tetrahedron within the cube, its value x: on the plane y = 0 it covers -0.5 < x < 0.5
  const double points[12] = {-1, -1, -0.9, 1, -1, -0.9, 0, 1, -0.9, 0, -0.2, 0.9}, values[4] = {-1, 1, 0, 0};
  const int32_t corner[4] = {0, 1, 2, 3};
  const PictureScale scale = {.map = PICTURE_DIVERGE, .low = -0.5, .high = 0.5};
  const PictureSection section = {
      .n_tetrahedra = 1, .points = points, .tetrahedra = corner, .point_values = values, .scale = &scale};
  const PictureSurface solid = {.n_points = 8,
                                .n_triangles = 12,
                                .points = cube,
                                .triangles = cube_triangles,
                                .colour = RED,
                                .clipped = true,
                                .inside = {0.2, 0.8, 0.2}};
  const PictureScene scene = {.azimuth = -90.0,
                              .n_surfaces = 1,
                              .surfaces = &solid,
                              .section = &section,
                              .cut = true,
                              .cut_normal = {0, -1, 0},
                              .no_axes = true,
                              .no_scale_bar = true};
  const Image image = draw(&scene);
  const int bottom = 182;    // pixels, just above the tetrahedron's base
  const double metre = 94.0; // pixels: the cube fills 0.96 of the panel, 197 wide about 100
  const uint32_t left = pixel(&image, 100 - 38, bottom), right = pixel(&image, 100 + 38, bottom);
  const PictureColour low = picture_colour(&scale, -37.5 / metre), high = picture_colour(&scale, 38.5 / metre);
  assert_true(abs(part(left, 0) - (int)(255.0 * low.blue)) < 8);
  assert_true(abs(part(right, 16) - (int)(255.0 * high.red)) < 8);
  assert_int_equal(pixel(&image, 100 - 70, bottom), 0x33cc33);
  cairo_surface_destroy(image.surface);
}

static void values_take_the_colours_of_their_scale(void **state)
{
  (void)state;
  const PictureScale scale = {.map = PICTURE_VIRIDIS, .low = 10.0, .high = 20.0};
  const double expected[3][3] = {{68, 1, 84}, {33, 144, 141}, {253, 231, 37}}, values[3] = {10.0, 15.0, 20.0};
  for (int i = 0; i < 3; i++) {
    const PictureColour colour = picture_colour(&scale, values[i]);
    assert_true(fabs(255.0 * colour.red - expected[i][0]) < 0.5);
    assert_true(fabs(255.0 * colour.green - expected[i][1]) < 0.5);
    assert_true(fabs(255.0 * colour.blue - expected[i][2]) < 0.5);
  }
  const PictureColour above = picture_colour(&scale, INFINITY), below = picture_colour(&scale, -1e9);
  assert_true(above.red > 0.98 && below.blue > 0.3 && below.green < 0.01);
  const PictureColour unknown = picture_colour(&scale, NAN);
  assert_true(unknown.red == unknown.green && unknown.green == unknown.blue);
}

/* The lightness of the two maps for fields rises all the way: they can be read in grey. */
static void lightness_of_maps_rises_evenly(void **state)
{
  (void)state;
  for (int map = PICTURE_HEAT; map <= PICTURE_VIRIDIS; map++) {
    double before = -1.0;
    for (int i = 0; i <= 100; i++) {
      const PictureColour c = picture_colour(&(PictureScale){.map = (PictureMap)map, .low = 0, .high = 100}, i);
      const double luma = 0.2126 * pow(c.red, 2.2) + 0.7152 * pow(c.green, 2.2) + 0.0722 * pow(c.blue, 2.2);
      assert_true(luma > before);
      before = luma;
    }
  }
}

static int count_pixels(const Image *image, bool (*is)(uint32_t), int top, int bottom)
{
  int count = 0;
  for (int y = top; y < bottom; y++)
    for (int x = 0; x < image->width; x++) count += is(pixel(image, x, y));
  return count;
}

static bool is_first_category(uint32_t c)
{
  return abs(part(c, 16) - 0) < 8 && abs(part(c, 8) - 114) < 8 && abs(part(c, 0) - 178) < 8;
}

static void curve_passes_where_its_values_say(void **state)
{
  (void)state;
  CastError err = {0};
  Picture *picture = NULL;
  char path[] = "/tmp/picture_XXXXXX";
  close(mkstemp(path));
  const double x[2] = {1.0, 100.0}, y[2] = {0.25, 0.25}; // a level line in the lower part
  const PictureCurve curve = {.n = 2, .x = x, .y = y, .width = 6.0};
  const PicturePlot plot = {
      .log_x = true, .y_limits = true, .y_low = 0.0, .y_high = 1.0, .n_curves = 1, .curves = &curve};
  ok(picture_create(&(PicturePage){.width = 400, .height = 300}, &picture, &err), &err);
  ok(picture_draw_plot(picture, 0, &plot, &err), &err);
  ok(picture_save(picture, path, &err), &err);
  picture_destroy(&picture);
  Image image = load(path);
  unlink(path);
  assert_int_equal(count_pixels(&image, is_first_category, 0, 150), 0);
  assert_in_range(count_pixels(&image, is_first_category, 180, 270), 300, 1500);
  cairo_surface_destroy(image.surface);
}

static void what_cannot_be_shown_is_refused(void **state)
{
  (void)state;
  CastError err = {0};
  Picture *picture = NULL;
  assert_int_equal(picture_create(&(PicturePage){.width = 10, .height = 100}, &picture, &err), CAST_ERR_ARGUMENT);
  const PictureScale flat = {.low = 1.0, .high = 1.0};
  const PicturePage flat_page = {.width = 100, .height = 100, .scale = {&flat}};
  assert_int_equal(picture_create(&flat_page, &picture, &err), CAST_ERR_ARGUMENT);
  ok(picture_create(&(PicturePage){.width = 200, .height = 200}, &picture, &err), &err);
  assert_int_equal(picture_draw_scene(picture, 0, &(PictureScene){0}, &err), CAST_ERR_ARGUMENT);
  assert_int_equal(picture_draw_scene(picture, 1, &(PictureScene){0}, &err), CAST_ERR_ARGUMENT);
  const double bad[1] = {NAN}, x[1] = {1.0};
  const PictureCloud cloud = {.n = 1, .x = {bad, x, x}, .radius = 1.0};
  assert_int_equal(picture_draw_scene(picture, 0, &(PictureScene){.n_clouds = 1, .clouds = &cloud}, &err),
                   CAST_ERR_ARGUMENT);
  const PictureCurve curve = {.n = 1, .x = x, .y = bad};
  assert_int_equal(picture_draw_plot(picture, 0, &(PicturePlot){.n_curves = 1, .curves = &curve}, &err),
                   CAST_ERR_ARGUMENT);
  assert_int_equal(picture_save(picture, "/nonexistent/a.png", &err), CAST_ERR_IO);
  assert_non_null(strstr(err.message, "/nonexistent/a.png"));
  picture_destroy(&picture);
}

static void page_with_everything_on_it_holds_together(void **state)
{
  (void)state;
  CastError err = {0};
  Picture *picture = NULL;
  char path[] = "/tmp/picture_XXXXXX";
  close(mkstemp(path));
  const PictureScale melt = {PICTURE_HEAT, 1000.0, 1150.0, "melt, degC"}, mould = {PICTURE_WARM, -5e-7, 5e-7, "K"};
  const PictureLegend legend[2] = {{RED, "pins"}, {BLUE, "plate"}};
  const PicturePage page = {.width = 600,
                            .height = 400,
                            .columns = 2,
                            .rows = 2,
                            .title = "-3.5 all of it",
                            .scale = {&melt, &mould},
                            .n_legend = 2,
                            .legend = legend};
  const double x[3] = {1e-9, 2e-9, 5e-9}, y[3] = {-2e7, NAN, 3e7};
  const PictureCurve curves[3] = {{.n = 3, .x = x, .y = y, .label = "dots", .markers = true, .line = PICTURE_NO_LINE},
                                  {.n = 3, .x = x, .y = x, .label = "dashes", .line = PICTURE_DASHED},
                                  {.n = 1, .x = x, .y = x, .line = PICTURE_DOTTED}};
  const PicturePlot plot = {.title = "t", .x_label = "x", .y_label = "y", .n_curves = 3, .curves = curves};
  const double point_values[8] = {1000, 1020, 1040, 1060, 1080, 1100, 1120, 1140};
  const PictureSurface solid = {.n_points = 8,
                                .n_triangles = 12,
                                .points = cube,
                                .triangles = cube_triangles,
                                .point_values = point_values,
                                .scale = &melt};
  const PictureScene scene = {.azimuth = 30, .elevation = 90, .n_surfaces = 1, .surfaces = &solid, .caption = "above"};
  ok(picture_create(&page, &picture, &err), &err);
  ok(picture_draw_plot(picture, 0, &plot, &err), &err);
  ok(picture_draw_plot(picture, 3, &(PicturePlot){.log_x = true, .log_y = true, .n_curves = 1, .curves = curves}, &err),
     &err);
  ok(picture_draw_scene(picture, 1, &scene, &err), &err);
  ok(picture_save(picture, path, &err), &err);
  picture_destroy(&picture);
  const Image image = load(path);
  assert_int_equal(image.width, 600);
  assert_int_equal(image.height, 400);
  assert_true(count_pixels(&image, is_reddish, 0, 400) > 20); // the legend's swatch
  cairo_surface_destroy(image.surface);
  unlink(path);
}

static void rom_is_drawn_in_the_colours_of_its_surfaces(void **state)
{
  (void)state;
  const SyntheticBox box = {.outer = {20e-3, 18e-3, 16e-3},
                            .cavity = {8e-3, 8e-3, 8e-3},
                            .pin_width = 2e-3,
                            .pin_depth = 3e-3,
                            .cell = 1e-3,
                            .patch_size = 4e-3,
                            .kappa = 1.0,
                            .rho = 1800.0,
                            .c = 1100.0,
                            .nodes = 2};
  CastError err = {0};
  RomData *rom = NULL;
  char path[] = "/tmp/picture_XXXXXX";
  close(mkstemp(path));
  ok(synthetic_rom_box_cavity(&box, &rom, &err), &err);
  ok(rom_picture(rom, path, &err), &err);
  const Image image = load(path);
  assert_int_equal(image.width, 1500);
  int blue = 0, orange = 0, grey = 0;
  for (int y = 0; y < image.height; y++)
    for (int x = 0; x < 1200; x++) { // the views, without the legend
      const uint32_t c = pixel(&image, x, y);
      blue += part(c, 0) > part(c, 16) + 40;
      orange += part(c, 16) > part(c, 0) + 60;
      grey += abs(part(c, 16) - 212) < 3 && abs(part(c, 0) - 204) < 3;
    }
  assert_true(blue > 20000 && orange > 2000 && grey > 40000); // cavity, pin, cut faces
  cairo_surface_destroy(image.surface);
  rom->n_points = rom->n_triangles = rom->n_tetrahedra = 0;
  assert_int_equal(rom_picture(rom, path, &err), CAST_ERR_ARGUMENT);
  unlink(path);
  rom_destroy(&rom);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(nearer_ball_hides_the_farther_from_either_side),
      cmocka_unit_test(axes_of_the_page_follow_the_view),
      cmocka_unit_test(solid_hides_a_ball_inside_until_it_is_cut),
      cmocka_unit_test(section_shows_values_on_the_cut_face),
      cmocka_unit_test(values_take_the_colours_of_their_scale),
      cmocka_unit_test(lightness_of_maps_rises_evenly),
      cmocka_unit_test(curve_passes_where_its_values_say),
      cmocka_unit_test(what_cannot_be_shown_is_refused),
      cmocka_unit_test(page_with_everything_on_it_holds_together),
      cmocka_unit_test(rom_is_drawn_in_the_colours_of_its_surfaces),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
