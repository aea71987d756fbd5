/* rom_check.c - is this a model of a mould? Sizes, numbers, names, and the identities that every ROM of this form
 * obeys: Lambda >= 0                     passive: E_r = I and K_r = Lambda are positive constant^T B = 1 per column a
 * watt in is a watt stored, as the constant temperature survived the reduction constant^T constant = heat capacity
 *   Lambda constant = ambient       a mould at the temperature of its surroundings stays there */
#include "common/rom/rom_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rounding of a sum of some thousand products, with orthogonality to 1e-10 in the reduction. */
static const double UNIT_TOLERANCE = 1e-8, IDENTITY_TOLERANCE = 1e-6;
enum { LARGEST_STATES = 1000000, LARGEST_PATCHES = 100000, LARGEST_TABLE = 100000 };

CastStatus rom_check_finite(const char *set, const double *values, size_t n, CastError *err)
{
  for (size_t i = 0; i < n; i++)
    ROM_CHECK(isfinite(values[i]), err, "%s: entry %zu is %g, a finite number is expected", set, i, values[i]);
  return CAST_OK;
}

static CastStatus check_array(const char *set, const void *array, size_t n, CastError *err)
{
  ROM_CHECK(array || n == 0, err, "%s: is missing", set);
  return CAST_OK;
}

static CastStatus check_sizes(const RomData *rom, CastError *err)
{
  ROM_CHECK(rom->r >= 1 && rom->r <= LARGEST_STATES, err, "model/lambda: %zu states, 1 to %d are expected", rom->r,
            LARGEST_STATES);
  ROM_CHECK(rom->m >= 1 && rom->m <= LARGEST_PATCHES, err, "patches/name: %zu patches, 1 to %d are expected", rom->m,
            LARGEST_PATCHES);
  ROM_CHECK(rom->n_materials <= LARGEST_TABLE, err, "materials/name: %zu materials", rom->n_materials);
  CAST_CALL(check_array("model/lambda", rom->lambda, rom->r, err));
  CAST_CALL(check_array("model/B", rom->B, rom->r, err));
  CAST_CALL(check_array("model/ambient", rom->ambient, rom->r, err));
  CAST_CALL(check_array("model/constant", rom->constant, rom->r, err));
  CAST_CALL(check_array("patches/name", rom->patch, rom->m, err));
  CAST_CALL(check_array("materials/name", rom->material, rom->n_materials, err));
  CAST_CALL(check_array("geometry/points", rom->points, rom->n_points, err));
  CAST_CALL(check_array("geometry/basis", rom->basis, rom->n_points, err));
  CAST_CALL(check_array("geometry/triangles", rom->triangles, rom->n_triangles, err));
  CAST_CALL(check_array("geometry/triangle_patch", rom->triangle_patch, rom->n_triangles, err));
  CAST_CALL(check_array("geometry/tetrahedra", rom->tetrahedra, rom->n_tetrahedra, err));
  CAST_CALL(check_array("reduction/shifts", rom->shifts, rom->n_shifts, err));
  const RomCertificate *certificate = &rom->certificate;
  CAST_CALL(check_array("certificate/frequency", certificate->frequency, certificate->n_frequencies, err));
  CAST_CALL(check_array("certificate/transfer_bound", certificate->transfer_bound, certificate->n_frequencies, err));
  CAST_CALL(check_array("certificate/time", certificate->time, certificate->n_times, err));
  return check_array("certificate/step_error", certificate->step_error, certificate->n_times, err);
}

static CastStatus check_lambda(const RomData *rom, CastError *err)
{
  CAST_CALL(rom_check_finite("model/lambda", rom->lambda, rom->r, err));
  for (size_t k = 0; k < rom->r; k++) {
    ROM_CHECK(rom->lambda[k] >= 0.0, err, "model/lambda: entry %zu is %g 1/s; a negative rate makes heat from nothing",
              k, rom->lambda[k]);
    ROM_CHECK(k == 0 || rom->lambda[k] >= rom->lambda[k - 1], err,
              "model/lambda: entry %zu (%g 1/s) is below the one before it (%g 1/s), ascending order is expected", k,
              rom->lambda[k], rom->lambda[k - 1]);
  }
  return CAST_OK;
}

static CastStatus check_inputs(const RomData *rom, CastError *err)
{
  CAST_CALL(rom_check_finite("model/B", rom->B, rom->r * rom->m, err));
  double *sum = calloc(rom->m, sizeof *sum);
  CAST_CHECK(sum, err, CAST_ERR_MEMORY, "no memory to check %zu patches", rom->m);
  for (size_t k = 0; k < rom->r; k++)
    for (size_t l = 0; l < rom->m; l++) sum[l] += rom->constant[k] * rom->B[k * rom->m + l];
  size_t worst = 0;
  for (size_t l = 0; l < rom->m; l++)
    if (fabs(sum[l] - 1.0) > fabs(sum[worst] - 1.0)) worst = l;
  const double found = sum[worst];
  free(sum);
  ROM_CHECK(
      fabs(found - 1.0) <= UNIT_TOLERANCE, err,
      "model/B: constant^T B is %.12g for patch %zu (%.63s), 1 within %g is expected: heat would not be conserved",
      found, worst, rom->patch[worst].name, UNIT_TOLERANCE);
  return CAST_OK;
}

