/* Trees of random bodies on joints. With WRITE: usage: write TREE [--single] [--loads] .., prints the generated step of that tree
   (list below), exit 3 if there is none. Else: TREE is stepped beside fb_system_rk4_step, unloaded and loaded; the largest
   difference of each kind of variable relative to its extreme is printed and at most TOLERANCE, energy and momentum stay
   as they do there, and what the library refuses is refused. */
#include "flexbeam.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef WRITE
#include "examples/tools/code_tree.h"
#else
#define generated_IMPLEMENTATION
#include "code.h"
#endif

enum { RIGID, BOOM, PANEL, WHEEL, HUB, MAST, BENT, VANE, MODELS, GIVEN = 16, RUBS = 32, LOCKED = 64, TIP = 8 };
enum { GIVEN_2 = 128, LOCKED_2 = 256 };
/* With RIGID..: GIVEN: the axis of its joint is prescribed; LOCKED: it is that; _2: its second axis; RUBS: it has friction and stops, which it reaches. WHEEL: turns
   fast about its hinge; HUB and MAST: as RIGID and BOOM, with rotors inside; BENT and VANE: of 6 and 2 modes, lines of large deflection */

typedef struct hang {
  int joint, parent, model;
} hang;

enum {
  ROOT = FB_JOINT_FREE,
  WELD = FB_JOINT_RIGID,
  HINGE = FB_JOINT_REVOLUTE,
  SLIDE = FB_JOINT_PRISMATIC,
  TUBE = FB_JOINT_CYLINDRICAL,
  SCREW = FB_JOINT_SCREW,
  CROSS = FB_JOINT_UNIVERSAL,
  BALL = FB_JOINT_SPHERICAL
};
enum {
  LINEAR = FB_EFFECTS_LINEAR,
  SPIN = FB_EFFECTS_SPIN,
  FULL = FB_EFFECTS_FULL,
  STIFFENED = FB_EFFECT_ACCELERATION_STIFFENING,
  DAMPING = FB_EFFECT_DAMPING,
  DAMPED = FB_EFFECTS_FULL | FB_EFFECT_DAMPING
};
enum { HARD = 1000 };
enum { UNIFORM = 1, CENTER = 2, APART = 4, MIXED = 8, ORBIT = 16 };
/* Gravity: of a center on all bodies; that of rigid ones of another center; or uniform on these; of the Earth, in a low orbit */
enum { PLANE = 2, DOOR = 3 }; /* of joints: all axes along z; on that of the first joint, whose loop moves nothing */

/* Effects of the flexible models, gravity, joints turned at random (0: about x; PLANE: not at all), bodies. The first two are those of
   bench/system_count.c, hinge and booms, in which nothing is random. */
