/* Moulds put together at random from boxes, turned at random: the search through the grid against looking at
 * everything. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <cmocka.h>

#include "cast/geometry/surface_internal.h"
#include "cast/geometry/walls.h"
#include "tests/support/assert_close.h"
#include "tests/support/random_numbers.h"
#include "tests/support/shaped_mould.h"
#include "tests/support/surface_of.h"

enum { BOXES = 5, MOULDS = 12 };

typedef struct RandomMould {
  ShapedBox box[BOXES];
  ShapedMould shape;
  Turn turn, back; // there, and back but for the shift
  RomData *rom;
  Surface *surface;
} RandomMould;

/* Two boxes cut out, one put back, two more cut out; none reaches the block's own faces. */
static void make_mould(uint64_t *seed, double reach, RandomMould *made)
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
  made->surface = surface_of(made->rom, reach);
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
  uint64_t seed = 21;
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
  uint64_t seed = 22;
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
  uint64_t seed = 23;
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
  uint64_t seed = 24;
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

typedef struct QuickAnswers {
  long asked, free;  // pairs that nothing separates: all, and those of which sight_is_free was sure
  long seen, met;    // wall particles that are seen: all, and those of which sight_meets_wall was sure
  long unfelt, open; // echoes that are not felt: all, and those of which sight_enters_nothing was sure
} QuickAnswers;

static void compare_walls(const RandomMould *made, const WallSet *walls, const double x[3], const Sight *sight,
                          double length, QuickAnswers *count)
{
  for (ptrdiff_t k = 0; k < walls->n; k++) {
    const double place[3] = {walls->x[0][k], walls->x[1][k], walls->x[2][k]};
    if (vec_distance2(place, x) >= length * length) continue;
    const double foot[3] = {walls->foot[0][k], walls->foot[1][k], walls->foot[2][k]},
                 normal[3] = {walls->normal[0][k], walls->normal[1][k], walls->normal[2][k]};
    const bool seen = walls_seen(made->surface, x, place, foot, normal, walls->echo[k]);
    if (walls->echo[k]) {
      const bool sure = sight_enters_nothing(sight, place);
      count->unfelt += !seen;
      count->open += sure;
      if (sure) assert_false(seen);
    } else {
      const bool sure = sight_meets_wall(sight, place, normal);
      count->seen += seen;
      count->met += sure;
      if (sure) assert_true(seen);
    }
  }
}

static void compare_void(const RandomMould *made, uint64_t *seed, const double a[3], const Sight *sight,
                         QuickAnswers *count)
{
  for (int i = 0; i < 200; i++) {
    double b[3], d[3];
    random_point(seed, (const double[3]){-0.45, -0.45, -0.45}, (const double[3]){0.45, 0.45, 0.45}, d);
    vec_axpy(1.0, d, a, b);
    if (surface_inside_mould(made->surface, b)) continue;
    const bool hidden = surface_separates(made->surface, a, b), sure = sight_is_free(sight, b);
    count->asked += !hidden;
    count->free += sure;
    if (sure) assert_false(hidden || surface_separates(made->surface, b, a));
  }
}

/* Where a quick answer is sure the slow one is the same, and most slow ones are saved. */
static void what_is_surely_in_sight_is_in_sight(void **state)
{
  (void)state;
  const double reach = 0.8, origin[3] = {0.0, 0.0, 0.0};
  uint64_t seed = 25;
  QuickAnswers count = {0};
  for (int m = 0; m < MOULDS; m++) {
    RandomMould made;
    WallSet walls;
    CastError err = {0};
    make_mould(&seed, reach, &made);
    if (walls_generate(made.surface, 0.2, 0.5, origin, &walls, &err) != CAST_OK) fail_msg("%s", err.message);
    for (int i = 0; i < 2000; i++) {
      double a[3];
      random_point(&seed, (const double[3]){-3, -3, -3}, (const double[3]){3, 3, 3}, a);
      if (!surface_thin_near(made.surface, a) || surface_inside_mould(made.surface, a)) continue;
      Sight sight;
      sight_from(made.surface, a, reach, &sight);
      compare_void(&made, &seed, a, &sight, &count);
      if (i < 200) compare_walls(&made, &walls, a, &sight, 0.6, &count);
    }
    walls_destroy(&walls);
    release(&made);
  }
  print_message("surely free %ld of %ld, surely met %ld of %ld, surely not felt %ld of %ld\n", count.free, count.asked,
                count.met, count.seen, count.open, count.unfelt);
  assert_true(count.asked > 10000 && count.free > count.asked / 2);
  assert_true(count.seen > 2000 && count.met > count.seen / 2);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(inside_agrees_with_the_boxes_it_was_made_of),
      cmocka_unit_test(nearest_agrees_with_looking_at_every_triangle),
      cmocka_unit_test(rays_meet_the_surface_where_mould_and_void_change),
      cmocka_unit_test(hiding_is_mutual),
      cmocka_unit_test(what_is_surely_in_sight_is_in_sight),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
