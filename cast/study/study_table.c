#define _GNU_SOURCE // open_memstream
/* study_table.c - what came of the runs: summaries read, table and picture written. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/results/run_record.h"
#include "cast/study/study.h"
#include "common/picture/picture.h"

const StudyQuantity study_quantities[STUDY_QUANTITIES] = {
    {"filled", "1", {"filling", "*", "fraction"}}, // of the part, or of the whole cavity
    {"fill_time", "s", {"filling", "*", "t99_s"}}, // 99 % of it
    {"melt_coldest", "K", {"melt_K", "min", NULL}},
    {"melt_mean", "K", {"melt_K", "mean", NULL}},
    {"wall_hottest", "K", {"cavity_wall_K", "max", NULL}},
    {"heat_exchanged", "J", {"energy_J", "exchanged", NULL}},
    {"energy_residual", "1", {"energy_J", "residual_relative", NULL}},
    {"particles_lost", "1", {"removed_particles", NULL, NULL}},
    {"wall_time", "s", {"work", "wall_s", NULL}},
    {"misrun", "1", {"filling", "*", "misrun"}},
    {"cold_shut", "1", {"filling", "*", "cold_shut"}},
};

/* "*" stands for the last feature: the part or the whole cavity. */
static const json_t *step_into(const json_t *object, const char *key)
{
  if (strcmp(key, "*") != 0) return json_object_get(object, key);
  const json_t *last = json_object_get(object, "part");
  return last ? last : json_object_get(object, "whole cavity");
}

void study_result_read(const char *folder, StudyResult *result)
{
  *result = (StudyResult){0};
  for (int q = 0; q < STUDY_QUANTITIES; q++) result->value[q] = NAN;
  char path[4300];
  snprintf(path, sizeof path, "%s/summary.json", folder);
  json_t *root = json_load_file(path, 0, NULL);
  const char *outcome = root ? json_string_value(json_object_get(root, "outcome")) : NULL;
  if (outcome) {
    result->done = true;
    snprintf(result->outcome, sizeof result->outcome, "%s", outcome);
    for (int q = 0; q < STUDY_QUANTITIES; q++) {
      const json_t *value = root;
      for (int k = 0; k < 3 && value && study_quantities[q].path[k]; k++)
        value = step_into(value, study_quantities[q].path[k]);
      if (json_is_number(value)) result->value[q] = json_number_value(value);
    }
  }
  json_decref(root);
}

bool study_goal_met(const StudyGoal *goal, const StudyResult *result)
{
  if (goal->quantity < 0 || !result->done) return false;
  const double value = result->value[goal->quantity];
  return goal->at_most ? value <= goal->bound : value >= goal->bound; // NAN: not met
}

/* Texts go without quotes, as in the other tables: what would end a cell becomes something else. */
static void put_cell(FILE *out, const char *text)
{
  for (; *text; text++) fputc(*text == ',' ? ';' : *text == '\n' || *text == '"' ? ' ' : *text, out);
}

static void put_table(FILE *out, const StudyConfig *config, size_t n, const StudyPoint *points,
                      const StudyResult *results)
{
  fprintf(out, "# %s\nrun", config->title);
  for (size_t k = 0; k < config->n_keys; k++) {
    fputc(',', out);
    put_cell(out, config->key[k].path);
  }
  fputs(",outcome", out);
  if (config->goal.quantity >= 0) fputs(",goal_met", out);
  for (int q = 0; q < STUDY_QUANTITIES; q++)
    fprintf(out, ",%s%s%s", study_quantities[q].name, strcmp(study_quantities[q].unit, "1") == 0 ? "" : "_",
            strcmp(study_quantities[q].unit, "1") == 0 ? "" : study_quantities[q].unit);
  fputc('\n', out);
  for (size_t i = 0; i < n; i++) {
    fprintf(out, "run-%04zu", i + 1);
    for (size_t k = 0; k < config->n_keys; k++) {
      fputc(',', out);
      put_cell(out, points[i].value[k]);
    }
    fputc(',', out);
    put_cell(out, results[i].done ? results[i].outcome : results[i].outcome[0] ? results[i].outcome : "not run yet");
    if (config->goal.quantity >= 0)
      fprintf(out, ",%s", !results[i].done ? "" : study_goal_met(&config->goal, &results[i]) ? "yes" : "no");
    for (int q = 0; q < STUDY_QUANTITIES; q++) {
      fputc(',', out);
      if (isfinite(results[i].value[q]) && results[i].done) fprintf(out, "%.9g", results[i].value[q]);
    }
    fputc('\n', out);
  }
}

