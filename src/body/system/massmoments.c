/* A body whose contact layer is massless keeps its total mass, its centre of mass and, where positive masses allow, its moments of inertia.

   The mass of the layer has gone to the nodes next to the layer, which moves the centre of mass inwards, and elements all of whose nodes
   are in the layer, as tetrahedra in corners are, have lost theirs. A smooth factor f(x) = s (1 + p(x)) on the mass that is left puts both
   back, s being the whole mass over what is left, p a polynomial and 1 + p kept above a bound. The factor acts on the lumped part of the
   mass matrix node by node, and on the consistent part of an element, whose symmetry and sign must stay, as its mean over the element's
   inner nodes. In a fine mesh f differs from 1 by terms of the size of the layer, so that waves do not feel the factor.

   With the fields phi = (1, x, y, z), the moments of M are the products phi_a' M phi_b. Momentum and angular momentum of a rigid motion
   depend on M through these alone. The moments are sums over the nodes of f times a weight of the node. Each condition says that a moment
   is what it is with the full mass. The polynomial p is a combination of the products phi_a phi_b: for a lumped M, it has the least sum of
   m p^2 of all functions that satisfy the conditions, and its coefficients are the multipliers of the conditions. The conditions are linear
   but for the bounds; Newton's method solves them for the coefficients. */
#include "massmoments.h"
#include <sys/units.h>
#include <petscblaslapack.h>

/* Bound of 1 + p where moments cannot be kept: on the ball of options/hertz-impact.opts a factor of 66 leaves 34.5 %, not 34.9 % */
#define MOST_FACTOR (1 / LEAST_FACTOR)
/* Conditions that no such factor satisfies become springs: the sum of the squares of what is missing, over twice the softness, is minimised
   together with half the sum of m p^2. The centre of mass is given up after the moments of inertia. */
#define SOFT_INERTIA 0.03
#define SOFT_CENTRE  1e-6
/* A centre of mass counts as kept within this part of the radii of gyration, a moment of inertia within this part of it */
#define KEPT 1e-11

/* phi' M phi of an element for each moment, field values by node; of a consistent mass, nodes x nodes */
static void AddConsistentMoments(const MomentsProblem *problem, const PetscScalar M[], PetscReal phi[][4], PetscReal scale,
                                 PetscReal moments[])
{
  const PetscInt n = problem->body->model.element->nodes;

  for (PetscInt i = 0; i < n; i++) {
    PetscReal product[4] = {0};

    for (PetscInt j = 0; j < n; j++)
      for (PetscInt a = 0; a < 4; a++) product[a] += M[i * n + j] * phi[j][a];
    for (PetscInt m = 0; m < problem->n_moments; m++) moments[m] += scale * phi[i][problem->pair[m][0]] * product[problem->pair[m][1]];
  }
}

/* And of a lumped one, by nodes */
static void AddLumpedMoments(const MomentsProblem *problem, const PetscScalar mass[], PetscReal phi[][4], PetscReal moments[])
{
  for (PetscInt i = 0; i < problem->body->model.element->nodes; i++)
    for (PetscInt m = 0; m < problem->n_moments; m++) moments[m] += mass[i] * phi[i][problem->pair[m][0]] * phi[i][problem->pair[m][1]];
}

