/* picture_colour.c - colour maps: control points, straight between them in sRGB. */
#include "common/picture/picture.h"

#include <math.h>

enum { POINTS = 9 };

// lightness rises evenly along the first two, so that they also read in grey
static const unsigned char maps[][POINTS][3] = {[PICTURE_HEAT] = {{6, 4, 24},
                                                                  {38, 12, 82},
                                                                  {88, 16, 110},
                                                                  {138, 34, 106},
                                                                  {186, 54, 85},
                                                                  {226, 88, 52},
                                                                  {247, 140, 16},
                                                                  {250, 198, 48},
                                                                  {252, 250, 160}},
                                                [PICTURE_VIRIDIS] = {{68, 1, 84},
                                                                     {71, 44, 122},
                                                                     {59, 81, 139},
                                                                     {44, 113, 142},
                                                                     {33, 144, 141},
                                                                     {39, 173, 129},
                                                                     {92, 200, 99},
                                                                     {170, 220, 50},
                                                                     {253, 231, 37}},
                                                [PICTURE_WARM] = {{226, 228, 230},
                                                                  {236, 224, 208},
                                                                  {245, 214, 178},
                                                                  {250, 194, 142},
                                                                  {250, 164, 108},
                                                                  {238, 124, 80},
                                                                  {214, 80, 56},
                                                                  {174, 38, 36},
                                                                  {120, 6, 22}},
                                                [PICTURE_DIVERGE] = {{33, 84, 160},
                                                                     {84, 136, 196},
                                                                     {144, 184, 220},
                                                                     {198, 216, 232},
                                                                     {240, 240, 240},
                                                                     {240, 208, 190},
                                                                     {228, 156, 132},
                                                                     {206, 94, 82},
                                                                     {166, 30, 46}}};

PictureColour picture_colour(const PictureScale *scale, double value)
{
  const double place = (value - scale->low) / (scale->high - scale->low) * (POINTS - 1);
  if (!(isfinite(place) || isinf(value))) return (PictureColour){0.55, 0.55, 0.55};
  const double clamped = fmin(fmax(place, 0.0), (double)(POINTS - 1));
  const int i = clamped < POINTS - 1 ? (int)clamped : POINTS - 2;
  const double share = clamped - i;
  const unsigned char *a = maps[scale->map][i], *b = maps[scale->map][i + 1];
  double mixed[3];
  for (int k = 0; k < 3; k++) mixed[k] = ((1.0 - share) * a[k] + share * b[k]) / 255.0;
  return (PictureColour){mixed[0], mixed[1], mixed[2]};
}

PictureColour picture_category(size_t i)
{
  // after Okabe & Ito (2008), chosen to be told apart with any colour vision; the yellow darkened for white paper
  static const unsigned char colours[8][3] = {{0, 114, 178},  {213, 94, 0},  {0, 158, 115}, {204, 121, 167},
                                              {86, 180, 233}, {196, 160, 0}, {90, 90, 90},  {128, 70, 160}};
  const unsigned char *colour = colours[i % 8];
  const double pale = 1.0 - pow(0.62, (double)((i / 8) % 3));
  double mixed[3];
  for (int k = 0; k < 3; k++) mixed[k] = (1.0 - pale) * colour[k] / 255.0 + pale;
  return (PictureColour){mixed[0], mixed[1], mixed[2]};
}
