/* Method      The kernel, integrated along the contact line, on a square grid; sums over the melt's part of it for each
 *             height above the wall and depth below the surface; then for each height turned from depth to fill, which
 *             rises with depth. */
#include "cast/physics/wedge.h"

#include <math.h>
#include <stdlib.h>

#include "cast/kernel/pair.h"

enum { GRID = 48, HEIGHTS = 24, DEPTHS = 48, FILLS = 32, SHARES = 64 };
static const double most_raise = 3.0; // where the wedge hides the gradient, only noise would be raised
static const double least_gradient = 1e-3;

struct Wedge {
  double cosine, sine;                   // of the contact angle
  double height[SHARES + 1];             // h, over walls' share from 0 to 1/2
  WedgePlace at[HEIGHTS + 1][FILLS + 1]; // over height from 0 to the support, fill from 0 to 1
  double support;                        // h
};

typedef struct Cell { // of the grid, seen from its middle
  double y, s;        // h, away from the wall and along it
  double W, gy, gs;   // share of the kernel, its gradient, times the cell's area
} Cell;

/* The kernel and its slope integrated along the contact line. */
static Cell make_cell(KernelKind kernel, double y, double s, double area)
{
  enum { PARTS = 64 };
  const double reach = shape_support(kernel), step = reach / PARTS, scale = 2.0 * shape_norm(kernel) * step * area;
  double W = 0.0, F = 0.0;
  for (int k = 0; k < PARTS; k++) {
    const double x = (k + 0.5) * step, q = sqrt(x * x + y * y + s * s);
    if (q >= reach) break;
    W += shape_value(kernel, q);
    F += shape_slope(kernel, q);
  }
  return (Cell){y, s, scale * W, scale * F * y, scale * F * s};
}

static Cell *make_grid(KernelKind kernel)
{
  Cell *grid = malloc(GRID * GRID * sizeof *grid);
  const double reach = shape_support(kernel), side = 2.0 * reach / GRID;
  for (int a = 0; grid && a < GRID; a++)
    for (int b = 0; b < GRID; b++)
      grid[a * GRID + b] = make_cell(kernel, (a + 0.5) * side - reach, (b + 0.5) * side - reach, side * side);
  return grid;
}

/* Part of a cell on the inner side of a line at this distance from its middle: 1/2 where it passes through. */
static double inside(double distance, double side)
{
  return fmax(0.0, fmin(1.0, 0.5 + distance / side));
}

/* Seen at a height and a depth: the place's numbers, the fill, and what walls fill. */
static WedgePlace look_at(const Wedge *w, const Cell *grid, double height, double depth, double *fill, double *walls)
{
  const double side = 2.0 * w->support / GRID;
  double all = 0.0, wall[2] = {0}, melt[3] = {0}, whole[2] = {0}; // shares; gradients away and along
  for (int k = 0; k < GRID * GRID; k++) {
    const Cell *c = &grid[k];
    const double open = inside(c->y + height, side), in = inside(depth - c->y * w->cosine + c->s * w->sine, side);
    all += c->W;
    wall[0] += (1.0 - open) * c->W;
    wall[1] += (1.0 - open) * c->gy;
    melt[0] += open * in * c->W;
    melt[1] += open * in * c->gy;
    melt[2] += open * in * c->gs;
    whole[0] += in * c->gy;
    whole[1] += in * c->gs;
  }
  *walls = wall[0] / all;
  const double free = 1.0 - *walls;
  *fill = melt[0] / all / free;
  const double away = (melt[1] + *fill * wall[1]) / free, along = melt[2] / free,
               seen = sqrt(away * away + along * along), truth = sqrt(whole[0] * whole[0] + whole[1] * whole[1]);
  WedgePlace at = {.height = height, .depth = depth, .raise = 1.0};
  if (seen < least_gradient) return at;
  at.lean = -w->cosine - away / seen;
  at.raise = fmin(most_raise, truth / seen);
  return at;
}

static WedgePlace between(const WedgePlace *a, const WedgePlace *b, double t)
{
  return (WedgePlace){a->height + t * (b->height - a->height), a->depth + t * (b->depth - a->depth),
                      a->lean + t * (b->lean - a->lean), a->raise + t * (b->raise - a->raise)};
}

/* The row of one height; returns what walls fill there. */
static double make_row(Wedge *w, const Cell *grid, double height, WedgePlace row[FILLS + 1])
{
  WedgePlace seen[DEPTHS + 1];
  double fill[DEPTHS + 1], walls = 0.0;
  for (int k = 0; k <= DEPTHS; k++)
    seen[k] = look_at(w, grid, height, w->support * (2.0 * k / DEPTHS - 1.0), &fill[k], &walls);
  for (int f = 0, k = 0; f <= FILLS; f++) {
    const double at = (double)f / FILLS;
    while (k < DEPTHS - 1 && fill[k + 1] < at) k++;
    const double rise = fill[k + 1] - fill[k], t = rise > 0.0 ? (at - fill[k]) / rise : 0.0;
    row[f] = between(&seen[k], &seen[k + 1], fmax(0.0, fmin(1.0, t)));
  }
  return walls;
}

static void make_tables(Wedge *w, const Cell *grid)
{
  double walls[HEIGHTS + 1];
  for (int k = 0; k <= HEIGHTS; k++) walls[k] = make_row(w, grid, w->support * k / HEIGHTS, w->at[k]);
  for (int s = 0, k = HEIGHTS; s <= SHARES; s++) { // walls fill less the higher it is
    const double share = 0.5 * s / SHARES;
    while (k > 1 && walls[k - 1] < share) k--;
    const double t = (share - walls[k]) / (walls[k - 1] - walls[k]);
    w->height[s] = w->support * (k - fmax(0.0, fmin(1.0, t))) / HEIGHTS;
  }
}

CastStatus wedge_create(KernelKind kernel, double contact_angle, Wedge **wedge, CastError *err)
{
  Wedge *w = *wedge = calloc(1, sizeof *w);
  CAST_CHECK(w, err, CAST_ERR_MEMORY, "no memory");
  w->cosine = cos(contact_angle);
  w->sine = sin(contact_angle);
  w->support = kernel_support(kernel);
  Cell *grid = make_grid(kernel);
  CAST_CHECK(grid, err, CAST_ERR_MEMORY, "no memory");
  make_tables(w, grid);
  free(grid);
  return CAST_OK;
}

void wedge_destroy(Wedge **wedge)
{
  if (!wedge) return;
  free(*wedge);
  *wedge = NULL;
}

/* Index below x of a table of n steps over [0, most]; the rest of x in steps. */
static int place(double x, double most, int n, double *rest)
{
  const double s = fmax(0.0, fmin(1.0, x / most)) * n;
  const int k = s < n ? (int)s : n - 1;
  *rest = s - k;
  return k;
}

WedgePlace wedge_look(const Wedge *w, double walls, double fill)
{
  double t, u;
  const int s = place(walls, 0.5, SHARES, &t);
  const double height = w->height[s] + t * (w->height[s + 1] - w->height[s]);
  const int k = place(height, w->support, HEIGHTS, &t), f = place(fill, 1.0, FILLS, &u);
  const WedgePlace low = between(&w->at[k][f], &w->at[k][f + 1], u),
                   high = between(&w->at[k + 1][f], &w->at[k + 1][f + 1], u);
  return between(&low, &high, t);
}
