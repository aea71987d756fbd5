/* Time and memory of reductions over unknowns and over inputs, drawn from the table that table.sh writes (CSV=file).
 *   growth TABLE.csv PICTURE.png
 * Runs with about as many inputs (or unknowns) are joined by a curve; a dotted line shows growth by proportion. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/picture/picture.h"

enum { MOST = 64, PANELS = 4 };

typedef struct Run {
  double unknowns, inputs, cpu_seconds, memory_mib;
} Run;

typedef struct Lines { // curves of one panel, and what they point to
  size_t n_curves, n_points;
  PictureCurve curve[MOST + 1];
  double lowest, highest; // of y
  double x[MOST], y[MOST], proportion_x[2], proportion_y[2];
  char label[MOST][64];
} Lines;

static bool alike(double a, double b)
{
  return fabs(log(a / b)) < log(1.7);
}

static size_t read_runs(const char *path, Run *run)
{
  FILE *file = fopen(path, "r");
  char line[256];
  size_t n = 0;
  if (!file || !fgets(line, sizeof line, file)) return 0;
  while (n < MOST && fgets(line, sizeof line, file)) {
    Run *r = &run[n];
    if (sscanf(line, "%lf,%lf,%*d,%*d,%*f,%lf,%lf", &r->unknowns, &r->inputs, &r->cpu_seconds, &r->memory_mib) == 4)
      n++;
  }
  fclose(file);
  return n;
}

static int by_unknowns(const void *a, const void *b)
{
  const double x = ((const Run *)a)->unknowns, y = ((const Run *)b)->unknowns;
  return (x > y) - (x < y);
}

static int by_inputs(const void *a, const void *b)
{
  const double x = ((const Run *)a)->inputs, y = ((const Run *)b)->inputs;
  return (x > y) - (x < y);
}

/*  run [n]  in the order of the axis */
static void collect(const Run *run, size_t n, bool over_inputs, bool memory, Lines *lines)
{
  bool taken[MOST] = {false};
  double first_x = 0.0, first_y = 0.0, low = HUGE_VAL, high = 0.0;
  *lines = (Lines){.lowest = HUGE_VAL};
  for (size_t i = 0; i < n; i++) {
    if (taken[i]) continue;
    const double kind = over_inputs ? run[i].unknowns : run[i].inputs;
    PictureCurve *curve = &lines->curve[lines->n_curves];
    *curve = (PictureCurve){.x = lines->x + lines->n_points, .y = lines->y + lines->n_points, .markers = true};
    for (size_t j = i; j < n; j++) {
      if (taken[j] || !alike(kind, over_inputs ? run[j].unknowns : run[j].inputs)) continue;
      taken[j] = true;
      lines->x[lines->n_points] = over_inputs ? run[j].inputs : run[j].unknowns;
      lines->y[lines->n_points++] = memory ? run[j].memory_mib : run[j].cpu_seconds;
      curve->n++;
    }
    snprintf(lines->label[lines->n_curves], sizeof lines->label[0], "about %.0f %s", kind,
             over_inputs ? "unknowns" : "inputs");
    curve->label = lines->label[lines->n_curves++];
    if (curve->n > 1 && first_x == 0.0) first_x = curve->x[0], first_y = curve->y[0];
  }
  for (size_t i = 0; i < lines->n_points; i++) {
    low = fmin(low, lines->x[i]), high = fmax(high, lines->x[i]);
    lines->lowest = fmin(lines->lowest, lines->y[i]), lines->highest = fmax(lines->highest, lines->y[i]);
  }
  if (first_x == 0.0) return;
  for (int end = 0; end < 2; end++) {
    lines->proportion_x[end] = end ? high : low;
    lines->proportion_y[end] = first_y * lines->proportion_x[end] / first_x;
  }
  lines->curve[lines->n_curves++] = (PictureCurve){
      .n = 2, .x = lines->proportion_x, .y = lines->proportion_y, .label = "in proportion", .line = PICTURE_DOTTED};
}

static CastStatus draw(Run *run, size_t n, Picture *picture, CastError *err)
{
  for (int panel = 0; panel < PANELS; panel++) {
    const bool over_inputs = panel >= 2, memory = panel % 2;
    Lines lines;
    qsort(run, n, sizeof *run, over_inputs ? by_inputs : by_unknowns);
    collect(run, n, over_inputs, memory, &lines);
    const PicturePlot plot = {.title = memory ? "memory of the larger rank" : "processor time, meshing included",
                              .x_label = over_inputs ? "inputs" : "unknowns",
                              .y_label = memory ? "MiB" : "CPU seconds",
                              .log_x = true,
                              .log_y = true,
                              .y_limits = true, // the legend has its place above the curves
                              .y_low = 0.5 * lines.lowest,
                              .y_high = 60.0 * lines.highest,
                              .n_curves = lines.n_curves,
                              .curves = lines.curve};
    CAST_CALL(picture_draw_plot(picture, panel, &plot, err));
  }
  return CAST_OK;
}

int main(int argc, char **argv)
{
  Run run[MOST];
  CastError err = {0};
  Picture *picture = NULL;
  const size_t n = argc == 3 ? read_runs(argv[1], run) : 0;
  if (n == 0) {
    fprintf(stderr, "use: growth TABLE.csv PICTURE.png, the table as table.sh writes it with CSV=TABLE.csv\n");
    return EXIT_FAILURE;
  }
  CastStatus status = picture_create(
      &(PicturePage){
          .width = 1400, .height = 1100, .columns = 2, .rows = 2, .title = "A block reduced to 0.1 %, 1 ms to 100 s"},
      &picture, &err);
  if (status == CAST_OK) status = draw(run, n, picture, &err);
  if (status == CAST_OK) status = picture_save(picture, argv[2], &err);
  picture_destroy(&picture);
  if (status != CAST_OK) fprintf(stderr, "growth: %s\n", err.message);
  return status == CAST_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
