/* airloads.h - air loads by strip theory on the lines of bodies, as a function for fb_input.distributed or
   fb_system_input.distributed: section tables with stall, unsteady lift, apparent mass, inflow by momentum theory,
   gusts. README.md beside it derives the formulas by the numbers in brackets and names the sources.
   Section axes are those of fb_line_point: x along the line, y toward the leading edge, z up. A strip has the chord
   c = 2 b, and the line runs `line` times b behind mid-chord (Theodorsen's a). Include flexbeam.h before. */
#ifndef AIRLOADS_H
#define AIRLOADS_H
#include <math.h>
#include <string.h>

enum { AIR_ANGLES = 80, AIR_POINTS = FB_MAX_LINE_POINTS };
#ifndef AIR_BODIES
#define AIR_BODIES 1 /* bodies with lines are the first of a system, or AIR_BODIES is larger */
#endif
static const double air_pi = 3.14159265358979324;
/* [A2] R. Jones' approximation of Wagner's function, phi(s) = 1 - A1 exp(-b1 s) - A2 exp(-b2 s), s in semichords */
static const double air_jones_A[2] = {0.165, 0.335}, air_jones_b[2] = {0.0455, 0.3};

typedef struct air_table { /* coefficients of a section against the angle of attack */
  int n;                   /* 2..AIR_ANGLES, from -pi to pi, ascending */
  double angle[AIR_ANGLES], lift[AIR_ANGLES], drag[AIR_ANGLES], moment[AIR_ANGLES]; /* moment: about the quarter chord,
                                                                                       nose up is positive */
} air_table;

/* [A1] Lift, drag and moment coefficient: linear between the angles, which go around. */
static inline void air_coefficients(double c[3], const air_table *t, double angle)
{
  const double a = atan2(sin(angle), cos(angle));
  int low = 0, high = t->n - 1;
  double part;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    *(t->angle[middle] <= a ? &low : &high) = middle;
  }
  part = fmin(1, fmax(0, (a - t->angle[low]) / (t->angle[high] - t->angle[low])));
  c[0] = t->lift[low] + part * (t->lift[high] - t->lift[low]);
  c[1] = t->drag[low] + part * (t->drag[high] - t->drag[low]);
  c[2] = t->moment[low] + part * (t->moment[high] - t->moment[low]);
}

/* [A1] A table for all angles every five degrees, and at stall: thin airfoil with the given slope of lift [1/rad] and
   drag up to the angle of stall [rad], from twice that on a flat plate, c_n = 2 sin a, its center of pressure at
   (1/4 + |a|/(2 pi)) c; straight lines between. stall is above 0 and at most pi/8. */
static inline void air_table_plate(air_table *t, double slope, double stall, double drag)
{
  t->n = 0;
  for (int k = -36; k <= 36; k++) {
    const double a = k * air_pi / 36, normal = 2 * sin(a);
    if (k == 0) {
      for (int side = -1; side <= 1; side++, t->n++) {
        t->angle[t->n] = side * stall;
        t->lift[t->n] = side * stall * slope;
        t->drag[t->n] = drag;
        t->moment[t->n] = 0;
      }
    } else if (fabs(a) >= 2 * stall) {
      t->angle[t->n] = a;
      t->lift[t->n] = normal * cos(a);
      t->drag[t->n] = drag + normal * sin(a);
      t->moment[t->n++] = -normal * fabs(a) / (2 * air_pi);
    }
  }
}

typedef struct air_section { /* of all strips */
  const air_table *table;
  double chord, line; /* [m], place of the line behind mid-chord in semichords */
  int unsteady;       /* 1: circulatory lift lags, [A2]; 0: quasi-steady */
} air_section;

typedef struct air_gust { /* [A6] */
  double velocity[3];     /* [m/s] at the middle, inertial axes; zero: none */
  double along[3];        /* unit vector along which the front travels over the points.. */
  double speed, length;   /* [m/s] ..with this; [m] from front to end */
  double start;           /* [m] along it from the origin to the front at t = 0 */
} air_gust;

