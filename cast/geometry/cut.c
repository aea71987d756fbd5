/* cut.c - volume and first moment of the part of a box that the mould fills.
 * Method: the triangles are clipped to the box. If each of the pieces lies behind the planes of all others, the mould's
 * part is the box cut by all those half-spaces; if each lies before them, the void is. Half-spaces are cut off
 * tetrahedron by tetrahedron, for which volume and centroid are exact. */
#include "cast/geometry/cut.h"

#include <stdlib.h>

enum { MAX_TRIANGLES = 768, MAX_PIECES = 48, MAX_CORNERS = 9, MAX_LEVEL = 3 };

typedef struct Plane {
  double normal[3], offset; // normal . x = offset
} Plane;

typedef struct Piece { // a triangle clipped to the box
  int count;
  double corner[MAX_CORNERS][3];
} Piece;

typedef struct Pieces {
  int n, n_planes;
  Piece piece[MAX_PIECES];
  Plane plane[MAX_PIECES]; // distinct ones
} Pieces;

void cut_add(CutPart *part, double scale, const CutPart *other)
{
  part->volume += scale * other->volume;
  vec_axpy(scale, other->moment, part->moment, part->moment);
}

void cut_whole(const CutBox *box, CutPart *part)
{
  part->volume = 1.0;
  for (int k = 0; k < 3; k++) part->volume *= box->high[k] - box->low[k];
  for (int k = 0; k < 3; k++) part->moment[k] = part->volume * 0.5 * (box->low[k] + box->high[k]);
}

static CutBox box_eighth(const CutBox *box, int child)
{
  CutBox eighth;
  for (int k = 0; k < 3; k++) {
    const double middle = 0.5 * (box->low[k] + box->high[k]);
    eighth.low[k] = child >> k & 1 ? middle : box->low[k];
    eighth.high[k] = child >> k & 1 ? box->high[k] : middle;
  }
  return eighth;
}

static void add_tetrahedron(const double x[4][3], CutPart *part)
{
  double a[3], b[3], c[3], n[3];
  vec_sub(x[1], x[0], a);
  vec_sub(x[2], x[0], b);
  vec_sub(x[3], x[0], c);
  vec_cross(a, b, n);
  const double volume = fabs(vec_dot(n, c)) / 6.0;
  part->volume += volume;
  for (int k = 0; k < 3; k++) part->moment[k] += 0.25 * volume * (x[0][k] + x[1][k] + x[2][k] + x[3][k]);
}

static void point_between(const double p[3], double at_p, const double q[3], double at_q, double out[3])
{
  const double share = at_p / (at_p - at_q);
  for (int k = 0; k < 3; k++) out[k] = p[k] + share * (q[k] - p[k]);
}

/* What of the tetrahedron lies behind all planes from `from` on; sign -1 turns the planes round. */
static void cut_tetrahedron(const Pieces *pieces, int from, double sign, const double x[4][3], CutPart *part)
{
  if (from == pieces->n_planes) {
    add_tetrahedron(x, part);
    return;
  }
  const Plane *plane = &pieces->plane[from];
  double height[4], in[4][3], out[4][3], in_height[4], out_height[4];
  int n_in = 0, n_out = 0;
  for (int k = 0; k < 4; k++) {
    height[k] = sign * (vec_dot(plane->normal, x[k]) - plane->offset);
    double *to = height[k] <= 0.0 ? in[n_in] : out[n_out];
    vec_copy(x[k], to);
    if (height[k] <= 0.0)
      in_height[n_in++] = height[k];
    else
      out_height[n_out++] = height[k];
  }
  if (n_in == 0) return;
  if (n_in == 4) {
    cut_tetrahedron(pieces, from + 1, sign, x, part);
    return;
  }
  double cut[4][3]; // on the edges from in[i] to out[j]
  for (int i = 0; i < n_in; i++)
    for (int j = 0; j < n_out; j++) point_between(in[i], in_height[i], out[j], out_height[j], cut[i * n_out + j]);
  double prism[2][3][3]; // two triangles, the mould's part between them; with one corner in, a tetrahedron
  if (n_in == 1) {
    double tip[4][3];
    vec_copy(in[0], tip[0]);
    for (int k = 0; k < 3; k++) vec_copy(cut[k], tip[k + 1]);
    cut_tetrahedron(pieces, from + 1, sign, (const double(*)[3])tip, part);
    return;
  }
  for (int k = 0; k < 3; k++) {
    if (n_in == 3) {
      vec_copy(in[k], prism[0][k]);
      vec_copy(cut[k], prism[1][k]);
    } else {
      for (int i = 0; i < 2; i++) vec_copy(k == 0 ? in[i] : cut[2 * i + k - 1], prism[i][k]);
    }
  }
  static const int split[3][4] = {{0, 1, 2, 3}, {1, 2, 3, 4}, {2, 3, 4, 5}};
  for (int s = 0; s < 3; s++) {
    double piece[4][3];
    for (int k = 0; k < 4; k++) vec_copy(prism[split[s][k] / 3][split[s][k] % 3], piece[k]);
    cut_tetrahedron(pieces, from + 1, sign, (const double(*)[3])piece, part);
  }
}

