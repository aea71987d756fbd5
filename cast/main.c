/* main.c - the command line of castrun. */
#define _GNU_SOURCE // sigaction
#include <errno.h>
#include <limits.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cast/io/draw.h"
#include "cast/io/run_record.h"
#include "cast/sim.h"
#include "cast_build_config.h"
#include "common/h5.h"
#include "common/rom_report.h"
#include "common/yaml_input.h"
#include "revision.h"

enum { EXIT_OK = 0, EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_INTERRUPTED = 3 };

static const char HELP[] =
    "castrun - fills a mould with melt: particles (SPH) coupled to the mould's reduced thermal model\n"
    "\n"
    "  castrun run CAST.yaml        compute; results go to the folder that the input names\n"
    "  castrun check CAST.yaml      read all inputs, say what would be computed and what is wrong\n"
    "  castrun resume FOLDER        go on from FOLDER/checkpoint.h5\n"
    "  castrun draw FOLDER          draw FOLDER/filling.png and FOLDER/curves.png\n"
    "  castrun info FILE            what a ROM (mould.rom.h5) or a results file (results.vtkhdf) holds\n"
    "\n"
    "  --set KEY=VALUE   with run and check: a value in place of the input's, as often as wished:\n"
    "                    --set 'preheat=850 degC' --set 'melt.blocks[1].temperature=1200 degC'\n"
    "  --threads N   threads to use (default: OMP_NUM_THREADS or all cores); results do not depend on it\n"
    "  --quiet       nothing but warnings and errors on the terminal; castrun.log has it all\n"
    "  --help, --version\n"
    "\n"
    "Interrupted (Ctrl-C, SIGTERM), a run writes a checkpoint and says how to go on; a second time it stops at once.\n"
    "Exit status: 0 done, 1 failed, 2 wrong command line, 3 interrupted with a checkpoint.\n";

typedef struct Arguments {
  const char *command, *target;
  bool quiet;
  char *line;      // the command line as one text, owned
  char *overrides; // what --set gives, as lines of YAML, owned; NULL: none
} Arguments;

static volatile sig_atomic_t stop_requested = 0;

static void request_stop(int signal_number)
{
  (void)signal_number;
  stop_requested = 1;
}

static void catch_signals(void)
{
  struct sigaction action = {.sa_handler = request_stop,
                             .sa_flags = (int)SA_RESETHAND}; // the second one ends the program
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
}

/* ---- folders ---- */

/* The folder and those above it. */
static CastStatus make_folder(const char *path, CastError *err)
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

/* ---- commands ---- */

static CastStatus run_to_the_end(Sim *sim, Log *log, const char *folder, int *exit_code, CastError *err)
{
  SimEnd end = SIM_FINISHED;
  catch_signals();
  CAST_CALL(sim_run(sim, &stop_requested, &end, err));
  if (end == SIM_INTERRUPTED) {
    log_info(log, "interrupted at t = %g ms; to go on: castrun resume %s", 1e3 * sim_time(sim), folder);
    *exit_code = EXIT_INTERRUPTED;
    return CAST_OK;
  }
  const EnergyLedger e = sim_ledger(sim);
  log_info(log, "%s: filled %.1f %%, energy residual %.1e J of %.4g J exchanged; see %s/summary.txt",
           end == SIM_EMPTY ? "all melt has left the mould" : "done", 100.0 * sim_filled_fraction(sim), e.residual,
           e.exchanged, folder);
  return CAST_OK;
}

static CastStatus run_config(const Arguments *arguments, const CastConfig *config, Log *log, int *exit_code,
                             CastError *err)
{
  Sim *sim = NULL;
  CastStatus status = sim_create(config, log, &sim, err);
  if (status == CAST_OK) status = sim_report(sim, err);
  if (status == CAST_OK) status = sim_open_output(sim, arguments->line, err);
  if (status == CAST_OK) status = run_to_the_end(sim, log, config->output.folder, exit_code, err);
  sim_destroy(&sim);
  return status;
}