static CastStatus check_heat_capacity(const RomData *rom, CastError *err)
{
  double sum = 0.0;
  for (size_t k = 0; k < rom->r; k++) sum += rom->constant[k] * rom->constant[k];
  ROM_CHECK(isfinite(rom->heat_capacity) && rom->heat_capacity > 0.0, err,
            "model/heat_capacity: is %g J/K, a positive number is expected", rom->heat_capacity);
  ROM_CHECK(fabs(sum - rom->heat_capacity) <= IDENTITY_TOLERANCE * rom->heat_capacity, err,
            "model/heat_capacity: is %.9g J/K, but constant^T constant is %.9g J/K", rom->heat_capacity, sum);
  return CAST_OK;
}

/* K 1 = ambient in the states' coordinates. Rounding of the small eigenproblem leaves about 1e-16 r of the largest
 * eigenvalue in each, hence the second part of the tolerance. */
static CastStatus check_ambient(const RomData *rom, CastError *err)
{
  CAST_CALL(rom_check_finite("model/ambient", rom->ambient, rom->r, err));
  double difference = 0.0, size = 0.0, constant = 0.0;
  for (size_t k = 0; k < rom->r; k++) {
    const double loss = rom->lambda[k] * rom->constant[k], delta = loss - rom->ambient[k];
    difference += delta * delta;
    size += loss * loss + rom->ambient[k] * rom->ambient[k];
    constant += rom->constant[k] * rom->constant[k];
  }
  const double tolerance = IDENTITY_TOLERANCE * sqrt(size) + 1e-10 * rom->lambda[rom->r - 1] * sqrt(constant);
  ROM_CHECK(sqrt(difference) <= tolerance, err,
            "model/ambient: differs from Lambda constant by %g (%g is allowed): a mould at the temperature of its "
            "surroundings would not stay there",
            sqrt(difference), tolerance);
  return CAST_OK;
}

static CastStatus check_name(const char *set, size_t i, const char *name, CastError *err)
{
  ROM_CHECK(memchr(name, 0, ROM_NAME_LENGTH), err, "%s: entry %zu has no end", set, i);
  ROM_CHECK(name[0], err, "%s: entry %zu is empty", set, i);
  return CAST_OK;
}

static CastStatus check_patch(const RomData *rom, size_t l, CastError *err)
{
  const RomPatch *patch = &rom->patch[l];
  CAST_CALL(check_name("patches/name", l, patch->name, err));
  CAST_CALL(check_name("patches/surface", l, patch->surface, err));
  ROM_CHECK(isfinite(patch->area) && patch->area > 0.0, err, "patches/area: %s has %g m2, more than 0 is expected",
            patch->name, patch->area);
  CAST_CALL(rom_check_finite("patches/centroid", patch->centroid, 3, err));
  ROM_CHECK(isfinite(patch->h) && patch->h >= 0.0, err, "patches/h: %s has %g W/(m2 K), 0 or more is expected",
            patch->name, patch->h);
  ROM_CHECK(!patch->fixed || patch->h > 0.0, err, "patches/fixed: %s has a fixed temperature but h = 0", patch->name);
  ROM_CHECK(l == 0 || patch->outer || !rom->patch[l - 1].outer, err,
            "patches/outer: cavity patch %zu (%s) stands after an outer one, cavity patches come first", l,
            patch->name);
  return CAST_OK;
}

static int compare_names(const void *a, const void *b)
{
  return strcmp((*(const RomPatch *const *)a)->name, (*(const RomPatch *const *)b)->name);
}

static CastStatus check_patch_names(const RomData *rom, CastError *err)
{
  const RomPatch **sorted = calloc(rom->m, sizeof(RomPatch *));
  CAST_CHECK(sorted, err, CAST_ERR_MEMORY, "no memory to check %zu patches", rom->m);
  for (size_t l = 0; l < rom->m; l++) sorted[l] = &rom->patch[l];
  qsort(sorted, rom->m, sizeof(RomPatch *), compare_names);
  const char *twice = NULL;
  for (size_t l = 1; l < rom->m && !twice; l++)
    if (strcmp(sorted[l]->name, sorted[l - 1]->name) == 0) twice = sorted[l]->name;
  free(sorted);
  ROM_CHECK(!twice, err, "patches/name: '%s' appears twice", twice);
  return CAST_OK;
}

static CastStatus check_patches(const RomData *rom, CastError *err)
{
  for (size_t l = 0; l < rom->m; l++) CAST_CALL(check_patch(rom, l, err));
  ROM_CHECK(!rom->patch[0].outer, err, "patches/outer: there is no cavity patch");
  return check_patch_names(rom, err);
}

static CastStatus check_positive(const char *set, const char *owner, double value, const char *unit, CastError *err)
{
  ROM_CHECK(isfinite(value) && value > 0.0, err, "%s: %s%s%g %s, a positive number is expected", set, owner,
            owner[0] ? " has " : "is ", value, unit);
  return CAST_OK;
}

