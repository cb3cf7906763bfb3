/*
   Yardstick for the CPU time of Impakt: the high speed impact of two bars in one dimension (J. Hoy, I. Tezaur, A. Mota,
   "The Schwarz alternating method for multiscale contact mechanics", table 4.2), solved by the Dirichlet-Neumann Schwarz
   alternation written down directly for this one problem, without PETSc and without MPI.

     gcc -O2 -std=c11 -Wall -Wextra -Werror tests/scaling/yardstick.c -lm
     ./a.out --mode II|EE|IE|default [--recheck 0|1] [--traction linear|constant] [--redistribute 0|1]

   II, EE: both bars implicit or both explicit with 1e-7 s; IE: left bar implicit with 1e-7 s, right one explicit with
   1e-8 s. --recheck 1 redoes a step without contact where the converged contact force pulls. --traction is how the
   force handed over runs through the substeps: linearly to its value at the end of the step, or constant at that value;
   it matters for IE only, where constant gives the small chatter and the larger loss of energy that the paper shows
   (figures 4.7 and 4.8). --redistribute 1 moves the mass of the contact node to its neighbour, relaxes the trace by
   1/2, and stops on the change of the trace. default: what Impakt does by default, in place of an alternation: both bars implicit, averaged
   mass (the mean of lumped and consistent), massless contact nodes, and the one contact force that closes the gap at the end of the step,
   found from the compliance of both contact nodes between elimination and back-substitution. The result is one line of JSON on standard
   output. SI units throughout.
*/
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
  N          = 200, /* elements in a bar; node N is the contact node, in both bars, node 0 the far end */
  NODES      = N + 1,
  STEPS      = 10000,
  MAX_SWEEPS = 100
};

static const double density = 1000, youngs_modulus = 1e9, cross_section = 1e-6;
static const double bar_length = 0.25, half_gap = 0.02, impact_speed = 100;
static const double time_start = -2e-4, time_step = 1e-7; /* of the controller */
static const double absolute_tolerance = 1e-12, relative_tolerance = 1e-15;

typedef struct {
  double u[NODES], v[NODES], a[NODES];
} State;

typedef struct {
  bool   implicit, massless; /* massless: the contact node has no mass */
  int    substeps;           /* in a controller step */
  double dt, k;              /* substep; stiffness of an element */
  double x[NODES];           /* initial coordinates */
  double m[NODES], inverse_m[NODES];
  double g[NODES], q[NODES]; /* factors of the effective stiffness K + 4 M / dt^2, see NewmarkStep() */
  double inverse_pivot;      /* of the contact node */
  /* averaged mass: next to the diagonal of the mass and of the effective matrix, and the inverse pivots of all nodes */
  double m_next[N], next[N], inverse_pivots[NODES];
  /* states at the start of the controller step, at the end of the latest sweep, of the one before, and spare */
  State *start, *now, *before, *spare;
  State  storage[4];
} Body;

typedef struct {
  double x, v, a; /* position, velocity, acceleration of a contact node */
} Trace;

typedef struct {
  bool   prescribed; /* the contact node follows trace, else it carries a force, linear in time over the step */
  Trace  trace;
  double force_start, force_end;
} Boundary;

static void Swap(State **a, State **b)
{
  State *t = *a;

  *a = *b;
  *b = t;
}

static void BodyCreate(Body *b, bool right, bool implicit, int substeps, bool redistribute)
{
  const double h = bar_length / N, side = right ? 1 : -1;
  double       inverse_pivot = 0;

  memset(b, 0, sizeof(*b));
  b->start    = &b->storage[0];
  b->now      = &b->storage[1];
  b->before   = &b->storage[2];
  b->spare    = &b->storage[3];
  b->implicit = implicit;
  b->massless = redistribute;
  b->substeps = substeps;
  b->dt       = time_step / substeps;
  b->k        = youngs_modulus * cross_section / h;
  for (int i = 0; i < NODES; i++) {
    b->x[i]        = side * (half_gap + bar_length - i * h);
    b->m[i]        = density * cross_section * h * (i == 0 || i == N ? 0.5 : 1);
    b->start->v[i] = -side * impact_speed;
  }
  if (redistribute) {
    b->m[N - 1] += b->m[N];
    b->m[N] = 0;
  }
  for (int i = 0; i < NODES; i++) {
    const double inertia = 4 / (b->dt * b->dt) * b->m[i];

    b->inverse_m[i] = b->m[i] > 0 ? 1 / b->m[i] : 0;
    inverse_pivot   = 1 / (inertia + b->k * (i == 0 || i == N ? 1 : 2) - b->k * b->k * inverse_pivot);
    b->g[i]         = b->k * inverse_pivot;
    b->q[i]         = inertia * inverse_pivot;
  }
  b->inverse_pivot = inverse_pivot;
}