static const struct {
  unsigned effects;
  int gravity, turned;
  hang link[5];
} trees[] = {
    {FULL, 0, 0, {{ROOT, -1, RIGID}, {HINGE, 0, RIGID}}},
    {FULL, 0, 0, {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {HINGE, 0, BOOM}}},
    {FULL, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, RIGID}}},
    {DAMPED, 0, 0, {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {HINGE, 0, PANEL}}},
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {SLIDE, 0, RIGID}, {TUBE, 0, BOOM}}},
    {FULL, 1, 1, {{ROOT, -1, RIGID}, {SCREW, 0, PANEL}, {CROSS, 0, RIGID}, {WELD, 2, BOOM}}},
    {FULL, 0, 1, {{ROOT, -1, RIGID}, {BALL, 0, BOOM}, {WELD, 0, PANEL}, {HINGE, 1, RIGID}}},
    {FULL, 1, 0, {{HINGE, -1, RIGID}, {HINGE, 0, RIGID}, {CROSS, 1, RIGID}}},
    {DAMPED, 1, 1, {{BALL, -1, RIGID}, {HINGE, 0, BOOM}, {SLIDE, -1, PANEL}}},
    {FULL, 0, 1, {{ROOT, -1, BOOM}, {CROSS, 0, RIGID}, {HINGE, 1, PANEL}, {BALL, 2, RIGID}}},
    {FULL, 1, 0, {{WELD, -1, RIGID}, {TUBE, 0, BOOM}, {SCREW, 1, RIGID}}},
    {SPIN, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {HINGE, 0, PANEL}}},
    {LINEAR, 0, 0, {{ROOT, -1, PANEL}, {BALL, 0, BOOM}}},
    {SPIN | STIFFENED | DAMPING, 0, 1, {{ROOT, -1, RIGID}, {SLIDE, 0, BOOM}, {SLIDE, 1, RIGID}}},
    {FULL, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, RIGID}, {HINGE, 1, RIGID}, {HINGE, 2, BOOM}, {CROSS, 0, BOOM}}},
    {FULL, 1, 1, {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {HINGE, -1, RIGID}, {BALL, 2, PANEL}}},
    {SPIN | DAMPING, 0, 1, {{HINGE, -1, PANEL}, {ROOT, -1, RIGID}, {CROSS, 1, RIGID}, {SLIDE, 0, BOOM}}},
    {DAMPED, 1, 1, {{HINGE, -1, RIGID | GIVEN}, {HINGE, 0, BOOM}, {SLIDE, 0, PANEL}}},
    {FULL,
     0,
     0,
     {{HINGE, -1, RIGID}, {SCREW, 0, PANEL | GIVEN}, {BALL, 1, BOOM}, {SLIDE, 1, RIGID | GIVEN}, {CROSS, 3, RIGID}}},
    {FULL, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, BOOM | RUBS}, {CROSS, 0, RIGID | RUBS}, {SLIDE, 2, RIGID | RUBS}}},
    {DAMPED,
     1,
     0,
     {{HINGE, -1, RIGID | RUBS},
      {SCREW, 0, PANEL | RUBS},
      {TUBE, -1, RIGID | RUBS},
      {HINGE, -1, RIGID | RUBS | GIVEN}}},
    /* 21: four bars in a plane; 22: with a coupler that bends, driven by the crank */
    {FULL, 0, PLANE, {{HINGE, -1, RIGID}, {HINGE, 0, RIGID}, {HINGE, -1, RIGID}}},
    {FULL, 0, PLANE, {{HINGE, -1, RIGID | GIVEN}, {HINGE, 0, PANEL}, {HINGE, -1, RIGID}}},
    {DAMPED, 1, 1, {{HINGE, -1, RIGID}, {BALL, 0, BOOM}, {CROSS, -1, PANEL}, {HINGE, 2, RIGID}}},
    {SPIN, 1, 1, {{CROSS, -1, RIGID}, {HINGE, 0, BOOM}, {BALL, 1, PANEL}, {TUBE, 2, RIGID}}},
    {FULL, 0, 1, {{HINGE, -1, RIGID | GIVEN}, {BALL, 0, BOOM}, {BALL, 1, BOOM}, {SLIDE, -1, RIGID}}},
    {LINEAR | DAMPING, 1, 1, {{HINGE, -1, RIGID}, {BALL, 0, BOOM}, {BALL, 1, PANEL}}},
    {FULL, 0, 1, {{WELD, -1, BOOM}, {BALL, -1, PANEL}, {SLIDE, 1, RIGID}}},
    /* 28 to 31: loops that fly: four bars on a hub; arms that hold one another; with a root that bends; without residual
       inertia, beside a loop on the ground */
    {FULL, 0, PLANE, {{ROOT, -1, RIGID}, {HINGE, 0, RIGID}, {HINGE, 1, RIGID}, {HINGE, 0, RIGID}}},
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {CROSS, 0, BOOM}, {BALL, 0, BOOM}}},
    {FULL, 1, 1, {{ROOT, -1, PANEL}, {HINGE, 0, RIGID}, {BALL, 1, BOOM}, {CROSS, 0, PANEL}, {TUBE, 3, RIGID}}},
    {SPIN | DAMPING,
     0,
     1,
     {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {BALL, 1, RIGID}, {HINGE, -1, PANEL}, {BALL, 3, RIGID}}},
    /* 32 to 35: loops with springs, dampers, friction and stops; by screws */
    {DAMPED, 0, PLANE, {{ROOT, -1, RIGID}, {HINGE, 0, RIGID | RUBS}, {HINGE, 1, PANEL}, {HINGE, 0, RIGID}}},
    {FULL, 1, 1, {{HINGE, -1, RIGID}, {BALL, 0, BOOM}, {BALL, 1, PANEL}}},
    {FULL, 0, 1, {{ROOT, -1, PANEL}, {CROSS, 0, BOOM}, {BALL, 1, RIGID}, {CROSS, 2, PANEL}}},
    {FULL, 0, DOOR, {{HINGE, -1, RIGID}, {SLIDE, -1, PANEL}}},
    /* 36: arm of two links that bend; 37..: joints on tips that modes move */
    {FULL, 0, PLANE, {{HINGE, -1, PANEL}, {HINGE, 0 + TIP, PANEL}}},
    {DAMPED, 0, 1, {{HINGE, -1, BOOM}, {BALL, 0 + TIP, PANEL}}},
    {FULL, 0, 1, {{ROOT, -1, PANEL}, {HINGE, 0 + TIP, PANEL}, {SLIDE, 0 + TIP, RIGID}}},
    {SPIN | DAMPING,
     0,
     1,
     {{CROSS, -1, RIGID}, {WELD, 0, PANEL}, {WELD, 1 + TIP, RIGID}, {HINGE, 2, PANEL}, {SCREW, 3 + TIP, PANEL}}},
    {LINEAR, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, PANEL}, {CROSS, 1 + TIP, BOOM}}},
    {FULL, 0, 1, {{SLIDE, -1, PANEL}, {HINGE, 0 + TIP, PANEL | GIVEN}, {HINGE, 1 + TIP, RIGID | RUBS}}},
    {DAMPED, 1, 1, {{HINGE, -1, RIGID}, {WELD, 0, PANEL}, {BALL, 1 + TIP, RIGID}}},
    /* 43: wheels on hinges; 44: and on the ground; 45: rotors inside bodies; 46: both */
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, WHEEL}, {HINGE, 0, BOOM}, {HINGE, 2, WHEEL}}},
    {FULL, 1, 1, {{HINGE, -1, RIGID | GIVEN}, {CROSS, 0, BOOM}, {HINGE, 1, WHEEL}}},
    {DAMPED, 0, 1, {{ROOT, -1, HUB}, {HINGE, 0, MAST}, {HINGE, 0, BOOM}}},
    {LINEAR, 1, 1, {{ROOT, -1, MAST}, {CROSS, 0, HUB}, {HINGE, 1, WHEEL}}},
    /* 47: a wheel beside a loop */
    {DAMPED, 1, 1, {{HINGE, -1, RIGID}, {BALL, 0, BOOM}, {CROSS, -1, PANEL}, {HINGE, 2, RIGID}, {HINGE, 0, WHEEL}}},
    /* 48: a wheel on the frame of a body that carries another one on its tip, rotors beside; 49: a prescribed crank with a
       loop on the ground beside a free tree with a wheel */
    {FULL, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, PANEL}, {HINGE, 1 + TIP, RIGID}, {HINGE, 1, WHEEL}, {HINGE, 0, HUB}}},
    {FULL,
     0,
     PLANE,
     {{ROOT, -1, RIGID}, {HINGE, -1, RIGID | GIVEN}, {HINGE, 1, PANEL}, {HINGE, -1, RIGID | RUBS}, {HINGE, 0, WHEEL}}},
    /* 50 to 52: rotors and wheels where modes move a joint: behind it, and on the body that carries it */
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, MAST}, {CROSS, 1 + TIP, HUB}, {HINGE, 1 + TIP, WHEEL}}},
    {FULL, 0, 1, {{HINGE, -1, MAST}, {HINGE, 0 + TIP, HUB}, {WELD, 0 + TIP, PANEL}, {HINGE, 2, WHEEL}}},
    {SPIN, 0, 1, {{ROOT, -1, MAST}, {HINGE, 0 + TIP, MAST}, {HINGE, 0, HUB}}},
    /* 53 to 56: loops beside joints on nodes that modes move: between what hangs there and the ground, the body that
       carries it, and what flies; 57 and 58: beside rotors, on the body of a loop and on one that carries it */
    {DAMPED, 1, 1, {{HINGE, -1, PANEL}, {BALL, 0 + TIP, PANEL}, {CROSS, -1, RIGID}}},
    {FULL, 1, 1, {{BALL, -1, PANEL}, {CROSS, 0 + TIP, RIGID}, {HINGE, 0, BOOM | RUBS}}},
    {FULL, 0, 1, {{ROOT, -1, BOOM}, {HINGE, 0 + TIP, RIGID}, {CROSS, 0, RIGID}, {WELD, 2, PANEL}}},
    {DAMPED, 1, 1, {{HINGE, -1, RIGID | GIVEN}, {BALL, 0, PANEL}, {HINGE, 1 + TIP, RIGID}, {SLIDE, -1, RIGID}}},
    {DAMPED, 1, 1, {{HINGE, -1, HUB}, {BALL, 0, MAST}, {CROSS, -1, RIGID}}},
    {SPIN, 0, 1, {{ROOT, -1, MAST}, {HINGE, 0 + TIP, HUB}, {CROSS, 0, HUB}, {HINGE, 0, WHEEL}}},
    /* 59 to 62: loops that tie what flies to the ground: an arm; a body that a crank carries and a joint on a node that modes
       move; by its root, with rotors and a loop of its own; a pendulum */
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {CROSS, 0, BOOM}, {HINGE, 0, PANEL}}},
    {SPIN, 0, 1, {{ROOT, -1, PANEL}, {BALL, 0 + TIP, RIGID}, {HINGE, -1, RIGID | GIVEN}, {HINGE, -1, PANEL}}},
    {FULL, 0, 1, {{ROOT, -1, HUB}, {CROSS, 0, MAST}, {BALL, 0, RIGID}}},
    {FULL, 1, 1, {{ROOT, -1, RIGID}, {HINGE, 0, RIGID}, {HINGE, 0, WHEEL}}},
    /* 63 to 66: axes of what flies that are prescribed: of arms; beside a loop; and locked ones, with one on the ground */
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, BOOM | GIVEN}, {SCREW, 0, PANEL}, {SLIDE, 2, RIGID | GIVEN}}},
    {FULL, 0, 1, {{ROOT, -1, PANEL}, {HINGE, 0, RIGID | GIVEN}, {BALL, 1, RIGID}, {CROSS, 0, BOOM}}},
    {FULL,
     1,
     1,
     {{ROOT, -1, RIGID},
      {HINGE, 0, BOOM | LOCKED | RUBS},
      {HINGE, 1, WHEEL},
      {HINGE, 0, PANEL | GIVEN},
      {SCREW, -1, RIGID | LOCKED}}},
    {SPIN, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, PANEL | GIVEN}, {SLIDE, 1 + TIP, RIGID | LOCKED}, {HINGE, 2, BOOM}}},
    /* 67 to 69: springs between points: of booms and the hub that carries them; on nodes that modes move and that carry
       joints, to the ground; beside a loop that ties what flies, and without length */
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {CROSS, 0, PANEL}}},
    {DAMPED, 0, 1, {{HINGE, -1, PANEL}, {HINGE, 0 + TIP, BOOM}, {HINGE, 0 + TIP, RIGID}}},
    {SPIN, 0, 1, {{ROOT, -1, PANEL}, {HINGE, 0, BOOM}, {BALL, -1, RIGID}}},
    /* 70: a beam that a loop holds altogether, beside a prescribed crank */
    {SPIN, 0, 1, {{HINGE, -1, RIGID | GIVEN}, {HINGE, 0, BOOM}, {WELD, -1, BOOM}}},
    /* 71 to 73: springs with actuators: an arm with muscles, one of which is nothing else; a payload on springs and actuators
       on a boom that flies; on nodes that modes move and that carry joints, beside a prescribed axis */
    {FULL, 1, 1, {{HINGE, -1, RIGID}, {HINGE, 0, RIGID}, {CROSS, 1, RIGID}}},
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {BALL, 1 + TIP, RIGID}}},
    {DAMPED, 0, 1, {{HINGE, -1, PANEL}, {HINGE, 0 + TIP, BOOM}, {HINGE, 0 + TIP, RIGID | GIVEN}, {SLIDE, 2, RIGID}}},
    /* 74 to 78: springs from what flies to the ground and to what hangs on that: a tethered satellite with a boom; a payload
       that four hold; with gravity, to a beam on the ground and to a prescribed crank; beside a loop; a frame that stands, with
       rotors */
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {CROSS, 0, BOOM}}},
    {FULL, 1, 0, {{ROOT, -1, RIGID}}},
    {DAMPED, 1, 1, {{HINGE, -1, PANEL}, {ROOT, -1, PANEL}, {BALL, 1 + TIP, RIGID}, {HINGE, -1, RIGID | GIVEN}}},
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, PANEL}, {BALL, 0, RIGID}, {HINGE, -1, RIGID}}},
    {SPIN, 0, 1, {{ROOT, -1, MAST}, {HINGE, 0 + TIP, HUB}, {SLIDE, -1, BOOM}}},
    /* 79 to 83: axes of joints that have several, prescribed and locked: one of them, of what flies; on the ground, with
       friction and stops, and a spherical joint; spherical and both axes, on nodes that modes move; beside a loop */
    {DAMPED,
     0,
     1,
     {{ROOT, -1, RIGID}, {CROSS, 0, BOOM | LOCKED}, {TUBE, 0, PANEL | GIVEN_2}, {CROSS, 2, RIGID | GIVEN}}},
    {FULL, 1, 1, {{CROSS, -1, RIGID | LOCKED_2 | RUBS}, {TUBE, 0, PANEL | GIVEN | RUBS}, {BALL, 1, RIGID | GIVEN}}},
    {SPIN | DAMPING,
     0,
     1,
     {{ROOT, -1, PANEL}, {BALL, 0 + TIP, BOOM | LOCKED}, {CROSS, 0 + TIP, HUB | GIVEN | LOCKED_2}, {HINGE, 0, WHEEL}}},
    {FULL, 0, 1, {{TUBE, -1, RIGID | GIVEN}, {CROSS, 0, BOOM | LOCKED}, {BALL, 1, BOOM}, {SLIDE, -1, RIGID}}},
    {FULL,
     0,
     1,
     {{ROOT, -1, RIGID}, {BALL, 0, BOOM | GIVEN}, {CROSS, 0, PANEL | GIVEN_2}, {CROSS, 2, RIGID | LOCKED_2}}},
    /* 84 to 91: axes of loops that are prescribed and locked: a crank that the loop's joint turns; universal, cylindrical,
       spherical joints, a screw; one that ties what flies; one on the joint that it turns */
    {FULL, 0, PLANE, {{HINGE, -1, RIGID}, {HINGE, 0, BOOM}, {HINGE, -1, RIGID}}},
    {DAMPED, 1, 1, {{HINGE, -1, RIGID}, {BALL, 0, BOOM}, {CROSS, -1, PANEL}, {HINGE, 2, RIGID}}},
    {FULL, 0, 1, {{ROOT, -1, RIGID}, {CROSS, 0, BOOM}, {BALL, 0, BOOM}, {CROSS, 2, RIGID}}},
    {FULL, 0, 1, {{HINGE, -1, RIGID}, {BALL, 0, BOOM}, {BALL, 1, RIGID}}},
    {SPIN, 0, 1, {{HINGE, -1, RIGID}, {BALL, 0, BOOM}, {BALL, 1, RIGID}}},
    {FULL, 0, 1, {{ROOT, -1, PANEL}, {CROSS, 0, BOOM}, {BALL, 1, RIGID}, {CROSS, 2, PANEL}}},
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {CROSS, 0, BOOM}, {HINGE, 0, PANEL}}},
    {FULL, 0, DOOR, {{HINGE, -1, RIGID}, {SLIDE, -1, PANEL}}},
    /* 92 to 100: gravity of a center: a free hub and a boom; rigid, beside uniform gravity; of two centers, with a wheel;
       on the ground; rotors and joints on nodes that modes move; on some bodies, with a loop; with a loop that ties what
       flies; prescribed axes, a spring and a tree on the ground; in a low orbit */
    {DAMPED, CENTER, 1, {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}}},
    {FULL, CENTER | UNIFORM, 1, {{ROOT, -1, RIGID}, {CROSS, 0, RIGID}}},
    {DAMPED, CENTER | APART, 1, {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {BALL, 0, PANEL}, {HINGE, 1, WHEEL}}},
    {FULL, CENTER, 1, {{HINGE, -1, RIGID}, {BALL, 0, BOOM}, {SLIDE, -1, PANEL}}},
    {DAMPED, CENTER, 1, {{ROOT, -1, MAST}, {HINGE, 0 + TIP, PANEL}, {CROSS, 0, HUB}}},
    {DAMPED, CENTER | MIXED, 1, {{ROOT, -1, RIGID}, {CROSS, 0, BOOM}, {BALL, 0, BOOM}}},
    {DAMPED, CENTER, 1, {{ROOT, -1, RIGID}, {CROSS, 0, BOOM}, {HINGE, 0, PANEL}}},
    {FULL,
     CENTER | MIXED,
     1,
     {{ROOT, -1, PANEL}, {HINGE, 0, BOOM | GIVEN}, {SCREW, 0, RIGID | RUBS}, {HINGE, -1, PANEL}}},
    {FULL, CENTER | ORBIT, 1, {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {HINGE, 0, WHEEL}}},
    /* 101 on: lines of large deflection: 101: on a hinge of a hub, as tree 0; 102: two of them, damped, turned at random; 103: at
       the root, with a body on its tip, and a panel of polynomials; 104: a chain of them on their tips; 105: a loop
       from tip to tip; 106: with a spring between tips, a prescribed hinge, a wheel; 107: tips of what flies tied to the ground;
       108: beside rotors, with friction and stops; 109: a loop of a tree that flies;
       110: stops beside a line on the ground */
    {FULL, 0, 0, {{ROOT, -1, RIGID}, {HINGE, 0, BENT}}},
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, BENT}, {HINGE, 0, VANE}}},
    {DAMPED, 1, 1, {{ROOT, -1, BENT}, {HINGE, 0 + TIP, RIGID}, {CROSS, 0, PANEL}}},
    {DAMPED, 1, 1, {{HINGE, -1, VANE}, {BALL, 0 + TIP, BENT}, {SLIDE, 1 + TIP, RIGID}}},
    {DAMPED, 0, 1, {{HINGE, -1, VANE}, {CROSS, 0 + TIP, RIGID}, {BALL, -1, VANE}}},
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, VANE | GIVEN}, {WELD, 0, VANE}, {HINGE, 2, WHEEL}}},
    {FULL, 0, 1, {{ROOT, -1, VANE}, {HINGE, 0, VANE}, {BALL, 0, RIGID}}},
    {SPIN | DAMPING, 1, 1, {{ROOT, -1, HUB}, {HINGE, 0, VANE | RUBS}, {TUBE, 0, MAST}}},
    {FULL, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, VANE}, {HINGE, 0, VANE | RUBS}}},
    {DAMPED, 1, 1, {{WELD, -1, BENT}, {HINGE, 0, RIGID | RUBS}}},
    /* 111: a boom of polynomials on a rigid hub, beside a line */
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {CROSS, 0, VANE}, {HINGE, 0, BOOM}}},
    /* 112, 113: two that fly, which a spring joins; by a trace */
    {DAMPED, 0, 1, {{ROOT, -1, RIGID}, {HINGE, 0, BOOM}, {ROOT, -1, PANEL}, {CROSS, 2, RIGID | RUBS}}},
    {FULL, CENTER, 1, {{ROOT, -1, HUB}, {ROOT, -1, RIGID}, {HINGE, 1, MAST}}},
};

