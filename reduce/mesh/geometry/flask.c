#include "reduce/mesh/geometry/flask.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CIRCLE = 36 }; // corners of the polygon that stands for a cylinder's circle; it has the circle's area

const char *const FLASK_NAMES[FLASK_SIDES] = {"top", "bottom", "side"};

typedef struct Prism { // the flask, in the file's unit
  size_t n, levels;    // corners of its base; rings of quadrangles round it
  double base[CIRCLE][2];
  double low, high, area;
} Prism;

static Prism prism_of(const FlaskConfig *config, double unit)
{
  Prism prism = {.levels = 1};
  if (config->kind == FLASK_BLOCK) {
    prism.n = 4;
    for (size_t i = 0; i < 4; i++) {
      prism.base[i][0] = (config->corner[0] + (i == 1 || i == 2 ? config->size[0] : 0.0)) / unit;
      prism.base[i][1] = (config->corner[1] + (i >= 2 ? config->size[1] : 0.0)) / unit;
    }
    prism.low = config->corner[2] / unit;
    prism.high = (config->corner[2] + config->size[2]) / unit;
    prism.area = config->size[0] * config->size[1] / unit / unit;
    return prism;
  }
  const double corner = 2.0 * M_PI / CIRCLE, radius = config->radius / unit * sqrt(corner / sin(corner));
  prism.n = CIRCLE;
  prism.levels = (size_t)fmax(1.0, round(config->height / (corner * config->radius) / 2.0));
  for (size_t i = 0; i < CIRCLE; i++) {
    prism.base[i][0] = config->base[0] / unit + radius * cos(corner * (double)i);
    prism.base[i][1] = config->base[1] / unit + radius * sin(corner * (double)i);
  }
  prism.low = config->base[2] / unit;
  prism.high = (config->base[2] + config->height) / unit;
  prism.area = M_PI * config->radius * config->radius / unit / unit;
  return prism;
}

/* How far a point lies inside the sides; negative: outside. The base is convex and runs against the clock. */
static double depth_of(const Prism *prism, const double x[3])
{
  double least = DBL_MAX;
  for (size_t i = 0; i < prism->n; i++) {
    const double *a = prism->base[i], *b = prism->base[(i + 1) % prism->n];
    const double u = b[0] - a[0], v = b[1] - a[1];
    least = fmin(least, (u * (x[1] - a[1]) - v * (x[0] - a[0])) / hypot(u, v));
  }
  return least;
}

static CastStatus check_within(const Prism *prism, const StlSurface *body, double unit, CastError *err)
{
  const double slack = 1e-6 * (prism->high - prism->low), mm = 1e3 * unit;
  for (size_t i = 0; i < body->n_points; i++) {
    const double *x = body->x + 3 * i;
    CAST_CHECK(depth_of(prism, x) > slack && x[2] > prism->low + slack, err, CAST_ERR_INPUT,
               "geometry.flask: the cavity reaches the flask's %s at (%.6g, %.6g, %.6g) mm: mould material is expected "
               "there; only the top may be open",
               x[2] > prism->low + slack ? "side" : "bottom", x[0] * mm, x[1] * mm, x[2] * mm);
    CAST_CHECK(
        x[2] < prism->high + slack, err, CAST_ERR_INPUT,
        "geometry.flask: the cavity stands out of the flask's top, z = %.6g mm, at (%.6g, %.6g, %.6g) mm: cut it "
        "off there, or make the flask higher",
        prism->high * mm, x[0] * mm, x[1] * mm, x[2] * mm);
  }
  return CAST_OK;
}

static void add_triangle(RemeshSurface *flask, const int32_t points[3], bool turn, int32_t origin)
{
  int32_t *to = flask->triangle + 3 * flask->n_triangles;
  to[0] = points[0];
  to[1] = points[turn ? 2 : 1];
  to[2] = points[turn ? 1 : 2];
  flask->tag[flask->n_triangles++] = origin;
}

