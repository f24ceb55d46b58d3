/* check.h - a benchmark ends when the library refuses something. */
#ifndef FBB_CHECK_H
#define FBB_CHECK_H

#include "flexbeam.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void fbb_check(fb_status status, const char *what)
{
  if (status != FB_OK) {
    fprintf(stderr, "%s: %s\n", what, fb_status_string(status));
    exit(1);
  }
}

#endif
