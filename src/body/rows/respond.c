/*
   The rows of a body through one controller step by its interface compliance alone. What comes out is affine in the forces on the rows,

     u_k = base u_k + sum_{l <= k} W_{k - l} (f_l - base f_l),

   with the base from a whole integration. Forces of forced rows are given; those of prescribed ones follow, substep by substep, from the
   displacement that they are to have. So the sweeps of a controller step need no solution with the body's matrices but for the base, and
   for the state at the end.
*/
#include "complianceimpl.h"
#include <petscblaslapack.h>

/*@
  BodySetBase - takes the integration just made, under forces only, as what `BodyRespond()` counts changes from

  Collective

  Input Parameter:
. body - the `Body`, integrated in this controller step, no row being prescribed

  Level: developer

.seealso: `Body`, `BodyRespond()`, `BodyIntegrate()`
@*/
PetscErrorCode BodySetBase(Body body)
{
  struct _BodyCompliance *c;
  PetscScalar            *displacement, *force;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(BodyCreateCompliance(body));
  c = body->compliance;
  for (PetscInt k = 0; k < body->time.substeps; k++) {
    PetscCall(TraceGetLevel(body->traces.displacement, k + 1, &displacement));
    PetscCall(TraceGetLevel(body->traces.force_in, k + 1, &force));
    for (PetscInt i = 0; i < body->rows.local; i++) {
      c->base_displacement[k * body->rows.local + i] = displacement[i];
      c->base_force[k * body->rows.local + i]        = body->rows.conditions[i] == BODY_FORCED ? force[i] : 0;
    }
  }
  c->base_gathered = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetFreeBase - takes what the body would do without contact as what `BodyRespond()` counts changes from, without integrating it

  Collective

  Input Parameter:
. body - the `Body`, one with `BodyHasFreeRows()`

  Level: developer

.seealso: `Body`, `BodySetBase()`, `BodyComputeFreeRows()`
@*/
PetscErrorCode BodySetFreeBase(Body body)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(BodyCreateCompliance(body));
  PetscCall(BodyComputeFreeRows(body, body->compliance->base_displacement));
  PetscCall(PetscArrayzero(body->compliance->base_force, body->rows.local));
  body->compliance->base_gathered = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For substeps: the force on each prescribed row by the displacement that it is to have at the end */
static PetscErrorCode FactorPrescribed(Body body)
{
  struct _BodyCompliance *c = body->compliance;
  PetscBLASInt            n, info;

  PetscFunctionBegin;
  if (!c->n_prescribed) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt j = 0; j < c->n_prescribed; j++)
    for (PetscInt i = 0; i < c->n_prescribed; i++)
      c->factor[j * c->n_prescribed + i] = c->levels[c->prescribed[j] * c->capacity + c->prescribed[i]];
  PetscCall(PetscBLASIntCast(c->n_prescribed, &n));
  PetscCallBLAS("LAPACKgetrf", LAPACKgetrf_(&n, &n, c->factor, &n, c->pivots, &info));
  PetscCheck(info == 0, PetscObjectComm((PetscObject)body), PETSC_ERR_MAT_LU_ZRPVT,
             "The prescribed contact rows of body '%s' are not independent (LAPACK getrf info %d); is a node in two contact pairs?",
             body->hdr.name, (int)info);
  c->factored = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetRoles - says which rows are prescribed and which are loaded in `BodyRespond()`

  Collective

  Input Parameters:
+ body  - the `Body`, all rows with a role being known to its compliance
- roles - `BODY_FREE`, `BODY_PRESCRIBED` or `BODY_FORCED` for each row of this rank

  Level: developer

  Note:
  Factors the compliance of the prescribed rows, if they are others than in the last call or have changed. The conditions under which
  `BodyIntegrate()` integrates stay as they are.

.seealso: `Body`, `BodyRespond()`, `BodyExtendCompliance()`
@*/
PetscErrorCode BodySetRoles(Body body, const BodyCondition roles[])
{
  struct _BodyCompliance *c;
  const BodyRows         *rows  = &body->rows;
  PetscInt                count = 0;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(BodyCreateCompliance(body));
  c = body->compliance;
  PetscCall(PetscArraycpy(c->roles, roles, rows->local));
  PetscCall(PetscArrayzero(c->all_roles, rows->global));
  for (PetscInt i = 0; i < rows->local; i++) c->all_roles[rows->begin + i] = (PetscMPIInt)roles[i];
  if (rows->size > 1)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, c->all_roles, (PetscMPIInt)rows->global, MPI_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
  for (PetscInt i = 0; i < rows->global; i++) {
    if (c->all_roles[i] == BODY_FREE) continue;
    PetscCheck(c->place[i] >= 0, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
               "Row %" PetscInt_FMT " of body '%s' is not known to its compliance; call BodyExtendCompliance() first", i, body->hdr.name);
    if (c->all_roles[i] != BODY_PRESCRIBED) continue;
    if (count >= c->n_prescribed || c->prescribed[count] != c->place[i]) c->factored = PETSC_FALSE;
    c->prescribed[count++] = c->place[i];
  }
  if (count != c->n_prescribed) c->factored = PETSC_FALSE;
  c->n_prescribed = count;
  if (!c->factored) PetscCall(FactorPrescribed(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What comes in, on the known rows of every rank: displacements of prescribed rows, forces of others */
static PetscErrorCode GatherInputs(Body body)
{
  struct _BodyCompliance *c = body->compliance;
  PetscScalar            *displacement, *force;

  PetscFunctionBegin;
  if (!c->base_gathered) {
    PetscCall(BodyGatherKnown(body, c->base_displacement, c->known_displacement));
    PetscCall(BodyGatherKnown(body, c->base_force, c->known_force));
    c->base_gathered = PETSC_TRUE;
  }
  for (PetscInt k = 0; k < body->time.substeps; k++) {
    PetscCall(TraceGetLevel(body->traces.displacement_in, k + 1, &displacement));
    PetscCall(TraceGetLevel(body->traces.force_in, k + 1, &force));
    for (PetscInt i = 0; i < body->rows.local; i++)
      c->mine[k * body->rows.local + i] = c->roles[i] == BODY_PRESCRIBED ? displacement[i] : c->roles[i] == BODY_FORCED ? force[i] : 0;
  }
  PetscCall(BodyGatherKnown(body, c->mine, c->input));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Substep k, with those before it done */
static PetscErrorCode RespondSubstep(Body body, PetscInt k)
{
  struct _BodyCompliance *c = body->compliance;
  PetscScalar            *u = c->displacement + k * c->n, *f = c->force + k * c->n, plus = 1;
  PetscBLASInt            n, leading, one                                                = 1, m, info;

  PetscFunctionBegin;
  if (!c->n) PetscFunctionReturn(PETSC_SUCCESS); /* BLAS refuses matrices without rows */
  PetscCall(PetscBLASIntCast(c->n, &n));
  PetscCall(PetscBLASIntCast(c->capacity, &leading));
  PetscCall(PetscBLASIntCast(c->n_prescribed, &m));
  PetscCall(PetscArraycpy(u, c->known_displacement + k * c->n, c->n));
  PetscCall(PetscArraycpy(f, c->input + k * c->n, c->n));
  for (PetscInt i = 0; i < c->n_prescribed; i++) f[c->prescribed[i]] = c->known_force[k * c->n + c->prescribed[i]];
  /* f holds changes from here on, of prescribed rows none yet */
  for (PetscInt i = 0; i < c->n; i++) f[i] -= c->known_force[k * c->n + i];
  for (PetscInt l = 0; l <= k; l++)
    PetscCallBLAS("BLASgemv", BLASgemv_("N", &n, &n, &plus, c->levels + (k - l) * c->capacity * c->capacity, &leading, c->force + l * c->n,
                                        &one, &plus, u, &one));
  if (!c->n_prescribed) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < c->n_prescribed; i++) c->rhs[i] = c->input[k * c->n + c->prescribed[i]] - u[c->prescribed[i]];
  PetscCallBLAS("LAPACKgetrs", LAPACKgetrs_("N", &m, &one, c->factor, &m, c->pivots, c->rhs, &m, &info));
  for (PetscInt i = 0; i < c->n_prescribed; i++) {
    const PetscInt place = c->prescribed[i];

    f[place] += c->rhs[i];
    PetscCallBLAS("BLASaxpy", BLASaxpy_(&n, &c->rhs[i], c->levels + place * c->capacity, &one, u, &one));
  }
  for (PetscInt i = 0; i < c->n_prescribed; i++) u[c->prescribed[i]] = c->input[k * c->n + c->prescribed[i]];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyRespond - displacements and reactions of the known rows for the input traces as they are, by the compliance alone

  Collective

  Input Parameter:
. body - the `Body`, after `BodySetBase()` in this controller step, and `BodySetRoles()`

  Level: developer

  Notes:
  Reads `displacement_in` of prescribed and `force_in` of forced rows, writes `displacement` of known rows and `reaction` of prescribed
ones; the state of the body stays as it is. For linear bodies with massless contact nodes the same as `BodyIntegrate()`, up to round-off.

.seealso: `Body`, `BodySetBase()`, `BodyIntegrate()`
@*/
PetscErrorCode BodyRespond(Body body)
{
  struct _BodyCompliance *c    = body->compliance;
  const BodyRows         *rows = &body->rows;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(c, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetBase() first");
  PetscCall(GatherInputs(body));
  for (PetscInt k = 0; k < body->time.substeps; k++) PetscCall(RespondSubstep(body, k));
  for (PetscInt k = 0; k < body->time.substeps; k++) {
    PetscScalar *displacement, *reaction;

    PetscCall(TraceGetLevel(body->traces.displacement, k + 1, &displacement));
    PetscCall(TraceGetLevel(body->traces.reaction, k + 1, &reaction));
    for (PetscInt i = 0; i < rows->local; i++) {
      const PetscInt place = c->place[rows->begin + i];

      reaction[i] = 0;
      if (place < 0) continue;
      displacement[i] = c->displacement[k * c->n + place];
      if (c->roles[i] == BODY_PRESCRIBED) reaction[i] = c->known_force[k * c->n + place] + c->force[k * c->n + place];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
