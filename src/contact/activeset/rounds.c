/*
   Rounds of the active set in one controller step: which rows change after each of them, and what ends an alternation that comes back to
   where it has been.

   At first all rows change at once that penetrate without being held, or are held and pulled. Where one end force for each row closes its
   gap at the end of the step, this is a linear complementarity problem, whose matrix S is symmetric and positive definite, and which has
   one solution. All changes at once may miss it and go round in a circle (Curtis, Han, Robinson 2014, section 2, has one with three rows),
   changes of the first row alone do not (Murty 1974). So a set seen twice makes the first row alone change, until fewer rows are wrong than
   ever: then all of them may again (Júdice, Pires 1994).

   A set that comes up again after two rounds is something else. Its rows d that change are pulled when held and penetrate when not: forces
   f and gaps g of both solutions differ by values of opposite sign there, and nowhere else by both, so that (f - f')(g - g') < 0 = (f - f')
   S (f - f') cannot be. It is no such problem: over the substeps of both bodies a row pushes at several times in the step, which its end
   does not tell. Such rows are held to the end of the step, so that nothing penetrates, and let go at the start of the next if they are
   still pulled. The others go on.
*/
#include "rounds.h"
#include <checkpoint/checkpoint.h>

/* Rounds after which no row leaves any more, so that a step with a set seen twice ends with an answer */
#define LAST_ROUNDS (ROUNDS_MAX / 2)