enum { LINES = 101, LINED = 112 }; /* trees with lines, whose models are not built for the others */

/* Joints that close loops at zero coordinates of these trees; TIP: the node of the boom's tip carries it; RUBS, of the
   child: with spring and damper, and friction and stops if it is not spherical. */
static const struct {
  int tree, joint, parent, child;
} loops[] = {{21, HINGE, 1, 2},
             {22, HINGE, 1 + TIP, 2},
             {23, BALL, 1 + TIP, 3},
             {24, BALL, 0, 2},
             {24, CROSS, -1, 3},
             {25, TUBE, 2 + TIP, 3},
             {26, BALL, 1 + TIP, 2},
             {26, BALL, -1, 1 + TIP},
             {27, SLIDE, 0 + TIP, 1 + TIP},
             {28, HINGE, 2, 3},
             {29, BALL, 1 + TIP, 2 + TIP},
             {30, BALL, 2 + TIP, 4},
             {30, CROSS, 0 + TIP, 2},
             {31, TUBE, 0, 2},
             {31, BALL, -1, 4},
             {32, HINGE, 2 + TIP, 3 + RUBS},
             {33, BALL, -1, 2 + TIP + RUBS},
             {33, CROSS, 0, 1 + TIP + RUBS},
             {34, SCREW, 0, 3 + TIP + RUBS},
             {35, HINGE, -1, 0 + RUBS},
             {47, BALL, 1 + TIP, 3},
             {49, HINGE, 2 + TIP, 3 + RUBS},
             {53, BALL, 1 + TIP, 2},
             {54, BALL, 0 + TIP, 2 + TIP + RUBS},
             {54, TUBE, -1, 1},
             {55, BALL, 1, 3 + TIP},
             {56, BALL, 2, 3},
             {57, BALL, 1 + TIP, 2},
             {58, BALL, 1, 2},
             {59, BALL, -1, 1 + TIP},
             {60, BALL, 2, 1},
             {60, CROSS, 3 + TIP, 0 + TIP},
             {61, HINGE, -1, 0 + RUBS},
             {61, BALL, 1 + TIP, 2},
             {62, BALL, -1, 1},
             {64, BALL, 2, 3 + TIP},
             {69, BALL, 0, 2},
             {70, TUBE, -1, 2 + TIP},
             {77, BALL, 1 + TIP, 2},
             {82, BALL, 2 + TIP, 3},
             {84, HINGE, 1 + TIP, 2 + GIVEN},
             {85, CROSS, 1 + TIP, 3 + LOCKED_2 + RUBS},
             {86, TUBE, 1 + TIP, 3 + LOCKED + GIVEN_2},
             {87, BALL, -1, 2 + LOCKED},
             {88, BALL, -1, 2 + GIVEN},
             {89, SCREW, 0, 3 + TIP + LOCKED + RUBS},
             {90, CROSS, -1, 1 + TIP + GIVEN_2 + RUBS},
             {91, HINGE, -1, 0 + GIVEN},
             {97, BALL, 1 + TIP, 2 + TIP},
             {98, BALL, -1, 1 + TIP},
             {105, BALL, 1, 2 + TIP},
             {107, BALL, -1, 1 + TIP + RUBS},
             {109, TUBE, 1 + TIP, 2 + TIP}};
/* Springs between points of bodies, TIP: beside the node of the boom's tip; [m] length, 0: without a damper; with an
   actuator, or nothing but that; MET: pulled, between the origins of the second body's joint, which meet at zero coordinates */
enum { IDLE, PULLED, MUSCLE, MET };
static const struct {
  int tree, body[2];
  double length;
  int pull;
} springs[] = {{112, {0, 3}, 3.0, PULLED},
               {67, {1 + TIP, 2 + TIP}, 8.0, IDLE},
               {67, {0, 1 + TIP}, 9.0, IDLE},
               {67, {2, 2 + TIP}, 7.0, IDLE},
               {67, {1 + TIP, 1 + TIP}, 1.0, IDLE},
               {68, {0 + TIP, 2}, 1.5, IDLE},
               {68, {-1, 1 + TIP}, 12.0, IDLE},
               {69, {0 + TIP, -1}, 0.0, IDLE},
               {69, {1 + TIP, 2}, 2.0, IDLE},
               {71, {-1, 0}, 1.0, PULLED},
               {71, {0, 2}, 0.0, MUSCLE},
               {71, {1, 2 + TIP}, 0.0, PULLED},
               {71, {0, 1}, 1.0, IDLE},
               {72, {1, 2}, 6.0, PULLED},
               {72, {0, 2 + TIP}, 0.0, PULLED},
               {73, {0 + TIP, 1 + TIP}, 8.0, IDLE},
               {73, {0 + TIP, 3}, 2.0, PULLED},
               {73, {-1, 2}, 0.0, MUSCLE},
               {73, {2, 3}, 0.0, MET},
               {74, {-1, 0}, 2.0, IDLE},
               {74, {1 + TIP, -1}, 9.0, PULLED},
               {75, {-1, 0 + TIP}, 1.0, IDLE},
               {75, {0, -1}, 0.0, IDLE},
               {75, {-1, 0}, 0.0, PULLED},
               {75, {-1, 0}, 2.0, IDLE},
               {76, {0 + TIP, 1 + TIP}, 2.0, IDLE},
               {76, {2, 0}, 0.0, MUSCLE},
               {76, {3, 1}, 1.0, PULLED},
               {76, {-1, 2 + TIP}, 6.0, IDLE},
               {77, {1 + TIP, 3}, 5.0, IDLE},
               {77, {0 + TIP, -1}, 4.0, PULLED},
               {77, {0, 2}, 1.0, IDLE},
               {78, {0 + TIP, 2 + TIP}, 5.0, PULLED},
               {78, {1, -1}, 0.0, IDLE},
               {99, {0, 1 + TIP}, 9.0, IDLE},
               {106, {1 + TIP, 2 + TIP}, 8.0, IDLE},
               {106, {0, 2 + TIP}, 9.0, IDLE}};
enum { SPRINGS = sizeof springs / sizeof *springs };
enum { LOOPS = sizeof loops / sizeof *loops };
enum { TREES = sizeof trees / sizeof *trees };

static fb_body model[MODELS];
static fb_system_desc desc;
static fb_system mechanism;
static fb_system_work work;
static unsigned char pulls[FB_MAX_SPRINGS]; /* 1: the spring has an actuator */
static int met = -1;                        /* one whose points meet at zero coordinates */
static int falls;                           /* ORBIT: in one */
static double hard = 1; /* factor of the stiffness of joints and modes; SDIRK: far beyond what rk4 resolves */

static double random_number(void)
{
  static unsigned long seed = 4711;
  seed = (1103515245ul * seed + 12345ul) & 0x7ffffffful;
  return (double)seed / 1073741824.0 - 1.0;
}

static int need(fb_status status, const char *what)
{
  if (status != FB_OK) {
    fprintf(stderr, "%s: %s\n", what, fb_status_string(status));
    exit(1);
  }
  return 1;
}

/* Gravity of a body: that of its tree. */
static void build_gravity(fb_body_desc *level, int gravity, int rigid)
{
  const int mixed = gravity & MIXED && rigid, center = gravity & CENTER && !mixed, uniform = gravity & UNIFORM || mixed;
  level->effects |= uniform ? FB_EFFECT_GRAVITY : 0u;
  level->gravity[1] = uniform ? FB_R(0.5) : FB_R(0.0);
  level->gravity[2] = uniform ? FB_R(-2.0) : FB_R(0.0);
  level->mu =
      center ? hard > 1 ? FB_R(60.0) : FB_R(400.0) : FB_R(0.0); /* which is not met in the longer steps of SDIRK */
  level->center[0] = gravity & APART && rigid ? FB_R(25.0) : FB_R(-30.0);
  level->center[1] = FB_R(20.0);
  level->center[2] = FB_R(25.0);
  if (gravity & ORBIT) {
    level->mu = FB_R(3.986004418e14);
    level->center[0] = FB_R(-7e6);
  }
  if (!center) {
    memset(level->center, 0, sizeof level->center);
  }
}

/* Rotors inside a body: two on the frame, one at its tip if it has one, else one of given momentum; friction, which brakes
   that many times as much. */
static void build_rotors(fb_body_desc *level, int tip, double brake)
{
  level->n_rotor = tip > 0 ? 3 : 2;
  for (int r = 0; r < level->n_rotor; r++) {
    fb_rotor *const rotor = &level->rotor[r];
    rotor->node = r == 2 ? tip : 0;
    rotor->axis[0] = (fb_real)random_number();
    rotor->axis[1] = FB_R(1.0);
    rotor->axis[2] = (fb_real)random_number();
    rotor->inertia = FB_R(0.1);
    rotor->damping = (fb_real)(0.002 * brake);
    rotor->friction = r == 0 ? FB_R(0.0) : (fb_real)(0.01 * brake);
    rotor->friction_speed = FB_R(2.0);
    rotor->given = tip == 0 && r == 1;
  }
}

