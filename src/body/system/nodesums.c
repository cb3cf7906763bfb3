/* Sums over the nodes of a body that its kinetic energy, momenta, mean rotation and, where it is linear, potential energy are made of. What
   they take is the time in which the vectors come from memory, so that all are made in one pass. */
#include <body/layout/bodyimpl.h>
#include <impakt/private/simd.h>

/* What is summed up: m v.v, m a.a and u.f, then vectors: m v, (X + u) x m v, m (X - C) x u, m (X + u) */
enum { KINETIC = 0, STAGGERED = 1, POTENTIAL = 2, MOMENTUM = 3, ANGULAR = 6, TURNED = 9, PLACE = 12, QUANTITIES = 15 };
/* In one dimension sums have four parts: each addition to a single one would wait for the one before */
#define PARTS 4
#define BLOCK 64

typedef struct {
  PetscInt           n;       /* nodes */
  const PetscScalar *x, *u;   /* per dof: reference positions and displacements [m] */
  const PetscScalar *v, *a;   /* velocities, and accelerations */
  const PetscScalar *mass;    /* row sums of the mass matrix */
  const PetscScalar *mv, *ma; /* products with it, where it is not diagonal */
  const PetscScalar *force;   /* internal forces of a linear body [N] */
  const PetscReal   *centre;  /* of mass, of the undeformed body [m] */
} Nodes;

/* c += a x b, the latter in part k of the sums; plane vectors have an area alone, and there is none on a line */
SIMD_INLINE void AddProduct(PetscInt dim, PetscInt k, const PetscReal a[], const PetscReal b[], PetscReal c[3][PARTS])
{
  if (dim == 2) c[2][k] += a[0] * b[1] - a[1] * b[0];
  if (dim < 3) return;
  for (PetscInt d = 0; d < 3; d++) c[d][k] += a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3];
}

/* Node i, to part k of the sums */
SIMD_INLINE void AddNode(PetscInt dim, PetscBool diagonal, PetscBool linear, PetscBool staggered, const Nodes *nodes, PetscInt i,
                         PetscInt k, PetscReal sum[QUANTITIES][PARTS])
{
  PetscReal place[3], momentum[3], arm[3];

  for (PetscInt d = 0; d < dim; d++) {
    const PetscInt dof = i * dim + d;

    momentum[d] = diagonal ? nodes->mass[dof] * nodes->v[dof] : nodes->mv[dof];
    place[d]    = nodes->x[dof] + nodes->u[dof];
    arm[d]      = nodes->mass[dof] * (nodes->x[dof] - nodes->centre[d]);
    sum[KINETIC][k] += nodes->v[dof] * momentum[d];
    if (staggered) sum[STAGGERED][k] += nodes->a[dof] * (diagonal ? nodes->mass[dof] * nodes->a[dof] : nodes->ma[dof]);
    sum[MOMENTUM + d][k] += momentum[d];
    sum[PLACE + d][k] += nodes->mass[dof] * place[d];
    if (linear) sum[POTENTIAL][k] += nodes->u[dof] * nodes->force[dof];
  }
  AddProduct(dim, k, place, momentum, sum + ANGULAR);
  if (linear) AddProduct(dim, k, arm, nodes->u + i * dim, sum + TURNED);
}

/* Block by block, whose sums are so much smaller than all that round-off is too */
SIMD_INLINE void AddNodes(PetscInt dim, PetscBool diagonal, PetscBool linear, PetscBool staggered, const Nodes *nodes,
                          PetscReal sums[QUANTITIES])
{
  const PetscInt parts = dim == 1 ? PARTS : 1;

  for (PetscInt q = 0; q < QUANTITIES; q++) sums[q] = 0;
  for (PetscInt begin = 0; begin < nodes->n; begin += BLOCK) {
    const PetscInt end = PetscMin(begin + BLOCK, nodes->n), whole = end - (end - begin) % parts;
    PetscReal      sum[QUANTITIES][PARTS] = {{0}};

    for (PetscInt i = begin; i < whole; i += parts)
      for (PetscInt k = 0; k < parts; k++) AddNode(dim, diagonal, linear, staggered, nodes, i + k, k, sum);
    for (PetscInt i = whole; i < end; i++) AddNode(dim, diagonal, linear, staggered, nodes, i, 0, sum);
    for (PetscInt q = 0; q < QUANTITIES; q++)
      for (PetscInt k = 0; k < parts; k++) sums[q] += sum[q][k];
  }
}