/* For rows of this rank whose state is in these arrays, which stay where they are */
PetscErrorCode RoundsCreate(Contact contact, PetscBool active[], const PetscReal force[], const PetscReal gap[], Rounds *rounds)
{
  PetscFunctionBegin;
  PetscCall(PetscMemzero(rounds, sizeof(*rounds)));
  rounds->contact   = contact;
  rounds->active    = active;
  rounds->force     = force;
  rounds->gap       = gap;
  rounds->tolerance = contact->options.tolerance;
  rounds->recheck   = PETSC_TRUE;
  PetscCall(PetscMalloc1((ROUNDS_MAX + 1) * contact->rows.n, &rounds->tried));
  PetscCall(PetscCalloc1(contact->rows.n, &rounds->kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RoundsDestroy(Rounds *rounds)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(rounds->tried));
  PetscCall(PetscFree(rounds->kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint, between two steps: what the next one begins with */
PetscErrorCode RoundsVisit(Rounds *rounds, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  PetscCall(CheckpointVisitBools(checkpoint, "cycled", 1, &rounds->cycled));
  PetscCall(CheckpointVisitBools(checkpoint, "kept", rounds->contact->rows.n, rounds->kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Call at the start of a controller step */
PetscErrorCode RoundsBegin(Rounds *rounds)
{
  PetscFunctionBegin;
  if (rounds->cycled) PetscCall(PetscArrayzero(rounds->kept, rounds->contact->rows.n));
  rounds->n = rounds->first = 0;
  rounds->cycled = rounds->single = PETSC_FALSE;
  rounds->fewest                  = PETSC_INT_MAX;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Remembers the active set that is about to be solved for; after too many the step has failed */
PetscErrorCode RoundsNext(Rounds *rounds)
{
  const PetscInt n = rounds->contact->rows.n;

  PetscFunctionBegin;
  if (rounds->n >= ROUNDS_MAX) {
    PetscCall(StepFailureSet(&rounds->contact->attempt.failure, STEP_DIVERGED_ACTIVE_SET, PETSC_ERR_NOT_CONVERGED,
                             "The active set of contact nodes has changed %d times in one controller step; choose a smaller -time_step",
                             ROUNDS_MAX));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscArraycpy(rounds->tried + rounds->n * n, rounds->active, n));
  rounds->n++;
  if (!rounds->cycled || rounds->n < LAST_ROUNDS) PetscFunctionReturn(PETSC_SUCCESS);
  rounds->single = PETSC_FALSE;
  for (PetscInt i = 0; i < n; i++) rounds->kept[i] = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The active set of the last round, NULL before the first */
static const PetscBool *RoundsLast(const Rounds *rounds)
{
  return rounds->n ? rounds->tried + (rounds->n - 1) * rounds->contact->rows.n : NULL;
}

/* Whether the active set is another than that of the last round; collective */
PetscErrorCode RoundsHaveChanged(const Rounds *rounds, PetscBool *changed)
{
  const PetscBool *last    = RoundsLast(rounds);
  int              differs = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < rounds->contact->rows.n; i++) differs |= rounds->active[i] != last[i];
  PetscCall(ContactOr(rounds->contact, &differs));
  *changed = (PetscBool)(differs > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a row penetrates without being active, or is active and pulled */
static PetscBool RowIsWrong(const Rounds *rounds, PetscInt i)
{
  if (rounds->active[i]) return (PetscBool)(rounds->recheck && rounds->force[i] < 0 && !rounds->contact->rows.tied[i] && !rounds->kept[i]);
  return (PetscBool)(rounds->gap[i] < -rounds->tolerance && (!rounds->known || rounds->known[i]));
}

/* The first of all ranks' rows that are wrong, by its number on this rank, or -1; and whether all rows may change at once again */
static PetscErrorCode FindFirstWrong(Rounds *rounds, PetscInt *which)
{
  const Contact contact = rounds->contact;
  PetscInt      count = 0, first = PETSC_INT_MAX;

  PetscFunctionBegin;
  for (PetscInt i = contact->rows.n - 1; i >= 0; i--) {
    if (!RowIsWrong(rounds, i)) continue;
    first = contact->rows.begin + i;
    count++;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)contact)));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPIU_INT, MPI_MIN, PetscObjectComm((PetscObject)contact)));
  *which = first >= contact->rows.begin && first < contact->rows.begin + contact->rows.n ? first - contact->rows.begin : -1;
  if (count >= rounds->fewest) PetscFunctionReturn(PETSC_SUCCESS);
  rounds->single = (PetscBool)(rounds->fewest == PETSC_INT_MAX); /* the first count is what others are compared with */
  rounds->fewest = count;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that penetrate join, rows that are pulled leave, or the first of them alone */
PetscErrorCode RoundsChange(Rounds *rounds)
{
  PetscInt first = -1;

  PetscFunctionBegin;
  if (rounds->single) PetscCall(FindFirstWrong(rounds, &first));
  for (PetscInt i = 0; i < rounds->contact->rows.n; i++)
    if (rounds->single ? i == first : RowIsWrong(rounds, i)) rounds->active[i] = (PetscBool)!rounds->active[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many rounds ago the active set was solved for in this step, under the present rule; 0: never */
static PetscErrorCode FindActiveSet(const Rounds *rounds, PetscInt *ago)
{
  const PetscInt n = rounds->contact->rows.n;

  PetscFunctionBegin;
  *ago = 0;
  for (PetscInt k = rounds->n - 1; k >= rounds->first && !*ago; k--) {
    int differs = 0;

    for (PetscInt i = 0; i < n; i++) differs |= rounds->tried[k * n + i] != rounds->active[i];
    PetscCall(ContactOr(rounds->contact, &differs));
    if (!differs) *ago = rounds->n - k;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Compares the active set, which has changed, with those of the rounds before, and turns to another rule if it is one of them. `flips`: it
   is that of the last round but one; then rows that differ between both are kept. */
PetscErrorCode RoundsBreakCycle(Rounds *rounds, PetscBool *flips)
{
  const PetscBool *last = RoundsLast(rounds);
  PetscInt         ago;

  PetscFunctionBegin;
  PetscCall(FindActiveSet(rounds, &ago));
  *flips = (PetscBool)(ago == 2);
  if (!ago) PetscFunctionReturn(PETSC_SUCCESS);
  if (!rounds->cycled) rounds->contact->counts.set_cycles++;
  rounds->cycled = PETSC_TRUE;
  rounds->first  = rounds->n;
  if (!*flips && !rounds->single) {
    rounds->single = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt i = 0; i < rounds->contact->rows.n; i++)
    if (rounds->active[i] != last[i]) rounds->active[i] = rounds->kept[i] = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
