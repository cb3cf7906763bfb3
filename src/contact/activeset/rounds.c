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
#include <contact/impls/schwarz/schwarzimpl.h>

/* Rounds after which no row leaves any more, so that a step with a set seen twice ends with an answer */
#define LAST_ROUNDS (SCHWARZ_MAX_ROUNDS / 2)

/* Call at the start of a controller step */
PetscErrorCode SchwarzBeginRounds(Contact contact)
{
  Rounds *rounds = &((Schwarz *)contact->data)->rounds;

  PetscFunctionBegin;
  if (rounds->cycled) PetscCall(PetscArrayzero(rounds->kept, contact->n_rows));
  if (contact->fades) PetscCall(PetscArrayzero(contact->release_intervals, contact->n_rows));
  rounds->n = rounds->first = 0;
  rounds->cycled = rounds->single = PETSC_FALSE;
  rounds->fewest                  = PETSC_INT_MAX;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Remembers the active set that is about to be solved for */
PetscErrorCode SchwarzBeginRound(Contact contact)
{
  Rounds *rounds = &((Schwarz *)contact->data)->rounds;

  PetscFunctionBegin;
  PetscCheck(rounds->n < SCHWARZ_MAX_ROUNDS, PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED,
             "The active set of contact nodes has changed %d times in one controller step; choose a smaller -time_step",
             SCHWARZ_MAX_ROUNDS);
  PetscCall(PetscArraycpy(rounds->tried + rounds->n++ * contact->n_rows, contact->active, contact->n_rows));
  if (!rounds->cycled || rounds->n < LAST_ROUNDS) PetscFunctionReturn(PETSC_SUCCESS);
  rounds->single = PETSC_FALSE;
  for (PetscInt i = 0; i < contact->n_rows; i++) rounds->kept[i] = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a row penetrates or is pulled. While sweeps run on the compliance, the gaps of rows that it does not know are not there yet. */
static PetscBool RowIsWrong(Contact contact, PetscInt i)
{
  const Schwarz *schwarz = (const Schwarz *)contact->data;

  if (contact->active[i]) return (PetscBool)(schwarz->recheck && contact->force[i] < 0 && !contact->tied[i] && !schwarz->rounds.kept[i]);
  return (PetscBool)(contact->gap[i] < -contact->tolerance && (schwarz->step != STEP_CONDENSED || schwarz->known[i]));
}

/* The first of all ranks' rows that are wrong, by its number on this rank, or -1; and whether all rows may change at once again */
static PetscErrorCode FindFirstWrong(Contact contact, PetscInt *which)
{
  Rounds  *rounds = &((Schwarz *)contact->data)->rounds;
  PetscInt count = 0, first = PETSC_INT_MAX;

  PetscFunctionBegin;
  for (PetscInt i = contact->n_rows - 1; i >= 0; i--) {
    if (!RowIsWrong(contact, i)) continue;
    first = contact->row_begin + i;
    count++;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)contact)));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPIU_INT, MPI_MIN, PetscObjectComm((PetscObject)contact)));
  *which = first >= contact->row_begin && first < contact->row_begin + contact->n_rows ? first - contact->row_begin : -1;
  if (count >= rounds->fewest) PetscFunctionReturn(PETSC_SUCCESS);
  rounds->single = (PetscBool)(rounds->fewest == PETSC_INT_MAX); /* the first count is what others are compared with */
  rounds->fewest = count;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A row leaves with the force that holds it until it is pulled, where that is told in the course of the step; else with one that falls
   linearly until its end. To go on with that while the row opens would be work out of nothing: with ten discs 1.4e-3 of the energy at a
   step of 4e-4 s. */