/* A loop for each case, with what does not change in it known to the compiler */
SIMD_INLINE void AddIn(PetscInt dim, PetscBool diagonal, PetscBool linear, PetscBool staggered, const Nodes *nodes,
                       PetscReal sums[QUANTITIES])
{
  if (diagonal && linear) AddNodes(dim, PETSC_TRUE, PETSC_TRUE, staggered, nodes, sums);
  else if (diagonal) AddNodes(dim, PETSC_TRUE, PETSC_FALSE, staggered, nodes, sums);
  else if (linear) AddNodes(dim, PETSC_FALSE, PETSC_TRUE, staggered, nodes, sums);
  else AddNodes(dim, PETSC_FALSE, PETSC_FALSE, staggered, nodes, sums);
}

SIMD_INLINE void AddAny(PetscInt dim, PetscBool diagonal, PetscBool linear, PetscBool staggered, const Nodes *nodes,
                        PetscReal sums[QUANTITIES])
{
  if (staggered) AddIn(dim, diagonal, linear, PETSC_TRUE, nodes, sums);
  else AddIn(dim, diagonal, linear, PETSC_FALSE, nodes, sums);
}

SIMD_CLONES static void Add(PetscInt dim, PetscBool diagonal, PetscBool linear, PetscBool staggered, const Nodes *nodes,
                            PetscReal sums[QUANTITIES])
{
  if (dim == 1) AddAny(1, diagonal, linear, staggered, nodes, sums);
  else if (dim == 2) AddAny(2, diagonal, linear, staggered, nodes, sums);
  else AddAny(3, diagonal, linear, staggered, nodes, sums);
}

/* Of this rank's nodes: kinetic energy, staggered for central differences and as it is [J], half the work of the internal forces
   of a linear body [J], momentum, angular momentum, sum m (X - C) x u of a linear body, and sum m (X + u) */
PetscErrorCode BodySumNodes(Body body, PetscReal *kinetic, PetscReal *moving, PetscReal *half_work, PetscReal momentum[3],
                            PetscReal angular[3], PetscReal turned[3], PetscReal place[3])
{
  const PetscReal staggered = body->integrator->staggered * PetscSqr(body->time.step);
  const Vec       a      = staggered > 0 ? body->state.a : body->state.v; /* what is not asked for costs least where it is read already */
  const Vec       force  = body->state.internal_force ? body->state.internal_force : body->state.u;
  const Vec       vecs[] = {body->mesh.positions,
                            body->state.u,
                            body->state.v,
                            a,
                            body->mass.row_sum,
                            body->work.nodes[0],
                            body->work.nodes[staggered > 0],
                            force};
  Nodes           nodes  = {.n = body->mesh.owned_nodes, .centre = body->mass.centre};
  const PetscScalar **const arrays[] = {&nodes.x, &nodes.u, &nodes.v, &nodes.a, &nodes.mass, &nodes.mv, &nodes.ma, &nodes.force};
  const PetscInt            n_arrays = PETSC_STATIC_ARRAY_LENGTH(vecs);
  PetscReal                 sums[QUANTITIES];

  PetscFunctionBegin;
  if (!body->mass.diagonal) {
    PetscCall(BodyMultiplyMass(body, body->state.v, body->work.nodes[0]));
    if (staggered > 0) PetscCall(BodyMultiplyMass(body, a, body->work.nodes[1]));
  }
  for (PetscInt k = 0; k < n_arrays; k++) PetscCall(VecGetArrayRead(vecs[k], arrays[k]));
  Add(body->mesh.dim, (PetscBool)(body->mass.diagonal != NULL), body->model.linear, (PetscBool)(staggered > 0), &nodes, sums);
  for (PetscInt k = n_arrays - 1; k >= 0; k--) PetscCall(VecRestoreArrayRead(vecs[k], arrays[k]));
  *kinetic   = 0.5 * (staggered > 0 ? sums[KINETIC] - staggered * sums[STAGGERED] : sums[KINETIC]);
  *moving    = 0.5 * sums[KINETIC];
  *half_work = 0.5 * sums[POTENTIAL];
  PetscCall(PetscArraycpy(momentum, sums + MOMENTUM, 3));
  PetscCall(PetscArraycpy(angular, sums + ANGULAR, 3));
  PetscCall(PetscArraycpy(turned, sums + TURNED, 3));
  PetscCall(PetscArraycpy(place, sums + PLACE, 3));
  if (!body->model.element->axisymmetric) PetscFunctionReturn(PETSC_SUCCESS);
  /* around the ring it adds up to nothing but what goes along the axis */
  momentum[0] = place[0] = 0;
  PetscCall(PetscArrayzero(angular, 3));
  PetscCall(PetscArrayzero(turned, 3));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodySumStaggering - a'Ma of this rank's nodes, for accelerations [N m/s^2]. Collective. */
PetscErrorCode BodySumStaggering(Body body, Vec accelerations, PetscReal *sum)
{
  PetscFunctionBegin;
  PetscCall(BodyMultiplyMass(body, accelerations, body->work.nodes[0]));
  PetscCall(BodyGetLocalDot(accelerations, body->work.nodes[0], sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}