/* The mean of lumped and consistent mass, that of the contact node given to its neighbour, and the factors of K + 4 M / dt^2 with it */
static void UseAveragedMass(Body *b)
{
  const double h = bar_length / N, c = 4 / (b->dt * b->dt), element = density * cross_section * h;

  b->massless = true;
  for (int i = 0; i < NODES; i++) b->m[i] = 0;
  for (int i = 0; i < N; i++) {
    const bool last = i == N - 1;

    b->m[i] += element * (last ? 1 : 5. / 12);
    if (!last) b->m[i + 1] += element * 5 / 12;
    b->m_next[i] = last ? 0 : element / 12;
    b->next[i]   = c * b->m_next[i] - b->k;
  }
  for (int i = 0; i < NODES; i++) {
    const double pivot = c * b->m[i] + b->k * (i == 0 || i == N ? 1 : 2);

    b->inverse_pivots[i] = 1 / (i ? pivot - b->next[i - 1] * b->next[i - 1] * b->inverse_pivots[i - 1] : pivot);
  }
}

/* Force that the bar's own deformation puts on its contact node; negative in a compressed left bar */
static double InternalForce(const Body *b, const State *s)
{
  return b->k * (s->u[N] - s->u[N - 1]);
}

static Trace TraceOf(const Body *b, const State *s)
{
  return (Trace){b->x[N] + s->u[N], s->v[N], s->a[N]};
}

/*
   beta = 1/4, gamma = 1/2. The tridiagonal system (K + c M) u = c M p + f, c = 4 / dt^2, p the predictor, by Thomas'
   algorithm with scaled rows, which has the same factors g going forth and back. The contact node comes last in the
   elimination, so that prescribing it leaves all other factors as they are.
*/
static void NewmarkStep(const Body *b, const State *restrict from, State *restrict to, const Boundary *bc, double force)
{
  const double dt = b->dt, half_dt = 0.5 * dt, quarter_dt2 = 0.25 * dt * dt, c = 4 / (dt * dt);
  double       z = 0;

  for (int i = 0; i < NODES; i++) {
    const double p = from->u[i] + dt * from->v[i] + quarter_dt2 * from->a[i];

    z        = b->q[i] * p + b->g[i] * z;
    to->a[i] = p;
    to->u[i] = z;
  }
  to->u[N] += b->inverse_pivot * force;
  if (bc->prescribed) to->u[N] = bc->trace.x - b->x[N];
  for (int i = N - 1; i >= 0; i--) to->u[i] += b->g[i] * to->u[i + 1];
  for (int i = 0; i < NODES; i++) {
    to->a[i] = c * (to->u[i] - to->a[i]);
    to->v[i] = from->v[i] + half_dt * (from->a[i] + to->a[i]);
  }
}

/* The elimination of a step with averaged mass: to->u[N] is where the contact node gets without a force on it */
static void Eliminate(const Body *b, const State *restrict from, State *restrict to)
{
  const double dt = b->dt, quarter_dt2 = 0.25 * dt * dt, c = 4 / (dt * dt);
  double       z = 0;

  for (int i = 0; i < NODES; i++) to->a[i] = from->u[i] + dt * from->v[i] + quarter_dt2 * from->a[i];
  for (int i = 0; i < NODES; i++) {
    double load = b->m[i] * to->a[i];

    if (i) load += b->m_next[i - 1] * to->a[i - 1];
    if (i < N) load += b->m_next[i] * to->a[i + 1];
    z        = b->inverse_pivots[i] * (c * load - (i ? b->next[i - 1] : 0) * z);
    to->u[i] = z;
  }
}

