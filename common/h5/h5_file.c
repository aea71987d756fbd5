/* h5_file.c - files and groups: opening, closing, and what HDF5 has to say when it fails. */
#define _GNU_SOURCE // memfd_create
#include "common/h5/h5.h"
#include "common/h5/h5_private.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

void h5_quiet(void)
{
  // HDF5's exit handler crashes on a file whose last flush failed; files are closed explicitly here, so it has no use
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

typedef struct Reason {
  char text[512];
  bool system; // the text holds the operating system's own words
} Reason;

/* The innermost entry is what happened; one that quotes errno tells the most. */
static herr_t keep_reason(unsigned n, const H5E_error2_t *entry, void *data)
{
  (void)n;
  Reason *reason = data;
  if (!entry->desc || !entry->desc[0]) return 0;
  const char *quoted = strstr(entry->desc, "error message = '");
  if (quoted) {
    quoted += strlen("error message = '");
    snprintf(reason->text, sizeof reason->text, "%.*s", (int)strcspn(quoted, "'"), quoted);
    reason->system = true;
  } else if (!reason->system) {
    snprintf(reason->text, sizeof reason->text, "%.400s", entry->desc);
  }
  return 0;
}

bool h5_reason(char *buffer, size_t size)
{
  Reason reason = {"no reason given", false};
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_reason, &reason);
  snprintf(buffer, size, "%s", reason.text);
  return reason.system;
}

CastStatus h5_file_name(hid_t object, char *path, size_t size)
{
  if (H5Fget_name(object, path, size) <= 0) snprintf(path, size, "HDF5 file");
  return CAST_OK;
}

/* HDF5 1.10 cannot close a file or a set whose last bytes it cannot write. Once a write has failed the file is lost
 * anyway, so the rest of it goes to memory, where writing succeeds. */
void h5_abandon(hid_t object)
{
  const hid_t file = H5Iget_file_id(object);
  void *handle = NULL;
  if (file >= 0 && H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) >= 0 && handle) {
    const int sink = memfd_create("abandoned", MFD_CLOEXEC);
    if (sink >= 0) {
      dup2(sink, *(int *)handle);
      close(sink);
    }
  }
  if (file >= 0) H5Fclose(file);
}

/* Format 1.10: superblock, object headers and chunk indices all carry checksums, so a flipped bit is found. */
static hid_t access_checksummed(void)
{
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  if (access >= 0) H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  return access;
}

CastStatus h5_file_create(const char *path, hid_t *file, CastError *err)
{
  *file = -1;
  h5_quiet();
  // the system's own refusal is clearer than HDF5's
  const int descriptor = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  CAST_CHECK(descriptor >= 0, err, CAST_ERR_IO, "%s: cannot be created: %s", path, strerror(errno));
  close(descriptor);
  const hid_t access = access_checksummed();
  CAST_CHECK(access >= 0, err, CAST_ERR_LIBRARY, "%s: HDF5 gives no file access list", path);
  *file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
  char reason[512] = "";
  if (*file < 0) h5_reason(reason, sizeof reason); // before the next call clears it
  H5Pclose(access);
  CAST_CHECK(*file >= 0, err, CAST_ERR_IO, "%s: cannot be created: %s", path, reason);
  return CAST_OK;
}

static CastStatus check_signature(const char *path, CastError *err)
{
  static const unsigned char signature[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
  struct stat info;
  CAST_CHECK(stat(path, &info) == 0, err, CAST_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
  CAST_CHECK(S_ISREG(info.st_mode), err, CAST_ERR_IO, "%s: %s, a file is expected", path,
             S_ISDIR(info.st_mode) ? "is a directory" : "is not a regular file");
  FILE *stream = fopen(path, "rbe");
  CAST_CHECK(stream, err, CAST_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
  unsigned char head[8] = {0};
  const size_t n = fread(head, 1, sizeof head, stream);
  fclose(stream);
  CAST_CHECK(n > 0, err, CAST_ERR_FORMAT, "%s: is empty", path);
  CAST_CHECK(n == sizeof head && memcmp(head, signature, sizeof head) == 0, err, CAST_ERR_FORMAT,
             "%s: is not an HDF5 file (its first bytes are not HDF5's)", path);
  return CAST_OK;
}

CastStatus h5_file_open(const char *path, hid_t *file, CastError *err)
{
  *file = -1;
  h5_quiet();
  CAST_CALL(check_signature(path, err));
  *file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  char reason[512] = "";
  if (*file < 0) h5_reason(reason, sizeof reason);
  CAST_CHECK(*file >= 0, err, CAST_ERR_FORMAT, "%s: HDF5 cannot open it, it is damaged or truncated: %s", path, reason);
  return CAST_OK;
}

static CastStatus sync_file(const char *path, CastError *err)
{
  const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
  CAST_CHECK(descriptor >= 0, err, CAST_ERR_IO, "%s: cannot be reopened: %s", path, strerror(errno));
  const int failed = fsync(descriptor);
  const int reason = errno;
  close(descriptor);
  CAST_CHECK(!failed, err, CAST_ERR_IO, "%s: cannot be brought to the disk: %s", path, strerror(reason));
  return CAST_OK;
}

static bool was_abandoned(hid_t file)
{
  void *handle = NULL;
  struct stat info;
  return H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) >= 0 && handle && fstat(*(int *)handle, &info) == 0 &&
         info.st_nlink == 0;
}

CastStatus h5_file_close(hid_t *file, CastError *err)
{
  if (*file < 0) return CAST_OK;
  h5_quiet();
  const hid_t closing = *file;
  *file = -1;
  char path[4096], reason[512] = "an earlier write failed";
  unsigned intent = 0;
  h5_file_name(closing, path, sizeof path);
  H5Fget_intent(closing, &intent);
  const bool written = (intent & H5F_ACC_RDWR) != 0;
  bool ok = !written || !was_abandoned(closing);
  if (ok && written && H5Fflush(closing, H5F_SCOPE_GLOBAL) < 0) {
    ok = false;
    if (h5_reason(reason, sizeof reason)) h5_abandon(closing);
  }
  if (H5Fclose(closing) < 0 && ok) {
    ok = false;
    h5_reason(reason, sizeof reason);
  }
  CAST_CHECK(ok, err, CAST_ERR_IO, "%s: cannot be written: %s", path, reason);
  return written ? sync_file(path, err) : CAST_OK;
}

CastStatus h5_group_create(hid_t parent, const char *name, hid_t *group, CastError *err)
{
  h5_quiet();
  char path[4096], reason[512];
  const hid_t links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  *group = H5Gcreate2(parent, name, links, H5P_DEFAULT, H5P_DEFAULT);
  if (*group < 0) h5_reason(reason, sizeof reason);
  H5Pclose(links);
  if (*group >= 0) return CAST_OK;
  h5_file_name(parent, path, sizeof path);
  return cast_error_set(err, CAST_ERR_IO, "%s: group %s cannot be made: %s", path, name, reason);
}