/* The moments of the full mass in the fields as they are */
static PetscErrorCode ComputeFullMoments(const MomentsProblem *problem, PetscReal moments[])
{
  Body           body = problem->body;
  const PetscInt n    = body->model.element->nodes;
  PetscScalar    lumped[ELEMENT_MAX_NODES], consistent[ELEMENT_MAX_NODES * ELEMENT_MAX_NODES];
  PetscReal      phi[ELEMENT_MAX_NODES][4] = {{0}};

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(moments, problem->n_moments));
  for (PetscInt e = 0; e < body->model.element->count; e++) {
    PetscCall(BodyGetElementMassParts(body, e, PETSC_FALSE, lumped, consistent));
    for (PetscInt i = 0; i < n; i++) MomentsGetFields(problem, body->mesh.connectivity[e * n + i], phi[i]);
    AddLumpedMoments(problem, lumped, phi, moments);
    AddConsistentMoments(problem, consistent, phi, 1, moments);
  }
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, moments, (PetscMPIInt)problem->n_moments, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the mass at each node adds to the moments: lumped mass and its share of its elements' consistent part, scaled to the mass. */
static PetscErrorCode ComputeWeights(MomentsProblem *problem)
{
  Body           body = problem->body;
  const PetscInt n = body->model.element->nodes, n_moments = problem->n_moments;
  PetscScalar    lumped[ELEMENT_MAX_NODES], consistent[ELEMENT_MAX_NODES * ELEMENT_MAX_NODES];
  PetscReal      phi[ELEMENT_MAX_NODES][4] = {{0}};
  PetscReal      left                      = 0;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(body->mesh.local_nodes * n_moments, &problem->weights));
  for (PetscInt e = 0; e < body->model.element->count; e++) {
    const PetscInt *nodes              = body->mesh.connectivity + e * n;
    PetscReal       share[MAX_MOMENTS] = {0};
    PetscInt        inner              = 0;

    PetscCall(BodyGetElementMassParts(body, e, PETSC_TRUE, lumped, consistent));
    for (PetscInt i = 0; i < n; i++) {
      MomentsGetFields(problem, nodes[i], phi[i]);
      inner += !body->layer.contains[nodes[i]];
    }
    if (!inner) continue;
    AddConsistentMoments(problem, consistent, phi, 1 / (inner * problem->total), share);
    for (PetscInt i = 0; i < n; i++) {
      PetscReal *weights = problem->weights + nodes[i] * n_moments;

      if (body->layer.contains[nodes[i]]) continue;
      for (PetscInt m = 0; m < n_moments; m++)
        weights[m] += share[m] + lumped[i] * phi[i][problem->pair[m][0]] * phi[i][problem->pair[m][1]] / problem->total;
    }
  }
  for (PetscInt node = 0; node < body->mesh.local_nodes; node++) left += problem->weights[node * n_moments];
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &left, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  problem->scale = PetscAbsReal(left - 1) <= KEPT ? 1 : left > 0 ? 1 / left : 0;
  for (PetscInt i = 0; i < body->mesh.local_nodes * n_moments; i++) problem->weights[i] *= problem->scale;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The principal axes of the full mass, and its radii of gyration along them, from its moments in fields along the coordinates */
