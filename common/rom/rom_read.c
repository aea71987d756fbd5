/* rom_read.c - a ROM is believed only after its version, every shape, its checksum and its physics have been checked.
 */
#include "common/rom/rom_schema.h"

#include <stdlib.h>
#include <string.h>

/* More than any mould needs, few enough that products of two of them do not overflow. */
static const hsize_t LARGEST_EXTENT = (hsize_t)1 << 31;

static CastStatus check_version(hid_t file, const char *path, CastError *err)
{
  char *format = NULL;
  int version[2] = {0, 0};
  if (h5_read_text_attribute(file, "format", &format, NULL) != CAST_OK)
    return cast_error_set(err, CAST_ERR_FORMAT, "%s: is HDF5 but not a ROM file (it has no text attribute 'format')",
                          path);
  const bool ours = strcmp(format, "castrom") == 0;
  if (!ours) cast_error_set(err, CAST_ERR_FORMAT, "%s: its format is '%s', 'castrom' is expected", path, format);
  free(format);
  if (!ours) return CAST_ERR_FORMAT;
  CAST_CALL(h5_read_attribute(file, "version", H5T_NATIVE_INT, 2, version, err));
  CAST_CHECK(version[0] >= 1 && version[1] >= 0, err, CAST_ERR_FORMAT, "%s: format version %d.%d is impossible", path,
             version[0], version[1]);
  CAST_CHECK(version[0] < ROM_FORMAT_MAJOR || (version[0] == ROM_FORMAT_MAJOR && version[1] <= ROM_FORMAT_MINOR), err,
             CAST_ERR_FORMAT, "%s: format version %d.%d is newer than %d.%d, the newest this program knows", path,
             version[0], version[1], ROM_FORMAT_MAJOR, ROM_FORMAT_MINOR);
  return CAST_OK;
}

typedef struct Reader {
  hid_t file;
  const char *path;
  RomData *rom;
  struct sha256_ctx hash;
  const char *known_from[ROM_EXTENTS_FIXED]; // the data set that told the number; NULL: not known yet
} Reader;

/* The first set that an extent appears in tells it; the others must agree. */
static CastStatus settle_extent(Reader *reader, const RomField *field, RomExtent extent, hsize_t found, CastError *err)
{
  size_t *slot = rom_extent_slot(reader->rom, extent);
  const char *from = slot ? reader->known_from[extent] : "the format";
  if (from) {
    const size_t expected = rom_extent_value(reader->rom, extent);
    CAST_CHECK(found == expected, err, CAST_ERR_FORMAT, "%s: data set %s has %llu %s, %zu are expected (from %s)",
               reader->path, field->name, (unsigned long long)found, rom_extent_names[extent], expected, from);
    return CAST_OK;
  }
  CAST_CHECK(found < LARGEST_EXTENT, err, CAST_ERR_FORMAT, "%s: data set %s claims %llu %s", reader->path, field->name,
             (unsigned long long)found, rom_extent_names[extent]);
  *slot = (size_t)found;
  reader->known_from[extent] = field->name;
  return CAST_OK;
}

static CastStatus make_room(Reader *reader, const RomField *field, CastError *err)
{
  RomData *rom = reader->rom;
  if (field->home == ROM_IN_PATCH && !rom->patch) rom->patch = calloc(rom->m + 1, sizeof *rom->patch);
  if (field->home == ROM_IN_MATERIAL && !rom->material)
    rom->material = calloc(rom->n_materials + 1, sizeof *rom->material);
  const bool room = (field->home != ROM_IN_PATCH || rom->patch) && (field->home != ROM_IN_MATERIAL || rom->material);
  CAST_CHECK(room, err, CAST_ERR_MEMORY, "no memory for %s", field->name);
  return CAST_OK;
}

static CastStatus read_values(Reader *reader, const RomField *field, void **packed, size_t *bytes, CastError *err)
{
  hsize_t shape[2] = {0, 0};
  if (field->type == ROM_TEXT || field->type == ROM_WORD) {
    char *text = NULL;
    CAST_CALL(h5_read_text(reader->file, field->name, &text, err));
    *packed = text;
    *bytes = strlen(text);
    return CAST_OK;
  }
  if (field->type == ROM_NAME || field->type == ROM_DIGEST) {
    size_t n = 0;
    char *names = NULL;
    CAST_CALL(h5_read_names(reader->file, field->name, &n, &names, err));
    *packed = names;
    shape[0] = n;
  } else {
    CAST_CALL(h5_read(reader->file, field->name, rom_memory_type(field->type), field->rank, shape, packed, err));
  }
  CastStatus status = CAST_OK;
  if (field->rank >= 1) status = settle_extent(reader, field, field->rows, shape[0], err);
  if (field->rank == 2 && status == CAST_OK) status = settle_extent(reader, field, field->columns, shape[1], err);
  if (status == CAST_OK) status = make_room(reader, field, err);
  if (status != CAST_OK) {
    free(*packed);
    *packed = NULL;
    return status;
  }
  *bytes = rom_field_entries(reader->rom, field) * rom_stored_size(field->type);
  return CAST_OK;
}

static CastStatus read_field(Reader *reader, const RomField *field, CastError *err)
{
  void *packed = NULL;
  size_t bytes = 0;
  CAST_CALL(read_values(reader, field, &packed, &bytes, err));
  rom_field_hash(&reader->hash, field, packed, bytes);
  return rom_field_unpack(reader->rom, field, packed, err);
}

static CastStatus check_checksum(Reader *reader, CastError *err)
{
  char found[65], *expected = NULL;
  rom_hash_finish(&reader->hash, found);
  CAST_CALL(h5_read_text_attribute(reader->file, "checksum", &expected, err));
  const bool same = strcmp(found, expected) == 0;
  free(expected);
  CAST_CHECK(same, err, CAST_ERR_FORMAT,
             "%s: the checksum of its data sets differs from the one stored: the file was damaged or changed",
             reader->path);
  return CAST_OK;
}

static CastStatus read_contents(Reader *reader, CastError *err)
{
  CAST_CALL(check_version(reader->file, reader->path, err));
  sha256_init(&reader->hash);
  for (size_t i = 0; i < rom_field_count; i++) CAST_CALL(read_field(reader, &rom_fields[i], err));
  CAST_CALL(check_checksum(reader, err));
  return rom_check(reader->rom, err) == CAST_OK ? CAST_OK : cast_error_prefix(err, reader->path);
}

CastStatus rom_read(const char *path, RomData **rom, CastError *err)
{
  CastError local = {CAST_OK, ""};
  if (!err) err = &local;
  *rom = NULL;
  Reader reader = {.file = -1, .path = path};
  CAST_CALL(h5_file_open(path, &reader.file, err));
  reader.rom = calloc(1, sizeof *reader.rom);
  CastStatus status =
      reader.rom ? read_contents(&reader, err) : cast_error_set(err, CAST_ERR_MEMORY, "%s: no memory to read it", path);
  h5_file_close(&reader.file, NULL);
  if (status == CAST_OK)
    *rom = reader.rom;
  else
    rom_destroy(&reader.rom);
  return status;
}
