/* config.h - cast.yaml, parsed once into a const struct. docs/user-guide describes the file. All SI. */
#ifndef CAST_CONFIG_CONFIG_H
#define CAST_CONFIG_CONFIG_H

#include "cast/coupling/coupling.h"
#include "cast/physics/drive.h"
#include "cast/pour/gas.h"
#include "cast/pour/inlet.h"
#include "cast/pour/outlet.h"
#include "cast/results/filling.h"

typedef struct BlockConfig { // a box of melt at the start
  double corner[3], size[3]; // m
  double temperature;        // K
  double velocity[3];        // m/s
} BlockConfig;

typedef struct PointConfig { // a probe (fixed) or a tracer (the particle nearest at the start)
  char name[ROM_NAME_LENGTH];
  double x[3]; // m
} PointConfig;

typedef struct OutputConfig {
  char *folder;            // resolved against the input file's folder
  double every;            // s of simulated time between frames of the results
  double curves_every;     // s of simulated time between rows of the CSV files
  double checkpoint_every; // s of wall time
  bool mould_fields;       // write the mould's temperature
  double record_every;     // s of simulated time, interval of the heat record; 0: none
  bool record_triangles;   // by wall triangle as well
  size_t n_probes, n_tracers;
  PointConfig *probe, *tracer;
} OutputConfig;

typedef struct CoolConfig { // the second stage: melt at rest
  bool wanted;
  bool at_end;                // begin at the end of the filling's time, not when the melt is at rest
  bool until_solid;           // end when 99.9 % of the melt is solid, `end` at the latest
  double end;                 // s
  double tolerance;           // K
  double every, curves_every; // s between frames and between rows; 0: a row each step
} CoolConfig;

typedef struct SurfaceAngle {
  char surface[ROM_NAME_LENGTH];
  double contact_angle; // rad
} SurfaceAngle;

typedef struct CastConfig {
  char *title;
  char *rom_path;          // resolved against the input file's folder
  RomData *loaded_rom;     // borrowed: what rom_path holds, where it has been read already; NULL: read it
  double preheat, ambient; // K
  Material melt;
  char *melt_reference;    // the name or path of its file as written; NULL: inline
  double melt_temperature; // K
  size_t n_blocks;
  BlockConfig *block;
  size_t n_inlets, n_outlets;
  InletConfig *inlet;
  OutletConfig *outlet;
  bool has_level; // melt fills the cavity below this height at the start
  double level;   // m
  Drive drive;    // gravity, tilting, spinning
  GasConfig gas;
  ContactLaws contact;
  CouplingParameters coupling; // .contact points to the laws above
  bool tension;                // surface tension acts
  double contact_angle;        // rad, on all cavity surfaces but those below
  size_t n_angles;
  SurfaceAngle *angle; // [n_angles]
  double spacing;      // m
  KernelKind kernel;
  double smoothing;   // h/spacing
  double sound_speed; // m/s; 0: from the largest speed and pressure expected
  SphDensity density;
  double density_diffusion, artificial_viscosity;
  bool cut_tension;
  double end; // s, of the filling
  CoolConfig cool;
  double step; // s; 0: from the limits of sph_time_step and of the exchange with the mould
  RomScheme scheme;
  size_t n_walls;
  OuterWall *wall; // outer surfaces under other conditions than in the ROM
  size_t n_features;
  FeatureBox *feature;           // boxes whose filling is told
  size_t n_part;                 // cavity surfaces and features that make up the part; 0: not said
  char (*part)[ROM_NAME_LENGTH]; // [n_part]
  OutputConfig output;
  char *input_path, *input_text;
} CastConfig;

/* Errors: CAST_ERR_INPUT with all faults, one a line. `text` NULL: read the file. */
CastStatus cast_config_read(const char *path, const char *text, CastConfig **config, CastError *err);
void cast_config_destroy(CastConfig **config);

/* The input with every default filled in, SI, as a text that castrun reads again to the same bits; paths are absolute.
 *   sound_speed  m/s, what "auto" came to; 0: leave it as it was written
 *   text         out: owned by the caller */
CastStatus cast_config_resolved(const CastConfig *config, double sound_speed, char **text, CastError *err);

#endif