CastStatus study_write_table(const StudyConfig *config, size_t n, const StudyPoint *points, const StudyResult *results,
                             CastError *err)
{
  char *text = NULL, path[4300];
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  CAST_CHECK(out, err, CAST_ERR_MEMORY, "no memory for the table");
  put_table(out, config, n, points, results);
  fclose(out);
  snprintf(path, sizeof path, "%s/study.csv", config->folder);
  const CastStatus status = run_record_write_text(path, text, err);
  free(text);
  return status;
}

/* ---- picture ---- */

typedef struct Dot {
  double x, y;
} Dot;

static int by_x(const void *a, const void *b)
{
  const Dot *p = a, *q = b;
  return p->x != q->x ? (p->x > q->x) - (p->x < q->x) : (p->y > q->y) - (p->y < q->y);
}

static CastStatus draw_key(const StudyConfig *config, size_t k, size_t n, const StudyPoint *points,
                           const StudyResult *results, Picture *picture, CastError *err)
{
  const int quantity = config->goal.quantity >= 0 ? config->goal.quantity : 0;
  const StudyKey *key = &config->key[k];
  Dot *dot = malloc((n + 1) * sizeof *dot);
  double *x = malloc((n + 1) * sizeof *x), *y = malloc((n + 1) * sizeof *y);
  size_t shown = 0;
  char x_label[160], y_label[64], *rest = NULL;
  snprintf(x_label, sizeof x_label, "%s", key->path);
  for (size_t i = 0; i < n && dot; i++) {
    if (!results[i].done || !isfinite(results[i].value[quantity])) continue;
    dot[shown] = (Dot){strtod(points[i].value[k], &rest), results[i].value[quantity]};
    if (rest == points[i].value[k]) continue; // a word: no place on an axis
    snprintf(x_label, sizeof x_label, "%s,%s", key->path, rest);
    shown++;
  }
  CastStatus status = dot && x && y ? CAST_OK : cast_error_set(err, CAST_ERR_MEMORY, "no memory for a plot");
  if (status == CAST_OK && shown > 0) {
    qsort(dot, shown, sizeof *dot, by_x);
    for (size_t i = 0; i < shown; i++) {
      x[i] = dot[i].x;
      y[i] = dot[i].y;
    }
    const bool plain = strcmp(study_quantities[quantity].unit, "1") == 0;
    snprintf(y_label, sizeof y_label, "%s%s%s", study_quantities[quantity].name, plain ? "" : ", ",
             plain ? "" : study_quantities[quantity].unit);
    const double ends[2] = {x[0], x[shown - 1]}, bound[2] = {config->goal.bound, config->goal.bound};
    const PictureCurve curves[2] = {
        {.n = shown, .x = x, .y = y, .markers = true, .line = config->n_keys == 1 ? PICTURE_SOLID : PICTURE_NO_LINE},
        {.n = 2, .x = ends, .y = bound, .line = PICTURE_DASHED, .label = "goal"}};
    status = picture_draw_plot(
        picture, (int)k,
        &(PicturePlot){
            .x_label = x_label, .y_label = y_label, .n_curves = config->goal.quantity >= 0 ? 2 : 1, .curves = curves},
        err);
  }
  free(dot);
  free(x);
  free(y);
  return status;
}

CastStatus study_draw(const StudyConfig *config, size_t n, const StudyPoint *points, const StudyResult *results,
                      CastError *err)
{
  Picture *picture = NULL;
  char path[4300];
  const int columns = config->n_keys < 2 ? 1 : 2, rows = ((int)config->n_keys + columns - 1) / columns;
  CAST_CALL(picture_create(
      &(PicturePage){
          .width = 800 * columns, .height = 60 + 540 * rows, .columns = columns, .rows = rows, .title = config->title},
      &picture, err));
  CastStatus status = CAST_OK;
  for (size_t k = 0; k < config->n_keys && status == CAST_OK; k++)
    status = draw_key(config, k, n, points, results, picture, err);
  snprintf(path, sizeof path, "%s/study.png", config->folder);
  if (status == CAST_OK) status = picture_save(picture, path, err);
  picture_destroy(&picture);
  return status;
}
