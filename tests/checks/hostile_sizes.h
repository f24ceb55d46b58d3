/* hostile_sizes.h - the sizes of the library that tests/checks/hostile.h wants, for those who compile it apart, too. */
#ifndef HOSTILE_SIZES_H
#define HOSTILE_SIZES_H
#define FB_MAX_MODES 8
#define FB_MAX_NODES 3
#define FB_MAX_LOADS 2
#define FB_MAX_ELEMENTS 3
#define FB_MAX_STATIONS 4
#define FB_MAX_LUMPS 2
#define FB_MAX_BODIES 2
#define FB_MAX_LOOPS 1
#define FB_MAX_ROWS 6
#define FB_MAX_SPEEDS 20
#define FB_MAX_EXACT 6
#define FB_WITH_DETAIL 1
#define FB_WITH_FORMS 1
#endif
