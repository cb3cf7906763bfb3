/*
   Yardstick for explicit dynamics of 8-node hexahedra with full integration: a box of n x n x n elements with free faces, central
   differences, lumped mass, written down directly for this one problem. Elements are taken in batches of 8, as structures of arrays;
   nothing is stored of an element but its nodes, so the Jacobians are recomputed from the coordinates at each Gauss point.

     gcc -O3 -std=c11 -fopenmp-simd -fno-math-errno -Wall -Wextra -Werror tests/scaling/yardstick_hex8.c -lm
     ./a.out [--elements n] [--steps m] [--material linear|neo_hookean] [--scalar]

   --elements is rounded to a cube; --scalar is the same loop unvectorised. The material is linear elastic, or compressible neo-Hookean with
   W = mu/2 (tr(F^T F) - 3) - mu ln J + lambda/4 (J^2 - 1) - lambda/2 ln J, P = mu F + (lambda/2 (J^2 - 1) - mu) F^-T.
   The result is one line of JSON on standard output: microseconds per element and step,
   as a clock shows them and as the processor spent them on this program, and by how much the energy has changed, relative to
   the initial one. SI units throughout.
*/
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define BATCH  8
#define INLINE static inline __attribute__((always_inline))
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#  define CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#  define SCALAR __attribute__((optimize("no-tree-vectorize")))
#else
#  define CLONES
#  define SCALAR
#endif

static const double density = 1000, youngs_modulus = 1e9, poissons_ratio = 0.3, speed = 10; /* speed: of the initial velocity field */

typedef struct {
  double lambda, mu;
  double gradient[8][8][3]; /* of the shape functions in the reference cube, at each Gauss point */
} Constants;

typedef struct {
  int     n_elements, n_nodes;
  int    *nodes; /* 8 of each element, the last one repeated to fill the last batch */
  double *x, *u, *v, *f, *inverse_mass;
} Box;

static void SetConstants(Constants *c)
{
  static const int corner[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};
  const double     at           = 1 / sqrt(3.0);

  c->lambda = youngs_modulus * poissons_ratio / ((1 + poissons_ratio) * (1 - 2 * poissons_ratio));
  c->mu     = youngs_modulus / (2 * (1 + poissons_ratio));
  for (int g = 0; g < 8; g++)
    for (int a = 0; a < 8; a++)
      for (int i = 0; i < 3; i++) {
        c->gradient[g][a][i] = 0.125 * corner[a][i];
        for (int j = 0; j < 3; j++)
          if (j != i) c->gradient[g][a][i] *= 1 + at * corner[g][j] * corner[a][j];
      }
}

