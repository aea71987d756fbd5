/* Point location in the band: a grid of cubic cells, each with the tetrahedra whose bounding boxes touch it. */
#include "cast/mould/band.h"

#include <math.h>
#include <stdlib.h>

static const double slack = 1e-9; // of barycentric weights: rounding must not lose a point between two tetrahedra

struct Band {
  const RomData *rom;
  double low[3], cell; // m
  int32_t count[3];
  ptrdiff_t *start; // [cells + 1]
  int32_t *item;    // tetrahedra of each cell, ascending
};

typedef struct Box {
  int32_t first[3], last[3]; // cells
} Box;

static const double *corner(const RomData *rom, size_t tetrahedron, int k)
{
  return rom->points + 3 * (size_t)rom->tetrahedra[4 * tetrahedron + (size_t)k];
}

static void lay_cells(Band *band)
{
  const RomData *rom = band->rom;
  double high[3], volume = 1.0;
  for (int d = 0; d < 3; d++) {
    band->low[d] = high[d] = corner(rom, 0, 0)[d];
    for (size_t t = 0; t < rom->n_tetrahedra; t++)
      for (int k = 0; k < 4; k++) {
        band->low[d] = fmin(band->low[d], corner(rom, t, k)[d]);
        high[d] = fmax(high[d], corner(rom, t, k)[d]);
      }
    volume *= high[d] - band->low[d];
  }
  band->cell = cbrt(volume / (double)rom->n_tetrahedra);
  const double most = 4.0 * (double)rom->n_tetrahedra + 64.0; // cells
  for (double cells = INFINITY; cells > most;) {
    cells = 1.0;
    for (int d = 0; d < 3; d++) {
      const double fit = floor((high[d] - band->low[d]) / band->cell) + 1.0;
      band->count[d] = (int32_t)fmin(fit, 1e6);
      cells *= fit;
    }
    if (cells > most) band->cell *= 1.2;
  }
}

static int32_t cell_at(const Band *band, int d, double x)
{
  const double at = floor((x - band->low[d]) / band->cell);
  return (int32_t)fmin(fmax(at, 0.0), band->count[d] - 1);
}

static Box box_of(const Band *band, size_t tetrahedron)
{
  Box box;
  for (int d = 0; d < 3; d++) {
    double least = INFINITY, most = -INFINITY;
    for (int k = 0; k < 4; k++) {
      least = fmin(least, corner(band->rom, tetrahedron, k)[d]);
      most = fmax(most, corner(band->rom, tetrahedron, k)[d]);
    }
    const double margin = slack * (most - least) + 1e-12 * band->cell;
    box.first[d] = cell_at(band, d, least - margin);
    box.last[d] = cell_at(band, d, most + margin);
  }
  return box;
}

static ptrdiff_t cell_index(const Band *band, int32_t x, int32_t y, int32_t z)
{
  return ((ptrdiff_t)z * band->count[1] + y) * band->count[0] + x;
}

/* Counts into start[cell + 1], or puts items at start[cell]++. */
static void visit(Band *band, bool put)
{
  for (size_t t = 0; t < band->rom->n_tetrahedra; t++) {
    const Box box = box_of(band, t);
    for (int32_t z = box.first[2]; z <= box.last[2]; z++)
      for (int32_t y = box.first[1]; y <= box.last[1]; y++)
        for (int32_t x = box.first[0]; x <= box.last[0]; x++) {
          const ptrdiff_t cell = cell_index(band, x, y, z);
          if (put)
            band->item[band->start[cell]++] = (int32_t)t;
          else
            band->start[cell + 1]++;
        }
  }
}

static CastStatus fill_cells(Band *band, CastError *err)
{
  const ptrdiff_t cells = (ptrdiff_t)band->count[0] * band->count[1] * band->count[2];
  band->start = calloc((size_t)cells + 1, sizeof *band->start);
  CAST_CHECK(band->start, err, CAST_ERR_MEMORY, "coupling: no memory for the band's search grid");
  visit(band, false);
  for (ptrdiff_t c = 0; c < cells; c++) band->start[c + 1] += band->start[c];
  band->item = malloc((size_t)(band->start[cells] + 1) * sizeof *band->item);
  CAST_CHECK(band->item, err, CAST_ERR_MEMORY, "coupling: no memory for the band's search grid");
  visit(band, true);
  for (ptrdiff_t c = cells; c > 0; c--) band->start[c] = band->start[c - 1];
  band->start[0] = 0;
  return CAST_OK;
}

CastStatus band_create(const RomData *rom, Band **out, CastError *err)
{
  *out = NULL;
  CAST_CHECK(rom->n_tetrahedra > 0 && rom->basis, err, CAST_ERR_INPUT,
             "the ROM has no near-wall band: `embedded` coupling needs one, `surface` does not");
  Band *band = calloc(1, sizeof *band);
  CAST_CHECK(band, err, CAST_ERR_MEMORY, "coupling: no memory");
  band->rom = rom;
  lay_cells(band);
  const CastStatus status = fill_cells(band, err);
  if (status != CAST_OK) band_destroy(&band);
  *out = band;
  return status;
}

void band_destroy(Band **band)
{
  if (!band || !*band) return;
  free((*band)->start);
  free((*band)->item);
  free(*band);
  *band = NULL;
}

static double triple(const double a[3], const double b[3], const double c[3])
{
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Barycentric weights of x; false if it lies outside. */
static bool weights_in(const RomData *rom, size_t tetrahedron, const double x[3], double weight[4])
{
  double edge[3][3], to[3];
  const double *base = corner(rom, tetrahedron, 0);
  for (int d = 0; d < 3; d++) {
    to[d] = x[d] - base[d];
    for (int k = 0; k < 3; k++) edge[k][d] = corner(rom, tetrahedron, k + 1)[d] - base[d];
  }
  const double volume = triple(edge[0], edge[1], edge[2]);
  weight[1] = triple(to, edge[1], edge[2]) / volume;
  weight[2] = triple(edge[0], to, edge[2]) / volume;
  weight[3] = triple(edge[0], edge[1], to) / volume;
  weight[0] = 1.0 - weight[1] - weight[2] - weight[3];
  double sum = 0.0;
  for (int k = 0; k < 4; k++) {
    if (!(weight[k] >= -slack)) return false;
    weight[k] = fmax(weight[k], 0.0);
    sum += weight[k];
  }
  for (int k = 0; k < 4; k++) weight[k] /= sum;
  return true;
}

bool band_locate(const Band *band, const double x[3], BandPlace *place)
{
  int32_t at[3];
  for (int d = 0; d < 3; d++) {
    const double cell = (x[d] - band->low[d]) / band->cell;
    if (!(cell > -1e-6 && cell < band->count[d] + 1e-6)) return false;
    at[d] = cell_at(band, d, x[d]);
  }
  const ptrdiff_t cell = cell_index(band, at[0], at[1], at[2]);
  for (ptrdiff_t k = band->start[cell]; k < band->start[cell + 1]; k++) {
    const int32_t tetrahedron = band->item[k];
    if (!weights_in(band->rom, (size_t)tetrahedron, x, place->weight)) continue;
    place->tetrahedron = tetrahedron;
    for (int c = 0; c < 4; c++) place->point[c] = band->rom->tetrahedra[4 * tetrahedron + c];
    return true;
  }
  return false;
}
