/* >>version: version and configuration string. The header is read here after everything it must live with: the
   system's own headers that own short FB_ and one-letter names, and the macros of other systems. */
#if defined(__has_include) && !defined(__cplusplus)
#if __has_include(<termios.h>)
#include <termios.h> /* B0 */
#endif
#if __has_include(<complex.h>)
#include <complex.h> /* I */
#endif
#if __has_include(<linux/fb.h>)
#include <linux/fb.h> /* FB_MAX, FB_TYPE_, FB_ACCEL_, FB_ROTATE_, FB_SYNC_, FB_ACTIVATE_ */
#endif
#endif
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifndef __cplusplus
#define near
#define far
#define small char
#define min(a, b) ((a) < (b) ? (a) : (b))
#define max(a, b) ((a) > (b) ? (a) : (b))
#define PI 3.0
#endif
#include "fbt.h"

/* Interface: a file and the implementation agree on the configuration, and a disagreement is noticed. */
TEST(a_configuration_is_accepted_only_by_its_own_name)
{
  char other[512];
  FBT_INT_EQ(fb_config_check(FB_CONFIG), FB_OK);
  FBT_TRUE(strcmp(fb_config_string(), FB_CONFIG) == 0);
  FBT_TRUE(strlen(FB_CONFIG) + 2 < sizeof other);
  for (size_t i = 0; i < strlen(FB_CONFIG); i++) { /* any one letter changed */
    snprintf(other, sizeof other, "%s", FB_CONFIG);
    other[i] = other[i] == '0' ? '1' : '0';
    FBT_INT_EQ(fb_config_check(other), FB_ERR_VALUE);
  }
  snprintf(other, sizeof other, "%s0", FB_CONFIG);
  FBT_INT_EQ(fb_config_check(other), FB_ERR_VALUE);
  FBT_INT_EQ(fb_config_check(""), FB_ERR_VALUE);
  FBT_INT_EQ(fb_config_check(NULL), FB_ERR_NULL);
}

/* Interface: the name spells out the options, so that a link error can be read. */
TEST(the_configuration_spells_out_the_options)
{
  char expected[512];
  snprintf(expected, sizeof expected,
           "fb_config_is_%s_modes%d_nodes%d_loads%d_elements%d_stations%d_lumps%d_strains%d_lambda%d_s%d_bodies%d_"
           "loops%d_springs%d_rows%d_speeds%d_ports%d_exact%d_points%d_lines%d_linerows%d_linetable%d_rotors%d_with%d%"
           "d%d%d%d%d%d%d%"
           "d_rooms%d%d%d%d",
           FB_SINGLE ? "single" : "double", FB_MAX_MODES, FB_MAX_NODES, FB_MAX_LOADS, FB_MAX_ELEMENTS, FB_MAX_STATIONS,
           FB_MAX_LUMPS, FB_MAX_STRAINS, FB_MAX_LAMBDA, FB_MAX_S, FB_MAX_BODIES, FB_MAX_LOOPS, FB_MAX_SPRINGS,
           FB_MAX_ROWS, FB_MAX_SPEEDS, FB_MAX_PORTS, FB_MAX_EXACT, FB_MAX_POINTS, FB_MAX_LINES, FB_MAX_LINE_ROWS,
           FB_MAX_LINE_TABLE, FB_MAX_ROTORS, FB_WITH_SPIN_COUPLING, FB_WITH_RESIDUAL_INERTIA, FB_WITH_SPIN_STIFFENING,
           FB_WITH_ACCELERATION_STIFFENING, FB_WITH_DAMPING, FB_WITH_GRAVITY, FB_WITH_NONLINEAR_STRAIN,
           FB_WITH_LARGE_DEFLECTION, FB_WITH_ROTORS, FB_WITH_SYSTEM, FB_WITH_EXACT, FB_WITH_BUILD, FB_WITH_ANALYSE);
  FBT_TRUE(strcmp(fb_config_string(), expected) == 0);
  FBT_INT_EQ(sizeof(fb_real), FB_SINGLE ? sizeof(float) : sizeof(double));
}

/* Interface: the compiled version is the header's, three numbers. */
TEST(the_version_is_that_of_the_header)
{
  int number[3];
  char rest;
  FBT_TRUE(strcmp(fb_version_string(), FB_VERSION) == 0);
  FBT_INT_EQ(sscanf(fb_version_string(), "%d.%d.%d%c", &number[0], &number[1], &number[2], &rest), 3);
}

/* Interface: arithmetic is as it is written, else nothing is made (tests/checks/fast_math.sh has the other case). */
TEST(the_build_keeps_arithmetic)
{
  FBT_INT_EQ(fb_build_check(), FB_OK);
}

SUITE(build, RUN(a_configuration_is_accepted_only_by_its_own_name), RUN(the_configuration_spells_out_the_options),
      RUN(the_version_is_that_of_the_header), RUN(the_build_keeps_arithmetic))
