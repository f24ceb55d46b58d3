/* parts.c - bodies of parts read from text files against the same models by C calls.
   usage: parts FOLDER, into which it writes; rom.h is examples/two_booms.txt by flexbeam reduce. */
#include "../../examples/tools/capacities.h"
#include "../../flexbeam.h"
#include "../../examples/tools/model.h"
#include "rom.h"

static fb_build_work build_work;
static fb_body by_calls;
static int bad;
static double worst[5]; /* of what is said at the end */

enum { FILES, PLACED, DAMPED, STEPPED, TURNING };

static void is_near(int what, const char *name, double have, double want, double scale, double tolerance)
{
  const double error = fabs(have - want) / scale;
  worst[what] = fmax(worst[what], error);
  if (!(error <= tolerance)) {
    printf("%s: %.17g, not %.17g\n", name, have, want);
    bad = 1;
  }
}

static void are_near(int what, const char *name, const fb_real *have, const fb_real *want, int n, double tolerance)
{
  double scale = 0;
  for (int i = 0; i < n; i++) {
    scale = fmax(scale, fabs((double)want[i]));
  }
  for (int i = 0; i < n && scale > 0; i++) {
    is_near(what, name, (double)have[i], (double)want[i], scale, tolerance);
  }
}

static void require(fb_status status, const char *what)
{
  if (status != FB_OK) {
    printf("%s: %s (%s: %s)\n", what, fb_status_string(status), fb_detail_last()->function, fb_detail_last()->what);
    exit(1);
  }
}

static void read_body(const char *file)
{
  const char *what;
  if (!model_read("parts", file)) {
    exit(1);
  }
  require(model_build(&what), file);
}

/* Squares of frequencies, ascending. */
static void frequencies(fb_real *d, const fb_shape *shape)
{
  static fb_real K[FB_MAX_MODES * FB_MAX_MODES], M[FB_MAX_MODES * FB_MAX_MODES], X[FB_MAX_MODES * FB_MAX_MODES];
  memcpy(K, shape->K, sizeof K);
  memcpy(M, shape->M, sizeof M);
  require(fb_eig_gen_solve(d, X, K, M, shape->n), "frequencies");
}

/* 1000 steps under a torque on the hub and a force on the last node; rotors from the speeds of the description on. */
static void run(fb_state *state, const fb_body *body)
{
  static fb_rk4_work work;
  fb_input input = {.n_load = 2, .load = {{.torque = {3, -2, 5}}, {.axes = FB_AXES_INERTIAL, .force = {1, 1, 2}}}};
  input.load[1].node = body->n_node - 1;
  require(fb_state_init(body, state), "state");
  for (int r = 0; r < body->n_rotor; r++) {
    input.rotor[r].torque = FB_R(0.05);
    require(fb_state_rotor_set(body, state, r, (fb_real)model.rotor[r].text.speed, 0, NULL), "speed");
  }
  for (int k = 0; k < 1000; k++) {
    require(fb_rk4_step(body, state, &work, &input, &input, &input, FB_R(0.002)), "step");
  }
}

