/* capacities.h - the configuration of spinup.c and table1.c: one body, in any form of its equations of motion. */
#define FB_WITH_FORMS 1
#define FB_MAX_MODES 40
#define FB_MAX_STRAINS 60
#define FB_WITH_SYSTEM 0
#define FB_WITH_EXACT 0
#define FB_WITH_ANALYSE 0
#define FB_WITH_DETAIL 1
