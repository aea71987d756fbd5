#include "common/rom/rom_report.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Extent { // of a set of points, m
  double low[3], high[3];
} Extent;

static Extent measure_extent(const RomData *rom)
{
  Extent extent = {{DBL_MAX, DBL_MAX, DBL_MAX}, {-DBL_MAX, -DBL_MAX, -DBL_MAX}};
  for (size_t i = 0; i < 3 * rom->n_points; i++) {
    extent.low[i % 3] = fmin(extent.low[i % 3], rom->points[i]);
    extent.high[i % 3] = fmax(extent.high[i % 3], rom->points[i]);
  }
  return extent;
}

/* By the divergence theorem, m3. */
static double enclosed_volume(const RomData *rom)
{
  double volume = 0.0;
  for (size_t t = 0; t < rom->n_triangles; t++) {
    const double *a = rom->points + 3 * (size_t)rom->triangles[3 * t];
    const double *b = rom->points + 3 * (size_t)rom->triangles[3 * t + 1];
    const double *c = rom->points + 3 * (size_t)rom->triangles[3 * t + 2];
    volume +=
        (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) /
        6.0;
  }
  return volume;
}

static size_t count_cavity_patches(const RomData *rom)
{
  size_t count = 0;
  while (count < rom->m && !rom->patch[count].outer) count++;
  return count;
}

/* 1.5e-3 -> "0.15 %" */
static const char *percent(double value, char buffer[32])
{
  if (isnan(value)) return "not computed";
  snprintf(buffer, 32, "%.3g %%", 100.0 * value);
  return buffer;
}

static const char *duration(double seconds, char buffer[32])
{
  if (seconds < 1e-3)
    snprintf(buffer, 32, "%.3g us", 1e6 * seconds);
  else if (seconds < 1.0)
    snprintf(buffer, 32, "%.3g ms", 1e3 * seconds);
  else if (seconds < 600.0)
    snprintf(buffer, 32, "%.3g s", seconds);
  else if (seconds < 36000.0)
    snprintf(buffer, 32, "%.3g min", seconds / 60.0);
  else
    snprintf(buffer, 32, "%.3g h", seconds / 3600.0);
  return buffer;
}

void rom_report_verdict(const RomData *rom, char *text, size_t size)
{
  const RomCertificate *certificate = &rom->certificate;
  char error[32], tolerance[32], start[32], end[32];
  if (isnan(certificate->step_error_max))
    snprintf(text, size, "no error was measured: nothing is known of the tolerance of %s asked for",
             percent(rom->tolerance, tolerance));
  else
    snprintf(text, size, "%s of the largest temperature rise from %s to %s, %s asked for: %s",
             percent(certificate->step_error_max, error), duration(rom->t_start, start), duration(rom->t_end, end),
             percent(rom->tolerance, tolerance), certificate->met ? "met" : "NOT met");
}

static void report_head(FILE *out, const RomData *rom, const char *path)
{
  const RomProvenance *provenance = &rom->provenance;
  char verdict[256];
  rom_report_verdict(rom, verdict, sizeof verdict);
  if (path) fprintf(out, "%s\n", path);
  fprintf(out, "Reduced thermal model of a mould, format %d.%d", ROM_FORMAT_MAJOR, ROM_FORMAT_MINOR);
  if (rom->title && rom->title[0]) fprintf(out, ": %s", rom->title);
  const size_t cavity = count_cavity_patches(rom);
  fprintf(out, "\n  states     %zu, reduced from %zu unknowns\n", rom->r, rom->n_full);
  fprintf(out, "  patches    %zu on the cavity wall, %zu on outer surfaces\n", cavity, rom->m - cavity);
  fprintf(out, "  error      %s\n", verdict);
  if (provenance->program && provenance->program[0])
    fprintf(out, "  made       by %s %s%s%s%s%s\n", provenance->program, provenance->version,
            provenance->created[0] ? " on " : "", provenance->created, provenance->host[0] ? ", machine " : "",
            provenance->host);
}

