/* Moulds put together at random from boxes, turned at random: the search through the grid against looking at
 * everything. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <cmocka.h>

#include "cast/geometry/surface_internal.h"
#include "tests/support/assert_close.h"
#include "tests/support/shaped_mould.h"

enum { BOXES = 5, MOULDS = 12 };

typedef struct RandomMould {
  ShapedBox box[BOXES];
  ShapedMould shape;
  Turn turn, back; // there, and back but for the shift
  RomData *rom;
  Surface *surface;
} RandomMould;

/* Two boxes cut out, one put back, two more cut out; none reaches the block's own faces. */
static void make_mould(unsigned long long *seed, double reach, RandomMould *made)
{
  for (int b = 0; b < BOXES; b++) {
    made->box[b].solid = b % 3 == 2;
    for (int k = 0; k < 3; k++) {
      const double first = -2.0 + 3.0 * random_unit(seed), size = 0.5 + 1.5 * random_unit(seed);
      made->box[b].low[k] = first;
      made->box[b].high[k] = fmin(first + size, 2.5);
    }
  }
  made->turn = (Turn){.angle = 6.0 * random_unit(seed)};
  random_point(seed, (const double[3]){-1, -1, -1}, (const double[3]){1, 1, 1}, made->turn.axis);
  random_point(seed, (const double[3]){-1, -1, -1}, (const double[3]){1, 1, 1}, made->turn.shift);
  vec_normalise(made->turn.axis);
  made->back = made->turn;
  made->back.angle = -made->turn.angle;
  for (int k = 0; k < 3; k++) made->back.shift[k] = 0.0;
  made->shape = (ShapedMould){{-3, -3, -3}, {3, 3, 3}, BOXES, made->box, 0.7, bend_turn, &made->turn};
  made->rom = shaped_mould_create(&made->shape);
  CastError err = {0};
  if (surface_create(made->rom, reach, &made->surface, &err) != CAST_OK) fail_msg("%s", err.message);
}

static void release(RandomMould *made)
{
  surface_destroy(&made->surface);
  rom_destroy(&made->rom);
}

/* Is x mould by what the boxes say? `margin`: its distance to the nearest face of any box or of the block. */
static bool in_boxes(const RandomMould *made, const double x[3], double *margin)
{
  double y[3];
  for (int k = 0; k < 3; k++) y[k] = x[k] - made->turn.shift[k];
  bend_turn(&made->back, y);
  bool solid = true;
  *margin = INFINITY;
  for (int k = 0; k < 3; k++) {
    solid = solid && fabs(y[k]) < 3.0;
    *margin = fmin(*margin, fabs(fabs(y[k]) - 3.0));
  }
  if (!solid) return false;
  for (int b = 0; b < BOXES; b++) {
    bool within = true;
    for (int k = 0; k < 3; k++) {
      within = within && y[k] > made->box[b].low[k] && y[k] < made->box[b].high[k];
      *margin = fmin(*margin, fmin(fabs(y[k] - made->box[b].low[k]), fabs(y[k] - made->box[b].high[k])));
    }
    if (within) solid = made->box[b].solid;
  }
  return solid;
}

static void inside_agrees_with_the_boxes_it_was_made_of(void **state)
{
  (void)state;
  unsigned long long seed = 21;
  for (int m = 0; m < MOULDS; m++) {
    RandomMould made;
    make_mould(&seed, 0.1 + 0.5 * random_unit(&seed), &made);
    for (int i = 0; i < 4000; i++) {
      double x[3], margin;
      random_point(&seed, (const double[3]){-6, -6, -6}, (const double[3]){6, 6, 6}, x);
      const bool solid = in_boxes(&made, x, &margin);
      if (margin < 1e-9) continue;
      if (surface_inside_mould(made.surface, x) != solid)
        fail_msg("mould %d: (%g, %g, %g) is taken for %s", m, x[0], x[1], x[2], solid ? "void" : "mould");
    }
    release(&made);
  }
}

