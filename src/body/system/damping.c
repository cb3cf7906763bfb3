/* Rayleigh damping: dashpots with the forces C v = alpha M v + beta K v against the velocity v.

   M is the body's own mass matrix: massless nodes have no drag. K v is what the elements of the undeformed body would put on the nodes for
   displacements v, of elements that touch no massless node: with dashpots on a massless node the contact layer would have dynamics of its
   own, of first order, and no balance. Left out as a whole, these elements damp nothing, so that what remains still lets rigid motions
   pass.

   In a nonlinear body K v is the force of the stress S = C0 : dE/dt, with the elastic constants C0 at zero strain and the rate of Green
   and Lagrange's strain E. It is K v at small displacements, takes no energy from a body that turns, and never brings any. */
#include <body/layout/bodyimpl.h>
#include <sys/units.h>

struct _BodyDamping {
  PetscReal mass, stiffness; /* alpha [1/s], beta [s] */
  /* below: with a stiffness part */
  PetscInt  counts[2];    /* of all ranks: elements that touch no massless node, and all */
  PetscInt *numbers;      /* in the body, of the former on this rank */
  PetscInt *connectivity; /* theirs */
  Element   element;      /* these; linear */
  Vec       work;         /* M v */
};

/*@
  BodySetDamping - gives a body Rayleigh damping

  Logically Collective

  Input Parameters:
+ body      - the `Body`, not yet set up
. mass      - alpha: forces against the velocity in parts of the mass, alpha M v [1/s]
- stiffness - beta: forces against the rate of the strain in parts of the stiffness, beta K v [s]

  Options Database Keys:
+ -<body>_damping_mass alpha     - the first
- -<body>_damping_stiffness beta - the second

  Level: intermediate

  Notes:
  A vibration of angular frequency omega has the damping ratio alpha / (2 omega) + beta omega / 2. alpha damps what is slow, rigid motion
  too; beta what is fast.

  beta counts for elements without massless contact nodes: the layer stays in static balance. In nonlinear bodies it stands for the stress
  beta C0 : dE/dt in the undeformed body, with the elastic constants C0 at zero strain and the rate of Green and Lagrange's strain: bodies
  turn freely.

  An explicit body takes the velocity at mid-step, half a step before its forces. Its stable step becomes
  (2 / omega) (sqrt(1 + zeta^2) - zeta), with the damping ratio zeta of its fastest vibration omega.

  The trapezoidal rule takes little from vibrations with beta omega^2 dt far beyond 1, which change their sign in each step of dt: beta
should not be much larger than the step.

  What the dashpots take is in `BodyMeasures`, and no error of the energy. A static body has none.

.seealso: `Body`, `BodyGetDamping()`, `BodyMeasures`, `BodyGetStableStep()`
@*/
PetscErrorCode BodySetDamping(Body body, PetscReal mass, PetscReal stiffness)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscValidLogicalCollectiveReal(body, mass, 2);
  PetscValidLogicalCollectiveReal(body, stiffness, 3);
  BodyCheckNotSetUp(body);
  PetscCheck(mass >= 0 && stiffness >= 0 && !PetscIsInfReal(mass) && !PetscIsInfReal(stiffness), PetscObjectComm((PetscObject)body),
             PETSC_ERR_ARG_OUTOFRANGE, "Body '%s': damping of %g 1/s of the mass and %g s of the stiffness; neither may be negative",
             body->hdr.name, (double)mass, (double)stiffness);
  if (!body->damping) PetscCall(PetscNew(&body->damping));
  body->damping->mass      = mass;
  body->damping->stiffness = stiffness;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetDamping - the Rayleigh damping of a body

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameters:
+ mass      - alpha, or `NULL` [1/s]
- stiffness - beta, or `NULL` [s]

  Level: intermediate

.seealso: `Body`, `BodySetDamping()`
@*/
PetscErrorCode BodyGetDamping(Body body, PetscReal *mass, PetscReal *stiffness)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (mass) *mass = body->damping ? body->damping->mass : 0;
  if (stiffness) *stiffness = body->damping ? body->damping->stiffness : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool BodyIsDamped(Body body)
{
  return (PetscBool)(body->damping && body->integrator->has_inertia && (body->damping->mass > 0 || body->damping->stiffness > 0));
}

