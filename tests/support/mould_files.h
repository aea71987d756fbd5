/* mould_files.h - a small mould as files in a temporary folder: a block with a box-shaped cavity, open at the top, and
 * a square pin below it, in two regions. Lengths in mm; all faces flat, so volumes and areas are exact. */
#ifndef TESTS_SUPPORT_MOULD_FILES_H
#define TESTS_SUPPORT_MOULD_FILES_H

#include "reduce/config/config.h"

typedef struct MouldFiles {
  char folder[64];
} MouldFiles;

/* mm2 and mm3 of the mould */
#define MOULD_VOLUME (20.0 * 16.0 * 12.0 - 8.0 * 6.0 * 5.0 - 1.2 * 1.2 * 3.0)
#define MOULD_FOOT_VOLUME (20.0 * 16.0 * 3.0)
#define MOULD_BASIN_AREA (2.0 * (8.0 + 6.0) * 5.0 + 8.0 * 6.0 - 1.2 * 1.2)
#define MOULD_PIN_AREA (4.0 * 1.2 * 3.0 + 1.2 * 1.2)
#define MOULD_RIM_AREA (20.0 * 16.0 - 8.0 * 6.0)
#define MOULD_SIDE_AREA (2.0 * (20.0 + 16.0) * 12.0)
#define MOULD_FOOT_AREA (20.0 * 16.0)

/* Make the folder with mould.geo; aborts the test if that fails. */
void mould_files_create(MouldFiles *files);
/* mould.step, mould.brep or mould.msh from mould.geo; options: gmsh statements (may be "") run before meshing. */
void mould_files_convert(const MouldFiles *files, const char *name, const char *options);
/* Write `text` as the folder's file `name`. */
void mould_files_write(const MouldFiles *files, const char *name, const char *text);
void mould_files_remove(MouldFiles *files);

/* One folder for all tests of a program, made and removed by cmocka's group; the path of a file in it, valid until the
 * next call. */
extern MouldFiles mould_files;
int mould_files_set_up(void **state);
int mould_files_clean_up(void **state);
const char *mould_files_path(const char *name);

/* A whole mould.yaml for the geometry file `name`; `unit`: line(s) for the geometry section, such as "unit: mm\n". */
const char *mould_files_yaml(const char *name, const char *geometry_lines);
/* The same without what only a mesher needs, for ready meshes. */
const char *mould_files_yaml_of_mesh(const char *name, const char *geometry_lines);
/* Groups that name the parts of mould.step and mould.brep, as lines of the geometry section. */
extern const char MOULD_GROUPS[];

#endif