/* The input file, with what --set gives behind it: a run's text tells all there is to know about it. */
static CastStatus read_config(const Arguments *arguments, CastConfig **config, CastError *err)
{
  if (!arguments->overrides) return cast_config_read(arguments->target, NULL, config, err);
  char *text = NULL;
  CAST_CALL(yaml_input_read_text(arguments->target, &text, err));
  const size_t size = strlen(text) + strlen(arguments->overrides) + 32;
  char *joined = malloc(size);
  if (joined) snprintf(joined, size, "%s\noverrides:\n%s", text, arguments->overrides);
  free(text);
  CAST_CHECK(joined, err, CAST_ERR_MEMORY, "no memory");
  const CastStatus status = cast_config_read(arguments->target, joined, config, err);
  free(joined);
  return status;
}

static CastStatus command_run(const Arguments *arguments, int *exit_code, CastError *err)
{
  CastConfig *config = NULL;
  Log *log = NULL;
  CAST_CALL(read_config(arguments, &config, err));
  CastStatus status = make_folder(config->output.folder, err);
  if (status == CAST_OK) status = open_log(config->output.folder, arguments->quiet, &log, err);
  if (status == CAST_OK) status = run_config(arguments, config, log, exit_code, err);
  log_close(&log);
  cast_config_destroy(&config);
  return status;
}

static CastStatus command_check(const Arguments *arguments, CastError *err)
{
  CastConfig *config = NULL;
  Log *log = NULL;
  Sim *sim = NULL;
  CAST_CALL(read_config(arguments, &config, err));
  CastStatus status = log_open(NULL, arguments->quiet, &log, err);
  if (status == CAST_OK) status = sim_create(config, log, &sim, err);
  if (status == CAST_OK) status = sim_report(sim, err);
  if (status == CAST_OK) log_info(log, "%s can be run", arguments->target);
  sim_destroy(&sim);
  log_close(&log);
  cast_config_destroy(&config);
  return status;
}

static CastStatus command_resume(const Arguments *arguments, int *exit_code, CastError *err)
{
  CastConfig *config = NULL;
  Log *log = NULL;
  Sim *sim = NULL;
  CAST_CALL(open_log(arguments->target, arguments->quiet, &log, err));
  CastStatus status = sim_resume(arguments->target, log, arguments->line, &config, &sim, err);
  if (status == CAST_OK) {
    log_info(log, "resumed at t = %g ms, step %ld", 1e3 * sim_time(sim), sim_steps(sim));
    status = run_to_the_end(sim, log, arguments->target, exit_code, err);
  }
  sim_destroy(&sim);
  log_close(&log);
  cast_config_destroy(&config);
  return status;
}

static CastStatus command_draw(const Arguments *arguments, CastError *err)
{
  Log *log = NULL;
  CAST_CALL(log_open(NULL, arguments->quiet, &log, err));
  const CastStatus status = draw_folder(arguments->target, log, err);
  log_close(&log);
  return status;
}

static CastStatus command_info(const Arguments *arguments, CastError *err)
{
  hid_t file = -1;
  CAST_CALL(h5_file_open(arguments->target, &file, err));
  const bool results = h5_exists(file, "VTKHDF");
  CAST_CALL(h5_file_close(&file, err));
  char *text = NULL;
  RomData *rom = NULL;
  CastStatus status =
      results ? run_record_read_summary(arguments->target, &text, err) : rom_read(arguments->target, &rom, err);
  if (status == CAST_OK && rom) status = rom_report(rom, arguments->target, &text, err);
  if (status == CAST_OK) fputs(text, stdout);
  free(text);
  rom_destroy(&rom);
  return status;
}

/* ---- command line ---- */

static char *join(int argc, char **argv)
{
  size_t size = 1;
  for (int i = 0; i < argc; i++) size += strlen(argv[i]) + 1;
  char *line = calloc(size, 1);
  for (int i = 0; i < argc && line; i++) {
    if (i > 0) strcat(line, " ");
    strcat(line, argv[i]);
  }
  return line;
}

