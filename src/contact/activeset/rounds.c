/*
   Rounds of the active set in one controller step: which rows change after each of them, and what ends an alternation that comes back to
   where it has been.

   All rows change at once that penetrate without being held, or are held and pulled. Where one end force for each row closes its gap at the
   end of the step, this is a linear complementarity problem, whose matrix S is symmetric and positive definite, and which has one solution,
   though all changes at once may miss it and go round in a circle (Curtis, Han, Robinson 2014, section 2, has one with three rows).

   A set that comes up again after two rounds is something else. Its rows d that change are pulled when held and penetrate when not: forces
   f and gaps g of both solutions differ by values of opposite sign there, and nowhere else by both, so that (f - f')(g - g') < 0 = (f - f')
   S (f - f') cannot be. It is no such problem: over the substeps of both bodies a row pushes at several times in the step, which its end
   does not tell.

   Rows by which a set that comes up again differs from the last one are held to the end of the step, so that nothing penetrates, and let go
   at the start of the next if they are still pulled. The others go on.
*/
#include "rounds.h"

PetscErrorCode RoundsCreate(Contact contact, Rounds *rounds)
{
  PetscFunctionBegin;
  *rounds = (Rounds){.contact = contact, .recheck = PETSC_TRUE};
  PetscCall(PetscMalloc1((ROUNDS_MAX + 1) * contact->rows.n, &rounds->tried));
  PetscCall(PetscMalloc1(contact->rows.n, &rounds->kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RoundsDestroy(Rounds *rounds)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(rounds->tried));
  PetscCall(PetscFree(rounds->kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Call at the start of a controller step */
PetscErrorCode RoundsBegin(Rounds *rounds)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(rounds->kept, rounds->contact->rows.n));
  rounds->n = rounds->first = 0;
  rounds->cycled            = PETSC_FALSE;
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
  PetscCall(PetscArraycpy(rounds->tried + rounds->n * n, rounds->contact->end.active, n));
  rounds->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many rounds ago the active set was solved for in this step, since a cycle has been ended; 0: never. Collective. */
static PetscErrorCode FindActiveSet(const Rounds *rounds, PetscInt *ago)
{
  const PetscInt n = rounds->contact->rows.n;

  PetscFunctionBegin;
  *ago = 0;
  for (PetscInt k = rounds->n - 1; k >= rounds->first && !*ago; k--) {
    int differs = 0;

    for (PetscInt i = 0; i < n; i++) differs |= rounds->tried[k * n + i] != rounds->contact->end.active[i];
    PetscCall(ContactOr(rounds->contact, &differs));
    if (!differs) *ago = rounds->n - k;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that penetrate join, rows that are pulled leave; whether there are any. Collective. */
PetscErrorCode RoundsChange(Rounds *rounds, PetscBool *changed)
{
  const Contact contact = rounds->contact;
  int           any     = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    PetscBool *active = &contact->end.active[i], wrong;

    if (*active) wrong = (PetscBool)(rounds->recheck && contact->end.force[i] < 0 && !contact->rows.tied[i] && !rounds->kept[i]);
    else wrong = (PetscBool)(contact->end.gap[i] < -contact->options.tolerance && (!rounds->known || rounds->known[i]));
    if (!wrong) continue;
    *active = (PetscBool) !*active;
    any     = 1;
  }
  PetscCall(ContactOr(contact, &any));
  *changed = (PetscBool)(any > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Compares the active set, which has changed, with those of the rounds before, and keeps rows where it is one of them. `flips`: it is that
   of the last round but one. Collective. */
PetscErrorCode RoundsBreakCycle(Rounds *rounds, PetscBool *flips)
{
  const PetscInt n      = rounds->contact->rows.n;
  PetscBool     *active = rounds->contact->end.active;
  PetscInt       ago;

  PetscFunctionBegin;
  PetscCall(FindActiveSet(rounds, &ago));
  *flips = (PetscBool)(ago == 2);
  if (!ago) PetscFunctionReturn(PETSC_SUCCESS);
  if (!rounds->cycled) rounds->contact->counts.set_cycles++;
  rounds->cycled = PETSC_TRUE;
  rounds->first  = rounds->n;
  for (PetscInt i = 0; i < n; i++)
    if (active[i] != rounds->tried[(rounds->n - 1) * n + i]) active[i] = rounds->kept[i] = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
