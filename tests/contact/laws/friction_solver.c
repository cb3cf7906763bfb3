/* Forces of nodes with friction, for random interfaces: the law holds at each node, in the plane and in space, with small and large
 * coefficients. */
#include "support.h"
#include <contact/laws/friction.h>

#define NODES  12
#define ROWS   (3 * NODES)
#define PLACES (ROWS + 4)

static PetscReal Random(void *state)
{
  unsigned *seed = (unsigned *)state;

  *seed = *seed * 1664525u + 1013904223u;
  return 2 * ((*seed >> 8) / (PetscReal)(1u << 24)) - 1;
}

typedef struct {
  PetscScalar      S[ROWS * ROWS], opened[ROWS], base[ROWS], limit[ROWS], force[ROWS], open[ROWS], diagonal[ROWS];
  FrictionState    state[NODES];
  FrictionProblem  problem;
  FrictionProducts products;
  PetscInt         count; /* of products */
} Problem;

static PetscErrorCode Multiply(void *data, const PetscScalar x[], PetscScalar y[])
{
  Problem       *p = (Problem *)data;
  const PetscInt n = p->problem.n;

  PetscFunctionBegin;
  p->count++;
  for (PetscInt i = 0; i < n; i++) {
    y[i] = 0;
    for (PetscInt j = 0; j < n; j++) y[i] += p->S[j * n + i] * x[j];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* From now on S is no matrix for the solver: it has products, and the diagonal for what it is about */
static void UseProducts(Problem *p)
{
  const PetscInt n = p->problem.n;

  p->products = (FrictionProducts){.data = p, .multiply = Multiply};
  for (PetscInt i = 0; i < n; i++) p->diagonal[i] = p->S[i * (n + 1)] > 0 ? 1.5 : 0;
  p->count            = 0;
  p->problem.S        = NULL;
  p->problem.products = &p->products;
  p->problem.diagonal = p->diagonal;
}

/* A compliance that is symmetric and positive definite, of the size of one per newton, and nodes that are pressed by about a metre and
 * moved across */
static void Fill(Problem *p, PetscInt dim, PetscReal coefficient, unsigned seed)
{
  const PetscInt n = dim * NODES;
  PetscReal      root[ROWS * PLACES];

  for (PetscInt k = 0; k < n * PLACES; k++) root[k] = Random(&seed) / PetscSqrtReal((PetscReal)PLACES);
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) {
      p->S[j * n + i] = i == j ? 1 : 0;
      for (PetscInt k = 0; k < PLACES; k++) p->S[j * n + i] += root[i * PLACES + k] * root[j * PLACES + k];
    }
  for (PetscInt i = 0; i < n; i++) {
    p->opened[i] = Random(&seed) - (i % dim ? 0 : 0.5);
    p->base[i]   = Random(&seed);
    p->force[i]  = p->base[i];
    p->limit[i]  = i % dim == 1 ? coefficient : 0;
  }
  p->problem = (FrictionProblem){
      .dim = dim, .n = n, .S = p->S, .opened = p->opened, .base = p->base, .limit = p->limit, .force = p->force, .state = p->state};
  for (PetscInt node = 0; node < NODES; node++) p->state[node] = FRICTION_OPEN;
}

/* What rows open by under the forces found */
static void Open(Problem *p)
{
  const PetscInt n = p->problem.n;

  for (PetscInt i = 0; i < n; i++) {
    p->open[i] = p->opened[i];
    for (PetscInt j = 0; j < n; j++) p->open[i] += p->S[j * n + i] * (p->force[j] - p->base[j]);
  }
}

/* The law at a node, to round-off of metres and newtons of size 1 */
static FrictionState CheckNode(const Problem *p, PetscInt node)
{
  const PetscInt     dim = p->problem.dim;
  const PetscScalar *f = p->force + node * dim, *g = p->open + node * dim;
  const PetscReal    bound = p->limit[node * dim + 1] * f[0], small = 1e-10;
  PetscReal          force = 0, slip = 0, work = 0;

  assert_true(f[0] >= -small && g[0] >= -small && PetscAbsReal(f[0] * g[0]) <= small);
  for (PetscInt k = 1; k < dim; k++) {
    force += PetscSqr(f[k]);
    slip += PetscSqr(g[k]);
    work += f[k] * g[k];
  }
  force = PetscSqrtReal(force);
  slip  = PetscSqrtReal(slip);
  assert_true(force <= bound + small);
  if (f[0] <= small) return FRICTION_OPEN;
  if (slip <= small) return FRICTION_STICKS;
  assert_true(PetscAbsReal(force - bound) <= small);
  assert_true(PetscAbsReal(work + force * slip) <= small); /* against the slip */
  return FRICTION_SLIDES;
}

static void law_holds(PetscBool products)
{
  const PetscReal coefficients[] = {0, 0.1, 0.3, 0.6, 1};
  FrictionSolver  solver;
  Problem         p;
  PetscInt        seen[3] = {0, 0, 0};

  ok(FrictionSolverCreate(&solver));
  for (PetscInt dim = 2; dim <= 3; dim++)
    for (size_t c = 0; c < PETSC_STATIC_ARRAY_LENGTH(coefficients); c++)
      for (unsigned seed = 1; seed <= 40; seed++) {
        PetscBool solved, by_nodes;

        Fill(&p, dim, coefficients[c], seed);
        if (products) UseProducts(&p);
        ok(FrictionSolverSolve(solver, &p.problem, &solved, &by_nodes));
        assert_true(solved);
        Open(&p);
        for (PetscInt node = 0; node < NODES; node++) seen[CheckNode(&p, node)]++;
      }
  for (PetscInt k = 0; k < 3; k++) assert_true(seen[k] > 100);
  ok(FrictionSolverDestroy(&solver));
}

/* Every third node is held across its normal, and dragged past its partner by what nothing changes */
static void law_holds_where_nodes_are_held(PetscBool products)
{
  FrictionSolver solver;
  Problem        p;
  PetscInt       seen[3] = {0, 0, 0};
  PetscBool      solved, by_nodes;

  ok(FrictionSolverCreate(&solver));
  for (PetscInt dim = 2; dim <= 3; dim++)
    for (unsigned seed = 1; seed <= 40; seed++) {
      const PetscInt n = dim * NODES;

      Fill(&p, dim, 0.3, seed);
      for (PetscInt node = 0; node < NODES; node += 3)
        for (PetscInt i = node * dim + 1; i < (node + 1) * dim; i++)
          for (PetscInt j = 0; j < n; j++) p.S[i * n + j] = p.S[j * n + i] = 0;
      if (products) UseProducts(&p);
      ok(FrictionSolverSolve(solver, &p.problem, &solved, &by_nodes));
      assert_true(solved);
      Open(&p);
      for (PetscInt node = 0; node < NODES; node += 3) seen[CheckNode(&p, node)]++;
    }
  assert_true(seen[FRICTION_SLIDES] > 100 && seen[FRICTION_STICKS] == 0);
  /* without a slip there is no force */
  Fill(&p, 2, 0.3, 1);
  for (PetscInt j = 0; j < 2 * NODES; j++) p.S[2 * NODES + j] = p.S[j * 2 * NODES + 1] = 0;
  p.opened[0] = -1;
  p.opened[1] = p.problem.still = 1e-12;
  if (products) UseProducts(&p);
  ok(FrictionSolverSolve(solver, &p.problem, &solved, &by_nodes));
  assert_true(solved && p.force[0] > 0 && p.force[1] == 0 && p.state[0] == FRICTION_STICKS);
  ok(FrictionSolverDestroy(&solver));
}

/* Every third node is held in one of two directions across its normal, as in a plane of symmetry: dragged there in every second problem,
   and without friction there in the others */
static void law_holds_where_nodes_are_held_in_one_direction(PetscBool products)
{
  const PetscInt dim = 3, n = dim * NODES;
  FrictionSolver solver;
  Problem        p;
  PetscInt       seen[2][3] = {{0}};
  PetscBool      solved, by_nodes;

  ok(FrictionSolverCreate(&solver));
  for (unsigned seed = 1; seed <= 80; seed++) {
    const PetscInt dragged = seed % 2;

    Fill(&p, dim, 0.3, seed);
    for (PetscInt node = 0; node < NODES; node += 3) {
      const PetscInt i = node * dim + 1 + (PetscInt)(seed / 2) % 2;

      for (PetscInt j = 0; j < n; j++) p.S[i * n + j] = p.S[j * n + i] = 0;
      if (!dragged) p.opened[i] = 0;
    }
    if (products) UseProducts(&p);
    ok(FrictionSolverSolve(solver, &p.problem, &solved, &by_nodes));
    assert_true(solved);
    Open(&p);
    for (PetscInt node = 0; node < NODES; node += 3) {
      seen[dragged][CheckNode(&p, node)]++;
      if (!dragged) assert_true(p.force[node * dim + 1 + (PetscInt)(seed / 2) % 2] == 0);
    }
  }
  assert_true(seen[0][FRICTION_SLIDES] > 20 && seen[0][FRICTION_STICKS] > 20);
  assert_true(seen[1][FRICTION_SLIDES] > 40 && seen[1][FRICTION_STICKS] == 0);
  ok(FrictionSolverDestroy(&solver));
}

static void law_holds_by_factors(void **state)
{
  (void)state;
  law_holds(PETSC_FALSE);
  law_holds_where_nodes_are_held(PETSC_FALSE);
  law_holds_where_nodes_are_held_in_one_direction(PETSC_FALSE);
}

static void law_holds_by_products(void **state)
{
  (void)state;
  law_holds(PETSC_TRUE);
  law_holds_where_nodes_are_held(PETSC_TRUE);
  law_holds_where_nodes_are_held_in_one_direction(PETSC_TRUE);
}

/* One node at a time: the same law */
static void law_holds_at_a_node(void **state)
{
  Problem p;

  (void)state;
  for (PetscInt dim = 2; dim <= 3; dim++)
    for (unsigned seed = 1; seed <= 200; seed++) {
      PetscReal S[9], open[3], limit[2], force[3];

      Fill(&p, dim, 0.4, seed);
      for (PetscInt i = 0; i < dim; i++) {
        open[i] = PetscRealPart(p.opened[i]);
        for (PetscInt j = 0; j < dim; j++) S[j * dim + i] = PetscRealPart(p.S[j * p.problem.n + i]);
      }
      limit[0] = 0;
      limit[1] = 0.4;
      ok(FrictionSolveNode(dim, S, open, limit, force));
      for (PetscInt i = 0; i < dim; i++) {
        p.force[i] = force[i];
        p.open[i]  = open[i];
        for (PetscInt j = 0; j < dim; j++) p.open[i] += S[j * dim + i] * force[j];
      }
      (void)CheckNode(&p, 0);
    }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(law_holds_by_factors),
      cmocka_unit_test(law_holds_by_products),
      cmocka_unit_test(law_holds_at_a_node),
  };

  return impakt_main(argc, argv, tests);
}
