/* >>exact, >>trim and >>linear: frequencies, buckling and paths of the exact beam. */
#include "exact.h"

/* ---- sections, ends, units */

/* E10.4 to E10.9 and >>beam: a twisted, tapered blade with every center off the line has the frequencies that the
   beam's natural modes have, which are made another way. */
TEST(spectrum_is_that_of_the_natural_modes)
{
  static fb_beam_desc b;
  static fb_beam model;
  static fb_modes_desc m;
  static fb_modes modes;
  static fb_modes_work modes_work;
  memset(&b, 0, sizeof b);
  memset(&m, 0, sizeof m);
  elastica(FB_MAX_EXACT);
  b.length = FB_R(1.0);
  b.n_element = FB_SINGLE ? 6 : 10;
  b.n_station = desc.n_station = 2;
  for (int k = 0; k < 2; k++) {
    const fb_section section = {k ? FB_R(1.0) : FB_R(0.0),
                                k ? FB_R(0.6) : FB_R(1.0),
                                FB_R(3e3),
                                FB_R(1.4),
                                FB_R(1.0),
                                FB_R(3.0),
                                FB_R(0.002),
                                FB_R(0.004),
                                FB_R(900.0),
                                FB_R(800.0),
                                FB_R(0.0),
                                FB_R(0.01),
                                FB_R(-0.015),
                                FB_R(0.02),
                                FB_R(0.01),
                                FB_R(0.012),
                                FB_R(0.008)};
    b.station[k] = section;
    b.station[k].twist = k ? FB_R(0.5) : FB_R(0.0);
    FBT_INT_EQ(fb_exact_station_init(&desc.station[k], &b.station[k]), FB_OK);
  }
  settle();
  spectrum_of(6);
  FBT_INT_EQ(fb_beam_init(&model, &b), FB_OK);
  m.lowest = 6;
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &model, &m), FB_OK);
  for (int k = 0; k < 6; k++) {
    FBT_NEAR_REL(spectrum.im[k], modes.omega[k], FBT_TOL(2e-3, 1e-2));
    FBT_NEAR_ABS(spectrum.re[k], 0.0, FBT_TOL(1e-8, 1e-2) * (double)modes.omega[k]);
  }
}

/* E10.4 to E10.9, E12.4: N elements of a rod have the wave number of the exact one and the frequency
   2 c/dx tan((2 n - 1) pi / (4 N)), of which a step of the integrator sees 2/dt atan(omega dt/2): the shifts that
   [L] 4.7 read off its histories, at every N, mode and step of the table. */
TEST(a_rod_has_the_dispersion_of_its_mesh_and_its_step)
{
  const fbt_table *t = fbt_reference("p08_box_modes.csv");
  const double rho = 0.098 / 386.4, E = 1e7, G = E / 2.7;
  double worst = 0.0;
  for (int row = 0; row < t->rows; row++) {
    const int torsion = strcmp(fbt_word(t, row, "kind"), "torsion") == 0, n = (int)fbt_value(t, row, "n");
    const double stiffness[6] = {torsion ? 0.0 : E, 0.0, 0.0, torsion ? G : 0.0, 0.0, 0.0};
    const double inertia[6] = {rho, rho, rho, rho, rho, rho}, dt = fbt_value(t, row, "dt");
    double f;
    beam(12.0, (int)fbt_value(t, row, "N"), stiffness, inertia);
    desc.box = 1;
    settle();
    spectrum_of(n);
    f = atan(0.5 * dt * (double)spectrum.im[n - 1]) / (pi * dt);
    FBT_NEAR_REL(f, fbt_value(t, row, "f_pred"), FBT_TOL(1e-10, 1e-4));
    worst = fmax(worst, fabs(f / fbt_value(t, row, "f_pred") - 1.0));
  }
  fbt_figure("axial and torsional frequencies 1 to 4 of 1, 10, 20 elements", "dispersion of mesh and step", worst);
}

/* >>exact, E12.4: frequencies follow the units of time and length, however far from the beam's own they are: of a beam
   that gives way in every direction, in one alone, and of one without mass that carries a body. */
TEST(any_unit_gives_the_same_frequency)
{
  for (int kind = 0; kind < 8; kind++) { /* 1..6: only that strain; 7: light */
    double omega = 0.0;
    for (int u = 0; u < 3; u++) {
      const double t = u == 1 ? FBT_TOL(1e-20, 1e-6) : 1.0, l = u == 2 ? FBT_TOL(1e10, 1e4) : 1.0, f = l / (t * t);
      double stiffness[6], inertia[6];
      for (int i = 0; i < 6; i++) {
        const int gives = kind % 7 == 0 || kind == i + 1;
        stiffness[i] = !gives ? 0.0 : i < 3 ? f : f * l * l;
        inertia[i] = kind == 7 ? 0.0 : i < 3 ? 1.0 / l : 0.1 * l;
      }
      beam(l, kind ? 4 : 1, stiffness, inertia);
      if (kind == 7) {
        desc.n_lump = 1;
        desc.lump[0].node = 4;
        desc.lump[0].mass = FB_R(1.0);
        for (int i = 0; i < 3; i++) {
          desc.lump[0].inertia[i] = (fb_real)(0.1 * l * l);
        }
      }
      start();
      spectrum_of(1);
      omega = u ? omega : (double)spectrum.im[0];
      FBT_BELOW(0.1, omega);
      FBT_NEAR_REL(spectrum.im[0] * (fb_real)t, omega, FBT_TOL(1e-9, 1e-3));
    }
  }
}

/* ---- spectrum */

/* E12.4, E12.5: clamped-free, free-free, pinned-pinned beams, equal frequencies in both planes. */
TEST(spectrum_of_a_straight_beam_is_the_textbooks)
{
  const double bl[3][3] = {{1.8751040687119612, 4.694091132974175, 7.854757438237613},
                           {4.730040744862704, 7.853204624095838, 10.995607838001671},
                           {3.141592653589793, 6.283185307179586, 9.42477796076938}};
  for (int kind = 0; kind < 3; kind++) {
    elastica(40);
    desc.station[0].inertia[21] = FB_R(1e-5); /* torsion is faster */
    if (kind == 1) {
      desc.root = FB_END_FREE;
      start();
    } else {
      desc.root = kind == 2 ? FB_END_PINNED | FB_HOLD_RX : FB_END_CLAMPED;
      desc.tip = kind == 2 ? FB_HOLD_Y | FB_HOLD_Z : FB_END_FREE;
      settle();
    }
    spectrum_of(kind == 1 ? 18 : 6);
    for (int k = 0, at = 0; k < 6; k++, at++) {
      while (at < 17 && (double)spectrum.im[at] < FBT_TOL(1e-3, 2.0)) { /* rigid motions of the free beam */
        at++;
      }
      FBT_NEAR_REL(spectrum.im[at], bl[kind][k / 2] * bl[kind][k / 2], FBT_TOL(1e-4, 2e-2));
      FBT_NEAR_ABS(spectrum.re[at], 0.0, FBT_TOL(1e-9, 1e-2) * bl[kind][k / 2] * bl[kind][k / 2]);
      if (kind == 0) { /* nothing goes as far as the tip turns */
        const fb_real *const re = spectrum.shape_re + 246 * k + 240, *const im = spectrum.shape_im + 246 * k + 240;
        FBT_NEAR_REL(fmax(hypot((double)re[4], (double)im[4]), hypot((double)re[5], (double)im[5])), 1.0,
                     16.0 * (double)FB_EPSILON);
      }
    }
  }
}