/* A rigid body with a beam of that many modes on it, 0: none; with rotors if their friction is not 0. */
static void build_model(fb_body *body, unsigned effects, int gravity, int modes, int plain, double rotors)
{
  static fb_shape shape;
  static fb_body_work body_work;
  static fb_beam_desc boom;
  static fb_beam beam;
  static fb_modes basis;
  static fb_modes_work modes_work;
  static fb_modes_desc keep;
  static fb_body_desc level;
  fb_real center[3], inertia[6] = {9, 11, 14, 0, 0, 0};
  int tip = 0;
  for (int i = 0; i < 3; i++) {
    center[i] = plain ? (i == 0 ? FB_R(0.5) : FB_R(0.0)) : (fb_real)(0.3 * random_number());
    inertia[i] = plain ? (i == 0 ? FB_R(4.0) : FB_R(9.0)) : inertia[i] + (fb_real)random_number();
    inertia[3 + i] = plain ? FB_R(0.0) : (fb_real)random_number();
  }
  memset(&level, 0, sizeof level);
  level.effects = modes > 0 ? effects : FB_EFFECTS_RIGID;
  level.base = FB_BASE_PRESCRIBED;
  build_gravity(&level, gravity, modes == 0);
  memset(&keep, 0, sizeof keep);
  for (int a = 0; a < modes; a++) {
    level.zeta[a] = effects & FB_EFFECT_DAMPING ? FB_R(0.02) : FB_R(0.0);
  }
  if (modes > 0) {
    memset(&boom, 0, sizeof boom);
    boom.length = (fb_real)(6 + modes); /* 10 m with 4 modes */
    boom.n_element = 6;
    boom.n_station = 1;
    boom.station[0].mass = 1;
    boom.station[0].EI_y = (fb_real)(5000 * hard);
    boom.station[0].EI_z = (fb_real)(8000 * hard);
    boom.position[0] = plain ? FB_R(0.0) : FB_R(0.5);
    keep.count[FB_KIND_BEND_Y] = (modes + 1) / 2;
    keep.count[FB_KIND_BEND_Z] = modes / 2;
    keep.line_points = effects & FB_EFFECT_LARGE_DEFLECTION ? 6 : 0;
    need(fb_beam_init(&beam, &boom), "beam");
    need(fb_modes_solve(&basis, &modes_work, &beam, &keep), "modes");
  }
  need(fb_shape_init(&shape, modes), "shape");
  need(fb_shape_add_rigid(&shape, FB_R(20.0), center, inertia), "rigid body");
  if (modes > 0) {
    need(fb_shape_add_beam(&shape, 0, &beam, &basis), "boom");
  }
  if (modes > 0) {
    const fb_real at = effects & FB_EFFECT_LARGE_DEFLECTION && modes == 6 ? FB_R(0.83) : FB_R(1.0); /* between points */
    need(fb_shape_add_beam_node(&shape, &tip, 0, &beam, &basis, at * boom.length), "tip");
  } else {
    const fb_real ahead[3] = {FB_R(0.7), FB_R(-0.4), FB_R(0.2)}, still[3] = {0, 0, 0};
    need(fb_shape_add_node(&shape, &tip, ahead, still, still), "node");
  }
  if (rotors > 0) {
    build_rotors(&level, modes > 0 ? tip : 0, rotors);
  }
  need(fb_body_init(body, &body_work, &shape, &level), "body");
  if (modes == 2 && hard > 1) { /* as modes of a part that are not orthogonal */
    body->K.term[body->K.n_term].a = 0;
    body->K.term[body->K.n_term].b = 1;
    body->K.term[body->K.n_term++].c = FB_R(0.3) * body->K.diagonal[0];
  }
}

/* The second body of a plain tree a meter ahead, the third one behind, turned by half a turn. */
static void build_plain_joint(fb_joint_desc *joint, int k)
{
  const fb_real turn[3] = {0, 0, k == 2 ? FB_R(3.14159265358979324) : FB_R(0.0)};
  joint->position[0] = k == 0 ? FB_R(0.0) : k == 1 ? FB_R(1.0) : -FB_R(1.0);
  fb_quat_from_rotvec(joint->attitude, turn);
}

/* Friction, and stops within the reach of motion, of every axis of a joint. */
static void build_rubbing(fb_joint_desc *joint)
{
  const int axes = joint->kind == FB_JOINT_UNIVERSAL || joint->kind == FB_JOINT_CYLINDRICAL ? 2 : 1;
  for (int i = 0; i < axes; i++) {
    joint->friction[i] = FB_R(0.5);
    joint->friction_speed[i] = FB_R(0.1);
    joint->stop[i][0] = FB_R(-0.1);
    joint->stop[i][1] = FB_R(0.2);
    joint->stop_stiffness[i] = FB_R(400.0);
    joint->stop_loss[i] = i == 0 ? FB_R(0.5) : FB_R(0.0);
  }
}

static void build_joint(fb_joint_desc *joint, const hang *link, int turned)
{
  const int random = turned == 1;
  fb_real turn[3], child[3];
  for (int i = 0; i < 3; i++) {
    joint->position[i] = (fb_real)random_number();
    joint->child_position[i] = random ? (fb_real)(0.3 * random_number()) : FB_R(0.0);
    turn[i] = (fb_real)(random ? random_number() : i == 0 && turned < PLANE ? 1.5707963267948966 : 0.0);
    child[i] = (fb_real)(random ? random_number() : 0.0);
  }
  if (link->joint == ROOT) {
    memset(joint->position, 0, sizeof joint->position);
    memset(joint->child_position, 0, sizeof joint->child_position);
    return;
  }
  fb_quat_from_rotvec(joint->attitude, turn);
  fb_quat_from_rotvec(joint->child_attitude, child);
  joint->pitch = link->joint == SCREW ? FB_R(0.2) : FB_R(0.0);
  for (int i = 0; i < 3 && link->joint != WELD && random; i++) {
    joint->stiffness[i] = (fb_real)(20 * hard);
    joint->damping[i] = FB_R(0.5);
    joint->rest[i] = link->joint == BALL ? FB_R(0.0) : (fb_real)(0.1 / sqrt(hard));
  }
}

static void build_modes(fb_joint_desc *joint, int flags)
{
  joint->mode[0] = flags & GIVEN ? FB_AXIS_PRESCRIBED : flags & LOCKED ? FB_AXIS_LOCKED : FB_AXIS_FREE;
  joint->mode[1] = flags & GIVEN_2 ? FB_AXIS_PRESCRIBED : flags & LOCKED_2 ? FB_AXIS_LOCKED : FB_AXIS_FREE;
}

/* A loop by joint frames that coincide at zero coordinates of the tree, which is built without it. */
static void build_loop(int which, int l)
{
  static fb_system_motion motion;
  static fb_system_state zero;
  fb_joint_desc *const loop = &desc.loop[desc.n_loop];
  const int parent = loops[l].parent, child = loops[l].child % GIVEN;
  const int on = parent >= TIP ? parent - TIP : parent, of = child % TIP;
  fb_real turn[3], back[4], x[3], R[9];
  hang at = {loops[l].joint, on, 0};
  need(fb_system_state_init(&mechanism, model, &zero, &work, NULL, NULL), "state at zero");
  need(fb_system_motion_eval(&mechanism, model, &work, &motion, &zero, NULL), "poses at zero");
  build_joint(loop, &at, 0);
  build_modes(loop, loops[l].child);
  loop->kind = (fb_joint_kind)at.joint;
  loop->parent = on;
  loop->child = of;
  loop->parent_node = parent >= TIP;
  loop->child_node = child >= TIP;
  loop->pitch = at.joint == SCREW ? FB_R(0.3) : FB_R(0.0);
  for (int i = 0; i < 3 && (loops[l].child & RUBS); i++) {
    loop->stiffness[i] = FB_R(10.0);
    loop->damping[i] = which == 54 && hard > 1 ? FB_R(40.0) : FB_R(0.4); /* which bounds steps of SDIRK */
  }
  if ((loops[l].child & RUBS) && at.joint != BALL) {
    loop->rest[0] = FB_R(0.05);
    build_rubbing(loop);
  }
  for (int i = 0; i < 3; i++) {
    loop->position[i] = trees[which].turned == DOOR ? desc.joint[0].position[i] : loop->position[i];
    turn[i] = trees[which].turned == 1 ? (fb_real)random_number() : FB_R(0.0);
    x[i] = loop->position[i] + (loop->parent_node ? model[desc.model[on]].node[1].r[i] : FB_R(0.0));
  }
  fb_quat_from_rotvec(loop->attitude, turn);
  if (on >= 0) { /* to the ground */
    fb_real y[3];
    fb_quat_to_mat33(R, motion.pose[on].quat);
    fb_mat33_mul_vec3(y, R, x);
    for (int i = 0; i < 3; i++) {
      x[i] = y[i] + motion.pose[on].rho[i];
    }
    fb_quat_mul(back, motion.pose[on].quat, loop->attitude);
  } else {
    memcpy(back, loop->attitude, sizeof back);
  }
  fb_quat_to_mat33(R, motion.pose[of].quat);
  for (int i = 0; i < 3; i++) {
    turn[i] = x[i] - motion.pose[of].rho[i];
  }
  fb_mat33_mulT_vec3(loop->child_position, R, turn);
  for (int i = 0; i < 3; i++) {
    loop->child_position[i] -= loop->child_node ? model[desc.model[of]].node[1].r[i] : FB_R(0.0);
    x[i] = -motion.pose[of].quat[1 + i];
  }
  {
    const fb_real inverse[4] = {motion.pose[of].quat[0], x[0], x[1], x[2]};
    fb_quat_mul(loop->child_attitude, inverse, back);
  }
  desc.n_loop++;
}

/* A wheel about its z axis, which is that of its hinge. */
static void build_wheel(fb_body *body, int gravity)
{
  static fb_shape shape;
  static fb_body_work body_work;
  static fb_body_desc level;
  const fb_real center[3] = {0, 0, 0}, inertia[6] = {FB_R(0.3), FB_R(0.3), FB_R(0.5), 0, 0, 0};
  memset(&level, 0, sizeof level);
  level.effects = FB_EFFECTS_RIGID;
  level.base = FB_BASE_PRESCRIBED;
  build_gravity(&level, gravity, 1);
  need(fb_shape_init(&shape, 0), "shape");
  need(fb_shape_add_rigid(&shape, FB_R(3.0), center, inertia), "wheel");
  need(fb_body_init(body, &body_work, &shape, &level), "wheel");
}

static int is_wheel(int k)
{
  return desc.model[k] == WHEEL;
}

