#include "cast/particles/particles.h"

#include <stdlib.h>
#include <string.h>

void particles_fields(const Particles *p, ParticleField field[PARTICLE_FIELDS])
{
  const ParticleField all[PARTICLE_FIELDS] = {
      {"x", "m", p->x[0]},
      {"y", "m", p->x[1]},
      {"z", "m", p->x[2]},
      {"v_x", "m/s", p->v[0]},
      {"v_y", "m/s", p->v[1]},
      {"v_z", "m/s", p->v[2]},
      {"a_x", "m/s2", p->a[0]},
      {"a_y", "m/s2", p->a[1]},
      {"a_z", "m/s2", p->a[2]},
      {"rho", "kg/m3", p->rho},
      {"drho", "kg/(m3 s)", p->drho},
      {"p", "Pa", p->p},
      {"mass", "kg", p->mass},
      {"volume", "m3", p->volume},
      {"E", "J/kg", p->E},
      {"heat", "W", p->heat},
      {"T", "K", p->T},
      {"kappa", "W/(m K)", p->kappa},
      {"mu", "Pa s", p->mu},
      {"rho_start", "kg/m3", p->rho_start},
      {"drho_last", "kg/(m3 s)", p->drho_last},
      {"clearance", "m", p->clearance},
  };
  memcpy(field, all, sizeof all);
}

/* Zeroed room for `count` values of `size` bytes, aligned to a cache line so that vectors load whole lines. */
static void *allocate(ptrdiff_t count, size_t size)
{
  const size_t bytes = ((size_t)(count > 0 ? count : 1) * size + 63) / 64 * 64;
  void *room = aligned_alloc(64, bytes);
  if (room) memset(room, 0, bytes);
  return room;
}

static bool allocate_double(ptrdiff_t count, double **field)
{
  *field = allocate(count, sizeof **field);
  return *field != NULL;
}

static bool allocate_fields(Particles *p)
{
  double **const scalar[] = {&p->rho, &p->drho,  &p->p,  &p->mass,      &p->volume,    &p->E,        &p->heat,
                             &p->T,   &p->kappa, &p->mu, &p->rho_start, &p->drho_last, &p->clearance};
  bool ok = true;
  for (size_t f = 0; f < sizeof scalar / sizeof *scalar; f++) ok = allocate_double(p->n, scalar[f]) && ok;
  const ptrdiff_t n_wall = p->n - p->n_fluid;
  for (int d = 0; d < 3; d++) {
    ok = allocate_double(p->n, &p->x[d]) && allocate_double(p->n, &p->v[d]) && allocate_double(p->n, &p->a[d]) && ok;
    ok = allocate_double(n_wall, &p->foot[d]) && allocate_double(n_wall, &p->normal[d]) &&
         allocate_double(n_wall, &p->wall_v[d]) && ok;
  }
  p->id = allocate(p->n, sizeof *p->id);
  p->patch = allocate(n_wall, sizeof *p->patch);
  p->echo = allocate(n_wall, sizeof *p->echo);
  p->record = allocate(p->n * RECORD_SIZE, sizeof *p->record);
  return allocate_double(n_wall, &p->depth) && p->record && p->id && p->patch && p->echo && ok;
}

static void fill_fluid(Particles *p, double *const x[3], double spacing, double rho0)
{
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    for (int d = 0; d < 3; d++) p->x[d][i] = x[d][i];
    p->rho[i] = p->rho_start[i] = rho0;
    p->volume[i] = spacing * spacing * spacing;
    p->mass[i] = rho0 * p->volume[i];
    p->id[i] = (int32_t)i;
  }
}

static void fill_walls(Particles *p, double rho0, const WallSet *walls)
{
  for (ptrdiff_t k = 0; k < p->n - p->n_fluid; k++) {
    const ptrdiff_t i = p->n_fluid + k;
    for (int d = 0; d < 3; d++) {
      p->x[d][i] = walls->x[d][k];
      p->foot[d][k] = walls->foot[d][k];
      p->normal[d][k] = walls->normal[d][k];
    }
    p->depth[k] = walls->depth[k];
    p->patch[k] = walls->patch[k];
    p->echo[k] = walls->echo ? walls->echo[k] : 0;
    p->rho[i] = rho0;
    p->volume[i] = walls->volume[k];
    p->mass[i] = rho0 * walls->volume[k];
    p->id[i] = (int32_t)i;
  }
}