/* E12.4, E12.5: a free beam of any mesh has the frequencies of the textbook, its rigid motions disturb none. */
TEST(free_beams_of_any_mesh_have_their_frequencies)
{
  const double bl[3] = {4.730040744862704, 7.853204624095838, 10.995607838001671};
  for (int n = 20; n <= 40; n += 5) {
    elastica(n);
    desc.station[0].inertia[21] = FB_R(1e-5);
    desc.root = FB_END_FREE;
    start();
    spectrum_of(18);
    for (int k = 0, at = 0; k < 6; k++, at++) {
      while (at < 17 && (double)spectrum.im[at] < 2.0) { /* rigid motions */
        at++;
      }
      FBT_NEAR_REL(spectrum.im[at], bl[k / 2] * bl[k / 2], FBT_TOL(1e-4, 3e-4));
    }
  }
}

/* E12.4: the shapes of a free arc are symmetric or the opposite: both ends move as far in each of their own directions. */
TEST(free_arcs_move_as_far_at_both_ends)
{
  int seen = 0;
  elastica(12);
  desc.station[0].inertia[21] = FB_R(1e-5);
  desc.station[0].curvature[2] = FB_R(4.0);
  desc.root = FB_END_FREE;
  start();
  spectrum_of(18);
  for (int k = 0; k < spectrum.n; k++) {
    const int tip = 6 * desc.n_element;
    const fb_real *const re = spectrum.shape_re + (tip + 6) * k, *const im = spectrum.shape_im + (tip + 6) * k;
    for (int i = 0; i < 3 && (double)spectrum.im[k] > 2.0; i++) {
      FBT_NEAR_ABS(hypot((double)re[i], (double)im[i]), hypot((double)re[tip + i], (double)im[tip + i]),
                   FBT_TOL(1e-8, 1e-3));
      seen += i == 0 && hypot((double)re[0], (double)im[0]) > 0.01;
    }
  }
  FBT_TRUE(seen >= 2);
}

/* E10.5: stations that lie anywhere within an element do not count as more than what they turn it: a line that starts
   to bend just before a node, and one that hardly stops in between. */
TEST(curvature_may_jump_beside_a_node)
{
  const double place[2][4] = {{0.0, 0.4999, 0.5, 1.0}, {0.0, 0.5, 0.5001, 1.0}};
  for (int run = 0; run < 2; run++) {
    elastica(4);
    desc.n_station = 4;
    for (int k = 0; k < 4; k++) {
      desc.station[k] = desc.station[0];
      desc.station[k].x = (fb_real)place[run][k];
      desc.station[k].curvature[2] = (k < 2) == run ? FB_R(16.0) : FB_R(0.0);
    }
    FBT_INT_EQ(fb_exact_init(&exact, &desc), FB_ERR_VALUE); /* 4 rad in an element all the same */
    for (int k = 0; k < 4; k++) {
      desc.station[k].curvature[2] *= FB_R(0.7); /* 2.8 */
    }
    settle();
    FBT_NEAR_ABS(cos(2.0 * atan2((double)node[4].quat[3], (double)node[4].quat[0])), cos(11.2 * 0.50005),
                 FBT_TOL(1e-9, 1e-5));
  }
  elastica(4); /* a narrow peak at a node */
  desc.n_station = 5;
  for (int k = 0; k < 5; k++) {
    const double peak[5] = {0.0, 0.499, 0.5, 0.501, 1.0};
    desc.station[k] = desc.station[0];
    desc.station[k].x = (fb_real)peak[k];
    desc.station[k].curvature[2] = k == 2 ? FB_R(100.0) : FB_R(0.0);
  }
  settle();
  FBT_NEAR_ABS(2.0 * atan2((double)node[4].quat[3], (double)node[4].quat[0]), 0.1, FBT_TOL(1e-9, 1e-5));
}

/* E10.6: the header's figures of an element that is built as an arc of 15, 45 and 90 degrees: flexibility at its end to
   forces in its plane and across, int of the arms squared. */
TEST(an_element_that_turns_is_as_stiff_as_the_header_says)
{
  const double turn[3] = {15.0, 45.0, 90.0}, in_plane[3] = {5.9e-4, 6.25e-3, 5.1e-2}, out[3] = {8.7e-4, 7.9e-3, 3.2e-2};
  for (int run = 0; run < 12; run++) {
    const double phi = turn[run % 3] * pi / 180.0, f = FBT_TOL(1e-7, 1e-3);
    const int across = run / 3 % 2, n = 1 + run / 6;
    const double bound = across ? out[run % 3] : in_plane[run % 3];
    double closed_form = 0.0, error;
    elastica(n);
    desc.station[0].curvature[2] = (fb_real)phi;
    load_tip(FB_AXES_INERTIAL, 0.0, across ? 0.0 : f, across ? f : 0.0);
    settle();
    for (int i = 0; i < 2000; i++) {
      const double s = (i + 0.5) / 2000.0, x = (sin(phi) - sin(phi * s)) / phi, y = (cos(phi * s) - cos(phi)) / phi;
      closed_form += (x * x + (across ? y * y : 0.0)) / 2000.0;
    }
    error = 1.0 - (double)node[n].displacement[across ? 2 : 1] / (f * closed_form);
    if (n == 1) {
      FBT_BELOW(error, bound + FBT_TOL(0.0, 2e-3));
      FBT_BELOW(0.95 * bound - FBT_TOL(0.0, 2e-3), error);
    } else {
      FBT_BELOW(fabs(error), bound / 12.0 + FBT_TOL(0.0, 2e-3)); /* order 4 */
    }
  }
}

/* E10.6, E12.4: shear takes the frequencies of a hinged beam to order 2, as the header says. */
TEST(shear_takes_frequencies_to_order_two)
{
  double error[2];
  for (int run = 0; run < 2; run++) {
    elastica(10 << run);
    desc.station[0].stiffness[7] = desc.station[0].stiffness[14] = FB_R(200.0);
    desc.station[0].inertia[21] = FB_R(1e-5);
    desc.root = FB_END_PINNED | FB_HOLD_RX;
    desc.tip = FB_HOLD_Y | FB_HOLD_Z;
    settle();
    spectrum_of(2);
    error[run] = (double)spectrum.im[0] / (pi * pi / sqrt(1.0 + pi * pi / 200.0)) - 1.0;
  }
  FBT_NEAR_REL(error[0], 2.0e-4, FBT_TOL(0.03, 0.1));
  FBT_NEAR_REL(error[1], 4.9e-5, FBT_TOL(0.02, 0.2));
}

/* E10.6, E12.4: Timoshenko cantilevers and free beams with rotary inertia, slender and stocky, of twenty elements:
   p01_timoshenko.csv. Of order 2, with the box, too, which keeps inertia along and about the line alone. */
TEST(timoshenko_beams_have_their_frequencies)
{
  const fbt_table *t = fbt_reference("p01_timoshenko.csv");
  double error[2][2] = {{0.0}};
  for (int row = 0; row < t->rows; row++) {
    const double ratio = fbt_value(t, row, "L_over_h"), r2 = 1.0 / (12.0 * ratio * ratio);
    const double GA = fbt_value(t, row, "kappa") / (2.0 * (1.0 + fbt_value(t, row, "nu"))) / r2;
    const int mode = (int)fbt_value(t, row, "mode"), is_free = strcmp(fbt_word(t, row, "bc"), "ff") == 0;
    const double stiffness[6] = {1.0 / r2, 5.0 * GA, GA, 0.0, 1.0, 9.0};
    const double inertia[6] = {1.0, 1.0, 1.0, 1e-5, r2, r2};
    for (int run = 0; run < 4 && mode <= 2 && !is_free; run++) {
      double nearest = 1.0;
      beam(1.0, 20 << run % 2, stiffness, inertia);
      desc.box = run / 2;
      settle();
      spectrum_of(8);
      for (int k = 0; k < spectrum.n; k++) {
        nearest = fmin(nearest, fabs((double)spectrum.im[k] / fbt_value(t, row, "freq") - 1.0));
      }
      FBT_BELOW(nearest, (run % 2 ? 1e-4 : 4e-4) + FBT_TOL(0.0, 1e-2));
      error[run / 2][run % 2] = fmax(error[run / 2][run % 2], nearest);
    }
  }
  for (int box = 0; box < 2; box++) {
    FBT_NEAR_REL(error[box][0] / error[box][1], 4.0, FBT_TOL(0.05, 0.9));
  }
  fbt_figure("Timoshenko cantilevers of 20 elements, two frequencies", "transfer matrix (p01)", error[0][0]);
}