static void build_spring(int j)
{
  fb_spring *const spring = &desc.spring[desc.n_spring++];
  for (int side = 0; side < 2; side++) {
    const int on = springs[j].body[side];
    spring->body[side] = on >= TIP ? on - TIP : on;
    spring->node[side] = on >= TIP;
    for (int i = 0; i < 3; i++) {
      spring->position[side][i] = (fb_real)random_number();
    }
  }
  if (springs[j].pull == MET) {
    memcpy(spring->position[0], desc.joint[spring->body[1]].position, sizeof spring->position[0]);
    memcpy(spring->position[1], desc.joint[spring->body[1]].child_position, sizeof spring->position[1]);
    met = desc.n_spring - 1;
  }
  spring->stiffness = springs[j].pull == MUSCLE           ? FB_R(0.0)
                      : hard > 1 && springs[j].tree == 68 ? FB_R(1500.0)
                                                          : FB_R(3.0);
  spring->length = (fb_real)springs[j].length;
  spring->damping = springs[j].length > 0 ? FB_R(0.7) : FB_R(0.0);
  if (hard > 1 && springs[j].tree == 71 && springs[j].length > 0) {
    spring->damping = FB_R(600.0); /* which bounds steps of SDIRK, as the stiffness of that of 68 does */
  }
}

/* Springs of a tree, and which of them are pulled. */
static void build_springs(int which)
{
  for (int j = 0; j < SPRINGS; j++) {
    if (springs[j].tree == which) {
      pulls[desc.n_spring] = springs[j].pull != IDLE;
      build_spring(j);
    }
  }
}

static void build(int which)
{
  falls = trees[which].gravity & ORBIT;
  build_model(&model[RIGID], 0, trees[which].gravity, 0, which < 2, 0);
  build_model(&model[BOOM], trees[which].effects, trees[which].gravity, 4, which < 2, 0);
  build_model(&model[PANEL], trees[which].effects, trees[which].gravity, 2, which < 2, 0);
  build_wheel(&model[WHEEL], trees[which].gravity);
  if (which >= 43) {
    const double brake = which == 45 ? hard : 1; /* which bounds shorter steps unless longer ones are allowed */
    build_model(&model[HUB], 0, trees[which].gravity, 0, 0, brake);
    build_model(&model[MAST], trees[which].effects, trees[which].gravity, 4, 0, brake);
  }
  if (which >= LINES && which < LINED) {
    build_model(&model[BENT], trees[which].effects | FB_EFFECTS_LARGE, trees[which].gravity, 6, which == LINES, 0);
    build_model(&model[VANE], trees[which].effects | FB_EFFECTS_LARGE, trees[which].gravity, 2, 0, 0);
  }
  memset(&desc, 0, sizeof desc);
  desc.allow_long_step = hard > 1 && (which == 16 || which == 45);
  for (int k = 0; k < 5 && !(trees[which].link[k].joint == ROOT && trees[which].link[k].parent == 0); k++) {
    const int flags = trees[which].link[k].model;
    desc.model[desc.n_body] = flags % GIVEN;
    desc.joint[k].kind = (fb_joint_kind)trees[which].link[k].joint;
    desc.joint[k].parent = trees[which].link[k].parent % TIP;
    desc.joint[k].parent_node = trees[which].link[k].parent >= TIP;
    build_modes(&desc.joint[k], flags);
    if (which < 2) {
      build_plain_joint(&desc.joint[desc.n_body++], k);
    } else {
      build_joint(&desc.joint[k], &trees[which].link[k], trees[which].turned);
      if (flags & RUBS) {
        build_rubbing(&desc.joint[k]);
      }
      desc.n_body++;
    }
  }
  need(fb_system_init(&mechanism, &work, model, &desc, MODELS), "system");
  for (int l = 0; l < LOOPS; l++) {
    if (loops[l].tree == which) {
      build_loop(which, l);
    }
  }
  build_springs(which);
  need(fb_system_init(&mechanism, &work, model, &desc, MODELS), "system with its loops");
}

/* Axes of a joint of that mode, a free root has none. */
static int count(int k, fb_axis_mode mode)
{
  const fb_joint *const joint = &mechanism.joint[k];
  int n = 0;
  for (int i = 0; i < joint->n_axis && joint->kind != FB_JOINT_FREE; i++) {
    n += joint->mode[i] == mode;
  }
  return n;
}

/* Has axis i of joint k a value that is prescribed? */
static inline int is_valued(int k, int i)
{
  const fb_joint *const joint = &mechanism.joint[k];
  return i < joint->n_axis && joint->kind != FB_JOINT_SPHERICAL && joint->mode[i] == FB_AXIS_PRESCRIBED;
}

#ifdef WRITE
/* A line WORD(k, ..) of them, if there is one. */
static void write_member(int is, const char *word, int k, const char *rest)
{
  if (is) {
    printf("%s(%d%s)\n", word, k, rest);
  }
}

/* The step, from where all is zero. */
static int write_step(const tree_choice *choice, const char *const *names)
{
  static fb_system_state start_;
  const trace_choice what = {.name = choice->name,
                             .file = "a random tree",
                             .single = choice->single,
                             .loads = choice->loads,
                             .body = names,
                             .pulls = pulls,
                             .implicit = choice->implicit};
  const trace_model of = {model, &mechanism, &start_, sizeof model[0], sizeof mechanism, sizeof start_, MODELS};
  char text[400];
  int bad;
  need(fb_system_state_init(&mechanism, model, &start_, &work, NULL, NULL), "start");
  {
    const code w = tree_begin(stdout, &mechanism, model, names, choice);
    tree_write_head(&w, "a random tree", fb_system_crc(&mechanism, model, MODELS));
    bad = code_write_steps(&w, what, &of, choice->lanes, tree_write_types, text);
  }
  if (bad) {
    fprintf(stderr, "%s\n", text);
  }
  return bad;
}

/* Members of the state and the input, for the program that steps the tree; acts: with loads at nodes. */
static void write_members(int acts)
{
  int motors = 0;
  printf("#ifndef PART\n#define PART(k, member, i, kind)\n#endif\n#ifndef RATE\n#define RATE(k)\n#endif\n"
         "#ifndef STEER\n#define STEER(j, member)\n#endif\n#ifndef HOLD\n#define HOLD(j, member)\n#endif\n");
  for (int j = 0; j < desc.n_loop; j++) {
    const int k = desc.n_body + j, ball = mechanism.joint[k].kind == FB_JOINT_SPHERICAL;
    write_member(count(k, FB_AXIS_PRESCRIBED) > 0 && !ball, "STEER", j, ", value");
    write_member(count(k, FB_AXIS_PRESCRIBED) > 0, "STEER", j, ", rate");
    write_member(count(k, FB_AXIS_LOCKED) > 0, "HOLD", j, ball ? ", hold_quat" : ", hold");
  }
  for (int k = 0; k < desc.n_body; k++) {
    const fb_joint *const joint = &mechanism.joint[k];
    const int root = joint->kind == FB_JOINT_FREE, n = model[desc.model[k]].n;
    const int turns = root || joint->kind == FB_JOINT_SPHERICAL, axes = root ? 0 : joint->n_axis;
    const int given = count(k, FB_AXIS_PRESCRIBED), is_free = root || count(k, FB_AXIS_FREE) > 0;
    motors |= (is_free && !root) || model[desc.model[k]].n_rotor > 0;
    write_member(1, "LOAD", k, "");
    write_member(root, "MEMBER", k, ", x, PLACE");
    write_member(root, "MEMBER", k, ", lost_x, LOST");
    write_member(root && mechanism.tied < 2, "MEMBER", k, ", u, FRAME");
    write_member(root && mechanism.tied < 2, "MEMBER", k, ", lost_u, LOST");
    write_member(is_free && !root, "MOTOR", k, "");
    write_member(given > 0, "RATE", k, "");
    write_member(given > 0 && !turns, "DRIVE", k, "");
    write_member(turns, "MEMBER", k, ", quat, ATTITUDE");
    write_member(axes > 0 && !turns, "MEMBER", k, given > 0 ? ", x, VALUE" : ", x, PLACE");
    write_member(root, "MEMBER", k, ", p, MOMENTUM");
    for (int i = 0; i < axes; i++) {
      char place[24];
      snprintf(place, sizeof place, ", p, %d, MOMENTUM", i);
      write_member(joint->mode[i] == FB_AXIS_FREE, "PART", k, place);
    }
    write_member(model[desc.model[k]].n_rotor > 0, "ROTORS", k, "");
    write_member(n > 0, "MEMBER", k, ", q, MODE");
    write_member(n > 0, "MEMBER", k, ", pi, MODE_MOMENTUM");
  }
  printf("#ifdef PULL\n");
  for (int j = 0; j < desc.n_spring; j++) {
    write_member(pulls[j], "PULL", j, "");
    motors |= pulls[j];
  }
  printf("#endif\n#ifdef WORK\n%s#endif\n", motors ? "WORK\n" : "");
  printf("#ifdef ACT\n");
  for (int k = 0; k < desc.n_body; k++) {
    write_member(acts && !is_wheel(k), "ACT", k, ""); /* which has no node but its origin */
  }
  printf("#endif\n#ifdef SEEN\n");
  for (int k = 0; k < desc.n_body; k++) {
    const fb_joint *const joint = &mechanism.joint[k];
    const int turns = joint->kind == FB_JOINT_FREE || joint->kind == FB_JOINT_SPHERICAL;
    printf("SEEN(%d, position, pose[%d].rho)\nSEEN(%d, v, motion[%d].v)\nSEEN(%d, w, motion[%d].w)\nTURNED(%d)\n", k, k,
           k, k, k, k, k);
    if (joint->n_axis > 0 && !turns) {
      printf("SEEN(%d, speed, joint[%d].speed)\n", k, k);
    }
    if (model[desc.model[k]].n > 0) {
      printf("SEEN(%d, q_dot, motion[%d].q_dot)\n", k, k);
    }
    if (model[desc.model[k]].n_rotor > 0) {
      printf("SEEN(%d, rotor_speed, motion[%d].rotor_speed)\n", k, k);
    }
  }
  printf("#endif\n#undef PART\n#undef RATE\n#undef STEER\n#undef HOLD\n");
}

int main(int argc, char **argv)
{
  static const char *const names[5] = {"first", "second", "third", "fourth", "fifth"};
  const int which = argc > 1 ? atoi(argv[1]) : 0;
  tree_choice choice = {.name = "generated"};
  int acts = 0;
  if (which >= TREES) {
    return 3;
  }
  for (int k = 2; k < argc; k++) {
    choice.implicit |= strcmp(argv[k], "--sdirk") == 0;
    acts |= strcmp(argv[k], "--loads") == 0;
  }
  hard = choice.implicit ? HARD : 1;
  build(which);
  if (argc > 2 && strcmp(argv[2], "--members") == 0) {
    write_members(acts);
    return 0;
  }
  for (int k = 2; k < argc; k++) {
    choice.single |= strcmp(argv[k], "--single") == 0;
    choice.lanes |= strcmp(argv[k], "--lanes") == 0;
  }
  for (int k = 0; k < desc.n_body; k++) { /* at the tip, of a rigid body at another place */
    if (acts && !is_wheel(k)) {
      node_put(&choice.loads[k], 1);
    }
  }
  memcpy(choice.pulls, pulls, sizeof pulls);
  return write_step(&choice, names);
}
#else
/* ---- the generated state and that of the library, member by member */

