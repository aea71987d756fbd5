/* rom_pack.c - from the fields of RomData to contiguous stored values and back. */
#include "common/rom/rom_schema.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

size_t *rom_extent_slot(RomData *rom, RomExtent extent)
{
  switch (extent) {
  case ROM_R:
    return &rom->r;
  case ROM_M:
    return &rom->m;
  case ROM_MATERIALS:
    return &rom->n_materials;
  case ROM_POINTS:
    return &rom->n_points;
  case ROM_TRIANGLES:
    return &rom->n_triangles;
  case ROM_TETRAHEDRA:
    return &rom->n_tetrahedra;
  case ROM_SHIFTS:
    return &rom->n_shifts;
  case ROM_FREQUENCIES:
    return &rom->certificate.n_frequencies;
  case ROM_TIMES:
    return &rom->certificate.n_times;
  default:
    return NULL;
  }
}

size_t rom_extent_value(const RomData *rom, RomExtent extent)
{
  const size_t fixed[] = {1, 3, 4};
  if (extent >= ROM_EXTENTS_FIXED) return fixed[extent - ROM_EXTENTS_FIXED];
  RomData copy = *rom; // the slots of a copy: rom stays const
  return *rom_extent_slot(&copy, extent);
}

size_t rom_field_entries(const RomData *rom, const RomField *field)
{
  return rom_extent_value(rom, field->rows) * rom_extent_value(rom, field->columns);
}

size_t rom_stored_size(RomType type)
{
  switch (type) {
  case ROM_DOUBLE:
    return sizeof(double);
  case ROM_FLOAT:
    return sizeof(float);
  case ROM_INT32:
    return sizeof(int32_t);
  case ROM_INT:
  case ROM_LONG:
  case ROM_COUNT:
    return sizeof(int64_t);
  case ROM_BOOL:
    return 1;
  case ROM_NAME:
  case ROM_DIGEST:
    return H5_NAME_LENGTH;
  default:
    return 0;
  }
}

size_t rom_column_stride(RomHome home)
{
  return home == ROM_IN_PATCH ? sizeof(RomPatch) : sizeof(RomMaterial);
}

hid_t rom_memory_type(RomType type)
{
  switch (type) {
  case ROM_DOUBLE:
    return H5T_NATIVE_DOUBLE;
  case ROM_FLOAT:
    return H5T_NATIVE_FLOAT;
  case ROM_INT32:
    return H5T_NATIVE_INT32;
  case ROM_INT:
  case ROM_LONG:
  case ROM_COUNT:
    return H5T_NATIVE_INT64;
  case ROM_BOOL:
    return H5T_NATIVE_UINT8;
  default:
    return -1;
  }
}

static void store_value(RomType type, const char *member, char *stored)
{
  int64_t wide = 0;
  switch (type) {
  case ROM_INT:
    wide = *(const int *)(const void *)member;
    break;
  case ROM_LONG:
    wide = *(const long *)(const void *)member;
    break;
  case ROM_COUNT:
    wide = (int64_t) * (const size_t *)(const void *)member;
    break;
  case ROM_BOOL:
    *stored = *(const bool *)(const void *)member ? 1 : 0;
    return;
  case ROM_NAME:
  case ROM_DIGEST:
    memcpy(stored, member, strnlen(member, H5_NAME_LENGTH));
    return;
  default:
    memcpy(stored, member, rom_stored_size(type));
    return;
  }
  memcpy(stored, &wide, sizeof wide);
}

static CastStatus load_value(const RomField *field, const char *stored, char *member, CastError *err)
{
  int64_t wide = 0;
  if (rom_stored_size(field->type) == sizeof wide) memcpy(&wide, stored, sizeof wide);
  switch (field->type) {
  case ROM_INT:
    CAST_CHECK(wide >= INT_MIN && wide <= INT_MAX, err, CAST_ERR_FORMAT, "%s: %lld is out of range", field->name,
               (long long)wide);
    *(int *)(void *)member = (int)wide;
    return CAST_OK;
  case ROM_LONG:
    *(long *)(void *)member = (long)wide;
    return CAST_OK;
  case ROM_COUNT:
    CAST_CHECK(wide >= 0, err, CAST_ERR_FORMAT, "%s: %lld is negative", field->name, (long long)wide);
    *(size_t *)(void *)member = (size_t)wide;
    return CAST_OK;
  case ROM_BOOL:
    CAST_CHECK(*stored == 0 || *stored == 1, err, CAST_ERR_FORMAT, "%s: %d is neither 0 nor 1", field->name, *stored);
    *(bool *)(void *)member = *stored == 1;
    return CAST_OK;
  case ROM_NAME:
    CAST_CHECK(memchr(stored, 0, ROM_NAME_LENGTH), err, CAST_ERR_FORMAT, "%s: a name of %d bytes or more", field->name,
               ROM_NAME_LENGTH);
    memcpy(member, stored, ROM_NAME_LENGTH);
    return CAST_OK;
  case ROM_DIGEST:
    memcpy(member, stored, H5_NAME_LENGTH);
    member[H5_NAME_LENGTH] = '\0';
    return CAST_OK;
  default:
    memcpy(member, stored, rom_stored_size(field->type));
    return CAST_OK;
  }
}

