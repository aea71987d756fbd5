#include "tests/support/mould_files.h"

#include <dirent.h>
#include <gmshc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char GEO[] = "SetFactory(\"OpenCASCADE\");\n"
                          "Box(1) = {-10, -8, 0, 20, 16, 3};\n"
                          "Box(2) = {-10, -8, 3, 20, 16, 9};\n"
                          "Box(3) = {-4, -3, 7, 8, 6, 6};\n"
                          "Box(4) = {-0.6, -0.6, 4, 1.2, 1.2, 4};\n"
                          "body() = BooleanDifference{ Volume{2}; Delete; }{ Volume{3, 4}; Delete; };\n"
                          "all() = BooleanFragments{ Volume{1}; Delete; }{ Volume{body()}; Delete; };\n"
                          "e = 1e-3;\n"
                          "base() = Volume In BoundingBox{-10 - e, -8 - e, -e, 10 + e, 8 + e, 3 + e};\n"
                          "top() = Volume In BoundingBox{-10 - e, -8 - e, 3 - e, 10 + e, 8 + e, 12 + e};\n"
                          "Physical Volume(\"base\") = {base()};\n"
                          "Physical Volume(\"body\") = {top()};\n"
                          "foot() = Surface In BoundingBox{-11, -9, -e, 11, 9, e};\n"
                          "seam() = Surface In BoundingBox{-11, -9, 3 - e, 11, 9, 3 + e};\n"
                          "rim() = Surface In BoundingBox{-11, -9, 12 - e, 11, 9, 12 + e};\n"
                          "pin() = Surface In BoundingBox{-1, -1, 4 - e, 1, 1, 7 + e};\n"
                          "basin() = Surface In BoundingBox{-4 - e, -3 - e, 7 - e, 4 + e, 3 + e, 12 + e};\n"
                          "side() = Surface{:}; side() -= foot(); side() -= seam(); side() -= rim();\n"
                          "side() -= pin(); side() -= basin();\n"
                          "Physical Surface(\"foot\") = {foot()};\n"
                          "Physical Surface(\"rim\") = {rim()};\n"
                          "Physical Surface(\"pin\") = {pin()};\n"
                          "Physical Surface(\"basin\") = {basin()};\n"
                          "Physical Surface(\"side\") = {side()};\n";

const char MOULD_GROUPS[] = "  groups:\n"
                            "    base: { volumes: { low: [-11 mm, -9 mm, -1 mm], high: [11 mm, 9 mm, 3 mm] } }\n"
                            "    body: { volumes: rest }\n"
                            "    foot: { surfaces: { low: [-11 mm, -9 mm, 0 mm], high: [11 mm, 9 mm, 0 mm] } }\n"
                            "    rim: { surfaces: { low: [-11 mm, -9 mm, 12 mm], high: [11 mm, 9 mm, 12 mm] } }\n"
                            "    pin: { surfaces: { low: [-0.6 mm, -0.6 mm, 4 mm], high: [0.6 mm, 0.6 mm, 7 mm] } }\n"
                            "    basin: { surfaces: { low: [-4 mm, -3 mm, 7 mm], high: [4 mm, 3 mm, 12 mm] } }\n"
                            "    side: { surfaces: rest }\n";

static const char REGIONS[] =
    "regions:\n"
    "  base: { material: { name: steel, density: 7750 kg/m^3, specific_heat: 500 J/kg/K, conductivity: 27 W/m/K } }\n"
    "  body: { material: { name: sand, density: 1800 kg/m^3, specific_heat: 1100 J/kg/K, conductivity: 1 W/m/K } }\n"
    "boundaries:\n"
    "  side: { type: robin, h: 15 W/m^2/K }\n"
    "  rim: { type: insulated }\n"
    "  foot: { type: fixed }\n";

static const char REDUCTION[] = "reduction: { method: rational, times: [1 ms, 10 s], tolerance: 1e-2 }\n"
                                "output: { file: mould.rom.h5, band: 0.8 mm }\n";

void mould_files_write(const MouldFiles *files, const char *name, const char *text)
{
  char path[256];
  snprintf(path, sizeof path, "%s/%s", files->folder, name);
  FILE *file = fopen(path, "w");
  if (!file || fputs(text, file) < 0 || fclose(file) != 0) abort();
}

void mould_files_create(MouldFiles *files)
{
  snprintf(files->folder, sizeof files->folder, "/tmp/castmould_XXXXXX");
  if (!mkdtemp(files->folder)) abort();
  mould_files_write(files, "mould.geo", GEO);
}

void mould_files_convert(const MouldFiles *files, const char *name, const char *options)
{
  char path[256];
  int ierr;
  mould_files_write(files, "options.geo", options);
  gmshInitialize(0, NULL, 0, &ierr);
  gmshOptionSetNumber("General.Terminal", 0, &ierr);
  snprintf(path, sizeof path, "%s/mould.geo", files->folder);
  gmshOpen(path, &ierr);
  if (ierr) abort();
  snprintf(path, sizeof path, "%s/options.geo", files->folder);
  if (options[0]) gmshMerge(path, &ierr);
  if (strstr(name, ".msh")) gmshModelMeshGenerate(3, &ierr);
  if (ierr) abort();
  snprintf(path, sizeof path, "%s/%s", files->folder, name);
  gmshWrite(path, &ierr);
  if (ierr) abort();
  gmshFinalize(&ierr);
}

void mould_files_remove(MouldFiles *files)
{
  DIR *folder = opendir(files->folder);
  if (!folder) return;
  for (struct dirent *entry = readdir(folder); entry; entry = readdir(folder)) {
    char path[512];
    snprintf(path, sizeof path, "%s/%.250s", files->folder, entry->d_name);
    if (entry->d_name[0] != '.') unlink(path);
  }
  closedir(folder);
  rmdir(files->folder);
}

static char yaml[8192];

const char *mould_files_yaml(const char *name, const char *geometry_lines)
{
  snprintf(yaml, sizeof yaml,
           "title: block with a basin and a pin\n"
           "geometry:\n  file: %s\n%s%s"
           "cavity:\n  surfaces:\n"
           "    basin: { patch_size: 3 mm, mesh_size: 0.8 mm }\n"
           "    pin: { one_patch: true, mesh_size: 0.4 mm }\n"
           "mesh: { outside_size: 3 mm, growth: 0.4 }\n%s",
           name, geometry_lines, REGIONS, REDUCTION);
  return yaml;
}

const char *mould_files_yaml_of_mesh(const char *name, const char *geometry_lines)
{
  snprintf(yaml, sizeof yaml,
           "geometry:\n  file: %s\n%s%s"
           "cavity: { surfaces: { basin: { patch_size: 3 mm }, pin: { one_patch: true } } }\n%s",
           name, geometry_lines, REGIONS, REDUCTION);
  return yaml;
}

MouldFiles mould_files;

int mould_files_set_up(void **state)
{
  (void)state;
  mould_files_create(&mould_files);
  return 0;
}

int mould_files_clean_up(void **state)
{
  (void)state;
  mould_files_remove(&mould_files);
  return 0;
}

const char *mould_files_path(const char *name)
{
  static char path[256];
  snprintf(path, sizeof path, "%s/%s", mould_files.folder, name);
  return path;
}
