/*
   The rows of a body through one controller step by its interface compliance alone. What comes out is affine in the forces on the rows,

     u_k = base u_k + sum_{l <= k} W_{k - l} (f_l - base f_l),

   with the base from a whole integration. Forces of forced rows are given. Those of prescribed rows follow, substep by substep, from the
   displacement x that they are to have, and those of Robin rows from f + alpha u = r:

     u = x,   u + f / alpha = r / alpha,

   so that 1 / alpha is added to the diagonal of W_0. So the sweeps of a controller step need no solution with the body's matrices but for
   the base, and for the state at the end.
*/
#include "complianceimpl.h"

/* Up to so many rows of a body sums are made here, and not by BLAS */
#define FEW_ROWS 8

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
  c->has_base      = PETSC_TRUE;
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
  PetscCall(BodyComputeFreeRows(body, body->compliance->base_displacement));
  PetscCall(PetscArrayzero(body->compliance->base_force, body->rows.local));
  body->compliance->base_gathered = PETSC_FALSE;
  body->compliance->has_base      = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetRestBase - takes rest without forces as what `BodyRespond()` counts changes from

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Level: developer

  Note:
  For differences of responses, in which the base does not matter.

.seealso: `Body`, `BodySetBase()`
@*/
PetscErrorCode BodySetRestBase(Body body)
{
  struct _BodyCompliance *c = body->compliance;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(PetscArrayzero(c->base_displacement, body->time.substeps * body->rows.local));
  PetscCall(PetscArrayzero(c->base_force, body->time.substeps * body->rows.local));
  c->base_gathered = PETSC_FALSE;
  c->has_base      = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The force on each prescribed or Robin row by what its displacement is to be at the end of a substep */
static PetscErrorCode FactorSolved(Body body)
{
  struct _BodyCompliance *c = body->compliance;
  const PetscScalar      *W;
  const PetscInt         *place;
  PetscInt                leading;
  PetscBool               singular;

  PetscFunctionBegin;
  PetscCall(DenseFactorResize(&c->factor, c->n_solved, body->rows.global));
  ComplianceGetRows(c->matrices, NULL, NULL, &place);
  ComplianceGetMatrix(c->matrices, 0, &leading, &W);
  for (PetscInt j = 0; j < c->n_solved; j++)
    for (PetscInt i = 0; i < c->n_solved; i++)
      c->factor.values[j * c->n_solved + i] = W[place[c->solved[j]] * leading + place[c->solved[i]]] +
                                              (i == j ? c->all_flexibility[c->solved[i]] : 0);
  PetscCall(DenseFactorCompute(&c->factor, &singular));
  PetscCheck(!singular, body->rows.at_home ? PETSC_COMM_SELF : PetscObjectComm((PetscObject)body), PETSC_ERR_MAT_LU_ZRPVT,
             "The prescribed contact rows of body '%s' are not independent: their compliance is singular; is a node in two contact pairs?",
             body->hdr.name);
  c->factored_state = ComplianceGetState(c->matrices);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether this rank takes part in what rows answer, and whether several do */
static PetscBool TakesPart(Body body)
{
  return (PetscBool)(!body->rows.at_home || body->mesh.is_owner);
}

static PetscBool IsShared(Body body)
{
  return (PetscBool)(body->rows.size > 1 && !body->rows.at_home);
}

/*@
  BodyProposeRoles - says which rows of this rank are prescribed and which are loaded in `BodyRespond()`

  Not Collective

  Input Parameters:
+ body  - the `Body`, all rows with a role being known to its compliance
- roles - for each row of this rank; Robin rows have the springs of `BodySetRobin()`

  Output Parameter:
. word - what ranks have to add up before `BodyTakeRoles()`; it stays with the body

  Level: developer

.seealso: `Body`, `BodyTakeRoles()`, `BodyRespond()`, `BodyExtendCompliance()`
@*/
PetscErrorCode BodyProposeRoles(Body body, const BodyCondition roles[], BodyWord *word)
{
  struct _BodyCompliance *c    = body->compliance;
  const BodyRows         *rows = &body->rows;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(word, 3);
  word->n      = IsShared(body) ? rows->global : 0;
  word->values = c->told_roles;
  if (!TakesPart(body)) PetscFunctionReturn(PETSC_SUCCESS); /* no other rank responds */
  PetscCall(PetscArraycpy(c->roles, roles, rows->local));
  PetscCall(PetscArrayzero(c->told_roles, rows->global));
  for (PetscInt i = 0; i < rows->local; i++) c->told_roles[rows->begin + i] = (PetscReal)roles[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyTakeRoles - the roles of the rows of all ranks in `BodyRespond()`

  Collective

  Input Parameter:
. body - the `Body`, after `BodyProposeRoles()`, the word of which has been added up

  Level: developer

  Note:
  Factors the compliance of the prescribed and Robin rows, if they are others than in the last call or have changed. The conditions under
which `BodyIntegrate()` integrates stay as they are.

.seealso: `Body`, `BodyProposeRoles()`, `BodyRespond()`
@*/
PetscErrorCode BodyTakeRoles(Body body)
{
  struct _BodyCompliance *c    = body->compliance;
  const BodyRows         *rows = &body->rows;
  const PetscInt         *place;
  PetscInt                count = 0;
  PetscBool               same = PETSC_TRUE, robin = PETSC_FALSE;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (!TakesPart(body)) PetscFunctionReturn(PETSC_SUCCESS);
  ComplianceGetRows(c->matrices, NULL, NULL, &place);
  for (PetscInt i = 0; i < rows->global; i++) {
    c->all_roles[i] = (PetscMPIInt)PetscRealPart(c->told_roles[i]);
    if (c->all_roles[i] == BODY_FREE) continue;
    PetscCheck(ComplianceKnows(c->matrices, i), PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
               "Row %" PetscInt_FMT " of body '%s' is not known to its compliance; call BodyExtendCompliance() first", i, body->hdr.name);
    if (c->all_roles[i] == BODY_FORCED) continue;
    if (c->all_roles[i] == BODY_ROBIN) robin = PETSC_TRUE;
    if (count >= c->n_solved || c->solved[count] != i) same = PETSC_FALSE;
    c->solved[count++] = i;
  }
  if (count != c->n_solved || robin) same = PETSC_FALSE;
  c->n_solved = count;
  if (same && c->factored_state == ComplianceGetState(c->matrices)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArrayzero(c->all_flexibility, rows->global));
  if (robin) {
    for (PetscInt i = 0; i < rows->local; i++)
      if (c->roles[i] == BODY_ROBIN) c->all_flexibility[rows->begin + i] = 1 / body->rows.robin[i];
    if (IsShared(body))
      PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, c->all_flexibility, (PetscMPIInt)rows->global, MPIU_REAL, MPIU_SUM,
                                 PetscObjectComm((PetscObject)body)));
  }
  PetscCall(FactorSolved(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for values of the rows that are known now, at each substep */
static PetscErrorCode MakeRoom(Body body)
{
  struct _BodyCompliance *c = body->compliance;
  PetscInt                n, size;

  PetscFunctionBegin;
  ComplianceGetRows(c->matrices, &n, NULL, NULL);
  if (n <= c->room) PetscFunctionReturn(PETSC_SUCCESS);
  c->room = PetscMin(body->rows.global, PetscMax(n, 2 * c->room));
  size    = body->time.substeps * c->room;
  PetscCall(PetscFree4(c->known_displacement, c->force, c->displacement, c->rhs));
  PetscCall(PetscMalloc4(3 * size, &c->known_displacement, size, &c->force, size, &c->displacement, c->room, &c->rhs));
  c->base_gathered = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyProposeInputs - what comes in along the rows of this rank, which all ranks that have rows are to know before `BodyRespond()`

  Not Collective

  Input Parameter:
. body - the `Body`, after `BodySetBase()` in this controller step, and `BodyTakeRoles()`

  Output Parameter:
. word - what ranks have to add up: displacements of prescribed rows [m], forces of forced ones and right-hand sides of Robin rows [N], and
         the base where it is not known yet; it stays with the body. Ranks that are not asked here ask each other in `BodyRespond()`.

  Level: developer

.seealso: `Body`, `BodyRespond()`
@*/
PetscErrorCode BodyProposeInputs(Body body, BodyWord *word)
{
  struct _BodyCompliance *c     = body->compliance;
  const PetscInt          local = body->rows.local, substeps = body->time.substeps;
  PetscScalar            *displacement, *force;
  PetscInt                n;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(word, 2);
  PetscCheck(c && c->has_base, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetBase() first");
  word->n = 0;
  if (!TakesPart(body)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MakeRoom(body));
  for (PetscInt k = 0; k < substeps; k++) {
    PetscCall(TraceGetLevel(body->traces.displacement_in, k + 1, &displacement));
    PetscCall(TraceGetLevel(body->traces.force_in, k + 1, &force));
    for (PetscInt i = 0; i < local; i++)
      c->mine[k * local + i] = c->roles[i] == BODY_PRESCRIBED ? displacement[i] : c->roles[i] == BODY_FREE ? 0 : force[i];
  }
  ComplianceGetRows(c->matrices, &n, NULL, NULL);
  word->n = substeps * n;
  if (c->base_gathered && c->gathered_state == ComplianceGetState(c->matrices)) {
    ComplianceSpread(c->matrices, substeps, c->mine, c->input);
    word->values = c->input;
  } else {
    c->known_force = c->known_displacement + substeps * n;
    c->input       = c->known_force + substeps * n;
    ComplianceSpread(c->matrices, 3 * substeps, c->base_displacement, c->known_displacement);
    c->base_gathered  = PETSC_TRUE;
    c->gathered_state = ComplianceGetState(c->matrices);
    word->n *= 3;
    word->values = c->known_displacement;
  }
  if (!IsShared(body)) word->n = 0;
  c->told = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* u += W f for few rows, where calling a library takes longer than the sum */
static inline void AddFew(PetscInt n, PetscInt leading, const PetscScalar W[], const PetscScalar f[], PetscScalar u[])
{
  for (PetscInt j = 0; j < n; j++)
    for (PetscInt i = 0; i < n; i++) u[i] += W[j * leading + i] * f[j];
}

/* What the forces of substep k and those before have done by its end */
static PetscErrorCode AddResponses(const struct _BodyCompliance *c, PetscInt n, PetscInt k, PetscScalar u[])
{
  const PetscScalar *W;
  PetscInt           leading;

  PetscFunctionBegin;
  for (PetscInt l = 0; l <= k; l++) {
    ComplianceGetMatrix(c->matrices, k - l, &leading, &W);
    if (n <= FEW_ROWS) AddFew(n, leading, W, c->force + l * n, u);
    else PetscCall(DenseMultiplyAdd(n, leading, W, 1, c->force + l * n, u));
  }
  if (n <= FEW_ROWS) PetscCall(PetscLogFlops(2.0 * (PetscLogDouble)n * (PetscLogDouble)n * (PetscLogDouble)(k + 1)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Substep k, with those before it done */
static PetscErrorCode RespondSubstep(Body body, PetscInt k)
{
  struct _BodyCompliance *c = body->compliance;
  const PetscInt         *place;
  const PetscScalar      *W, *base;
  PetscScalar            *u, *f, *input;
  PetscInt                n, leading;

  PetscFunctionBegin;
  ComplianceGetRows(c->matrices, &n, NULL, &place);
  u     = c->displacement + k * n;
  f     = c->force + k * n; /* changes from the base: of prescribed and Robin rows none yet */
  input = c->input + k * n;
  base  = c->known_force + k * n;
  PetscCall(PetscArraycpy(u, c->known_displacement + k * n, n));
  for (PetscInt i = 0; i < n; i++) f[i] = input[i] - base[i];
  for (PetscInt i = 0; i < c->n_solved; i++) f[place[c->solved[i]]] = 0;
  PetscCall(AddResponses(c, n, k, u));
  if (!c->n_solved) PetscFunctionReturn(PETSC_SUCCESS);
  ComplianceGetMatrix(c->matrices, 0, &leading, &W);
  for (PetscInt i = 0; i < c->n_solved; i++) {
    const PetscInt  row = c->solved[i], at = place[row];
    const PetscReal flexibility = c->all_flexibility[row];

    c->rhs[i] = (c->all_roles[row] == BODY_ROBIN ? flexibility * (input[at] - base[at]) : input[at]) - u[at];
  }
  PetscCall(DenseFactorSolve(&c->factor, c->rhs));
  for (PetscInt j = 0; j < c->n_solved; j++) {
    const PetscInt at = place[c->solved[j]];

    f[at] = c->rhs[j];
    for (PetscInt i = 0; i < n; i++) u[i] += c->rhs[j] * W[at * leading + i];
  }
  for (PetscInt i = 0; i < c->n_solved; i++)
    if (c->all_roles[c->solved[i]] == BODY_PRESCRIBED) u[place[c->solved[i]]] = input[place[c->solved[i]]];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyRespond - displacements and reactions of the known rows for the input traces as they are, by the compliance alone

  Collective

  Input Parameter:
. body - the `Body`, after `BodySetBase()` in this controller step, and `BodyTakeRoles()`

  Level: developer

  Notes:
  Reads `displacement_in` of prescribed rows and `force_in` of forced and Robin rows, writes `displacement` of known rows and `reaction` of
  prescribed and Robin ones; the state of the body stays as it is. For linear bodies with massless contact nodes the same as
`BodyIntegrate()`, up to round-off.

.seealso: `Body`, `BodySetBase()`, `BodyProposeInputs()`, `BodyIntegrate()`
@*/
PetscErrorCode BodyRespond(Body body)
{
  struct _BodyCompliance *c    = body->compliance;
  const BodyRows         *rows = &body->rows;
  const PetscInt         *place;
  PetscInt                n;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (!TakesPart(body)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!c->told) {
    BodyWord word;

    PetscCall(BodyProposeInputs(body, &word));
    if (word.n)
      PetscCallMPI(
          MPI_Allreduce(MPI_IN_PLACE, word.values, (PetscMPIInt)word.n, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  }
  c->told = PETSC_FALSE;
  for (PetscInt k = 0; k < body->time.substeps; k++) PetscCall(RespondSubstep(body, k));
  ComplianceGetRows(c->matrices, &n, NULL, &place);
  for (PetscInt k = 0; k < body->time.substeps; k++) {
    PetscScalar *displacement, *reaction;

    PetscCall(TraceGetLevel(body->traces.displacement, k + 1, &displacement));
    PetscCall(TraceGetLevel(body->traces.reaction, k + 1, &reaction));
    for (PetscInt i = 0; i < rows->local; i++) {
      const PetscInt at = place[rows->begin + i];

      reaction[i] = 0;
      if (at < 0) continue;
      displacement[i] = c->displacement[k * n + at];
      if (c->roles[i] == BODY_PRESCRIBED || c->roles[i] == BODY_ROBIN) reaction[i] = c->known_force[k * n + at] + c->force[k * n + at];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
