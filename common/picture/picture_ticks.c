/* picture_ticks.c - where an axis is marked, and with what text. */
#include "common/picture/picture_private.h"

#include <math.h>
#include <stdio.h>

double picture_nice_step(double span, int parts)
{
  const double rough = span / parts, power = pow(10.0, floor(log10(rough)));
  const double digit = rough / power;
  return power * (digit < 1.5 ? 1.0 : digit < 3.5 ? 2.0 : digit < 7.5 ? 5.0 : 10.0);
}

static void add_tick(PictureTicks *ticks, double value)
{
  if (ticks->n >= PICTURE_MOST_TICKS) return;
  ticks->value[ticks->n] = value;
  ticks->label[ticks->n++][0] = '\0';
}

/* As many decimals as the step has; powers of ten where zeros would fill the label. */
static void label_linear(PictureTicks *ticks, double step)
{
  double largest = 0.0;
  for (int i = 0; i < ticks->n; i++) largest = fmax(largest, fabs(ticks->value[i]));
  const bool powers = largest >= 1e6 || largest < 1e-3;
  const int decimals = (int)fmax(0.0, -floor(log10(step) + 1e-9));
  const int digits = (int)fmax(0.0, floor(log10(largest) + 1e-9) - floor(log10(step) + 1e-9));
  for (int i = 0; i < ticks->n; i++) {
    const double value = fabs(ticks->value[i]) < 1e-9 * step ? 0.0 : ticks->value[i];
    if (powers && value != 0.0)
      snprintf(ticks->label[i], sizeof ticks->label[i], "%.*e", digits, value);
    else
      snprintf(ticks->label[i], sizeof ticks->label[i], "%.*f", powers ? 0 : decimals, value);
  }
}

void picture_ticks_linear(double low, double high, int parts, PictureTicks *ticks)
{
  const double step = picture_nice_step(high - low, parts), slack = 1e-6 * step;
  ticks->n = 0;
  for (double i = ceil((low - slack) / step); i * step <= high + slack; i++) add_tick(ticks, i * step);
  label_linear(ticks, step);
}

static void label_power(PictureTicks *ticks, int i, int digit, int exponent, bool plain)
{
  const size_t room = sizeof ticks->label[i];
  if (plain)
    snprintf(ticks->label[i], room, "%g", digit * pow(10.0, exponent));
  else if (digit == 1)
    snprintf(ticks->label[i], room, "10^%d", exponent);
}

void picture_ticks_log(double low, double high, PictureTicks *ticks)
{
  const int first = (int)floor(log10(low) + 1e-9), last = (int)ceil(log10(high) - 1e-9);
  const int every = (last - first + 7) / 8; // decades between labels
  const bool short_axis = log10(high / low) < 1.8, plain = first >= -2 && last <= 4;
  ticks->n = 0;
  for (int exponent = first; exponent <= last; exponent++)
    for (int digit = 1; digit < 10; digit++) {
      const double value = digit * pow(10.0, exponent);
      if (value < low * (1.0 - 1e-9) || value > high * (1.0 + 1e-9)) continue;
      if (digit > 1 && last - first > 7) continue; // too many decades for minor ticks
      const int i = ticks->n;
      add_tick(ticks, value);
      if (ticks->n == i) return;
      const bool labelled = digit == 1 ? (exponent - first) % every == 0 : short_axis && (digit == 2 || digit == 5);
      if (labelled) label_power(ticks, i, digit, exponent, plain || short_axis);
    }
}