static CastStatus pack_column(const RomData *rom, const RomField *field, void **owned, CastError *err)
{
  const size_t n = rom_extent_value(rom, field->rows), width = rom_extent_value(rom, field->columns);
  const size_t size = rom_stored_size(field->type) * width, stride = rom_column_stride(field->home);
  const char *first = field->home == ROM_IN_PATCH ? (const char *)rom->patch : (const char *)rom->material;
  char *stored = calloc(n > 0 ? n : 1, size);
  CAST_CHECK(stored, err, CAST_ERR_MEMORY, "no memory for %zu bytes of %s", n * size, field->name);
  for (size_t i = 0; i < n; i++) {
    const char *member = first + i * stride + field->offset;
    if (width > 1)
      memcpy(stored + i * size, member, size);
    else
      store_value(field->type, member, stored + i * size);
  }
  *owned = stored;
  return CAST_OK;
}

CastStatus rom_field_pack(const RomData *rom, const RomField *field, const void **packed, void **owned, CastError *err)
{
  const char *base = (const char *)rom + field->offset;
  *owned = NULL;
  if (field->type == ROM_WORD) {
    *packed = base;
  } else if (field->type == ROM_TEXT) {
    const char *text = *(char *const *)(const void *)base;
    *packed = text ? text : "";
  } else if (field->home == ROM_IN_ARRAY) {
    *packed = *(void *const *)(const void *)base;
  } else if (field->home == ROM_IN_DATA) {
    *owned = calloc(1, sizeof(int64_t));
    CAST_CHECK(*owned, err, CAST_ERR_MEMORY, "no memory for %s", field->name);
    store_value(field->type, base, *owned);
    *packed = *owned;
  } else {
    CAST_CALL(pack_column(rom, field, owned, err));
    *packed = *owned;
  }
  return CAST_OK;
}

static CastStatus unpack_column(RomData *rom, const RomField *field, const char *stored, CastError *err)
{
  const size_t n = rom_extent_value(rom, field->rows), width = rom_extent_value(rom, field->columns);
  const size_t size = rom_stored_size(field->type) * width, stride = rom_column_stride(field->home);
  char *first = field->home == ROM_IN_PATCH ? (char *)rom->patch : (char *)rom->material;
  for (size_t i = 0; i < n; i++) {
    char *member = first + i * stride + field->offset;
    if (width > 1)
      memcpy(member, stored + i * size, size);
    else
      CAST_CALL(load_value(field, stored + i * size, member, err));
  }
  return CAST_OK;
}

CastStatus rom_field_unpack(RomData *rom, const RomField *field, void *packed, CastError *err)
{
  char *base = (char *)rom + field->offset;
  if (field->type == ROM_TEXT || field->home == ROM_IN_ARRAY) {
    *(void **)(void *)base = packed; // handed over
    return CAST_OK;
  }
  CastStatus status = CAST_OK;
  if (field->type == ROM_WORD) {
    const size_t length = strlen(packed), room = sizeof rom->method;
    if (length < room)
      memcpy(base, packed, length + 1);
    else
      status = cast_error_set(err, CAST_ERR_FORMAT, "%s: a word of %zu bytes or more", field->name, room);
  } else if (field->home == ROM_IN_DATA) {
    status = load_value(field, packed, base, err);
  } else {
    status = unpack_column(rom, field, packed, err);
  }
  free(packed);
  return status;
}

void rom_field_hash(struct sha256_ctx *hash, const RomField *field, const void *packed, size_t bytes)
{
  unsigned char length[8];
  for (int i = 0; i < 8; i++) length[i] = (unsigned char)((uint64_t)bytes >> (8 * i));
  sha256_update(hash, strlen(field->name) + 1, (const uint8_t *)field->name);
  sha256_update(hash, sizeof length, length);
  if (bytes > 0) sha256_update(hash, bytes, packed);
}

void rom_hash_finish(struct sha256_ctx *hash, char hex[65])
{
  uint8_t digest[SHA256_DIGEST_SIZE];
  sha256_digest(hash, sizeof digest, digest);
  static const char digits[] = "0123456789abcdef";
  for (size_t i = 0; i < sizeof digest; i++) {
    hex[2 * i] = digits[digest[i] >> 4];
    hex[2 * i + 1] = digits[digest[i] & 15];
  }
  hex[64] = '\0';
}