/* E10.6, E12.4: torsion of a clamped rod is of order 4 in the mesh, of the box of the dispersion 2 c/h tan(k h/2). */
TEST(twist_is_of_order_four)
{
  const double stiffness[6] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0}, inertia[6] = {1.0, 1.0, 1.0, 0.04, 0.02, 0.02};
  for (int mode = 0; mode < 2; mode++) {
    const double k = (2.0 * mode + 1.0) * pi / 2.0;
    double error[2];
    for (int run = 0; run < 4; run++) {
      const int n = 5 << run % 2;
      beam(1.0, n, stiffness, inertia);
      desc.box = run / 2;
      settle();
      spectrum_of(2);
      if (desc.box) {
        FBT_NEAR_REL(spectrum.im[mode], 5.0 * 2.0 * n * tan(k / (2.0 * n)), FBT_TOL(1e-10, 1e-3));
      } else {
        error[run] = (double)spectrum.im[mode] / (5.0 * k) - 1.0;
      }
    }
    FBT_DOUBLE_ONLY("rounding of single precision is as large")
    {
      FBT_NEAR_REL(error[0], -pow(k / 5.0, 4.0) / 480.0, 0.1); /* dispersion, leading term */
      FBT_NEAR_REL(error[0] / error[1], 16.0, 0.1);
    }
  }
}

/* E10.6, E12.4: the first four frequencies of a slender cantilever of eight elements. */
TEST(eight_elements_have_four_frequencies)
{
  const double root[4] = {1.8751040687119611, 4.694091132974175, 7.8547574382376126, 10.995540734875467};
  const double bound[4] = {3.3e-6, 1.3e-4, 1e-3, 3.8e-3};
  elastica(8);
  desc.station[0].inertia[21] = FB_R(1e-5);
  settle();
  spectrum_of(8);
  for (int k = 0; k < 4; k++) { /* one plane and the other */
    FBT_NEAR_REL(spectrum.im[2 * k], root[k] * root[k], bound[k] + FBT_TOL(0.0, 2e-2));
    FBT_NEAR_REL(spectrum.im[2 * k + 1], root[k] * root[k], bound[k] + FBT_TOL(0.0, 2e-2));
  }
}

/* E10.9, E10.28, E12.4: a conservative beam that spins with its mass ahead of or behind its line neither grows nor decays,
   at any mesh, sign of spin and offset: the linearized beam is Hamiltonian. */
TEST(spinning_beams_with_their_mass_ahead_are_stable)
{
  for (int run = 0; run < 16; run++) {
    const int n = 5 << run / 4;
    mass_ahead(n, run % 2 ? 0.1 : -0.1, run / 2 % 2 ? 20.0 : -20.0);
    settle();
    FBT_INT_EQ(work.unstable, 0);
    spectrum_of(6);
    for (int k = 0; k < 6; k++) {
      FBT_BELOW(fabs((double)spectrum.re[k]), FBT_TOL(1e-12, 1e-5) * (double)spectrum.im[k]);
    }
    FBT_NEAR_REL(spectrum.im[2], 178.0583, 0.22 / (n * n) + FBT_TOL(1e-5, 1e-2));
  }
}

/* E10.6, E10.9, E12.4: nor does one whose rotary inertia has all products and a center off the line. */
TEST(spinning_beams_of_any_inertia_are_stable)
{
  static const double own[9] = {0.02, 0.004, -0.003, 0.004, 0.012, 0.005, -0.003, 0.005, 0.015};
  for (int run = 0; run < 16; run++) {
    const double m = 0.5, c[3] = {0.0, run % 2 ? 0.1 : -0.1, 0.04};
    fb_real *const M = desc.station[0].inertia;
    mass_ahead(5 << run / 4, 0.0, run / 2 % 2 ? 20.0 : -20.0);
    desc.box = (run + run / 2) % 2;
    desc.station[0].stiffness[7] = desc.station[0].stiffness[14] = FB_R(5e4);
    M[4] = M[24] = (fb_real)(m * c[2]);
    M[5] = M[30] = (fb_real)(-m * c[1]);
    M[15] = M[20] = (fb_real)(m * c[1]);
    M[9] = M[19] = (fb_real)(-m * c[2]);
    for (int i = 0; i < 9; i++) {
      const int a = i / 3, b = i % 3;
      const double square = a == b ? c[1] * c[1] + c[2] * c[2] : 0.0;
      M[21 + 6 * a + b] = (fb_real)(own[i] + m * (square - c[a] * c[b]));
    }
    settle();
    FBT_INT_EQ(work.unstable, 0);
    spectrum_of(6);
    for (int k = 0; k < 6; k++) {
      FBT_BELOW(fabs((double)spectrum.re[k]), FBT_TOL(1e-12, 1e-5) * (double)spectrum.im[k]);
    }
  }
}

/* E10.6, E12.4: frequencies of a straight beam are of order 4 in the mesh. */
TEST(frequencies_of_a_straight_beam_are_of_order_four)
{
  double error[2];
  for (int run = 0; run < 2; run++) {
    elastica(10 << run);
    desc.station[0].inertia[21] = FB_R(1e-5);
    settle();
    spectrum_of(4);
    error[run] = (double)spectrum.im[2] / (4.694091132974175 * 4.694091132974175) - 1.0;
  }
  FBT_BELOW(fabs(error[1]), FBT_TOL(1e-4, 2e-2));
  FBT_NEAR_REL(error[0] / error[1], 16.0, FBT_TOL(0.1, 0.3)); /* order 3 or 5: 8, 32 */
}

/* E12.4, E10.14: a body with products of mass and place at the tip of a beam without mass has the six frequencies of
   its 6x6 stiffness and inertia: det(K - omega^2 M) = 0 by 2x2 blocks, K of the tip of a cantilever. */
