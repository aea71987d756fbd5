/* rom.h - the ROM file: the reduced thermal model of a mould, its geometry near the cavity, and its certificate.
 *
 * Model, theta = T - T_preheat (docs/theory):
 *   dz/dt = -Lambda z + B q + ambient (T_ambient - T_preheat)
 *   T_patch = T_preheat + B^T z              (C = B^T: power in equals power out)
 *   heat stored above preheat = constant^T z          [J]   (constant = V^T E 1)
 * z [r] sqrt(J K), Lambda [r] 1/s, q [m] W per patch, B [r x m] with constant^T B = 1 for each column.
 * Patches are the cavity's first, then one for each named outer surface.
 *
 * Geometry: `points` are nodes of the mould mesh: those on the boundary and those of the near-wall band. `triangles` is
 * the whole closed boundary of the mould, wound so that the normal points OUT of the mould (into the cavity or the
 * open air); `tetrahedra` are the band's. `basis` is V restricted to the points, so that T at point p is
 * T_preheat + sum_k basis[p][k] z[k].
 *
 * docs/rom-format.md describes the file field by field. */
#ifndef COMMON_ROM_ROM_H
#define COMMON_ROM_ROM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "common/error.h"

enum { ROM_FORMAT_MAJOR = 1, ROM_FORMAT_MINOR = 0, ROM_NAME_LENGTH = 64 };

typedef struct RomPatch {
  char name[ROM_NAME_LENGTH];    // "pins/12"
  char surface[ROM_NAME_LENGTH]; // the named surface it is part of: "pins"
  bool outer;                    // an outer surface of the mould, not cavity wall
  double area;                   // m2
  double centroid[3];            // m
  double h;                      // W/(m2 K), the Robin coefficient in K; 0: insulated
  bool fixed;                    // fixed temperature, applied as a Robin condition with a large h
} RomPatch;

typedef struct RomMaterial {
  char region[ROM_NAME_LENGTH], name[ROM_NAME_LENGTH];
  double conductivity, density, specific_heat; // W/(m K), kg/m3, J/(kg K)
  double reference_temperature;                // K at which they were taken; NAN: not stated
  char sha256[65];
} RomMaterial;

/* What is known of the reduction's error; relative errors have no unit. NAN: not computed. */
typedef struct RomCertificate {
  size_t n_frequencies;
  double *frequency;      // [n] rad/s, ascending, over the band 1/t_end to 1/t_start
  double *transfer_bound; // [n] upper bound of ||H(iw) - H_r(iw)||_2/||H_r(iw)||_2; log-log interpolation holds between
  size_t n_times;
  double *time;              // [n] s
  double *step_error;        // [n] max |dT| of the sampled patches at that time / largest rise, full model against ROM
  double step_error_max;     // over time in [t_start, t_end] and sampled patches: the error that `tolerance` means
  long sampled_patches;      // how many step inputs were followed
  double moment_error;       // relative difference of the moments matched; NAN unless checked
  double orthogonality;      // max |V^T E V - I|
  double second_stage_bound; // change by the second stage, K/W: a priori where balanced, else found; 0: none
  bool met;                  // step_error_max <= tolerance
} RomCertificate;

typedef struct RomProvenance { // all owned, never NULL in a file that was read
  char *program, *version, *command, *input_text, *input_path, *geometry_sha256, *created; // ISO 8601, UTC
  char *libraries, *host;
  int ranks;
  double seconds_mesh, seconds_assembly, seconds_reduction, seconds_certificate;
} RomProvenance;

typedef struct RomData {
  char *title;
  size_t r, m;          // states; patches (cavity and outer)
  size_t n_full;        // unknowns of the full model
  double *lambda;       // [r] 1/s, ascending, >= 0
  double *B;            // [r*m] row-major: B[k*m + l], sqrt(K/J)
  double *ambient;      // [r]
  double *constant;     // [r] sqrt(J/K)
  double heat_capacity; // J/K of the whole mould: 1^T E 1 = constant^T constant
  RomPatch *patch;      // [m]
  size_t n_materials;
  RomMaterial *material;

  size_t n_points;
  double *points; // [n_points*3] m
  float *basis;   // [n_points*r] row-major, K/sqrt(J K)
  size_t n_triangles;
  int32_t *triangles;      // [n_triangles*3] into points
  int32_t *triangle_patch; // [n_triangles]
  size_t n_tetrahedra;
  int32_t *tetrahedra; // [n_tetrahedra*4] into points, positive volume
  double band;         // m: the tetrahedra reach at least this far into the mould from the cavity wall

  char method[32]; // "arnoldi" or "rational"
  size_t n_shifts;
  double *shifts;        // [n_shifts] 1/s
  long moments;          // moments (or vectors an input) at each shift
  double tolerance;      // asked for
  double t_start, t_end; // s, band of times that tolerance speaks of
  double min_edge;       // m, shortest edge of a boundary triangle of the cavity
  RomCertificate certificate;
  RomProvenance provenance;
} RomData;

/* Check shapes, ranges, finiteness, Lambda >= 0, ascending order, indices, constant^T B = 1, heat capacity, a closed
 * and consistently wound boundary, positive tetrahedra. Errors: CAST_ERR_FORMAT, naming the data set and the fault. */
CastStatus rom_check(const RomData *rom, CastError *err);

/* Write to a temporary name beside `path`, then rename. Checks first. Errors: CAST_ERR_FORMAT, CAST_ERR_IO. */
CastStatus rom_write(const RomData *rom, const char *path, CastError *err);

/* Read and check; a damaged (checksum), truncated, foreign, newer or inconsistent file is refused with the reason.
 *   rom  out: caller destroys with rom_destroy; NULL on failure
 * Errors: CAST_ERR_IO, CAST_ERR_FORMAT. */
CastStatus rom_read(const char *path, RomData **rom, CastError *err);
void rom_destroy(RomData **rom);
/* The certified relative error of H(iw) at any w, rad/s, within the band; NAN outside. */
double rom_certificate_bound(const RomCertificate *certificate, double w);

#endif
