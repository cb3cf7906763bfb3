/* Room for the rows of the interface of a body, and rows that take the place of others while a run goes on. */
#include "complianceimpl.h"

/* Waveforms of all rows, once the substeps are known */
PetscErrorCode BodyCreateTraces(Body body)
{
  PetscFunctionBegin;
  for (PetscInt t = 0; t < BODY_TRACES; t++) PetscCall(TraceCreate(body->rows.local, body->time.substeps, &body->traces.all[t]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyDestroyTraces(Body body)
{
  PetscFunctionBegin;
  for (PetscInt t = 0; t < BODY_TRACES; t++) PetscCall(TraceDestroy(&body->traces.all[t]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for as many rows as the matrix has, all of them free */
PetscErrorCode BodyCreateRowArrays(Body body)
{
  BodyRows *rows = &body->rows;
  PetscBool elsewhere;

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(rows->matrix, &rows->local, NULL));
  PetscCall(MatGetSize(rows->matrix, &rows->global, NULL));
  PetscCall(MatGetOwnershipRange(rows->matrix, &rows->begin, NULL));
  elsewhere = (PetscBool)(rows->local && !body->mesh.is_owner);
  if (body->mesh.whole) PetscCall(BodyAnyRank(body, &elsewhere));
  rows->at_home = (PetscBool)(body->mesh.whole && !elsewhere);
  PetscCall(PetscCalloc5(rows->local, &rows->conditions, rows->local, &rows->constrained, rows->local, &rows->flexibility, rows->local,
                         &rows->robin, rows->local, &rows->excess));
  PetscCall(PetscMalloc1(rows->global, &rows->changed));
  PetscCall(PetscMalloc4(rows->local, &rows->handover.before, rows->local, &rows->handover.now, rows->local, &rows->handover.rest,
                         rows->local, &rows->handover.intervals));
  PetscCall(PetscCalloc4(rows->local, &rows->inputs[0], rows->local, &rows->inputs[1], rows->local, &rows->changes[0], rows->local,
                         &rows->changes[1]));
  for (PetscInt k = 0; k < 3; k++) PetscCall(MatCreateVecs(rows->matrix, NULL, &body->work.rows[k]));
  PetscCall(BodySetNearRows(body, -1, NULL));
  rows->n_prescribed = rows->n_forced = rows->n_robin = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyDestroyRowArrays(Body body)
{
  BodyRows *rows = &body->rows;

  PetscFunctionBegin;
  PetscCall(PetscFree5(rows->conditions, rows->constrained, rows->flexibility, rows->robin, rows->excess));
  PetscCall(PetscFree(rows->changed));
  PetscCall(PetscFree(rows->by_mean));
  PetscCall(MatDestroy(&rows->handover.matrix));
  PetscCall(PetscFree4(rows->handover.before, rows->handover.now, rows->handover.rest, rows->handover.intervals));
  PetscCall(PetscFree4(rows->inputs[0], rows->inputs[1], rows->changes[0], rows->changes[1]));
  PetscCall(VecDestroy(&rows->exchange.force));
  PetscCall(MatDestroy(&rows->near.matrix));
  PetscCall(VecDestroy(&rows->near.values));
  PetscCall(PetscFree(rows->near.numbers));
  rows->near.n = -1;
  for (PetscInt k = 0; k < 3; k++) PetscCall(VecDestroy(&body->work.rows[k]));
  PetscCall(MatDestroy(&rows->free_matrix));
  PetscCall(BodyGramDestroy(&rows->gram));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The traces of the rows there are now, from those of the rows that there were; zeros for rows that are new */
static PetscErrorCode MoveTraces(Body body, const PetscInt from[])
{
  BodyTraces old = body->traces;

  PetscFunctionBegin;
  PetscCall(BodyCreateTraces(body));
  for (PetscInt t = 0; t < BODY_TRACES; t++) {
    for (PetscInt level = 0; level <= body->time.substeps; level++) {
      PetscScalar *before, *now;

      PetscCall(TraceGetLevel(old.all[t], level, &before));
      PetscCall(TraceGetLevel(body->traces.all[t], level, &now));
      for (PetscInt i = 0; i < body->rows.local; i++) now[i] = from[i] < 0 ? 0 : before[from[i]];
    }
    PetscCall(TraceDestroy(&old.all[t]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What levels of cut steps know of nodes begins anew, as slabs lie at the rows; factors get other rows. The present level is the first. */
static PetscErrorCode RenewLevels(Body body)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k <= STEP_MAX_CUTS; k++) {
    struct _BodyCompliance *compliance = k ? body->levels[k].compliance : body->compliance;
    const ConstrainedSolver solver     = k ? body->levels[k].solver : body->solver;

    if (compliance) PetscCall(ComplianceDestroy(&compliance->nodal));
    if (compliance) PetscCall(NodalMatrixDestroy(&compliance->nodal_matrix));
    if (solver && (k == 0 || solver != body->solver)) PetscCall(ConstrainedSolverReplaceRows(solver, body->rows.free_matrix));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Announces, before the set-up, that rows may come in the course of a run */
PetscErrorCode BodyExpectRows(Body body)
{
  PetscFunctionBegin;
  BodyCheckNotSetUp(body);
  body->rows.expected = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives the body other rows at the start of a whole controller step. `from`: for each row of this rank its former number there, with the
   same entries; -1: it is new. No matrix is factored again; all rows are free afterwards. Collective. */
PetscErrorCode BodyReplaceInterface(Body body, Mat B, const PetscInt from[])
{
  BodyRows       *rows            = &body->rows;
  const PetscBool had_mass_solver = (PetscBool)(body->mass.solver != NULL);

  PetscFunctionBegin;
  PetscCheck(body->setup && !body->time.level && (rows->expected || rows->global), PetscObjectComm((PetscObject)body),
             PETSC_ERR_ARG_WRONGSTATE, "Call after BodySetUp() with rows, or with BodyExpectRows(), at the start of a whole step");
  PetscCall(BodyDestroyRowArrays(body));
  PetscCall(PetscObjectReference((PetscObject)B));
  PetscCall(MatDestroy(&rows->matrix));
  rows->matrix = B;
  PetscCall(BodyCreateRowArrays(body));
  PetscCall(MatMult(rows->matrix, body->saved.u, body->work.rows[0])); /* as BodyUseScatter() does with the scatter of a matrix */
  PetscCall(BodySetUpFreeRows(body));
  PetscCall(MoveTraces(body, from));
  PetscCall(RenewLevels(body));
  for (PetscInt i = 0; i < rows->global; i++) rows->changed[i] = 1;
  PetscCall(BodySetRowsOfLevels(body, rows->changed));
  PetscCall(ConstrainedSolverDestroy(&body->mass.solver));
  if (had_mass_solver) PetscCall(BodySetUpMassSolver(body));
  PetscCall(BodySetConstraints(body));
  PetscCall(BodyHandoverEnd(body));
  body->repeats = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of the matrix that are in a list of this rank; those of all ranks that have such a list */
static PetscErrorCode CreateMatrix(Body body, RowList *list)
{
  BodyRows *rows = &body->rows;
  MPI_Comm  comm = PetscObjectComm((PetscObject)rows->matrix);
  PetscInt *numbers;
  IS        some;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(list->n, &numbers));
  for (PetscInt k = 0; k < list->n; k++) numbers[k] = rows->begin + list->numbers[k];
  PetscCall(ISCreateGeneral(comm, list->n, numbers, PETSC_OWN_POINTER, &some));
  PetscCall(MatCreateSubMatrix(rows->matrix, some, NULL, MAT_INITIAL_MATRIX, &list->matrix));
  PetscCall(MatCreateVecs(list->matrix, NULL, &list->values));
  PetscCall(ISDestroy(&some));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Limits the rows that may have a force and are read, until they get new entries: ascending numbers on this rank; n < 0 on all ranks: all
   rows. Output traces of other rows stay as they are until BodyWriteStartTraces(). No row is prescribed or a Robin row. Collective. */
PetscErrorCode BodySetNearRows(Body body, PetscInt n, const PetscInt near[])
{
  BodyRows       *rows = &body->rows;
  const PetscBool all = (PetscBool)(n < 0), other = (PetscBool)(!all || rows->some_near || rows->near.n != rows->local);

  PetscFunctionBegin;
  PetscCall(MatDestroy(&rows->near.matrix));
  PetscCall(VecDestroy(&rows->near.values));
  rows->near.n    = all ? rows->local : n;
  rows->some_near = (PetscBool)!all;
  if (!rows->near.numbers) PetscCall(PetscMalloc1(rows->local, &rows->near.numbers));
  for (PetscInt k = 0; k < rows->near.n && other; k++) rows->near.numbers[k] = all ? k : near[k];
  if (!all) {
    PetscCall(CreateMatrix(body, &rows->near));
    for (PetscInt k = 0; k < 2; k++) PetscCall(PetscArrayzero(rows->changes[k], rows->local)); /* rows that nobody looks at have none */
  } else {
    PetscCall(PetscObjectReference((PetscObject)rows->matrix));
    PetscCall(PetscObjectReference((PetscObject)body->work.rows[0]));
    rows->near.matrix = rows->matrix;
    rows->near.values = body->work.rows[0];
  }
  if (other) PetscCall(BodyListContactDofs(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
