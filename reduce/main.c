/* main.c - castreduce: the command line, and how a failure reaches the user. */
#include <slepcsys.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast_build_config.h"
#include "common/log.h"
#include "common/rom/rom_picture.h"
#include "common/rom/rom_report.h"
#include "reduce/petsc/petsc_compat.h"
#include "reduce/pipeline/pipeline.h"
#include "revision.h"

static const char HELP[] =
    "castreduce - from a mould's geometry to a reduced model of its heat conduction\n"
    "\n"
    "  castreduce run MOULD.YAML [--quiet] [PETSc options]   mesh, assemble, reduce; writes the ROM file it names\n"
    "  castreduce check MOULD.YAML                           read the input and the geometry, print what was "
    "understood\n"
    "  castreduce compare MOULD.YAML [--quiet] [PETSc options]  reduce by every method; prints a table, writes CSV and "
    "plot\n"
    "  castreduce replay FILE.rom.h5 RECORD.h5 [options]     the full model driven by the heat that castrun recorded: "
    "the\n"
    "                                                        ROM's true error on that run. Options:\n"
    "      --resolved          also what lumping the heat on patches costs (record_triangles)\n"
    "      --fields TIMES      the mould's whole temperature field for ParaView, at '10 ms,0.5 s'\n"
    "      --mould MOULD.YAML  the input that the ROM was made from, if it was moved\n"
    "      --substeps N        time steps in each interval, default 4\n"
    "  castreduce info FILE.rom.h5                           print what a ROM file holds\n"
    "  castreduce picture FILE.rom.h5 OUT.png                draw its patches on the cavity wall\n"
    "  castreduce --help | --version\n"
    "\n"
    "On several processes: mpiexec -n 4 castreduce run MOULD.YAML. PETSc options tune its solvers.\n"
    "The input file is described in docs/user-guide.md.\n";

enum { EXIT_USAGE = 2 };

typedef struct Failure { // the innermost error
  bool seen;
  char message[9000];
} Failure;

static PetscErrorCode remember_error(MPI_Comm comm, int line, const char *function, const char *file,
                                     PetscErrorCode code, PetscErrorType type, const char *message, void *context)
{
  Failure *failure = context;
  (void)comm;
  if (type != PETSC_ERROR_INITIAL && failure->seen) return code;
  failure->seen = true;
  if (code == PETSC_ERR_USER || code == PETSC_ERR_NOT_CONVERGED) // what a user can mend
    snprintf(failure->message, sizeof failure->message, "%s", message ? message : "unknown error");
  else
    snprintf(failure->message, sizeof failure->message, "%s (error %d in %s, %s:%d)",
             message && message[0] ? message : "a library failed", (int)code, function, file, line);
  return code;
}

/* Did all ranks fail, as they do for faults of the input? Then one of them speaks and all end in good order. A rank
 * that failed alone would leave the others waiting: it must abort. */
static bool all_failed(MPI_Comm comm)
{
  static const double PATIENCE = 10.0; // s
  MPI_Request request;
  int done = 0;
  if (MPI_Ibarrier(comm, &request) != MPI_SUCCESS) return false;
  const double begin = log_wall_time();
  while (!done && log_wall_time() - begin < PATIENCE) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (!done) PetscSleep(0.01);
  }
  return done != 0;
}

static int report_failure(const Failure *failure, MPI_Comm failure_comm)
{
  int rank, size;
  MPI_Comm_rank(failure_comm, &rank);
  MPI_Comm_size(failure_comm, &size);
  if (all_failed(failure_comm)) {
    if (rank == 0) fprintf(stderr, "castreduce: error: %s\n", failure->message);
    return EXIT_FAILURE;
  }
  fprintf(stderr, "castreduce: error on rank %d of %d: %s\n", rank, size, failure->message);
  MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
  return EXIT_FAILURE;
}