static void report_geometry(FILE *out, const RomData *rom)
{
  fprintf(out, "\nGeometry\n");
  if (rom->n_triangles == 0) {
    fprintf(out, "  none: the model was reduced from matrices; castrun cannot pour into it\n");
    return;
  }
  const Extent extent = measure_extent(rom);
  fprintf(out, "  mould      x %.4g to %.4g mm, y %.4g to %.4g mm, z %.4g to %.4g mm\n", 1e3 * extent.low[0],
          1e3 * extent.high[0], 1e3 * extent.low[1], 1e3 * extent.high[1], 1e3 * extent.low[2], 1e3 * extent.high[2]);
  fprintf(out, "  volume     %.4g cm3, heat capacity %.4g J/K\n", 1e6 * enclosed_volume(rom), rom->heat_capacity);
  fprintf(out, "  boundary   %zu triangles, shortest edge in the cavity %.3g mm\n", rom->n_triangles,
          1e3 * rom->min_edge);
  fprintf(out, "  band       %zu tetrahedra on %zu points, %.3g mm into the mould\n", rom->n_tetrahedra, rom->n_points,
          1e3 * rom->band);
}

static void report_materials(FILE *out, const RomData *rom)
{
  if (rom->n_materials == 0) return;
  fprintf(out, "\nMaterials          W/(m K)   kg/m3  J/(kg K)  alpha mm2/s   taken at\n");
  for (size_t i = 0; i < rom->n_materials; i++) {
    const RomMaterial *material = &rom->material[i];
    char at[32] = "not stated";
    if (!isnan(material->reference_temperature))
      snprintf(at, sizeof at, "%.0f degC", material->reference_temperature - 273.15);
    fprintf(out, "  %-16s %7.4g %7.4g %9.4g %12.4g   %-10s  %.34s\n", material->region, material->conductivity,
            material->density, material->specific_heat,
            1e6 * material->conductivity / (material->density * material->specific_heat), at, material->name);
  }
}

/* One line for each named surface: its patches, their areas and what it does to the heat. */
static void report_surface(FILE *out, const RomData *rom, size_t first)
{
  const RomPatch *patch = &rom->patch[first];
  size_t count = 0;
  double total = 0.0, least = DBL_MAX, most = 0.0;
  for (size_t l = first; l < rom->m; l++) {
    if (strcmp(rom->patch[l].surface, patch->surface) != 0) continue;
    count++;
    total += rom->patch[l].area;
    least = fmin(least, rom->patch[l].area);
    most = fmax(most, rom->patch[l].area);
  }
  char kind[64] = "cavity wall";
  if (patch->outer && patch->fixed)
    snprintf(kind, sizeof kind, "outer, fixed temperature");
  else if (patch->outer && patch->h > 0.0)
    snprintf(kind, sizeof kind, "outer, h = %.4g W/(m2 K)", patch->h);
  else if (patch->outer)
    snprintf(kind, sizeof kind, "outer, insulated");
  fprintf(out, "  %-16s %7zu %10.4g", patch->surface, count, 1e6 * total);
  if (count > 1)
    fprintf(out, "   %8.3g to %-8.3g", 1e6 * least, 1e6 * most);
  else
    fprintf(out, "   %8.3g %11s", 1e6 * total, "");
  fprintf(out, "  %s\n", kind);
}

static void report_patches(FILE *out, const RomData *rom)
{
  fprintf(out, "\nSurfaces          patches   area mm2   each, mm2\n");
  for (size_t l = 0; l < rom->m; l++) {
    bool seen = false;
    for (size_t k = 0; k < l && !seen; k++) seen = strcmp(rom->patch[k].surface, rom->patch[l].surface) == 0;
    if (!seen) report_surface(out, rom, l);
  }
}

static void report_reduction(FILE *out, const RomData *rom)
{
  char start[32], end[32];
  fprintf(out, "\nReduction\n  method     %s", rom->method);
  if (rom->moments > 0 && rom->n_shifts > 0)
    fprintf(out, ", %ld moment%s an input at each of %zu shift%s", rom->moments, rom->moments == 1 ? "" : "s",
            rom->n_shifts, rom->n_shifts == 1 ? "" : "s");
  if (rom->n_shifts > 0) {
    fprintf(out, "\n  shifts    ");
    for (size_t i = 0; i < rom->n_shifts; i++)
      fprintf(out, i % 12 == 11 ? "\n             %.3g" : " %.3g", rom->shifts[i]);
    fprintf(out, " 1/s");
  }
  fprintf(out, "\n  times      %s to %s\n", duration(rom->t_start, start), duration(rom->t_end, end));
  const double fastest = rom->lambda[rom->r - 1], slowest = rom->lambda[0];
  fprintf(out, "  rates      %.3g to %.3g 1/s", slowest, fastest);
  if (fastest > 0.0) fprintf(out, " (time constants %s", duration(1.0 / fastest, start));
  if (fastest > 0.0) fprintf(out, " to %s)", slowest > 1e-12 * fastest ? duration(1.0 / slowest, end) : "for ever");
  fprintf(out, "\n");
}