/* The box is six tetrahedra round its diagonal (Kuhn). */
static void cut_planes(const Pieces *pieces, const CutBox *box, double sign, CutPart *part)
{
  static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  *part = (CutPart){0};
  for (int s = 0; s < 6; s++) {
    double x[4][3];
    vec_copy(box->low, x[0]);
    for (int k = 0; k < 3; k++) {
      vec_copy(x[k], x[k + 1]);
      x[k + 1][order[s][k]] = box->high[order[s][k]];
    }
    cut_tetrahedron(pieces, 0, sign, (const double(*)[3])x, part);
  }
}

/* Keep of the piece what lies at sign x[axis] <= sign wall (Sutherland & Hodgman 1974). */
static void clip_piece(Piece *piece, int axis, double sign, double wall)
{
  bool inside = true;
  for (int k = 0; k < piece->count; k++) inside = inside && sign * (piece->corner[k][axis] - wall) <= 0.0;
  if (inside) return;
  Piece out;
  out.count = 0;
  for (int k = 0; k < piece->count && out.count < MAX_CORNERS - 1; k++) {
    const double *p = piece->corner[k], *q = piece->corner[(k + 1) % piece->count];
    const double at_p = sign * (p[axis] - wall), at_q = sign * (q[axis] - wall);
    if (at_p <= 0.0) vec_copy(p, out.corner[out.count++]);
    if ((at_p < 0.0 && at_q > 0.0) || (at_p > 0.0 && at_q < 0.0))
      point_between(p, at_p, q, at_q, out.corner[out.count++]);
  }
  *piece = out;
}

static double piece_area(const Piece *piece)
{
  double sum[3] = {0.0, 0.0, 0.0};
  for (int k = 1; k + 1 < piece->count; k++) {
    double u[3], v[3], n[3];
    vec_sub(piece->corner[k], piece->corner[0], u);
    vec_sub(piece->corner[k + 1], piece->corner[0], v);
    vec_cross(u, v, n);
    vec_axpy(1.0, n, sum, sum);
  }
  return 0.5 * vec_norm(sum);
}

static bool boxes_meet(const Facet *facet, const CutBox *box)
{
  for (int k = 0; k < 3; k++) {
    const double a = facet->corner[0][k], b = facet->corner[1][k], c = facet->corner[2][k];
    if (a > box->high[k] && b > box->high[k] && c > box->high[k]) return false;
    if (a < box->low[k] && b < box->low[k] && c < box->low[k]) return false;
  }
  return true;
}

/* Clip a facet to the box; false if nothing of it (or a hair only) is left. */
static bool make_piece(const Facet *facet, const CutBox *box, double edge, Piece *piece)
{
  if (!boxes_meet(facet, box)) return false;
  piece->count = 3;
  for (int k = 0; k < 3; k++) vec_copy(facet->corner[k], piece->corner[k]);
  for (int axis = 0; axis < 3 && piece->count > 0; axis++) {
    clip_piece(piece, axis, 1.0, box->high[axis]);
    clip_piece(piece, axis, -1.0, box->low[axis]);
  }
  return piece->count >= 3 && piece_area(piece) > 1.0e-9 * edge * edge;
}