TEST(a_body_on_a_light_beam_rings_in_closed_form)
{
  const double L = 1.5, EA = 300.0, GJ = 4.0, EI[2] = {7.0, 5.0}, m = 0.8, J[3] = {0.05, 0.04, 0.06};
  const double stiffness[6] = {EA, 0.0, 0.0, GJ, EI[0], EI[1]};
  double want[6], last = 0.0;
  beam(L, 4, stiffness, NULL);
  desc.n_lump = 1;
  desc.lump[0].node = 4;
  desc.lump[0].mass = (fb_real)m;
  for (int i = 0; i < 3; i++) {
    desc.lump[0].inertia[i] = (fb_real)J[i];
  }
  settle();
  want[0] = sqrt(EA / (L * m));
  want[1] = sqrt(GJ / (L * J[0]));
  for (int i = 0; i < 2; i++) { /* in y: EI_z, J_z */
    const double k = EI[1 - i] / (L * L * L), c = k * L * 6.0, r = k * L * L * 4.0, inertia = J[2 - i];
    const double p = 12.0 * k / m + r / inertia, q = (12.0 * k * r - c * c) / (m * inertia);
    want[2 + 2 * i] = sqrt(0.5 * p - sqrt(0.25 * p * p - q));
    want[3 + 2 * i] = sqrt(0.5 * p + sqrt(0.25 * p * p - q));
  }
  spectrum_of(6);
  for (int k = 0; k < 6; k++) { /* in ascending order */
    double next = HUGE_VAL;
    for (int i = 0; i < 6; i++) {
      next = want[i] > last && want[i] < next ? want[i] : next;
    }
    FBT_NEAR_REL(spectrum.im[k], next, FBT_TOL(1e-8, 1e-3));
    FBT_NEAR_ABS(spectrum.re[k], 0.0, FBT_TOL(1e-8, 1e-2));
    last = next;
  }
  for (int count = 7; count <= FB_EXACT_MODES; count++) { /* there are no more */
    FBT_INT_EQ(fb_exact_spectrum_solve(&exact, &spectrum_work, &spectrum, &state, &input, count), FB_ERR_MODES);
  }
  elastica(4); /* without inertia there is none */
  memset(desc.station[0].inertia, 0, sizeof desc.station[0].inertia);
  settle();
  FBT_INT_EQ(fb_exact_spectrum_solve(&exact, &spectrum_work, &spectrum, &state, NULL, 1), FB_ERR_MODES);
}

/* E12.4, E10.10: two bodies off the line of a stiff bar, on its middle, which slides along the axis of its spin W and
   swings about z: omega^2 = W^2 (sum m c^2 - J)/(sum m c^2 + J - (sum m c)^2/mass), J of the bar. Their loads on what
   holds the node turn with it, and have no part in this. */
TEST(bodies_swing_on_a_spinning_slide_in_closed_form)
{
  const double k = FBT_TOL(1e7, 1e3), stiffness[6] = {k, k, k, k, k, k}, inertia[6] = {0.4, 0.4, 0.4, 0.0, 0.0, 0.0};
  const double m[2] = {0.3, 0.5}, c[2] = {0.5, 0.4}, W = 1.5, J = 0.4 / 12.0;
  const double square = m[0] * c[0] * c[0] + m[1] * c[1] * c[1], first = m[0] * c[0] + m[1] * c[1];
  int swings = 0;
  beam(1.0, 2, stiffness, inertia);
  desc.root = FB_END_FREE;
  desc.n_support = 1;
  desc.support[0].node = 1;
  desc.support[0].held = FB_END_CLAMPED & ~FB_HOLD_X & ~FB_HOLD_RZ;
  desc.n_lump = 2;
  for (int l = 0; l < 2; l++) {
    desc.lump[l].node = 1;
    desc.lump[l].mass = (fb_real)m[l];
    desc.lump[l].center[1] = (fb_real)c[l];
    desc.lump[l].center[2] = (fb_real)(0.3 - 0.2 * l);
  }
  input.w[0] = (fb_real)W;
  start();
  spectrum_of(2);
  for (int i = 0; i < 2; i++) {
    if (spectrum.im[i] > FB_R(0.5)) { /* the other slides */
      FBT_NEAR_REL(spectrum.im[i], W * sqrt((square - J) / (square + J - first * first / (m[0] + m[1] + 0.4))),
                   FBT_TOL(1e-5, 1e-2));
      swings++;
    }
  }
  FBT_INT_EQ(swings, 1);
}

/* E12.5: whatever their number, the slowest motions are the same (artefacts of the basis are not among them). */
TEST(spectrum_does_not_depend_on_the_count)
{
  double omega[12];
  for (int count = 12; count >= 1; count--) {
    const double stiffness[6] = {20.0, 7.4, 7.4, 1.7, 1.0 / 6.0, 2.0 / 3.0};
    const double inertia[6] = {2.0, 2.0, 2.0, 5.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0};
    beam(12.0, 10, stiffness, inertia);
    settle();
    spectrum_of(count);
    for (int k = 0; k < count; k++) {
      omega[k] = count == 12 ? (double)spectrum.im[k] : omega[k];
      FBT_NEAR_REL(spectrum.im[k], omega[k], FBT_TOL(1e-6, 1e-2));
    }
  }
}

/* E10.9, E12.4: Beck's column under a tangential tip load flutters where its first two frequencies meet; below it, the
   frequencies. */
TEST(becks_column_flutters_at_its_load)
{
  const fbt_table *t = fbt_reference("p06_beck.csv");
  double low = 15.0, high = 25.0;
  for (int row = 0; row < t->rows; row++) {
    const double mu = fbt_value(t, row, "mu"), p = fbt_value(t, row, "p");
    const int mode = (int)fbt_value(t, row, "mode");
    if (fbt_value(t, row, "gam") < 1.0 || p > 20.0) {
      continue;
    }
    if (mode == 1) {
      elastica(20);
      desc.tip = FB_HOLD_Z;
      desc.n_lump = mu > 0.0;
      desc.lump[0].node = 20;
      desc.lump[0].mass = (fb_real)mu;
      load_tip(FB_AXES_NODE, -p, 0.0, 0.0);
      settle();
    }
    spectrum_of(10);
    {
      double best = 1e9; /* the other plane's, held at the tip, are among them */
      for (int k = 0; k < 10; k++) {
        best = fmin(best, hypot((double)spectrum.im[k] - fbt_value(t, row, "om_re"),
                                fabs((double)spectrum.re[k]) - fbt_value(t, row, "om_im")));
      }
      FBT_BELOW(best / fbt_value(t, row, "om_re"), FBT_TOL(p < 19.9 ? 2e-3 : 1e-2, 3e-2)); /* steep at flutter */
    }
  }
  while (high - low > 1e-3) {
    const double p = 0.5 * (low + high);
    double growth = -1.0;
    elastica(20);
    desc.tip = FB_HOLD_Z;
    load_tip(FB_AXES_NODE, -p, 0.0, 0.0);
    settle();
    spectrum_of(4);
    for (int k = 0; k < 4; k++) {
      growth = fmax(growth, fabs((double)spectrum.re[k]));
    }
    low = growth < FBT_TOL(1e-3, 0.1) ? p : low;
    high = growth < FBT_TOL(1e-3, 0.1) ? high : p;
  }
  FBT_NEAR_REL(low, 20.0509536, FBT_TOL(1e-3, 5e-3));
  fbt_figure("Beck's flutter load, 20 elements, relative", "20.0509536", fabs(low / 20.0509536 - 1.0));
}

/* E12.4: gyroscopic whirl of a shaft with rotary inertia, seen from the turning base: each frequency less the spin. */
TEST(shaft_whirls_as_in_closed_form)
{
  const fbt_table *t = fbt_reference("p06_shaft_whirl.csv");
  for (int row = 0; row < t->rows; row++) {
    const double r = fbt_value(t, row, "r_over_L"), spin = fbt_value(t, row, "Om"), r2 = r * r;
    const double way[2] = {fbt_value(t, row, "forward") - spin, fbt_value(t, row, "backward") + spin};
    const double inertia[6] = {1.0, 1.0, 1.0, 2.0 * r2, r2, r2}, stiffness[6] = {0.0, 0.0, 0.0, 0.0, 1.0, 1.0};
    beam(1.0, 40, stiffness, inertia);
    desc.root = FB_END_PINNED | FB_HOLD_RX;
    desc.tip = FB_HOLD_Y | FB_HOLD_Z;
    input.w[0] = (fb_real)spin;
    settle();
    spectrum_of(8);
    for (int i = 0; i < 2; i++) {
      double best = 1e9;
      for (int k = 0; k < 8; k++) {
        best = fmin(best, fabs((double)spectrum.im[k] - fabs(way[i])));
      }
      FBT_BELOW(best / fbt_value(t, row, "forward"), FBT_TOL(2e-3, 1e-2));
    }
  }
}

