#include "tests/support/voxel_mould.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *synthetic_array(size_t n, size_t size)
{
  void *array = calloc(n > 0 ? n : 1, size);
  if (!array) abort();
  return array;
}

VoxelMould voxel_mould_create(const size_t n[3], double *const lines[3])
{
  VoxelMould mould = {0};
  const size_t cells = n[0] * n[1] * n[2];
  for (int d = 0; d < 3; d++) {
    mould.n[d] = n[d];
    mould.lines[d] = lines[d];
  }
  mould.solid = synthetic_array(cells, 1);
  mould.band = synthetic_array(cells, 1);
  memset(mould.solid, 1, cells);
  return mould;
}

void voxel_mould_destroy(VoxelMould *mould)
{
  for (int d = 0; d < 3; d++) free(mould->lines[d]);
  free(mould->solid);
  free(mould->band);
  *mould = (VoxelMould){0};
}

size_t voxel_cell(const VoxelMould *mould, size_t i, size_t j, size_t k)
{
  return i + mould->n[0] * (j + mould->n[1] * k);
}

typedef struct Builder {
  const VoxelMould *mould;
  RomData *rom;
  int32_t *point_of_node; // [nodes] index into rom->points + 1; 0: not used
} Builder;

static int32_t use_node(Builder *builder, const size_t at[3])
{
  const VoxelMould *mould = builder->mould;
  RomData *rom = builder->rom;
  int32_t *point = &builder->point_of_node[at[0] + (mould->n[0] + 1) * (at[1] + (mould->n[1] + 1) * at[2])];
  if (*point == 0) {
    for (size_t d = 0; d < 3; d++) rom->points[3 * rom->n_points + d] = mould->lines[d][at[d]];
    *point = (int32_t)++rom->n_points;
  }
  return *point - 1;
}

/* Is there void on that side of the cell? `inside`: within the grid. */
static bool looks_at_void(const VoxelMould *mould, const size_t cell[3], int axis, int sign, bool *inside)
{
  *inside = sign > 0 ? cell[axis] + 1 < mould->n[axis] : cell[axis] > 0;
  if (!*inside) return true;
  size_t next[3] = {cell[0], cell[1], cell[2]};
  next[axis] = sign > 0 ? cell[axis] + 1 : cell[axis] - 1;
  return !mould->solid[voxel_cell(mould, next[0], next[1], next[2])];
}

static void add_face(Builder *builder, const size_t cell[3], int axis, int sign, int32_t patch)
{
  RomData *rom = builder->rom;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  int32_t corner[4]; // anticlockwise seen from +axis; the diagonal 0-2 is the cell's own (Kuhn)
  for (int q = 0; q < 4; q++) {
    size_t node[3] = {cell[0], cell[1], cell[2]};
    node[axis] += sign > 0;
    node[u] += q == 1 || q == 2;
    node[v] += q >= 2;
    corner[q] = use_node(builder, node);
  }
  for (int half = 0; half < 2; half++) {
    int32_t *triangle = rom->triangles + 3 * rom->n_triangles;
    triangle[0] = corner[0];
    triangle[sign > 0 ? 1 : 2] = corner[half + 1];
    triangle[sign > 0 ? 2 : 1] = corner[half + 2];
    rom->triangle_patch[rom->n_triangles++] = patch;
  }
}

static void add_tetrahedra(Builder *builder, const size_t cell[3])
{
  static const int paths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                  {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}; // first three: even
  RomData *rom = builder->rom;
  for (int path = 0; path < 6; path++) {
    size_t node[3] = {cell[0], cell[1], cell[2]};
    int32_t corner[4] = {use_node(builder, node), 0, 0, 0};
    for (int step = 0; step < 3; step++) {
      node[paths[path][step]]++;
      corner[step + 1] = use_node(builder, node);
    }
    if (path >= 3) {
      const int32_t swap = corner[1];
      corner[1] = corner[2];
      corner[2] = swap;
    }
    memcpy(rom->tetrahedra + 4 * rom->n_tetrahedra++, corner, sizeof corner);
  }
}

static double triangle_area(const RomData *rom, const int32_t *triangle)
{
  double u[3], v[3], square = 0.0;
  for (size_t d = 0; d < 3; d++) {
    u[d] = rom->points[3 * (size_t)triangle[1] + d] - rom->points[3 * (size_t)triangle[0] + d];
    v[d] = rom->points[3 * (size_t)triangle[2] + d] - rom->points[3 * (size_t)triangle[0] + d];
  }
  for (size_t d = 0; d < 3; d++) {
    const double w = u[(d + 1) % 3] * v[(d + 2) % 3] - u[(d + 2) % 3] * v[(d + 1) % 3];
    square += w * w;
  }
  return 0.5 * sqrt(square);
}