static void add_plane(Pieces *pieces, const Facet *facet, double edge)
{
  Plane plane = {.offset = vec_dot(facet->normal, facet->corner[0])};
  vec_copy(facet->normal, plane.normal);
  for (int k = 0; k < pieces->n_planes; k++)
    if (vec_distance2(pieces->plane[k].normal, plane.normal) < 1.0e-18 &&
        fabs(pieces->plane[k].offset - plane.offset) < 1.0e-9 * edge)
      return;
  pieces->plane[pieces->n_planes++] = plane;
}

/* All pieces in the box; false if there are too many for one go. */
static bool gather_pieces(const Surface *s, const int32_t *id, int n, const CutBox *box, Pieces *pieces)
{
  const double edge = box->high[0] - box->low[0];
  pieces->n = pieces->n_planes = 0;
  for (int k = 0; k < n; k++) {
    Piece piece;
    if (!make_piece(&s->facet[id[k]], box, edge, &piece)) continue;
    if (pieces->n == MAX_PIECES) return false;
    pieces->piece[pieces->n++] = piece;
    add_plane(pieces, &s->facet[id[k]], edge);
  }
  return true;
}

/* Do all pieces lie behind (sign 1) or before (sign -1) every plane? A tolerance of 1e-4 of the box's edge lets meshes
 * of curved walls pass whose facets are a little out of line. */
static bool is_one_sided(const Pieces *pieces, double sign, double edge)
{
  for (int k = 0; k < pieces->n_planes; k++)
    for (int i = 0; i < pieces->n; i++)
      for (int c = 0; c < pieces->piece[i].count; c++)
        if (sign * (vec_dot(pieces->plane[k].normal, pieces->piece[i].corner[c]) - pieces->plane[k].offset) >
            1.0e-4 * edge)
          return false;
  return true;
}

typedef struct CutWork {
  const Surface *surface;
  const SurfaceHit *sheet;
  Pieces pieces;
} CutWork;

/* The tangent plane at the point of these triangles that is nearest to the box's centre. */
static void cut_tangent(CutWork *work, const int32_t *id, int n, const CutBox *box, CutPart *part)
{
  double centre[3], best = INFINITY, foot[3];
  int32_t nearest = id[0];
  for (int k = 0; k < 3; k++) centre[k] = 0.5 * (box->low[k] + box->high[k]);
  for (int k = 0; k < n; k++) {
    FacetFeature feature;
    const double distance2 = facet_closest(&work->surface->facet[id[k]], centre, foot, &feature);
    if (distance2 < best) {
      best = distance2;
      nearest = id[k];
    }
  }
  work->pieces.n_planes = 0;
  add_plane(&work->pieces, &work->surface->facet[nearest], box->high[0] - box->low[0]);
  cut_planes(&work->pieces, box, 1.0, part);
}

/* No triangle of interest passes through the box: it is all mould or all void. */
static void fill_uniform(CutWork *work, const int32_t *id, int n, const CutBox *box, int level, CutPart *part)
{
  if (work->sheet && level > 0) { // a share of a box that the sheet passes through: before it or behind it
    cut_tangent(work, id, n, box, part);
    return;
  }
  double centre[3];
  for (int k = 0; k < 3; k++) centre[k] = 0.5 * (box->low[k] + box->high[k]);
  *part = (CutPart){0};
  if (work->sheet || surface_inside_mould(work->surface, centre)) cut_whole(box, part);
}

static bool cut_recursive(CutWork *work, const int32_t *id, int n, const CutBox *box, int level, CutPart *part);

static void cut_eighths(CutWork *work, const int32_t *id, int n, const CutBox *box, int level, CutPart *part)
{
  *part = (CutPart){0};
  for (int child = 0; child < 8; child++) {
    const CutBox eighth = box_eighth(box, child);
    CutPart share;
    cut_recursive(work, id, n, &eighth, level + 1, &share);
    cut_add(part, 1.0, &share);
  }
}

