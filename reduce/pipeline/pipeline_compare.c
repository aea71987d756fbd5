/* pipeline_compare.c - castreduce compare: the same mould by every method. */
#include <math.h>
#include <stdlib.h>
#include "reduce/mor/online_cost.h"
#include "reduce/petsc/collective.h"
#include "reduce/petsc/petsc_compat.h"
#include "reduce/pipeline/comparison.h"
#include "reduce/pipeline/pipeline_private.h"
#include "reduce/pipeline/process_use.h"

static double largest_bound(const RomCertificate *certificate)
{
  double bound = (double)NAN;
  for (size_t i = 0; i < certificate->n_frequencies; i++) bound = fmax(bound, certificate->transfer_bound[i]);
  return bound;
}

/* Reduce by `config` and note what it took. Silently: a method that misses the tolerance is part of the comparison. */
static PetscErrorCode measure(Pipeline *pipeline, const ReductionConfig *config, ComparisonRow *row)
{
  PetscReal before, after, peak;
  OnlineCost online;
  ReducedModel *model;

  PetscFunctionBeginUser;
  process_use_reset_peak();
  PetscCall(process_use_cpu(pipeline->comm, &before));
  PetscCall(reduced_model_create(pipeline->system, config, NULL, &model));
  PetscCall(process_use_cpu(pipeline->comm, &after));
  PetscCall(process_use_peak(pipeline->comm, &peak));
  PetscCall(online_cost_measure(model, &online));
  row->states = (long)model->r;
  row->cpu_seconds = after - before;
  row->reduction_share = model->seconds_reduction / (model->seconds_reduction + model->seconds_certificate);
  row->peak_bytes = peak;
  row->step_error = model->certificate.step_error_max;
  row->transfer_bound = largest_bound(&model->certificate);
  row->second_stage = model->certificate.second_stage_bound;
  row->multiplications = online.multiplications;
  row->step_seconds = online.seconds;
  log_info(pipeline->log, "%s: %ld states, error %.3g %%, %.1f s of CPU", row->method, row->states,
           100.0 * row->step_error, row->cpu_seconds);
  PetscCall(reduced_model_destroy(&model));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static ComparisonRow *add_row(Comparison *comparison, const char *family, const char *detail)
{
  ComparisonRow *row = &comparison->row[comparison->n++];
  snprintf(row->family, sizeof row->family, "%s", family);
  snprintf(row->method, sizeof row->method, "%s%s", family, detail);
  return row;
}

/* The founding paper's moments at s = 0, or where K is singular at the slowest rate that counts. */
static PetscErrorCode compare_arnoldi(Pipeline *pipeline, Comparison *comparison)
{
  ReductionConfig config = pipeline->config->reduction;
  char detail[32];

  PetscFunctionBeginUser;
  config.method = REDUCTION_ARNOLDI;
  config.second_stage = false;
  config.solver_rtol = 1e-12; // moments build on one another
  config.s0 = pipeline->system->singular ? 1.0 / config.t_end : 0.0;
  for (config.moments = 1; config.moments <= 5; config.moments += 2) {
    snprintf(detail, sizeof detail, ", q = %ld", config.moments);
    PetscCall(measure(pipeline, &config, add_row(comparison, "arnoldi", detail)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode compare_modal(Pipeline *pipeline, Comparison *comparison)
{
  ReductionConfig config = pipeline->config->reduction;
  char detail[32];

  PetscFunctionBeginUser;
  config.method = REDUCTION_MODAL;
  config.second_stage = false;
  for (PetscInt each = 1; each <= 5; each += 4) {
    config.modes = (long)PetscMin(each * pipeline->system->m, pipeline->system->n / 4);
    snprintf(detail, sizeof detail, ", %ld modes", config.modes);
    PetscCall(measure(pipeline, &config, add_row(comparison, "modal", detail)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By the settings of the input, but for the second stage. */
static PetscErrorCode compare_rational(Pipeline *pipeline, Comparison *comparison)
{
  ReductionConfig config = pipeline->config->reduction;

  PetscFunctionBeginUser;
  if (config.method != REDUCTION_RATIONAL) {
    config.n_shifts = 0;
    config.solver_rtol = reduce_config_solver_rtol(config.tolerance, config.iterative);
    config.early_weight = 0.4;
  }
  config.method = REDUCTION_RATIONAL;
  config.second_stage = false;
  PetscCall(measure(pipeline, &config, add_row(comparison, "rational", "")));
  config.second_stage = true;
  config.early_weight = 0.0;
  PetscCall(measure(pipeline, &config, add_row(comparison, "rational, balanced", "")));
  config.early_weight = pipeline->config->reduction.early_weight > 0.0 ? pipeline->config->reduction.early_weight : 0.4;
  PetscCall(measure(pipeline, &config, add_row(comparison, "rational, early weight", "")));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With the time step of a filling. */
static PetscErrorCode measure_full_step(const Pipeline *pipeline, Comparison *comparison)
{
  static const PetscReal DT = 1e-5; // s
  FullStepCost cost;

  PetscFunctionBeginUser;
  PetscCall(full_step_measure(pipeline->system, DT, &cost));
  comparison->full_dt = DT;
  comparison->full_operations = cost.operations;
  comparison->full_seconds = cost.seconds;
  comparison->full_iterations = cost.iterations;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static CastStatus write_results(const Pipeline *pipeline, const Comparison *comparison, CastError *err)
{
  char *csv = pipeline_output_path(pipeline->config, ".compare.csv");
  char *png = pipeline_output_path(pipeline->config, ".compare.png");
  CastStatus status = csv && png ? CAST_OK : cast_error_set(err, CAST_ERR_MEMORY, "no memory for the output's path");
  if (status == CAST_OK) status = comparison_write_csv(comparison, csv, err);
  if (status == CAST_OK) status = comparison_draw(comparison, png, err);
  if (status == CAST_OK) {
    comparison_print(comparison, stdout);
    log_info(pipeline->log, "wrote %s and %s", csv, png);
  }
  free(csv);
  free(png);
  return status;
}

static PetscErrorCode compare_methods(Pipeline *pipeline)
{
  const ReductionConfig *config;
  CastError err = {CAST_OK, ""};
  CastStatus status = CAST_OK;

  PetscFunctionBeginUser;
  PetscCall(pipeline_read_config(pipeline));
  char *log_path = pipeline_output_path(pipeline->config, ".compare.log");
  PetscCall(pipeline_open_log(pipeline, log_path));
  free(log_path);
  PetscCall(pipeline_assemble(pipeline));
  config = &pipeline->config->reduction;
  Comparison comparison = {.title = pipeline->config->title,
                           .unknowns = (long)pipeline->system->n,
                           .patches = (long)pipeline->system->m,
                           .tolerance = config->tolerance,
                           .t_start = config->t_start,
                           .t_end = config->t_end};
  PetscCall(measure_full_step(pipeline, &comparison));
  PetscCall(compare_arnoldi(pipeline, &comparison));
  PetscCall(compare_modal(pipeline, &comparison));
  PetscCall(compare_rational(pipeline, &comparison));
  if (pipeline->rank == 0) status = write_results(pipeline, &comparison, &err);
  PetscCall(collective_check(pipeline->comm, status, &err));
  PetscCall(pipeline_release(pipeline));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode pipeline_compare(MPI_Comm comm, const PipelineTask *task)
{
  Pipeline pipeline = {.task = task, .comm = comm};
  PetscErrorCode ierr;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &pipeline.rank));
  ierr = compare_methods(&pipeline);
  pipeline_close(&pipeline);
  PetscFunctionReturn(ierr);
}
