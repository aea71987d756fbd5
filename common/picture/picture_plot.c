/* picture_plot.c - curves on linear or logarithmic axes. */
#include "common/picture/picture_private.h"

#include <float.h>
#include <math.h>

typedef struct Axis {
  double low, high; // of the values shown
  bool log;
  PictureTicks ticks;
} Axis;

typedef struct Chart {
  Axis x, y;
  PictureBox box; // of the data
  double unit;
} Chart;

static bool showable(double value, bool log)
{
  return isfinite(value) && (!log || value > 0.0);
}

static double share(const Axis *axis, double value) // 0 at low, 1 at high
{
  return axis->log ? log(value / axis->low) / log(axis->high / axis->low)
                   : (value - axis->low) / (axis->high - axis->low);
}

static double place_x(const Chart *chart, double x)
{
  return chart->box.x + chart->box.width * share(&chart->x, x);
}

static double place_y(const Chart *chart, double y)
{
  return chart->box.y + chart->box.height * (1.0 - share(&chart->y, y));
}

/* The range of the values that can be shown. */
static void find_range(const PicturePlot *plot, bool of_y, Axis *axis)
{
  axis->low = DBL_MAX;
  axis->high = -DBL_MAX;
  for (size_t c = 0; c < plot->n_curves; c++) {
    const PictureCurve *curve = &plot->curves[c];
    for (size_t i = 0; i < curve->n; i++) {
      if (!showable(curve->x[i], plot->log_x) || !showable(curve->y[i], plot->log_y)) continue;
      const double value = of_y ? curve->y[i] : curve->x[i];
      axis->low = fmin(axis->low, value);
      axis->high = fmax(axis->high, value);
    }
  }
}

/* Room at both ends; a y axis that starts near zero starts at zero. */
static void widen(Axis *axis, bool of_y)
{
  if (axis->log) {
    const double room = of_y ? pow(axis->high / axis->low, 0.06) : pow(axis->high / axis->low, 0.02);
    const double factor = axis->high > axis->low ? room : 2.0;
    axis->low /= factor;
    axis->high *= factor;
    return;
  }
  if (axis->high == axis->low) {
    const double room = axis->low == 0.0 ? 1.0 : 0.1 * fabs(axis->low);
    axis->low -= room;
    axis->high += room;
    return;
  }
  const double span = axis->high - axis->low;
  const bool from_zero = axis->low >= 0.0 && axis->low < 0.25 * axis->high;
  axis->low = from_zero ? 0.0 : of_y ? axis->low - 0.06 * span : axis->low;
  axis->high += of_y ? 0.06 * span : 0.0;
}

static CastStatus set_axis(const PicturePlot *plot, bool of_y, Axis *axis, CastError *err)
{
  axis->log = of_y ? plot->log_y : plot->log_x;
  if (of_y ? plot->y_limits : plot->x_limits) {
    axis->low = of_y ? plot->y_low : plot->x_low;
    axis->high = of_y ? plot->y_high : plot->x_high;
  } else {
    find_range(plot, of_y, axis);
    CAST_CHECK(axis->low <= axis->high, err, CAST_ERR_ARGUMENT, "a plot without a point that can be shown");
    widen(axis, of_y);
  }
  CAST_CHECK(isfinite(axis->low) && isfinite(axis->high) && axis->low < axis->high && (!axis->log || axis->low > 0.0),
             err, CAST_ERR_ARGUMENT, "a plot's %s axis from %g to %g%s is impossible", of_y ? "y" : "x", axis->low,
             axis->high, axis->log ? ", logarithmic," : "");
  return CAST_OK;
}

static void place_ticks(Axis *axis, double pixels, double unit)
{
  const int parts = (int)fmin(8.0, fmax(2.0, pixels / (5.0 * unit)));
  if (axis->log && axis->high / axis->low > 3.0)
    picture_ticks_log(axis->low, axis->high, &axis->ticks);
  else
    picture_ticks_linear(axis->low, axis->high, parts, &axis->ticks);
}

