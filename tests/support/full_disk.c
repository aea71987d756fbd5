#define _GNU_SOURCE // RTLD_NEXT
#include "tests/support/full_disk.h"

#include <dlfcn.h>
#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

static int writes_left = -1; // -1: any number
static bool refused;

void disk_fill_after(int writes)
{
  writes_left = writes;
  refused = false;
}

void disk_empty(void)
{
  writes_left = -1;
}

bool disk_was_full(void)
{
  return refused;
}

/* HDF5 itself loses memory when a flush fails. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
  return "leak:libhdf5";
}

typedef ssize_t (*PWrite)(int descriptor, const void *bytes, size_t n, off_t offset);

static ssize_t write_or_refuse(PWrite next, int descriptor, const void *bytes, size_t n, off_t offset)
{
  struct stat info;
  if (writes_left < 0 || fstat(descriptor, &info) != 0 || !S_ISREG(info.st_mode) || info.st_nlink == 0)
    return next(descriptor, bytes, n, offset);
  if (writes_left > 0) {
    writes_left--;
    return next(descriptor, bytes, n, offset);
  }
  refused = true;
  errno = ENOSPC;
  return -1;
}

/* Both names under which the C library has it: which one HDF5 calls depends on how it was compiled. */
ssize_t full_disk_pwrite(int descriptor, const void *bytes, size_t n, off_t offset) __asm__("pwrite");
ssize_t full_disk_pwrite64(int descriptor, const void *bytes, size_t n, off_t offset) __asm__("pwrite64");

ssize_t full_disk_pwrite(int descriptor, const void *bytes, size_t n, off_t offset)
{
  PWrite next = NULL;
  *(void **)&next = dlsym(RTLD_NEXT, "pwrite");
  return write_or_refuse(next, descriptor, bytes, n, offset);
}

ssize_t full_disk_pwrite64(int descriptor, const void *bytes, size_t n, off_t offset)
{
  PWrite next = NULL;
  *(void **)&next = dlsym(RTLD_NEXT, "pwrite64");
  return write_or_refuse(next, descriptor, bytes, n, offset);
}
