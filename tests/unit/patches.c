/* Cutting surfaces into patches: equal areas, compact, connected, not round edges; and the tree of triangles. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "common/vector.h"
#include "reduce/mesh/patches/partition.h"
#include "reduce/mesh/surface/triangle_tree.h"

enum { MOST = 20000 };
static const double PI = 3.14159265358979323846;

typedef struct Sheet { // triangles in the making
  size_t n_points, n;
  double x[3 * MOST];
  int32_t triangle[3 * MOST], entity[MOST];
} Sheet;

static Sheet sheet;

/* An nu x nv grid of points x(u, v), u and v in [0, 1], as triangles of one face of the geometry. `jitter` moves inner
 * points by a part of a cell, by a fixed rule; `closed` joins u = 1 to u = 0. */
static void add_grid(size_t nu, size_t nv, void (*place)(double u, double v, double x[3]), double jitter, bool closed)
{
  const size_t base = sheet.n_points, columns = closed ? nu : nu + 1;
  const int32_t entity = sheet.n > 0 ? sheet.entity[sheet.n - 1] + 1 : 1;
  for (size_t j = 0; j <= nv; j++)
    for (size_t i = 0; i < columns; i++) {
      const bool inner = j > 0 && j < nv && (closed || (i > 0 && i < nu));
      const double a = inner ? jitter * sin(12.9898 * (double)i + 78.233 * (double)j) : 0.0;
      const double b = inner ? jitter * cos(39.425 * (double)i + 11.135 * (double)j) : 0.0;
      place(((double)i + a) / (double)nu, ((double)j + b) / (double)nv, sheet.x + 3 * sheet.n_points++);
    }
  for (size_t j = 0; j < nv; j++)
    for (size_t i = 0; i < nu; i++) {
      const size_t next = (i + 1) % columns;
      const int32_t a = (int32_t)(base + i + j * columns), b = (int32_t)(base + next + j * columns);
      const int32_t c = (int32_t)(base + next + (j + 1) * columns), d = (int32_t)(base + i + (j + 1) * columns);
      const int32_t both[2][3] = {{a, b, c}, {a, c, d}};
      for (int half = 0; half < 2; half++) {
        memcpy(sheet.triangle + 3 * sheet.n, both[half], sizeof both[half]);
        sheet.entity[sheet.n++] = entity;
      }
    }
  assert_true(sheet.n_points < MOST && sheet.n < MOST);
}

/* Points at the same place become one, so that grids share their edges. */
static void weld(void)
{
  for (size_t i = 0; i < 3 * sheet.n; i++)
    for (int32_t p = 0; p < sheet.triangle[i]; p++)
      if (vec_distance(sheet.x + 3 * (size_t)p, sheet.x + 3 * (size_t)sheet.triangle[i]) < 1e-9) sheet.triangle[i] = p;
}

static SurfaceGraph *make_graph(void)
{
  SurfaceGraph *graph = NULL;
  CastError err;
  if (surface_graph_create(sheet.x, sheet.n, sheet.triangle, sheet.entity, &graph, &err) != CAST_OK)
    fail_msg("%s", err.message);
  return graph;
}

typedef struct Shape { // of a partition
  size_t n;
  double area_spread;                         // largest over smallest area
  double worst_compactness, mean_compactness; // perimeter/(4 sqrt(area)): 1 for a square, 0.886 for a disc
  bool connected;
} Shape;

static size_t count_reached(const SurfaceGraph *graph, const int32_t *part, int32_t from, int32_t *queue, char *seen)
{
  size_t head = 0, tail = 0;
  queue[tail++] = from;
  seen[from] = 1;
  while (head < tail) {
    const int32_t t = queue[head++];
    for (int k = 0; k < 3; k++) {
      const int32_t to = graph->neighbour[3 * t + k];
      if (to < 0 || seen[to] || part[to] != part[t]) continue;
      seen[to] = 1;
      queue[tail++] = to;
    }
  }
  return tail;
}

static Shape measure(const SurfaceGraph *graph, const int32_t *part, size_t n_parts)
{
  Shape shape = {.n = n_parts, .connected = true};
  double *area = calloc(n_parts, sizeof *area), *border = calloc(n_parts, sizeof *border);
  size_t *count = calloc(n_parts, sizeof *count);
  int32_t *first = malloc(n_parts * sizeof *first), *queue = malloc(graph->n * sizeof *queue);
  char *seen = calloc(graph->n, 1);
  for (size_t t = graph->n; t-- > 0;) {
    assert_true(part[t] >= 0 && (size_t)part[t] < n_parts);
    area[part[t]] += graph->area[t];
    count[part[t]]++;
    first[part[t]] = (int32_t)t;
    for (size_t k = 3 * t; k < 3 * t + 3; k++)
      if (graph->neighbour[k] < 0 || part[graph->neighbour[k]] != part[t]) border[part[t]] += graph->border[k];
  }
  double least = INFINITY, most = 0.0;
  for (size_t l = 0; l < n_parts; l++) {
    least = fmin(least, area[l]);
    most = fmax(most, area[l]);
    const double compactness = border[l] / (4.0 * sqrt(area[l]));
    shape.worst_compactness = fmax(shape.worst_compactness, compactness);
    shape.mean_compactness += compactness / (double)n_parts;
    shape.connected = shape.connected && count[l] > 0 && count_reached(graph, part, first[l], queue, seen) == count[l];
  }
  shape.area_spread = most / least;
  free(area);
  free(border);
  free(count);
  free(first);
  free(queue);
  free(seen);
  return shape;
}

