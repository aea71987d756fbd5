#include "cast/kernel/kernel.h"

#include "cast/kernel/pair.h"

static const char *const names[] = {"wendland-c2", "cubic-spline", "quintic-spline", "lucy"};

double kernel_support(KernelKind kind)
{
  return shape_support(kind);
}

const char *kernel_name(KernelKind kind)
{
  return names[kind];
}

double kernel_value(KernelKind kind, double r, double h)
{
  return shape_norm(kind) / (h * h * h) * shape_value(kind, r / h);
}

double kernel_slope(KernelKind kind, double r, double h)
{
  return shape_norm(kind) / (h * h * h * h * h) * shape_slope(kind, r / h);
}
