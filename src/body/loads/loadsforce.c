/* Tractions, forces in the volume, and weight: nodal forces from outside. */
#include "loadsimpl.h"

/* Points, and weights times shape functions, of one face or element of a load; nodes: the local numbers of its nodes */
static PetscErrorCode GetPoints(Body body, const Load *load, PetscInt i, PetscInt *n_points, PetscInt *n_nodes, const PetscInt *nodes[])
{
  struct _BodyLoads *loads   = body->loads;
  const Element      element = body->model.element;

  PetscFunctionBegin;
  if (load->on_faces) {
    *n_points = load->faces.n_points;
    *n_nodes  = load->faces.nodes;
    *nodes    = load->faces.connectivity + i * *n_nodes;
    PetscCall(BodyFacesGetPoints(body, &load->faces, i, loads->points, loads->shape));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  *n_points = element->n_points;
  *n_nodes  = element->nodes;
  *nodes    = element->connectivity + i * *n_nodes;
  PetscCall((*element->ops->points)(element, i, loads->x, loads->weights));
  for (PetscInt g = 0; g < *n_points; g++) {
    for (PetscInt d = 0; d < 3; d++) {
      loads->points[g].x[d] = d < body->mesh.dim ? loads->x[g * body->mesh.dim + d] : 0;
      loads->points[g].n[d] = 0;
    }
    for (PetscInt a = 0; a < *n_nodes; a++) loads->shape[g * *n_nodes + a] = loads->weights[g] * element->shape[g * *n_nodes + a];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the nodal forces of a density at time t to those of the rank's nodes, ghosts among them; NULL components are left out */
static PetscErrorCode Integrate(Body body, const Load *load, const Expression density[], PetscReal t, PetscScalar f[])
{
  const PetscInt dim = body->mesh.dim, count = load->on_faces ? load->faces.count : body->model.element->count;

  PetscFunctionBegin;
  if (!density[0] && !density[1] && !density[2]) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < count; i++) {
    const PetscInt *nodes;
    PetscInt        n_points, n_nodes;

    PetscCall(GetPoints(body, load, i, &n_points, &n_nodes, &nodes));
    for (PetscInt g = 0; g < n_points; g++) {
      body->loads->points[g].t = t;
      for (PetscInt d = 0; d < dim; d++) {
        PetscReal value;

        if (!density[d]) continue;
        PetscCall(ExpressionEvaluate(density[d], &body->loads->points[g], &value));
        for (PetscInt a = 0; a < n_nodes; a++) f[nodes[a] * dim + d] += body->loads->shape[g * n_nodes + a] * value;
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SortComponents(Load *load)
{
  PetscFunctionBegin;
  for (int d = 0; d < 3; d++) {
    PetscBool steady, uniform;

    if (!load->component[d]) continue;
    PetscCall(ExpressionGetNature(load->component[d], &steady, &uniform, NULL));
    load->part[steady ? LOAD_STEADY : uniform ? LOAD_UNIFORM : LOAD_VARYING][d] = load->component[d];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode IntegrateAll(Body body, PetscInt n, const Load loads[], LoadKind kind, PetscReal t, Vec local)
{
  PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(VecSet(local, 0));
  PetscCall(VecGetArray(local, &array));
  for (PetscInt i = 0; i < n; i++) PetscCall(Integrate(body, &loads[i], loads[i].part[kind], t, array));
  PetscCall(VecRestoreArray(local, &array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nodal forces of one kind, with the shares of ghosts at their owners */
static PetscErrorCode Assemble(Body body, PetscInt n, const Load loads[], LoadKind kind, PetscReal t, Vec f)
{
  const PetscBool ghosted = body->mesh.ghosted;
  PetscErrorCode  error;
  Vec             local = f;

  PetscFunctionBegin;
  if (ghosted) PetscCall(VecGhostGetLocalForm(f, &local));
  error = IntegrateAll(body, n, loads, kind, t, local);
  if (ghosted) PetscCall(VecGhostRestoreLocalForm(f, &local));
  PetscCall(error);
  if (ghosted) {
    PetscCall(VecGhostUpdateBegin(f, ADD_VALUES, SCATTER_REVERSE));
    PetscCall(VecGhostUpdateEnd(f, ADD_VALUES, SCATTER_REVERSE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* M g with the body's own mass matrix, however that is lumped or redistributed: free fall has the acceleration g everywhere */
static PetscErrorCode AddWeight(Body body, Vec f)
{
  const PetscInt n = body->mesh.owned_nodes * body->mesh.dim;
  PetscScalar   *g;
  Vec            gravity, weight;

  PetscFunctionBegin;
  PetscCall(BodyCreateVec(body, &gravity));
  PetscCall(BodyCreateVec(body, &weight));
  PetscCall(VecGetArrayWrite(gravity, &g));
  for (PetscInt i = 0; i < n; i++) g[i] = body->loads->gravity[i % body->mesh.dim];
  PetscCall(VecRestoreArrayWrite(gravity, &g));
  PetscCall(BodyMultiplyMass(body, gravity, weight));
  PetscCall(VecAXPY(f, 1, weight));
  PetscCall(VecDestroy(&weight));
  PetscCall(VecDestroy(&gravity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is integrated once, and multiplied with functions of time afterwards */
static PetscErrorCode SetUpUniform(Body body, const Load *load)
{
  struct _BodyLoads *loads = body->loads;
  Load               unit  = *load;
  const PetscScalar *array;
  Expression         one;

  PetscFunctionBegin;
  PetscCall(ExpressionCreate(PETSC_COMM_SELF, "", "1", &one));
  for (int d = 0; d < 3; d++) unit.part[LOAD_UNIFORM][d] = load->part[LOAD_UNIFORM][d] ? one : NULL;
  PetscCall(Assemble(body, 1, &unit, LOAD_UNIFORM, 0, loads->varying));
  PetscCall(ExpressionDestroy(&one));
  PetscCall(VecGetArrayRead(loads->varying, &array));
  for (int d = 0; d < body->mesh.dim; d++) {
    UniformForce *force = &loads->uniform[loads->n_uniform];

    if (!load->part[LOAD_UNIFORM][d]) continue;
    force->density = load->part[LOAD_UNIFORM][d];
    loads->n_uniform++;
    PetscCall(BodyLoadsCompress(body->mesh.owned_nodes * body->mesh.dim, array, d, body->mesh.dim, &force->unit));
  }
  PetscCall(VecRestoreArrayRead(loads->varying, &array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUpForces(Body body)
{
  struct _BodyLoads *loads           = body->loads;
  const PetscInt     n_points        = PetscMax(FACE_MAX_POINTS, body->model.element->n_points),
                     n_nodes         = PetscMax(FACE_MAX_NODES, body->model.element->nodes);
  PetscBool          has[LOAD_KINDS] = {PETSC_FALSE};
  const PetscScalar *array;

  PetscFunctionBegin;
  PetscCheck(!loads->has_gravity || body->mass.row_sum, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
             "Call BodySetUp() first: weight needs the mass");
  if (!loads->points) {
    PetscCall(PetscMalloc4(n_points, &loads->points, n_points * body->mesh.dim, &loads->x, n_points, &loads->weights, n_points * n_nodes,
                           &loads->shape));
    PetscCall(PetscCalloc1(3 * loads->n_loads, &loads->uniform));
    PetscCall(BodyCreateVec(body, &loads->varying));
  }
  for (PetscInt i = 0; i < loads->n_loads; i++) {
    PetscCall(SortComponents(&loads->loads[i]));
    for (int kind = 0; kind < LOAD_KINDS; kind++)
      for (int d = 0; d < 3; d++)
        if (loads->loads[i].part[kind][d]) has[kind] = PETSC_TRUE;
  }
  PetscCall(Assemble(body, loads->n_loads, loads->loads, LOAD_STEADY, 0, loads->varying));
  if (loads->has_gravity) PetscCall(AddWeight(body, loads->varying));
  PetscCall(VecGetArrayRead(loads->varying, &array));
  PetscCall(BodyLoadsCompress(body->mesh.owned_nodes * body->mesh.dim, array, 0, 1, &loads->steady));
  PetscCall(VecRestoreArrayRead(loads->varying, &array));
  if (has[LOAD_UNIFORM])
    for (PetscInt i = 0; i < loads->n_loads; i++) PetscCall(SetUpUniform(body, &loads->loads[i]));
  if (!has[LOAD_VARYING]) PetscCall(VecDestroy(&loads->varying));
  loads->ready = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether tractions, body forces or gravity act on a body, on any rank */
PetscErrorCode BodyHasForces(Body body, PetscBool *force)
{
  PetscFunctionBegin;
  *force = (PetscBool)(body->loads && (body->loads->n_loads || body->loads->has_gravity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void AddValues(const DofValues *force, PetscReal scale, PetscScalar f[])
{
  for (PetscInt i = 0; i < force->n; i++) f[force->dofs[i]] += scale * force->values[i];
}

/* f += scale * forces from outside at time t [N], on owned dofs. Collective: the first time, and where forces vary in time and place. */
PetscErrorCode BodyLoadsAddForce(Body body, PetscReal t, PetscScalar scale, Vec f)
{
  struct _BodyLoads *loads = body->loads;
  PetscScalar       *array;

  PetscFunctionBegin;
  if (!loads || !(loads->n_loads || loads->has_gravity)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!loads->ready) PetscCall(SetUpForces(body));
  if (loads->varying) {
    PetscCall(Assemble(body, loads->n_loads, loads->loads, LOAD_VARYING, t, loads->varying));
    PetscCall(VecAXPY(f, scale, loads->varying));
  }
  PetscCall(VecGetArray(f, &array));
  AddValues(&loads->steady, PetscRealPart(scale), array);
  for (PetscInt i = 0; i < loads->n_uniform; i++) {
    const ExpressionPoint point = {{0}, {0}, t};
    PetscReal             density;

    PetscCall(ExpressionEvaluate(loads->uniform[i].density, &point, &density));
    AddValues(&loads->uniform[i].unit, PetscRealPart(scale) * density, array);
  }
  PetscCall(VecRestoreArray(f, &array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyLoadsDestroyForces(struct _BodyLoads *loads)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < loads->n_loads; i++) {
    for (int d = 0; d < 3; d++) PetscCall(ExpressionDestroy(&loads->loads[i].component[d]));
    PetscCall(BodyFacesDestroy(&loads->loads[i].faces));
  }
  for (PetscInt i = 0; i < loads->n_uniform; i++) {
    PetscCall(PetscFree(loads->uniform[i].unit.dofs));
    PetscCall(PetscFree(loads->uniform[i].unit.values));
  }
  PetscCall(PetscFree(loads->steady.dofs));
  PetscCall(PetscFree(loads->steady.values));
  PetscCall(PetscFree4(loads->points, loads->x, loads->weights, loads->shape));
  PetscCall(PetscFree(loads->uniform));
  PetscCall(PetscFree(loads->loads));
  PetscCall(VecDestroy(&loads->varying));
  PetscFunctionReturn(PETSC_SUCCESS);
}