static Shape partition_sheet(double target_area, int32_t *part)
{
  SurfaceGraph *graph = make_graph();
  CastError err;
  size_t n_parts;
  if (partition_surface(graph, target_area, part, &n_parts, &err) != CAST_OK) fail_msg("%s", err.message);
  const Shape shape = measure(graph, part, n_parts);
  print_message("%zu triangles, %zu parts: areas within a factor %.3f, compactness %.2f (worst %.2f)\n", graph->n,
                n_parts, shape.area_spread, shape.mean_compactness, shape.worst_compactness);
  surface_graph_destroy(&graph);
  return shape;
}

static int clear_sheet(void **state)
{
  (void)state;
  sheet.n_points = sheet.n = 0;
  return 0;
}

static void flat(double u, double v, double x[3]) // 8 x 6
{
  x[0] = 8.0 * u;
  x[1] = 6.0 * v;
  x[2] = 0.0;
}

static void tube(double u, double v, double x[3]) // radius 1, length 6
{
  x[0] = cos(2 * PI * u);
  x[1] = sin(2 * PI * u);
  x[2] = 6.0 * v;
}

static void tube_end(double u, double v, double x[3]) // closes the tube at z = 0; its middle is a small hole
{
  tube(u, 0.0, x);
  x[0] *= 0.05 + 0.95 * v;
  x[1] *= 0.05 + 0.95 * v;
}

static void ball(double u, double v, double x[3]) // radius 1, without its poles
{
  const double theta = PI * (0.02 + 0.96 * v);
  x[0] = sin(theta) * cos(2 * PI * u);
  x[1] = sin(theta) * sin(2 * PI * u);
  x[2] = -cos(theta);
}

/* Areas: with k triangles a part they move in steps of 1/k, and differences below 0.005 sqrt(k) are left where evening
 * them out would lengthen the border (partition_balance.c). Compactness: a hexagon has 0.93, a square 1; a border along
 * edges of triangles is longer than a straight one by up to 4/pi. */
static void check_shape(const Shape *shape, double triangles_per_part)
{
  assert_true(shape->connected);
  assert_true(shape->area_spread < 1.0 + 0.005 * sqrt(triangles_per_part) + 2.0 / triangles_per_part);
  assert_true(shape->mean_compactness < 0.93 * 4.0 / PI);
  assert_true(shape->worst_compactness < 1.5);
}

static void a_flat_sheet_is_cut_into_equal_compact_connected_parts(void **state)
{
  (void)state;
  static int32_t part[MOST];
  add_grid(64, 48, flat, 0.3, false);
  const Shape shape = partition_sheet(1.0, part);
  assert_int_equal(shape.n, 48);
  check_shape(&shape, 2.0 * 64 * 48 / 48);
}

static void a_tube_is_cut_into_equal_compact_connected_parts(void **state)
{
  (void)state;
  static int32_t part[MOST];
  add_grid(48, 40, tube, 0.3, true);
  const Shape shape = partition_sheet(1.0, part);
  assert_int_equal(shape.n, 38); // 2 pi 6 = 37.7
  check_shape(&shape, 2.0 * 48 * 40 / 38);
}

static void a_ball_is_cut_into_equal_compact_connected_parts(void **state)
{
  (void)state;
  static int32_t part[MOST];
  add_grid(80, 40, ball, 0.2, true);
  const Shape shape = partition_sheet(0.5, part);
  assert_int_equal(shape.n, 25); // 4 pi/0.5 = 25.1
  check_shape(&shape, 2.0 * 80 * 40 / 25);
}

static void few_triangles_still_give_connected_parts(void **state)
{
  (void)state;
  static int32_t part[MOST];
  add_grid(6, 5, flat, 0.2, false);
  const Shape shape = partition_sheet(48.0 / 30.0, part); // two triangles each
  assert_int_equal(shape.n, 30);
  assert_true(shape.connected);
  const Shape single = partition_sheet(1e-6, part); // never more parts than triangles
  assert_int_equal(single.n, 60);
  assert_true(single.connected);
}

static bool lies_on_end(int32_t t)
{
  for (size_t k = 0; k < 3; k++)
    if (sheet.x[3 * (size_t)sheet.triangle[3 * (size_t)t + k] + 2] > 1e-6) return false;
  return true;
}

