/* S, what touching rows read by forces on them, from how bodies answer: S = sum of B_b W_b B_b^T, on every rank. Where no node of a body
   answers to forces on others W_b is diagonal. The part of such bodies is the product R R^T of sparse matrices, R being the columns of all
   B_b times the roots of the diagonals, side by side. R and its product are kept while entries stay in place. Each other body has a block,
   between all of its rows. Where these are a small part of a matrix of all rows by all rows, as those of many bodies are, S is sparse. */
#include "stepimpl.h"
#include <impakt/private/bodyforces.h>

#define FEW_ROWS  60    /* up to so many S is dense whatever it is made of, */
#define MANY_ROWS 150   /* and up to so many where bodies have blocks, whose LU factors are exact where bodies hang on soft springs */
#define SPARSE    0.25  /* blocks of bodies that are at most this part of S make it sparse */
#define ZERO      1e-14 /* entries of rows that are zero but for round-off; the largest are 1 or so */
#define SMALL     1e-3  /* entries that are left out where S is approximate all the same, in parts of the largest of their row */

PetscErrorCode ContactStepperDestroyAssembly(StepperAssembly *assembly)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < assembly->n_bodies; b++) {
    StepperEntries *entries = &assembly->of_body[b];

    PetscCall(PetscFree4(entries->rows, entries->places, entries->begin, entries->product));
    PetscCall(PetscFree4(entries->columns, entries->dofs, entries->values, entries->answers));
    PetscCall(PetscFree(entries->block));
    PetscCall(PetscFree(entries->own));
    PetscCall(StepperSecantsDestroy(&entries->secants));
    PetscCall(StepperSecantsDestroy(&entries->kept));
    PetscCall(VecDestroy(&entries->force));
    PetscCall(VecDestroy(&entries->way));
  }
  PetscCall(PetscFree(assembly->of_body));
  PetscCall(PetscFree2(assembly->begin, assembly->next));
  PetscCall(PetscFree4(assembly->columns, assembly->body, assembly->places, assembly->values));
  PetscCall(MatDestroy(&assembly->rows));
  PetscCall(MatDestroy(&assembly->transpose));
  PetscCall(MatDestroy(&assembly->product));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How large an entry of a row is that counts. Rows along an axis have entries of zero along the others, each of which would ask for a
   column of the compliance; `small`: so they have where the axis has turned a little, which secants make up for. */
static PetscReal Least(PetscBool small, PetscInt n, const PetscScalar values[])
{
  PetscReal largest = 0;

  for (PetscInt e = 0; e < n && small; e++) largest = PetscMax(largest, PetscAbsScalar(values[e]));
  return PetscMax(ZERO, SMALL * largest);
}

/* How many entries each of the touching rows of a body has, and room for them */
static PetscErrorCode CountEntries(Contact contact, ContactStepper *stepper, PetscInt b, PetscBool small)
{
  StepperEntries *entries = &stepper->assembly.of_body[b];
  const PetscInt  first = contact->body_rows[b].begin, end = first + contact->body_rows[b].n;
  PetscInt       *begin = entries->begin, total;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(begin, entries->n + 1));
  for (PetscInt k = 0; k < entries->n; k++) {
    const PetscScalar *values;
    PetscReal          least;
    PetscInt           n;

    if (entries->rows[k] < first || entries->rows[k] >= end) continue;
    PetscCall(MatGetRow(contact->interfaces[b], entries->rows[k], &n, NULL, &values));
    least = Least(small, n, values);
    for (PetscInt e = 0; e < n; e++) begin[k + 1] += PetscAbsScalar(values[e]) > least;
    PetscCall(MatRestoreRow(contact->interfaces[b], entries->rows[k], &n, NULL, &values));
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, begin + 1, (PetscMPIInt)entries->n, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)contact)));
  for (PetscInt k = 0; k < entries->n; k++) begin[k + 1] += begin[k];
  total = begin[entries->n];
  if (total <= entries->room) PetscFunctionReturn(PETSC_SUCCESS);
  entries->room = 2 * total;
  PetscCall(PetscFree4(entries->columns, entries->dofs, entries->values, entries->answers));
  PetscCall(PetscMalloc4(entries->room, &entries->columns, entries->room, &entries->dofs, entries->room, &entries->values, entries->room,
                         &entries->answers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brings the entries of the touching rows of a body to all ranks; each rank has those of its rows. small: without those that are small. */
static PetscErrorCode GetEntries(Contact contact, ContactStepper *stepper, PetscInt b, PetscBool small)
{
  StepperEntries *entries = &stepper->assembly.of_body[b];
  const PetscInt  first = contact->body_rows[b].begin, end = first + contact->body_rows[b].n;
  PetscMPIInt     total;

  PetscFunctionBegin;
  PetscCall(CountEntries(contact, stepper, b, small));
  PetscCall(PetscMPIIntCast(entries->begin[entries->n], &total));
  PetscCall(PetscArrayzero(entries->columns, total));
  PetscCall(PetscArrayzero(entries->values, total));
  for (PetscInt k = 0; k < entries->n; k++) {
    const PetscInt     row = entries->rows[k], *columns;
    const PetscScalar *values;
    PetscReal          least;
    PetscInt           n, at = entries->begin[k];

    if (row < first || row >= end) continue;
    PetscCall(MatGetRow(contact->interfaces[b], row, &n, &columns, &values));
    least = Least(small, n, values);
    for (PetscInt e = 0; e < n; e++) {
      if (PetscAbsScalar(values[e]) <= least) continue;
      entries->columns[at]  = columns[e];
      entries->values[at++] = values[e];
    }
    PetscCall(MatRestoreRow(contact->interfaces[b], row, &n, &columns, &values));
  }
  if (contact->ranks.size == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, entries->columns, total, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)contact)));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, entries->values, total, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for the block of a body whose nodes answer to each other, and the displacements that it is of */
