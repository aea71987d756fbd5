#include "common/rom/rom_schema.h"

#define DATA(type, member, units, text) type, ROM_IN_DATA, offsetof(RomData, member), 0, ROM_ONE, ROM_ONE, units, text
#define ROWS(type, member, rows, units, text)                                                                          \
  type, ROM_IN_ARRAY, offsetof(RomData, member), 1, rows, ROM_ONE, units, text
#define TABLE(type, member, rows, columns, units, text)                                                                \
  type, ROM_IN_ARRAY, offsetof(RomData, member), 2, rows, columns, units, text
#define PATCH(type, member, units, text) type, ROM_IN_PATCH, offsetof(RomPatch, member), 1, ROM_M, ROM_ONE, units, text
#define MATERIAL(type, member, units, text)                                                                            \
  type, ROM_IN_MATERIAL, offsetof(RomMaterial, member), 1, ROM_MATERIALS, ROM_ONE, units, text

const RomField rom_fields[] = {
    {"title", DATA(ROM_TEXT, title, "", "what the mould is, in the user's words")},

    {"model/lambda", ROWS(ROM_DOUBLE, lambda, ROM_R, "1/s", "decay rates of the states, ascending, none negative")},
    {"patches/name",
     PATCH(ROM_NAME, name, "", "name of each patch: those of the cavity wall first, then the outer surfaces")},
    {"model/B", TABLE(ROM_DOUBLE, B, ROM_R, ROM_M, "sqrt(K/J)",
                      "input of each patch's heat flow (columns) to each state (rows); its transpose is the output")},
    {"model/ambient", ROWS(ROM_DOUBLE, ambient, ROM_R, "sqrt(J/K)/s", "input of T_ambient - T_preheat")},
    {"model/constant", ROWS(ROM_DOUBLE, constant, ROM_R, "sqrt(J/K)",
                            "states of the constant temperature of 1 K; constant^T z is the heat stored")},
    {"model/heat_capacity", DATA(ROM_DOUBLE, heat_capacity, "J/K", "heat capacity of the whole mould")},

    {"patches/surface", PATCH(ROM_NAME, surface, "", "named surface that the patch is part of")},
    {"patches/outer", PATCH(ROM_BOOL, outer, "1", "1: an outer surface of the mould, 0: cavity wall")},
    {"patches/area", PATCH(ROM_DOUBLE, area, "m2", "area")},
    {"patches/centroid", ROM_DOUBLE, ROM_IN_PATCH, offsetof(RomPatch, centroid), 2, ROM_M, ROM_THREE, "m", "centroid"},
    {"patches/h",
     PATCH(ROM_DOUBLE, h, "W/(m2 K)", "heat-transfer coefficient to the surroundings within the model; 0: insulated")},
    {"patches/fixed",
     PATCH(ROM_BOOL, fixed, "1", "1: fixed temperature, applied as a large heat-transfer coefficient")},

    {"materials/region", MATERIAL(ROM_NAME, region, "", "named volume")},
    {"materials/name", MATERIAL(ROM_NAME, name, "", "material")},
    {"materials/conductivity", MATERIAL(ROM_DOUBLE, conductivity, "W/(m K)", "thermal conductivity")},
    {"materials/density", MATERIAL(ROM_DOUBLE, density, "kg/m3", "density")},
    {"materials/specific_heat", MATERIAL(ROM_DOUBLE, specific_heat, "J/(kg K)", "specific heat")},
    {"materials/reference_temperature",
     MATERIAL(ROM_DOUBLE, reference_temperature, "K", "temperature at which these were taken; NaN: not stated")},
    {"materials/sha256", MATERIAL(ROM_DIGEST, sha256, "", "SHA-256 of the material's text; empty: none")},

    {"geometry/points", TABLE(ROM_DOUBLE, points, ROM_POINTS, ROM_THREE, "m",
                              "nodes of the boundary and of the band along the cavity wall")},
    {"geometry/basis", TABLE(ROM_FLOAT, basis, ROM_POINTS, ROM_R, "sqrt(K/J)",
                             "temperature at each point (rows) above preheat for each state (columns)")},
    {"geometry/triangles", TABLE(ROM_INT32, triangles, ROM_TRIANGLES, ROM_THREE, "1",
                                 "closed boundary, indices into points from 0, normals out of the mould")},
    {"geometry/triangle_patch", ROWS(ROM_INT32, triangle_patch, ROM_TRIANGLES, "1", "patch of each triangle, from 0")},
    {"geometry/tetrahedra", TABLE(ROM_INT32, tetrahedra, ROM_TETRAHEDRA, ROM_FOUR, "1",
                                  "band along the cavity wall, indices into points from 0, positive volume")},
    {"geometry/band", DATA(ROM_DOUBLE, band, "m", "the tetrahedra reach at least this deep below the cavity wall")},
    {"geometry/min_edge", DATA(ROM_DOUBLE, min_edge, "m", "shortest edge of the cavity's triangles")},

    {"reduction/method", DATA(ROM_WORD, method, "", "how the model was reduced")},
    {"reduction/n_full", DATA(ROM_COUNT, n_full, "1", "unknowns of the full model")},
    {"reduction/shifts", ROWS(ROM_DOUBLE, shifts, ROM_SHIFTS, "1/s", "expansion points")},
    {"reduction/moments", DATA(ROM_LONG, moments, "1", "moments matched for each input at each shift")},
    {"reduction/tolerance",
     DATA(ROM_DOUBLE, tolerance, "1", "error asked for, relative to the largest temperature rise of a patch")},
    {"reduction/t_start", DATA(ROM_DOUBLE, t_start, "s", "start of the band of times that the tolerance speaks of")},
    {"reduction/t_end", DATA(ROM_DOUBLE, t_end, "s", "its end")},

    {"certificate/frequency",
     ROWS(ROM_DOUBLE, certificate.frequency, ROM_FREQUENCIES, "rad/s",
          "where the transfer function is bounded, ascending; between them the bound is interpolated, log over log")},
    {"certificate/transfer_bound", ROWS(ROM_DOUBLE, certificate.transfer_bound, ROM_FREQUENCIES, "1",
                                        "upper bound of the transfer function's relative error there")},
    {"certificate/time",
     ROWS(ROM_DOUBLE, certificate.time, ROM_TIMES, "s", "times of the step responses compared with the full model")},
    {"certificate/step_error", ROWS(ROM_DOUBLE, certificate.step_error, ROM_TIMES, "1",
                                    "largest error of a sampled patch at that time over the largest rise")},
    {"certificate/step_error_max",
     DATA(ROM_DOUBLE, certificate.step_error_max, "1",
          "the largest of them from t_start to t_end: what the tolerance means; NaN: not computed")},
    {"certificate/sampled_patches", DATA(ROM_LONG, certificate.sampled_patches, "1", "step inputs followed")},
    {"certificate/moment_error",
     DATA(ROM_DOUBLE, certificate.moment_error, "1",
          "relative difference of the moments matched; NaN: not computed, or not kept by a second stage")},
    {"certificate/orthogonality",
     DATA(ROM_DOUBLE, certificate.orthogonality, "1", "largest entry of |V^T E V - I|; NaN: not computed")},
    {"certificate/second_stage_bound",
     DATA(ROM_DOUBLE, certificate.second_stage_bound, "K/W",
          "second stage's change of the transfer function: a-priori bound of balanced truncation, else the largest "
          "found; 0: none")},
    {"certificate/met", DATA(ROM_BOOL, certificate.met, "1", "1: step_error_max is within the tolerance")},

    {"provenance/program", DATA(ROM_TEXT, provenance.program, "", "who wrote the file")},
    {"provenance/version", DATA(ROM_TEXT, provenance.version, "", "its version")},
    {"provenance/command", DATA(ROM_TEXT, provenance.command, "", "command line")},
    {"provenance/input_path", DATA(ROM_TEXT, provenance.input_path, "", "input file")},
    {"provenance/input_text", DATA(ROM_TEXT, provenance.input_text, "", "its text")},
    {"provenance/geometry_sha256", DATA(ROM_TEXT, provenance.geometry_sha256, "", "SHA-256 of the geometry file")},
    {"provenance/created", DATA(ROM_TEXT, provenance.created, "", "date and time, ISO 8601, UTC")},
    {"provenance/libraries", DATA(ROM_TEXT, provenance.libraries, "", "libraries and their versions")},
    {"provenance/host", DATA(ROM_TEXT, provenance.host, "", "machine")},
    {"provenance/ranks", DATA(ROM_INT, provenance.ranks, "1", "MPI ranks")},
    {"provenance/seconds_mesh", DATA(ROM_DOUBLE, provenance.seconds_mesh, "s", "wall time of meshing")},
    {"provenance/seconds_assembly", DATA(ROM_DOUBLE, provenance.seconds_assembly, "s", "wall time of assembly")},
    {"provenance/seconds_reduction", DATA(ROM_DOUBLE, provenance.seconds_reduction, "s", "wall time of the reduction")},
    {"provenance/seconds_certificate",
     DATA(ROM_DOUBLE, provenance.seconds_certificate, "s", "wall time of the certificate")},
};

const size_t rom_field_count = sizeof rom_fields / sizeof rom_fields[0];
const char *const rom_extent_names[] = {"states", "patches",     "materials", "points", "triangles",   "tetrahedra",
                                        "shifts", "frequencies", "times",     "value",  "coordinates", "corners"};
