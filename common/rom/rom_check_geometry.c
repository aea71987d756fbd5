/* rom_check_geometry.c - the mould's boundary and band: indices, areas, volumes, and the basis on the points. */
#include "common/rom/rom_check.h"

#include <math.h>
#include <stdlib.h>

#include "common/vector.h"

enum { LARGEST_GEOMETRY = 1 << 30 };
/* Areas and volumes come from the same corners as the model's; only rounding stands between them. The basis is float.
 */
static const double AREA_TOLERANCE = 1e-6, CAPACITY_TOLERANCE = 1e-3, BASIS_TOLERANCE = 1e-3;

static const double *corner(const RomData *rom, int32_t point)
{
  return rom->points + 3 * (size_t)point;
}

static void edge_vector(const double *from, const double *to, double vector[3])
{
  for (int d = 0; d < 3; d++) vector[d] = to[d] - from[d];
}

/* Twice the area, along the normal. */
static void triangle_normal(const RomData *rom, const int32_t *triangle, double normal[3])
{
  double u[3], v[3];
  edge_vector(corner(rom, triangle[0]), corner(rom, triangle[1]), u);
  edge_vector(corner(rom, triangle[0]), corner(rom, triangle[2]), v);
  vec_cross(u, v, normal);
}

static CastStatus check_indices(const char *set, const int32_t *indices, size_t n, size_t limit, CastError *err)
{
  for (size_t i = 0; i < n; i++)
    ROM_CHECK(indices[i] >= 0 && (size_t)indices[i] < limit, err,
              "%s: entry %zu is %d, an index from 0 to %zu is expected", set, i, (int)indices[i], limit - 1);
  return CAST_OK;
}

static CastStatus check_sizes(const RomData *rom, CastError *err)
{
  ROM_CHECK(rom->n_points < LARGEST_GEOMETRY, err, "geometry/points: %zu points are too many", rom->n_points);
  ROM_CHECK(rom->n_triangles < LARGEST_GEOMETRY, err, "geometry/triangles: %zu are too many", rom->n_triangles);
  ROM_CHECK(rom->n_tetrahedra < LARGEST_GEOMETRY, err, "geometry/tetrahedra: %zu are too many", rom->n_tetrahedra);
  ROM_CHECK(rom->n_points >= 4 && rom->n_triangles >= 4, err,
            "geometry/triangles: %zu triangles on %zu points cannot close round a mould", rom->n_triangles,
            rom->n_points);
  ROM_CHECK(rom->n_tetrahedra >= 1, err,
            "geometry/tetrahedra: there are none, the band along the cavity wall is missing");
  ROM_CHECK(isfinite(rom->band) && rom->band > 0.0, err, "geometry/band: is %g m, a positive number is expected",
            rom->band);
  ROM_CHECK(isfinite(rom->min_edge) && rom->min_edge > 0.0, err,
            "geometry/min_edge: is %g m, a positive number is expected", rom->min_edge);
  ROM_CHECK(rom->n_materials >= 1, err, "materials/name: there is none");
  return CAST_OK;
}

static CastStatus check_areas(const RomData *rom, double *area, CastError *err)
{
  for (size_t t = 0; t < rom->n_triangles; t++) {
    double normal[3];
    triangle_normal(rom, rom->triangles + 3 * t, normal);
    const double size = 0.5 * sqrt(vec_dot(normal, normal));
    const double *at = corner(rom, rom->triangles[3 * t]);
    ROM_CHECK(size > 0.0, err, "geometry/triangles: triangle %zu at (%g, %g, %g) m has no area", t, at[0], at[1],
              at[2]);
    area[rom->triangle_patch[t]] += size;
  }
  for (size_t l = 0; l < rom->m; l++)
    ROM_CHECK(fabs(area[l] - rom->patch[l].area) <= AREA_TOLERANCE * rom->patch[l].area, err,
              "patches/area: %s has %.9g m2, but its triangles add up to %.9g m2", rom->patch[l].name,
              rom->patch[l].area, area[l]);
  return CAST_OK;
}

static CastStatus check_patch_areas(const RomData *rom, CastError *err)
{
  double *area = calloc(rom->m, sizeof *area);
  CAST_CHECK(area, err, CAST_ERR_MEMORY, "no memory to check %zu patches", rom->m);
  const CastStatus status = check_areas(rom, area, err);
  free(area);
  return status;
}

