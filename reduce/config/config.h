/* config.h - mould.yaml, parsed once into a const struct. Same on every rank (each rank parses the text that rank 0
 * read and broadcast). docs/user-guide describes the file. */
#ifndef REDUCE_CONFIG_CONFIG_H
#define REDUCE_CONFIG_CONFIG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include "common/material/material.h"

enum { NAME_LENGTH = 64 };

typedef enum BoundaryKind { BOUNDARY_ROBIN, BOUNDARY_INSULATED, BOUNDARY_FIXED } BoundaryKind;

typedef enum GeometryKind { GEOMETRY_GEO, GEOMETRY_STEP, GEOMETRY_BREP, GEOMETRY_MESH, GEOMETRY_STL } GeometryKind;

typedef struct RegionConfig { // a named volume and what it is made of
  char name[NAME_LENGTH];
  Material material;
} RegionConfig;

typedef struct BoundaryConfig { // a named outer surface
  char name[NAME_LENGTH];
  BoundaryKind kind;
  double h;          // W/(m2 K)
  double patch_size; // m, edge of the square of a patch's target area; 0: one patch for the whole surface
} BoundaryConfig;

typedef enum LayersKind { LAYERS_NONE, LAYERS_AUTO, LAYERS_GIVEN } LayersKind;

typedef struct LayersConfig { // thin layers of elements at the wall
  LayersKind kind;
  double first;  // m, height of the first; 0: from the thermal depth at t_start
  double growth; // of each layer over the one before
  int count;     // at most
} LayersConfig;

typedef struct CavitySurfaceConfig { // a named part of the cavity wall
  char name[NAME_LENGTH];
  double patch_size; // m, edge of the square of a patch's target area; 0: one patch for the whole surface
  double mesh_size;  // m, at this surface
  LayersConfig layers;
} CavitySurfaceConfig;

typedef struct GroupConfig { // names for a geometry that has none (STEP): entities by tag or by bounding box
  char name[NAME_LENGTH];
  int dimension; // 2 or 3
  size_t n_tags;
  int *tags;
  bool has_box;
  double box[6]; // m: xmin ymin zmin xmax ymax zmax, entities wholly inside
  bool rest;     // all volumes, or all boundary surfaces, that no other group holds
} GroupConfig;

typedef enum FlaskKind { FLASK_NONE, FLASK_BLOCK, FLASK_CYLINDER } FlaskKind;

typedef struct FlaskConfig { // the mould about an STL file's cavity; its axis is z
  FlaskKind kind;
  double corner[3], size[3];      // m, of a block: least corner
  double base[3], radius, height; // m, of a cylinder: middle of its bottom
} FlaskConfig;

typedef enum ReductionMethod { REDUCTION_RATIONAL, REDUCTION_ARNOLDI, REDUCTION_MODAL } ReductionMethod;

typedef enum ReductionBasis { BASIS_AUTOMATIC, BASIS_MEMORY, BASIS_DISK } ReductionBasis;

typedef struct ReductionConfig {
  ReductionMethod method;
  double t_start, t_end; // s
  double tolerance;      // of patch temperatures over their largest rise
  long moments;          // arnoldi: q at s0
  double s0;             // 1/s, arnoldi's expansion point
  long modes;            // modal: how many of the slowest; 0: five an input
  size_t n_shifts;       // rational: 0 = chosen by the program
  double *shifts;        // 1/s
  double deflation;      // relative size below which a direction is dropped
  bool second_stage;     // balanced second stage
  double early_weight;   // its p: 0 balanced truncation, with an a-priori bound; above 0 the early response counts more
  double solver_rtol;    // of iterative solves
  bool iterative;        // force CG + AMG; default: by size
  ReductionBasis basis;  // rational: where its vectors are kept; automatic: by their size
  char *scratch;         // folder for them, beside the ROM file; NULL (tests): in memory
} ReductionConfig;

typedef struct MatricesConfig { // a model that another program has assembled, as Matrix Market files
  char *E, *K, *B, *C;          // resolved against the input file's folder; C NULL: B^T
  bool K_is_A;                  // the file K holds A = -K
  bool flux;                    // the columns of B are those of a flux, W/m2, not of watts
} MatricesConfig;

typedef struct ReduceConfig {
  char *title;
  MatricesConfig *matrices;   // instead of geometry, regions, boundaries, cavity and mesh; NULL: from geometry
  char *geometry_path;        // resolved against the input file's folder
  GeometryKind geometry_kind; // by the file's extension
  double geometry_unit;       // m: length of one unit of the geometry's numbers
  char geometry_sha256[65];   // of the geometry file; of the matrix files' digests one after the other
  FlaskConfig flask;
  double split_angle; // rad, STL: where faces meet at a larger one is an edge
  size_t n_groups;
  GroupConfig *group;
  size_t n_regions;
  RegionConfig *region;
  size_t n_boundaries;
  BoundaryConfig *boundary;
  size_t n_cavity;
  CavitySurfaceConfig *cavity;
  double contact;      // W/(m2 K), the best contact with the melt that is expected; 0: perfect
  double outside_size; // m, mesh size far from the cavity
  double growth;       // size gained per length away from the cavity wall: size = cavity size + growth * distance
  double band;         // m, thickness of the near-wall band kept in the ROM
  double basis_budget; // bytes that the basis on the near-wall points may take: a thinner band is kept where it would
                       // take more
  int order;           // of the elements: 1 or 2
  ReductionConfig reduction;
  char *rom_path; // resolved against the input file's folder
  char *input_path, *input_text;
} ReduceConfig;

/* Errors: CAST_ERR_INPUT with all faults, one a line. `text` NULL: read the file. */
CastStatus reduce_config_read(const char *path, const char *text, ReduceConfig **config, CastError *err);
void reduce_config_destroy(ReduceConfig **config);
/* Everything as it was understood, in SI, one setting a line. */
void reduce_config_print(const ReduceConfig *config, FILE *out);
const char *reduce_config_method(ReductionMethod method); // "rational" and so on
/* Of a basis' solves, where the input gives none; iterative: no factor may be made. */
double reduce_config_solver_rtol(double tolerance, bool iterative);
/* A named surface by its index: the cavity's come first, then the outer ones. */
const char *reduce_config_surface_name(const ReduceConfig *config, size_t surface);

#endif
