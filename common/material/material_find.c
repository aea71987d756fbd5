/* material_find.c - which file a material's name means. */
#include "common/material/material_private.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "cast_build_config.h"

enum { MAX_NAMES = 256, NAME_SIZE = 64 };

static bool file_exists(const char *path)
{
  struct stat info;
  return stat(path, &info) == 0 && S_ISREG(info.st_mode);
}

static int by_name(const void *a, const void *b)
{
  return strcmp(a, b);
}

/* Append the names of the materials in the folder. */
static size_t list_folder(const char *folder, char (*names)[NAME_SIZE], size_t n)
{
  DIR *directory = opendir(folder);
  if (!directory) return n;
  const struct dirent *entry;
  while ((entry = readdir(directory)) && n < MAX_NAMES) {
    const size_t length = strlen(entry->d_name);
    if (length <= 5 || length - 5 >= NAME_SIZE || strcmp(entry->d_name + length - 5, ".yaml") != 0) continue;
    memcpy(names[n], entry->d_name, length - 5);
    names[n++][length - 5] = '\0';
  }
  closedir(directory);
  return n;
}

static void unknown_name(YamlNode node, const char *name, const char *const *folders, size_t n_folders)
{
  char names[MAX_NAMES][NAME_SIZE], list[1024] = "none at all", folder[4096];
  size_t n = 0;
  for (size_t i = 0; i < n_folders; i++) {
    if (!folders[i]) continue;
    snprintf(folder, sizeof folder, "%s/materials", folders[i]);
    n = list_folder(folder, names, n);
  }
  qsort(names, n, NAME_SIZE, by_name);
  size_t used = 0;
  for (size_t i = 0; i < n && used < sizeof list; i++)
    if (i == 0 || strcmp(names[i], names[i - 1]) != 0)
      used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", names[i]);
  yaml_problem(node, "there is no material '%s'; known by name: %s (or give a path beside this file, ending in .yaml)",
               name, list);
}

bool material_find_file(YamlNode node, const char *name, char *path, size_t size)
{
  if (strchr(name, '/') || strstr(name, ".yaml")) {
    const char *input = yaml_input_path(node.input);
    const char *slash = strrchr(input, '/');
    const int folder = slash && name[0] != '/' ? (int)(slash - input) + 1 : 0;
    snprintf(path, size, "%.*s%s", folder, input, name);
    if (file_exists(path)) return true;
    yaml_problem(node, "there is no file '%s'", path);
    return false;
  }
  const char *const folders[] = {getenv("CAST_SHARE"), CAST_SHARE_INSTALLED, CAST_SHARE_SOURCE};
  enum { N_FOLDERS = sizeof folders / sizeof *folders };
  for (size_t i = 0; i < N_FOLDERS; i++) {
    if (!folders[i]) continue;
    snprintf(path, size, "%s/materials/%s.yaml", folders[i], name);
    if (file_exists(path)) return true;
  }
  unknown_name(node, name, folders, N_FOLDERS);
  return false;
}
