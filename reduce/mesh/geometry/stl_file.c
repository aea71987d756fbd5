#include "reduce/mesh/geometry/stl_file.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER = 80, RECORD = 50 }; // bytes of a binary file

typedef struct Reader {
  const char *path, *text, *end, *at;
  int line;
  StlSurface *surface; // its points are still three for each triangle
  size_t capacity;
} Reader;

static CastStatus reserve_triangle(Reader *reader, CastError *err)
{
  StlSurface *surface = reader->surface;
  if (surface->n_triangles < reader->capacity) return CAST_OK;
  const size_t n = 2 * reader->capacity + 256;
  CAST_CHECK(n < INT32_MAX / 9, err, CAST_ERR_INPUT, "'%s' has too many triangles", reader->path);
  double *x = realloc(surface->x, 9 * n * sizeof *x);
  if (x) surface->x = x;
  int32_t *solid = realloc(surface->solid, n * sizeof *solid);
  if (solid) surface->solid = solid;
  CAST_CHECK(x && solid, err, CAST_ERR_MEMORY, "no memory for '%s'", reader->path);
  reader->capacity = n;
  return CAST_OK;
}

static CastStatus add_solid(Reader *reader, const char *name, size_t length, CastError *err)
{
  StlSurface *surface = reader->surface;
  char(*names)[STL_NAME] = realloc(surface->name, (surface->n_solids + 1) * sizeof *names);
  CAST_CHECK(names, err, CAST_ERR_MEMORY, "no memory for '%s'", reader->path);
  surface->name = names;
  snprintf(names[surface->n_solids++], STL_NAME, "%.*s", (int)(length < STL_NAME ? length : STL_NAME - 1), name);
  return CAST_OK;
}

/* --- text --- */

static bool next_word(Reader *reader, const char **word, size_t *length)
{
  while (reader->at < reader->end && isspace((unsigned char)*reader->at)) reader->line += *reader->at++ == '\n';
  *word = reader->at;
  while (reader->at < reader->end && !isspace((unsigned char)*reader->at)) reader->at++;
  *length = (size_t)(reader->at - *word);
  return *length > 0;
}

static bool is_word(const char *word, size_t length, const char *expected)
{
  if (strlen(expected) != length) return false;
  for (size_t i = 0; i < length; i++)
    if (tolower((unsigned char)word[i]) != expected[i]) return false;
  return true;
}

static CastStatus expect(Reader *reader, const char *expected, CastError *err)
{
  const char *word = "";
  size_t length = 0;
  next_word(reader, &word, &length);
  CAST_CHECK(is_word(word, length, expected), err, CAST_ERR_INPUT, "%s:%d: '%.*s' where '%s' is expected", reader->path,
             reader->line, (int)(length < 40 ? length : 40), word, expected);
  return CAST_OK;
}

static CastStatus read_numbers(Reader *reader, size_t n, double *value, CastError *err)
{
  for (size_t i = 0; i < n; i++) {
    const char *word = "";
    char copy[64], *stop = copy;
    size_t length = 0;
    next_word(reader, &word, &length);
    snprintf(copy, sizeof copy, "%.*s", (int)(length < 63 ? length : 63), word);
    value[i] = strtod(copy, &stop);
    CAST_CHECK(length > 0 && length < 64 && *stop == '\0' && isfinite(value[i]), err, CAST_ERR_INPUT,
               "%s:%d: '%s' where a number is expected", reader->path, reader->line, copy);
  }
  return CAST_OK;
}

/* The rest of the line is the solid's name. */
static CastStatus read_solid_name(Reader *reader, CastError *err)
{
  const char *from = reader->at;
  while (reader->at < reader->end && *reader->at != '\n') reader->at++;
  const char *to = reader->at;
  while (from < to && isspace((unsigned char)*from)) from++;
  while (to > from && isspace((unsigned char)to[-1])) to--;
  return add_solid(reader, from, (size_t)(to - from), err);
}

static CastStatus read_facet(Reader *reader, CastError *err)
{
  double normal[3];
  CAST_CALL(reserve_triangle(reader, err));
  CAST_CALL(expect(reader, "normal", err));
  CAST_CALL(read_numbers(reader, 3, normal, err));
  CAST_CALL(expect(reader, "outer", err));
  CAST_CALL(expect(reader, "loop", err));
  for (size_t k = 0; k < 3; k++) {
    CAST_CALL(expect(reader, "vertex", err));
    CAST_CALL(read_numbers(reader, 3, reader->surface->x + 9 * reader->surface->n_triangles + 3 * k, err));
  }
  CAST_CALL(expect(reader, "endloop", err));
  CAST_CALL(expect(reader, "endfacet", err));
  reader->surface->solid[reader->surface->n_triangles++] = (int32_t)reader->surface->n_solids - 1;
  return CAST_OK;
}

static CastStatus read_text(Reader *reader, CastError *err)
{
  const char *word;
  size_t length;
  bool inside = false;
  while (next_word(reader, &word, &length)) {
    if (!inside && is_word(word, length, "solid")) {
      CAST_CALL(read_solid_name(reader, err));
      inside = true;
    } else if (inside && is_word(word, length, "facet")) {
      CAST_CALL(read_facet(reader, err));
    } else if (inside && is_word(word, length, "endsolid")) {
      while (reader->at < reader->end && *reader->at != '\n') reader->at++;
      inside = false;
    } else {
      return cast_error_set(err, CAST_ERR_INPUT, "%s:%d: '%.*s' where '%s' is expected", reader->path, reader->line,
                            (int)(length < 40 ? length : 40), word, inside ? "facet' or 'endsolid" : "solid");
    }
  }
  CAST_CHECK(!inside, err, CAST_ERR_INPUT, "%s:%d: the file ends inside a solid: 'endsolid' is missing", reader->path,
             reader->line);
  return CAST_OK;
}

