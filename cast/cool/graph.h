/* graph.h - conduction between melt particles that stand still: the pairs of the SPH sum with their weights, kept. */
#ifndef CAST_COOL_GRAPH_H
#define CAST_COOL_GRAPH_H

#include "cast/particles/neighbours.h"
#include "cast/physics/sph.h"

/* Rows are particles, entries their neighbours, both ways: entry (i, j) has the bits of (j, i), so that what i gives j
 * gets. Floats: the weights are known to a spacing's disorder, and a matrix of half the size is applied in half the
 * time. */
typedef struct CoolGraph {
  ptrdiff_t n;
  ptrdiff_t *start;   // [n + 1]
  int32_t *index;     // [start[n]]
  float *weight;      // [start[n]] V_i V_j F_ij, m
  float *conductance; // [start[n]] W/K, weight 4 kappa_i kappa_j/(kappa_i + kappa_j)
} CoolGraph;

/* From lists that are up to date with the particles. Errors: CAST_ERR_MEMORY. */
CastStatus cool_graph_create(const SphParameters *sph, const Particles *particles, const Neighbours *neighbours,
                             CoolGraph *graph, CastError *err);
void cool_graph_destroy(CoolGraph *graph);
void cool_graph_set_conductances(CoolGraph *graph, const double *kappa); // kappa [n] W/(m K)
/* y_i = sum_j conductance_ij (x_i - x_j): the heat, W, that i gives its neighbours at temperatures x. x, y [n] */
void cool_graph_apply(const CoolGraph *graph, const double *x, double *y);
void cool_graph_diagonal(const CoolGraph *graph, double *diagonal); // [n] W/K, sum_j conductance_ij

#endif
