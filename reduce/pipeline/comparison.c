#include "reduce/pipeline/comparison.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>
#include <unistd.h>
#include "common/picture/picture.h"

static const double MEBIBYTE = 1048576.0;

void comparison_print(const Comparison *comparison, FILE *out)
{
  fprintf(out, "%s\n%ld unknowns, %ld patches; errors from %g s to %g s, tolerance %g %%\n\n", comparison->title,
          comparison->unknowns, comparison->patches, comparison->t_start, comparison->t_end,
          100.0 * comparison->tolerance);
  fprintf(
      out,
      "| method | states | CPU s | of it reducing | MiB | error | H(iw) bound | multiplications a step | us a step |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (size_t i = 0; i < comparison->n; i++) {
    const ComparisonRow *row = &comparison->row[i];
    fprintf(out, "| %s | %ld | %.2f | %.0f %% | %.0f | %.3g %% | %.3g %% | %.0f | %.3g |\n", row->method, row->states,
            row->cpu_seconds, 100.0 * row->reduction_share, row->peak_bytes / MEBIBYTE, 100.0 * row->step_error,
            100.0 * row->transfer_bound, row->multiplications, 1e6 * row->step_seconds);
  }
  fprintf(out,
          "full model, one implicit step of %g us: %.3g multiplications and additions, %.3g us (%.0f iterations of "
          "conjugate "
          "gradients)\n",
          1e6 * comparison->full_dt, comparison->full_operations, 1e6 * comparison->full_seconds,
          comparison->full_iterations);
  for (size_t i = 0; i < comparison->n; i++)
    if (comparison->row[i].second_stage > 0.0)
      fprintf(out, "%s: the second stage changes the transfer function by at most %.3g K/W\n",
              comparison->row[i].method, comparison->row[i].second_stage);
}

static bool write_rows(const Comparison *comparison, FILE *file)
{
  fprintf(file, "method,states,cpu_s,reduction_share,peak_bytes,step_error,transfer_bound,second_stage_K_per_W,"
                "multiplications_per_step,seconds_per_step\n");
  for (size_t i = 0; i < comparison->n; i++) {
    const ComparisonRow *row = &comparison->row[i];
    fprintf(file, "\"%s\",%ld,%.6g,%.4g,%.0f,%.6g,%.6g,%.6g,%.0f,%.6g\n", row->method, row->states, row->cpu_seconds,
            row->reduction_share, row->peak_bytes, row->step_error, row->transfer_bound, row->second_stage,
            row->multiplications, row->step_seconds);
  }
  return !ferror(file);
}

CastStatus comparison_write_csv(const Comparison *comparison, const char *path, CastError *err)
{
  FILE *file = fopen(path, "w");
  CAST_CHECK(file, err, CAST_ERR_IO, "'%s' cannot be written: %s", path, strerror(errno));
  const bool written = write_rows(comparison, file);
  const bool closed = fclose(file) == 0;
  if (written && closed) return CAST_OK;
  const int cause = errno;
  unlink(path);
  return cast_error_set(err, CAST_ERR_IO, "'%s' cannot be written: %s", path, strerror(cause));
}

typedef struct Lines { // error against something, one curve a family
  size_t n;
  PictureCurve curve[COMPARISON_MOST];
  double x[COMPARISON_MOST], y[COMPARISON_MOST];
} Lines;

/* Rows of a family stand together. */
static void collect(const Comparison *comparison, bool over_time, Lines *lines)
{
  lines->n = 0;
  for (size_t i = 0; i < comparison->n; i++) {
    const ComparisonRow *row = &comparison->row[i];
    lines->x[i] = over_time ? row->cpu_seconds : (double)row->states;
    lines->y[i] = 100.0 * row->step_error;
    if (i == 0 || strcmp(row->family, comparison->row[i - 1].family) != 0)
      lines->curve[lines->n++] = (PictureCurve){
          .x = lines->x + i, .y = lines->y + i, .label = over_time ? NULL : row->family, .markers = true};
    lines->curve[lines->n - 1].n++;
  }
}

static CastStatus draw_panels(const Comparison *comparison, Picture *picture, CastError *err)
{
  for (int panel = 0; panel < 2; panel++) {
    Lines lines;
    collect(comparison, panel == 1, &lines);
    const PicturePlot plot = {.title = panel == 0 ? "certified error over the number of states"
                                                  : "certified error over the time to get it",
                              .x_label = panel == 0 ? "states" : "CPU seconds, reduction and certificate",
                              .y_label = "largest error of a patch, % of the rise",
                              .log_x = true,
                              .log_y = true,
                              .n_curves = lines.n,
                              .curves = lines.curve};
    CAST_CALL(picture_draw_plot(picture, panel, &plot, err));
  }
  return CAST_OK;
}

CastStatus comparison_draw(const Comparison *comparison, const char *path, CastError *err)
{
  Picture *picture = NULL;
  CAST_CALL(picture_create(&(PicturePage){.width = 1400, .height = 600, .columns = 2, .title = comparison->title},
                           &picture, err));
  CastStatus status = draw_panels(comparison, picture, err);
  if (status == CAST_OK) status = picture_save(picture, path, err);
  picture_destroy(&picture);
  return status;
}