static bool cut_recursive(CutWork *work, const int32_t *id, int n, const CutBox *box, int level, CutPart *part)
{
  const double edge = box->high[0] - box->low[0];
  const bool complete = gather_pieces(work->surface, id, n, box, &work->pieces);
  if (complete && work->pieces.n == 0) {
    fill_uniform(work, id, n, box, level, part);
    return false;
  }
  if (complete && is_one_sided(&work->pieces, 1.0, edge)) {
    cut_planes(&work->pieces, box, 1.0, part);
  } else if (complete && is_one_sided(&work->pieces, -1.0, edge)) {
    CutPart open;
    cut_planes(&work->pieces, box, -1.0, &open);
    cut_whole(box, part);
    cut_add(part, -1.0, &open);
  } else if (level < MAX_LEVEL) {
    cut_eighths(work, id, n, box, level, part);
  } else {
    cut_tangent(work, id, n, box, part);
  }
  return true;
}

static int compare_int32(const void *left, const void *right)
{
  const int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;
  return (a > b) - (a < b);
}

/* Is triangle t part of the side that `sheet` is the foot of? The end face of a fin is part of both its sides; of the
 * floor that it stands on, only what lies before a side is. */
static bool belongs_to_sheet(const Surface *s, int32_t t, const CutBox *box, const SurfaceHit *sheet)
{
  const Facet *facet = &s->facet[t];
  if (vec_dot(facet->normal, sheet->normal) < -0.3) return false;
  double eye[3], centre[3], place[3];
  FacetFeature feature;
  vec_axpy(1.0e-3 * s->reach, sheet->normal, sheet->foot, eye);
  for (int k = 0; k < 3; k++) centre[k] = 0.5 * (box->low[k] + box->high[k]);
  facet_closest(facet, centre, place, &feature);
  for (int k = 0; k < 3; k++) // off the edges, where sheets meet
    place[k] += 0.05 * ((facet->corner[0][k] + facet->corner[1][k] + facet->corner[2][k]) / 3.0 - place[k]);
  vec_axpy(1.0e-3 * s->reach, facet->normal, place, place);
  return !surface_hides(s, eye, place, NULL);
}

/* Triangles that may pass through the box, each once and in order; MAX_TRIANGLES + 1 if there are more than that. */
static int gather_triangles(const Surface *s, const CutBox *box, const SurfaceHit *sheet, int32_t id[MAX_TRIANGLES])
{
  int32_t first[3], last[3], at[3];
  int n = 0;
  if (!grid_range(&s->grid, box->low, box->high, first, last)) return 0;
  for (at[2] = first[2]; at[2] <= last[2]; at[2]++)
    for (at[1] = first[1]; at[1] <= last[1]; at[1]++)
      for (at[0] = first[0]; at[0] <= last[0]; at[0]++) {
        const ptrdiff_t cell = grid_index(&s->grid, at);
        for (int32_t k = s->grid.start[cell]; k < s->grid.start[cell + 1]; k++) {
          const int32_t t = s->grid.item[k];
          if (!boxes_meet(&s->facet[t], box) || (sheet && !belongs_to_sheet(s, t, box, sheet))) continue;
          if (n == MAX_TRIANGLES) return MAX_TRIANGLES + 1;
          id[n++] = t;
        }
      }
  qsort(id, (size_t)n, sizeof *id, compare_int32);
  int kept = 0;
  for (int k = 0; k < n; k++)
    if (kept == 0 || id[kept - 1] != id[k]) id[kept++] = id[k];
  return kept;
}

static bool cut_level(const Surface *surface, const CutBox *box, const SurfaceHit *sheet, int level, CutPart *part)
{
  int32_t id[MAX_TRIANGLES];
  CutWork work; // its pieces are filled as far as they are read
  work.surface = surface;
  work.sheet = sheet;
  const int n = gather_triangles(surface, box, sheet, id);
  if (n <= MAX_TRIANGLES || level == MAX_LEVEL)
    return cut_recursive(&work, id, n < MAX_TRIANGLES ? n : MAX_TRIANGLES, box, level, part);
  *part = (CutPart){0}; // a mesh far finer than the box
  for (int child = 0; child < 8; child++) {
    const CutBox eighth = box_eighth(box, child);
    CutPart share;
    cut_level(surface, &eighth, sheet, level + 1, &share);
    cut_add(part, 1.0, &share);
  }
  return true;
}

bool cut_box(const Surface *surface, const CutBox *box, const SurfaceHit *sheet, CutPart *part)
{
  return cut_level(surface, box, sheet, 0, part);
}