static double widest_label(cairo_t *cairo, const PictureTicks *ticks, double size)
{
  double width = 0.0;
  for (int i = 0; i < ticks->n; i++) width = fmax(width, picture_text_width(cairo, ticks->label[i], size));
  return width;
}

static void draw_grid(cairo_t *cairo, const Chart *chart)
{
  const double u = chart->unit;
  const PictureBox *box = &chart->box;
  for (int axis = 0; axis < 2; axis++) {
    const PictureTicks *ticks = axis ? &chart->y.ticks : &chart->x.ticks;
    for (int i = 0; i < ticks->n; i++) {
      const double grey = ticks->label[i][0] ? 0.84 : 0.93;
      const double at = axis ? place_y(chart, ticks->value[i]) : place_x(chart, ticks->value[i]);
      cairo_set_line_width(cairo, fmax(1.0, 0.06 * u));
      cairo_set_source_rgb(cairo, grey, grey, grey);
      cairo_move_to(cairo, axis ? box->x : at, axis ? at : box->y);
      cairo_line_to(cairo, axis ? box->x + box->width : at, axis ? at : box->y + box->height);
      cairo_stroke(cairo);
    }
  }
}

static void draw_labels(cairo_t *cairo, const Chart *chart)
{
  const double u = chart->unit;
  const PictureBox *box = &chart->box;
  for (int i = 0; i < chart->x.ticks.n; i++)
    picture_text(cairo, place_x(chart, chart->x.ticks.value[i]), box->y + box->height + 1.35 * u,
                 chart->x.ticks.label[i], (PictureFont){0.92 * u, false, PICTURE_CENTRE, 0.1});
  for (int i = 0; i < chart->y.ticks.n; i++)
    picture_text(cairo, box->x - 0.5 * u, place_y(chart, chart->y.ticks.value[i]) + 0.33 * u, chart->y.ticks.label[i],
                 (PictureFont){0.92 * u, false, PICTURE_RIGHT, 0.1});
}

static void draw_titles(cairo_t *cairo, const Chart *chart, const PicturePlot *plot, PictureBox panel)
{
  const double u = chart->unit;
  const PictureBox *box = &chart->box;
  const PictureFont font = {u, false, PICTURE_CENTRE, 0.0};
  if (plot->title)
    picture_text(cairo, box->x + 0.5 * box->width, panel.y + 1.2 * u, plot->title,
                 (PictureFont){1.1 * u, true, PICTURE_CENTRE, 0.0});
  if (plot->x_label)
    picture_text(cairo, box->x + 0.5 * box->width, panel.y + panel.height - 0.35 * u, plot->x_label, font);
  if (!plot->y_label) return;
  cairo_save(cairo);
  cairo_translate(cairo, panel.x + 1.0 * u, box->y + 0.5 * box->height);
  cairo_rotate(cairo, -M_PI_2);
  picture_text(cairo, 0.0, 0.0, plot->y_label, font);
  cairo_restore(cairo);
}

static PictureColour curve_colour(const PicturePlot *plot, size_t c)
{
  return picture_category(plot->curves[c].colour > 0 ? (size_t)plot->curves[c].colour - 1 : c);
}