/* Adds to f the force of the elements of a batch at one Gauss point, whose weight is 1; returns the stored energy there */
INLINE double AddPoint(const Constants *c, bool neo_hookean, bool with_energy, int g, const double x[24][BATCH], const double u[24][BATCH],
                       double f[24][BATCH], int p)
{
  const double (*gradient)[3] = c->gradient[g];
  const double lambda = c->lambda, mu = c->mu;
  double       x00 = 0, x01 = 0, x02 = 0, x10 = 0, x11 = 0, x12 = 0, x20 = 0, x21 = 0, x22 = 0; /* dX_i/dxi_j */
  double       u00 = 0, u01 = 0, u02 = 0, u10 = 0, u11 = 0, u12 = 0, u20 = 0, u21 = 0, u22 = 0; /* du_i/dxi_j */
  double       energy = 0;

#pragma GCC unroll 8
  for (int a = 0; a < 8; a++) {
    x00 += x[3 * a][p] * gradient[a][0];
    x01 += x[3 * a][p] * gradient[a][1];
    x02 += x[3 * a][p] * gradient[a][2];
    x10 += x[3 * a + 1][p] * gradient[a][0];
    x11 += x[3 * a + 1][p] * gradient[a][1];
    x12 += x[3 * a + 1][p] * gradient[a][2];
    x20 += x[3 * a + 2][p] * gradient[a][0];
    x21 += x[3 * a + 2][p] * gradient[a][1];
    x22 += x[3 * a + 2][p] * gradient[a][2];
  }
#pragma GCC unroll 8
  for (int a = 0; a < 8; a++) {
    u00 += u[3 * a][p] * gradient[a][0];
    u01 += u[3 * a][p] * gradient[a][1];
    u02 += u[3 * a][p] * gradient[a][2];
    u10 += u[3 * a + 1][p] * gradient[a][0];
    u11 += u[3 * a + 1][p] * gradient[a][1];
    u12 += u[3 * a + 1][p] * gradient[a][2];
    u20 += u[3 * a + 2][p] * gradient[a][0];
    u21 += u[3 * a + 2][p] * gradient[a][1];
    u22 += u[3 * a + 2][p] * gradient[a][2];
  }
  /* cofactors of dX/dxi: its inverse is their transpose over the determinant */
  const double c00 = x11 * x22 - x12 * x21, c01 = x12 * x20 - x10 * x22, c02 = x10 * x21 - x11 * x20;
  const double c10 = x21 * x02 - x22 * x01, c11 = x22 * x00 - x20 * x02, c12 = x20 * x01 - x21 * x00;
  const double c20 = x01 * x12 - x02 * x11, c21 = x02 * x10 - x00 * x12, c22 = x00 * x11 - x01 * x10;
  const double volume = x00 * c00 + x01 * c01 + x02 * c02, r = 1 / volume;
  const double h00 = r * (u00 * c00 + u01 * c01 + u02 * c02), h01 = r * (u00 * c10 + u01 * c11 + u02 * c12),
               h02 = r * (u00 * c20 + u01 * c21 + u02 * c22);
  const double h10 = r * (u10 * c00 + u11 * c01 + u12 * c02), h11 = r * (u10 * c10 + u11 * c11 + u12 * c12),
               h12 = r * (u10 * c20 + u11 * c21 + u12 * c22);
  const double h20 = r * (u20 * c00 + u21 * c01 + u22 * c02), h21 = r * (u20 * c10 + u21 * c11 + u22 * c12),
               h22 = r * (u20 * c20 + u21 * c21 + u22 * c22);
  double       p00, p01, p02, p10, p11, p12, p20, p21, p22;

  if (neo_hookean) {
    const double f00 = 1 + h00, f11 = 1 + h11, f22 = 1 + h22;
    const double a00 = f11 * f22 - h12 * h21, a01 = h12 * h20 - h10 * f22, a02 = h10 * h21 - f11 * h20;
    const double a10 = h21 * h02 - f22 * h01, a11 = f22 * f00 - h20 * h02, a12 = h20 * h01 - h21 * f00;
    const double a20 = h01 * h12 - h02 * f11, a21 = h02 * h10 - f00 * h12, a22 = f00 * f11 - h01 * h10;
    const double J = f00 * a00 + h01 * a01 + h02 * a02, s = (0.5 * lambda * (J * J - 1) - mu) / J;

    p00 = mu * f00 + s * a00;
    p01 = mu * h01 + s * a01;
    p02 = mu * h02 + s * a02;
    p10 = mu * h10 + s * a10;
    p11 = mu * f11 + s * a11;
    p12 = mu * h12 + s * a12;
    p20 = mu * h20 + s * a20;
    p21 = mu * h21 + s * a21;
    p22 = mu * f22 + s * a22;
    if (with_energy)
      energy = 0.5 * mu * (f00 * f00 + f11 * f11 + f22 * f22 + h01 * h01 + h02 * h02 + h10 * h10 + h12 * h12 + h20 * h20 + h21 * h21 - 3) +
               0.25 * lambda * (J * J - 1) - (mu + 0.5 * lambda) * log(J);
  } else {
    const double pressure = lambda * (h00 + h11 + h22);

    p00 = pressure + 2 * mu * h00;
    p11 = pressure + 2 * mu * h11;
    p22 = pressure + 2 * mu * h22;
    p01 = p10 = mu * (h01 + h10);
    p02 = p20 = mu * (h02 + h20);
    p12 = p21 = mu * (h12 + h21);
    if (with_energy) energy = 0.5 * (p00 * h00 + p11 * h11 + p22 * h22 + p01 * (h01 + h10) + p02 * (h02 + h20) + p12 * (h12 + h21));
  }
  if (with_energy) return volume * energy;
  /* stress against the axes of the reference cube */
  const double q00 = p00 * c00 + p01 * c10 + p02 * c20, q01 = p00 * c01 + p01 * c11 + p02 * c21, q02 = p00 * c02 + p01 * c12 + p02 * c22;
  const double q10 = p10 * c00 + p11 * c10 + p12 * c20, q11 = p10 * c01 + p11 * c11 + p12 * c21, q12 = p10 * c02 + p11 * c12 + p12 * c22;
  const double q20 = p20 * c00 + p21 * c10 + p22 * c20, q21 = p20 * c01 + p21 * c11 + p22 * c21, q22 = p20 * c02 + p21 * c12 + p22 * c22;
#pragma GCC unroll 8
  for (int a = 0; a < 8; a++) {
    f[3 * a][p] += q00 * gradient[a][0] + q01 * gradient[a][1] + q02 * gradient[a][2];
    f[3 * a + 1][p] += q10 * gradient[a][0] + q11 * gradient[a][1] + q12 * gradient[a][2];
    f[3 * a + 2][p] += q20 * gradient[a][0] + q21 * gradient[a][1] + q22 * gradient[a][2];
  }
  return 0;
}