/* All other nodes, when the contact node is in its place */
static void Substitute(const Body *b, const State *restrict from, State *restrict to)
{
  const double dt = b->dt, half_dt = 0.5 * dt, c = 4 / (dt * dt);

  for (int i = N - 1; i >= 0; i--) to->u[i] -= b->inverse_pivots[i] * b->next[i] * to->u[i + 1];
  for (int i = 0; i < N; i++) {
    to->a[i] = c * (to->u[i] - to->a[i]);
    to->v[i] = from->v[i] + half_dt * (from->a[i] + to->a[i]);
  }
  to->a[N] = 0;
  to->v[N] = (to->u[N] - from->u[N]) / dt;
}

/* A step of both bars under the force that keeps them from overlapping; whether there is one */
static bool CompliantStep(Body *left, Body *right)
{
  double overlap, force = 0;

  Eliminate(left, left->start, left->now);
  Eliminate(right, right->start, right->now);
  overlap = left->x[N] + left->now->u[N] - right->x[N] - right->now->u[N];
  if (overlap > 0) {
    force = overlap / (left->inverse_pivots[N] + right->inverse_pivots[N]);
    left->now->u[N] -= left->inverse_pivots[N] * force;
    right->now->u[N] += right->inverse_pivots[N] * force;
  }
  Substitute(left, left->start, left->now);
  Substitute(right, right->start, right->now);
  return force > 0;
}

static void CentralDifferenceStep(const Body *b, const State *restrict from, State *restrict to, const Boundary *bc, double force)
{
  const double dt = b->dt, half_dt = 0.5 * dt, k = b->k;

  for (int i = 0; i < NODES; i++) {
    to->v[i] = from->v[i] + half_dt * from->a[i];
    to->u[i] = from->u[i] + dt * to->v[i];
  }
  /* without mass the node is in static balance with its neighbour and the force */
  if (bc->prescribed) to->u[N] = bc->trace.x - b->x[N];
  else if (b->massless) to->u[N] = to->u[N - 1] + force / k;
  to->a[0] = k * (to->u[1] - to->u[0]) * b->inverse_m[0];
  for (int i = 1; i < N; i++) to->a[i] = k * (to->u[i - 1] - 2 * to->u[i] + to->u[i + 1]) * b->inverse_m[i];
  to->a[N] = (force - k * (to->u[N] - to->u[N - 1])) * b->inverse_m[N];
  for (int i = 0; i < NODES; i++) to->v[i] += half_dt * to->a[i];
}

/* From the start of the controller step to its end; the previous result is kept in before */
static void BodyAdvance(Body *b, const Boundary *bc)
{
  const State *from = b->start;

  Swap(&b->now, &b->before);
  for (int s = 1; s <= b->substeps; s++) {
    const double force = bc->force_start + (bc->force_end - bc->force_start) * s / b->substeps;

    if (s > 1) {
      Swap(&b->now, &b->spare);
      from = b->spare;
    }
    if (b->implicit) NewmarkStep(b, from, b->now, bc, force);
    else CentralDifferenceStep(b, from, b->now, bc, force);
    if (bc->prescribed) {
      b->now->v[N] = bc->trace.v;
      b->now->a[N] = bc->trace.a;
    }
  }
}

static bool PositionsConverged(const Body *b)
{
  double change = 0, position = 0;

  for (int i = 0; i < NODES; i++) {
    const double d = b->now->u[i] - b->before->u[i];
    const double x = b->x[i] + b->now->u[i];

    change += d * d;
    position += x * x;
  }
  change = sqrt(change);
  return change < absolute_tolerance || change < relative_tolerance * sqrt(position);
}

