#define _GNU_SOURCE // mkdtemp, wait4
#include "tests/bench/lammps.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SHORT_RUN = 20, LONG_RUN = 120 };

static bool is_on_path(const char *program)
{
  const char *path = getenv("PATH");
  char copy[8192], file[8300];
  snprintf(copy, sizeof copy, "%s", path ? path : "");
  for (char *rest = NULL, *folder = strtok_r(copy, ":", &rest); folder; folder = strtok_r(NULL, ":", &rest)) {
    snprintf(file, sizeof file, "%s/%s", folder, program);
    if (access(file, X_OK) == 0) return true;
  }
  return false;
}

/* Atoms of atom_style sph: number, type, rho, internal energy, heat capacity, place. Walls are of type 2. */
static bool write_atoms(const char *path, const Particles *p)
{
  FILE *out = fopen(path, "w");
  if (!out) return false;
  fprintf(out, "breaking column\n\n%td atoms\n2 atom types\n\n", p->n);
  for (int d = 0; d < 3; d++) {
    double low = INFINITY, high = -INFINITY;
    for (ptrdiff_t i = 0; i < p->n; i++) {
      low = fmin(low, p->x[d][i]);
      high = fmax(high, p->x[d][i]);
    }
    fprintf(out, "%g %g %clo %chi\n", low - 0.02, high + 0.12, "xyz"[d], "xyz"[d]);
  }
  fprintf(out, "\nMasses\n\n1 %.10g\n2 %.10g\n\nAtoms # sph\n\n", p->mass[0], p->mass[0]);
  for (ptrdiff_t i = 0; i < p->n; i++)
    fprintf(out, "%td %d 1000.0 %.1f 1.0 %.6f %.6f %.6f\n", i + 1, i < p->n_fluid ? 1 : 2, i < p->n_fluid ? 0.3 : 0.0,
            p->x[0][i], p->x[1][i], p->x[2][i]);
  return fclose(out) == 0;
}

/* Forces, continuity and heat of all pairs but those of two walls; lists with a skin of a tenth of the support. */
static bool write_deck(const char *path, const SphParameters *sph, double dt)
{
  const double support = 2.0 * sph->h;
  FILE *out = fopen(path, "w");
  if (!out) return false;
  fprintf(out,
          "units si\natom_style sph\nboundary f f f\nnewton on\ncomm_modify vel yes\nread_data atoms\n"
          "group fluid type 1\ngroup wall type 2\n"
          "pair_style hybrid/overlay sph/taitwater sph/heatconduction\n"
          "pair_coeff * * sph/taitwater %g %g %g %g\npair_coeff * * sph/heatconduction 1e-5 %g\n"
          "neighbor %g bin\nneigh_modify every 5 delay 0 check yes exclude type 2 2\n"
          "fix g fluid gravity %g vector 0 0 -1\nfix f fluid sph\nfix w wall sph/stationary\n"
          "timestep %g\nthermo 1000\nrun ${steps}\n",
          sph->rho0, sph->c0, sph->alpha, support, support, 0.1 * support, -sph->gravity[2], dt);
  return fclose(out) == 0;
}

/* User time of one run, s; NAN: it failed. */
static double run(const char *folder, int steps)
{
  char count[16];
  snprintf(count, sizeof count, "%d", steps);
  const pid_t child = fork();
  if (child == 0) {
    const int nothing = open("/dev/null", O_WRONLY);
    setenv("OMP_NUM_THREADS", "1", 1);
    if (nothing < 0 || chdir(folder) != 0) _exit(126);
    dup2(nothing, STDOUT_FILENO);
    dup2(nothing, STDERR_FILENO);
    execlp("lmp", "lmp", "-in", "deck", "-log", "none", "-var", "steps", count, (char *)NULL);
    _exit(127);
  }
  int status = 0;
  struct rusage use = {0};
  if (child < 0 || wait4(child, &status, 0, &use) != child) return (double)NAN;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return (double)NAN;
  return (double)use.ru_utime.tv_sec + 1e-6 * (double)use.ru_utime.tv_usec;
}

double lammps_time(const LatticeTank *tank, double dt, char note[160])
{
  char folder[] = "/tmp/bench_lammps_XXXXXX", atoms[64], deck[64];
  snprintf(note, 160, "no lmp on this machine");
  if (!is_on_path("lmp") || !mkdtemp(folder)) return (double)NAN;
  snprintf(atoms, sizeof atoms, "%s/atoms", folder);
  snprintf(deck, sizeof deck, "%s/deck", folder);
  double us = (double)NAN;
  if (write_atoms(atoms, &tank->particles) && write_deck(deck, &tank->sph, dt)) {
    const double few = run(folder, SHORT_RUN), many = run(folder, LONG_RUN);
    us = 1e6 * (many - few) / ((LONG_RUN - SHORT_RUN) * (double)tank->particles.n_fluid);
  }
  snprintf(note, 160, "%s",
           isnan(us) ? "lmp does not run the deck: no SPH package?" : "lmp, momentum, continuity, heat");
  remove(atoms);
  remove(deck);
  rmdir(folder);
  return us;
}