static void a_part_does_not_go_round_an_edge(void **state)
{
  (void)state;
  static int32_t part[MOST];
  static int sides[MOST];
  memset(sides, 0, sizeof sides);
  add_grid(32, 32, tube, 0.0, true);
  add_grid(32, 6, tube_end, 0.0, true);
  weld();
  const Shape shape = partition_sheet(1.5, part); // the end, 3.1, is worth two parts
  assert_true(shape.connected);
  for (size_t t = 0; t < sheet.n; t++) sides[part[t]] |= lies_on_end((int32_t)t) ? 1 : 2;
  for (size_t l = 0; l < shape.n; l++) assert_int_not_equal(sides[l], 3);
}

static void a_tip_far_smaller_than_a_part_joins_its_neighbour(void **state)
{
  (void)state;
  static int32_t part[MOST];
  add_grid(32, 32, tube, 0.0, true);
  add_grid(32, 6, tube_end, 0.0, true);
  weld();
  const Shape shape = partition_sheet(20.0, part); // the end, 3.1, is far less; all is 40.8
  assert_int_equal(shape.n, 2);
  assert_true(shape.connected);
  assert_true(shape.area_spread < 1.05);
}

static void no_target_gives_one_part(void **state)
{
  (void)state;
  static int32_t part[MOST];
  add_grid(8, 8, flat, 0.0, false);
  assert_int_equal(partition_sheet(0.0, part).n, 1);
}

static void the_same_surface_is_always_cut_alike(void **state)
{
  (void)state;
  static int32_t part[MOST], again[MOST];
  add_grid(40, 30, flat, 0.3, false);
  partition_sheet(1.3, part);
  partition_sheet(1.3, again);
  assert_memory_equal(part, again, sheet.n * sizeof *part);
}

/* --- the tree of triangles --- */

static double brute_force(const double *corners, const double *offset, size_t n, double slope, const double x[3])
{
  enum { FINE = 60 };
  double best = INFINITY;
  for (size_t t = 0; t < n; t++)
    for (int i = 0; i <= FINE; i++)
      for (int j = 0; i + j <= FINE; j++) {
        const double u = (double)i / FINE, v = (double)j / FINE;
        double at[3];
        for (size_t d = 0; d < 3; d++)
          at[d] = (1 - u - v) * corners[9 * t + d] + u * corners[9 * t + 3 + d] + v * corners[9 * t + 6 + d];
        best = fmin(best, offset[t] + slope * vec_distance(at, x));
      }
  return best;
}

static void tree_finds_the_least_offset_plus_distance(void **state)
{
  (void)state;
  enum { N = 60 };
  double corners[9 * N], offset[N];
  unsigned seed = 1;
  for (int i = 0; i < 9 * N; i++) {
    seed = seed * 1103515245u + 12345u;
    corners[i] =
        (double)(seed >> 16 & 1023) / 1023.0 * (i % 9 < 3 ? 1.0 : 0.3) + (i % 9 < 3 ? 0.0 : corners[i - i % 9 + i % 3]);
  }
  for (int t = 0; t < N; t++) offset[t] = 0.05 * (t % 7);
  TriangleTree *tree = NULL;
  CastError err;
  assert_int_equal(triangle_tree_create(N, corners, offset, 0.7, &tree, &err), CAST_OK);
  for (int i = 0; i < 40; i++) {
    const double x[3] = {fmod(0.37 * i, 2.0) - 0.3, fmod(0.61 * i, 2.0) - 0.3, fmod(0.83 * i, 2.0) - 0.3};
    const double found = triangle_tree_query(tree, x, 1e9), sampled = brute_force(corners, offset, N, 0.7, x);
    // samples lie within half a diagonal of a cell of the finest grid from any point: 0.43/60/2
    assert_true(found <= sampled + 1e-12);
    assert_true(found >= sampled - 0.7 * 0.004);
    assert_true(triangle_tree_query(tree, x, 0.5 * found) == 0.5 * found); // the limit, if nothing is below
  }
  triangle_tree_destroy(&tree);
  assert_null(tree);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup(a_flat_sheet_is_cut_into_equal_compact_connected_parts, clear_sheet),
      cmocka_unit_test_setup(a_tube_is_cut_into_equal_compact_connected_parts, clear_sheet),
      cmocka_unit_test_setup(a_ball_is_cut_into_equal_compact_connected_parts, clear_sheet),
      cmocka_unit_test_setup(few_triangles_still_give_connected_parts, clear_sheet),
      cmocka_unit_test_setup(a_part_does_not_go_round_an_edge, clear_sheet),
      cmocka_unit_test_setup(a_tip_far_smaller_than_a_part_joins_its_neighbour, clear_sheet),
      cmocka_unit_test_setup(no_target_gives_one_part, clear_sheet),
      cmocka_unit_test_setup(the_same_surface_is_always_cut_alike, clear_sheet),
      cmocka_unit_test(tree_finds_the_least_offset_plus_distance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
