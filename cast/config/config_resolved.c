/* config_resolved.c - the input as castrun understood it: every default filled in, SI, readable by castrun again. */
#define _GNU_SOURCE // realpath, open_memstream
#include "cast/config/config_private.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A file's absolute name, or the name as it is where there is no such file (yet). */
static void put_path(FILE *out, const char *path)
{
  char absolute[PATH_MAX];
  if (realpath(path, absolute)) {
    config_put_text(out, absolute);
    return;
  }
  char folder[PATH_MAX] = "";
  if (path[0] != '/' && realpath(".", folder)) {
    char joined[2 * PATH_MAX];
    snprintf(joined, sizeof joined, "%s/%s", folder, path);
    config_put_text(out, joined);
  } else {
    config_put_text(out, path);
  }
}

/* Spaces that every line of a block map but its first (which stands behind its key) begins with. */
static size_t common_indent(const char *text)
{
  size_t least = SIZE_MAX;
  for (const char *line = strchr(text, '\n'); line; line = strchr(line, '\n')) {
    line++;
    const size_t indent = strspn(line, " ");
    if (line[indent] != '\n' && line[indent] != '\0' && line[indent] != '#' && indent < least) least = indent;
  }
  return least == SIZE_MAX ? 0 : least;
}

/* An inline material, moved to the indentation that it has here. */
static void put_inline_material(FILE *out, const char *text)
{
  const bool flow = text[0] == '{';
  const size_t indent = flow ? 0 : common_indent(text);
  fputs(flow ? "  material: " : "  material:\n", out);
  const char *line = text;
  for (bool first = true; *line; first = false) {
    const size_t length = strcspn(line, "\n");
    const size_t blank = strspn(line, " "), skip = first ? 0 : blank < indent ? blank : indent;
    if (length > blank) fprintf(out, "%s%.*s\n", flow && first ? "" : "    ", (int)(length - skip), line + skip);
    line += length;
    if (*line) line++;
  }
}

static void put_melt(FILE *out, const CastConfig *c)
{
  fputs("melt:\n", out);
  if (c->melt_reference) {
    fputs("  material: ", out);
    const bool is_path = strchr(c->melt_reference, '/') || strstr(c->melt_reference, ".yaml");
    if (is_path)
      put_path(out, c->melt_reference);
    else
      config_put_text(out, c->melt_reference);
    fprintf(out, "   # sha256 %s\n", c->melt.sha256);
  } else {
    put_inline_material(out, c->melt.text);
  }
  fprintf(out, "  temperature: %.17g K\n", c->melt_temperature);
  if (c->has_level) fprintf(out, "  cavity_below: %.17g m\n", c->level);
  if (c->n_blocks) fputs("  blocks:\n", out);
  for (size_t i = 0; i < c->n_blocks; i++) {
    const BlockConfig *block = &c->block[i];
    fputs("    - corner: ", out);
    config_put_vector(out, block->corner, "m");
    fputs("\n      size: ", out);
    config_put_vector(out, block->size, "m");
    fprintf(out, "\n      temperature: %.17g K\n      velocity: ", block->temperature);
    config_put_vector(out, block->velocity, "m/s");
    fputc('\n', out);
  }
  config_put_pour(out, c);
}

static void put_sph(FILE *out, const CastConfig *c, double sound_speed)
{
  const double speed = sound_speed > 0.0 ? sound_speed : c->sound_speed;
  fprintf(out, "sph:\n  spacing: %.17g m\n  kernel: %s\n  smoothing: %.17g\n", c->spacing, kernel_name(c->kernel),
          c->smoothing);
  if (speed > 0.0)
    fprintf(out, "  sound_speed: %.17g m/s%s\n", speed, c->sound_speed > 0.0 ? "" : "   # auto");
  else
    fputs("  sound_speed: auto\n", out);
  fprintf(out, "  density: %s\n", c->density == SPH_SUMMATION ? "summation" : "continuity");
  if (c->density == SPH_CONTINUITY) fprintf(out, "  density_diffusion: %.17g\n", c->density_diffusion);
  fprintf(out, "  artificial_viscosity: %.17g\n  negative_pressure: %s\n", c->artificial_viscosity,
          c->cut_tension ? "cut" : "keep");
}