INLINE void AddForces(const Constants *c, const Box *box, bool neo_hookean)
{
  for (int first = 0; first < box->n_elements; first += BATCH) {
    const int *nodes = box->nodes + 8 * first;
    const int  n     = box->n_elements - first < BATCH ? box->n_elements - first : BATCH;
    double x[24][BATCH] __attribute__((aligned(64))), u[24][BATCH] __attribute__((aligned(64))), f[24][BATCH] __attribute__((aligned(64)));

    for (int e = 0; e < BATCH; e++)
      for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) {
          x[3 * a + i][e] = box->x[3 * nodes[8 * e + a] + i];
          u[3 * a + i][e] = box->u[3 * nodes[8 * e + a] + i];
        }
    memset(f, 0, sizeof(f));
    for (int g = 0; g < 8; g++) {
#pragma omp simd
      for (int p = 0; p < BATCH; p++) AddPoint(c, neo_hookean, false, g, x, u, f, p);
    }
    for (int e = 0; e < n; e++)
      for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) box->f[3 * nodes[8 * e + a] + i] += f[3 * a + i][e];
  }
}

CLONES static void AddForcesLinear(const Constants *c, const Box *box)
{
  AddForces(c, box, false);
}

CLONES static void AddForcesNeoHookean(const Constants *c, const Box *box)
{
  AddForces(c, box, true);
}

SCALAR static void AddForcesLinearScalar(const Constants *c, const Box *box)
{
  AddForces(c, box, false);
}

SCALAR static void AddForcesNeoHookeanScalar(const Constants *c, const Box *box)
{
  AddForces(c, box, true);
}

static double StoredEnergy(const Constants *c, const Box *box, bool neo_hookean)
{
  double energy = 0;

  for (int e = 0; e < box->n_elements; e++) {
    double x[24][BATCH], u[24][BATCH];

    for (int a = 0; a < 8; a++)
      for (int i = 0; i < 3; i++) {
        x[3 * a + i][0] = box->x[3 * box->nodes[8 * e + a] + i];
        u[3 * a + i][0] = box->u[3 * box->nodes[8 * e + a] + i];
      }
    for (int g = 0; g < 8; g++) energy += AddPoint(c, neo_hookean, true, g, x, u, NULL, 0);
  }
  return energy;
}

/* v, of half a step before or after, taken to the time of u */
static double KineticEnergy(const Box *box, double ahead)
{
  double energy = 0;

  for (int k = 0; k < 3 * box->n_nodes; k++) {
    const double v = box->v[k] - ahead * box->f[k] * box->inverse_mass[k];

    energy += 0.5 * v * v / box->inverse_mass[k];
  }
  return energy;
}

static void *Allocate(size_t n, size_t size)
{
  void *p = aligned_alloc(64, (n * size + 63) / 64 * 64);

  if (!p) exit(fprintf(stderr, "out of memory\n"));
  memset(p, 0, n * size);
  return p;
}