/* Mass, inertia, shapes and Lambda, and where 1000 steps lead to. */
static void compare(int what, const fb_shape *shape, const fb_body *body)
{
  static fb_real lambda[2][FBI_MAX_LAMBDA];
  fb_real have[FB_MAX_MODES], want[FB_MAX_MODES];
  fb_state a, b;
  const int n = shape->n;
  if (n != model_shape.n || body->n_lambda != model_body.n_lambda || shape->n_node != model_shape.n_node) {
    printf("%d modes, %d terms of Lambda, %d nodes, not %d, %d, %d\n", model_shape.n, model_body.n_lambda,
           model_shape.n_node, n, body->n_lambda, shape->n_node);
    exit(1);
  }
  frequencies(have, &model_shape);
  frequencies(want, shape);
  for (int k = 0; k < n; k++) {
    is_near(what, "omega^2", (double)have[k], (double)want[k], (double)want[k], 1e-12);
  }
  are_near(what, "mass", &model_shape.mass, &shape->mass, 1, 1e-12);
  are_near(what, "inertia", model_shape.J, shape->J, 9, 1e-12);
  are_near(what, "p", model_shape.P, shape->P, 3 * n, 1e-12);
  are_near(what, "h", model_shape.H, shape->H, 3 * n, 1e-12);
  are_near(what, "M", model_shape.M, shape->M, n * n, 1e-12);
  are_near(what, "ups", model_shape.second.ups, shape->second.ups, 3 * n * n, 1e-12);
  are_near(what, "Pi", model_shape.second.Pi, shape->second.Pi, 9 * n * n, 1e-12);
  are_near(what, "p^chi", model_shape.second.pchi, shape->second.pchi, 3 * n * n, 1e-12);
  are_near(what, "h^chi", model_shape.second.hchi, shape->second.hchi, 3 * n * n, 1e-12);
  are_near(what, "Gamma^chi", model_shape.second.Gamchi, shape->second.Gamchi, 9 * n * n, 1e-12);
  for (int k = 0; k < body->n_lambda; k++) {
    lambda[0][k] = model_body.lambda[k].c;
    lambda[1][k] = body->lambda[k].c;
  }
  are_near(what, "Lambda", lambda[0], lambda[1], body->n_lambda, 1e-12);
  run(&a, &model_body);
  run(&b, body);
  are_near(what, "position", a.rho, b.rho, 3, 1e-12);
  are_near(what, "attitude", a.quat, b.quat, 4, 1e-12);
  are_near(what, "q", a.q, b.q, n, 1e-12);
  are_near(what, "pi", a.pi, b.pi, n, 1e-12);
  are_near(what, "angles of rotors", a.q + n, b.q + n, body->n_rotor, 1e-12);
  are_near(what, "momenta of rotors", a.pi + n, b.pi + n, body->n_rotor, 1e-12);
}

static void two_booms(void)
{
  const fb_section tube = {.mass = FB_R(0.5), .EI_y = 2000, .EI_z = 2000};
  const fb_beam_desc beam = {.length = 8, .n_element = 8, .n_station = 1, .station = {tube}};
  const fb_modes_desc keep = {.count = {2, 2}};
  fb_build_desc craft = {.mass = 400,
                         .inertia = {60, 60, 80},
                         .n_part = 2,
                         .part = {{.position = {FB_R(0.5)}, .n_node = 1, .node = {8}},
                                  {.position = {FB_R(-0.5)}, .attitude = {0, 0, 0, 1}, .n_node = 1, .node = {8}}},
                         .body = {.effects = FB_EFFECTS_FULL | FB_EFFECT_DAMPING}};
  fb_state a, b;
  for (int k = 0; k < 8; k++) {
    craft.body.zeta[k] = k < 4 ? FB_R(0.005) : FB_R(0.003);
  }
  read_body("examples/two_booms.txt");
  require(fb_body_build(&by_calls, &build_work, &craft, &beam, &keep, 1), "two booms by C calls");
  model_shape.node[1] = build_work.shape.node[1]; /* the node of the hub comes first in the file alone */
  model_shape.n_node--;
  compare(FILES, &build_work.shape, &by_calls);

  /* the model in ROM */
  run(&a, &model_body);
  run(&b, &rom_body);
  are_near(STEPPED, "q of the model in ROM", b.q, a.q, 8, 0);
  are_near(STEPPED, "pi of the model in ROM", b.pi, a.pi, 8, 0);
  are_near(STEPPED, "attitude of the model in ROM", b.quat, a.quat, 4, 0);
}

