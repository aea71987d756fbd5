#include "cast/io/xmf.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static const char *base_name(const char *path)
{
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

/* The whole set, as a plain item: of a mesh that stays, ParaView's reader complains about points in a slab. */
static void put_set(FILE *out, const char *indent, const char *file, const char *set, long long rows, int columns,
                    bool integer)
{
  char shape[64];
  if (columns == 1)
    snprintf(shape, sizeof shape, "%lld", rows);
  else
    snprintf(shape, sizeof shape, "%lld %d", rows, columns);
  fprintf(out,
          "%s<DataItem Dimensions=\"%s\" NumberType=\"%s\" Precision=\"4\" Format=\"HDF\">%s:/VTKHDF/%s</DataItem>\n",
          indent, shape, integer ? "Int" : "Float", file, set);
}

typedef struct Slab { // rows [first, first + rows) of a set of `total` rows
  long long first, rows, total;
  int columns;
  bool integer;
} Slab;

static void put_slab(FILE *out, const char *file, const char *set, const Slab *slab)
{
  const long long first = slab->first, rows = slab->rows;
  const int columns = slab->columns;
  if (first == 0 && rows == slab->total) {
    put_set(out, "        ", file, set, rows, columns, slab->integer);
    return;
  }
  if (columns == 1)
    fprintf(out,
            "        <DataItem ItemType=\"HyperSlab\" Dimensions=\"%lld\">\n"
            "          <DataItem Dimensions=\"3 1\" NumberType=\"Int\" Format=\"XML\">%lld 1 %lld</DataItem>\n",
            rows, first, rows);
  else
    fprintf(out,
            "        <DataItem ItemType=\"HyperSlab\" Dimensions=\"%lld %d\">\n"
            "          <DataItem Dimensions=\"3 2\" NumberType=\"Int\" Format=\"XML\">%lld 0 1 1 %lld %d</DataItem>\n",
            rows, columns, first, rows, columns);
  put_set(out, "          ", file, set, slab->total, columns, slab->integer);
  fputs("        </DataItem>\n", out);
}

static void put_topology(FILE *out, const char *file, const VtkStep *step, const XmfPart *part)
{
  if (!part) {
    fprintf(out, "      <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"%lld\" NodesPerElement=\"1\"/>\n",
            step->n_points);
    return;
  }
  fprintf(out,
          "      <Topology TopologyType=\"%s\" NumberOfElements=\"%zu\">\n"
          "        <DataItem Dimensions=\"%zu %d\" NumberType=\"Int\" Precision=\"4\" Format=\"HDF\">%s:%s</DataItem>\n"
          "      </Topology>\n",
          part->topology, part->n_cells, part->n_cells, part->corners, file, part->set);
}

static void put_grid(FILE *out, const VtkSeries *series, const VtkStep *step, const XmfPart *part)
{
  const char *file = base_name(vtk_series_path(series));
  fprintf(out, "    <Grid Name=\"%s\" GridType=\"Uniform\">\n", part ? part->name : "melt");
  if (!part) fprintf(out, "      <Time Value=\"%.17g\"/>\n", step->time);
  put_topology(out, file, step, part);
  fputs("      <Geometry GeometryType=\"XYZ\">\n", out);
  const Slab points = {step->first_point, step->n_points, vtk_series_n_points(series), 3, false};
  put_slab(out, file, "Points", &points);
  fputs("      </Geometry>\n", out);
  for (size_t f = 0; f < vtk_series_n_fields(series); f++) {
    const VtkField *field = &vtk_series_fields(series)[f];
    char set[256];
    snprintf(set, sizeof set, "PointData/%s", field->name);
    fprintf(out, "      <Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"Node\">\n", field->name,
            field->components == 3 ? "Vector" : "Scalar");
    const Slab values = {step->first_value, step->n_points, vtk_series_n_values(series), field->components,
                         field->integer};
    put_slab(out, file, set, &values);
    fputs("      </Attribute>\n", out);
  }
  for (size_t f = 0; part && f < part->n_maps; f++) {
    char set[256];
    snprintf(set, sizeof set, "CellData/%s", part->map[f].name);
    fprintf(out, "      <Attribute Name=\"%s\" AttributeType=\"Scalar\" Center=\"Cell\">\n", part->map[f].name);
    put_set(out, "        ", file, set, (long long)part->n_cells, 1, part->map[f].integer);
    fputs("      </Attribute>\n", out);
  }
  fputs("    </Grid>\n", out);
}

static void put_document(FILE *out, const VtkSeries *series, size_t n_parts, const XmfPart *part)
{
  fputs("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
        "  <Grid Name=\"steps\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
        out);
  for (size_t s = 0; s < vtk_series_n_steps(series); s++) {
    const VtkStep *step = &vtk_series_steps(series)[s];
    if (n_parts == 0) put_grid(out, series, step, NULL);
    if (n_parts == 0) continue;
    fprintf(out,
            "  <Grid Name=\"parts\" GridType=\"Collection\" CollectionType=\"Spatial\">\n    <Time Value=\"%.17g\"/>\n",
            step->time);
    for (size_t k = 0; k < n_parts; k++) put_grid(out, series, step, &part[k]);
    fputs("  </Grid>\n", out);
  }
  fputs("  </Grid>\n</Domain>\n</Xdmf>\n", out);
}

CastStatus xmf_write(const char *path, const VtkSeries *series, size_t n_parts, const XmfPart *part, CastError *err)
{
  char temporary[4096];
  snprintf(temporary, sizeof temporary, "%s.part", path);
  FILE *out = fopen(temporary, "w");
  CAST_CHECK(out, err, CAST_ERR_IO, "%s: cannot be created: %s", temporary, strerror(errno));
  put_document(out, series, n_parts, part);
  const bool written = !ferror(out);
  const bool closed = fclose(out) == 0;
  if (!written || !closed || rename(temporary, path) != 0) {
    const int reason = errno;
    remove(temporary);
    return cast_error_set(err, CAST_ERR_IO, "%s: cannot be written: %s", path, strerror(reason));
  }
  return CAST_OK;
}
