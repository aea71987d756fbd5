/* main.c - the command line of castrun. */
#define _GNU_SOURCE // sigaction
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/draw/draw.h"
#include "cast/results/run_record.h"
#include "cast/sim/run_case.h"
#include "cast/study/study.h"
#include "cast_build_config.h"
#include "common/h5/h5.h"
#include "common/rom/rom_report.h"
#include "revision.h"

enum { EXIT_OK = 0, EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_INTERRUPTED = 3 };

static const char HELP[] =
    "castrun - fills a mould with melt: particles (SPH) coupled to the mould's reduced thermal model\n"
    "\n"
    "  castrun run CAST.yaml        compute; results go to the folder that the input names\n"
    "  castrun check CAST.yaml      read all inputs, say what would be computed and what is wrong\n"
    "  castrun resume FOLDER        go on from FOLDER/checkpoint.h5\n"
    "  castrun draw FOLDER          draw filling.png, speed.png, pressure.png and curves.png there\n"
    "  castrun sweep STUDY.yaml     many runs of one case: lists, grids, Latin hypercube, bisection\n"
    "  castrun info FILE            what a ROM (mould.rom.h5) or a results file (results.vtkhdf) holds\n"
    "\n"
    "  --set KEY=VALUE   with run and check: a value in place of the input's, as often as wished:\n"
    "                    --set 'preheat=850 degC' --set 'melt.blocks[1].temperature=1200 degC'\n"
    "  --only N      with sweep: its run N alone, for the job arrays of a cluster\n"
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
  long only;       // of a study's runs; 0: all
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

/* ---- commands ---- */

static RunCase how_to_run(const Arguments *arguments)
{
  catch_signals();
  return (RunCase){arguments->line, arguments->quiet, &stop_requested};
}

static CastStatus command_run(const Arguments *arguments, int *exit_code, CastError *err)
{
  CastConfig *config = NULL;
  SimEnd end = SIM_FINISHED;
  CAST_CALL(run_case_read(arguments->target, arguments->overrides, &config, err));
  const RunCase how = how_to_run(arguments);
  const CastStatus status = run_case(config, &how, &end, err);
  if (end == SIM_INTERRUPTED) *exit_code = EXIT_INTERRUPTED;
  cast_config_destroy(&config);
  return status;
}

static CastStatus command_check(const Arguments *arguments, CastError *err)
{
  CastConfig *config = NULL;
  Log *log = NULL;
  Sim *sim = NULL;
  CAST_CALL(run_case_read(arguments->target, arguments->overrides, &config, err));
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
  SimEnd end = SIM_FINISHED;
  const RunCase how = how_to_run(arguments);
  const CastStatus status = run_case_resume(arguments->target, &how, &end, err);
  if (end == SIM_INTERRUPTED) *exit_code = EXIT_INTERRUPTED;
  return status;
}

static CastStatus command_sweep(const Arguments *arguments, int *exit_code, CastError *err)
{
  StudyConfig *config = NULL;
  Log *log = NULL;
  bool interrupted = false;
  char path[4200];
  CAST_CALL(study_config_read(arguments->target, &config, err));
  catch_signals();
  snprintf(path, sizeof path, "%.4000s/study.log", config->folder);
  CastStatus status = run_case_make_folder(config->folder, err);
  if (status == CAST_OK) status = log_open(arguments->only ? NULL : path, arguments->quiet, &log, err);
  const StudyHow how = {arguments->line, log, &stop_requested, arguments->only};
  if (status == CAST_OK) status = study_run(config, &how, &interrupted, err);
  if (interrupted) {
    log_info(log, "interrupted; the same command goes on");
    *exit_code = EXIT_INTERRUPTED;
  }
  log_close(&log);
  study_config_destroy(&config);
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

/* 0: not a number from 1 to `most`. */
static long number_above_zero(const char *text, long most)
{
  char *end = NULL;
  const long n = text ? strtol(text, &end, 10) : 0;
  return end && end != text && !*end && n >= 1 && n <= most ? n : 0;
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
      const long n = number_above_zero(i + 1 < argc ? argv[++i] : NULL, 4096);
      if (n == 0) return usage("--threads wants a number from 1 to 4096", NULL);
      omp_set_num_threads((int)n);
    } else if (strcmp(argument, "--only") == 0) {
      arguments->only = number_above_zero(i + 1 < argc ? argv[++i] : NULL, STUDY_MOST_RUNS);
      if (arguments->only == 0) return usage("--only wants the number of a run, from 1", NULL);
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
  if (arguments->only && strcmp(arguments->command, "sweep") != 0) return usage("--only goes with sweep", NULL);
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
  else if (strcmp(arguments->command, "sweep") == 0)
    status = command_sweep(arguments, &exit_code, &err);
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
