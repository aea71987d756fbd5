/* How long neighbour lists last: until particles may have come nearer to each other by the skin. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/support/assert_ok.h"
#include "tests/support/listed_cloud.h"
#include "tests/support/random_numbers.h"

static const double reach = CLOUD_REACH, skin = 0.02;

static void lists_last_until_particles_may_have_come_nearer_by_the_skin(void **unused)
{
  (void)unused;
  ListedCloud cloud = listed_cloud_create(5, skin);
  Particles *p = &cloud.p;
  assert_true(listed_cloud_update(&cloud));
  const PairList *list = neighbours_fluid_fluid(cloud.neighbours);
  const int32_t near = list->index[list->start[17]];
  p->x[1][17] += 0.49 * skin;
  p->x[1][near] -= 0.49 * skin;
  assert_false(listed_cloud_update(&cloud));
  p->x[1][17] += 0.03 * skin;
  assert_true(listed_cloud_update(&cloud));
  CastError err;
  bool rebuilt;
  ok(neighbours_update(cloud.neighbours, p, true, &rebuilt, &err), &err);
  assert_true(rebuilt);
  assert_int_equal(neighbours_builds(cloud.neighbours), 3);
  listed_cloud_check(&cloud);
  listed_cloud_destroy(&cloud);
}

/* Two halves fly apart, faster than the skin would allow if they were near each other. */
static void melt_far_apart_may_go_different_ways(void **unused)
{
  (void)unused;
  ListedCloud cloud = listed_cloud_create(5, skin);
  Particles *p = &cloud.p;
  for (int i = 0; i < CLOUD_FLUID; i++) p->x[0][i] += i % 2 ? 2.0 : 0.0;
  assert_true(listed_cloud_update(&cloud));
  for (int i = 0; i < CLOUD_FLUID; i++) p->x[0][i] += (p->x[0][i] > 1.5 ? 0.9 : -0.9) * skin;
  assert_false(listed_cloud_update(&cloud));
  listed_cloud_destroy(&cloud);
}

/* Melt that moves as one keeps its pairs, but not its walls. */
static void melt_that_moves_as_one_needs_new_lists_for_the_walls_alone(void **unused)
{
  (void)unused;
  ListedCloud cloud = listed_cloud_create(5, skin);
  Particles *p = &cloud.p;
  assert_true(listed_cloud_update(&cloud));
  const double wall_skin = neighbours_range(reach, skin) - reach;
  for (int i = 0; i < CLOUD_FLUID; i++) p->x[0][i] += 0.98 * wall_skin;
  assert_false(listed_cloud_update(&cloud));
  for (int i = 0; i < CLOUD_FLUID; i++) p->x[0][i] += 0.03 * wall_skin;
  assert_true(listed_cloud_update(&cloud));
  listed_cloud_destroy(&cloud);
}

/* Whatever way particles go until lists are made anew, no pair within reach is missing from them. */
static void no_pair_comes_within_reach_unlisted(void **unused)
{
  (void)unused;
  ListedCloud cloud = listed_cloud_create(6, skin);
  Particles *p = &cloud.p;
  assert_true(listed_cloud_update(&cloud));
  uint64_t seed = 31;
  int kept = 0;
  for (int step = 0; step < 40; step++) { // a flow that turns one way below and the other above, and noise
    for (int i = 0; i < CLOUD_FLUID; i++) {
      const double turn = 0.3 * skin * (p->x[2][i] < 0.5 ? 1.0 : -1.0);
      p->x[0][i] -= turn * (p->x[1][i] - 0.5);
      p->x[1][i] += turn * (p->x[0][i] - 0.5);
      for (int d = 0; d < 3; d++) p->x[d][i] += 0.04 * skin * (random_unit(&seed) - 0.5);
    }
    kept += !listed_cloud_update(&cloud);
    const double *period = neighbours_period(cloud.neighbours);
    const PairList *lists[2] = {neighbours_fluid_fluid(cloud.neighbours), neighbours_fluid_wall(cloud.neighbours)};
    long near = 0, listed = 0;
    for (ptrdiff_t i = 0; i < CLOUD_FLUID; i++)
      for (ptrdiff_t j = 0; j < p->n; j++) near += j != i && cloud_distance2(p, i, j, period) < reach * reach;
    for (int l = 0; l < 2; l++)
      for (ptrdiff_t i = 0; i < CLOUD_FLUID; i++)
        for (ptrdiff_t k = lists[l]->start[i]; k < lists[l]->start[i + 1]; k++)
          listed += cloud_distance2(p, i, lists[l]->index[k], period) < reach * reach;
    assert_int_equal(near, listed);
  }
  assert_true(kept > 10);
  listed_cloud_destroy(&cloud);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lists_last_until_particles_may_have_come_nearer_by_the_skin),
      cmocka_unit_test(melt_far_apart_may_go_different_ways),
      cmocka_unit_test(melt_that_moves_as_one_needs_new_lists_for_the_walls_alone),
      cmocka_unit_test(no_pair_comes_within_reach_unlisted),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