CastStatus particles_create(ptrdiff_t n_fluid, double *const x[3], double spacing, double rho0, const WallSet *walls,
                            Particles *particles, CastError *err)
{
  const ptrdiff_t n = n_fluid + (walls ? walls->n : 0);
  *particles = (Particles){.n = n, .n_fluid = n_fluid, .capacity_fluid = n_fluid};
  CAST_CHECK(n < INT32_MAX, err, CAST_ERR_ARGUMENT, "particles: %td are too many, the most is %d", n, INT32_MAX - 1);
  if (!allocate_fields(particles)) {
    particles_destroy(particles);
    return cast_error_set(err, CAST_ERR_MEMORY, "particles: no memory for %td of them", n);
  }
  fill_fluid(particles, x, spacing, rho0);
  if (walls) fill_walls(particles, rho0, walls);
  return CAST_OK;
}

/* ---- growing ---- */

enum { GROWING = PARTICLE_FIELDS + 2 }; // the fields, id, record

/* Where the arrays of all [n] fields are kept, and the bytes of an entry. */
static void growing_arrays(Particles *p, void **array[GROWING], size_t size[GROWING])
{
  double **const scalar[] = {&p->rho, &p->drho,  &p->p,  &p->mass,      &p->volume,    &p->E,        &p->heat,
                             &p->T,   &p->kappa, &p->mu, &p->rho_start, &p->drho_last, &p->clearance};
  int k = 0;
  for (size_t f = 0; f < sizeof scalar / sizeof *scalar; f++) array[k++] = (void **)scalar[f];
  for (int d = 0; d < 3; d++) {
    array[k++] = (void **)&p->x[d];
    array[k++] = (void **)&p->v[d];
    array[k++] = (void **)&p->a[d];
  }
  for (int f = 0; f < k; f++) size[f] = sizeof(double);
  array[k] = (void **)&p->id;
  size[k++] = sizeof *p->id;
  array[k] = (void **)&p->record;
  size[k++] = RECORD_SIZE * sizeof *p->record;
}

/* Arrays for `capacity` fluid particles with the same content, all or none. */
static bool grow(Particles *p, ptrdiff_t capacity)
{
  void **array[GROWING], *made[GROWING];
  size_t size[GROWING];
  growing_arrays(p, array, size);
  const ptrdiff_t n_wall = p->n - p->n_fluid;
  bool ok = true;
  for (int k = 0; k < GROWING; k++) ok = (made[k] = allocate(capacity + n_wall, size[k])) && ok;
  for (int k = 0; k < GROWING; k++) {
    if (ok) memcpy(made[k], *array[k], (size_t)p->n * size[k]);
    free(ok ? *array[k] : made[k]);
    if (ok) *array[k] = made[k];
  }
  if (ok) p->capacity_fluid = capacity;
  return ok;
}

CastStatus particles_add(Particles *p, ptrdiff_t more, CastError *err)
{
  const ptrdiff_t n_fluid = p->n_fluid + more, n_wall = p->n - p->n_fluid;
  CAST_CHECK(n_fluid + n_wall < INT32_MAX, err, CAST_ERR_ARGUMENT, "particles: %td are too many, the most is %d",
             n_fluid + n_wall, INT32_MAX - 1);
  if (n_fluid > p->capacity_fluid && !grow(p, n_fluid + n_fluid / 4))
    return cast_error_set(err, CAST_ERR_MEMORY, "particles: no memory for %td of them", n_fluid + n_wall);
  void **array[GROWING];
  size_t size[GROWING];
  growing_arrays(p, array, size);
  for (int k = 0; k < GROWING; k++) {
    char *bytes = *array[k];
    memmove(bytes + (size_t)n_fluid * size[k], bytes + (size_t)p->n_fluid * size[k], (size_t)n_wall * size[k]);
    memset(bytes + (size_t)p->n_fluid * size[k], 0, (size_t)more * size[k]);
  }
  p->n_fluid = n_fluid;
  p->n = n_fluid + n_wall;
  return CAST_OK;
}

void particles_destroy(Particles *p)
{
  if (!p) return;
  double *const scalar[] = {p->rho, p->drho,  p->p,  p->mass,      p->volume,    p->E,         p->heat,
                            p->T,   p->kappa, p->mu, p->rho_start, p->drho_last, p->clearance, p->depth};
  for (size_t f = 0; f < sizeof scalar / sizeof *scalar; f++) free(scalar[f]);
  for (int d = 0; d < 3; d++) {
    free(p->x[d]);
    free(p->v[d]);
    free(p->a[d]);
    free(p->foot[d]);
    free(p->normal[d]);
    free(p->wall_v[d]);
  }
  free(p->record);
  free(p->id);
  free(p->patch);
  free(p->echo);
  *p = (Particles){0};
}
