/* capacities.h - the configuration of build/flexbeam and of the FMU of a scene: the library is compiled with it once
   (library.c), and all words are linked with that. Include it before flexbeam.h. */
#ifndef CAPACITIES_H
#define CAPACITIES_H
#define FB_MAX_MODES 24
#define FB_MAX_NODES 65 /* the frame and 64 more; at most NODE_SET of trace.h, for the code that is written */
#define FB_MAX_LOADS 64
#define FB_MAX_ELEMENTS 40
#define FB_MAX_STATIONS 200
#define FB_MAX_STRAINS 60
#define FB_MAX_BODIES 64
#define FB_MAX_PORTS 96
#define FB_MAX_SPEEDS 256
#define FB_MAX_LOOPS 8
#define FB_MAX_SPRINGS 64
#define FB_MAX_EXACT 400
#define FB_WITH_FORMS 1
#define FB_WITH_DETAIL 1
#endif