/* E12.4: a shaft that spins whirls on circles: in every mode each node moves along y as far as along z, a quarter turn
   apart. */
TEST(whirling_shafts_move_on_circles)
{
  const double stiffness[6] = {0.0, 0.0, 0.0, 0.0, 1.0, 1.0}, inertia[6] = {1.0, 1.0, 1.0, 0.02, 0.01, 0.01};
  beam(1.0, 10, stiffness, inertia);
  desc.root = FB_END_PINNED | FB_HOLD_RX;
  desc.tip = FB_HOLD_Y | FB_HOLD_Z;
  input.w[0] = FB_R(5.0);
  settle();
  spectrum_of(4);
  for (int k = 0; k < 4; k++) {
    double most = 0.0;
    for (int j = 0; j <= 10; j++) {
      const fb_real *const re = spectrum.shape_re + 66 * k + 6 * j, *const im = spectrum.shape_im + 66 * k + 6 * j;
      const double y = hypot((double)re[1], (double)im[1]), z = hypot((double)re[2], (double)im[2]);
      FBT_NEAR_ABS(y, z, FBT_TOL(1e-7, 3e-2));
      FBT_NEAR_ABS(re[1] * re[2] + im[1] * im[2], 0.0, FBT_TOL(1e-7, 3e-2));
      most = fmax(most, y);
    }
    FBT_BELOW(0.1, most);
  }
}

/* E12.4 about a steady rotation: flap and lag of the spinning cantilever. */
TEST(spinning_cantilever_has_the_published_frequencies)
{
  const fbt_table *t = fbt_reference("p02_rotating_uniform.csv");
  for (int row = 0; row < t->rows; row++) {
    const double eta = fbt_value(t, row, "eta"), hub = fbt_value(t, row, "alpha");
    const double stiffness[6] = {1e8, 0.0, 0.0, 0.0, 1.0, 1.0}, inertia[6] = {1.0, 1.0, 1.0, 0.0, 0.0, 0.0};
    double flap = 1e9, lag = 1e9;
    if (eta > 12.5 || (int)fbt_value(t, row, "mode") > 2) {
      continue;
    }
    if ((int)fbt_value(t, row, "mode") == 1) {
      beam(1.0, 40, stiffness, inertia);
      desc.position[0] = (fb_real)hub;
      input.w[2] = (fb_real)eta;
      settle();
      spectrum_of(5);
    }
    for (int k = 0; k < 5; k++) {
      flap = fmin(flap, fabs((double)spectrum.im[k] - fbt_value(t, row, "mu_flap")));
      lag = fmin(lag, fabs((double)spectrum.im[k] - fbt_value(t, row, "mu_lag")));
    }
    FBT_BELOW(flap / fbt_value(t, row, "mu_flap"), FBT_TOL(5e-4, 5e-2));
    FBT_BELOW(lag / fbt_value(t, row, "mu_lag"), FBT_TOL(5e-4, 5e-2));
  }
}

/* Middle against the line between the ends, across it, in the plane of inertial x and y. */
static double bow(const fb_real *root, const fb_real *middle, const fb_real *tip)
{
  const double x = (double)tip[0] - (double)root[0], y = (double)tip[1] - (double)root[1];
  const double along = (double)middle[0] - (double)root[0], up = (double)middle[1] - (double)root[1];
  return (x * up - y * along) / hypot(x, y);
}

/* Bodies on root, middle and tip of a beam of n elements. */
static void three_lumps(fb_lump *lump, int n)
{
  static const double mass[3] = {0.6, 0.9, 0.2}, aside[3] = {0.0, 0.1, -0.05};
  for (int k = 0; k < 3; k++) {
    memset(&lump[k], 0, sizeof lump[k]);
    lump[k].node = k * n / 2;
    lump[k].mass = (fb_real)mass[k];
    lump[k].center[1] = (fb_real)aside[k];
    lump[k].inertia[0] = lump[k].inertia[1] = lump[k].inertia[2] = FB_R(0.01);
  }
}

/* A free beam's body of natural modes with the nodes root, middle, tip; and its state at rest where the beam lies along
   the inertial x. elsewhere: with lumps, in a frame off it and askew. */
static void free_body(fb_body *body, fb_state *at_rest, double length, int modes_y, int elsewhere)
{
  static fb_beam_desc line;
  static fb_beam built;
  static fb_modes modes;
  static fb_modes_work modes_work;
  static fb_shape shape;
  static fb_body_work body_work;
  const double askew[3] = {0.4, -0.7, 1.1}, off[3] = {0.3, -0.4, 0.2};
  fb_real R[9], root[3], turn[3];
  fb_modes_desc keep;
  fb_body_desc level;
  int at;
  memset(&line, 0, sizeof line);
  memset(&keep, 0, sizeof keep);
  memset(&level, 0, sizeof level);
  line.length = (fb_real)length;
  line.n_element = 6;
  line.root = FB_ROOT_FREE;
  line.n_station = 1;
  line.station[0].mass = FB_R(1.0);
  line.station[0].EI_y = line.station[0].EI_z = FB_R(25.0);
  line.station[0].i_y = line.station[0].i_z = FB_R(0.01);
  keep.count[FB_KIND_BEND_Y] = modes_y;
  level.effects = FB_EFFECTS_FULL;
  line.n_lump = 3 * elsewhere;
  if (elsewhere) {
    three_lumps(line.lump, line.n_element);
  }
  for (int i = 0; i < 3; i++) {
    turn[i] = (fb_real)(elsewhere * askew[i]);
    line.position[i] = (fb_real)(elsewhere * off[i]);
  }
  fb_quat_from_rotvec(line.attitude, turn);
  FBT_INT_EQ(fb_beam_init(&built, &line), FB_OK);
  FBT_INT_EQ(fb_modes_solve(&modes, &modes_work, &built, &keep), FB_OK);
  FBT_INT_EQ(fb_shape_init(&shape, modes.n), FB_OK);
  FBT_INT_EQ(fb_shape_add_beam(&shape, 0, &built, &modes), FB_OK);
  for (int k = 0; k < 3; k++) {
    FBT_INT_EQ(fb_shape_add_beam_node(&shape, &at, 0, &built, &modes, (fb_real)(0.5 * k * length)), FB_OK);
  }
  FBT_INT_EQ(fb_body_init(body, &body_work, &shape, &level), FB_OK);
  FBT_INT_EQ(fb_state_init(body, at_rest), FB_OK);
  fb_quat_to_mat33(R, line.attitude);
  fb_mat33_mulT_vec3(root, R, line.position);
  for (int i = 0; i < 4; i++) {
    at_rest->quat[i] = i ? -line.attitude[i] : line.attitude[0];
    at_rest->rho[i % 3] = -root[i % 3];
  }
}

/* E8.32: a free beam that is pushed aside at its tip for half a second: its modes with the quadratic field about the
   mass center bend as the exact beam does (with a field from the root on they are off by half of it). */