static void nearest_agrees_with_looking_at_every_triangle(void **state)
{
  (void)state;
  unsigned long long seed = 22;
  for (int m = 0; m < MOULDS; m++) {
    RandomMould made;
    make_mould(&seed, 0.6, &made);
    const Surface *s = made.surface;
    for (int i = 0; i < 300; i++) {
      double x[3], best = INFINITY, foot[3], margin;
      SurfaceHit hit, again;
      random_point(&seed, (const double[3]){-5, -5, -5}, (const double[3]){5, 5, 5}, x);
      for (int32_t t = 0; t < s->n_triangles; t++) best = fmin(best, surface_triangle_distance(s, t, x, foot));
      assert_int_equal(surface_nearest(s, x, 0.6, &hit), best <= 0.6);
      NearestQuery query = {.reach = INFINITY, .guess = -1};
      assert_true(surface_nearest_query(s, x, &query, &hit));
      assert_close(fabs(hit.distance), best, 0.0);
      assert_int_equal(hit.distance < 0.0, in_boxes(&made, x, &margin));
      query.guess = (int32_t)(random_unit(&seed) * (double)s->n_triangles); // a guess changes nothing
      assert_true(surface_nearest_query(s, x, &query, &again));
      assert_memory_equal(&hit, &again, sizeof hit);
    }
    release(&made);
  }
}

/* A ray passes the surface as often as mould and void take turns along it. */
static void rays_meet_the_surface_where_mould_and_void_change(void **state)
{
  (void)state;
  unsigned long long seed = 23;
  for (int m = 0; m < MOULDS; m++) {
    RandomMould made;
    make_mould(&seed, 0.6, &made);
    for (int i = 0; i < 200; i++) {
      double x[3], d[3], margin, distance;
      int32_t triangle;
      random_point(&seed, (const double[3]){-5, -5, -5}, (const double[3]){5, 5, 5}, x);
      random_point(&seed, (const double[3]){-1, -1, -1}, (const double[3]){1, 1, 1}, d);
      vec_normalise(d);
      bool solid = in_boxes(&made, x, &margin);
      while (surface_first_crossing(made.surface, x, d, 20.0, &distance, &triangle)) {
        assert_int_equal(vec_dot(made.surface->facet[triangle].normal, d) > 0.0, solid);
        double middle[3];
        vec_axpy(0.5 * distance, d, x, middle);
        const bool expected = in_boxes(&made, middle, &margin);
        if (margin > 1e-6) assert_int_equal(solid, expected);
        vec_axpy(distance + 1e-10, d, x, x);
        solid = !solid;
      }
      assert_false(solid); // it ends in the open
    }
    release(&made);
  }
}

static void hiding_is_mutual(void **state)
{
  (void)state;
  unsigned long long seed = 24;
  int hidden = 0;
  for (int m = 0; m < MOULDS; m++) {
    RandomMould made;
    make_mould(&seed, 0.8, &made);
    for (int i = 0; i < 20000; i++) {
      double a[3], b[3], d[3];
      random_point(&seed, (const double[3]){-3, -3, -3}, (const double[3]){3, 3, 3}, a);
      random_point(&seed, (const double[3]){-0.45, -0.45, -0.45}, (const double[3]){0.45, 0.45, 0.45}, d);
      vec_axpy(1.0, d, a, b);
      if (surface_inside_mould(made.surface, a) || surface_inside_mould(made.surface, b)) continue;
      const bool forth = surface_separates(made.surface, a, b), back = surface_separates(made.surface, b, a);
      assert_int_equal(forth, back);
      hidden += forth;
      if (forth) assert_true(surface_thin_near(made.surface, a) && surface_thin_near(made.surface, b));
    }
    release(&made);
  }
  assert_true(hidden > 20);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(inside_agrees_with_the_boxes_it_was_made_of),
      cmocka_unit_test(nearest_agrees_with_looking_at_every_triangle),
      cmocka_unit_test(rays_meet_the_surface_where_mould_and_void_change),
      cmocka_unit_test(hiding_is_mutual),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