static void set_dash(cairo_t *cairo, PictureLine line, double width)
{
  const double dashes[2] = {4.0 * width, 2.5 * width}, dots[2] = {0.0, 2.2 * width};
  cairo_set_dash(cairo, line == PICTURE_DASHED ? dashes : dots, line == PICTURE_SOLID ? 0 : 2, 0.0);
  cairo_set_line_cap(cairo, line == PICTURE_DOTTED ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
}

static void draw_marker(cairo_t *cairo, double x, double y, double size)
{
  cairo_arc(cairo, x, y, size, 0.0, 2.0 * M_PI);
  cairo_fill(cairo);
}

static void draw_curve(cairo_t *cairo, const Chart *chart, const PicturePlot *plot, size_t c)
{
  const PictureCurve *curve = &plot->curves[c];
  const double width = (curve->width > 0.0 ? curve->width : 2.0) * chart->unit / 16.0;
  picture_set_colour(cairo, curve_colour(plot, c));
  cairo_set_line_width(cairo, width);
  cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
  set_dash(cairo, curve->line, width);
  bool open = false;
  for (size_t i = 0; i < curve->n; i++) {
    const bool shown = showable(curve->x[i], plot->log_x) && showable(curve->y[i], plot->log_y);
    if (shown && curve->markers) {
      cairo_new_path(cairo);
      draw_marker(cairo, place_x(chart, curve->x[i]), place_y(chart, curve->y[i]), 0.28 * chart->unit);
    }
  }
  for (size_t i = 0; i < curve->n && curve->line != PICTURE_NO_LINE; i++) {
    const bool shown = showable(curve->x[i], plot->log_x) && showable(curve->y[i], plot->log_y);
    if (shown && open)
      cairo_line_to(cairo, place_x(chart, curve->x[i]), place_y(chart, curve->y[i]));
    else if (shown)
      cairo_move_to(cairo, place_x(chart, curve->x[i]), place_y(chart, curve->y[i]));
    open = shown;
  }
  cairo_stroke(cairo);
  cairo_set_dash(cairo, NULL, 0, 0.0);
}

/* How many points of curves lie in the box (pixels). */
static size_t points_within(const Chart *chart, const PicturePlot *plot, PictureBox box)
{
  size_t count = 0;
  for (size_t c = 0; c < plot->n_curves; c++)
    for (size_t i = 0; i < plot->curves[c].n; i++) {
      const PictureCurve *curve = &plot->curves[c];
      if (!showable(curve->x[i], plot->log_x) || !showable(curve->y[i], plot->log_y)) continue;
      const double x = place_x(chart, curve->x[i]) - box.x, y = place_y(chart, curve->y[i]) - box.y;
      count += x > 0.0 && x < box.width && y > 0.0 && y < box.height;
    }
  return count;
}

/* The corner with the fewest points beneath; the upper right among equals. */
static PictureBox place_within(const Chart *chart, const PicturePlot *plot, double width, double height)
{
  const double gap = 0.6 * chart->unit;
  const PictureBox *box = &chart->box;
  PictureBox best = {0};
  size_t least = SIZE_MAX;
  for (int corner = 0; corner < 4; corner++) {
    const PictureBox place = {corner & 1 ? box->x + gap : box->x + box->width - width - gap,
                              corner & 2 ? box->y + box->height - height - gap : box->y + gap, width, height};
    const size_t count = points_within(chart, plot, place);
    if (count >= least) continue;
    least = count;
    best = place;
  }
  return best;
}

/* A legend of more lines stands beside the plot, where it hides nothing. */
enum { MOST_LINES_WITHIN = 5 };

typedef struct Legend {
  int lines;
  double width, height; // pixels
} Legend;

static Legend measure_legend(cairo_t *cairo, const PicturePlot *plot, double u)
{
  Legend legend = {0};
  for (size_t c = 0; c < plot->n_curves; c++) {
    if (!plot->curves[c].label) continue;
    legend.width = fmax(legend.width, picture_text_width(cairo, plot->curves[c].label, 0.92 * u));
    legend.lines++;
  }
  legend.width += 4.2 * u;
  legend.height = 1.5 * u * legend.lines + 0.6 * u;
  return legend;
}

/* How wide a strip beside the plot the legend takes, pixels. */
static double strip_of(const Legend *legend, double u)
{
  return legend->lines > MOST_LINES_WITHIN ? legend->width + 0.6 * u : 0.0;
}

static PictureBox place_legend(const Chart *chart, const PicturePlot *plot, const Legend *legend)
{
  if (legend->lines <= MOST_LINES_WITHIN) return place_within(chart, plot, legend->width, legend->height);
  return (PictureBox){chart->box.x + chart->box.width + 0.8 * chart->unit, chart->box.y, legend->width, legend->height};
}

static void draw_legend(cairo_t *cairo, const Chart *chart, const PicturePlot *plot, const Legend *legend)
{
  const double u = chart->unit;
  if (legend->lines == 0) return;
  const PictureBox box = place_legend(chart, plot, legend);
  cairo_set_source_rgba(cairo, 1.0, 1.0, 1.0, 0.88);
  cairo_rectangle(cairo, box.x, box.y, box.width, box.height);
  cairo_fill_preserve(cairo);
  cairo_set_source_rgb(cairo, 0.75, 0.75, 0.75);
  cairo_set_line_width(cairo, fmax(1.0, 0.06 * u));
  cairo_stroke(cairo);
  double y = box.y + 1.05 * u;
  for (size_t c = 0; c < plot->n_curves; c++) {
    const PictureCurve *curve = &plot->curves[c];
    if (!curve->label) continue;
    const double line = (curve->width > 0.0 ? curve->width : 2.0) * u / 16.0;
    picture_set_colour(cairo, curve_colour(plot, c));
    if (curve->markers) draw_marker(cairo, box.x + 1.75 * u, y, 0.28 * u);
    if (curve->line != PICTURE_NO_LINE) {
      set_dash(cairo, curve->line, line);
      cairo_set_line_width(cairo, line);
      cairo_move_to(cairo, box.x + 0.6 * u, y);
      cairo_line_to(cairo, box.x + 2.9 * u, y);
      cairo_stroke(cairo);
      cairo_set_dash(cairo, NULL, 0, 0.0);
    }
    picture_text(cairo, box.x + 3.5 * u, y + 0.33 * u, curve->label, (PictureFont){0.92 * u, false, PICTURE_LEFT, 0.1});
    y += 1.5 * u;
  }
}

CastStatus picture_draw_plot(Picture *picture, int panel, const PicturePlot *plot, CastError *err)
{
  PictureBox whole;
  Chart chart = {.unit = picture->unit};
  CAST_CALL(picture_panel(picture, panel, &whole, err));
  CAST_CALL(set_axis(plot, false, &chart.x, err));
  CAST_CALL(set_axis(plot, true, &chart.y, err));
  cairo_t *cairo = picture->cairo;
  const double u = chart.unit;
  const double top = plot->title ? 2.2 * u : 0.8 * u, bottom = plot->x_label ? 3.4 * u : 2.0 * u;
  place_ticks(&chart.y, whole.height - top - bottom, u);
  const double left = (plot->y_label ? 1.9 * u : 0.3 * u) + widest_label(cairo, &chart.y.ticks, 0.92 * u) + 0.6 * u;
  const Legend legend = measure_legend(cairo, plot, u);
  const double right = 1.6 * u + strip_of(&legend, u);
  chart.box = (PictureBox){whole.x + left, whole.y + top, whole.width - left - right, whole.height - top - bottom};
  CAST_CHECK(chart.box.width > 2.0 * u && chart.box.height > 2.0 * u, err, CAST_ERR_ARGUMENT,
             "the panels are too small for a plot");
  place_ticks(&chart.x, chart.box.width, u);
  draw_grid(cairo, &chart);
  cairo_save(cairo);
  cairo_rectangle(cairo, chart.box.x, chart.box.y, chart.box.width, chart.box.height);
  cairo_clip(cairo);
  for (size_t c = 0; c < plot->n_curves; c++) draw_curve(cairo, &chart, plot, c);
  cairo_restore(cairo);
  cairo_set_source_rgb(cairo, 0.25, 0.25, 0.25);
  cairo_set_line_width(cairo, fmax(1.0, 0.08 * u));
  cairo_rectangle(cairo, chart.box.x, chart.box.y, chart.box.width, chart.box.height);
  cairo_stroke(cairo);
  draw_labels(cairo, &chart);
  draw_titles(cairo, &chart, plot, whole);
  draw_legend(cairo, &chart, plot, &legend);
  return CAST_OK;
}