typedef struct air {
  air_section section;
  double density, wind[3]; /* [kg/m^3], [m/s] of the air far away, inertial axes */
  air_gust gust;
  double inflow, axis[3];              /* [m/s] uniform induced velocity against the unit vector axis, inertial axes */
  double x[AIR_BODIES][AIR_POINTS][2]; /* [m/s] states of the lag, by body and point */
  /* of the last evaluation, by body: number of points, downwash at three quarters of the chord [m/s], semichords
     travelled per time [1/s]; force [N] and moment about the origin [N m] of all its strips, inertial axes */
  int n[AIR_BODIES];
  double downwash[AIR_BODIES][AIR_POINTS], rate[AIR_BODIES][AIR_POINTS];
  double force[AIR_BODIES][3], moment[AIR_BODIES][3];
} air;

/* [A6] Velocity of the gust at a place: velocity (1 - cos 2 pi s/length)/2, s behind its front. */
static inline double air_gust_part(const air_gust *g, const fb_real position[3], double t)
{
  double s = g->start + g->speed * t;
  for (int i = 0; i < 3; i++) {
    s -= g->along[i] * (double)position[i];
  }
  return g->length > 0 && s > 0 && s < g->length ? 0.5 * (1 - cos(2 * air_pi * s / g->length)) : 0;
}

/* Velocity of the section through the air at the line, section axes. */
static inline void air_relative(double u[3], const air *a, const fb_line_point *p, double t)
{
  const double gust = air_gust_part(&a->gust, p->position, t);
  fb_real v[3], local[3];
  for (int i = 0; i < 3; i++) {
    v[i] = (fb_real)((double)p->velocity[i] - a->wind[i] - gust * a->gust.velocity[i] + a->inflow * a->axis[i]);
  }
  fb_mat33_mulT_vec3(local, p->R, v);
  for (int i = 0; i < 3; i++) {
    u[i] = (double)local[i];
  }
}

/* [A2] What circulation sees of the downwash: w_e = phi(0) w + x_1 + x_2; quasi-steady: w. */
static inline double air_effective(const air *a, const double x[2], double w)
{
  return a->section.unsteady ? (1 - air_jones_A[0] - air_jones_A[1]) * w + x[0] + x[1] : w;
}

/* [A3] Force (F_y, F_z) and nose-up moment about the line, per length, of a section that moves through the air with u_y
   forward and turns with the rate w_x; w_e: the downwash above. Lift, drag and moment of the table at the quarter
   chord; the part of the apparent mass that goes with the speed, rho pi b^2 u_y w_x at three quarters. */
static inline void air_strip(double F[2], double *M, const air *a, double u_y, double w_e, double w_x)
{
  const double b = 0.5 * a->section.chord, quarter = (a->section.line + 0.5) * b, rear = quarter - b;
  const double half = 0.5 * a->density * a->section.chord, speed = sqrt(u_y * u_y + w_e * w_e);
  const double damping = a->density * air_pi * b * b * u_y * w_x;
  double c[3];
  air_coefficients(c, a->section.table, atan2(w_e, u_y));
  F[0] = half * speed * (c[0] * w_e - c[1] * u_y);
  F[1] = half * speed * (c[0] * u_y + c[1] * w_e);
  *M = quarter * F[1] + rear * damping + half * speed * speed * a->section.chord * c[2];
  F[1] += damping;
}

/* fb_distributed; user is an air. Loads follow from poses, velocities and the states x alone: what it notes down is for
   air_advance and the caller, and does not enter them. */
