/* gas_column.h - a column of melt that hangs free in a duct without walls (it repeats across), with gas below it, or
 * gas on both sides. */
#ifndef TESTS_SUPPORT_GAS_COLUMN_H
#define TESTS_SUPPORT_GAS_COLUMN_H

#include "cast/pour/gas.h"
#include "tests/support/lattice_tank.h"

enum { COLUMN_ACROSS = 10, COLUMN_ROOM = 8 }; // particles; room for gas below and above the column

typedef struct GasColumn {
  LatticeTank tank;
  Gas *gas;
  int length;     // particles
  double spacing; // m
} GasColumn;

/*  above  gas is let in there too.  Fails the test where anything fails. */
GasColumn gas_column_create(int length, double spacing, double rho0, double c0, double gravity, bool above);
void gas_column_destroy(GasColumn *column);
void gas_column_rates(GasColumn *column, double pressure); // lists, rates, gas
void gas_column_step(GasColumn *column, double dt, double pressure);

#endif
