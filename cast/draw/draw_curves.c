/* draw_curves.c - curves.png: what the CSV files hold over time. Times in ms, temperatures in degrees Celsius. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cast/draw/draw_private.h"
#include "cast/io/csv_read.h"
#include "common/picture/picture.h"

enum { WIDTH = 1600, HEIGHT = 1100, MOST_CURVES = 24 };
static const double ZERO_CELSIUS = 273.15; // K

typedef struct Curves { // of one plot
  size_t n;
  PictureCurve curve[MOST_CURVES];
  char name[MOST_CURVES][80];
} Curves;

static void curves_free(Curves *curves)
{
  for (size_t k = 0; k < curves->n; k++) {
    free((double *)(uintptr_t)curves->curve[k].x);
    free((double *)(uintptr_t)curves->curve[k].y);
  }
  curves->n = 0;
}

typedef struct Column { // what of a table becomes a curve
  size_t x, y;          // columns
  double factor, shift; // y' = factor y + shift
  const char *only;     // rows whose name (column 1) is this; NULL: all
} Column;

/* Add a curve; nothing is added where there is no value, or no room. */
static CastStatus add_curve(Curves *curves, const char *name, const CsvTable *table, const Column *column,
                            CastError *err)
{
  if (curves->n == MOST_CURVES || column->y >= table->n_columns) return CAST_OK;
  double *x = malloc((table->n_rows + 1) * sizeof *x), *y = malloc((table->n_rows + 1) * sizeof *y);
  size_t n = 0, values = 0;
  for (size_t row = 0; row < table->n_rows && x && y; row++) {
    if (column->only && strcmp(table->cell[row * table->n_columns + 1], column->only) != 0) continue;
    x[n] = 1e3 * csv_value(table, row, column->x);
    y[n] = column->factor * csv_value(table, row, column->y) + column->shift;
    values += isfinite(y[n]) != 0;
    n++;
  }
  if (!x || !y || values == 0) {
    const bool failed = !x || !y;
    free(x);
    free(y);
    CAST_CHECK(!failed, err, CAST_ERR_MEMORY, "no memory for a curve of %zu points", table->n_rows);
    return CAST_OK;
  }
  snprintf(curves->name[curves->n], sizeof curves->name[0], "%s", name);
  curves->curve[curves->n] = (PictureCurve){.n = n, .x = x, .y = y, .label = curves->name[curves->n]};
  curves->n++;
  return CAST_OK;
}

typedef struct Page {
  Picture *picture;
  int plots; // so many panels are taken
} Page;

typedef struct Titles {
  const char *title, *y_label;
} Titles;

/* Plots the curves in the page's next panel, unless something has failed before, and frees them. Without any no panel
 * is taken. */
static CastStatus plot(CastStatus before, Page *page, const Titles *titles, Curves *curves, CastError *err)
{
  const PicturePlot shown = {.title = titles->title,
                             .x_label = "time, ms",
                             .y_label = titles->y_label,
                             .n_curves = curves->n,
                             .curves = curves->curve};
  CastStatus status = before;
  if (status == CAST_OK && curves->n > 0) status = picture_draw_plot(page->picture, page->plots++, &shown, err);
  curves_free(curves);
  return status;
}

static CastStatus plot_tracers(Page *page, const CsvTable *table, CastError *err)
{
  Curves curves = {0};
  const size_t T = csv_column(table, "temperature_K");
  CastStatus status = CAST_OK;
  for (size_t row = 0; row < table->n_rows && status == CAST_OK; row++) {
    const char *name = table->cell[row * table->n_columns + 1];
    bool known = false;
    for (size_t k = 0; k < curves.n; k++) known = known || strcmp(curves.name[k], name) == 0;
    if (known) break; // the second time: all tracers have come by
    status = add_curve(&curves, name, table, &(Column){0, T, 1.0, -ZERO_CELSIUS, name}, err);
  }
  return plot(status, page, &(Titles){"Tracked particles", "temperature, degC"}, &curves, err);
}

static CastStatus plot_probes(Page *page, const CsvTable *table, CastError *err)
{
  Curves curves = {0};
  CastStatus status = CAST_OK;
  for (size_t k = 1; k < table->n_columns && status == CAST_OK; k++) {
    char name[80];
    snprintf(name, sizeof name, "%.60s", table->name[k]);
    const size_t length = strlen(name);
    if (length > 2 && strcmp(name + length - 2, "_K") == 0) name[length - 2] = '\0';
    status = add_curve(&curves, name, table, &(Column){0, k, 1.0, -ZERO_CELSIUS, NULL}, err);
  }
  return plot(status, page, &(Titles){"Probes", "temperature, degC"}, &curves, err);
}

static CastStatus plot_filling(Page *page, const CsvTable *table, CastError *err)
{
  Curves curves = {0};
  CastStatus status = CAST_OK;
  for (size_t k = 0; k < table->n_columns && status == CAST_OK; k++)
    if (strncmp(table->name[k], "filled ", 7) == 0)
      status = add_curve(&curves, table->name[k] + 7, table, &(Column){0, k, 100.0, 0.0, NULL}, err);
  return plot(status, page, &(Titles){"Filling", "filled, %"}, &curves, err);
}

static CastStatus plot_melt(Page *page, const CsvTable *table, CastError *err)
{
  static const char *const columns[] = {"melt_max_K", "melt_mean_K", "melt_min_K"};
  static const char *const names[] = {"hottest", "mean", "coldest"};
  Curves curves = {0};
  CastStatus status = CAST_OK;
  for (int k = 0; k < 3 && status == CAST_OK; k++)
    status =
        add_curve(&curves, names[k], table, &(Column){0, csv_column(table, columns[k]), 1.0, -ZERO_CELSIUS, NULL}, err);
  return plot(status, page, &(Titles){"Melt", "temperature, degC"}, &curves, err);
}

/* Read FOLDER/name and plot it; a table that the run did not write takes no place. */
static CastStatus with_table(Page *page, const char *folder, const char *name,
                             CastStatus (*draw)(Page *, const CsvTable *, CastError *), CastError *err)
{
  char path[4200];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  if (access(path, F_OK) != 0) return CAST_OK;
  CsvTable table;
  CAST_CALL(csv_read(path, &table, err));
  const CastStatus status = draw(page, &table, err);
  csv_table_free(&table);
  return status;
}

CastStatus draw_curves(const char *folder, const char *picture_path, CastError *err)
{
  Picture *picture = NULL;
  CAST_CALL(picture_create(&(PicturePage){.width = WIDTH, .height = HEIGHT, .columns = 2, .rows = 2}, &picture, err));
  Page page = {picture, 0};
  CastStatus status = with_table(&page, folder, "tracers.csv", plot_tracers, err);
  if (status == CAST_OK) status = with_table(&page, folder, "probes.csv", plot_probes, err);
  if (status == CAST_OK) status = with_table(&page, folder, "ledger.csv", plot_filling, err);
  if (status == CAST_OK) status = with_table(&page, folder, "ledger.csv", plot_melt, err);
  if (status == CAST_OK) status = picture_save(picture, picture_path, err);
  picture_destroy(&picture);
  return status;
}
