/* union_find.h - sets that grow together: parent [n], each its own at the start; a set's root is its least member. */
#ifndef REDUCE_MESH_SURFACE_UNION_FIND_H
#define REDUCE_MESH_SURFACE_UNION_FIND_H

#include <stdint.h>

static inline int32_t union_find_root(int32_t *parent, int32_t t)
{
  while (parent[t] != t) t = parent[t] = parent[parent[t]];
  return t;
}

static inline void union_find_join(int32_t *parent, int32_t a, int32_t b)
{
  a = union_find_root(parent, a);
  b = union_find_root(parent, b);
  if (a < b)
    parent[b] = a;
  else
    parent[a] = b;
}

#endif