/* Wheels on the hub and, by the number of its node, on the tip of a boom. */
static void wheels(const char *file)
{
  static fb_shape shape;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_body_work body_work;
  const fb_section tube = {.mass = FB_R(0.5), .EI_y = 2000, .EI_z = 3000};
  const fb_beam_desc desc = {.length = 8, .n_element = 8, .n_station = 1, .station = {tube}};
  const fb_modes_desc keep = {.count = {2, 2}};
  const fb_real center[3] = {0}, inertia[6] = {60, 70, 80}, bench[3] = {0, FB_R(0.3), 0}, none[3 * FB_MAX_MODES] = {0};
  const fb_rotor rotor[3] = {{.node = 1, .axis = {0, 2, 0}, .inertia = FB_R(0.05), .damping = FB_R(1e-3)},
                             {.node = 2,
                              .axis = {1, 1, 0},
                              .inertia = FB_R(0.004),
                              .static_imbalance = FB_R(1e-5),
                              .dynamic_imbalance = FB_R(2e-5),
                              .dynamic_phase = (fb_real)(40 * 3.14159265358979324 / 180)},
                             {.axis = {0, 0, -1}, .inertia = FB_R(0.01), .friction = FB_R(0.02), .friction_speed = 2}};
  fb_body_desc level = {.effects = FB_EFFECTS_FULL, .n_rotor = 3};
  int node;
  FILE *out = fopen(file, "w");
  if (!out) {
    perror(file);
    exit(1);
  }
  fputs("parts\nhub 400  0 0 0  60 70 80\neffects full\n"
        "rotor tip 2\n  axis 1 1 0\n  inertia 0.004\n  speed -40\n  static_imbalance 1e-5\n"
        "  dynamic_imbalance 2e-5 40\nend\n"
        "beam boom\n  length 8\n  elements 8\n  modes bend_y 2 bend_z 2\n  stations x mass EI_y EI_z\n"
        "  0 0.5 2000 3000\n  end\n  node tip far\nend\n"
        "rotor hub bench\n  speed 300\n  axis 0 2 0\n  damping 1e-3\n  inertia 0.05\nend\nnode 0 0.3 0 bench\n"
        "rotor own\n  axis 0 0 -1\n  inertia 0.01\n  friction 0.02 2\nend\n",
        out);
  fclose(out);
  read_body(file);
  require(fb_beam_init(&beam, &desc), "beam");
  require(fb_modes_solve(&modes, &modes_work, &beam, &keep), "modes");
  require(fb_shape_init(&shape, 4), "shape");
  require(fb_shape_add_node(&shape, &node, bench, none, none), "node");
  require(fb_shape_add_beam(&shape, 0, &beam, &modes), "beam");
  require(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, 8), "node");
  require(fb_shape_add_rigid(&shape, 400, center, inertia), "hub");
  level.rotor[0] = rotor[1]; /* in the order of the file */
  level.rotor[1] = rotor[0];
  level.rotor[2] = rotor[2];
  require(fb_body_init(&by_calls, &body_work, &shape, &level), "body");
  compare(TURNING, &shape, &by_calls);
  if (fb_body_crc(&by_calls) != fb_body_crc(&model_body)) {
    printf("wheels: another body than by C calls\n");
    bad = 1;
  }
}

/* ---- a component in another place and attitude, beside a beam */

#define POINTS 5
#define SHAPES 2

typedef struct point {
  double x[3], mass, J[6], u[SHAPES][3], turn[SHAPES][3], chi[3][3]; /* chi of the pairs 11, 12, 22 */
} point;

static const double omega[SHAPES] = {2.5, 4.0}; /* [rad/s] */

/* How the second order is given; along lines: from which point each comes, -1: the frame, 3 without rotations. */
enum { QUADRATIC, GEOMETRIC, LINE, WAYS };
static const int before[POINTS] = {-1, 0, 1, 1, 2};
static const double begin[3] = {0.1, -0.2, 0.3};

/* Numbers from -1 to 1. */
static double any(void)
{
  static unsigned seed = 12345;
  seed = seed * 1664525u + 1013904223u;
  return (double)(seed >> 8) / 8388608.0 - 1;
}

