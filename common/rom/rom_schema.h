/* rom_schema.h - the ROM file's data sets, one row for each: what writing, reading, the checksum and docs/rom-format.md
 * go by. The order of the rows is the order in which the sets are read and hashed. */
#ifndef COMMON_ROM_ROM_SCHEMA_H
#define COMMON_ROM_ROM_SCHEMA_H

#include <nettle/sha2.h>
#include "common/h5/h5.h"
#include "common/rom/rom.h"

typedef enum RomType {
  ROM_DOUBLE, // double
  ROM_FLOAT,  // float
  ROM_INT32,  // int32_t
  ROM_INT,    // int, stored as 64-bit integer
  ROM_LONG,   // long, stored as 64-bit integer
  ROM_COUNT,  // size_t, stored as 64-bit integer
  ROM_BOOL,   // bool, stored as 8-bit integer
  ROM_NAME,   // char[ROM_NAME_LENGTH] in the struct
  ROM_DIGEST, // char[65] in the struct, stored as 64 bytes of hexadecimal digits
  ROM_WORD,   // char[32] in the struct, stored as text
  ROM_TEXT    // char * in the struct
} RomType;

typedef enum RomHome { // what `offset` counts from
  ROM_IN_DATA,         // a value in RomData
  ROM_IN_ARRAY,        // RomData holds a pointer to the values
  ROM_IN_PATCH,        // a value in each RomPatch
  ROM_IN_MATERIAL      // a value in each RomMaterial
} RomHome;

typedef enum RomExtent { // numbers of entries; those before ROM_EXTENTS_FIXED are read from the file
  ROM_R,
  ROM_M,
  ROM_MATERIALS,
  ROM_POINTS,
  ROM_TRIANGLES,
  ROM_TETRAHEDRA,
  ROM_SHIFTS,
  ROM_FREQUENCIES,
  ROM_TIMES,
  ROM_EXTENTS_FIXED,
  ROM_ONE = ROM_EXTENTS_FIXED,
  ROM_THREE,
  ROM_FOUR
} RomExtent;

typedef struct RomField {
  const char *name; // path in the file
  RomType type;
  RomHome home;
  size_t offset;
  int rank; // 0: one value; 1: rows; 2: rows x columns
  RomExtent rows, columns;
  const char *units, *description;
} RomField;

extern const RomField rom_fields[];
extern const size_t rom_field_count;
extern const char *const rom_extent_names[]; // for messages: "states", "patches", ..

/* Where the number behind an extent lives in RomData; NULL for the fixed ones. */
size_t *rom_extent_slot(RomData *rom, RomExtent extent);
size_t rom_extent_value(const RomData *rom, RomExtent extent);
size_t rom_field_entries(const RomData *rom, const RomField *field);
size_t rom_stored_size(RomType type);   // bytes of one value as stored; 0 for ROM_WORD and ROM_TEXT
size_t rom_column_stride(RomHome home); // bytes from one patch (material) to the next
hid_t rom_memory_type(RomType type);    // HDF5's type of a value as packed; -1 for texts and names

/* The field's values as one contiguous array in their stored form: borrowed from rom where they lie so already, else
 * packed into a new buffer, *owned. */
CastStatus rom_field_pack(const RomData *rom, const RomField *field, const void **packed, void **owned, CastError *err);
/* Give the stored values `packed` (malloc'ed, taken over) to rom, whose patch and material arrays exist.
 * Errors: CAST_ERR_FORMAT for a value that the struct cannot hold. */
CastStatus rom_field_unpack(RomData *rom, const RomField *field, void *packed, CastError *err);

/* Add the field to the file's checksum: path and closing zero, number of bytes (64 bits, little-endian), bytes. */
void rom_field_hash(struct sha256_ctx *hash, const RomField *field, const void *packed, size_t bytes);
void rom_hash_finish(struct sha256_ctx *hash, char hex[65]);

#endif
