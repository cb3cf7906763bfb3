/* Room for the rows of the interface of a body, and rows that take the place of others while a run goes on. */
#include <body/layout/bodyimpl.h>

enum { N_TRACES = 8 };

static void ListTraces(Body body, Trace *traces[N_TRACES])
{
  BodyTraces *t = &body->traces;

  traces[0] = &t->displacement_in;
  traces[1] = &t->velocity_in;
  traces[2] = &t->acceleration_in;
  traces[3] = &t->force_in;
  traces[4] = &t->displacement;
  traces[5] = &t->velocity;
  traces[6] = &t->acceleration;
  traces[7] = &t->reaction;
}

/* Waveforms of all rows, once the substeps are known */
PetscErrorCode BodyCreateTraces(Body body)
{
  Trace *traces[N_TRACES];

  PetscFunctionBegin;
  ListTraces(body, traces);
  for (PetscInt t = 0; t < N_TRACES; t++) PetscCall(TraceCreate(body->rows.local, body->time.substeps, traces[t]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyDestroyTraces(Body body)
{
  Trace *traces[N_TRACES];

  PetscFunctionBegin;
  ListTraces(body, traces);
  for (PetscInt t = 0; t < N_TRACES; t++) PetscCall(TraceDestroy(traces[t]));
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
  PetscCall(PetscCalloc4(rows->local, &rows->conditions, rows->local, &rows->constrained, rows->local, &rows->flexibility, rows->local,
                         &rows->robin));
  PetscCall(PetscMalloc1(rows->global, &rows->changed));
  PetscCall(BodyHandoverCreate(rows->local, &rows->handover));
  for (PetscInt k = 0; k < 3; k++) PetscCall(MatCreateVecs(rows->matrix, NULL, &body->work.rows[k]));
  PetscCall(BodySetNearRows(body, -1, NULL));
  rows->n_prescribed = rows->n_forced = rows->n_robin = 0;
  rows->laid_out++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyDestroyRowArrays(Body body)
{
  BodyRows *rows = &body->rows;

  PetscFunctionBegin;
  PetscCall(PetscFree4(rows->conditions, rows->constrained, rows->flexibility, rows->robin));
  PetscCall(PetscFree(rows->changed));
  PetscCall(PetscFree(rows->by_mean));
  PetscCall(BodyHandoverDestroy(&rows->handover));
  PetscCall(VecDestroy(&rows->exchange.force));
  PetscCall(BodyDestroyNearRows(body));
  for (PetscInt k = 0; k < 3; k++) PetscCall(VecDestroy(&body->work.rows[k]));
  PetscCall(MatDestroy(&rows->free_matrix));
  PetscCall(RowPatternDestroy(&rows->pattern));
  PetscCall(BodyGramDestroy(&rows->gram));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The traces of the rows there are now, from those of the rows that there were; zeros for rows that are new */
static PetscErrorCode MoveTraces(Body body, const PetscInt from[])
{
  Trace *traces[N_TRACES], old[N_TRACES];

  PetscFunctionBegin;
  ListTraces(body, traces);
  for (PetscInt t = 0; t < N_TRACES; t++) {
    old[t]     = *traces[t];
    *traces[t] = NULL;
  }
  PetscCall(BodyCreateTraces(body));
  for (PetscInt t = 0; t < N_TRACES; t++) {
    for (PetscInt level = 0; level <= body->time.substeps; level++) {
      PetscScalar *before, *now;

      PetscCall(TraceGetLevel(old[t], level, &before));
      PetscCall(TraceGetLevel(*traces[t], level, &now));
      for (PetscInt i = 0; i < body->rows.local; i++) now[i] = from[i] < 0 ? 0 : before[from[i]];
    }
    PetscCall(TraceDestroy(&old[t]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What levels of cut steps know of the rows begins anew; their factors stay */
static PetscErrorCode RenewLevels(Body body)
{
  struct _BodyCompliance *first = body->compliance, *renewed;
  ConstrainedSolver       of_first;

  PetscFunctionBegin;
  PetscCall(BodyCreateCompliance(body));
  renewed  = body->compliance;
  of_first = body->solver;
  if (of_first) PetscCall(ConstrainedSolverReplaceRows(of_first, body->rows.free_matrix));
  for (PetscInt k = 0; k <= STEP_MAX_CUTS; k++) { /* the present one may be in the list too */
    BodyLevel *level = &body->levels[k];

    if (!level->compliance) continue;
    if (level->compliance == first) level->compliance = renewed;
    else {
      body->compliance = level->compliance;
      PetscCall(BodyDestroyCompliance(body));
      PetscCall(BodyCreateCompliance(body));
      level->compliance = body->compliance;
    }
    body->compliance = level->compliance;
    if (level->solver && level->solver != of_first) PetscCall(ConstrainedSolverReplaceRows(level->solver, body->rows.free_matrix));
  }
  body->compliance = first;
  PetscCall(BodyDestroyCompliance(body));
  body->compliance = renewed;
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
  PetscCall(BodyDestroyRepeat(body));
  PetscCall(PetscObjectReference((PetscObject)B));
  PetscCall(MatDestroy(&rows->matrix));
  rows->matrix = B;
  PetscCall(BodyCreateRowArrays(body));
  PetscCall(MatMult(rows->matrix, body->saved.u, body->work.rows[0])); /* as BodyUseScatter() does with the scatter of a matrix */
  PetscCall(BodySetUpFreeRows(body));
  PetscCall(MoveTraces(body, from));
  PetscCall(RenewLevels(body));
  for (PetscInt i = 0; i < rows->global; i++) rows->changed[i] = 1;
  if (body->integrator->ops.setrows) PetscCall((*body->integrator->ops.setrows)(body, rows->changed));
  PetscCall(BodySetRowsOfLevels(body, rows->changed));
  PetscCall(ConstrainedSolverDestroy(&body->mass.solver));
  if (had_mass_solver) PetscCall(BodySetUpMassSolver(body));
  PetscCall(BodySetUpRepeat(body));
  PetscCall(BodySetConstraints(body));
  PetscCall(BodyHandoverEnd(body));
  body->repeats = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