static PetscErrorCode NoteRelease(Contact contact, PetscInt i)
{
  Schwarz           *schwarz  = (Schwarz *)contact->data;
  const ContactPair *pair     = &contact->pairs[contact->row_pair[i]];
  const Trace        reaction = contact->traces[DirichletBody(pair)].reaction;
  PetscReal         *force    = contact->release + i * contact->release_room;
  PetscInt           n        = 1, partner;

  PetscFunctionBegin;
  PetscCall(TraceGetSizes(contact->traces[NeumannBody(pair)].displacement, NULL, &partner));
  if (pair->by_force ? partner > 1 : schwarz->levels[contact->row_pair[i]] > 1) PetscCall(TraceGetSizes(reaction, NULL, &n));
  force[0]                      = contact->saved_active[i] ? PetscMax(contact->saved_force[i], 0) : 0;
  force[n]                      = 0;
  contact->release_intervals[i] = force[0] > 0 ? n : 0;
  for (PetscInt k = 1; k < n; k++) {
    PetscScalar *values;

    PetscCall(TraceGetLevel(reaction, k, &values));
    force[k] = k > 1 && force[k - 1] == 0 ? 0 : PetscMax(-NeumannSign(pair) * values[i], 0);
    if (force[k] > 0) contact->release_intervals[i] = n;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the active set is another than that of the last round, after rows of shared nodes have been put in order, of which some may be
   let go again; notes the forces of rows that leave */
PetscErrorCode SchwarzTakeActiveSet(Contact contact, PetscBool *changed)
{
  const Rounds    *rounds = &((Schwarz *)contact->data)->rounds;
  const PetscBool *before = rounds->n ? rounds->tried + (rounds->n - 1) * contact->n_rows : NULL;
  int              any    = 0;

  PetscFunctionBegin;
  ContactArrangeShared(contact);
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    const PetscBool was = (PetscBool)(before && before[i]);

    if (contact->active[i] == was) continue;
    if (was && contact->fades) PetscCall(NoteRelease(contact, i));
    any = 1;
  }
  PetscCall(ContactOr(contact, &any));
  *changed = (PetscBool)(any > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that penetrate join, rows that are pulled leave, or the first of them alone */
PetscErrorCode SchwarzUpdateActiveSet(Contact contact, PetscBool *changed)
{
  const Rounds *rounds = &((Schwarz *)contact->data)->rounds;
  PetscInt      first  = -1;

  PetscFunctionBegin;
  if (rounds->single) PetscCall(FindFirstWrong(contact, &first));
  for (PetscInt i = 0; i < contact->n_rows; i++)
    if (rounds->single ? i == first : RowIsWrong(contact, i)) contact->active[i] = (PetscBool)!contact->active[i];
  PetscCall(SchwarzTakeActiveSet(contact, changed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many rounds ago the active set was solved for in this step, under the present rule; 0: never */
static PetscErrorCode FindActiveSet(Contact contact, PetscInt *ago)
{
  const Rounds *rounds = &((Schwarz *)contact->data)->rounds;

  PetscFunctionBegin;
  *ago = 0;
  for (PetscInt k = rounds->n - 1; k >= rounds->first && !*ago; k--) {
    int differs = 0;

    for (PetscInt i = 0; i < contact->n_rows; i++) differs |= rounds->tried[k * contact->n_rows + i] != contact->active[i];
    PetscCall(ContactOr(contact, &differs));
    if (!differs) *ago = rounds->n - k;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Compares the active set, which has changed, with those of the rounds before, and turns to another rule if it is one of them. `flips`: it
   is that of the last round but one. */
PetscErrorCode SchwarzBreakCycle(Contact contact, PetscBool *flips)
{
  Rounds          *rounds = &((Schwarz *)contact->data)->rounds;
  const PetscBool *last   = rounds->tried + (rounds->n - 1) * contact->n_rows;
  PetscInt         ago;

  PetscFunctionBegin;
  PetscCall(FindActiveSet(contact, &ago));
  *flips = (PetscBool)(ago == 2);
  if (!ago) PetscFunctionReturn(PETSC_SUCCESS);
  if (!rounds->cycled) contact->counts_made.set_cycles++;
  rounds->cycled = PETSC_TRUE;
  rounds->first  = rounds->n;
  if (!*flips && !rounds->single) {
    rounds->single = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt i = 0; i < contact->n_rows; i++)
    if (contact->active[i] != last[i]) contact->active[i] = rounds->kept[i] = PETSC_TRUE;
  ContactArrangeShared(contact);
  PetscFunctionReturn(PETSC_SUCCESS);
}