/* Divergence theorem, about the first point so that a mould far from the origin loses no digits. */
static double enclosed_volume(const RomData *rom)
{
  double volume = 0.0;
  for (size_t t = 0; t < rom->n_triangles; t++) {
    double normal[3], from_origin[3];
    triangle_normal(rom, rom->triangles + 3 * t, normal);
    edge_vector(rom->points, corner(rom, rom->triangles[3 * t]), from_origin);
    volume += vec_dot(normal, from_origin) / 6.0;
  }
  return volume;
}

static CastStatus check_volume(const RomData *rom, CastError *err)
{
  const double volume = enclosed_volume(rom);
  ROM_CHECK(volume > 0.0, err,
            "geometry/triangles: they enclose %g m3: wound the wrong way round, normals must point out of the mould",
            volume);
  double least = INFINITY, most = 0.0;
  for (size_t i = 0; i < rom->n_materials; i++) {
    const double capacity = rom->material[i].density * rom->material[i].specific_heat;
    least = fmin(least, capacity);
    most = fmax(most, capacity);
  }
  const double mean = rom->heat_capacity / volume;
  ROM_CHECK(mean >= least * (1.0 - CAPACITY_TOLERANCE) && mean <= most * (1.0 + CAPACITY_TOLERANCE), err,
            "model/heat_capacity: %.6g J/K over the %.6g m3 within the boundary is %.6g J/(m3 K), the materials have "
            "%.6g to %.6g",
            rom->heat_capacity, volume, mean, least, most);
  return CAST_OK;
}

static CastStatus check_tetrahedra(const RomData *rom, CastError *err)
{
  for (size_t t = 0; t < rom->n_tetrahedra; t++) {
    const int32_t *tetrahedron = rom->tetrahedra + 4 * t;
    const double *at = corner(rom, tetrahedron[0]);
    double normal[3], w[3];
    triangle_normal(rom, tetrahedron, normal);
    edge_vector(at, corner(rom, tetrahedron[3]), w);
    const double volume = vec_dot(normal, w) / 6.0;
    ROM_CHECK(volume > 0.0, err,
              "geometry/tetrahedra: tetrahedron %zu at (%g, %g, %g) m has volume %g m3, a positive "
              "one is expected",
              t, at[0], at[1], at[2], volume);
  }
  return CAST_OK;
}

/* The constant temperature of 1 K must be 1 K at every point: V constant = 1. Catches rows that belong to other points.
 */
static CastStatus check_basis(const RomData *rom, CastError *err)
{
  for (size_t p = 0; p < rom->n_points; p++) {
    const float *row = rom->basis + p * rom->r;
    double sum = 0.0;
    for (size_t k = 0; k < rom->r; k++) {
      ROM_CHECK(isfinite(row[k]), err, "geometry/basis: entry %zu, %zu is %g, a finite number is expected", p, k,
                (double)row[k]);
      sum += (double)row[k] * rom->constant[k];
    }
    ROM_CHECK(fabs(sum - 1.0) <= BASIS_TOLERANCE, err,
              "geometry/basis: the constant temperature of 1 K is %g K at point %zu, 1 within %g is expected", sum, p,
              BASIS_TOLERANCE);
  }
  return CAST_OK;
}

CastStatus rom_check_geometry(const RomData *rom, CastError *err)
{
  // a model from matrices alone has no geometry: none at all, or the whole of it
  if (rom->n_points == 0 && rom->n_triangles == 0 && rom->n_tetrahedra == 0) return CAST_OK;
  CAST_CALL(check_sizes(rom, err));
  CAST_CALL(rom_check_finite("geometry/points", rom->points, 3 * rom->n_points, err));
  CAST_CALL(check_indices("geometry/triangles", rom->triangles, 3 * rom->n_triangles, rom->n_points, err));
  CAST_CALL(check_indices("geometry/triangle_patch", rom->triangle_patch, rom->n_triangles, rom->m, err));
  CAST_CALL(check_indices("geometry/tetrahedra", rom->tetrahedra, 4 * rom->n_tetrahedra, rom->n_points, err));
  CAST_CALL(rom_check_closed(rom, err));
  CAST_CALL(check_patch_areas(rom, err));
  CAST_CALL(check_volume(rom, err));
  CAST_CALL(check_tetrahedra(rom, err));
  return check_basis(rom, err);
}