static CastStatus reserve(RemeshSurface *flask, size_t points, size_t triangles, CastError *err)
{
  double *x = realloc(flask->x, 3 * (flask->n_points + points + 1) * sizeof *x);
  if (x) flask->x = x;
  int32_t *triangle = realloc(flask->triangle, 3 * (flask->n_triangles + triangles + 1) * sizeof *triangle);
  if (triangle) flask->triangle = triangle;
  int32_t *tag = realloc(flask->tag, (flask->n_triangles + triangles + 1) * sizeof *tag);
  if (tag) flask->tag = tag;
  CAST_CHECK(x && triangle && tag, err, CAST_ERR_MEMORY, "no memory for the flask");
  return CAST_OK;
}

/* The body's points come first, with its numbers; its triangles turned, to look out of the mould. */
static CastStatus add_body(const StlSurface *body, const bool *left_out, RemeshSurface *flask, CastError *err)
{
  CAST_CALL(reserve(flask, body->n_points, body->n_triangles, err));
  memcpy(flask->x, body->x, 3 * body->n_points * sizeof *flask->x);
  flask->n_points = body->n_points;
  for (size_t t = 0; t < body->n_triangles; t++)
    if (!left_out[t]) add_triangle(flask, body->triangle + 3 * t, true, FLASK_SIDES + body->solid[t]);
  return CAST_OK;
}

/* Rings of points from the bottom's to the top's; the first number. */
static CastStatus add_sides(const Prism *prism, RemeshSurface *flask, size_t *first, CastError *err)
{
  const size_t n = prism->n;
  *first = flask->n_points;
  CAST_CALL(reserve(flask, n * (prism->levels + 1), 2 * n * prism->levels, err));
  for (size_t level = 0; level <= prism->levels; level++)
    for (size_t i = 0; i < n; i++) {
      double *x = flask->x + 3 * flask->n_points++;
      memcpy(x, prism->base[i], sizeof prism->base[i]);
      x[2] = level == prism->levels ? prism->high
                                    : prism->low + (prism->high - prism->low) * (double)level / (double)prism->levels;
    }
  for (size_t level = 0; level < prism->levels; level++)
    for (size_t i = 0; i < n; i++) {
      const int32_t a = (int32_t)(*first + level * n + i), b = (int32_t)(*first + level * n + (i + 1) % n);
      add_triangle(flask, (int32_t[]){a, b, b + (int32_t)n}, false, FLASK_SIDE);
      add_triangle(flask, (int32_t[]){a, b + (int32_t)n, a + (int32_t)n}, false, FLASK_SIDE);
    }
  return CAST_OK;
}

typedef struct Lid { // top or bottom
  double z;
  FlaskSide side;
  size_t ring;                   // first point of its outline in the flask
  const FlaskOpenings *openings; // NULL: none
} Lid;

/* number [points]: the flask's numbers of the polygons' points, then of those that gmsh adds. */
static CastStatus add_lid_triangles(const FlaskPolygons *polygons, const Lid *lid, int32_t *number, size_t n_number,
                                    RemeshSurface *flask, CastError *err)
{
  int32_t *triangle = NULL;
  double *more = NULL;
  size_t n_triangles = 0, n_more = 0;
  CastStatus status = flask_triangulate(polygons, &triangle, &n_triangles, &more, &n_more, err);
  if (status == CAST_OK) status = reserve(flask, n_more, n_triangles, err);
  const size_t first = flask->n_points;
  for (size_t i = 0; status == CAST_OK && i < n_more; i++) {
    double *x = flask->x + 3 * flask->n_points++;
    memcpy(x, more + 2 * i, 2 * sizeof *x);
    x[2] = lid->z;
  }
  for (size_t t = 0; status == CAST_OK && t < n_triangles; t++) {
    int32_t p[3];
    for (size_t k = 0; k < 3; k++) {
      const size_t place = (size_t)triangle[3 * t + k];
      p[k] = place < n_number ? number[place] : (int32_t)(first + place - n_number);
    }
    const double *a = flask->x + 3 * (size_t)p[0], *b = flask->x + 3 * (size_t)p[1], *c = flask->x + 3 * (size_t)p[2];
    const bool upwards = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0;
    add_triangle(flask, p, upwards != (lid->side == FLASK_TOP), lid->side);
  }
  free(triangle);
  free(more);
  return status;
}

