/* resolution.h - how thin the elements at the cavity wall must be for the times and the contact of a run.
 *
 * Under a flux that is switched on, heat has gone sqrt(alpha t) into the mould after t. With a first layer of height d
 * and layers that grow by 1.5 each, a column of elements gives a wall temperature that is too low by a share of about
 *   order 1: 0.4 % + f^2/(f^2 + 30),  order 2: 0.04 % + (f - 3)^2/((f - 3)^2 + 80) for f > 3,   f = d/sqrt(alpha t)
 * (fitted to computed columns: 0.6 % for f = 0.25, 3 % for f = 1, 35 % for f = 4; order 2: 0.03 % for f = 1, 24 % for
 * f = 8). Behind a contact of resistance 1/h the wall's own impedance Z(t) = 2 sqrt(t/pi)/sqrt(kappa rho c) is only a
 * part h Z/(1 + h Z) of the whole, and so is its error. Over all t, error times Z h is at most 0.10 h d/kappa
 * (order 1) or 0.041 h d/kappa (order 2): so d may be as large as a fixed part of kappa/h. */
#ifndef REDUCE_MESH_TETS_RESOLUTION_H
#define REDUCE_MESH_TETS_RESOLUTION_H

#include "reduce/config/config.h"

/* sqrt(alpha t), m */
double resolution_depth(const Material *material, double t);
/* First layer, m, that keeps the wall's error below 1 % (of the rise with perfect contact, of the difference between
 * melt and mould behind config->contact) from t_start on. */
double resolution_layer(const ReduceConfig *config, const Material *material);
/* The share of error that a first layer of `height` m makes, at its worst from t_start to t_end. */
double resolution_error(const ReduceConfig *config, const Material *material, double height);

#endif