/* For central differences the staggered energy, which is what the scheme conserves */
static void Energies(const Body *b, double *kinetic, double *potential)
{
  const State *s   = b->now;
  const double w   = b->implicit ? 0 : 0.25 * b->dt * b->dt;
  double       mvv = 0, maa = 0, dudu = 0;

  for (int i = 0; i < NODES; i++) {
    mvv += b->m[i] * s->v[i] * s->v[i];
    maa += b->m[i] * s->a[i] * s->a[i];
  }
  for (int i = 0; i < N; i++) mvv += 2 * b->m_next[i] * s->v[i] * s->v[i + 1];
  for (int i = 0; i < N; i++) dudu += (s->u[i + 1] - s->u[i]) * (s->u[i + 1] - s->u[i]);
  *kinetic   = 0.5 * (mvv - w * maa);
  *potential = 0.5 * b->k * dudu;
}

/* Both bars without contact; whether they overlap at the end */
static bool FreeStep(Body *left, Body *right)
{
  const Boundary none = {0};

  BodyAdvance(left, &none);
  BodyAdvance(right, &none);
  return right->x[N] + right->now->u[N] < left->x[N] + left->now->u[N];
}

/* The Schwarz alternation; returns the number of sweeps, 0 if it did not converge */
static int ContactStep(Body *left, Body *right, bool constant, bool redistribute)
{
  Boundary     dirichlet = {.prescribed = true, .trace = TraceOf(right, right->start)};
  Boundary     neumann   = {.force_start = -InternalForce(left, left->start)};
  const double theta     = redistribute ? 0.5 : 1;

  for (int sweep = 1; sweep <= MAX_SWEEPS; sweep++) {
    Trace *x = &dirichlet.trace, y;
    bool   converged;

    BodyAdvance(left, &dirichlet);
    neumann.force_end = -InternalForce(left, left->now);
    if (constant) neumann.force_start = neumann.force_end;
    BodyAdvance(right, &neumann);
    y = TraceOf(right, right->now);
    if (redistribute) converged = fabs(y.x - x->x) < absolute_tolerance;
    else converged = sweep > 1 && PositionsConverged(left) && PositionsConverged(right);
    if (converged) return sweep;
    x->x += theta * (y.x - x->x);
    x->v += theta * (y.v - x->v);
    x->a += theta * (y.a - x->a);
  }
  return 0;
}

/* Equation 4.5 of the paper */
static double ExactKinetic(double t)
{
  const double impact = time_start + half_gap / impact_speed, crossing = bar_length * sqrt(density / youngs_modulus);
  const double total = 0.5 * density * cross_section * bar_length * impact_speed * impact_speed;
  const double since = (t - impact) / crossing;

  return since < 0 || since > 2 ? total : total * fabs(1 - since);
}

static int Usage(void)
{
  fprintf(stderr, "usage: yardstick --mode II|EE|IE|default [--recheck 0|1] [--traction linear|constant] [--redistribute 0|1]\n");
  return 2;
}