static inline fb_status air_loads(fb_line_point *point, int n, fb_real t, void *user)
{
  air *const a = (air *)user;
  const int body = point[0].body;
  const double b = 0.5 * a->section.chord, rear = (a->section.line - 0.5) * b;
  if (body >= AIR_BODIES || n > AIR_POINTS) {
    return FB_ERR_CAPACITY;
  }
  a->n[body] = n;
  memset(a->force[body], 0, sizeof a->force[body]);
  memset(a->moment[body], 0, sizeof a->moment[body]);
  for (int k = 0; k < n; k++) {
    fb_line_point *const p = &point[k];
    double u[3], F[2], M, w, w_x = 0;
    fb_real local[3] = {0}, arm[3];
    air_relative(u, a, p, (double)t);
    for (int i = 0; i < 3; i++) {
      w_x += (double)p->R[3 * i] * (double)p->angular_rate[i];
    }
    w = -u[2] - w_x * rear;
    air_strip(F, &M, a, u[1], air_effective(a, a->x[body][k], w), w_x);
    local[1] = p->length * (fb_real)F[0];
    local[2] = p->length * (fb_real)F[1];
    fb_mat33_mul_vec3(p->force, p->R, local);
    fb_vec3_cross(arm, p->position, p->force);
    a->downwash[body][k] = w;
    a->rate[body][k] = sqrt(u[1] * u[1] + w * w) / b;
    for (int i = 0; i < 3; i++) {
      p->torque[i] = p->R[3 * i] * p->length * (fb_real)M;
      a->force[body][i] += (double)p->force[i];
      a->moment[body][i] += (double)arm[i] + (double)p->torque[i];
    }
  }
  return FB_OK;
}

/* [A4] The states of the lag after dt under the downwash of the last evaluation, held, in closed form:
   x_i' = b_i V/b (A_i w - x_i). Half of it before and half after a step of the bodies is of order 2. dt = FB_HUGE: steady. */
static inline void air_advance(air *a, double dt)
{
  for (int body = 0; body < AIR_BODIES; body++) {
    for (int k = 0; k < a->n[body]; k++) {
      for (int i = 0; i < 2; i++) {
        const double end = air_jones_A[i] * a->downwash[body][k];
        a->x[body][k][i] = end + (a->x[body][k][i] - end) * exp(-air_jones_b[i] * a->rate[body][k] * dt);
      }
    }
  }
}

/* [A5] Adds the apparent mass of a thin airfoil, rho pi b^2 at mid-chord with the moment of inertia rho pi b^4/8, to a
   section of the beam. For wings whose speed is steady and that move across the chord alone: it is mass in all
   directions, to gravity and to the centrifugal force, too. i_y: the part that turns with the span is left alone. */
static inline void air_add_apparent_mass(fb_section *s, double density, double chord, double line)
{
  const double b = 0.5 * chord, added = density * air_pi * b * b, middle = line * b, mass = (double)s->mass + added;
  const double center = ((double)s->mass * (double)s->mass_y + added * middle) / mass;
  const double before = (double)s->mass_y - center, after = middle - center;
  s->i_z = (fb_real)((double)s->i_z + (double)s->mass * before * before + added * (b * b / 8 + after * after));
  s->mass_y = (fb_real)center;
  s->mass = (fb_real)mass;
}

/* [A7] Glauert's induced velocity v of a rotor disc of this area that carries this thrust and moves through the air with
   `along` in its plane and `climb` along its axis: thrust = 2 rho area v sqrt(along^2 + (climb + v)^2), 0 for no
   thrust; below 0 for thrust down. Not for descent (climb < 0) near the vortex ring state. */
static inline double air_momentum_inflow(double thrust, double density, double area, double along, double climb)
{
  const double side = thrust < 0 ? -1 : 1, c = side * climb;
  double low = 0, high = sqrt(fabs(thrust) / (2 * density * area)) + fabs(climb);
  for (int k = 0; k < 100; k++) {
    const double v = 0.5 * (low + high);
    *(2 * density * area * v * sqrt(along * along + (c + v) * (c + v)) < fabs(thrust) ? &low : &high) = v;
  }
  return side * low;
}
#endif
