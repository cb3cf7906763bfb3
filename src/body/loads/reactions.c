/* The forces that hold the surfaces whose displacement is prescribed. */
#include "loadsimpl.h"

#define N_SUMS 6

/* Room for the sums, when the surfaces are known */
PetscErrorCode BodyLoadsSetUpReactions(Body body)
{
  struct _BodyLoads *loads = body->loads;
  PetscInt           n;

  PetscFunctionBegin;
  PetscCall(PetscFree(loads->reactions));
  PetscCall(BodyGetNumReactions(body, &n));
  PetscCall(PetscCalloc1(N_SUMS * n, &loads->reactions));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetNumReactions - how many surfaces of a body have prescribed displacements; of a rigid body, 1 where it is led

  Not Collective

  Input Parameter:
. body - the `Body`, with its loads

  Output Parameter:
. n - number of surfaces or node sets in the list of prescribed displacements

  Level: intermediate

.seealso: `Body`, `BodyGetReactions()`, `BodyGetReactionSurface()`, `BodyAddDisplacement()`
@*/
PetscErrorCode BodyGetNumReactions(Body body, PetscInt *n)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(n, 2);
  *n = body->loads ? body->loads->n_prescribed + (body->loads->led ? 1 : 0) : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  BodyGetReactionSurface - the name of a surface with prescribed displacements

  Not Collective

  Input Parameters:
+ body - the `Body`, with its loads
- i    - 0 to the number of `BodyGetNumReactions()` - 1, in the order in which they were given

  Output Parameter:
. name - of surface or node set, owned by the body; `rigid` for what leads a rigid body as a whole

  Level: intermediate

.seealso: `Body`, `BodyGetReactions()`, `BodyGetNumReactions()`
@*/
PetscErrorCode BodyGetReactionSurface(Body body, PetscInt i, const char *name[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(name, 3);
  if (BodyIsLed(body) && i == body->loads->n_prescribed) {
    *name = "rigid";
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheck(body->loads && i >= 0 && i < body->loads->n_prescribed, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
             "Body '%s' has no surface %" PetscInt_FMT " with prescribed displacements", body->hdr.name, i);
  *name = body->loads->prescribed[i].surface;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds what holds some dofs (no list: all) to their surface's sums; `applied`: outside forces and reactions, `outside`: the former [N] */
static void AddDofs(PetscInt n, const PetscInt dofs[], PetscInt dim, const PetscScalar x[], const PetscScalar u[],
                    const PetscScalar applied[], const PetscScalar outside[], PetscReal sums[])
{
  PetscReal *force = sums, *moment = sums + 3;

  for (PetscInt i = 0; i < n; i++) {
    const PetscInt  dof = dofs ? dofs[i] : i, d = dof % dim, first = dof - d;
    const PetscReal f      = PetscRealPart(applied[dof] - outside[dof]);
    PetscReal       arm[3] = {0};

    for (PetscInt k = 0; k < dim; k++) arm[k] = PetscRealPart(x[first + k] + u[first + k]);
    force[d] += f;
    /* arm x (f e_d) */
    moment[(d + 1) % 3] += arm[(d + 2) % 3] * f;
    moment[(d + 2) % 3] -= arm[(d + 1) % 3] * f;
  }
}

/*@
  BodyGetReactions - forces and moments that hold each surface with prescribed displacements

  Collective

  Input Parameter:
. body - the `Body`, at its start or after an accepted step (`BodySave()`)

  Output Parameters:
+ force  - three for each surface, zeros beyond the dimension: what the support exerts on the body, positive along the axes [N]
- moment - three for each surface: of these forces about the origin, where the nodes are now [N m]

  Level: intermediate

  Notes:
  On each held degree of freedom inertia and internal force less forces from outside and of contact: so that reactions, loads and contact
  forces add up to the rate of the body's momentum, and their moments to that of its angular momentum. At the ends of steps of `TSALPHA2`
  with other parameters than alpha_m = alpha_f = 1 that holds up to an error of the order of the step.

  A component of a node that several surfaces prescribe belongs to the one named last, whose prescription holds: no force is counted twice.

  Of axisymmetric bodies the first component is the sum of what acts away from the axis, all around; there are no moments.

  The loads of a static body begin in its first step: at the start it has the reactions of its strain alone.

.seealso: `Body`, `BodyGetNumReactions()`, `BodyGetReactionSurface()`, `BodyAddDisplacement()`
@*/
PetscErrorCode BodyGetReactions(Body body, PetscReal force[], PetscReal moment[])
{
  struct _BodyLoads *loads   = body->loads;
  Vec                outside = body->work.nodes[0];
  const PetscInt     dim     = body->mesh.dim;
  const PetscScalar *x, *u, *applied, *external;
  PetscInt           n;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call after BodySetUp()");
  PetscCall(BodyGetNumReactions(body, &n));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscAssertPointer(force, 2);
  PetscAssertPointer(moment, 3);
  PetscCall(VecZeroEntries(outside));
  if (body->integrator->has_inertia || body->state.step) PetscCall(BodyAddExternalForce(body, body->state.time, 1, outside));
  if (!loads->reactions) PetscCall(BodyLoadsSetUpReactions(body));
  PetscCall(PetscArrayzero(loads->reactions, N_SUMS * n));
  PetscCall(VecGetArrayRead(body->mesh.positions, &x));
  PetscCall(VecGetArrayRead(body->state.u, &u));
  PetscCall(VecGetArrayRead(body->state.applied, &applied));
  PetscCall(VecGetArrayRead(outside, &external));
  for (PetscInt g = 0; g < loads->n_groups && loads->groups[g].prescription < loads->n_prescribed; g++)
    AddDofs(loads->groups[g].held.n, loads->groups[g].held.dofs, dim, x, u, applied, external,
            loads->reactions + N_SUMS * loads->groups[g].prescription);
  if (loads->led)
    AddDofs(body->mesh.owned_nodes * dim, NULL, dim, x, u, applied, external, loads->reactions + N_SUMS * loads->n_prescribed);
  PetscCall(VecRestoreArrayRead(outside, &external));
  PetscCall(VecRestoreArrayRead(body->state.applied, &applied));
  PetscCall(VecRestoreArrayRead(body->state.u, &u));
  PetscCall(VecRestoreArrayRead(body->mesh.positions, &x));
  if (body->rows.size > 1)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, loads->reactions, (PetscMPIInt)(N_SUMS * n), MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt d = 0; d < 3; d++) {
      force[3 * i + d]  = loads->reactions[N_SUMS * i + d];
      moment[3 * i + d] = body->model.element->axisymmetric ? 0 : loads->reactions[N_SUMS * i + 3 + d];
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}