int main(int argc, char **argv)
{
  static Body   left, right;
  static double force[STEPS + 1];
  const char   *mode    = "II";
  bool          recheck = false, constant = false, redistribute = false, contact = false, compliant;
  int           contact_steps = 0, onsets = 0, first = 0, last = 0, max_sweeps = 0, unconverged = 0;
  long          sweeps = 0, substeps = 0;
  double        energy_start = 0, energy_min = 0, energy_max = 0, energy_final = 0, error2 = 0, exact2 = 0;

  if (argc % 2 == 0) return Usage();
  for (int i = 1; i < argc; i += 2) {
    if (!strcmp(argv[i], "--mode")) mode = argv[i + 1];
    else if (!strcmp(argv[i], "--recheck")) recheck = atoi(argv[i + 1]);
    else if (!strcmp(argv[i], "--traction")) constant = !strcmp(argv[i + 1], "constant");
    else if (!strcmp(argv[i], "--redistribute")) redistribute = atoi(argv[i + 1]);
    else return Usage();
  }
  compliant = !strcmp(mode, "default");
  if (strcmp(mode, "II") && strcmp(mode, "EE") && strcmp(mode, "IE") && !compliant) return Usage();
  BodyCreate(&left, false, compliant || mode[0] == 'I', 1, redistribute);
  BodyCreate(&right, true, compliant || mode[1] == 'I', compliant || mode[0] == mode[1] ? 1 : 10, redistribute);
  if (compliant) {
    UseAveragedMass(&left);
    UseAveragedMass(&right);
  }

  struct timespec begin, end;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &begin);
  for (int n = 1; n <= STEPS; n++) {
    const bool had_contact = contact;
    double     kinetic[2], potential[2];

    /* push: contact in the step before, compressed at its end; otherwise overlap of the free trial step */
    contact = had_contact && InternalForce(&left, left.start) < 0;
    if (compliant) {
      contact = CompliantStep(&left, &right);
      substeps += 2;
      sweeps += contact;
      if (contact) max_sweeps = 1;
    } else if (!contact) {
      contact = FreeStep(&left, &right);
      substeps += left.substeps + right.substeps;
    }
    if (contact && !compliant) {
      const int count = ContactStep(&left, &right, constant, redistribute), done = count ? count : MAX_SWEEPS;

      unconverged += !count;
      sweeps += done;
      substeps += (long)done * (left.substeps + right.substeps);
      if (done > max_sweeps) max_sweeps = done;
      if (recheck && InternalForce(&left, left.now) > 0) {
        contact = FreeStep(&left, &right);
        substeps += left.substeps + right.substeps;
        /* they overlap: FreeStep() has kept the contact solution as the result before its own */
        if (contact) {
          Swap(&left.now, &left.before);
          Swap(&right.now, &right.before);
        }
      }
    }
    if (contact) {
      if (!had_contact) onsets++;
      if (!first) first = n;
      last     = n;
      force[n] = -InternalForce(&left, left.now);
      contact_steps++;
    }
    Energies(&left, &kinetic[0], &potential[0]);
    Energies(&right, &kinetic[1], &potential[1]);
    const double energy = kinetic[0] + kinetic[1] + potential[0] + potential[1];
    const double exact  = ExactKinetic(time_start + n * time_step);
    if (n == 1) energy_start = energy; /* the first step is free: nothing has changed yet */
    energy_final = energy / energy_start - 1;
    energy_min   = fmin(energy_min, energy_final);
    energy_max   = fmax(energy_max, energy_final);
    error2 += (kinetic[0] - exact) * (kinetic[0] - exact);
    exact2 += exact * exact;
    Swap(&left.start, &left.now);
    Swap(&right.start, &right.now);
  }
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);

  /* mean and scatter of the contact force over the middle three fifths of the contact interval */
  const int from = first + (last - first) / 5, to = last - (last - first) / 5;
  double    mean = 0, variance = 0;
  for (int n = from; n <= to; n++) mean += force[n] / (to - from + 1);
  for (int n = from; n <= to; n++) variance += (force[n] - mean) * (force[n] - mean) / (to - from + 1);

  printf(
      "{\"mode\": \"%s\", \"recheck\": %d, \"traction\": \"%s\", \"redistribute\": %d, \"cpu\": %.6f, \"steps\": %d, \"substeps\": %ld, ",
      mode, recheck, constant ? "constant" : "linear", redistribute,
      (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec), STEPS, substeps);
  printf("\"sweeps\": %ld, \"max_sweeps\": %d, \"unconverged_steps\": %d, \"mean_all_steps\": %.4f, \"mean_contact_steps\": %.4f, ", sweeps,
         max_sweeps, unconverged, (double)sweeps / STEPS, contact_steps ? (double)sweeps / contact_steps : 0);
  printf("\"contact_steps\": %d, \"onsets\": %d, \"release_time\": %.7e, ", contact_steps, onsets, time_start + last * time_step);
  printf("\"energy_error_min\": %.3e, \"energy_error_max\": %.3e, \"energy_error_final\": %.3e, ", energy_min, energy_max, energy_final);
  printf("\"force_mean\": %.6e, \"force_scatter\": %.3e, \"kinetic_error\": %.3e}\n", mean, sqrt(variance) / mean, sqrt(error2 / exact2));
  return unconverged ? 1 : 0;
}
