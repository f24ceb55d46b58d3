/* section_doubt.h - where the stiffness, mass and length of a beam do not go together in SI units: what cannot be of any
   material, and the mistake that would make it so. What is not given (0) is not judged. Include stdio, math, string
   before. */
#ifndef SECTION_DOUBT_H
#define SECTION_DOUBT_H
#include <math.h>
#include <stdio.h>

#define SECTION_DOUBT 240

typedef struct section_figures { /* of a station */
  double mass, EA, GJ, EI_y, EI_z, i_y, i_z;
} section_figures;

/* sqrt(EA/mass) [m/s] is the speed of waves in the material: from rubber, 50, to diamond, 20,000. The mistake that
   leads farthest back to 3000, between wood and steel. */
static const char *section_why_speed(double speed)
{
  static const struct {
    double factor;
    const char *why;
  } mistakes[] = {{31.6227766, "lengths in mm, mass in kg/mm?"},
                  {1000, "lengths in mm, mass in t/mm?"},
                  {6.27, "lengths in inches, mass in pounds?"},
                  {1e-3, "E in N/mm^2 (MPa)?"},
                  {3.16227766e-5, "E in GPa?"},
                  {3.16227766e-2, "mass in g/m, or EA in kN?"}};
  double least = HUGE_VAL;
  const char *why = "";
  for (int k = 0; k < (int)(sizeof mistakes / sizeof *mistakes); k++) {
    const double off = fabs(log(speed / mistakes[k].factor / 3000));
    why = off < least ? mistakes[k].why : why;
    least = fmin(least, off);
  }
  return why;
}

/* The first doubt about a station at x of a beam of that length, into text; 0: there is none. */
static int section_doubt(char text[SECTION_DOUBT], double x, double length, const section_figures *s)
{
  const double stiff = fmax(s->EI_y, s->EI_z), soft = s->EI_y > 0 && s->EI_z > 0 ? fmin(s->EI_y, s->EI_z) : stiff;
  const double speed = s->EA > 0 && s->mass > 0 ? sqrt(s->EA / s->mass) : 0;
  const double thick = s->EA > 0 ? sqrt(stiff / s->EA) : 0, thin = s->EA > 0 ? sqrt(soft / s->EA) : 0;
  const double gyration = s->mass > 0 ? sqrt(fmax(s->i_y, s->i_z) / s->mass) : 0;
  text[0] = 0;
  if (speed > 0 && (speed < 50 || speed > 20000)) {
    snprintf(text, SECTION_DOUBT, "at x = %.6g sqrt(EA/mass) = %.3g m/s, of no material (50 to 20,000): %s", x, speed,
             section_why_speed(speed));
  } else if (thick > length / 3) {
    snprintf(text, SECTION_DOUBT,
             "at x = %.6g sqrt(EI/EA) = %.3g m, above a third of the length, %.6g m: EI in N mm^2?", x, thick, length);
  } else if (thin > 0 && thin < 1e-6 * length) {
    snprintf(text, SECTION_DOUBT, "at x = %.6g sqrt(EI/EA) = %.3g m, below 1e-6 of the length, %.6g m: lengths in mm?",
             x, thin, length);
  } else if (s->GJ > 0 && soft > 0 && (s->GJ > 1e3 * stiff || s->GJ < 1e-3 * soft)) {
    const int high = s->GJ > 1e3 * stiff;
    snprintf(text, SECTION_DOUBT, "at x = %.6g GJ/EI = %.3g, beyond 1e-3 to 1e3: %s in N mm^2?", x,
             s->GJ / (high ? stiff : soft), high ? "GJ" : "EI");
  } else if (gyration > length / 3) {
    snprintf(text, SECTION_DOUBT,
             "at x = %.6g sqrt(i/mass) = %.3g m, above a third of the length, %.6g m: i_y and i_z in kg mm?", x,
             gyration, length);
  }
  return text[0] != 0;
}
#endif
