/* full_disk.h - a disk that fills up. Linking this puts a pwrite before the C library's, which HDF5 then calls: once so
 * many writes have succeeded, each further one to a file with a name fails with ENOSPC. */
#ifndef TESTS_SUPPORT_FULL_DISK_H
#define TESTS_SUPPORT_FULL_DISK_H

#include <stdbool.h>

void disk_fill_after(int writes); // how many more writes succeed
void disk_empty(void);            // room for ever again
bool disk_was_full(void);         // did a write fail since disk_fill_after?
#endif