static double free_beam_apart(int elsewhere)
{
  static fb_body body;
  static fb_state at;
  static fb_rk4_work rk4;
  static fb_motion rest; /* positions want no velocities */
  const double stiffness[6] = {0.0, 0.0, 0.0, 0.0, 25.0, 25.0}, inertia[6] = {1.0, 1.0, 1.0, 0.02, 0.01, 0.01};
  const double dt = 2.5e-3, L = 3.0;
  fb_input push;
  double worst = 0.0, most = 0.0;
  free_body(&body, &at, L, 3, elsewhere);
  beam(L, 20, stiffness, inertia);
  desc.root = FB_END_FREE;
  desc.n_lump = 3 * elsewhere;
  if (elsewhere) {
    three_lumps(desc.lump, desc.n_element);
  }
  load_tip(FB_AXES_INERTIAL, 0.0, 3.0, 0.0);
  start();
  memset(&push, 0, sizeof push);
  push.n_load = 1;
  push.load[0].node = 3;
  push.load[0].force[1] = FB_R(3.0);
  for (int k = 1; k <= 800; k++) {
    fb_node_motion seen[3];
    double judge, modal;
    input.n_load = push.n_load = k <= 200;
    FBT_INT_EQ(fb_exact_step(&exact, &state, &work, &input, (fb_real)dt), FB_OK);
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    for (int half = 0; half < 2; half++) {
      FBT_INT_EQ(fb_rk4_step(&body, &at, &rk4, &push, &push, &push, (fb_real)(0.5 * dt)), FB_OK);
    }
    for (int i = 0; i < 3; i++) {
      FBT_INT_EQ(fb_body_node_motion_eval(&body, &seen[i], &at, &rest, i + 1), FB_OK);
    }
    judge = bow(node[0].position, node[10].position, node[20].position);
    modal = bow(seen[0].position, seen[1].position, seen[2].position);
    worst = fmax(worst, fabs(modal - judge));
    most = fmax(most, fabs(judge));
  }
  FBT_BELOW(0.01 * L, most);
  return worst / most;
}

/* E8.32: the field about the mass center, along the axes and elsewhere. */
TEST(a_free_beam_swings_as_the_exact_one)
{
  const double apart = free_beam_apart(0);
  FBT_BELOW(apart, 0.03);
  fbt_figure("free beam pushed at its tip, bow of 3 modes / its largest", "geometrically exact beam", apart);
  FBT_BELOW(free_beam_apart(1), 0.03);
}

/* E10.11: a column under a dead load: unstable beyond Euler's, and the bent states beyond it. */
TEST(columns_buckle_at_eulers_load)
{
  const fbt_table *t = fbt_reference("p06_euler.csv");
  for (int row = 4; row < t->rows; row++) { /* extensible, shearable */
    const double EA = row == 4 ? 1000.0 : 200.0, GA = 0.4 * EA, critical = fbt_value(t, row, "p_cr");
    const double stiffness[6] = {EA, GA, GA, 1.0, 1.0, 1.0}, inertia[6] = {1.0, 1.0, 1.0, 1e-3, 0.0, 0.0};
    for (int beyond = 0; beyond < 2; beyond++) {
      double growth = 0.0;
      beam(1.0, 20, stiffness, inertia);
      load_tip(FB_AXES_INERTIAL, -critical * (beyond ? 1.0 + FBT_TOL(5e-5, 1e-2) : 1.0 - FBT_TOL(5e-5, 1e-2)), 0.0,
               0.0);
      settle();
      spectrum_of(4); /* beyond: growing and decaying in both planes, all as fast as each other */
      for (int k = 0; k < spectrum.n; k++) {
        growth = fmax(growth, (double)spectrum.re[k]);
      }
      FBT_TRUE(beyond ? growth > 1e-3 : (double)spectrum.im[0] > 1e-3);
    }
  }
  t = fbt_reference("p06_postbuckling.csv");
  for (int row = 1; row < t->rows; row++) {
    const double P = fbt_value(t, row, "PL2_EI");
    elastica(40);
    desc.station[0].stiffness[28] = FB_R(2.0); /* across, or the bent column turns about its load as it likes */
    load_tip(FB_AXES_INERTIAL, 0.0, 0.05, 0.0);
    settle();
    for (int k = 1; k <= 21; k++) { /* pressed, pushed aside a little, and at last let go */
      input.load[0].force[0] = (fb_real)(-P * (k < 20 ? k / 20.0 : 1.0));
      input.load[0].force[1] = k < 21 ? FB_R(0.05) : FB_R(0.0);
      FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_OK);
    }
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    FBT_NEAR_ABS(node[40].position[0], fbt_value(t, row, "x_tip"), FBT_TOL(1e-5, 2e-3));
    FBT_NEAR_ABS(fabs((double)node[40].position[1]), fbt_value(t, row, "y_tip"), FBT_TOL(1e-5, 2e-3)); /* either side */
  }
}

/* E10.19, E10.20: a straight column under a dead load at its tip is left in as many ways as it has buckling loads
   below: in two planes, with its ends held as may be, rigid in stretch and shear or as stiff as its bending wants;
   under a follower load, in none. */
TEST(columns_have_as_many_unstable_directions_as_loads_exceeded)
{
  static const int root[3] = {FB_END_CLAMPED, FB_END_PINNED | FB_HOLD_RX, FB_END_CLAMPED};
  static const int tip[3] = {FB_END_FREE, FB_HOLD_Y | FB_HOLD_Z, FB_END_CLAMPED & ~FB_HOLD_X};
  int most = 0;
  for (int run = 0; run < 48; run++) {
    const int held = run % 3, follower = held == 0 && run >= 24, upright = held == 1 && run >= 24;
    const double p = 1.5 * pow(1.5, run / 3), other = 1.7;
    int expected = 0;
    elastica(20);
    if (run % 2) {
      desc.station[0].stiffness[0] = FBT_TOL(1e8, 1e5);
      desc.station[0].stiffness[7] = desc.station[0].stiffness[14] = FBT_TOL(1e7, 1e4);
    }
    desc.station[0].stiffness[28] = (fb_real)other;
    desc.root = root[held];
    desc.tip = upright ? FB_HOLD_X | FB_HOLD_Z : tip[held];
    desc.attitude[0] = desc.attitude[3] = upright ? FB_R(0.7071067811865476) : FB_R(0.0);
    load_tip(follower ? FB_AXES_NODE : FB_AXES_INERTIAL, upright ? 0.0 : -p, upright ? -p : 0.0, 0.0);
    settle();
    for (int k = 1; k < 9 && !follower; k++) {
      const double odd = (k - 0.5) * pi, whole = k * pi;
      /* clamped at both ends: sin u = 0 or tan u = u, u half of root p */
      static const double tangent[3] = {4.493409457909064, 7.725251836937707, 10.904121659428899};
      const double both = k % 2 ? (k + 1) * pi : k < 7 ? 2.0 * tangent[k / 2 - 1] : 1e9;
      const double u = held == 0 ? odd : held == 1 ? whole : both;
      expected += (p > u * u) + (p > other * u * u);
    }
    FBT_INT_EQ(work.unstable, expected);
    most = most < expected ? expected : most;
  }
  FBT_INT_EQ(most, 14);
}

/* E10.19, E10.20: so is one that bends in one plane alone, its other strains rigid or some of them, whose blocks have
   zeros and rounding on their diagonal. */
TEST(rigid_strains_are_no_unstable_directions)
{
  for (int run = 0; run < 64; run++) {
    const double part = run % 2 ? 1.1 : 0.9, p = part * 0.25 * pi * pi;
    elastica(run < 32 ? 10 : 3);
    for (int i = 0; i < 4; i++) { /* stretch, shear, torsion, bending out of plane; 0 is rigid */
      static const int at[4] = {0, 14, 21, 28};
      static const double stiff[4] = {1e4, 1e3, 0.7, 1e3};
      desc.station[0].stiffness[at[i]] = run >> (1 + i) & 1 ? (fb_real)stiff[i] : FB_R(0.0);
    }
    load_tip(FB_AXES_INERTIAL, -p, run % 2 ? 0.0 : 1e-3, 0.0);
    settle();
    FBT_INT_EQ(work.unstable, run % 2);
  }
}

