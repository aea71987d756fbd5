/* rom_write.c - the ROM file is written beside its place and renamed: under the final name stands a whole file or none.
 */
#include "common/rom/rom_schema.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static CastStatus write_values(hid_t file, const RomData *rom, const RomField *field, const void *packed,
                               CastError *err)
{
  if (field->type == ROM_TEXT || field->type == ROM_WORD)
    return h5_write_text(file, field->name, packed, field->description, err);
  const size_t rows = rom_extent_value(rom, field->rows);
  if (field->type == ROM_NAME || field->type == ROM_DIGEST)
    return h5_write_names(file, field->name, rows, packed, field->description, err);
  const hsize_t shape[2] = {rows, rom_extent_value(rom, field->columns)};
  return h5_write(file, field->name, rom_memory_type(field->type), field->rank, shape, packed, field->units,
                  field->description, err);
}

static CastStatus write_field(hid_t file, const RomData *rom, const RomField *field, struct sha256_ctx *hash,
                              CastError *err)
{
  const void *packed = NULL;
  void *owned = NULL;
  CAST_CALL(rom_field_pack(rom, field, &packed, &owned, err));
  const bool text = field->type == ROM_TEXT || field->type == ROM_WORD;
  rom_field_hash(hash, field, packed,
                 text ? strlen(packed) : rom_field_entries(rom, field) * rom_stored_size(field->type));
  const CastStatus status = write_values(file, rom, field, packed, err);
  free(owned);
  return status;
}

static CastStatus write_contents(hid_t file, const RomData *rom, CastError *err)
{
  const int version[2] = {ROM_FORMAT_MAJOR, ROM_FORMAT_MINOR};
  struct sha256_ctx hash;
  char checksum[65];
  sha256_init(&hash);
  CAST_CALL(h5_write_text_attribute(file, "format", "castrom", err));
  CAST_CALL(h5_write_attribute(file, "version", H5T_NATIVE_INT, 2, version, err));
  for (size_t i = 0; i < rom_field_count; i++) CAST_CALL(write_field(file, rom, &rom_fields[i], &hash, err));
  rom_hash_finish(&hash, checksum);
  return h5_write_text_attribute(file, "checksum", checksum, err);
}

static CastStatus write_temporary(const RomData *rom, const char *path, CastError *err)
{
  hid_t file = -1;
  CAST_CALL(h5_file_create(path, &file, err));
  CastStatus status = write_contents(file, rom, err);
  const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
  return status == CAST_OK ? closed : status;
}

/* The rename itself must survive a power cut. Some file systems refuse to sync a directory; that is no fault. */
static void sync_directory(const char *path)
{
  const char *slash = strrchr(path, '/');
  char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
  const int descriptor = folder ? open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
  if (descriptor >= 0) {
    fsync(descriptor);
    close(descriptor);
  }
  free(folder);
}

CastStatus rom_write(const RomData *rom, const char *path, CastError *err)
{
  CAST_CALL(rom_check(rom, err));
  struct stat info;
  CAST_CHECK(stat(path, &info) != 0 || S_ISREG(info.st_mode), err, CAST_ERR_IO, "%s: %s, a file is to be written there",
             path, S_ISDIR(info.st_mode) ? "is a directory" : "is not a file");
  char temporary[4096];
  const int length = snprintf(temporary, sizeof temporary, "%s.%ld.part", path, (long)getpid());
  CAST_CHECK(length > 0 && (size_t)length < sizeof temporary, err, CAST_ERR_IO, "%s: the path is too long", path);
  CastStatus status = write_temporary(rom, temporary, err);
  if (status == CAST_OK && rename(temporary, path) != 0)
    status = cast_error_set(err, CAST_ERR_IO, "%s: cannot be renamed to %s: %s", temporary, path, strerror(errno));
  if (status == CAST_OK)
    sync_directory(path);
  else
    unlink(temporary);
  return status;
}