static CastStatus check_materials(const RomData *rom, CastError *err)
{
  for (size_t i = 0; i < rom->n_materials; i++) {
    const RomMaterial *material = &rom->material[i];
    CAST_CALL(check_name("materials/region", i, material->region, err));
    CAST_CALL(check_name("materials/name", i, material->name, err));
    CAST_CALL(check_positive("materials/conductivity", material->name, material->conductivity, "W/(m K)", err));
    CAST_CALL(check_positive("materials/density", material->name, material->density, "kg/m3", err));
    CAST_CALL(check_positive("materials/specific_heat", material->name, material->specific_heat, "J/(kg K)", err));
    const double reference = material->reference_temperature;
    ROM_CHECK(isnan(reference) || (isfinite(reference) && reference > 0.0), err,
              "materials/reference_temperature: %s has %g K", material->name, reference);
    ROM_CHECK(memchr(material->sha256, 0, sizeof material->sha256), err, "materials/sha256: entry %zu has no end", i);
  }
  return CAST_OK;
}

static CastStatus check_reduction(const RomData *rom, CastError *err)
{
  ROM_CHECK(memchr(rom->method, 0, sizeof rom->method) && rom->method[0], err, "reduction/method: is empty");
  ROM_CHECK(rom->n_full >= rom->r, err, "reduction/n_full: %zu unknowns cannot have been reduced to %zu states",
            rom->n_full, rom->r);
  ROM_CHECK(rom->moments >= 0, err, "reduction/moments: is %ld", rom->moments);
  ROM_CHECK(rom->n_shifts <= LARGEST_TABLE, err, "reduction/shifts: %zu entries", rom->n_shifts);
  CAST_CALL(rom_check_finite("reduction/shifts", rom->shifts, rom->n_shifts, err));
  for (size_t i = 0; i < rom->n_shifts; i++)
    ROM_CHECK(rom->shifts[i] >= 0.0, err, "reduction/shifts: entry %zu is %g 1/s, 0 or more is expected", i,
              rom->shifts[i]);
  CAST_CALL(check_positive("reduction/tolerance", "", rom->tolerance, "", err));
  CAST_CALL(check_positive("reduction/t_start", "", rom->t_start, "s", err));
  ROM_CHECK(isfinite(rom->t_end) && rom->t_end > rom->t_start, err,
            "reduction/t_end: %g s, more than t_start = %g s "
            "is expected",
            rom->t_end, rom->t_start);
  return CAST_OK;
}

/* Errors and bounds: none negative; NaN says that it was not computed. */
static CastStatus check_error(const char *set, double value, CastError *err)
{
  ROM_CHECK(isnan(value) || value >= 0.0, err, "%s: %g is negative", set, value);
  return CAST_OK;
}

static CastStatus check_certificate(const RomData *rom, CastError *err)
{
  const RomCertificate *certificate = &rom->certificate;
  ROM_CHECK(certificate->n_frequencies <= LARGEST_TABLE, err, "certificate/frequency: too many entries");
  ROM_CHECK(certificate->n_times <= LARGEST_TABLE, err, "certificate/time: too many entries");
  CAST_CALL(rom_check_finite("certificate/frequency", certificate->frequency, certificate->n_frequencies, err));
  CAST_CALL(rom_check_finite("certificate/time", certificate->time, certificate->n_times, err));
  for (size_t i = 0; i < certificate->n_frequencies; i++)
    CAST_CALL(check_error("certificate/transfer_bound", certificate->transfer_bound[i], err));
  for (size_t i = 0; i < certificate->n_times; i++)
    CAST_CALL(check_error("certificate/step_error", certificate->step_error[i], err));
  CAST_CALL(check_error("certificate/step_error_max", certificate->step_error_max, err));
  CAST_CALL(check_error("certificate/moment_error", certificate->moment_error, err));
  CAST_CALL(check_error("certificate/orthogonality", certificate->orthogonality, err));
  CAST_CALL(check_error("certificate/second_stage_bound", certificate->second_stage_bound, err));
  ROM_CHECK(certificate->sampled_patches >= 0, err, "certificate/sampled_patches: is %ld",
            certificate->sampled_patches);
  ROM_CHECK(!certificate->met || certificate->step_error_max <= rom->tolerance, err,
            "certificate/met: says that the tolerance %g is met, but step_error_max is %g", rom->tolerance,
            certificate->step_error_max);
  return CAST_OK;
}

CastStatus rom_check(const RomData *rom, CastError *err)
{
  CAST_CALL(check_sizes(rom, err));
  CAST_CALL(check_lambda(rom, err));
  CAST_CALL(rom_check_finite("model/constant", rom->constant, rom->r, err));
  CAST_CALL(check_patches(rom, err));
  CAST_CALL(check_inputs(rom, err));
  CAST_CALL(check_heat_capacity(rom, err));
  CAST_CALL(check_ambient(rom, err));
  CAST_CALL(check_materials(rom, err));
  CAST_CALL(check_reduction(rom, err));
  CAST_CALL(check_certificate(rom, err));
  return rom_check_geometry(rom, err);
}