static void put_points(FILE *out, const char *what, const char *where, size_t n, const PointConfig *point)
{
  if (n == 0) return;
  fprintf(out, "  %s:\n", what);
  for (size_t i = 0; i < n; i++) {
    fputs("    - name: ", out);
    config_put_text(out, point[i].name);
    fprintf(out, "\n      %s: ", where);
    config_put_vector(out, point[i].x, "m");
    fputc('\n', out);
  }
}

static void put_output(FILE *out, const OutputConfig *o)
{
  fputs("output:\n  folder: ", out);
  put_path(out, o->folder);
  fprintf(out, "\n  every: %.17g s\n  curves_every: %.17g s\n  checkpoint_every: %.17g s\n  mould_fields: %s\n",
          o->every, o->curves_every, o->checkpoint_every, o->mould_fields ? "true" : "false");
  if (o->record_every > 0.0)
    fprintf(out, "  record_every: %.17g s\n  record_triangles: %s\n", o->record_every,
            o->record_triangles ? "true" : "false");
  put_points(out, "probes", "position", o->n_probes, o->probe);
  put_points(out, "tracers", "nearest", o->n_tracers, o->tracer);
}

static void put_cool(FILE *out, const CoolConfig *cool)
{
  if (!cool->wanted) return;
  fprintf(out, "  cool:\n    end: %.17g s\n    begin: %s\n    until: %s\n    tolerance: %.17g K\n    every: %.17g s\n",
          cool->end, cool->at_end ? "at-end" : "at-rest", cool->until_solid ? "solid" : "end", cool->tolerance,
          cool->every);
  if (cool->curves_every > 0.0) fprintf(out, "    curves_every: %.17g s\n", cool->curves_every);
}

static void put_coupling(FILE *out, const CouplingParameters *c)
{
  fprintf(out, "coupling: { kind: %s, mould: %s", c->kind == COUPLING_SURFACE ? "surface" : "embedded",
          c->mould_frozen ? "frozen" : "live");
  if (c->kind == COUPLING_SURFACE && !c->mould_frozen) {
    if (isfinite(c->mould_interval) && c->mould_interval > 0.0)
      fprintf(out, ", mould_step: %.17g s", c->mould_interval);
    else
      fprintf(out, ", mould_step: %s", c->mould_interval > 0.0 ? "auto" : "each");
  }
  fputs(" }\n", out);
}

static void put_config(FILE *out, const CastConfig *c, double sound_speed)
{
  fputs("# The input as castrun understood it: SI, every default filled in.\ntitle: ", out);
  config_put_text(out, c->title);
  fputs("\nrom: ", out);
  put_path(out, c->rom_path);
  fprintf(out, "\npreheat: %.17g K\nambient: %.17g K\n", c->preheat, c->ambient);
  put_melt(out, c);
  config_put_forces(out, c);
  config_put_contact(out, c);
  put_coupling(out, &c->coupling);
  config_put_walls(out, c);
  config_put_tension(out, c);
  put_sph(out, c, sound_speed);
  fprintf(out, "time:\n  end: %.17g s\n", c->end);
  put_cool(out, &c->cool);
  if (c->step > 0.0)
    fprintf(out, "  step: %.17g s\n", c->step);
  else
    fputs("  step: auto\n", out);
  fprintf(out, "  scheme: %s\n", c->scheme == ROM_EXPONENTIAL ? "exponential" : "backward-euler");
  config_put_features(out, c);
  if (c->n_part) fputs("part: [", out);
  for (size_t i = 0; i < c->n_part; i++) {
    if (i) fputs(", ", out);
    config_put_text(out, c->part[i]);
  }
  if (c->n_part) fputs("]\n", out);
  put_output(out, &c->output);
}

CastStatus cast_config_resolved(const CastConfig *config, double sound_speed, char **text, CastError *err)
{
  *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(text, &size);
  CAST_CHECK(out, err, CAST_ERR_MEMORY, "no memory for the resolved input");
  put_config(out, config, sound_speed);
  const int failed = fclose(out);
  if (failed) {
    free(*text);
    *text = NULL;
  }
  CAST_CHECK(!failed, err, CAST_ERR_MEMORY, "no memory for the resolved input");
  return CAST_OK;
}