/* The largest error of each decade of times. */
static void report_step_errors(FILE *out, const RomCertificate *certificate)
{
  char from[32], to[32], text[32];
  for (size_t i = 0, next; i < certificate->n_times; i = next) {
    double most = NAN;
    for (next = i; next < certificate->n_times && certificate->time[next] < 9.99 * certificate->time[i]; next++)
      most = fmax(most, certificate->step_error[next]); // fmax passes over NaN
    if (next == i) next++;                              // a time of zero
    duration(certificate->time[i], from);
    duration(certificate->time[next - 1], to);
    fprintf(out, "    %8s to %-8s  %s\n", from, to, percent(most, text));
  }
}

static void report_certificate(FILE *out, const RomData *rom)
{
  const RomCertificate *certificate = &rom->certificate;
  char text[32];
  fprintf(out, "\nCertificate\n");
  if (isnan(certificate->step_error_max) && certificate->n_frequencies == 0) fprintf(out, "  none\n");
  if (!isnan(certificate->step_error_max))
    fprintf(out, "  step responses of %ld patches, full model against ROM: %s at most\n", certificate->sampled_patches,
            percent(certificate->step_error_max, text));
  report_step_errors(out, certificate);
  if (certificate->n_frequencies > 0)
    fprintf(out, "  transfer function, upper bounds; interpolated between\n");
  for (size_t i = 0; i < certificate->n_frequencies; i++)
    fprintf(out, "    w = %-10.3g rad/s  %s\n", certificate->frequency[i],
            percent(certificate->transfer_bound[i], text));
  if (certificate->second_stage_bound > 0.0)
    fprintf(out, "  second stage: changes the transfer function by at most %.3g K/W\n",
            certificate->second_stage_bound);
  if (certificate->moment_error < 1e-3)
    fprintf(out, "  moments matched to %.2g\n", certificate->moment_error);
  else if (isnan(certificate->moment_error) && certificate->second_stage_bound > 0.0)
    fprintf(out, "  moments at the shifts: not kept after the second stage\n");
  else if (!isnan(certificate->moment_error))
    fprintf(out, "  moments at the shifts are not matched (relative difference %.2g)%s\n", certificate->moment_error,
            certificate->second_stage_bound > 0.0 ? ": the second stage does not keep them" : "");
  if (!isnan(certificate->orthogonality)) fprintf(out, "  |V^T E V - I| at most %.2g\n", certificate->orthogonality);
}

static void report_text(FILE *out, const char *label, const char *text)
{
  if (text && text[0]) fprintf(out, "  %-10s %s\n", label, text);
}

static void report_provenance(FILE *out, const RomData *rom)
{
  const RomProvenance *provenance = &rom->provenance;
  char mesh[32], assembly[32], reduction[32], certificate[32];
  if (!provenance->program || !provenance->program[0]) return;
  fprintf(out, "\nProvenance\n");
  report_text(out, "command", provenance->command);
  report_text(out, "input", provenance->input_path);
  report_text(out, rom->n_triangles > 0 ? "geometry" : "matrices", provenance->geometry_sha256);
  for (size_t i = 0; i < rom->n_materials; i++) report_text(out, rom->material[i].region, rom->material[i].sha256);
  report_text(out, "libraries", provenance->libraries);
  fprintf(out, "  time       mesh %s, assembly %s, reduction %s, certificate %s, on %d rank%s\n",
          duration(provenance->seconds_mesh, mesh), duration(provenance->seconds_assembly, assembly),
          duration(provenance->seconds_reduction, reduction), duration(provenance->seconds_certificate, certificate),
          provenance->ranks, provenance->ranks == 1 ? "" : "s");
}

CastStatus rom_report(const RomData *rom, const char *path, char **text, CastError *err)
{
  size_t size = 0;
  *text = NULL;
  FILE *out = open_memstream(text, &size);
  CAST_CHECK(out, err, CAST_ERR_MEMORY, "no memory for a report");
  report_head(out, rom, path);
  report_geometry(out, rom);
  report_materials(out, rom);
  report_patches(out, rom);
  report_reduction(out, rom);
  report_certificate(out, rom);
  report_provenance(out, rom);
  const bool failed = ferror(out) != 0;
  if (fclose(out) == 0 && !failed) return CAST_OK;
  free(*text);
  *text = NULL;
  return cast_error_set(err, CAST_ERR_MEMORY, "no memory for a report");
}