static PetscErrorCode FindAxes(MomentsProblem *problem, const PetscReal moments[])
{
  const PetscInt dim = problem->body->mesh.dim;
  PetscReal      J[9], squares[3], work[12];
  PetscBLASInt   order = (PetscBLASInt)dim, lwork = 12, info;

  PetscFunctionBegin;
  for (PetscInt m = dim + 1; m < problem->n_moments; m++) {
    const PetscInt a = problem->pair[m][0], b = problem->pair[m][1];

    J[(a - 1) * dim + b - 1] = J[(b - 1) * dim + a - 1] = problem->size[a - 1] * problem->size[b - 1] *
                                                          (moments[m] - moments[a] * moments[b] / problem->total) / problem->total;
  }
  for (PetscInt d = 0; d < dim; d++) problem->centre[d] += problem->size[d] * moments[1 + d] / problem->total;
  PetscCallBLAS("LAPACKsyev", LAPACKsyev_("V", "L", &order, J, &order, squares, work, &lwork, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK syev info %d", (int)info);
  for (PetscInt a = 0; a < dim; a++) {
    problem->size[a] = PetscSqrtReal(squares[a]);
    for (PetscInt d = 0; d < dim; d++) problem->axes[a][d] = J[a * dim + d];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Fields of first order along the principal axes of the full mass, from its centre, in units of its radii of gyration; then its moments in
   them. In such fields the conditions are well conditioned whatever the shape of the body and however it is turned. */
static PetscErrorCode SetUpFields(MomentsProblem *problem)
{
  const PetscInt dim = problem->body->mesh.dim;
  PetscReal      lower[3], upper[3], moments[MAX_MOMENTS];

  PetscFunctionBegin;
  for (PetscInt a = 0; a <= dim; a++) {
    problem->pair[a][0] = 0;
    problem->pair[a][1] = a;
  }
  problem->n_moments = dim + 1;
  for (PetscInt a = 1; a <= dim; a++)
    for (PetscInt b = a; b <= dim; b++) {
      problem->pair[problem->n_moments][0] = a;
      problem->pair[problem->n_moments][1] = b;
      problem->n_moments++;
    }
  PetscCall(DMGetBoundingBox(problem->body->mesh.dm, lower, upper));
  for (PetscInt d = 0; d < dim; d++) {
    problem->centre[d]  = (lower[d] + upper[d]) / 2;
    problem->size[d]    = upper[d] - lower[d];
    problem->axes[d][d] = 1;
  }
  PetscCall(ComputeFullMoments(problem, moments));
  problem->total = moments[0];
  PetscCall(FindAxes(problem, moments));
  PetscCall(ComputeFullMoments(problem, problem->target));
  for (PetscInt m = 0; m < problem->n_moments; m++) problem->target[m] /= problem->total;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the condition that a moment is kept */
static PetscReal *AddCondition(MomentsProblem *problem, PetscInt moment, PetscReal softness)
{
  PetscReal *weights = problem->condition[problem->n];

  for (PetscInt m = 0; m < problem->n_moments; m++) weights[m] = m == moment ? 1 : 0;
  problem->softness[problem->n++] = softness;
  return weights;
}

/* What is asked for beyond total mass and centre */
typedef enum {
  SECOND_ORDER,              /* all moments of second order: the kinetic energy of every linear field of velocities */
  SECOND_ORDER_AND_ROTATION, /* the same, and, as a condition of its own that is not soft, that of the one rotation in two dimensions */
  FIRST_ORDER                /* nothing */
} Order;

static void SetConditions(MomentsProblem *problem, Order order, PetscReal centre, PetscReal inertia)
{
  const PetscInt  dim     = problem->body->mesh.dim;
  const PetscReal largest = PetscMax(problem->size[0], PetscMax(problem->size[1], problem->size[2]));

  problem->n    = 0;
  problem->most = inertia > 0 ? MOST_FACTOR : PETSC_MAX_REAL;
  for (PetscInt m = 0; m <= dim; m++) (void)AddCondition(problem, m, m ? centre : 0);
  if (order == FIRST_ORDER) return;
  for (PetscInt m = dim + 1; m < problem->n_moments; m++) {
    PetscReal *weights = AddCondition(problem, m, inertia);

    /* such a moment counts twice, so that what is missing does not depend on how the axes of a cube are chosen */
    if (problem->pair[m][0] != problem->pair[m][1]) weights[m] = PetscSqrtReal(2);
  }
  if (order == SECOND_ORDER_AND_ROTATION) {
    PetscReal *weights = AddCondition(problem, -1, 0);

    for (PetscInt m = dim + 1; m < problem->n_moments; m++)
      if (problem->pair[m][0] == problem->pair[m][1]) weights[m] = PetscSqr(problem->size[problem->pair[m][0] - 1] / largest);
  }
}

/* Largest relative change of a moment of inertia about axes through the centre: those spanned by n orthonormal vectors, three numbers each
   along the principal axes. With I = tr(J) 1 - J in these vectors they are the eigenvalues of I_full^-1 (I - I_full). */
static PetscErrorCode CompareInertia(const MomentsProblem *problem, const PetscReal moments[], PetscInt n, const PetscReal axes[],
                                     PetscReal *error)
{
  const PetscInt dim     = problem->body->mesh.dim;
  PetscReal      J[2][9] = {{0}}, inertia[2][9] = {{0}}, values[3], work[12];
  PetscBLASInt   one = 1, order = (PetscBLASInt)n, lwork = 12, info;

  PetscFunctionBegin;
  *error = 0;
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt m = dim + 1; m < problem->n_moments; m++) {
    const PetscInt  a = problem->pair[m][0] - 1, b = problem->pair[m][1] - 1;
    const PetscReal unit = problem->size[a] * problem->size[b];
    /* about the centre of the mass as it is */
    const PetscReal now = moments[m] - moments[1 + a] * moments[1 + b];

    J[0][3 * a + b] = J[0][3 * b + a] = problem->target[m] * unit;
    J[1][3 * a + b] = J[1][3 * b + a] = (now - problem->target[m]) * unit;
  }
  for (PetscInt k = 0; k < 2; k++)
    for (PetscInt p = 0; p < n; p++)
      for (PetscInt q = 0; q < n; q++)
        for (PetscInt i = 0; i < 9; i++)
          inertia[k][p * n + q] += axes[3 * p + i / 3] * axes[3 * q + i % 3] * ((i % 4 ? 0 : J[k][0] + J[k][4] + J[k][8]) - J[k][i]);
  if (n == 1) {
    *error = PetscAbsReal(inertia[1][0] / inertia[0][0]);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCallBLAS("LAPACKsygv", LAPACKsygv_(&one, "N", "L", &order, inertia[1], &order, inertia[0], &order, values, work, &lwork, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK sygv info %d", (int)info);
  *error = PetscMax(PetscAbsReal(values[0]), PetscAbsReal(values[n - 1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the mass that is left makes of moments of inertia: about all axes, and about those that the body can turn about. In one dimension
   nothing turns, and no ring does; in two, there is one axis. */
static PetscErrorCode NoteInertia(const MomentsProblem *problem, const PetscReal moments[])
{
  static const PetscReal all[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  Body                   body   = problem->body;
  const PetscInt         dim    = body->mesh.dim;
  PetscReal              turns[9], axes[9] = {0}, *errors[] = {&body->mass.inertia_error, &body->mass.turn_error};
  PetscInt               n;

  PetscFunctionBegin;
  if (dim == 1 || body->model.element->axisymmetric) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CompareInertia(problem, moments, 2 * dim - 3, dim == 3 ? all : all + 6, errors[0]));
  PetscCall(BodyFindTurns(body, &n, turns));
  for (PetscInt k = 0; k < n; k++)
    for (PetscInt a = 0; a < 3; a++) {
      axes[3 * k + a] = dim == 2 && a == 2 ? turns[3 * k + 2] : 0;
      for (PetscInt d = 0; d < dim && a < dim; d++) axes[3 * k + a] += problem->axes[a][d] * turns[3 * k + d];
    }
  PetscCall(CompareInertia(problem, moments, n, axes, errors[1]));
  for (PetscInt k = 0; k < 2; k++)
    if (*errors[k] <= KEPT) *errors[k] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The factor at all nodes of this rank, also ghosts, and its range over nodes with mass */
static PetscErrorCode EvaluateFactor(MomentsProblem *problem, const PetscReal coefficients[])
{
  Body      body     = problem->body;
  PetscReal range[2] = {PETSC_MAX_REAL, PETSC_MAX_REAL};

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(body->mesh.local_nodes, &body->mass.factor));
  for (PetscInt node = 0; node < body->mesh.local_nodes; node++) {
    PetscReal psi[MAX_MOMENTS];

    MomentsGetPolynomials(problem, node, psi);
    body->mass.factor[node] = problem->scale *
                              PetscClipInterval(MomentsGetPolynomial(problem, coefficients, psi), LEAST_FACTOR, problem->most);
    if (body->layer.contains[node]) continue;
    range[0] = PetscMin(range[0], body->mass.factor[node]);
    range[1] = PetscMin(range[1], -body->mass.factor[node]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, range, 2, MPIU_REAL, MPIU_MIN, PetscObjectComm((PetscObject)body)));
  body->mass.least_factor   = range[0];
  body->mass.largest_factor = -range[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first of these sets of conditions that can be satisfied gives the coefficients of the factor. What is given up, in this order: in two
   dimensions, moments of second order that no rotation needs; moments of inertia; the centre. None: they are zero. */
static PetscErrorCode FindCoefficients(MomentsProblem *problem, PetscReal coefficients[MAX_MOMENTS])
{
  const struct {
    PetscInt  dim; /* 0: in all dimensions */
    Order     order;
    PetscReal centre, inertia;
  } attempts[]              = {{0, SECOND_ORDER, 0, 0},
                               {2, SECOND_ORDER_AND_ROTATION, 0, SOFT_INERTIA},
                               {0, SECOND_ORDER, 0, SOFT_INERTIA},
                               {0, SECOND_ORDER, SOFT_CENTRE, SOFT_INERTIA}};
  const PetscInt n_attempts = (PetscInt)(sizeof(attempts) / sizeof(attempts[0])), dim = problem->body->mesh.dim;
  /* in one dimension nothing turns, and no ring does */
  const PetscBool centre_alone = (PetscBool)(dim == 1 || problem->body->model.element->axisymmetric ||
                                             problem->body->mass.moments == BODY_MASS_CENTRE);
  PetscBool       converged    = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(coefficients, MAX_MOMENTS));
  for (PetscInt i = 0; i < n_attempts && !converged && problem->body->mass.moments != BODY_MASS_TOTAL; i++) {
    if (attempts[i].dim && attempts[i].dim != dim) continue;
    SetConditions(problem, centre_alone ? FIRST_ORDER : attempts[i].order, attempts[i].centre, attempts[i].inertia);
    PetscCall(MomentsSolve(problem, coefficients, &converged));
  }
  if (!converged) PetscCall(PetscArrayzero(coefficients, MAX_MOMENTS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The factor. Of a mesh that is whole, its rank finds the coefficients by itself and tells them. */
static PetscErrorCode FindFactor(MomentsProblem *problem)
{
  Body           body = problem->body;
  const PetscInt dim  = body->mesh.dim;
  PetscReal      coefficients[MAX_MOMENTS], moments[MAX_MOMENTS];

  PetscFunctionBegin;
  problem->alone = body->mesh.whole;
  if (!problem->alone || body->mesh.is_owner) PetscCall(FindCoefficients(problem, coefficients));
  if (problem->alone) PetscCallMPI(MPI_Bcast(coefficients, MAX_MOMENTS, MPIU_REAL, body->mesh.owner, PetscObjectComm((PetscObject)body)));
  problem->alone = PETSC_FALSE;
  PetscCall(EvaluateFactor(problem, coefficients));
  PetscCall(MomentsCompute(problem, coefficients, moments, NULL));
  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt d = 0; d < dim && PetscAbsReal(moments[1 + a]) > KEPT; d++)
      problem->body->mass.shift[d] += problem->axes[a][d] * problem->size[a] * moments[1 + a];
  PetscCall(NoteInertia(problem, moments));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the factor with which the mass that is left has the moments of the full mass, where any node is massless. `less`: the part of the
   mass that elements without inner nodes have; NULL: it is an error if they are all. */
PetscErrorCode BodyFindMassFactor(Body body, PetscReal *less)
{
  MomentsProblem problem = {.body = body, .most = PETSC_MAX_REAL};
  PetscBool      any     = PETSC_FALSE;

  PetscFunctionBegin;
  if (less) *less = 0;
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) any = (PetscBool)(any || body->layer.contains[node]);
  PetscCall(BodyAnyRank(body, &any));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SetUpFields(&problem));
  PetscCall(ComputeWeights(&problem));
  if (less) *less = problem.scale > 0 ? 1 - 1 / problem.scale : 1;
  if (problem.scale > 0) PetscCall(FindFactor(&problem));
  PetscCall(PetscFree(problem.weights));
  PetscCheck(problem.scale > 0 || less, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "Body '%s': %g%s of elements that have all their nodes on contact surfaces find no inner node to go to; refine the mesh, name "
             "smaller surfaces in -contact_pairs, or leave the choice to the body: -%smass_redistribute auto",
             body->hdr.name, (double)problem.total, UnitsOf((PetscObject)body, UNIT_MASS), ((PetscObject)body)->prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Largest relative change of a moment of inertia by the massless layer, about axes through the centre on which the body can turn */
PetscErrorCode BodyGetInertiaChange(Body body, PetscReal *change)
{
  PetscFunctionBegin;
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetUp() first");
  *change = body->mass.turn_error;
  PetscFunctionReturn(PETSC_SUCCESS);
}