static PetscErrorCode BeginBlock(Contact contact, ContactStepper *stepper, PetscInt b)
{
  StepperEntries *entries = &stepper->assembly.of_body[b];
  const PetscInt  n       = entries->n;

  PetscFunctionBegin;
  if (n * n > entries->block_room) {
    entries->block_room = 2 * n * n;
    PetscCall(PetscFree(entries->block));
    PetscCall(PetscFree(entries->own));
    PetscCall(PetscMalloc1(entries->block_room, &entries->block));
    PetscCall(PetscMalloc1(entries->block_room, &entries->own));
  }
  entries->n_dofs = entries->begin[n];
  PetscCall(PetscArraycpy(entries->dofs, entries->columns, entries->n_dofs));
  PetscCall(PetscSortRemoveDupsInt(&entries->n_dofs, entries->dofs));
  for (PetscInt e = 0; e < entries->begin[n]; e++)
    PetscCall(PetscFindInt(entries->columns[e], entries->n_dofs, entries->dofs, &entries->columns[e]));
  entries->corrected = PETSC_FALSE;
  PetscCall(PetscArrayzero(entries->own, n * n));
  PetscCall(BodyNodalComplianceFollows(contact->bodies[b], entries->n_dofs, &entries->follows));
  if (!entries->follows) PetscCall(ContactStepperMakeBlock(contact, stepper, b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B_b W_b B_b^T of a body whose nodes answer to each other: for each row, how the displacements go under a unit force along it */
PetscErrorCode ContactStepperMakeBlock(Contact contact, ContactStepper *stepper, PetscInt b)
{
  StepperEntries    *entries = &stepper->assembly.of_body[b];
  const PetscInt     n = entries->n, count = entries->n_dofs, *dofs = entries->dofs, *columns = entries->columns, *place;
  PetscInt           leading;
  PetscScalar       *moved = entries->answers;
  const PetscScalar *W;

  PetscFunctionBegin;
  PetscCall(BodyGetNodalCompliance(contact->bodies[b], stepper->rules[b]->shape, count, dofs, &place, &leading, &W));
  PetscCall(PetscArrayzero(entries->own, n * n));
  for (PetscInt l = 0; l < n; l++) {
    PetscScalar *column = entries->own + l * n;

    PetscCall(PetscArrayzero(moved, count));
    for (PetscInt f = entries->begin[l]; f < entries->begin[l + 1]; f++) {
      const PetscScalar *answers = W + place[dofs[columns[f]]] * leading;

      for (PetscInt d = 0; d < count; d++) moved[d] += entries->values[f] * answers[place[dofs[d]]];
    }
    for (PetscInt k = 0; k < n; k++)
      for (PetscInt e = entries->begin[k]; e < entries->begin[k + 1]; e++) column[k] += entries->values[e] * moved[columns[e]];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The entries that a body whose nodes answer to the forces on them alone has in R */
static PetscErrorCode ScaleEntries(Contact contact, ContactStepper *stepper, PetscInt b, Vec diagonal)
{
  StepperEntries    *entries = &stepper->assembly.of_body[b];
  const PetscScalar *values;
  PetscInt           begin, end, total;

  PetscFunctionBegin;
  if (!entries->n) PetscFunctionReturn(PETSC_SUCCESS);
  total = entries->begin[entries->n];
  PetscCall(VecGetOwnershipRange(diagonal, &begin, &end));
  PetscCall(VecGetArrayRead(diagonal, &values));
  for (PetscInt e = 0; e < total; e++)
    entries->answers[e] = entries->columns[e] >= begin && entries->columns[e] < end ? values[entries->columns[e] - begin] : 0;
  PetscCall(VecRestoreArrayRead(diagonal, &values));
  if (contact->ranks.size > 1)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, entries->answers, (PetscMPIInt)total, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  for (PetscInt e = 0; e < total; e++) entries->values[e] *= PetscSqrtScalar(entries->answers[e]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for the rows of R, and where each begins; `same`: where they did */
static PetscErrorCode CountRows(const ContactStepper *stepper, StepperAssembly *assembly, PetscBool *same)
{
  const PetscInt n = stepper->problem.n;

  PetscFunctionBegin;
  *same = (PetscBool)(assembly->product && assembly->n == n);
  if (n > assembly->row_room) {
    assembly->row_room = 2 * n;
    PetscCall(PetscFree2(assembly->begin, assembly->next));
    PetscCall(PetscMalloc2(assembly->row_room + 1, &assembly->begin, assembly->row_room + 1, &assembly->next));
  }
  PetscCall(PetscArrayzero(assembly->next, n + 1));
  for (PetscInt b = 0; b < assembly->n_bodies; b++) {
    const StepperEntries *entries = &assembly->of_body[b];

    for (PetscInt k = 0; entries->alone && k < entries->n; k++)
      assembly->next[entries->places[k] + 1] += entries->begin[k + 1] - entries->begin[k];
  }
  for (PetscInt k = 0; k < n; k++) assembly->next[k + 1] += assembly->next[k];
  if (*same) PetscCall(PetscArraycmp(assembly->next, assembly->begin, n + 1, same));
  PetscCall(PetscArraycpy(assembly->begin, assembly->next, n + 1));
  assembly->n = n;
  if (assembly->begin[n] <= assembly->room) PetscFunctionReturn(PETSC_SUCCESS);
  assembly->room = 2 * assembly->begin[n];
  PetscCall(PetscFree4(assembly->columns, assembly->body, assembly->places, assembly->values));
  PetscCall(PetscMalloc4(assembly->room, &assembly->columns, assembly->room, &assembly->body, assembly->room, &assembly->places,
                         assembly->room, &assembly->values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Columns of R are the displacements in which rows have entries, those of one body behind those of another */
static PetscErrorCode NumberColumns(StepperAssembly *assembly, PetscInt *n)
{
  PetscFunctionBegin;
  *n = 0;
  PetscCall(PetscArraycpy(assembly->next, assembly->begin, assembly->n + 1));
  for (PetscInt b = 0; b < assembly->n_bodies; b++) {
    const StepperEntries *entries = &assembly->of_body[b];
    PetscInt              count   = entries->alone && entries->n ? entries->begin[entries->n] : 0;

    if (!count) continue;
    PetscCall(PetscArraycpy(entries->dofs, entries->columns, count));
    PetscCall(PetscSortRemoveDupsInt(&count, entries->dofs));
    for (PetscInt k = 0; k < entries->n; k++)
      for (PetscInt e = entries->begin[k]; e < entries->begin[k + 1]; e++) {
        PetscInt *place = &assembly->places[assembly->next[entries->places[k]]++];

        PetscCall(PetscFindInt(entries->columns[e], count, entries->dofs, place));
        *place += *n;
      }
    *n += count;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MultiplyRows(const ContactStepper *stepper, StepperAssembly *assembly)
{
  PetscBool same;

  PetscFunctionBegin;
  PetscCall(CountRows(stepper, assembly, &same));
  PetscCall(PetscArraycpy(assembly->next, assembly->begin, assembly->n + 1));
  for (PetscInt b = 0; b < assembly->n_bodies; b++) {
    const StepperEntries *entries = &assembly->of_body[b];

    for (PetscInt k = 0; entries->alone && k < entries->n; k++)
      for (PetscInt e = entries->begin[k]; e < entries->begin[k + 1]; e++) {
        const PetscInt at = assembly->next[entries->places[k]]++;

        same                  = (PetscBool)(same && assembly->columns[at] == entries->columns[e] && assembly->body[at] == b);
        assembly->columns[at] = entries->columns[e];
        assembly->body[at]    = b;
        assembly->values[at]  = entries->values[e];
      }
  }
  if (!same) {
    PetscInt columns;

    PetscCall(MatDestroy(&assembly->rows));
    PetscCall(MatDestroy(&assembly->transpose));
    PetscCall(MatDestroy(&assembly->product));
    PetscCall(NumberColumns(assembly, &columns));
    PetscCall(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, assembly->n, columns, assembly->begin, assembly->places, assembly->values,
                                        &assembly->rows));
    PetscCall(MatTranspose(assembly->rows, MAT_INITIAL_MATRIX, &assembly->transpose));
    PetscCall(MatMatMult(assembly->rows, assembly->transpose, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &assembly->product));
  } else {
    PetscCall(PetscObjectStateIncrease((PetscObject)assembly->rows));
    PetscCall(MatTranspose(assembly->rows, MAT_REUSE_MATRIX, &assembly->transpose));
    PetscCall(MatProductNumeric(assembly->product));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddProduct(const StepperAssembly *assembly, PetscScalar S[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < assembly->n; i++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           n;

    PetscCall(MatGetRow(assembly->product, i, &n, &columns, &values));
    for (PetscInt e = 0; e < n; e++) S[columns[e] * assembly->n + i] += values[e];
    PetscCall(MatRestoreRow(assembly->product, i, &n, &columns, &values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether bodies with touching rows answer node by node (true), or have blocks (false) */
static PetscBool AnyBody(const StepperAssembly *assembly, PetscBool alone)
{
  PetscBool any = PETSC_FALSE;

  for (PetscInt b = 0; b < assembly->n_bodies; b++)
    any = (PetscBool)(any || (assembly->of_body[b].n && assembly->of_body[b].alone == alone));
  return any;
}

/* A dense S: the one there is, where it has the size */
static PetscErrorCode AssembleDense(ContactStepper *stepper, Mat *S)
{
  const PetscInt n = stepper->problem.n;
  PetscScalar   *values;
  PetscInt       size = -1;

  PetscFunctionBegin;
  if (!stepper->problem.sparse) PetscCall(MatGetSize(stepper->problem.S, &size, NULL));
  *S = stepper->problem.S;
  if (size == n) PetscCall(PetscObjectReference((PetscObject)*S));
  else PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, n, n, NULL, S));
  PetscCall(MatDenseGetArrayWrite(*S, &values));
  PetscCall(PetscArrayzero(values, n * n));
  if (AnyBody(&stepper->assembly, PETSC_TRUE)) PetscCall(AddProduct(&stepper->assembly, values));
  for (PetscInt b = 0; b < stepper->assembly.n_bodies; b++) {
    const StepperEntries *entries = &stepper->assembly.of_body[b];

    for (PetscInt l = 0; l < entries->n && !entries->alone; l++)
      for (PetscInt k = 0; k < entries->n; k++) values[entries->places[l] * n + entries->places[k]] += entries->block[l * entries->n + k];
  }
  PetscCall(MatDenseRestoreArrayWrite(*S, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of how many entries the blocks of bodies are, in parts of those of S */
static PetscReal BlockPart(const ContactStepper *stepper)
{
  PetscReal sum = 0;

  for (PetscInt b = 0; b < stepper->assembly.n_bodies; b++) {
    const StepperEntries *entries = &stepper->assembly.of_body[b];

    if (!entries->alone) sum += (PetscReal)entries->n * entries->n;
  }
  return sum / ((PetscReal)stepper->problem.n * stepper->problem.n);
}

/* A sparse S that has the blocks of bodies, and R R^T where bodies answer node by node */
static PetscErrorCode AssembleSparse(ContactStepper *stepper, Mat *S)
{
  const PetscInt         n        = stepper->problem.n;
  const StepperAssembly *assembly = &stepper->assembly;
  PetscInt              *counts; /* more than there are: two rows may share both of their bodies */

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(n, &counts));
  for (PetscInt b = 0; b < assembly->n_bodies; b++) {
    const StepperEntries *entries = &assembly->of_body[b];

    for (PetscInt k = 0; k < entries->n && !entries->alone; k++) counts[entries->places[k]] += entries->n;
  }
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, n, n, 0, counts, S));
  PetscCall(PetscFree(counts));
  for (PetscInt b = 0; b < assembly->n_bodies; b++) {
    const StepperEntries *entries = &assembly->of_body[b];

    if (entries->alone || !entries->n) continue;
    PetscCall(MatSetValues(*S, entries->n, entries->places, entries->n, entries->places, entries->block, ADD_VALUES));
  }
  PetscCall(MatAssemblyBegin(*S, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*S, MAT_FINAL_ASSEMBLY));
  if (AnyBody(assembly, PETSC_TRUE)) PetscCall(MatAXPY(*S, 1, assembly->product, DIFFERENT_NONZERO_PATTERN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What S is made of, from the bodies */
static PetscErrorCode GetParts(Contact contact, ContactStepper *stepper)
{
  StepperAssembly *assembly = &stepper->assembly;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool is_explicit, linear;
    Vec       diagonal;

    if (!assembly->of_body[b].n) continue;
    PetscCall(BodyIsExplicit(contact->bodies[b], &is_explicit));
    PetscCall(BodyIsLinear(contact->bodies[b], &linear));
    PetscCall(BodyGetNodalDiagonal(contact->bodies[b], stepper->rules[b]->shape, &diagonal));
    PetscCall(GetEntries(contact, stepper, b, (PetscBool)(is_explicit && !linear && !diagonal)));
    assembly->of_body[b].alone = (PetscBool)(diagonal != NULL);
    if (diagonal) PetscCall(ScaleEntries(contact, stepper, b, diagonal));
    else PetscCall(BeginBlock(contact, stepper, b));
  }
  if (AnyBody(assembly, PETSC_TRUE)) PetscCall(MultiplyRows(stepper, assembly));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S of the rows that touch now, unless it is there. Where it has been corrected alone, bodies need not be asked again. */
PetscErrorCode ContactStepperAssemble(Contact contact, ContactStepper *stepper)
{
  const PetscInt   n        = stepper->problem.n;
  StepperAssembly *assembly = &stepper->assembly;
  PetscBool        same     = (PetscBool)(assembly->of_state == stepper->state && stepper->n_assembled == n);
  Mat              S, near = NULL;

  PetscFunctionBegin;
  if (same) PetscCall(PetscArraycmp(stepper->rows, stepper->of_assembled, n, &same));
  if (same && stepper->assembled == stepper->state) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLogEventBegin(CONTACT_Factor, contact, 0, 0, 0));
  if (!same) PetscCall(ContactStepperListBodyRows(contact, stepper));
  if (!same) PetscCall(ContactStepperChooseProducts(contact, stepper));
  if (!same && !stepper->products) PetscCall(GetParts(contact, stepper));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    if (assembly->of_body[b].n && !assembly->of_body[b].alone) PetscCall(ContactStepperCorrectBlock(contact, stepper, b));
  }
  if (stepper->products) PetscCall(ContactStepperCreateProducts(contact, stepper, &S, &near));
  else if (!AnyBody(assembly, PETSC_FALSE) && n > FEW_ROWS) {
    S = assembly->product;
    if (stepper->penalty.any) PetscCall(MatDuplicate(assembly->product, MAT_COPY_VALUES, &S));
    else PetscCall(PetscObjectReference((PetscObject)S));
  } else if (n > MANY_ROWS && BlockPart(stepper) <= SPARSE) PetscCall(AssembleSparse(stepper, &S));
  else PetscCall(AssembleDense(stepper, &S));
  PetscCall(ContactStepperAddTurns(contact, stepper, S));
  if (!near) PetscCall(ContactStepperAddSprings(stepper, S));
  PetscCall(LawProblemTakeS(&stepper->problem, &S, near ? &near : NULL));
  PetscCall(PetscArraycpy(stepper->of_assembled, stepper->rows, n));
  PetscCall(PetscInfo(contact, "S assembled: %s, %" PetscInt_FMT " rows of %" PetscInt_FMT " nodes\n",
                      stepper->products         ? "as products"
                      : stepper->problem.sparse ? "sparse"
                                                : "dense",
                      n, stepper->problem.n_nodes));
  stepper->n_assembled = n;
  stepper->assembled = assembly->of_state = stepper->state;
  PetscCall(PetscLogEventEnd(CONTACT_Factor, contact, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