static void measure_patches(RomData *rom)
{
  rom->min_edge = DBL_MAX;
  for (size_t t = 0; t < rom->n_triangles; t++) {
    const int32_t *triangle = rom->triangles + 3 * t;
    RomPatch *patch = &rom->patch[rom->triangle_patch[t]];
    const double area = triangle_area(rom, triangle);
    patch->area += area;
    for (size_t k = 0; k < 3; k++) {
      double square = 0.0;
      for (size_t d = 0; d < 3; d++) {
        const double x = rom->points[3 * (size_t)triangle[k] + d];
        patch->centroid[d] += area * x / 3.0;
        square += pow(rom->points[3 * (size_t)triangle[(k + 1) % 3] + d] - x, 2.0);
      }
      if (!patch->outer) rom->min_edge = fmin(rom->min_edge, sqrt(square));
    }
  }
  for (size_t l = 0; l < rom->m; l++)
    for (int d = 0; d < 3; d++) rom->patch[l].centroid[d] /= rom->patch[l].area;
}

static void build_cell(Builder *builder, const size_t cell[3],
                       int32_t (*patch_of)(const void *context, const VoxelFace *face), const void *context)
{
  const VoxelMould *mould = builder->mould;
  VoxelFace face;
  for (face.axis = 0; face.axis < 3; face.axis++)
    for (face.sign = -1; face.sign <= 1; face.sign += 2) {
      if (!looks_at_void(mould, cell, face.axis, face.sign, &face.inside)) continue;
      for (int d = 0; d < 3; d++) {
        face.low[d] = mould->lines[d][cell[d] + (d == face.axis && face.sign > 0)];
        face.high[d] = mould->lines[d][cell[d] + (d != face.axis || face.sign > 0)];
      }
      add_face(builder, cell, face.axis, face.sign, patch_of(context, &face));
    }
  if (mould->band[voxel_cell(mould, cell[0], cell[1], cell[2])]) add_tetrahedra(builder, cell);
}

void voxel_mould_geometry(const VoxelMould *mould, int32_t (*patch_of)(const void *context, const VoxelFace *face),
                          const void *context, RomData *rom)
{
  const size_t *n = mould->n, cells = n[0] * n[1] * n[2], nodes = (n[0] + 1) * (n[1] + 1) * (n[2] + 1);
  Builder builder = {mould, rom, synthetic_array(nodes, sizeof(int32_t))};
  rom->points = synthetic_array(3 * nodes, sizeof(double));
  rom->triangles = synthetic_array(36 * cells, sizeof(int32_t));
  rom->triangle_patch = synthetic_array(12 * cells, sizeof(int32_t));
  rom->tetrahedra = synthetic_array(24 * cells, sizeof(int32_t));
  size_t cell[3];
  for (cell[2] = 0; cell[2] < n[2]; cell[2]++)
    for (cell[1] = 0; cell[1] < n[1]; cell[1]++)
      for (cell[0] = 0; cell[0] < n[0]; cell[0]++)
        if (mould->solid[voxel_cell(mould, cell[0], cell[1], cell[2])]) build_cell(&builder, cell, patch_of, context);
  free(builder.point_of_node);
  measure_patches(rom);
}

static char *copy_text(const char *text)
{
  char *copy = synthetic_array(strlen(text) + 1, 1);
  return strcpy(copy, text);
}

void synthetic_particulars(RomData *rom, const char *title, double kappa, double rho, double c)
{
  rom->title = copy_text(title);
  rom->n_materials = 1;
  rom->material = synthetic_array(1, sizeof *rom->material);
  RomMaterial *material = rom->material;
  snprintf(material->region, sizeof material->region, "mould");
  snprintf(material->name, sizeof material->name, "synthetic");
  material->conductivity = kappa;
  material->density = rho;
  material->specific_heat = c;
  material->reference_temperature = NAN;
  snprintf(rom->method, sizeof rom->method, "modal");
  rom->n_full = rom->r;
  rom->moments = 0;
  rom->tolerance = 1e-3;
  rom->t_start = 1e-3;
  rom->t_end = 100.0;
  rom->shifts = synthetic_array(1, sizeof(double));
  RomCertificate *certificate = &rom->certificate;
  certificate->frequency = synthetic_array(1, sizeof(double));
  certificate->transfer_bound = synthetic_array(1, sizeof(double));
  certificate->time = synthetic_array(1, sizeof(double));
  certificate->step_error = synthetic_array(1, sizeof(double));
  certificate->step_error_max = certificate->moment_error = certificate->orthogonality = NAN;
  RomProvenance *provenance = &rom->provenance;
  char **texts[] = {&provenance->program,    &provenance->version,    &provenance->command,
                    &provenance->input_text, &provenance->input_path, &provenance->geometry_sha256,
                    &provenance->created,    &provenance->libraries,  &provenance->host};
  for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) *texts[i] = copy_text("");
  provenance->ranks = 1;
}
