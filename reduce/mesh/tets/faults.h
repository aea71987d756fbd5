/* faults.h - several faults found in one go, gathered as lines of one error. */
#ifndef REDUCE_MESH_TETS_FAULTS_H
#define REDUCE_MESH_TETS_FAULTS_H

#include <stddef.h>
#include "common/error.h"

typedef struct Faults {
  CastError *err; // borrowed
  size_t count;
} Faults;

/* Add a line; once the message is full the rest is only counted. */
void faults_add(Faults *faults, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* CAST_OK without faults; else CAST_ERR_INPUT with the lines, headed by `heading`. */
CastStatus faults_finish(const Faults *faults, const char *heading);

#endif