#define TOLERANCE (FB_SINGLE ? 2e-3 : 1e-11)

typedef struct pair {
  fb_real *own, *theirs;
  int n, kind;
} pair;

enum {
  PLACE,
  ATTITUDE,
  MOMENTUM,
  MODE,
  MODE_MOMENTUM,
  VALUE,
  FRAME,
  ANGLE,
  SPUN,
  WORKED,
  LOST,
  KINDS
}; /* ANGLE, SPUN: of rotors */

static fb_system_state state;
static generated_state own;
static pair piece[40];
static int n_piece;
static double difference[KINDS], extreme[KINDS];

static void add(fb_real *mine, fb_real *theirs, size_t bytes, int kind)
{
  piece[n_piece].own = mine;
  piece[n_piece].theirs = theirs;
  piece[n_piece].n = (int)(bytes / sizeof *mine);
  piece[n_piece++].kind = kind;
}

/* The generated state becomes that of the library, or (back) the reverse. */
static void take_state(int back)
{
  for (int k = 0; k < n_piece; k++) {
    memcpy(back ? piece[k].theirs : piece[k].own, back ? piece[k].own : piece[k].theirs,
           (size_t)piece[k].n * sizeof(fb_real));
  }
}

static void compare(void)
{
  for (int k = 0; k < n_piece; k++) {
    const pair *const p = &piece[k];
    for (int i = 0; i < p->n; i++) {
      const double apart = (double)p->own[i] - (double)p->theirs[i];
      difference[p->kind] =
          fmax(difference[p->kind], fabs(p->kind == ANGLE ? atan2(sin(apart), cos(apart)) : apart)); /* of a turn */
      extreme[p->kind] = fmax(extreme[p->kind], fabs((double)p->theirs[i]));
    }
  }
}

static void start(double speed)
{
  static fb_link_motion motion[FB_MAX_BODIES];
  const double near = (desc.n_loop > 0 ? 0.1 : 1) / sqrt(hard); /* where loops are closed; with as much energy */
  memset(motion, 0, sizeof motion);
  memset(&state, 0, sizeof state);
  for (int k = 0; k < desc.n_body; k++) {
    const fb_body *const body = &model[desc.model[k]];
    fb_real turn[3];
    for (int i = 0; i < 3; i++) {
      turn[i] = (fb_real)(near * random_number());
      motion[k].value[i] = (fb_real)(0.5 * near * random_number());
    }
    fb_quat_from_rotvec(motion[k].quat, turn);
    for (int i = 0; i < 6; i++) {
      motion[k].speed[i] = (fb_real)(speed * random_number());
    }
    for (int r = 0; r < body->n_rotor; r++) {
      motion[k].rotor_speed[r] = (fb_real)(200 * speed * random_number());
      motion[k].rotor_angle[r] = (fb_real)random_number();
    }
    for (int a = 0; a < body->n; a++) {
      const double most = body->reach[a] > FB_R(0.0) ? (double)body->deflection_limit / (double)body->reach[a] : 100.0;
      motion[k].q[a] = (fb_real)(0.05 / sqrt(hard) * most / body->n * random_number());
      motion[k].q_dot[a] = (fb_real)(0.2 / sqrt(hard) * random_number());
    }
  }
  need(fb_system_state_init(&mechanism, model, &state, &work, motion, NULL), "state");
  for (int k = 0; k < desc.n_body; k++) {
    for (int i = 0; i < 3 && mechanism.joint[k].kind == FB_JOINT_FREE && mechanism.tied < 2; i++) {
      state.link[k].u[i] += (fb_real)(0.1 * (i - 1.5)); /* the whole drifts: as of another observer */
      state.link[k].u[i] += falls == ORBIT && i == 1 ? FB_R(7546.05) : FB_R(0.0);
    }
  }
  generated_start(&own);
  take_state(0);
}

/* The load on that node of body k. */
static const fb_load *load_on(const fb_system_input *in, int k, int node)
{
  static const fb_load none;
  for (int i = 0; i < in->n_load; i++) {
    if (in->load[i].body == k && in->load[i].load.node == node) {
      return &in->load[i].load;
    }
  }
  return &none;
}

static inline void take_motors(fb_real *mine, const fb_rotor_input *in, int n)
{
  for (int r = 0; r < n; r++) {
    mine[r] = in[r].torque + in[r].momentum; /* one of them is zero */
  }
}