PetscErrorCode BodyViewDamping(Body body, PetscViewer viewer)
{
  const struct _BodyDamping *damping = body->damping;

  PetscFunctionBegin;
  if (!BodyIsDamped(body)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPrintf(viewer, "  Rayleigh damping: %g%s of the mass, %g%s of the stiffness", (double)damping->mass,
                                   UnitsOf((PetscObject)body, UNIT_RATE), (double)damping->stiffness,
                                   UnitsOf((PetscObject)body, UNIT_TIME)));
  if (damping->counts[0] < damping->counts[1])
    PetscCall(PetscViewerASCIIPrintf(viewer, " in %" PetscInt_FMT " elements, those at massless nodes left out", damping->counts[0]));
  PetscCall(PetscViewerASCIIPrintf(viewer, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Elements none of whose nodes is massless: how many, which, and their connectivity */
static PetscErrorCode SelectElements(Body body, PetscInt *count, PetscInt **numbers, PetscInt **connectivity)
{
  const PetscInt n = body->model.element->nodes;

  PetscFunctionBegin;
  *count = 0;
  PetscCall(PetscMalloc1(body->model.element->count, numbers));
  PetscCall(PetscMalloc1(body->model.element->count * n, connectivity));
  for (PetscInt e = 0; e < body->model.element->count; e++) {
    const PetscInt *nodes    = body->mesh.connectivity + e * n;
    PetscBool       massless = PETSC_FALSE;

    for (PetscInt a = 0; a < n; a++)
      if (body->mass.redistribute && body->layer.contains[nodes[a]]) massless = PETSC_TRUE;
    if (massless) continue;
    PetscCall(PetscArraycpy(*connectivity + *count * n, nodes, n));
    (*numbers)[(*count)++] = e;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* When it is known which nodes are massless */
PetscErrorCode BodySetUpDamping(Body body)
{
  struct _BodyDamping *damping = body->damping;
  PetscInt             count;

  PetscFunctionBegin;
  if (!BodyIsDamped(body)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyCreateVec(body, &damping->work));
  if (!(damping->stiffness > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(body->model.linear || body->model.element->ops->viscousforce, PetscObjectComm((PetscObject)body), PETSC_ERR_SUP,
             "-%sdamping_stiffness: elements of shape '%s' do not support it with nonlinear materials", ((PetscObject)body)->prefix,
             DMPolytopeTypes[body->mesh.cell_shape]);
  PetscCall(SelectElements(body, &count, &damping->numbers, &damping->connectivity));
  damping->counts[0] = count;
  damping->counts[1] = body->model.element->count;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, damping->counts, 2, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
  PetscCheck(
      damping->counts[0], PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
      "-%sdamping_stiffness has no effect: all elements of body '%s' are at massless contact nodes, which have no dashpots; refine the "
      "mesh, or set -%smass_redistribute false, or near",
      ((PetscObject)body)->prefix, body->hdr.name, ((PetscObject)body)->prefix);
  PetscCall(ElementCreateSelection(body->model.element, (PetscBool)!body->model.linear, count, damping->numbers, damping->connectivity,
                                   body->mesh.coordinates, &damping->element));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyDestroyDamping(Body body)
{
  PetscFunctionBegin;
  if (!body->damping) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ElementDestroy(&body->damping->element));
  PetscCall(PetscFree(body->damping->numbers));
  PetscCall(PetscFree(body->damping->connectivity));
  PetscCall(VecDestroy(&body->damping->work));
  PetscCall(PetscFree(body->damping));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* force = K v; as in the undeformed body where u is NULL */
static PetscErrorCode ComputeViscousForce(Body body, Vec u, Vec v, Vec force)
{
  Element            element = body->damping->element;
  const PetscScalar *at      = NULL, *rate;
  PetscScalar       *f;
  Vec                at_local, rate_local, f_local;

  PetscFunctionBegin;
  if (u) PetscCall(BodyGetLocalRead(body, u, &at_local, &at));
  PetscCall(BodyGetLocalRead(body, v, &rate_local, &rate));
  PetscCall(BodyGetLocalSum(body, force, &f_local, &f));
  if (u) PetscCall((*element->ops->viscousforce)(element, at, rate, f));
  else PetscCall((*element->ops->internalforce)(element, rate, f));
  PetscCall(BodyRestoreLocalSum(body, force, &f_local, &f));
  PetscCall(BodyRestoreLocalRead(body, v, &rate_local, &rate));
  if (u) PetscCall(BodyRestoreLocalRead(body, u, &at_local, &at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* force = C v, at displacement u of a nonlinear body, NULL: the undeformed one [N]; of a body with damping */
PetscErrorCode BodyMultiplyDamping(Body body, Vec u, Vec v, Vec force)
{
  struct _BodyDamping *damping = body->damping;

  PetscFunctionBegin;
  if (damping->stiffness > 0) {
    PetscCall(ComputeViscousForce(body, body->model.linear || body->model.linearized ? NULL : u, v, force));
    PetscCall(VecScale(force, damping->stiffness));
  } else PetscCall(VecZeroEntries(force));
  if (damping->mass > 0) {
    PetscCall(BodyMultiplyMass(body, v, damping->work));
    PetscCall(VecAXPY(force, damping->mass, damping->work));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes the forces of the dashpots in the state as it is */
PetscErrorCode BodyNoteDamping(Body body)
{
  PetscFunctionBegin;
  if (BodyIsDamped(body)) PetscCall(BodyMultiplyDamping(body, body->state.u, body->state.v, body->state.damping));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A += scale C, at displacement u of a nonlinear body, NULL: the undeformed one; without what C changes by with the displacement */
PetscErrorCode BodyAddDampingMatrix(Body body, Vec u, PetscReal scale, Mat A)
{
  const struct _BodyDamping *damping = body->damping;
  const PetscInt             n       = body->model.element->nodes * body->mesh.dim;
  const PetscScalar         *at      = NULL;
  PetscScalar               *zero    = NULL, part[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS];
  PetscInt                   dofs[ELEMENT_MAX_DOFS];
  Vec                        local;

  PetscFunctionBegin;
  if (!BodyIsDamped(body)) PetscFunctionReturn(PETSC_SUCCESS);
  if (damping->mass > 0) PetscCall(BodyAddMassMatrix(body, scale * damping->mass, A));
  if (!(damping->stiffness > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->model.linear) u = NULL;
  if (u) PetscCall(BodyGetLocalRead(body, u, &local, &at));
  else {
    PetscCall(PetscCalloc1(body->mesh.local_nodes * body->mesh.dim, &zero));
    at = zero;
  }
  for (PetscInt e = 0; e < damping->element->count; e++) {
    PetscCall((*damping->element->ops->tangent)(damping->element, e, u ? PETSC_TRUE : PETSC_FALSE, at, part));
    for (PetscInt i = 0; i < n * n; i++) part[i] *= scale * damping->stiffness;
    PetscCall(BodyGetElementDofs(body, damping->numbers[e], dofs));
    PetscCall(MatSetValues(A, n, dofs, n, dofs, part, ADD_VALUES));
  }
  if (u) PetscCall(BodyRestoreLocalRead(body, u, &local, &at));
  PetscCall(PetscFree(zero));
  PetscCall(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the dashpots take from displacement and forces at the start of the substep to the present ones: by the trapezoidal rule, as the work
   of loads. Central differences and the trapezoidal rule of a linear body take just that from their energies. */
static PetscErrorCode ComputeWork(Body body, PetscReal *work)
{
  const BodyState   *start = &body->substep_start;
  const PetscScalar *u0, *u1, *d0, *d1;

  PetscFunctionBegin;
  *work = 0;
  PetscCall(VecGetArrayRead(start->u, &u0));
  PetscCall(VecGetArrayRead(start->damping, &d0));
  PetscCall(VecGetArrayRead(body->state.u, &u1));
  PetscCall(VecGetArrayRead(body->state.damping, &d1));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * body->mesh.dim; i++) *work += 0.5 * PetscRealPart((d0[i] + d1[i]) * (u1[i] - u0[i]));
  PetscCall(VecRestoreArrayRead(body->state.damping, &d1));
  PetscCall(VecRestoreArrayRead(body->state.u, &u1));
  PetscCall(VecRestoreArrayRead(start->damping, &d0));
  PetscCall(VecRestoreArrayRead(start->u, &u0));
  if (body->rows.size > 1 && !body->local)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, work, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts what the dashpots have taken in the substep that has been made; collective only where there are some */
PetscErrorCode BodyAddDampingWork(Body body)
{
  PetscReal work;

  PetscFunctionBegin;
  if (!BodyIsDamped(body) || body->unloaded) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ComputeWork(body, &work));
  body->state.damping_work += work;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the dashpots have taken in a step of one substep that has not been accepted yet [J] */
PetscErrorCode BodyGetPendingDampingWork(Body body, PetscReal *work)
{
  PetscFunctionBegin;
  *work = 0;
  if (BodyIsDamped(body)) PetscCall(ComputeWork(body, work));
  PetscFunctionReturn(PETSC_SUCCESS);
}