static fb_exact_path path;
static fb_exact_path_work path_work;
static fb_exact_input varied;

/* From the steady state under `input`, nothing varied yet. */
static void path_start(void)
{
  memset(&path, 0, sizeof path);
  memset(&varied, 0, sizeof varied);
  varied.n_load = 1;
  varied.load[0].node = desc.n_element;
  settle();
}

static fb_status path_on(double arc)
{
  fb_status status;
  memset(&path_work, 0xff, sizeof path_work); /* it means nothing between calls */
  status = fb_exact_path_step(&exact, &path, &state, &path_work, &input, &varied, (fb_real)arc);
  FBT_INT_EQ(status, FB_OK);
  FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
  return status;
}

/* E12.17, E10.20: a column that is nudged to one side bends to that side, stable, beyond its buckling load; solved in
   one go the state may be another, and then says that it is unstable. */
TEST(columns_bend_to_the_side_they_are_nudged_to)
{
  const fbt_table *t = fbt_reference("p06_postbuckling.csv");
  int against = 0;
  for (int row = 1; row < t->rows; row++) {
    const double P = fbt_value(t, row, "PL2_EI");
    elastica(40);
    desc.station[0].stiffness[21] = desc.station[0].stiffness[28] = FB_R(50.0); /* in its plane */
    load_tip(FB_AXES_INERTIAL, 0.0, 1e-2, 0.0);
    path_start();
    varied.load[0].force[0] = -(fb_real)P;
    for (int k = 0; k < 60 && (double)path.factor < 1.0; k++) {
      if (path_on(0.05) != FB_OK) {
        return;
      }
      FBT_INT_EQ(path.unstable, 0);
    }
    FBT_BELOW(1.0, path.factor);
    input.load[0].force[0] = -(fb_real)P;
    input.load[0].force[1] = FB_R(0.0);
    FBT_INT_EQ(fb_exact_trim(&exact, &state, &work, &input), FB_OK);
    FBT_INT_EQ(work.unstable, 0);
    FBT_INT_EQ(fb_exact_nodes_eval(&exact, node, &state), FB_OK);
    FBT_NEAR_ABS(node[40].position[0], fbt_value(t, row, "x_tip"), FBT_TOL(1e-5, 2e-3));
    FBT_NEAR_ABS(node[40].position[1], fbt_value(t, row, "y_tip"), FBT_TOL(1e-5, 2e-3));
    input.load[0].force[1] = FB_R(1e-2);
    settle();
    against += node[40].position[1] < FB_R(0.0);
    FBT_INT_EQ(work.unstable > 0, node[40].position[1] < FB_R(0.0));
  }
  FBT_BELOW(0, against);
}

/* E12.17, E10.20: a bar that rises by 0.8 of its length, between hinges, the upper of which slides up and down and is
   pressed down: P = EA (1 - l) h/l, up to the limit load, where l^3 = span^2, down through the flat state and as far
   below, unstable while it falls; and all the way back. */
TEST(a_stiff_truss_snaps_in_closed_form)
{
  const double rise = 0.8, span = sqrt(1.0 - rise * rise), EA = 100.0, l_limit = pow(span, 2.0 / 3.0);
  const double largest = EA * (1.0 / l_limit - 1.0) * sqrt(l_limit * l_limit - span * span);
  const double stiffness[6] = {EA, 1e4, 1e4, 1e3, 1e3, 1e3};
  double h = rise, most = 0.0, least = 0.0;
  int unstable = 0;
  beam(1.0, 4, stiffness, NULL);
  desc.root = FB_END_CLAMPED & ~FB_HOLD_RZ;
  desc.tip = FB_HOLD_X | FB_HOLD_Z;
  desc.attitude[0] = (fb_real)cos(0.5 * asin(rise));
  desc.attitude[3] = (fb_real)sin(0.5 * asin(rise));
  path_start();
  varied.load[0].force[1] = -(fb_real)largest;
  for (int back = 0; back < 2; back++) {
    for (int k = 0; k < 400 && (back ? h < rise : h > -1.3 * rise); k++) {
      double l, P;
      if (path_on(back ? -0.05 : 0.05) != FB_OK) {
        return;
      }
      h = rise + (double)node[4].displacement[1];
      l = hypot(span, h);
      P = EA * (1.0 - l) * h / l;
      FBT_NEAR_ABS(path.factor, P / largest, FBT_TOL(1e-12, 1e-4));
      FBT_INT_EQ(path.unstable, l < l_limit);
      FBT_INT_EQ(path.rise > FB_R(0.0), l > l_limit);
      FBT_TRUE(back ? path.arc < FB_R(0.0) && path.arc > -FB_R(0.051) : path.arc > FB_R(0.0) && path.arc < FB_R(0.051));
      unstable += path.unstable;
      most = fmax(most, (double)(h > 0.0 ? path.factor : FB_R(0.0)));
      least = fmin(least, (double)(h < 0.0 ? path.factor : FB_R(0.0)));
    }
    FBT_TRUE(back ? h >= rise : h <= -1.3 * rise);
  }
  FBT_BELOW(50, unstable);
  FBT_NEAR_ABS(most, 1.0, 1e-3); /* at the nearest step */
  FBT_NEAR_ABS(least, -1.0, 1e-3);
}

/* E12.17, E10.20: a circular arch of 215 degrees, clamped at one end and on a hinge at the other, pressed down at its
   crown: snaps at P = 8.97 EI/R^2 (D.A. DaDeppo and R. Schmidt, J. Appl. Mech. 42 (1975) 311-316). */
TEST(arches_snap_at_their_limit_load)
{
  const double arc = 215.0 * pi / 180.0;
  double most = 0.0;
  elastica(40);
  desc.length = (fb_real)arc;
  desc.station[0].curvature[2] = -FB_R(1.0);
  desc.station[0].stiffness[21] = desc.station[0].stiffness[28] = FB_R(50.0); /* in its plane */
  desc.tip = FB_END_CLAMPED & ~FB_HOLD_RZ;
  desc.attitude[0] = (fb_real)cos(0.25 * arc);
  desc.attitude[3] = (fb_real)sin(0.25 * arc);
  path_start();
  varied.load[0].node = 20;
  varied.load[0].force[1] = -FB_R(10.0);
  for (int k = 0; k < 70; k++) { /* up, and down to a load that pulls */
    if (path_on(0.05) != FB_OK) {
      return;
    }
    FBT_INT_EQ(path.unstable, path.rise < FB_R(0.0));
    most = fmax(most, 10.0 * (double)path.factor);
  }
  FBT_BELOW(path.factor, 0.0);
  FBT_NEAR_ABS(most, 8.97, 0.005);
  fbt_figure("Limit load of a deep arch, 40 elements, relative", "8.97 (DaDeppo and Schmidt 1975)",
             fabs(most / 8.97 - 1.0));
}

/* E12.17: whatever acts, on nodes and elements, dead or following, on a spinning base: what lies on the path is a
   steady state under the loads of its factor. */