static int usage(const char *fault, const char *what)
{
  fprintf(stderr, "castrun: %s%s%s\ncastrun --help tells what there is\n", fault, what ? ": " : "", what ? what : "");
  return EXIT_USAGE;
}

/* KEY=VALUE as a line of the map `overrides`; false: it is not of that form. */
static bool add_override(Arguments *arguments, const char *text)
{
  const char *equals = text ? strchr(text, '=') : NULL;
  if (!equals || equals == text || !equals[1] || strpbrk(text, "\n\"")) return false;
  const size_t old = arguments->overrides ? strlen(arguments->overrides) : 0, size = old + strlen(text) + 16;
  char *longer = realloc(arguments->overrides, size);
  if (!longer) return false;
  arguments->overrides = longer;
  snprintf(longer + old, size - old, "  \"%.*s\": %s\n", (int)(equals - text), text, equals + 1);
  return true;
}

/* 0, or the exit status for a wrong command line. */
static int parse(int argc, char **argv, Arguments *arguments)
{
  for (int i = 1; i < argc; i++) {
    const char *argument = argv[i];
    if (strcmp(argument, "--quiet") == 0) {
      arguments->quiet = true;
    } else if (strcmp(argument, "--set") == 0) {
      if (!add_override(arguments, i + 1 < argc ? argv[++i] : NULL)) return usage("--set wants KEY=VALUE", NULL);
    } else if (strcmp(argument, "--threads") == 0) {
      char *end = NULL;
      const long n = i + 1 < argc ? strtol(argv[++i], &end, 10) : 0;
      if (!end || *end || n < 1 || n > 4096) return usage("--threads wants a number from 1 to 4096", NULL);
      omp_set_num_threads((int)n);
    } else if (argument[0] == '-') {
      return usage("unknown option", argument);
    } else if (!arguments->command) {
      arguments->command = argument;
    } else if (!arguments->target) {
      arguments->target = argument;
    } else {
      return usage("one argument too many", argument);
    }
  }
  if (!arguments->command) return usage("a command is expected", NULL);
  if (!arguments->target) return usage("a file or folder is expected after the command", arguments->command);
  const bool reads_input = strcmp(arguments->command, "run") == 0 || strcmp(arguments->command, "check") == 0;
  if (arguments->overrides && !reads_input) return usage("--set goes with run and check", NULL);
  return 0;
}

static int execute(const Arguments *arguments)
{
  CastError err = {0};
  CastStatus status = CAST_OK;
  int exit_code = EXIT_OK;
  if (strcmp(arguments->command, "run") == 0)
    status = command_run(arguments, &exit_code, &err);
  else if (strcmp(arguments->command, "check") == 0)
    status = command_check(arguments, &err);
  else if (strcmp(arguments->command, "resume") == 0)
    status = command_resume(arguments, &exit_code, &err);
  else if (strcmp(arguments->command, "draw") == 0)
    status = command_draw(arguments, &err);
  else if (strcmp(arguments->command, "info") == 0)
    status = command_info(arguments, &err);
  else
    return usage("unknown command", arguments->command);
  if (status == CAST_OK) return exit_code;
  fprintf(stderr, "castrun: %s\n", err.message);
  return EXIT_FAILED;
}

int main(int argc, char **argv)
{
  for (int i = 1; i < argc; i++) {
    if (strcmp(argv[i], "--help") == 0) return fputs(HELP, stdout) < 0;
    if (strcmp(argv[i], "--version") == 0) return printf("castrun %s (%s)\n", CAST_VERSION, CAST_REVISION) < 0;
  }
  Arguments arguments = {0};
  const int wrong = parse(argc, argv, &arguments);
  if (wrong) return wrong;
  arguments.line = join(argc, argv);
  const int exit_code = execute(&arguments);
  free(arguments.line);
  free(arguments.overrides);
  return exit_code;
}
