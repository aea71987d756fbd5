#define _GNU_SOURCE // qsort_r
#include "reduce/mesh/surface/triangle_tree.h"

#include <float.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include "common/vector.h"

enum { LEAF_SIZE = 8 };

typedef struct Node { // children of node i are 2 i + 1 and 2 i + 2
  double low[3], high[3];
  double least_offset;
  size_t first, count; // triangles, in the order of `triangle`
} Node;

struct TriangleTree {
  size_t n, n_nodes;
  double *corners;  // [n*9]
  double *offset;   // [n]
  size_t *triangle; // [n] permutation
  Node *node;
  double slope;
};

typedef struct Axis {
  const double *corners;
  int axis;
} Axis;

static double centre_along(const Axis *axis, size_t t)
{
  const double *c = axis->corners + 9 * t + axis->axis;
  return c[0] + c[3] + c[6];
}

static int by_centre(const void *left, const void *right, void *context)
{
  const size_t a = *(const size_t *)left, b = *(const size_t *)right;
  const double u = centre_along(context, a), v = centre_along(context, b);
  if (u != v) return u < v ? -1 : 1;
  return (a > b) - (a < b);
}

static void bound(const TriangleTree *tree, Node *node)
{
  node->least_offset = DBL_MAX;
  for (int d = 0; d < 3; d++) {
    node->low[d] = DBL_MAX;
    node->high[d] = -DBL_MAX;
  }
  for (size_t i = node->first; i < node->first + node->count; i++) {
    const double *corner = tree->corners + 9 * tree->triangle[i];
    node->least_offset = fmin(node->least_offset, tree->offset[tree->triangle[i]]);
    for (int k = 0; k < 9; k++) {
      node->low[k % 3] = fmin(node->low[k % 3], corner[k]);
      node->high[k % 3] = fmax(node->high[k % 3], corner[k]);
    }
  }
}

/* Split the node's triangles at the median along its longest side. */
static void split(TriangleTree *tree, size_t index)
{
  Node *node = &tree->node[index];
  bound(tree, node);
  if (2 * index + 2 >= tree->n_nodes) return;
  Axis axis = {tree->corners, 0};
  for (int d = 1; d < 3; d++)
    if (node->high[d] - node->low[d] > node->high[axis.axis] - node->low[axis.axis]) axis.axis = d;
  qsort_r(tree->triangle + node->first, node->count, sizeof *tree->triangle, by_centre, &axis);
  const size_t half = node->count / 2;
  tree->node[2 * index + 1].first = node->first;
  tree->node[2 * index + 1].count = half;
  tree->node[2 * index + 2].first = node->first + half;
  tree->node[2 * index + 2].count = node->count - half;
  split(tree, 2 * index + 1);
  split(tree, 2 * index + 2);
}

CastStatus triangle_tree_create(size_t n, const double *corners, const double *offset, double slope,
                                TriangleTree **tree, CastError *err)
{
  *tree = NULL;
  CAST_CHECK(n > 0, err, CAST_ERR_ARGUMENT, "a tree of triangles needs at least one");
  TriangleTree *made = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory for %zu triangles", n);
  made->n = n;
  made->n_nodes = 1; // a full binary tree: half the triangles of a level stay together to the leaf
  for (size_t in_leaf = n; in_leaf > LEAF_SIZE; in_leaf = (in_leaf + 1) / 2) made->n_nodes = 2 * made->n_nodes + 1;
  made->slope = slope;
  made->corners = malloc(9 * n * sizeof *made->corners);
  made->offset = calloc(n, sizeof *made->offset);
  made->triangle = malloc(n * sizeof *made->triangle);
  made->node = calloc(made->n_nodes, sizeof *made->node);
  if (!made->corners || !made->offset || !made->triangle || !made->node) {
    triangle_tree_destroy(&made);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for %zu triangles", n);
  }
  memcpy(made->corners, corners, 9 * n * sizeof *corners);
  if (offset) memcpy(made->offset, offset, n * sizeof *offset);
  for (size_t i = 0; i < n; i++) made->triangle[i] = i;
  made->node[0].count = n;
  split(made, 0);
  *tree = made;
  return CAST_OK;
}

void triangle_tree_destroy(TriangleTree **tree)
{
  if (!tree || !*tree) return;
  free((*tree)->corners);
  free((*tree)->offset);
  free((*tree)->triangle);
  free((*tree)->node);
  free(*tree);
  *tree = NULL;
}

static double box_distance(const Node *node, const double x[3])
{
  double square = 0.0;
  for (int d = 0; d < 3; d++) {
    const double outside = fmax(fmax(node->low[d] - x[d], x[d] - node->high[d]), 0.0);
    square += outside * outside;
  }
  return sqrt(square);
}

static double segment_distance(const double a[3], const double b[3], const double x[3])
{
  double along[3], to[3], foot[3];
  vec_between(a, b, along);
  vec_between(a, x, to);
  const double length2 = vec_dot(along, along);
  const double s = length2 > 0.0 ? fmin(fmax(vec_dot(along, to) / length2, 0.0), 1.0) : 0.0;
  for (int d = 0; d < 3; d++) foot[d] = a[d] + s * along[d];
  return vec_distance(foot, x);
}

/* The height over the plane where the foot falls inside, else the distance to the nearest edge. */
static double triangle_distance(const double c[9], const double x[3])
{
  double u[3], v[3], normal[3], to[3];
  vec_between(c, c + 3, u);
  vec_between(c, c + 6, v);
  vec_between(c, x, to);
  vec_cross(u, v, normal);
  bool inside = true;
  for (int k = 0; k < 3 && inside; k++) {
    double edge[3], from[3], inward[3];
    vec_between(c + 3 * k, c + 3 * ((k + 1) % 3), edge);
    vec_between(c + 3 * k, x, from);
    vec_cross(normal, edge, inward);
    inside = vec_dot(inward, from) >= 0.0;
  }
  const double size = vec_norm(normal);
  if (inside && size > 0.0) return fabs(vec_dot(normal, to)) / size;
  return fmin(segment_distance(c, c + 3, x), fmin(segment_distance(c + 3, c + 6, x), segment_distance(c + 6, c, x)));
}

static double search(const TriangleTree *tree, size_t index, const double x[3], double best)
{
  const Node *node = &tree->node[index];
  if (node->least_offset + tree->slope * box_distance(node, x) >= best) return best;
  if (2 * index + 2 >= tree->n_nodes) {
    for (size_t i = node->first; i < node->first + node->count; i++) {
      const size_t t = tree->triangle[i];
      best = fmin(best, tree->offset[t] + tree->slope * triangle_distance(tree->corners + 9 * t, x));
    }
    return best;
  }
  const Node *children = &tree->node[2 * index + 1];
  const size_t near = box_distance(&children[0], x) <= box_distance(&children[1], x) ? 1 : 2;
  best = search(tree, 2 * index + near, x, best);
  return search(tree, 2 * index + 3 - near, x, best);
}

double triangle_tree_query(const TriangleTree *tree, const double x[3], double limit)
{
  return search(tree, 0, x, limit);
}
