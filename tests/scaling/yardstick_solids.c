/*
   Yardstick for explicit dynamics of tri3, quad4 and tet4: a square of n x n cells or a cube of n x n x n with free faces, central
   differences, lumped mass, written down directly for these problems. Elements are taken in batches of 8, as structures of arrays; nothing
   is stored of an element but its nodes, so that the Jacobians are recomputed from the coordinates. yardstick_hex8.c does the same for
   hexahedra.

     gcc -O3 -std=c11 -fopenmp-simd -fno-math-errno -Wall -Wextra -Werror tests/scaling/yardstick_solids.c -lm
     ./a.out --shape tri3|quad4|tet4 [--cells n] [--steps m] [--material linear|neo_hookean]

   --cells is the number along an edge: a square cell is one quad4 or two tri3, a cubic one six tet4. Two dimensions are plane strain. The
   materials are those of yardstick_hex8.c. The result is one line of JSON on standard output: microseconds of processor time per element
   and step, floating point operations and bytes of memory that an element takes in a step as counted by hand, and by how much the energy
   has changed, relative to the initial one.
   With --shape machine it measures instead what the roofline is made of: bandwidth of a triad over arrays of --cells million numbers
   [GB/s], and the rate of fused multiplications and additions in registers [GFLOP/s]. SI units throughout.
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
#else
#  define CLONES
#endif

static const double density = 1000, youngs_modulus = 1e9, poissons_ratio = 0.3, speed = 10; /* speed: of the initial velocity field */

typedef struct {
  int    dim, nodes, points;
  double weight;
  double gradient[4][4][3]; /* of the shape functions in the reference element, at each point */
} Shape;

typedef struct {
  double  lambda, mu;
  int     n_elements, n_nodes;
  int    *nodes; /* of each element, the last one repeated to fill the last batch */
  double *x, *u, *v, *f, *inverse_mass;
} Mesh;

static void SetShape(Shape *s, const char *name)
{
  memset(s, 0, sizeof(*s));
  s->dim    = !strcmp(name, "tet4") ? 3 : 2;
  s->nodes  = !strcmp(name, "tri3") ? 3 : 4;
  s->points = !strcmp(name, "quad4") ? 4 : 1;
  s->weight = s->points == 4 ? 1 : s->dim == 3 ? 1.0 / 6 : 0.5;
  for (int g = 0; g < s->points; g++)
    for (int a = 0; a < s->nodes; a++)
      for (int i = 0; i < s->dim; i++) {
        static const int corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

        if (s->points == 1) s->gradient[g][a][i] = a == 0 ? -1 : a == i + 1;
        else s->gradient[g][a][i] = 0.25 * corner[a][i] * (1 + corner[g][1 - i] * corner[a][1 - i] / sqrt(3.0));
      }
}

/* First Piola-Kirchhoff stress of one member of a batch, or its stored energy; third row and column of H are zero in two dimensions */
INLINE double Stress(const Mesh *mesh, int dim, bool neo_hookean, bool with_energy, double h[3][3], double P[3][3])
{
  const double lambda = mesh->lambda, mu = mesh->mu;

  if (neo_hookean) {
    const double f00 = 1 + h[0][0], f11 = 1 + h[1][1], f22 = dim == 3 ? 1 + h[2][2] : 1;
    double       a[3][3];

    a[0][0] = dim == 3 ? f11 * f22 - h[1][2] * h[2][1] : f11;
    a[0][1] = dim == 3 ? h[1][2] * h[2][0] - h[1][0] * f22 : -h[1][0];
    a[1][0] = dim == 3 ? h[2][1] * h[0][2] - f22 * h[0][1] : -h[0][1];
    a[1][1] = dim == 3 ? f22 * f00 - h[2][0] * h[0][2] : f00;
    if (dim == 3) {
      a[0][2] = h[1][0] * h[2][1] - f11 * h[2][0];
      a[1][2] = h[2][0] * h[0][1] - h[2][1] * f00;
      a[2][0] = h[0][1] * h[1][2] - h[0][2] * f11;
      a[2][1] = h[0][2] * h[1][0] - f00 * h[1][2];
      a[2][2] = f00 * f11 - h[0][1] * h[1][0];
    }
    const double J = f00 * a[0][0] + h[0][1] * a[0][1] + (dim == 3 ? h[0][2] * a[0][2] : 0), s = (0.5 * lambda * (J * J - 1) - mu) / J;

    if (with_energy) {
      double trace = f00 * f00 + f11 * f11 + f22 * f22 - 3;

      for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++) trace += i == j ? 0 : h[i][j] * h[i][j];
      return 0.5 * mu * trace + 0.25 * lambda * (J * J - 1) - (mu + 0.5 * lambda) * log(J);
    }
    for (int i = 0; i < dim; i++)
      for (int j = 0; j < dim; j++) P[i][j] = mu * ((i == j) + h[i][j]) + s * a[i][j];
  } else {
    double trace = 0, energy = 0;

    for (int i = 0; i < dim; i++) trace += h[i][i];
    for (int i = 0; i < dim; i++)
      for (int j = 0; j < dim; j++) P[i][j] = mu * (h[i][j] + h[j][i]) + (i == j ? lambda * trace : 0);
    if (with_energy) {
      for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++) energy += 0.5 * P[i][j] * h[i][j];
      return energy;
    }
  }
  return 0;
}