/* What drives the library becomes what drives the step. */
static void give(generated_input *mine, const fb_system_input *in)
{
#define MEMBER(k, member, kind)
#define LOAD(k)                                                                \
  memcpy(mine->body_##k.force, load_on(in, k, 0)->force, 3 * sizeof(fb_real)); \
  memcpy(mine->body_##k.torque, load_on(in, k, 0)->torque, 3 * sizeof(fb_real));
#define MOTOR(k) memcpy(mine->body_##k.motor, in->drive[k].torque, sizeof mine->body_##k.motor);
#define ROTORS(k) take_motors(mine->body_##k.rotor_motor, in->rotor[k], model[desc.model[k]].n_rotor);
#define DRIVE(k) memcpy(mine->body_##k.value, in->drive[k].value, sizeof mine->body_##k.value);
#define RATE(k) memcpy(mine->body_##k.rate, in->drive[k].rate, sizeof mine->body_##k.rate);
#define STEER(j, member) memcpy(mine->loop_##j.member, in->drive[desc.n_body + j].member, sizeof mine->loop_##j.member);
#define PULL(j) mine->pull_##j = in->pull[j];
#define ACT(k)                                                                   \
  memcpy(mine->body_##k.force_1, load_on(in, k, 1)->force, 3 * sizeof(fb_real)); \
  memcpy(mine->body_##k.torque_1, load_on(in, k, 1)->torque, 3 * sizeof(fb_real));
#include "members.h"
#undef PULL
#undef ACT
#undef MEMBER
#undef LOAD
#undef MOTOR
#undef DRIVE
#undef ROTORS
}

/* A load at the node of body k. */
static inline void act(fb_system_load *on, int k, double t)
{
  on->body = k;
  on->load.node = 1;
  on->load.axes = FB_AXES_BODY;
  for (int i = 0; i < 3; i++) {
    on->load.force[i] = (fb_real)(0.5 * sin(9 * t + 2 * i + k));
    on->load.torque[i] = (fb_real)(0.5 * cos(7 * t + i + 2 * k));
  }
}

/* What is prescribed of joints and loops. */
static void drive(fb_system_input *in, double t)
{
  for (int k = 0; k < desc.n_body + desc.n_loop; k++) {
    for (int i = 0; i < 3 && count(k, FB_AXIS_PRESCRIBED) > 0; i++) {
      const double by = (desc.n_loop > 0 ? 0.1 : 1) * (1 - 0.4 * i); /* that a crank turns */
      if (mechanism.joint[k].mode[i] == FB_AXIS_PRESCRIBED) {
        in->drive[k].value[i] = (fb_real)(by * (0.3 * t + 0.1 * sin(2 * t)));
        in->drive[k].rate[i] = (fb_real)(by * (0.3 + 0.2 * cos(2 * t)));
        in->drive[k].acceleration[i] = (fb_real)(-0.4 * by * sin(2 * t));
      }
    }
  }
}

static void load(fb_system_input *in, generated_input *mine, double t)
{
  memset(in, 0, sizeof *in);
  memset(mine, 0, sizeof *mine);
  for (int k = 0; k < desc.n_body; k++) {
    fb_load *const act = &in->load[in->n_load].load;
    const double by = is_wheel(k) ? 0.01 : 2.0; /* its spin would bound the step */
    in->load[in->n_load++].body = k;
    act->axes = FB_AXES_BODY;
    for (int r = 0; r < model[desc.model[k]].n_rotor; r++) {
      const fb_real motor = (fb_real)(0.5 * sin(2 * t + r + k));
      const int given = model[desc.model[k]].rotor[r].given;
      in->rotor[k][r].torque = given ? FB_R(0.0) : motor;
      in->rotor[k][r].momentum = given ? motor : FB_R(0.0);
    }
    for (int i = 0; i < 3; i++) {
      act->force[i] = (fb_real)(by * sin(t + i + 2 * k));
      act->torque[i] = (fb_real)(by * cos(2 * t + i + k));
      in->drive[k].torque[i] = mechanism.joint[k].mode[i] == FB_AXIS_FREE && mechanism.joint[k].kind != FB_JOINT_FREE &&
                                       i < mechanism.joint[k].n_axis
                                   ? (fb_real)(by * sin(3 * t + i - k))
                                   : FB_R(0.0);
    }
  }
  drive(in, t);
  for (int j = 0; j < desc.n_spring; j++) {
    in->pull[j] = pulls[j] ? (fb_real)(2 * sin(2 * t + 3 * j + 1)) : FB_R(0.0);
  }
#define ACT(k) act(&in->load[in->n_load++], k, t);
#define MEMBER(k, member, kind)
#define LOAD(k)
#define MOTOR(k)
#define DRIVE(k)
#define ROTORS(k)
#include "members.h"
#undef ACT
#undef MEMBER
#undef LOAD
#undef MOTOR
#undef DRIVE
#undef ROTORS
  give(mine, in);
}

static double energy(void)
{
  static fb_energy e;
  need(fb_system_energy_eval(&mechanism, model, &work, &e, &state, NULL), "energy");
  return (double)(e.kinetic + e.strain + e.gravity);
}

/* A step of both under what acts at its start, middle and end (NULL: nothing). */
static fb_status step(fb_system_state *x, const fb_system_input *in, fb_real dt)
{
#ifdef SDIRK
  return fb_system_sdirk_step(&mechanism, model, x, &work, in, in ? in + 2 : NULL, dt, generated_ITERATIONS);
#else
  return fb_system_rk4_step(&mechanism, model, x, &work, in, in ? in + 1 : NULL, in ? in + 2 : NULL, dt);
#endif
}

static generated_status own_step(const generated_input *mine, fb_real dt)
{
#ifdef SDIRK
  return generated_step(&own, mine, mine ? mine + 2 : NULL, dt);
#else
  return generated_step(&own, mine, mine ? mine + 1 : NULL, mine ? mine + 2 : NULL, dt);
#endif
}

/* Steps of both under one input, which is that of the start and of the end. */
static fb_status held_step(fb_system_state *x, const fb_system_input *in, fb_real dt)
{
#ifdef SDIRK
  return fb_system_sdirk_step(&mechanism, model, x, &work, in, in, dt, generated_ITERATIONS);
#else
  return fb_system_rk4_step(&mechanism, model, x, &work, in, in, in, dt);
#endif
}

static generated_status own_held_step(const generated_input *mine, fb_real dt)
{
#ifdef SDIRK
  return generated_step(&own, mine, mine, dt);
#else
  return generated_step(&own, mine, mine, mine, dt);
#endif
}

/* 1000 steps of both. */
static double fly(int loaded)
{
  static fb_system_input in[3];
  static generated_input mine[3];
  const fb_real limit = FB_R(0.15) * fb_system_rk4_limit(&mechanism, model, FB_R(1.0), FB_R(1.0));
#ifdef SDIRK
  const fb_real usual = FB_R(0.02);
  fb_real dt = usual;
#else
  const fb_real dt = limit < FB_R(0.01) ? limit : FB_R(0.01);
#endif
  double worst = 0, before = energy(), theirs, e;
  double t = 0;
  int refused = 0;
  memset(difference, 0, sizeof difference);
  memset(extreme, 0, sizeof extreme);
  for (int k = 0; k < 1000; k++) {
    fb_status status;
    generated_status same;
    for (int i = 0; i < 3; i++) {
      load(&in[i], &mine[i], t + 0.5 * i * (double)dt);
    }
    status = step(&state, loaded ? in : NULL, dt);
    same = own_step(loaded ? mine : NULL, dt);
#ifdef SDIRK
    if (status == FB_ERR_CONVERGENCE && (int)same == (int)status && refused++ < 200) {
      dt *= FB_R(0.7);
      continue;
    }
#endif
    if (status != FB_OK || (int)same != (int)status) {
      printf("step %d: status %d, generated %d\n", k, (int)status, (int)same);
      return 1;
    }
    compare();
    t += (double)dt;
#ifdef SDIRK
    dt = usual;
#endif
  }
  for (int kind = 0; kind < LOST; kind++) {
    const double relative = difference[kind] / (extreme[kind] > 0 ? extreme[kind] : 1);
    worst = fmax(worst, relative);
    printf(" %.1e", relative);
  }
  theirs = energy();
  take_state(1);
  e = energy();
  printf(" | %d refused, dt %.2g of the limit of rk4 | energy %.6g %.1e %.1e\n", refused,
         (double)(FB_R(0.15) * dt / limit), before, theirs / before - 1, e / before - 1);
  return worst;
}

/* One step of both, which both refuse with that status (FB_OK: with any) and leave the state as it was. */
static int refused(const fb_system_input *in, const generated_input *mine, fb_real dt, fb_status expected,
                   const char *what)
{
  const generated_state before = own;
  fb_system_state copy = state;
  const fb_status status = held_step(&copy, in, dt);
  const generated_status same = own_held_step(mine, dt);
  const int good = status != FB_OK && same != generated_ok && (expected == FB_OK || (int)same == (int)expected) &&
                   memcmp(&before, &own, sizeof own) == 0;
  if (!good) {
    printf("%s: library %d, generated %d, expected %d\n", what, (int)status, (int)same, (int)expected);
  }
  own = before;
  return good;
}

/* A step that both take or both refuse, from the state of the library. */
static int alike(const fb_system_input *in, const generated_input *mine, fb_real dt, const char *what)
{
  fb_system_state copy = state;
  fb_status status;
  generated_status same;
  take_state(0);
  status = held_step(&copy, in, dt);
  same = own_held_step(mine, dt);
  take_state(0);
  if ((status == FB_OK) != (same == generated_ok)) {
    printf("%s: library %d, generated %d\n", what, (int)status, (int)same);
    return 0;
  }
  return 1;
}

/* Has a body lines of large deflection? */
static int lined(void)
{
  int any = 0;
  for (int k = 0; k < desc.n_body; k++) {
    any |= (model[desc.model[k]].effects & FB_EFFECT_LARGE_DEFLECTION) != 0;
  }
  return any;
}

/* On both sides of the step limit under what acts. */
static int bounded(const fb_system_input *in, const generated_input *mine)
{
  const double off = FB_SINGLE ? 1e-2 : 1e-6;
  fb_system_limit now;
  need(fb_system_limit_eval(&mechanism, model, &work, &now, &state, in), "limit");
#ifdef SDIRK
  now.rk4 = now.sdirk;
#endif
  return alike(in, mine, (fb_real)((1 - off) * (double)now.rk4), "below the limit") &
         alike(in, mine, (fb_real)((1 + off) * (double)now.rk4), "beyond the limit");
}

/* The step limit of a motion, also with actuators, and the limit of rotation in a step. */
static int limits(void)
{
  static fb_system_input in;
  static generated_input mine;
  const fb_real dt = FB_R(1e-4);
  int good = 1;
  for (int n = 0; n < (lined() ? 12 : 1); n++) { /* of lines the deflection counts */
    start(0.5);
    good &= bounded(NULL, NULL);
  }
  memset(&in, 0, sizeof in);
  for (int j = 0; j < desc.n_spring; j++) {
    in.pull[j] = pulls[j] && j != met ? FB_R(30.0) : FB_R(0.0);
  }
  give(&mine, &in);
  good &= bounded(&in, &mine);
  start(0.1);
  for (int power = -2; power < 3; power++) {
    load(&in, &mine, 0);
    for (int i = 0; i < 3; i++) {
      in.load[0].load.torque[i] = (fb_real)(pow(3, power) * 20) / (dt * dt);
    }
    give(&mine, &in);
    good &= mechanism.joint[0].n_axis == 0 || alike(&in, &mine, dt, "a torque that turns it too far");
    load(&in, &mine, 0);
    for (int k = 0; k < desc.n_body; k++) {
      in.drive[k].torque[0] = is_wheel(k) ? (fb_real)(pow(3, power) * 0.25) / (dt * dt) : in.drive[k].torque[0];
    }
    give(&mine, &in);
    good &= alike(&in, &mine, dt, "motors that turn wheels too far");
  }
  return good;
}

/* A spring whose points meet: without its actuator, its step limit on both sides; with it refused. */
static int meets(void)
{
  static fb_system_input in;
  static generated_input mine;
  int good;
  need(fb_system_state_init(&mechanism, model, &state, &work, NULL, NULL), "state at zero");
  generated_start(&own);
  good = bounded(NULL, NULL);
  memset(&in, 0, sizeof in);
  memset(&mine, 0, sizeof mine);
  in.pull[met] = FB_R(0.1);
  give(&mine, &in);
  return refused(&in, &mine, FB_R(1e-4), FB_ERR_RANGE, "points that meet, pulled") && good;
}

/* From the center of gravity outward, where that moves what flies: a step and the energy are refused as too near where the
   library refuses them. */
static int center_refused(void)
{
  int root = -1, seen[2] = {0, 0}, good = 1;
  for (int k = 0; k < desc.n_body; k++) {
    root = mechanism.joint[k].kind == FB_JOINT_FREE && model[desc.model[k]].mu > FB_R(0.0) ? k : root;
  }
  for (int k = 0; k < 40 && root >= 0 && mechanism.tied < 2 && !falls && good; k++) {
    fb_system_state copy;
    fb_energy theirs;
    generated_energy mine;
    fb_status expected[2];
    generated_status found[2];
    start(0.1);
    for (int i = 0; i < 3; i++) {
      state.link[root].x[i] = model[desc.model[root]].center[i] + (fb_real)(0.4 * k * (1 - 0.7 * i));
      state.link[root].lost_x[i] = FB_R(0.0);
    }
    copy = state;
    take_state(0);
    expected[0] = fb_system_energy_eval(&mechanism, model, &work, &theirs, &state, NULL);
    found[0] = generated_energy_eval(&mine, &own, NULL);
    expected[1] = held_step(&copy, NULL, FB_R(1e-6));
    found[1] = own_held_step(NULL, FB_R(1e-6));
    for (int i = 0; i < 2; i++) {
      good &= (int)expected[i] == (int)found[i] && (expected[i] == FB_OK || expected[i] == FB_ERR_RANGE);
    }
    seen[expected[0] == FB_OK]++;
  }
  if (!good || (seen[0] + seen[1] > 0 && (seen[0] == 0 || seen[1] == 0))) {
    printf("near the center: %d refused, %d taken\n", seen[0], seen[1]);
    good = 0;
  }
  return good;
}

/* What the library refuses, and each number of the state that is none. */
static int refusals(void)
{
  static fb_system_input in;
  static generated_input mine;
  const fb_real small = FB_R(1e-4);
#ifdef SDIRK
  const fb_real limit = FB_HUGE; /* at rest */
#else
  const fb_real limit = fb_system_rk4_limit(&mechanism, model, FB_R(0.0), FB_R(0.0));
#endif
  int good = 1;
  start(0.1);
  good &= refused(NULL, NULL, FB_R(0.0), FB_ERR_VALUE, "no step");
  good &= refused(NULL, NULL, -small, FB_ERR_VALUE, "a step back");
  good &= refused(NULL, NULL, (fb_real)NAN, FB_ERR_VALUE, "a step that is no number");
  good &= limit > FB_R(100.0) || refused(NULL, NULL, FB_R(1.01) * limit, FB_ERR_STEP, "beyond the limit");
#ifdef SDIRK
  good &= generated_step(NULL, NULL, NULL, small) == generated_null;
  good &= generated_step(&own, NULL, &mine, small) == generated_null;
#else
  good &= generated_step(NULL, NULL, NULL, NULL, small) == generated_null;
#endif
  load(&in, &mine, 0);
  in.load[0].load.torque[1] = (fb_real)NAN;
  give(&mine, &in);
  good &= mechanism.joint[0].n_axis == 0 || desc.joint[0].mode[0] != FB_AXIS_FREE ||
          refused(&in, &mine, small, FB_OK, "a load that is no number");
  for (int k = 0; k < n_piece; k++) {
    for (int i = 0; i < piece[k].n; i++) {
      const fb_real kept = piece[k].own[i];
      piece[k].own[i] = piece[k].theirs[i] = (fb_real)NAN;
      good &= piece[k].kind == VALUE || (piece[k].kind == SPUN /* one that is given is not read */
                                             ? alike(NULL, NULL, small, "a momentum of a rotor that is none")
                                             : refused(NULL, NULL, small, FB_OK, "a number of the state that is none"));
      piece[k].own[i] = piece[k].theirs[i] = kept;
      if (piece[k].kind == MODE) {
        piece[k].own[i] = piece[k].theirs[i] = FB_R(100.0);
        good &= refused(NULL, NULL, small, FB_OK, "a deflection out of range");
        piece[k].own[i] = piece[k].theirs[i] = kept;
      }
    }
  }
  return good;
}

/* A step of both from the same state, value and rate of all prescribed axes at its start, middle (NULL: not told) and end. */
static int jump(double x, const double *at[3], double dt, const char *what)
{
  static fb_system_input in[3];
  static generated_input mine[3];
  fb_system_state copy;
  fb_status status;
  generated_status same;
  for (int k = 0; k < desc.n_body; k++) {
    for (int i = 0; i < 3; i++) {
      state.link[k].x[i] = is_valued(k, i) ? (fb_real)x : state.link[k].x[i];
    }
  }
  for (int i = 0; i < 3; i++) {
    memset(&in[i], 0, sizeof in[i]);
    memset(&mine[i], 0, sizeof mine[i]);
    in[i].n_load = desc.n_body;
    for (int k = 0; k < desc.n_body + desc.n_loop; k++) {
      in[i].load[k].body = k < desc.n_body ? k : 0;
      for (int a = 0; a < 3 && at[i]; a++) {
        in[i].drive[k].value[a] = is_valued(k, a) ? (fb_real)at[i][0] : FB_R(0.0);
        in[i].drive[k].rate[a] = is_valued(k, a) ? (fb_real)at[i][1] : FB_R(0.0);
      }
    }
    give(&mine[i], &in[i]);
  }
  copy = state;
  take_state(0);
#ifdef SDIRK
  status = fb_system_sdirk_step(&mechanism, model, &copy, &work, &in[0], &in[2], (fb_real)dt, generated_ITERATIONS);
  same = generated_step(&own, &mine[0], &mine[2], (fb_real)dt);
#else
  status = fb_system_rk4_step(&mechanism, model, &copy, &work, &in[0], at[1] ? &in[1] : NULL, &in[2], (fb_real)dt);
  same = generated_step(&own, &mine[0], at[1] ? &mine[1] : NULL, &mine[2], (fb_real)dt);
#endif
  take_state(0);
  if ((int)status != (int)same) {
    printf("%s by %g: library %d, generated %d\n", what, at[2][0], (int)status, (int)same);
  }
  return (int)status == (int)same ? status == FB_OK ? 1 : 2 : 0;
}

/* Prescribed values that go with their rates, and that jump: taken and refused as by the library, at the same values. */
static int jumps(int which)
{
  static const double size[] = {0, 0.5, 0.99, 1.01, 3, 1e6};
  const double dt = 1e-3, turn = 6.283185307179586;
  int seen[3] = {0}, driven = 0;
  for (int k = 0; k < desc.n_body + desc.n_loop; k++) { /* of loops, one that turns an axis, which may jump as far */
    driven |= (is_valued(k, 0) || is_valued(k, 1)) && (desc.n_loop == 0 || trees[which].turned == DOOR);
  }
  if (!driven) {
    return 1;
  }
  start(0.1);
  for (int k = 0; k < 6; k++) {
    const double far = 2 * size[k] * dt; /* of the most a rate of 1 allows */
    const double a[2] = {0, 1}, b[2] = {0.5 * far, 1}, c[2] = {far, 1}, still[2] = {0, 0}, back[2] = {far, -1};
    const double first[2] = {0.1 + far, 1}, then[2] = {0.1 + far + 0.5 * dt, 1}, last[2] = {0.1 + far + dt, 1};
    const double around[2] = {0.1 + turn, 1}, on[2] = {0.1 + turn + 0.5 * dt, 1}, round[2] = {0.1 + turn + dt, 1};
    seen[jump(0, (const double *[3]){a, b, c}, dt, "in the step")]++;
    seen[jump(0, (const double *[3]){a, NULL, c}, dt, "without a middle")]++;
    seen[jump(0, (const double *[3]){a, c, b}, dt, "in its middle")]++;
    seen[jump(0, (const double *[3]){a, b, back}, dt, "there and back")]++;
    seen[jump(0, (const double *[3]){still, still, c}, dt, "at last")]++;
    seen[jump(0.1, (const double *[3]){first, then, last}, dt, "from the state")]++;
    seen[jump(0.1, (const double *[3]){around, on, round}, dt, "a whole turn on")]++;
    seen[jump(0, (const double *[3]){still, still, still}, dt, "at rest")]++;
  }
  {
    const double none[2] = {(double)NAN, 1}, a[2] = {0, 1};
    seen[jump(0, (const double *[3]){a, none, a}, dt, "no number")]++;
  }
  return seen[0] == 0 && seen[1] > 5 && seen[2] > 5;
}

/* Numbers of one member of the motion beside those of the library. */
static int is_seen(const fb_real *mine, const fb_real *theirs, size_t n, const char *what)
{
  for (size_t i = 0; i < n; i++) {
    const double size = 1.0 + fabs((double)theirs[i]);
    if (!(fabs((double)mine[i] - (double)theirs[i]) <= TOLERANCE * size)) {
      printf("%s[%d]: %.17g, by the library %.17g\n", what, (int)i, (double)mine[i], (double)theirs[i]);
      return 0;
    }
  }
  return 1;
}

/* All nodes, and what is none. */
static int nodes_seen(const fb_system_motion *motion, const generated_motion *mine)
{
  fb_node_motion theirs;
  generated_node node;
  fb_real R[9], own_R[9];
  int good = 1;
  for (int k = 0; k < desc.n_body; k++) {
    const fb_body *const body = &model[desc.model[k]];
    for (int at = 0; at < body->n_node; at++) {
      need(fb_body_node_motion_eval(body, &theirs, &motion->pose[k], &motion->motion[k], at), "node");
      good &= generated_node_eval(&node, &own, mine, k, at) == generated_ok;
      fb_quat_to_mat33(R, theirs.quat);
      fb_quat_to_mat33(own_R, node.quat);
      good &= is_seen(node.position, theirs.position, 3, "node position") && is_seen(own_R, R, 9, "node attitude") &&
              is_seen(node.velocity, theirs.velocity, 3, "node velocity") &&
              is_seen(node.angular_rate, theirs.angular_rate, 3, "node angular rate");
    }
    good &= generated_node_eval(&node, &own, mine, k, body->n_node) == generated_value &&
            generated_node_eval(&node, &own, mine, k, -1) == generated_value;
  }
  good &= generated_node_eval(&node, &own, mine, desc.n_body, 0) == generated_value &&
          generated_node_eval(&node, &own, mine, -1, 0) == generated_value &&
          generated_node_eval(NULL, &own, mine, 0, 0) == generated_null &&
          generated_node_eval(&node, NULL, mine, 0, 0) == generated_null &&
          generated_node_eval(&node, &own, NULL, 0, 0) == generated_null;
  if (!good) {
    printf("nodes\n");
  }
  return good;
}

static int energy_seen(const fb_system_input *in, const generated_input *acts)
{
  fb_energy theirs;
  generated_energy mine;
  fb_real a[3], b[3], size;
  need(fb_system_energy_eval(&mechanism, model, &work, &theirs, &state, in), "energy");
  if (generated_energy_eval(&mine, &own, acts) != generated_ok ||
      generated_energy_eval(NULL, &own, acts) != generated_null ||
      generated_energy_eval(&mine, NULL, acts) != generated_null) {
    printf("energy: a status\n");
    return 0;
  }
  size = theirs.kinetic + theirs.strain; /* what rounding is of */
  for (int i = 0; i < 3; i++) {
    a[i] = (i == 0 ? mine.kinetic : i == 1 ? mine.strain : mine.gravity) / (FB_R(1.0) + size);
    b[i] = (i == 0 ? theirs.kinetic : i == 1 ? theirs.strain : theirs.gravity) / (FB_R(1.0) + size);
  }
  return is_seen(a, b, 3, "energy");
}

/* Where the bodies and their nodes are, how they move and their energy at the state of the library, under what acts. */
static int seen(const fb_system_input *in, const generated_input *acts)
{
  static fb_system_motion motion;
  static generated_motion mine;
  fb_real R[9];
  int good = 1;
  take_state(0);
  need(fb_system_motion_eval(&mechanism, model, &work, &motion, &state, in), "motion");
  if (generated_motion_eval(&mine, &own, acts) != generated_ok ||
      generated_motion_eval(NULL, &own, acts) != generated_null ||
      generated_motion_eval(&mine, NULL, acts) != generated_null) {
    printf("motion: a status\n");
    return 0;
  }
#define SEEN(k, member, theirs)                                                                                    \
  good &= is_seen(mine.body_##k.member, motion.theirs, sizeof mine.body_##k.member / sizeof *mine.body_##k.member, \
                  #k " " #member);
#define TURNED(k)                           \
  fb_quat_to_mat33(R, motion.pose[k].quat); \
  good &= is_seen(mine.body_##k.R, R, 9, #k " R");
#define LOAD(k)
#define MOTOR(k)
#define MEMBER(k, member, kind)
#define DRIVE(k)
#define ROTORS(k)
#include "members.h"
#undef SEEN
#undef TURNED
#undef MEMBER
#undef LOAD
#undef MOTOR
#undef DRIVE
#undef ROTORS
  return nodes_seen(&motion, &mine) && energy_seen(in, acts) && good;
}

/* At the end of a flight and at its start, at rest of what is prescribed and under loads. */
static int all_seen(void)
{
  static fb_system_input in;
  static generated_input mine;
  int good = seen(NULL, NULL);
  start(0.3);
  good &= seen(NULL, NULL);
  load(&in, &mine, 0.7);
  for (int k = 0; k < desc.n_body; k++) {
    for (int i = 0; i < 3; i++) { /* where it is */
      in.drive[k].value[i] = mechanism.joint[k].mode[i] != FB_AXIS_FREE ? state.link[k].x[i] : in.drive[k].value[i];
    }
  }
  give(&mine, &in);
  return seen(&in, &mine) && good;
}

int main(int argc, char **argv)
{
  double worst = 0;
#ifdef SDIRK
  hard = HARD;
#endif
  build(argc > 1 ? atoi(argv[1]) : 0);
#define LOAD(k)
#define MOTOR(k)
#define MEMBER(k, member, kind) add(own.body_##k.member, state.link[k].member, sizeof own.body_##k.member, kind);
#define PART(k, member, i, kind) add(own.body_##k.member + i, state.link[k].member + i, sizeof(fb_real), kind);
#define HOLD(j, member) add(own.loop_##j.member, state.member[desc.n_body + j], sizeof own.loop_##j.member, VALUE);
#define DRIVE(k)
#define ROTORS(k)                                                                                                  \
  add(own.body_##k.rotor_angle, state.link[k].q + model[desc.model[k]].n, sizeof own.body_##k.rotor_angle, ANGLE); \
  add(own.body_##k.rotor_momentum, state.link[k].pi + model[desc.model[k]].n, sizeof own.body_##k.rotor_momentum, SPUN);
#define WORK add(&own.motor_work, &state.motor_work, sizeof own.motor_work, WORKED);
#include "members.h"
#undef WORK
#undef MEMBER
#undef LOAD
#undef MOTOR
#undef DRIVE
#undef ROTORS
  for (int loaded = 0; loaded < 2; loaded++) {
    start(0.3);
    worst = fmax(worst, fly(loaded));
  }
  printf(" worst %.1e\n", worst);
  if (generated_crc != (FB_SINGLE ? generated_crc : fb_system_crc(&mechanism, model, MODELS))) {
    printf("check word\n");
    return 1;
  }
  return all_seen() && refusals() && center_refused() && limits() && jumps(argc > 1 ? atoi(argv[1]) : 0) &&
                 (met < 0 || meets()) && worst <= TOLERANCE
             ? 0
             : 1;
}
#endif