static void make_points(point *p)
{
  for (int k = 0; k < POINTS; k++) {
    p[k].mass = 2 + any();
    for (int i = 0; i < 3; i++) {
      p[k].x[i] = 2 * any();
      p[k].J[i] = 1 + 0.2 * any();
      p[k].J[3 + i] = 0.1 * any();
      for (int a = 0; a < SHAPES; a++) {
        p[k].u[a][i] = any();
        p[k].turn[a][i] = any();
      }
      for (int ab = 0; ab < 3; ab++) {
        p[k].chi[ab][i] = 0.1 * any();
      }
    }
  }
}

static void turned(double out[3], const double R[9], const double x[3])
{
  for (int i = 0; i < 3; i++) {
    out[i] = R[3 * i] * x[0] + R[3 * i + 1] * x[1] + R[3 * i + 2] * x[2];
  }
}

/* Fields of point k along its line, where it is in the shape; those of the points before are known. */
static void follow(fb_fields *fields, const fb_shape *shape, int k, const double at[3], const double R[9],
                   const fb_real r[3], const fb_real *psi, const fb_real *theta)
{
  static fb_fields root;
  static const fb_real none[3 * FB_MAX_MODES];
  double x[3];
  fb_real place[3];
  turned(x, R, begin);
  for (int i = 0; i < 3; i++) {
    place[i] = (fb_real)(x[i] + at[i]);
  }
  require(fb_fields_init(&root, shape, NULL, place, none, none), "the beginning of a line");
  require(fb_fields_init(&fields[k], shape, before[k] < 0 ? &root : &fields[before[k]], r, psi, k == 3 ? NULL : theta),
          "a point of a line");
}

/* Adds the points to a shape of n coordinates, from `first` on, displaced by `at` and turned by R; lumps: with their
   inertia, whose rotation has a second-order displacement of its own. */
static void add_points(fb_shape *shape, const point *p, const double at[3], const double R[9], int first,
                       const double scale[SHAPES], int lumps, int way)
{
  static fb_fields fields[POINTS];
  static const int pair[SHAPES][SHAPES] = {{0, 1}, {1, 2}}, J_at[9] = {0, 3, 4, 3, 1, 5, 4, 5, 2};
  const int n = shape->n;
  for (int k = 0; k < POINTS; k++) {
    static fb_real psi[3 * FB_MAX_MODES], theta[3 * FB_MAX_MODES], none[3 * FB_MAX_MODES],
        chi[3 * FB_MAX_MODES * FB_MAX_MODES];
    fb_real r[3], J[6];
    double x[3], full[9] = {0};
    turned(x, R, p[k].x);
    for (int i = 0; i < 3; i++) {
      r[i] = (fb_real)(x[i] + at[i]);
    }
    memset(psi, 0, sizeof psi);
    memset(theta, 0, sizeof theta);
    memset(chi, 0, sizeof chi);
    for (int a = 0; a < SHAPES; a++) {
      double u[3], turn[3];
      turned(u, R, p[k].u[a]);
      turned(turn, R, p[k].turn[a]);
      for (int i = 0; i < 3; i++) {
        psi[3 * (first + a) + i] = (fb_real)(scale[a] * u[i]);
        theta[3 * (first + a) + i] = (fb_real)(scale[a] * turn[i]);
      }
      for (int b = 0; b < SHAPES; b++) {
        double c[3];
        turned(c, R, p[k].chi[pair[a][b]]);
        for (int i = 0; i < 3; i++) {
          chi[3 * ((first + a) * n + first + b) + i] = (fb_real)(scale[a] * scale[b] * c[i]);
        }
      }
    }
    for (int ij = 0; ij < 9; ij++) {
      for (int lm = 0; lm < 9; lm++) {
        full[ij] += R[3 * (ij / 3) + lm / 3] * p[k].J[J_at[lm]] * R[3 * (ij % 3) + lm % 3];
      }
    }
    for (int i = 0; i < 3; i++) {
      J[i] = (fb_real)full[4 * i];
      J[3 + i] = (fb_real)full[i < 2 ? 1 + i : 5];
    }
    if (way == LINE) {
      follow(fields, shape, k, at, R, r, psi, theta);
      require(fb_shape_add_field_lump(shape, &fields[k], (fb_real)p[k].mass, J), "a point of a line");
      if (k == 0) {
        int node;
        require(fb_shape_add_field_node(shape, &node, &fields[k]), "its node");
      }
      continue;
    }
    require(fb_shape_add_particle(shape, (fb_real)p[k].mass, r, psi, chi), "a point");
    require(lumps ? fb_shape_add_lump(shape, FB_R(0.0), r, J, none, theta) : FB_OK, "its inertia");
    if (k == 0) {
      int node;
      require(fb_shape_add_node(shape, &node, r, psi, theta), "its node");
    }
  }
}