static CastStatus add_lid(const Prism *prism, const Lid *lid, RemeshSurface *flask, CastError *err)
{
  const FlaskOpenings none = {0}, *openings = lid->openings ? lid->openings : &none;
  const size_t n_rim = openings->n > 0 ? openings->start[openings->n] : 0, n = prism->n + n_rim;
  double *x = malloc((2 * n + 1) * sizeof *x);
  int32_t *number = malloc((n + 1) * sizeof *number);
  size_t *start = malloc((openings->n + 2) * sizeof *start);
  bool *island = calloc(openings->n + 1, sizeof *island);
  CastStatus status = CAST_ERR_MEMORY;
  if (x && number && start && island) {
    for (size_t i = 0; i < n; i++) {
      number[i] = i < prism->n ? (int32_t)(lid->ring + i) : openings->point[i - prism->n];
      memcpy(x + 2 * i, flask->x + 3 * (size_t)number[i], 2 * sizeof *x);
    }
    start[0] = 0;
    for (size_t p = 0; p <= openings->n; p++) start[p + 1] = prism->n + (openings->n > 0 ? openings->start[p] : 0);
    for (size_t p = 0; p < openings->n; p++) island[p + 1] = openings->island[p];
    const FlaskPolygons polygons = {openings->n + 1, start, x, island};
    status = add_lid_triangles(&polygons, lid, number, n, flask, err);
  } else {
    cast_error_set(err, CAST_ERR_MEMORY, "no memory for the flask");
  }
  free(x);
  free(number);
  free(start);
  free(island);
  return status;
}

static CastStatus build(const Prism *prism, double unit, const StlSurface *body, FlaskSurface *flask, CastError *err)
{
  FlaskOpenings openings = {0};
  size_t ring = 0;
  bool *left_out = calloc(body->n_triangles + 1, sizeof *left_out);
  CAST_CHECK(left_out, err, CAST_ERR_MEMORY, "no memory for the flask");
  CastStatus status = flask_find_openings(body, prism->high, unit, left_out, &openings, err);
  if (status == CAST_OK) status = add_body(body, left_out, &flask->surface, err);
  if (status == CAST_OK) status = add_sides(prism, &flask->surface, &ring, err);
  const Lid bottom = {prism->low, FLASK_BOTTOM, ring, NULL};
  const Lid top = {prism->high, FLASK_TOP, ring + prism->levels * prism->n, &openings};
  if (status == CAST_OK) status = add_lid(prism, &bottom, &flask->surface, err);
  if (status == CAST_OK) status = add_lid(prism, &top, &flask->surface, err);
  flask->volume = prism->area * (prism->high - prism->low) - stl_volume(body);
  flask_free_openings(&openings);
  free(left_out);
  return status;
}

CastStatus flask_create(const FlaskConfig *config, double unit, const StlSurface *body, FlaskSurface **flask,
                        CastError *err)
{
  *flask = NULL;
  const Prism prism = prism_of(config, unit);
  CAST_CALL(check_within(&prism, body, unit, err));
  FlaskSurface *made = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory for the flask");
  const CastStatus status = build(&prism, unit, body, made, err);
  if (status != CAST_OK) flask_destroy(&made);
  *flask = made;
  return status;
}

void flask_destroy(FlaskSurface **flask)
{
  if (!flask || !*flask) return;
  free((*flask)->surface.x);
  free((*flask)->surface.triangle);
  free((*flask)->surface.tag);
  free(*flask);
  *flask = NULL;
}