TEST(paths_lead_through_steady_states)
{
  elastica(8);
  desc.gravity[1] = FB_R(-1.0);
  desc.station[0].curvature[2] = FB_R(0.3);
  input.w[2] = FB_R(0.8);
  input.v[0] = FB_R(0.5);
  load_tip(FB_AXES_BODY, 0.1, 0.2, -0.1);
  for (int k = 0; k < 8; k++) {
    input.line[k].axes = k % 2 ? FB_AXES_INERTIAL : FB_AXES_NODE;
    input.line[k].force[1] = k % 2 ? FB_R(0.0) : FB_R(0.1); /* none that is dead */
  }
  path_start();
  varied.load[0].axes = FB_AXES_NODE;
  varied.load[0].force[1] = FB_R(1.0);
  for (int k = 0; k < 8; k++) {
    varied.line[k].axes = input.line[k].axes;
    varied.line[k].force[2] = FB_R(2.0);
    varied.line[k].torque[0] = FB_R(0.3);
    varied.line[k].torque[2] = FB_R(0.1); /* the last of what is stored of an element */
  }
  for (int k = 0; k < 10; k++) {
    fb_exact_input all = input;
    static fb_exact_state same;
    if (path_on(0.1) != FB_OK) {
      return;
    }
    all.load[all.n_load] = varied.load[0];
    all.load[all.n_load++].force[1] *= path.factor;
    for (int e = 0; e < 8; e++) {
      for (int i = 0; i < 3; i++) {
        all.line[e].force[i] += path.factor * varied.line[e].force[i];
        all.line[e].torque[i] += path.factor * varied.line[e].torque[i];
      }
    }
    same = state;
    FBT_INT_EQ(fb_exact_trim(&exact, &same, &work, &all), FB_OK);
    FBT_BELOW(fbt_difference(same.r, state.r, 27), FBT_TOL(1e-8, 1e-3));
  }
}

/* Interface: a path refuses what makes no sense, and is left as it was. */
TEST(paths_refuse_bad_input)
{
  fb_exact_path before;
  static fb_exact_state then;
  elastica(4);
  path_start();
  varied.load[0].force[1] = FB_R(1.0);
  FBT_INT_EQ(path_on(0.1), FB_OK);
  before = path;
  then = state;
#define PATH(constant, arc) fb_exact_path_step(&exact, &path, &state, &path_work, constant, &varied, arc)
  FBT_INT_EQ(PATH(NULL, FB_R(0.0)), FB_ERR_VALUE);
  FBT_INT_EQ(PATH(NULL, (fb_real)NAN), FB_ERR_VALUE);
  FBT_INT_EQ(PATH(NULL, FB_R(2.0) * FB_HUGE), FB_ERR_VALUE);
  FBT_INT_EQ(PATH(NULL, FB_R(1e6)), FB_ERR_CONVERGENCE);
  varied.load[0].node = 5;
  FBT_INT_EQ(PATH(NULL, FB_R(0.1)), FB_ERR_CAPACITY);
  varied.load[0].node = 4;
  input.n_load = -1;
  FBT_INT_EQ(PATH(&input, FB_R(0.1)), FB_ERR_CAPACITY);
  FBT_TRUE(memcmp(&before, &path, sizeof path) == 0);
  FBT_TRUE(memcmp(&then, &state, sizeof state) == 0);
  path.factor = (fb_real)INFINITY;
  FBT_INT_EQ(PATH(NULL, FB_R(0.1)), FB_ERR_NOT_FINITE);
#undef PATH
  desc.root = FB_END_FREE;
  desc.station[0].inertia[21] = FB_R(1e-3);
  memset(&path, 0, sizeof path);
  start();
  FBT_INT_EQ(fb_exact_path_step(&exact, &path, &state, &path_work, NULL, &varied, FB_R(0.1)), FB_ERR_SINGULAR);
}

/* E12.4: two equal rods on a soft hinge swing against each other about their own centers, omega^2 = 2 k/J: in single precision
   far below the shift, and no further off than the spectrum says. */
TEST(slow_modes_of_floating_beams_tell_their_error)
{
  static const double stiffness[6] = {1e5, 4e4, 4e4, 80.0, 100.0, 100.0},
                      inertia[6] = {1.0, 1.0, 1.0, 0.02, 0.01, 0.01};
  const double k = 1e-3, J = 2.5 * (2.5 * 2.5 / 12.0 + 0.01), omega = sqrt(2.0 * k / J);
  int found = 0;
  beam(5.0, 30, stiffness, inertia);
  desc.root = FB_END_FREE;
  desc.n_joint = 1;
  desc.joint[0].element = 15;
  desc.joint[0].axis[2] = FB_R(1.0);
  desc.joint[0].stiffness = (fb_real)k;
  start();
  FBT_INT_EQ(fb_exact_spectrum_solve(&exact, &spectrum_work, &spectrum, &state, &input, 8), FB_OK);
  for (int i = 0; i < spectrum.n && !found; i++) { /* above the rigid motions */
    found = (double)spectrum.im[i] > 0.5 * omega;
    if (found) {
      FBT_BELOW(fabs((double)spectrum.im[i] / omega - 1.0), 3e-3 + (double)spectrum.error[i]);
      FBT_BELOW((double)spectrum.error[i], FBT_TOL(1e-9, 0.05));
    }
  }
  FBT_TRUE(found);
}

/* E10.6, E10.20: elements under a tension are stable below 12 EI/h^2, unstable from there (many) to twice that (one) on, as the
   header says. */
TEST(elements_bear_a_tension_of_their_own)
{
  for (int n = 1; n <= 4; n++) {
    for (int above = 0; above < 2; above++) {
      elastica(n);
      load_tip(FB_AXES_INERTIAL, (!above ? 0.99 : n == 1 ? 2.01 : n == 4 ? 1.1 : 1.5) * 12.0 * n * n, 0.0, 0.0);
      settle();
      FBT_INT_EQ(work.unstable > 0, above);
    }
  }
}

SUITE(exact_spectrum, RUN(slow_modes_of_floating_beams_tell_their_error), RUN(elements_bear_a_tension_of_their_own),
      RUN(curvature_may_jump_beside_a_node), RUN(an_element_that_turns_is_as_stiff_as_the_header_says),
      RUN(shear_takes_frequencies_to_order_two), RUN(eight_elements_have_four_frequencies),
      RUN(timoshenko_beams_have_their_frequencies), RUN(twist_is_of_order_four),
      RUN(spinning_beams_of_any_inertia_are_stable), RUN(spinning_beams_with_their_mass_ahead_are_stable),
      RUN(whirling_shafts_move_on_circles), RUN(spectrum_is_that_of_the_natural_modes),
      RUN(a_rod_has_the_dispersion_of_its_mesh_and_its_step), RUN(any_unit_gives_the_same_frequency),
      RUN(spectrum_of_a_straight_beam_is_the_textbooks), RUN(free_beams_of_any_mesh_have_their_frequencies),
      RUN(free_arcs_move_as_far_at_both_ends), RUN(spectrum_does_not_depend_on_the_count),
      RUN(a_body_on_a_light_beam_rings_in_closed_form), RUN(bodies_swing_on_a_spinning_slide_in_closed_form),
      RUN(frequencies_of_a_straight_beam_are_of_order_four), RUN_LONG(becks_column_flutters_at_its_load),
      RUN(shaft_whirls_as_in_closed_form), RUN(spinning_cantilever_has_the_published_frequencies),
      RUN(a_free_beam_swings_as_the_exact_one), RUN(columns_buckle_at_eulers_load),
      RUN(columns_have_as_many_unstable_directions_as_loads_exceeded), RUN(rigid_strains_are_no_unstable_directions),
      RUN(columns_bend_to_the_side_they_are_nudged_to), RUN(a_stiff_truss_snaps_in_closed_form),
      RUN(arches_snap_at_their_limit_load), RUN(paths_lead_through_steady_states), RUN(paths_refuse_bad_input))