/* A misspelt option would otherwise do nothing and say nothing. */
static PetscErrorCode warn_unused_options(void)
{
  PetscInt n;
  char **names, **values;
  PetscMPIInt rank;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(PetscOptionsLeftGet(NULL, &n, &names, &values));
  for (PetscInt i = 0; rank == 0 && i < n; i++)
    fprintf(stderr, "castreduce: warning: option -%s was not used by anything\n", names[i]);
  PetscCall(PetscOptionsLeftRestore(NULL, &n, &names, &values));
  PetscCall(PetscOptionsSetValue(NULL, "-options_left", "no")); // PETSc need not say it again
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* PETSc gets the program's name and what stands behind the input file. */
static int run_parallel(int argc, char **argv, PetscErrorCode (*step)(MPI_Comm, const PipelineTask *),
                        const PipelineTask *task)
{
  Failure failure = {false, ""};
  MPI_Comm failure_comm;
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return EXIT_FAILURE;
  PetscPopSignalHandler(); // an interrupt ends the program without a lecture
  PetscPushErrorHandler(remember_error, &failure);
  MPI_Comm_dup(PETSC_COMM_WORLD, &failure_comm);
  PetscErrorCode ierr = step(PETSC_COMM_WORLD, task);
  if (!ierr) ierr = warn_unused_options();
  int code = EXIT_SUCCESS;
  if (ierr) {
    code = report_failure(&failure, failure_comm);
    PetscOptionsSetValue(NULL, "-options_left", "no");
  }
  MPI_Comm_free(&failure_comm);
  PetscPopErrorHandler();
  ierr = SlepcFinalize();
  return ierr ? EXIT_FAILURE : code;
}

static char *join_arguments(int argc, char **argv)
{
  size_t length = 1;
  for (int i = 0; i < argc; i++) length += strlen(argv[i]) + 1;
  char *text = calloc(length, 1);
  for (int i = 0; text && i < argc; i++) {
    if (i > 0) strcat(text, " ");
    strcat(text, argv[i]);
  }
  return text;
}

/* Take "--quiet" out of the arguments; what is left behind the file must be PETSc's. */
static bool take_options(int *argc, char **argv, bool *quiet)
{
  const bool may_be_quiet = strcmp(argv[1], "check") != 0;
  int kept = 3;
  for (int i = 3; i < *argc; i++) {
    if (may_be_quiet && strcmp(argv[i], "--quiet") == 0) {
      *quiet = true;
      continue;
    }
    const bool value = i > 3 && argv[i - 1][0] == '-' && strcmp(argv[i - 1], "--quiet") != 0;
    if ((argv[i][0] != '-' && !value) || strncmp(argv[i], "--", 2) == 0) {
      fprintf(stderr, "castreduce: error: '%s' is not understood here; see castreduce --help\n", argv[i]);
      return false;
    }
    argv[kept++] = argv[i];
  }
  *argc = kept;
  return true;
}

static int run_task(int argc, char **argv, PetscErrorCode (*step)(MPI_Comm, const PipelineTask *))
{
  char *command = join_arguments(argc, argv);
  PipelineTask task = {.input_path = argv[2], .command = command ? command : "castreduce"};
  int code = EXIT_USAGE;
  if (take_options(&argc, argv, &task.quiet)) {
    argv[2] = argv[0]; // PETSc counts from its program's name
    code = run_parallel(argc - 2, argv + 2, step, &task);
  }
  free(command);
  return code;
}

/* The options of replay, taken out; what is left must be PETSc's. */
static bool take_replay_options(int *argc, char **argv, PipelineTask *task, ReplayOptions *options)
{
  int kept = 4;
  for (int i = 4; i < *argc; i++) {
    const char *value = i + 1 < *argc ? argv[i + 1] : NULL;
    char *end = NULL;
    if (strcmp(argv[i], "--quiet") == 0)
      task->quiet = true;
    else if (strcmp(argv[i], "--resolved") == 0)
      options->resolved = true;
    else if (strcmp(argv[i], "--fields") == 0 && value)
      options->fields = argv[++i];
    else if (strcmp(argv[i], "--mould") == 0 && value)
      options->mould_path = argv[++i];
    else if (strcmp(argv[i], "--substeps") == 0 && value && (options->substeps = strtol(argv[++i], &end, 10)) >= 1 &&
             !*end && options->substeps <= 1000)
      continue;
    else if (argv[i][0] == '-' && argv[i][1] != '-' && strcmp(argv[i - 1], "--substeps") != 0)
      argv[kept++] = argv[i];
    else if (kept > 4 && argv[kept - 1][0] == '-')
      argv[kept++] = argv[i];
    else {
      fprintf(stderr, "castreduce: error: '%s' is not understood here; see castreduce --help\n", argv[i]);
      return false;
    }
  }
  *argc = kept;
  return true;
}

static int run_replay(int argc, char **argv)
{
  char *command = join_arguments(argc, argv);
  ReplayOptions options = {.rom_path = argv[2], .record_path = argv[3], .substeps = 4};
  PipelineTask task = {.command = command ? command : "castreduce", .replay = &options};
  int code = EXIT_USAGE;
  if (take_replay_options(&argc, argv, &task, &options)) {
    argv[3] = argv[0]; // PETSc counts from its program's name
    code = run_parallel(argc - 3, argv + 3, pipeline_replay, &task);
  }
  free(command);
  return code;
}

static int print_info(const char *path)
{
  CastError err = {CAST_OK, ""};
  RomData *rom = NULL;
  char *text = NULL;
  CastStatus status = rom_read(path, &rom, &err);
  if (status == CAST_OK) status = rom_report(rom, path, &text, &err);
  if (status == CAST_OK)
    fputs(text, stdout);
  else
    fprintf(stderr, "castreduce: error: %s\n", err.message);
  free(text);
  rom_destroy(&rom);
  return status == CAST_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}

static int draw_picture(const char *path, const char *picture)
{
  CastError err = {CAST_OK, ""};
  RomData *rom = NULL;
  CastStatus status = rom_read(path, &rom, &err);
  if (status == CAST_OK) status = rom_picture(rom, picture, &err);
  if (status != CAST_OK) fprintf(stderr, "castreduce: error: %s\n", err.message);
  rom_destroy(&rom);
  return status == CAST_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv)
{
  const char *verb = argc > 1 ? argv[1] : "";
  if (strcmp(verb, "--help") == 0 || strcmp(verb, "-h") == 0) {
    fputs(HELP, stdout);
    return EXIT_SUCCESS;
  }
  if (strcmp(verb, "--version") == 0) {
    printf("castreduce %s (%s)\n", CAST_VERSION, CAST_REVISION);
    return EXIT_SUCCESS;
  }
  if (argc >= 3 && strcmp(verb, "run") == 0) return run_task(argc, argv, pipeline_run);
  if (argc >= 3 && strcmp(verb, "check") == 0) return run_task(argc, argv, pipeline_check);
  if (argc >= 3 && strcmp(verb, "compare") == 0) return run_task(argc, argv, pipeline_compare);
  if (argc >= 4 && strcmp(verb, "replay") == 0) return run_replay(argc, argv);
  if (argc == 3 && strcmp(verb, "info") == 0) return print_info(argv[2]);
  if (argc == 4 && strcmp(verb, "picture") == 0) return draw_picture(argv[2], argv[3]);
  if (argc > 1) fprintf(stderr, "castreduce: error: '%s' with %d more arguments is not understood\n\n", verb, argc - 2);
  fputs(HELP, stderr);
  return EXIT_USAGE;
}
