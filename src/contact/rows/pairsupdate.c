/* Pairs whose rows are built again, and those whose rows follow. */
#include <contact/parts.h>
#include <sys/stages.h>

/* Rows stay while the partner slips [parts of a face] and the normal turns [rad] by less, or bars would buckle from round-off. */
#define STILL 1e-6
/* The same between two linear bodies, whose displacements are small: with rows of the undeformed state pressures agree with closed forms to
   1e-8, and energy is kept to 1e-6. Linear bodies that turn do not keep angular momentum themselves. */
#define STILL_LINEAR 0.05

/* Rows of two bodies with inertia follow their surfaces, so that neither angular momentum nor energy is lost as they slide and turn. Rows
   of static bodies are built anew at the place where they are, and merged rows are means of several. */
static PetscErrorCode FollowPair(Contact contact, const ContactPair *pair, PetscBool *any)
{
  const PetscReal near    = ContactPairReach(contact, pair);
  PetscBool      *touches = contact->work.flags, linear = PETSC_TRUE; /* of each node, which has several rows with friction */

  PetscFunctionBegin;
  *any = PETSC_FALSE;
  if (pair->obstacle || pair->rests || contact->held.merger) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt side = 0; side < 2; side++) linear = (PetscBool)(linear && BodyDoes(contact->bodies[pair->body[side]], BodyIsLinear));
  for (PetscInt i = pair->begin; i < pair->end; i += pair->components)
    touches[(i - pair->begin) / pair->components] = contact->start.active[i];
  PetscCall(TransferFollow(pair->transfer, touches, near, linear ? STILL_LINEAR : STILL, (PetscBool)!linear,
                           (PetscBool)(contact->ahead[pair->body[0]] != 0), contact->step,
                           contact->attempt.whole_step / PetscPowRealInt(2, contact->attempt.accepted_level), any));
  if (contact->turns.n) PetscCall(TransferBalance(pair->transfer, contact->start.force + pair->begin, near, any));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Motion of all pairs' surfaces since rows were built, which touch or had a force, and which may close now; the same on all ranks */
static PetscErrorCode MeasureMotion(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair  = &contact->pairs[p];
    PetscReal         *least = contact->work.motion + CONTACT_MOTION * p;

    PetscCall(PetscArrayzero(least, CONTACT_MOTION));
    if (pair->bonded) continue;
    PetscCall(TransferMeasureMotion(pair->transfer, ContactPairReach(contact, pair), least));
    least[MOTION_TOUCHES] = ContactHasTouched(contact, pair) ? -1 : 0;
    for (PetscInt i = pair->begin; i < pair->end && !pair->obstacle && least[MOTION_TOUCHES] == 0; i += pair->components) {
      if (contact->start.active[i]) least[MOTION_TOUCHES] = -1;
      if (contact->rows.opposite[i] && contact->start.gap[i] <= ContactRowReach(contact, pair, contact->rows.normal + 3 * i))
        least[MOTION_CLOSES] = -1;
    }
  }
  PetscCall(ContactReduce(contact, CONTACT_MOTION * contact->n_pairs, MPIU_REAL, MPIU_MIN, contact->work.motion));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Builds the rows of a pair again, or lets them follow its surfaces, where that is needed. Rows of surfaces that may touch in this step for
   the first time are built where the surfaces are now: what happens then does not depend on when they were built before. */
static PetscErrorCode RenewPair(Contact contact, PetscInt p, int *updated)
{
  const PetscReal   *least    = contact->work.motion + CONTACT_MOTION * p;
  const ContactPair *pair     = &contact->pairs[p];
  const PetscBool    anew     = (PetscBool)(pair->ahead || (least[MOTION_TOUCHES] == 0 && least[MOTION_CLOSES] < 0));
  const PetscReal    near     = ContactPairReach(contact, pair);
  const PetscInt     sides    = pair->obstacle ? 1 : 2;
  PetscBool          followed = PETSC_FALSE, rebuilt, logged;
  Vec                u[2] = {NULL, NULL}, at[2] = {NULL, NULL};

  PetscFunctionBegin;
  *updated = ROWS_STAY;
  if (pair->bonded) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(StageBegin(STAGE_SEARCH, &logged));
  PetscCall(TransferIsStale(pair->transfer, near, anew, least, &rebuilt));
  for (PetscInt side = 0; side < sides && rebuilt; side++) {
    PetscCall(ContactGetRowPlace(contact, pair->body[side], &u[side]));
    at[side] = pair->ahead ? contact->ends[pair->body[side]] : u[side];
    if (pair->ahead) PetscCall(SurfaceUpdate(pair->surfaces[side], at[side]));
  }
  if (rebuilt) PetscCall(TransferRenew(pair->transfer, at[0], at[1], near, anew));
  for (PetscInt side = 0; side < sides && rebuilt && pair->ahead; side++) /* other pairs may have these surfaces too */
    PetscCall(SurfaceUpdate(pair->surfaces[side], u[side]));
  PetscCall(StageEnd(logged));
  PetscCall(FollowPair(contact, pair, &followed));
  *updated = rebuilt ? ROWS_REBUILT : followed ? ROWS_FOLLOWED : ROWS_STAY;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Builds rows of pairs that have slid or turned far enough again, lets those near contact follow: what became of each, on all ranks */
PetscErrorCode ContactUpdatePairs(Contact contact)
{
  int      *updated = contact->work.updated;
  PetscBool logged;

  PetscFunctionBegin;
  PetscCall(StageBegin(STAGE_SEARCH, &logged));
  PetscCall(MeasureMotion(contact));
  PetscCall(StageEnd(logged));
  /* those of several ranks first, which wait for each other there, and would for what each has to do by itself */
  for (PetscInt pass = 0; pass < 2; pass++)
    for (PetscInt p = 0; p < contact->n_pairs; p++)
      if (contact->pairs[p].owned == (PetscBool)pass) PetscCall(RenewPair(contact, p, &updated[p]));
  /* of its own rows, and of a pair that it has to itself, each rank alone knows */
  PetscCall(ContactReduce(contact, contact->n_pairs, MPI_INT, MPI_MAX, updated));
  PetscFunctionReturn(PETSC_SUCCESS);
}