/* Modal masses of the points. */
static void make_scales(double scale[SHAPES], const point *p)
{
  static const int J_at[9] = {0, 3, 4, 3, 1, 5, 4, 5, 2};
  for (int a = 0; a < SHAPES; a++) {
    double m = 0;
    for (int k = 0; k < POINTS; k++) {
      for (int i = 0; i < 9; i++) {
        m += i % 4 == 0 ? p[k].mass * p[k].u[a][i / 3] * p[k].u[a][i / 3] : 0;
        m += p[k].turn[a][i / 3] * p[k].J[J_at[i]] * p[k].turn[a][i % 3];
      }
    }
    scale[a] = 1 / sqrt(m);
  }
}

static void write_numbers(FILE *out, const fb_real *x, int n)
{
  for (int i = 0; i < n; i++) {
    fprintf(out, " %.17g", (double)x[i]);
  }
}

/* Lines from point to point, or what a pair's integrals are, or give as geometric stiffness. */
static void write_second_order(FILE *out, const fb_shape *local, int way)
{
  if (way == LINE) {
    fprintf(out, "  line frame %.17g %.17g %.17g 10 11 12\n  line straight 11 13\n  line 12 14\n", begin[0], begin[1],
            begin[2]);
    return;
  }
  for (int a = 0; a < SHAPES; a++) {
    for (int b = a; b < SHAPES; b++) {
      const int ab = a * SHAPES + b;
      const fb_real *const G = local->second.Gamchi + 9 * ab;
      const fb_real spin[6] = {-G[0], -G[4], -G[8], -G[1] - G[3], -G[2] - G[6], -G[5] - G[7]};
      fprintf(out, "  %s %d %d ", way == GEOMETRIC ? "geometric" : "quadratic", a + 1, b + 1);
      write_numbers(out, local->second.pchi + 3 * ab, 3);
      write_numbers(out, local->second.hchi + 3 * ab, 3);
      write_numbers(out, way == GEOMETRIC ? spin : G, way == GEOMETRIC ? 6 : 9);
      fprintf(out, "\n");
    }
  }
}