/* Adds to f the force of a member of a batch at one point; returns the stored energy there. Constant arguments are folded in. */
INLINE double AddPoint(const Mesh *mesh, int dim, int nodes, const double (*gradient)[3], double weight, bool neo_hookean, bool with_energy,
                       double x[12][BATCH], double u[12][BATCH], double f[12][BATCH], int p)
{
  double X[3][3] = {{0}}, U[3][3] = {{0}}, c[3][3] = {{0}}, h[3][3] = {{0}}, P[3][3] = {{0}};

  for (int i = 0; i < dim; i++)
    for (int j = 0; j < dim; j++) {
      X[i][j] = U[i][j] = 0;
#pragma GCC unroll 4
      for (int a = 0; a < nodes; a++) {
        X[i][j] += x[dim * a + i][p] * gradient[a][j];
        U[i][j] += u[dim * a + i][p] * gradient[a][j];
      }
    }
  if (dim == 3) {
    c[0][0] = X[1][1] * X[2][2] - X[1][2] * X[2][1];
    c[0][1] = X[1][2] * X[2][0] - X[1][0] * X[2][2];
    c[0][2] = X[1][0] * X[2][1] - X[1][1] * X[2][0];
    c[1][0] = X[2][1] * X[0][2] - X[2][2] * X[0][1];
    c[1][1] = X[2][2] * X[0][0] - X[2][0] * X[0][2];
    c[1][2] = X[2][0] * X[0][1] - X[2][1] * X[0][0];
    c[2][0] = X[0][1] * X[1][2] - X[0][2] * X[1][1];
    c[2][1] = X[0][2] * X[1][0] - X[0][0] * X[1][2];
    c[2][2] = X[0][0] * X[1][1] - X[0][1] * X[1][0];
  } else {
    c[0][0] = X[1][1];
    c[0][1] = -X[1][0];
    c[1][0] = -X[0][1];
    c[1][1] = X[0][0];
  }
  const double volume = X[0][0] * c[0][0] + X[0][1] * c[0][1] + (dim == 3 ? X[0][2] * c[0][2] : 0), r = 1 / volume;

  for (int i = 0; i < dim; i++)
    for (int j = 0; j < dim; j++) {
      double sum = 0;

      for (int k = 0; k < dim; k++) sum += U[i][k] * c[j][k];
      h[i][j] = r * sum;
    }
  if (with_energy) return weight * volume * Stress(mesh, dim, neo_hookean, true, h, P);
  (void)Stress(mesh, dim, neo_hookean, false, h, P);
  for (int i = 0; i < dim; i++) {
    double q[3];

    for (int k = 0; k < dim; k++) {
      q[k] = 0;
      for (int j = 0; j < dim; j++) q[k] += P[i][j] * c[j][k];
    }
#pragma GCC unroll 4
    for (int a = 0; a < nodes; a++) {
      double sum = 0;

      for (int k = 0; k < dim; k++) sum += q[k] * gradient[a][k];
      f[dim * a + i][p] += weight * sum;
    }
  }
  return 0;
}

