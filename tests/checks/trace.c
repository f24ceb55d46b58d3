/* trace.c - a file of --jacobian against differences of its own functions, which the tracer holds against the library:
   MODEL its prefix, HEADER the file, SENSE a function of a sensor, if there is one. At states around the one that it was
   traced at. */
#define JOIN_2(a, b) a##b
#define JOIN(a, b) JOIN_2(a, b)
#include HEADER
#include <stdio.h>
#include <stdlib.h>
#define OF(name) JOIN(MODEL, name)
typedef OF(_real) real;
enum { N = OF(_STATES), ALL = OF(_STATES) + OF(_INPUTS), MOST = N > 16 ? N : 16 };

typedef int function(real *y, const real *x);
static double scale; /* of states and inputs away from those traced at */

static double pick(void)
{
  static unsigned seed = 7;
  seed = 1664525u * seed + 1013904223u;
  return (double)(seed >> 8) / 8388608.0 - 1.0;
}

static int rates(real *y, const real *x)
{
  return OF(_rates)(y, x, x + N);
}

static real the_dt;
static OF(_work) work;
static real Phi[N * N], Gamma[N * (ALL - N) + 1]; /* a model may have no inputs */

static int step(real *y, const real *x)
{
  for (int i = 0; i < N; i++) {
    y[i] = x[i];
  }
  return OF(_step_jacobian)(y, Phi, Gamma, &work, x + N, the_dt);
}

#ifdef SENSE
static int sense(real *y, const real *x)
{
  return SENSE(y, x, x + N);
}
#endif

/* Largest error of J (rows x ALL) of f at x by the largest number of its column and 1; of central differences of
   fourth order with ever smaller steps the best counts, whose own errors grow either way. */
static double miss(function *f, int rows, const double *J, const real *at)
{
  double most = 0.0;
  real x[ALL], y[2][MOST];
  for (int i = 0; i < ALL; i++) {
    x[i] = at[i];
  }
  for (int c = 0; c < ALL; c++) {
    double best = 1e300;
    for (double h = sizeof(real) == 4 ? 0.06 : 4e-3; h > (sizeof(real) == 4 ? 1e-3 : 1e-7); h *= 0.25) {
      double d[MOST] = {0.0}, worst = 0.0, size = 1.0;
      for (int k = 1; k <= 2; k++) {
        int status;
        x[c] = at[c] + (real)(k * h);
        status = f(y[0], x);
        x[c] = at[c] - (real)(k * h);
        status |= f(y[1], x);
        x[c] = at[c];
        if (status) {
          worst = 1e300;
        }
        for (int r = 0; r < rows; r++) {
          d[r] += (k == 1 ? 8.0 : -1.0) / (12.0 * h) * ((double)y[0][r] - (double)y[1][r]);
        }
      }
      for (int r = 0; r < rows; r++) {
        size = fmax(size, fabs(J[r * ALL + c]));
      }
      for (int r = 0; r < rows; r++) {
        worst = fmax(worst, fabs(d[r] - J[r * ALL + c]) / size);
      }
      best = fmin(best, worst);
    }
    most = fmax(most, best);
  }
  return most;
}

static void dense(double *D, int rows, const real *J, const unsigned short (*at)[2], int entries)
{
  for (int i = 0; i < rows * ALL; i++) {
    D[i] = 0.0;
  }
  for (int e = 0; e < entries; e++) {
    D[at[e][0] * ALL + at[e][1]] = (double)J[e];
  }
}

int main(void)
{
  static double D[MOST * ALL];
  static real J[MOST * ALL], x[ALL], y[MOST], same[MOST];
  double worst[3] = {0.0, 0.0, 0.0};
  int good = 0;
  for (int k = 0; k < 20; k++) {
    int status;
    scale = 0.02 * k;
    for (int i = 0; i < ALL; i++) {
      x[i] = (real)((double)OF(_near)[i] * (1.0 + scale * pick()));
    }
    status = OF(_rates_jacobian)(y, J, x, x + N);
    if (status != OF(_rates)(same, x, x + N)) {
      fprintf(stderr, "the two functions of the rates return different statuses\n");
      return 1;
    }
    if (status) {
      continue;
    }
    good++;
    dense(D, N, J, OF(_rates_at), OF(_rates_entries));
    worst[0] = fmax(worst[0], miss(rates, N, D, x));
    the_dt = (real)1e-3;
    if (step(y, x) == 0) {
      for (int i = 0; i < N; i++) {
        for (int j = 0; j < ALL; j++) {
          D[i * ALL + j] = (double)(j < N ? Phi[i * N + j] : Gamma[i * (ALL - N) + j - N]);
        }
      }
      worst[1] = fmax(worst[1], miss(step, N, D, x));
    }
#ifdef SENSE
    if (JOIN(SENSE, _jacobian)(y, J, x, x + N) == 0) {
      dense(D, 16, J, JOIN(SENSE, _at), JOIN(SENSE, _entries));
      worst[2] = fmax(worst[2], miss(sense, 16, D, x));
    }
#endif
  }
  printf("%d %.1e %.1e %.1e\n", good, worst[0], worst[1], worst[2]);
  for (int k = 0; k < 3; k++) {
    if (!(worst[k] < (sizeof(real) == 4 ? 2e-2 : 2e-8))) {
      return 1;
    }
  }
  return good < 10;
}