static void write_component(FILE *out, const point *p, int way)
{
  static fb_shape local;
  static const double here[3] = {0}, as_it_is[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, one[SHAPES] = {1, 1};
  fprintf(out, "  modes 2\n  frequency_hz %.17g %.17g\n", omega[0] / (2 * model_pi), omega[1] / (2 * model_pi));
  for (int k = 0; k < POINTS; k++) {
    fprintf(out, "  node %d %.17g %.17g %.17g  %.17g ", 10 + k, p[k].x[0], p[k].x[1], p[k].x[2], p[k].mass);
    for (int i = 0; i < 6; i++) {
      fprintf(out, " %.17g", p[k].J[i]);
    }
    fprintf(out, "\n");
    for (int a = 0; a < SHAPES; a++) {
      fprintf(out, "  shape %d %d  %.17g %.17g %.17g  %.17g %.17g %.17g\n", a + 1, 10 + k, p[k].u[a][0], p[k].u[a][1],
              p[k].u[a][2], p[k].turn[a][0], p[k].turn[a][1], p[k].turn[a][2]);
    }
  }
  require(fb_shape_init(&local, SHAPES), "the component as it is");
  add_points(&local, p, here, as_it_is, 0, one, 0, QUADRATIC);
  write_second_order(out, &local, way);
  fprintf(out, "  mark 10 point\n");
}

/* (M^-1 C)^2 = 4 zeta^2 M^-1 K where one ratio is that of all modes: of the component, coordinates 4 and 5. */
static void damped_component(double zeta)
{
  const fb_real *const M = model_shape.M;
  const int n = model_shape.n, f = 4;
  double m[4], c[4] = {0}, D[4], k[2], det;
  for (int i = 0; i < 4; i++) {
    m[i] = (double)M[(f + i / 2) * n + f + i % 2];
  }
  for (int a = 0; a < n; a++) {
    if (a >= f && a < f + SHAPES) {
      c[3 * (a - f)] = (double)model_body.C.diagonal[a];
    }
  }
  for (int t = 0; t < model_body.C.n_term; t++) {
    const fb_pair_term *const term = &model_body.C.term[t];
    if (term->a != f + 1 || term->b != f) {
      printf("damping connects the coordinates %d and %d\n", term->a, term->b);
      bad = 1;
    }
    c[1] = c[2] = (double)term->c;
  }
  det = m[0] * m[3] - m[1] * m[2];
  for (int i = 0; i < 4; i++) { /* M^-1 C */
    D[i] = ((i < 2 ? m[3] : -m[2]) * c[i % 2] + (i < 2 ? -m[1] : m[0]) * c[2 + i % 2]) / det;
  }
  for (int a = 0; a < 2; a++) {
    k[a] = omega[a] * omega[a];
  }
  for (int i = 0; i < 4; i++) {
    const double have = D[2 * (i / 2)] * D[i % 2] + D[2 * (i / 2) + 1] * D[2 + i % 2];
    const double inverse = (i == 0 ? m[3] : i == 3 ? m[0] : -m[1]) / det;
    is_near(DAMPED, "(M^-1 C)^2", have, 4 * zeta * zeta * inverse * k[i % 2], 4 * zeta * zeta * k[1], 1e-9);
  }
}

/* A mode of a beam rings down as its part says. */
static void rings_down(int mode, double zeta)
{
  static fb_rk4_work work;
  const double w = sqrt((double)model_shape.K[mode * (model_shape.n + 1)]), wd = w * sqrt(1 - zeta * zeta);
  const fb_input still = {.n_load = 0};
  const int steps = 4000;
  const double dt = 6 * 2 * model_pi / w / steps;
  fb_state state;
  double t;
  require(fb_state_init(&model_body, &state), "state");
  state.q[mode] = FB_R(0.01);
  for (int k = 0; k < steps; k++) {
    require(fb_rk4_step(&model_body, &state, &work, &still, &still, &still, (fb_real)dt), "step");
  }
  t = steps * dt;
  is_near(DAMPED, "a mode that rings down", (double)state.q[mode],
          0.01 * exp(-zeta * w * t) * (cos(wd * t) + zeta * w / wd * sin(wd * t)), 0.01, 1e-4);
}

static void placed(const char *file, int way)
{
  static point points[POINTS];
  static fb_shape shape;
  static fb_beam beam;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_body_work body_work;
  static const double at[3] = {0.7, -1.1, 0.4};
  const double c = cos(0.9), s = sin(0.9), C = cos(-0.4), S = sin(-0.4); /* z, then the turned x */
  const double R[9] = {c, -s * C, s * S, s, c * C, -c * S, 0, S, C};
  const fb_section tube = {.mass = FB_R(0.5), .EI_y = 2000, .EI_z = 3000};
  const fb_beam_desc desc = {
      .length = 8, .n_element = 8, .n_station = 1, .station = {tube}, .position = {FB_R(0.5), 0, FB_R(0.1)}};
  const fb_modes_desc keep = {.count = {2, 2}};
  const fb_real center[3] = {FB_R(0.1), 0, 0}, inertia[6] = {60, 70, 80};
  fb_body_desc level = {.effects = FB_EFFECTS_FULL};
  double scale[SHAPES];
  int node;
  FILE *out = fopen(file, "w");
  if (!out) {
    perror(file);
    exit(1);
  }
  make_points(points);
  make_scales(scale, points);
  fprintf(out, "parts\nhub 400  0.1 0 0  60 70 80\neffects full\nbeam boom\n  length 8\n  elements 8\n");
  fprintf(out,
          "  position 0.5 0 0.1\n  modes bend_y 2 bend_z 2\n  stations x mass EI_y EI_z\n  0 0.5 2000 3000\n  end\n");
  fprintf(out, "  node tip tip\nend\ncomponent wing\n  position 0.7 -1.1 0.4\n  attitude z %.17g x %.17g\n",
          0.9 * 180 / model_pi, -0.4 * 180 / model_pi);
  write_component(out, points, way);
  fprintf(out, "end\n");
  fclose(out);
  read_body(file);
  require(fb_beam_init(&beam, &desc), "beam");
  require(fb_modes_solve(&modes, &modes_work, &beam, &keep), "modes");
  require(fb_shape_init(&shape, 4 + SHAPES), "shape");
  require(fb_shape_add_beam(&shape, 0, &beam, &modes), "beam");
  require(fb_shape_add_beam_node(&shape, &node, 0, &beam, &modes, 8), "node");
  add_points(&shape, points, at, R, 4, scale, 1, way);
  for (int a = 0; a < SHAPES; a++) {
    shape.K[(4 + a) * (4 + SHAPES + 1)] = (fb_real)(omega[a] * omega[a]);
  }
  require(fb_shape_add_rigid(&shape, 400, center, inertia), "hub");
  require(fb_body_init(&by_calls, &body_work, &shape, &level), "body");
  compare(PLACED, &shape, &by_calls);

  /* each part with a damping of its own; the base is held, so that they do not meet */
  model.level.effects |= FB_EFFECT_DAMPING;
  model.level.base = FB_BASE_PRESCRIBED;
  model.part[0].n_damping = model.part[0].n;
  model.part[1].n_damping = 1;
  for (int k = 0; k < FB_MAX_MODES; k++) {
    model.part[0].zeta[k] = k == 1 ? 0.02 : 0.01;
    model.part[1].zeta[k] = 0.03;
  }
  {
    const char *what;
    require(model_build(&what), "with damping");
  }
  damped_component(0.03);
  rings_down(0, 0.01);
  rings_down(1, 0.02);
}

int main(int argc, char **argv)
{
  char file[256], turning[256];
  const char *what;
  snprintf(file, sizeof file, "%s/placed.txt", argc > 1 ? argv[1] : ".");
  two_booms();
  snprintf(turning, sizeof turning, "%s/turning.txt", argc > 1 ? argv[1] : ".");
  wheels(turning);
  for (int way = WAYS - 1; way >= 0; way--) { /* the file of the last one stays */
    placed(file, way);
  }
  read_body("examples/two_booms.txt");
  model.level.base = FB_BASE_PRESCRIBED;
  require(model_build(&what), "two booms, held");
  rings_down(0, 0.005);
  rings_down(4, 0.003);
  printf("file against C calls %.1e, placed component against turned points %.1e, damping by part %.1e, in ROM %.1e, "
         "wheels %.1e\n",
         worst[FILES], worst[PLACED], worst[DAMPED], worst[STEPPED], worst[TURNING]);
  return bad;
}
