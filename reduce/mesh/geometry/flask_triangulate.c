/* flask_triangulate.c - plane polygons as triangles, by gmsh in a model of its own. */
#include <gmshc.h>
#include <stdlib.h>
#include <string.h>
#include "reduce/mesh/geometry/flask.h"
#include "reduce/mesh/geometry/gmsh_session.h"

enum { TRIANGLE = 2 }; // gmsh's number for a triangle of three nodes

/* Point i of the polygons is gmsh's point i + 1, and so are the lines that begin there. */
static int draw_loop(const FlaskPolygons *polygons, size_t polygon, int *ierr)
{
  const size_t begin = polygons->start[polygon], end = polygons->start[polygon + 1];
  int *lines = malloc((end - begin + 1) * sizeof *lines), loop = -1;
  for (size_t i = begin; lines && i < end; i++)
    gmshModelGeoAddPoint(polygons->x[2 * i], polygons->x[2 * i + 1], 0.0, 0.0, (int)i + 1, ierr);
  for (size_t i = begin; lines && i < end; i++) {
    lines[i - begin] = (int)i + 1;
    gmshModelGeoAddLine((int)i + 1, (int)(i + 1 < end ? i + 1 : begin) + 1, (int)i + 1, ierr);
    gmshModelGeoMeshSetTransfiniteCurve((int)i + 1, 2, "Progression", 1.0, ierr); // the body's points and no others
  }
  if (lines) loop = gmshModelGeoAddCurveLoop(lines, end - begin, -1, 0, ierr);
  free(lines);
  return loop;
}

static CastStatus draw(const FlaskPolygons *polygons, CastError *err)
{
  int ierr, n = 0, *main_loops = malloc((polygons->n_polygons + 1) * sizeof *main_loops);
  CAST_CHECK(main_loops, err, CAST_ERR_MEMORY, "no memory for the flask");
  for (size_t p = 0; p < polygons->n_polygons; p++) {
    int loop = draw_loop(polygons, p, &ierr);
    if (p > 0 && polygons->island[p])
      gmshModelGeoAddPlaneSurface(&loop, 1, -1, &ierr);
    else
      main_loops[n++] = loop;
  }
  gmshModelGeoAddPlaneSurface(main_loops, (size_t)n, -1, &ierr);
  free(main_loops);
  gmshModelGeoSynchronize(&ierr);
  gmshModelMeshGenerate(2, &ierr);
  return gmsh_session_check(ierr, "the flask's top and bottom", err);
}

/* place [largest tag + 1]: number of each node: a polygon's point, or one behind them all. */
static CastStatus number_nodes(const FlaskPolygons *polygons, int32_t **place, double **more, size_t *n_more,
                               CastError *err)
{
  const size_t n_points = polygons->start[polygons->n_polygons];
  size_t *tag = NULL, n = 0, n_x = 0, n_parametric = 0, largest = 0;
  double *x = NULL, *parametric = NULL;
  int ierr;
  *n_more = 0;
  gmshModelMeshGetNodes(&tag, &n, &x, &n_x, &parametric, &n_parametric, -1, -1, 0, 0, &ierr);
  for (size_t i = 0; i < n; i++) largest = tag[i] > largest ? tag[i] : largest;
  *place = malloc((largest + 1) * sizeof **place);
  *more = malloc((2 * n + 1) * sizeof **more);
  const bool room = *place && *more;
  for (size_t i = 0; room && i <= largest; i++) (*place)[i] = -1;
  for (size_t p = 0; room && p < n_points; p++) { // the node at point p
    size_t *at = NULL, n_at = 0, n_u = 0, n_c = 0;
    double *c = NULL, *u = NULL;
    gmshModelMeshGetNodes(&at, &n_at, &c, &n_c, &u, &n_u, 0, (int)p + 1, 0, 0, &ierr);
    if (n_at == 1) (*place)[at[0]] = (int32_t)p;
    gmshFree(at);
    gmshFree(c);
    gmshFree(u);
  }
  for (size_t i = 0; room && i < n; i++) {
    if ((*place)[tag[i]] >= 0) continue;
    memcpy(*more + 2 * *n_more, x + 3 * i, 2 * sizeof **more);
    (*place)[tag[i]] = (int32_t)(n_points + (*n_more)++);
  }
  gmshFree(tag);
  gmshFree(x);
  gmshFree(parametric);
  CAST_CHECK(room, err, CAST_ERR_MEMORY, "no memory for the flask");
  return gmsh_session_check(ierr, "the flask's top and bottom", err);
}

static CastStatus take_triangles(const int32_t *place, int32_t **triangle, size_t *n, CastError *err)
{
  size_t *element = NULL, *node = NULL, n_node = 0;
  int ierr;
  gmshModelMeshGetElementsByType(TRIANGLE, &element, n, &node, &n_node, -1, 0, 1, &ierr);
  *triangle = malloc((n_node + 1) * sizeof **triangle);
  for (size_t i = 0; *triangle && i < n_node; i++) (*triangle)[i] = place[node[i]];
  gmshFree(element);
  gmshFree(node);
  CAST_CHECK(*triangle, err, CAST_ERR_MEMORY, "no memory for the flask");
  return gmsh_session_check(ierr, "the flask's top and bottom", err);
}

CastStatus flask_triangulate(const FlaskPolygons *polygons, int32_t **triangle, size_t *n_triangles, double **more,
                             size_t *n_more, CastError *err)
{
  int32_t *place = NULL;
  int ierr;
  *triangle = NULL;
  *more = NULL;
  gmshModelAdd("flask", &ierr);
  CastStatus status = draw(polygons, err);
  if (status == CAST_OK) status = number_nodes(polygons, &place, more, n_more, err);
  if (status == CAST_OK) status = take_triangles(place, triangle, n_triangles, err);
  gmshModelRemove(&ierr);
  free(place);
  return status;
}
