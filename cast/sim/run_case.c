#include "cast/sim/run_case.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "common/input/yaml_input.h"

CastStatus run_case_read(const char *path, const char *overrides, CastConfig **config, CastError *err)
{
  *config = NULL;
  if (!overrides) return cast_config_read(path, NULL, config, err);
  char *text = NULL;
  CAST_CALL(yaml_input_read_text(path, &text, err));
  const size_t size = strlen(text) + strlen(overrides) + 32;
  char *joined = malloc(size);
  if (joined) snprintf(joined, size, "%s\noverrides:\n%s", text, overrides);
  free(text);
  CAST_CHECK(joined, err, CAST_ERR_MEMORY, "no memory");
  const CastStatus status = cast_config_read(path, joined, config, err);
  free(joined);
  return status;
}

CastStatus run_case_make_folder(const char *path, CastError *err)
{
  char partial[PATH_MAX];
  snprintf(partial, sizeof partial, "%s", path);
  for (char *slash = partial + 1; *slash; slash++) {
    if (*slash != '/') continue;
    *slash = '\0';
    mkdir(partial, 0777); // what fails here fails below too, with the reason
    *slash = '/';
  }
  if (mkdir(partial, 0777) == 0 || errno == EEXIST) {
    struct stat info;
    CAST_CHECK(stat(path, &info) == 0 && S_ISDIR(info.st_mode), err, CAST_ERR_IO, "output folder '%s' is a file", path);
    return CAST_OK;
  }
  return cast_error_set(err, CAST_ERR_IO, "output folder '%s' cannot be made: %s", path, strerror(errno));
}

static CastStatus open_log(const char *folder, bool quiet, Log **log, CastError *err)
{
  char path[PATH_MAX];
  snprintf(path, sizeof path, "%.4000s/castrun.log", folder);
  return log_open(path, quiet, log, err);
}

static CastStatus run_to_the_end(Sim *sim, Log *log, const char *folder, const RunCase *how, SimEnd *end,
                                 CastError *err)
{
  CAST_CALL(sim_run(sim, how->stop, end, err));
  if (*end == SIM_INTERRUPTED) {
    log_info(log, "interrupted at t = %g ms; to go on: castrun resume %s", 1e3 * sim_time(sim), folder);
    return CAST_OK;
  }
  const EnergyLedger e = sim_ledger(sim);
  log_info(log, "%s: filled %.1f %%, energy residual %.1e J of %.4g J exchanged; see %s/summary.txt",
           *end == SIM_EMPTY ? "all melt has left the mould" : "done", 100.0 * sim_filled_fraction(sim), e.residual,
           e.exchanged, folder);
  return CAST_OK;
}

CastStatus run_case(const CastConfig *config, const RunCase *how, SimEnd *end, CastError *err)
{
  Log *log = NULL;
  Sim *sim = NULL;
  const char *folder = config->output.folder;
  CAST_CALL(run_case_make_folder(folder, err));
  CAST_CALL(open_log(folder, how->quiet, &log, err));
  CastStatus status = sim_create(config, log, &sim, err);
  if (status == CAST_OK) status = sim_report(sim, err);
  if (status == CAST_OK) status = sim_open_output(sim, how->command, err);
  if (status == CAST_OK) status = run_to_the_end(sim, log, folder, how, end, err);
  sim_destroy(&sim);
  log_close(&log);
  return status;
}

CastStatus run_case_resume(const char *folder, const RunCase *how, SimEnd *end, CastError *err)
{
  CastConfig *config = NULL;
  Log *log = NULL;
  Sim *sim = NULL;
  CAST_CALL(open_log(folder, how->quiet, &log, err));
  CastStatus status = sim_resume(folder, log, how->command, &config, &sim, err);
  if (status == CAST_OK) {
    log_info(log, "resumed at t = %g ms, step %ld", 1e3 * sim_time(sim), sim_steps(sim));
    status = run_to_the_end(sim, log, folder, how, end, err);
  }
  sim_destroy(&sim);
  log_close(&log);
  cast_config_destroy(&config);
  return status;
}
