/* peers_links.h - ten rigid links on hinges, about y and z in turn, that fall from rest: what bench_peers_links.c, peers_links.cpp
   and peers.py step. */
#ifndef FBB_PEERS_LINKS_H
#define FBB_PEERS_LINKS_H

enum { LINKS = 10 };
#define LINK_LENGTH 0.5 /* [m] from hinge to hinge along x */
#define LINK_MASS 1.0   /* [kg] */
#define LINK_CENTER 0.25
#define LINK_INERTIA 0.002, 0.02, 0.02 /* [kg m^2] about the mass center */
#define LINK_ANGLE 0.2                 /* [rad] of all hinges at the start */
#define LINK_GRAVITY (-9.81)           /* [m/s^2] along z */
#define LINK_END 1.0                   /* [s] */

static const double link_steps[] = {0.02, 0.01, 0.005, 0.002, 0.001, 0.0005, 0.0002, 0.0001}; /* [s] */

#endif