/* --- binary: 80 bytes, the number of triangles, and for each normal, three corners (float) and two bytes --- */

static uint32_t little_endian(const char *byte)
{
  uint32_t value = 0;
  for (int i = 3; i >= 0; i--) value = value << 8 | (unsigned char)byte[i];
  return value;
}

static bool is_binary(const Reader *reader)
{
  const size_t size = (size_t)(reader->end - reader->text);
  return size >= HEADER + 4 && size == HEADER + 4 + (size_t)RECORD * little_endian(reader->text + HEADER);
}

static CastStatus read_binary(Reader *reader, CastError *err)
{
  const size_t n = little_endian(reader->text + HEADER);
  CAST_CALL(add_solid(reader, "", 0, err));
  for (size_t t = 0; t < n; t++) {
    CAST_CALL(reserve_triangle(reader, err));
    const char *record = reader->text + HEADER + 4 + RECORD * t;
    for (size_t i = 0; i < 9; i++) {
      const uint32_t bits = little_endian(record + 12 + 4 * i);
      float value;
      memcpy(&value, &bits, sizeof value);
      CAST_CHECK(isfinite(value), err, CAST_ERR_INPUT,
                 "'%s': triangle %zu (byte %zu) has a coordinate that is no number", reader->path, t + 1,
                 HEADER + 4 + RECORD * t + 12 + 4 * i);
      reader->surface->x[9 * t + i] = (double)value;
    }
    reader->surface->solid[t] = 0;
    reader->surface->n_triangles++;
  }
  return CAST_OK;
}

/* --- points --- */

typedef struct Corner {
  double x[3];
  size_t from;
} Corner;

static int by_place(const void *left, const void *right)
{
  const Corner *a = left, *b = right;
  for (int d = 0; d < 3; d++)
    if (a->x[d] != b->x[d]) return a->x[d] < b->x[d] ? -1 : 1;
  return (a->from > b->from) - (a->from < b->from);
}

/* Corners of the very same coordinates: an STL file repeats the numbers of a point in each of its triangles. */
static CastStatus join_points(StlSurface *surface, CastError *err)
{
  const size_t n = 3 * surface->n_triangles;
  Corner *corner = malloc((n + 1) * sizeof *corner);
  surface->triangle = malloc((n + 1) * sizeof *surface->triangle);
  if (!corner || !surface->triangle) {
    free(corner);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for the STL file's points");
  }
  for (size_t i = 0; i < n; i++) {
    corner[i].from = i;
    for (size_t d = 0; d < 3; d++) corner[i].x[d] = surface->x[3 * i + d] + 0.0; // -0 is 0
  }
  qsort(corner, n, sizeof *corner, by_place);
  for (size_t i = 0; i < n; i++) {
    if (i == 0 || memcmp(corner[i].x, corner[i - 1].x, sizeof corner[i].x) != 0)
      memcpy(surface->x + 3 * surface->n_points++, corner[i].x, sizeof corner[i].x);
    surface->triangle[corner[i].from] = (int32_t)surface->n_points - 1;
  }
  free(corner);
  return CAST_OK;
}

static CastStatus load(const char *path, char **text, size_t *size, CastError *err)
{
  FILE *file = fopen(path, "rb");
  CAST_CHECK(file, err, CAST_ERR_IO, "'%s' cannot be opened", path);
  long length = -1;
  if (fseek(file, 0, SEEK_END) == 0) length = ftell(file);
  rewind(file);
  *text = length >= 0 ? malloc((size_t)length + 1) : NULL;
  *size = *text ? fread(*text, 1, (size_t)length, file) : 0;
  fclose(file);
  CAST_CHECK(*text && *size == (size_t)length, err, CAST_ERR_IO, "'%s' cannot be read", path);
  return CAST_OK;
}

CastStatus stl_read(const char *path, StlSurface **surface, CastError *err)
{
  char *text = NULL;
  size_t size = 0;
  *surface = NULL;
  CAST_CALL(load(path, &text, &size, err));
  StlSurface *made = calloc(1, sizeof *made);
  Reader reader = {.path = path, .text = text, .at = text, .end = text + size, .line = 1, .surface = made};
  CastStatus status = CAST_ERR_MEMORY;
  if (!made)
    cast_error_set(err, CAST_ERR_MEMORY, "no memory for '%s'", path);
  else
    status = is_binary(&reader) ? read_binary(&reader, err) : read_text(&reader, err);
  if (status == CAST_OK && made->n_triangles == 0)
    status = cast_error_set(err, CAST_ERR_INPUT, "'%s' has no triangles", path);
  if (status == CAST_OK) status = join_points(made, err);
  free(text);
  if (status != CAST_OK) stl_destroy(&made);
  *surface = made;
  return status;
}

void stl_destroy(StlSurface **surface)
{
  if (!surface || !*surface) return;
  free((*surface)->x);
  free((*surface)->triangle);
  free((*surface)->solid);
  free((*surface)->name);
  free(*surface);
  *surface = NULL;
}
