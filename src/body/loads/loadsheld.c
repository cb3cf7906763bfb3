/* Displacements prescribed on surfaces. */
#include "loadsimpl.h"
#include <impakt/private/mesh.h>

/* The i-th prescription puts its mark on the rank's dofs, over those of earlier ones */
static PetscErrorCode MarkHeld(Body body, PetscInt i, const char surface[], Vec local)
{
  Expression *const component = body->loads->prescribed[i].component;
  PetscInt          n, *vertices;
  PetscScalar      *mark;

  PetscFunctionBegin;
  PetscCall(MeshGetNodeSet(body->mesh.dm, surface, &n, &vertices));
  PetscCall(VecGetArray(local, &mark));
  for (PetscInt k = 0; k < n; k++)
    for (PetscInt d = 0; d < body->mesh.dim; d++)
      if (component[d]) mark[body->mesh.node_of_vertex[vertices[k] - body->mesh.vertex_start] * body->mesh.dim + d] = i + 1;
  PetscCall(VecRestoreArray(local, &mark));
  PetscCall(PetscFree(vertices));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nodes on the axis of rings stay there: that comes after all prescriptions */
static PetscErrorCode MarkAxis(Body body, Vec local)
{
  PetscScalar *mark;

  PetscFunctionBegin;
  PetscCall(VecGetArray(local, &mark));
  for (PetscInt node = 0; node < body->mesh.local_nodes; node++)
    if (body->mesh.on_axis[node]) mark[node * body->mesh.dim] = body->loads->n_prescribed + 1;
  PetscCall(VecRestoreArray(local, &mark));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For each owned dof 1 + the number of the last prescription that holds it, else 0. */
static PetscErrorCode MarkAllHeld(Body body, Vec marks)
{
  const PetscBool          ghosted = body->mesh.ghosted;
  const struct _BodyLoads *loads   = body->loads;
  PetscErrorCode           error   = PETSC_SUCCESS;
  Vec                      local   = marks;

  PetscFunctionBegin;
  if (ghosted) PetscCall(VecGhostGetLocalForm(marks, &local));
  PetscCall(VecSet(local, 0));
  for (PetscInt i = 0; i < loads->n_prescribed && !error; i++) error = MarkHeld(body, i, loads->prescribed[i].surface, local);
  if (!error && body->mesh.on_axis) error = MarkAxis(body, local);
  if (ghosted) PetscCall(VecGhostRestoreLocalForm(marks, &local));
  PetscCall(error);
  if (ghosted) {
    PetscCall(VecGhostUpdateBegin(marks, MAX_VALUES, SCATTER_REVERSE));
    PetscCall(VecGhostUpdateEnd(marks, MAX_VALUES, SCATTER_REVERSE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void GetPoint(Body body, PetscInt dof, PetscReal t, ExpressionPoint *point)
{
  const PetscReal *x = body->mesh.coordinates + dof / body->mesh.dim * body->mesh.dim;

  for (PetscInt d = 0; d < 3; d++) {
    point->x[d] = d < body->mesh.dim ? x[d] : 0;
    point->n[d] = 0;
  }
  point->t = t;
}

static PetscErrorCode FillGroup(Body body, const PetscScalar marks[], PetscInt prescription, PetscInt component, Expression displacement,
                                HeldDofs *group)
{
  const PetscInt n     = body->mesh.owned_nodes * body->mesh.dim;
  PetscInt       count = 0;

  PetscFunctionBegin;
  group->prescription = prescription;
  group->displacement = displacement;
  PetscCall(ExpressionGetNature(group->displacement, &group->steady, &group->uniform, NULL));
  for (PetscInt dof = component; dof < n; dof += body->mesh.dim) count += marks[dof] == prescription + 1;
  PetscCall(PetscMalloc1(count, &group->held.dofs));
  if (group->steady) PetscCall(PetscMalloc1(count, &group->held.values));
  for (PetscInt dof = component; dof < n; dof += body->mesh.dim) {
    ExpressionPoint point;

    if (marks[dof] != prescription + 1) continue;
    GetPoint(body, dof, 0, &point);
    if (group->steady) PetscCall(ExpressionEvaluate(group->displacement, &point, &group->held.values[group->held.n]));
    group->held.dofs[group->held.n++] = dof;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyGroups(struct _BodyLoads *loads)
{
  PetscFunctionBegin;
  for (PetscInt g = 0; g < loads->n_groups; g++) {
    PetscCall(PetscFree(loads->groups[g].held.dofs));
    PetscCall(PetscFree(loads->groups[g].held.values));
  }
  PetscCall(PetscFree(loads->groups));
  PetscCall(PetscFree(loads->held_dofs));
  loads->n_groups = loads->n_held = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error where a displacement away from the axis is prescribed on it */
static PetscErrorCode CheckAxis(Body body)
{
  const struct _BodyLoads *loads = body->loads;
  PetscInt                 bad   = -1;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < loads->n_prescribed; i++) {
    PetscInt n, *vertices;

    if (!loads->prescribed[i].component[0]) continue;
    PetscCall(MeshGetNodeSet(body->mesh.dm, loads->prescribed[i].surface, &n, &vertices));
    for (PetscInt k = 0; k < n; k++) {
      const PetscInt node = body->mesh.node_of_vertex[vertices[k] - body->mesh.vertex_start];

      for (PetscInt second = 0; second < 2 && body->mesh.on_axis[node]; second++) {
        ExpressionPoint point;
        PetscReal       value;

        GetPoint(body, node * body->mesh.dim, second, &point);
        PetscCall(ExpressionEvaluate(loads->prescribed[i].component[0], &point, &value));
        if (value != 0) bad = PetscMax(bad, i);
      }
    }
    PetscCall(PetscFree(vertices));
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, &bad, 1, MPIU_INT, MPI_MAX, PetscObjectComm((PetscObject)body)));
  PetscCheck(
      bad < 0, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
      "-%sboundary_displacement_%s moves nodes on the axis x = 0 of an axisymmetric body along x: they stay there; write the word free, "
      "or a formula in x that is 0 there",
      ((PetscObject)body)->prefix, loads->prescribed[bad].surface);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which dofs are held, and by which prescription; to be called again when one has been added */
PetscErrorCode BodyLoadsSetUpHeld(Body body)
{
  struct _BodyLoads *loads  = body->loads;
  const PetscInt     n_dofs = body->mesh.owned_nodes * body->mesh.dim, n = loads->n_prescribed;
  PetscInt64         count[2];
  PetscScalar       *mark;
  Vec                marks;
  PetscErrorCode     error;

  PetscFunctionBegin;
  PetscCheck(!n || body->integrator->deforms, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%sboundary_displacement: body '%s' is rigid, and moves as a whole; lead it by -%srigid_displacement and -%srigid_rotation",
             ((PetscObject)body)->prefix, body->hdr.name, ((PetscObject)body)->prefix, ((PetscObject)body)->prefix);
  if (!n && !body->mesh.touches_axis) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->mesh.touches_axis) PetscCall(CheckAxis(body));
  if (body->mesh.touches_axis && !loads->axis) PetscCall(ExpressionCreate(PETSC_COMM_SELF, "", "0", &loads->axis));
  PetscCall(DestroyGroups(loads));
  PetscCall(BodyCreateVec(body, &marks));
  error = MarkAllHeld(body, marks);
  if (error) PetscCall(VecDestroy(&marks));
  PetscCall(error);
  PetscCall(VecGetArray(marks, &mark));
  for (PetscInt dof = 0; dof < n_dofs; dof++) loads->n_held += mark[dof] > 0;
  PetscCall(PetscMalloc1(loads->n_held, &loads->held_dofs));
  for (PetscInt dof = 0, k = 0; dof < n_dofs; dof++)
    if (mark[dof] > 0) loads->held_dofs[k++] = dof;
  PetscCall(PetscCalloc1(n * body->mesh.dim + 1, &loads->groups));
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt d = 0; d < body->mesh.dim; d++)
      if (loads->prescribed[i].component[d])
        PetscCall(FillGroup(body, mark, i, d, loads->prescribed[i].component[d], &loads->groups[loads->n_groups++]));
  if (loads->axis) PetscCall(FillGroup(body, mark, n, 0, loads->axis, &loads->groups[loads->n_groups++]));
  PetscCall(VecRestoreArray(marks, &mark));
  PetscCall(VecDestroy(&marks));
  PetscCall(BodyLoadsSetUpReactions(body));
  count[0] = loads->n_held;
  count[1] = n_dofs;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, 2, MPIU_INT64, MPI_SUM, PetscObjectComm((PetscObject)body)));
  PetscCheck(count[0] < count[1], PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%sboundary_displacement prescribes all components of all nodes of body '%s': there is nothing left to find; leave some free",
             ((PetscObject)body)->prefix, body->hdr.name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the program or the options have anything act on the body from outside, or hold it; its axis does neither */
PetscBool BodyIsLoaded(Body body)
{
  return (PetscBool)(body->loads && (body->loads->n_prescribed || body->loads->n_loads || body->loads->has_gravity || body->loads->led));
}

/* Holds the axis of an axisymmetric body, before other prescriptions come */
PetscErrorCode BodyLoadsHoldAxis(Body body)
{
  PetscFunctionBegin;
  if (!body->mesh.touches_axis || body->loads) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscNew(&body->loads));
  PetscCall(BodyLoadsSetUpHeld(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacement, and with rates velocity and acceleration, of the i-th dof of a group */
static PetscErrorCode EvaluateHeld(Body body, const HeldDofs *group, PetscInt i, PetscReal t, PetscBool rates, PetscReal values[])
{
  const PetscReal step = body->time.step > 0 ? body->time.step : body->time.controller_step;
  ExpressionPoint point;

  PetscFunctionBegin;
  GetPoint(body, group->held.dofs[i], t, &point);
  if (rates) {
    PetscCheck(step > 0, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONGSTATE, "Call BodySetControllerStep() first");
    PetscCall(ExpressionEvaluateRates(group->displacement, &point, body->time.start, step, values));
  } else PetscCall(ExpressionEvaluate(group->displacement, &point, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Held dofs of u [m], v [m/s] and a [m/s^2] at time t; any of them may be NULL, ghosts are left alone */
PetscErrorCode BodyLoadsPrescribe(Body body, PetscReal t, Vec u, Vec v, Vec a)
{
  const Vec          vecs[]    = {u, v, a};
  struct _BodyLoads *loads     = body->loads;
  PetscScalar       *arrays[3] = {NULL};

  PetscFunctionBegin;
  /* ranks without held dofs must open the vectors too, or PETSc would keep norms with them on some ranks alone */
  if (!loads || !body->held.any) PetscFunctionReturn(PETSC_SUCCESS);
  for (int k = 0; k < 3; k++)
    if (vecs[k]) PetscCall(VecGetArray(vecs[k], &arrays[k]));
  for (PetscInt g = 0; g < loads->n_groups; g++) {
    const HeldDofs *group     = &loads->groups[g];
    PetscReal       values[3] = {0};

    for (PetscInt i = 0; i < group->held.n; i++) {
      if (group->steady) values[0] = group->held.values[i];
      else if (!i || !group->uniform) PetscCall(EvaluateHeld(body, group, i, t, (PetscBool)(v || a), values));
      for (int k = 0; k < 3; k++)
        if (arrays[k]) arrays[k][group->held.dofs[i]] = values[k];
    }
  }
  for (int k = 0; k < 3; k++)
    if (vecs[k]) PetscCall(VecRestoreArray(vecs[k], &arrays[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyLoadsDestroyHeld(struct _BodyLoads *loads)
{
  PetscFunctionBegin;
  PetscCall(DestroyGroups(loads));
  for (PetscInt i = 0; i < loads->n_prescribed; i++) {
    PetscCall(PetscFree(loads->prescribed[i].surface));
    for (int d = 0; d < 3; d++) PetscCall(ExpressionDestroy(&loads->prescribed[i].component[d]));
  }
  PetscCall(PetscFree(loads->prescribed));
  PetscCall(PetscFree(loads->reactions));
  PetscCall(ExpressionDestroy(&loads->axis));
  PetscFunctionReturn(PETSC_SUCCESS);
}