/* A unit cube, the nodes moved off the regular grid a little */
static void SetUpBox(Box *box, int n)
{
  const double h = 1.0 / n;
  const int    m = n + 1;

  box->n_elements   = n * n * n;
  box->n_nodes      = m * m * m;
  box->nodes        = Allocate(8 * ((size_t)box->n_elements + BATCH), sizeof(int));
  box->x            = Allocate(3 * (size_t)box->n_nodes, sizeof(double));
  box->u            = Allocate(3 * (size_t)box->n_nodes, sizeof(double));
  box->v            = Allocate(3 * (size_t)box->n_nodes, sizeof(double));
  box->f            = Allocate(3 * (size_t)box->n_nodes, sizeof(double));
  box->inverse_mass = Allocate(3 * (size_t)box->n_nodes, sizeof(double));
  for (int k = 0; k < m; k++)
    for (int j = 0; j < m; j++)
      for (int i = 0; i < m; i++) {
        const int    node = (k * m + j) * m + i, shares = (2 - (i == 0 || i == n)) * (2 - (j == 0 || j == n)) * (2 - (k == 0 || k == n));
        const double position[3] = {i * h, j * h, k * h};

        for (int d = 0; d < 3; d++) {
          box->x[3 * node + d]            = position[d] + 0.05 * h * sin(1 + d + node);
          box->v[3 * node + d]            = speed * cos(3.141592653589793 * position[d]);
          box->inverse_mass[3 * node + d] = 8 / (shares * density * h * h * h);
        }
      }
  for (int e = 0; e < box->n_elements + BATCH; e++) {
    const int element = e < box->n_elements ? e : box->n_elements - 1, i = element % n, j = element / n % n, k = element / n / n,
              node       = (k * m + j) * m + i;
    const int offsets[8] = {0, 1, m + 1, m, m * m, m * m + 1, m * m + m + 1, m * m + m};

    for (int a = 0; a < 8; a++) box->nodes[8 * e + a] = node + offsets[a];
  }
}

static double GetSeconds(clockid_t clock)
{
  struct timespec now;

  clock_gettime(clock, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int argc, char **argv)
{
  int       n_elements = 8000, steps = 100, n;
  bool      neo_hookean = false, scalar = false;
  Constants c;
  Box       box;
  double    wall, cpu;

  for (int i = 1; i < argc; i++) {
    if (!strcmp(argv[i], "--scalar")) scalar = true;
    else if (i + 1 < argc && !strcmp(argv[i], "--elements")) n_elements = atoi(argv[++i]);
    else if (i + 1 < argc && !strcmp(argv[i], "--steps")) steps = atoi(argv[++i]);
    else if (i + 1 < argc && !strcmp(argv[i], "--material") && (!strcmp(argv[i + 1], "linear") || !strcmp(argv[i + 1], "neo_hookean")))
      neo_hookean = !strcmp(argv[++i], "neo_hookean");
    else return fprintf(stderr, "usage: %s [--elements n] [--steps m] [--material linear|neo_hookean] [--scalar]\n", argv[0]), 1;
  }
  if (n_elements < 1 || steps < 1) return fprintf(stderr, "--elements and --steps must be positive\n"), 1;
  n = (int)lround(cbrt(n_elements));
  SetConstants(&c);
  SetUpBox(&box, n);
  {
    void (*const add_forces)(const Constants *, const Box *) = scalar ? (neo_hookean ? AddForcesNeoHookeanScalar : AddForcesLinearScalar)
                                                                      : (neo_hookean ? AddForcesNeoHookean : AddForcesLinear);
    /* the fastest wave crosses a fifth of an element in a step; u at t, v half a step later */
    const double dt      = 0.2 / n / sqrt((c.lambda + 2 * c.mu) / density);
    const double initial = KineticEnergy(&box, 0);
    double       energy;

    wall = GetSeconds(CLOCK_MONOTONIC);
    cpu  = GetSeconds(CLOCK_PROCESS_CPUTIME_ID);
    for (int step = 0; step < steps; step++) {
      const double kick = step ? dt : dt / 2;

      memset(box.f, 0, 3 * (size_t)box.n_nodes * sizeof(double));
      add_forces(&c, &box);
      for (int k = 0; k < 3 * box.n_nodes; k++) {
        box.v[k] -= kick * box.f[k] * box.inverse_mass[k];
        box.u[k] += dt * box.v[k];
      }
    }
    wall = GetSeconds(CLOCK_MONOTONIC) - wall;
    cpu  = GetSeconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    memset(box.f, 0, 3 * (size_t)box.n_nodes * sizeof(double));
    add_forces(&c, &box);
    energy = KineticEnergy(&box, dt / 2) + StoredEnergy(&c, &box, neo_hookean);
    printf("{\"elements\": %d, \"steps\": %d, \"material\": \"%s\", \"scalar\": %s, \"us_per_element_step\": %.5f, "
           "\"cpu_us_per_element_step\": %.5f, \"energy_error\": %.3e}\n",
           box.n_elements, steps, neo_hookean ? "neo_hookean" : "linear", scalar ? "true" : "false", 1e6 * wall / steps / box.n_elements,
           1e6 * cpu / steps / box.n_elements, energy / initial - 1);
  }
  free(box.nodes);
  free(box.x);
  free(box.u);
  free(box.v);
  free(box.f);
  free(box.inverse_mass);
  return 0;
}