INLINE void AddForces(const Mesh *mesh, const Shape *shape, int dim, int n_nodes, int points, bool neo_hookean)
{
  for (int first = 0; first < mesh->n_elements; first += BATCH) {
    const int *nodes = mesh->nodes + n_nodes * first;
    const int  n     = mesh->n_elements - first < BATCH ? mesh->n_elements - first : BATCH;
    double x[12][BATCH] __attribute__((aligned(64))), u[12][BATCH] __attribute__((aligned(64))), f[12][BATCH] __attribute__((aligned(64)));

    for (int e = 0; e < BATCH; e++)
      for (int a = 0; a < n_nodes; a++)
        for (int i = 0; i < dim; i++) {
          x[dim * a + i][e] = mesh->x[dim * nodes[n_nodes * e + a] + i];
          u[dim * a + i][e] = mesh->u[dim * nodes[n_nodes * e + a] + i];
        }
    memset(f, 0, sizeof(f));
    for (int g = 0; g < points; g++) {
#pragma omp simd
      for (int p = 0; p < BATCH; p++) AddPoint(mesh, dim, n_nodes, shape->gradient[g], shape->weight, neo_hookean, false, x, u, f, p);
    }
    for (int e = 0; e < n; e++)
      for (int a = 0; a < n_nodes; a++)
        for (int i = 0; i < dim; i++) mesh->f[dim * nodes[n_nodes * e + a] + i] += f[dim * a + i][e];
  }
}

/* One loop for each shape, in which the gradients of simplices are constants: their zeros cost nothing */
static const Shape simplex[2] = {{2, 3, 1, 0.5, {{{-1, -1}, {1, 0}, {0, 1}}}},
                                 {3, 4, 1, 1.0 / 6, {{{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}}};

CLONES static void AddTri3(const Mesh *mesh, const Shape *shape, bool neo_hookean)
{
  (void)shape;
  if (neo_hookean) AddForces(mesh, &simplex[0], 2, 3, 1, true);
  else AddForces(mesh, &simplex[0], 2, 3, 1, false);
}

CLONES static void AddQuad4(const Mesh *mesh, const Shape *shape, bool neo_hookean)
{
  if (neo_hookean) AddForces(mesh, shape, 2, 4, 4, true);
  else AddForces(mesh, shape, 2, 4, 4, false);
}

CLONES static void AddTet4(const Mesh *mesh, const Shape *shape, bool neo_hookean)
{
  (void)shape;
  if (neo_hookean) AddForces(mesh, &simplex[1], 3, 4, 1, true);
  else AddForces(mesh, &simplex[1], 3, 4, 1, false);
}

static double StoredEnergy(const Mesh *mesh, const Shape *s, bool neo_hookean)
{
  double energy = 0;

  for (int e = 0; e < mesh->n_elements; e++) {
    double x[12][BATCH], u[12][BATCH];

    for (int a = 0; a < s->nodes; a++)
      for (int i = 0; i < s->dim; i++) {
        x[s->dim * a + i][0] = mesh->x[s->dim * mesh->nodes[s->nodes * e + a] + i];
        u[s->dim * a + i][0] = mesh->u[s->dim * mesh->nodes[s->nodes * e + a] + i];
      }
    for (int g = 0; g < s->points; g++)
      energy += AddPoint(mesh, s->dim, s->nodes, s->gradient[g], s->weight, neo_hookean, true, x, u, NULL, 0);
  }
  return energy;
}

/* v, of half a step before or after, taken to the time of u */
static double KineticEnergy(const Mesh *mesh, int dim, double ahead)
{
  double energy = 0;

  for (int k = 0; k < dim * mesh->n_nodes; k++) {
    const double v = mesh->v[k] - ahead * mesh->f[k] * mesh->inverse_mass[k];

    energy += 0.5 * v * v / mesh->inverse_mass[k];
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

/* Corners of the parts of a cell: a square, its two triangles, or six tetrahedra around the diagonal of a cube */
static void SetNodes(Mesh *mesh, const Shape *s, int n)
{
  static const int square[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  static const int halves[2][3] = {{0, 1, 2}, {0, 2, 3}};
  static const int path[6][2]   = {{0, 1}, {1, 2}, {2, 0}, {1, 0}, {2, 1}, {0, 2}}; /* axes along which the first two edges go */
  const int        parts = s->dim == 3 ? 6 : 5 - s->nodes, m = n + 1;

  for (int e = 0; e < mesh->n_elements + BATCH; e++) {
    const int element = e < mesh->n_elements ? e : mesh->n_elements - 1, cell = element / parts, part = element % parts;
    const int at[3] = {cell % n, cell / n % n, s->dim == 3 ? cell / n / n : 0};

    for (int a = 0; a < s->nodes; a++) {
      int to[3] = {at[0], at[1], at[2]};

      if (s->dim == 2) {
        const int corner = s->nodes == 3 ? halves[part][a] : a;

        for (int d = 0; d < 2; d++) to[d] += square[corner][d];
      } else {
        const int *axes = path[part], order[3] = {axes[0], axes[1], 3 - axes[0] - axes[1]};
        const int  edges = part < 3 || a == 0 || a == 3 ? a : 3 - a; /* mirrored ones the other way round */

        for (int d = 0; d < edges; d++) to[order[d]]++;
      }
      mesh->nodes[s->nodes * e + a] = (to[2] * m + to[1]) * m + to[0];
    }
  }
}

/* A unit square or cube, the nodes moved off the regular grid a little */
static void SetUpMesh(Mesh *mesh, const Shape *s, int n)
{
  const double h = 1.0 / n;
  const int    m = n + 1, dim = s->dim, parts = dim == 3 ? 6 : 5 - s->nodes;

  mesh->lambda       = youngs_modulus * poissons_ratio / ((1 + poissons_ratio) * (1 - 2 * poissons_ratio));
  mesh->mu           = youngs_modulus / (2 * (1 + poissons_ratio));
  mesh->n_elements   = parts * (dim == 3 ? n * n * n : n * n);
  mesh->n_nodes      = dim == 3 ? m * m * m : m * m;
  mesh->nodes        = Allocate((size_t)s->nodes * ((size_t)mesh->n_elements + BATCH), sizeof(int));
  mesh->x            = Allocate((size_t)dim * (size_t)mesh->n_nodes, sizeof(double));
  mesh->u            = Allocate((size_t)dim * (size_t)mesh->n_nodes, sizeof(double));
  mesh->v            = Allocate((size_t)dim * (size_t)mesh->n_nodes, sizeof(double));
  mesh->f            = Allocate((size_t)dim * (size_t)mesh->n_nodes, sizeof(double));
  mesh->inverse_mass = Allocate((size_t)dim * (size_t)mesh->n_nodes, sizeof(double));
  SetNodes(mesh, s, n);
  for (int node = 0; node < mesh->n_nodes; node++) {
    const int at[3] = {node % m, node / m % m, node / m / m};
    double    cells = 1; /* that share the node */

    for (int d = 0; d < dim; d++) cells *= at[d] == 0 || at[d] == n ? 1 : 2;
    for (int d = 0; d < dim; d++) {
      mesh->x[dim * node + d]            = h * at[d] + 0.05 * h * sin(1 + d + node);
      mesh->v[dim * node + d]            = speed * cos(3.141592653589793 * h * at[d]);
      mesh->inverse_mass[dim * node + d] = (dim == 3 ? 8 : 4) / (cells * density * pow(h, dim));
    }
  }
}

static double GetSeconds(void)
{
  struct timespec now;

  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

CLONES static void Triad(double *a, const double *b, const double *c, size_t n)
{
  for (size_t i = 0; i < n; i++) a[i] = b[i] + 3 * c[i];
}

/* 16 chains of 8 numbers: enough to fill the pipelines of fused operations */
CLONES static double Multiply(int rounds, double factor)
{
  double sum = 0, a[16][8];

  for (int i = 0; i < 128; i++) a[i / 8][i % 8] = i;
  for (int r = 0; r < rounds; r++)
#pragma GCC unroll 16
    for (int i = 0; i < 16; i++)
#pragma omp simd
      for (int p = 0; p < 8; p++) a[i][p] = a[i][p] * factor + 1e-3;
  for (int i = 0; i < 128; i++) sum += a[i / 8][i % 8];
  return sum;
}

static int MeasureMachine(int millions)
{
  const size_t n      = (size_t)millions * 1000000;
  const int    rounds = 20000000;
  double *a = Allocate(n, sizeof(double)), *b = Allocate(n, sizeof(double)), *c = Allocate(n, sizeof(double)), bandwidth = 0, rate, sum;

  for (int repeat = 0; repeat < 5; repeat++) {
    const double start = GetSeconds();

    Triad(a, b, c, n);
    bandwidth = fmax(bandwidth, 32e-9 * (double)n / (GetSeconds() - start)); /* what is written has to be read first */
  }
  rate = GetSeconds();
  sum  = Multiply(rounds, 0.999);
  rate = 256e-9 * rounds / (GetSeconds() - rate);
  printf("{\"bandwidth_GB_per_s\": %.3f, \"GFLOP_per_s\": %.3f, \"check\": %.3g}\n", bandwidth, rate, sum + a[n / 2]);
  free(a);
  free(b);
  free(c);
  return 0;
}

/* Additions and multiplications of an element in a step, a division counted as one, with those of its share of the nodes */
static double CountOperations(const Shape *s, bool neo_hookean, double nodes_per_element)
{
  const int d = s->dim, simplices = s->points == 1;
  double    point, jacobian       = simplices ? d * d : 2 * s->nodes * d * d;

  point = 2 * jacobian + (d == 3 ? 27 + 5 : 3) + 1; /* gradients, cofactors, determinant */
  point += 2 * d * d * d;                           /* H */
  if (neo_hookean) point += (d == 3 ? 3 + 27 + 5 : 2 + 3) + 5 + 3 * d * d + d;
  else point += d - 1 + 1 + 2 * d + d * (d - 1);
  point += d * d * (2 * d - 1) + d * d + (simplices ? d * (d - 1) : 2 * s->nodes * d * d); /* stress to the nodes */
  return s->points * point + s->nodes * d + 5 * d * nodes_per_element;
}

int main(int argc, char **argv)
{
  const char *name  = NULL;
  int         cells = 20, steps = 100;
  bool        neo_hookean = false;
  Shape       shape;
  Mesh        mesh;

  for (int i = 1; i < argc; i++) {
    if (i + 1 < argc && !strcmp(argv[i], "--shape")) name = argv[++i];
    else if (i + 1 < argc && !strcmp(argv[i], "--cells")) cells = atoi(argv[++i]);
    else if (i + 1 < argc && !strcmp(argv[i], "--steps")) steps = atoi(argv[++i]);
    else if (i + 1 < argc && !strcmp(argv[i], "--material") && (!strcmp(argv[i + 1], "linear") || !strcmp(argv[i + 1], "neo_hookean")))
      neo_hookean = !strcmp(argv[++i], "neo_hookean");
    else name = "";
  }
  if (!name || (strcmp(name, "tri3") && strcmp(name, "quad4") && strcmp(name, "tet4") && strcmp(name, "machine")))
    return fprintf(stderr, "usage: %s --shape tri3|quad4|tet4|machine [--cells n] [--steps m] [--material linear|neo_hookean]\n", argv[0]),
           1;
  if (cells < 1 || steps < 1) return fprintf(stderr, "--cells and --steps must be positive\n"), 1;
  if (!strcmp(name, "machine")) return MeasureMachine(cells);
  SetShape(&shape, name);
  SetUpMesh(&mesh, &shape, cells);
  {
    void (*const add_forces)(const Mesh *, const Shape *, bool) = shape.dim == 3 ? AddTet4 : shape.nodes == 3 ? AddTri3 : AddQuad4;
    /* the fastest wave crosses a tenth of a cell in a step; u at t, v half a step later */
    const double dt      = 0.1 / cells / sqrt((mesh.lambda + 2 * mesh.mu) / density);
    const double initial = KineticEnergy(&mesh, shape.dim, 0), n_dofs = shape.dim * (double)mesh.n_nodes;
    const double share = (double)mesh.n_nodes / mesh.n_elements;
    double       energy, cpu = GetSeconds();

    for (int step = 0; step < steps; step++) {
      const double kick = step ? dt : dt / 2;

      memset(mesh.f, 0, (size_t)n_dofs * sizeof(double));
      add_forces(&mesh, &shape, neo_hookean);
      for (int k = 0; k < shape.dim * mesh.n_nodes; k++) {
        mesh.v[k] -= kick * mesh.f[k] * mesh.inverse_mass[k];
        mesh.u[k] += dt * mesh.v[k];
      }
    }
    cpu = GetSeconds() - cpu;
    memset(mesh.f, 0, (size_t)n_dofs * sizeof(double));
    add_forces(&mesh, &shape, neo_hookean);
    energy = KineticEnergy(&mesh, shape.dim, dt / 2) + StoredEnergy(&mesh, &shape, neo_hookean);
    /* of memory: x, u read and f written, read first, and the update's f, v, u, masses, of which v and u are written */
    printf("{\"shape\": \"%s\", \"elements\": %d, \"nodes\": %d, \"steps\": %d, \"material\": \"%s\", \"cpu_us_per_element_step\": %.6f, "
           "\"flop_per_element_step\": %.1f, \"bytes_per_element_step\": %.1f, \"energy_error\": %.3e}\n",
           name, mesh.n_elements, mesh.n_nodes, steps, neo_hookean ? "neo_hookean" : "linear", 1e6 * cpu / steps / mesh.n_elements,
           CountOperations(&shape, neo_hookean, share), 4.0 * shape.nodes + 8.0 * shape.dim * share * (1 + 4 + 6), energy / initial - 1);
  }
  free(mesh.nodes);
  free(mesh.x);
  free(mesh.u);
  free(mesh.v);
  free(mesh.f);
  free(mesh.inverse_mass);
  return 0;
}
