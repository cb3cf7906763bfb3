/* What the folders of src/contact have of each other. Implementations of methods by others need <impakt/private/contactimpl.h> alone. */
#pragma once
#include <checkpoint/statelist.h>
#include <impakt/private/box.h>
#include <impakt/private/contactimpl.h>

#define ContactCheckNotSetUp(contact)                                                                                                      \
  PetscCheck(!(contact)->setup, PetscObjectComm((PetscObject)(contact)), PETSC_ERR_ARG_WRONGSTATE, "Call %s() before ContactSetUp()",      \
             PETSC_FUNCTION_NAME)
#define ContactCheckPair(contact, pair)                                                                                                    \
  PetscCheck((pair) >= 0 && (pair) < ((contact)->neighbours.come_and_go ? (contact)->neighbours.told.n : (contact)->n_pairs),              \
             PetscObjectComm((PetscObject)(contact)), PETSC_ERR_ARG_OUTOFRANGE,                                                            \
             "There is no pair %" PetscInt_FMT "; there are %" PetscInt_FMT, pair, (contact)->n_pairs)

/* What decides which of two bodies takes displacements */
typedef struct ContactPreference {
  PetscBool is_rigid, is_explicit;
  PetscInt  substeps; /* of explicit bodies, about */
  PetscReal size;     /* edge of its mean element, or of the largest that is alike [m] */
} ContactPreference;

/* What is kept of a pair from step to step: its impulse and the force at the end of the last step, 3 numbers each, and the same of the
   normal forces, one number each; the impulse of nodes beyond the end of the partner */
#define CONTACT_IMPULSES 9

/* Length of the texts of ContactDescribeMoves() */
#define CONTACT_MOVES 256

/* A pair that outputs are told of */
static inline const ContactPair *ContactToldPair(Contact contact, PetscInt pair)
{
  return contact->neighbours.come_and_go ? &contact->neighbours.told.pairs[pair] : &contact->pairs[pair];
}

/* Groups of bodies, each named by its first one. While groups are joined, `of` leads to that by way of others. */
static inline PetscInt ContactGroupOf(const PetscInt of[], PetscInt b)
{
  while (of[b] != b) b = of[b];
  return b;
}

static inline void ContactJoinGroups(PetscInt of[], PetscInt a, PetscInt b)
{
  const PetscInt first = ContactGroupOf(of, a), second = ContactGroupOf(of, b);

  of[PetscMax(first, second)] = PetscMin(first, second);
}

/* By how many rows those of a pair follow each other that have a gap: rows across the normal, with friction, have none */
static inline PetscInt ContactGapStride(const ContactPair *pair)
{
  return pair->law == CONTACT_LAW_FRICTION ? pair->components : 1;
}

/* The number of the second body of a pair, or the number of bodies and that of the obstacle */
static inline PetscInt ContactPairPartner(Contact contact, const ContactPair *pair)
{
  PetscInt o = 0;

  if (!pair->obstacle) return pair->body[1];
  while (contact->obstacles[o] != pair->obstacle) o++;
  return contact->n_bodies + o;
}

/* A number for a pair that comes and goes; pairs are in the order of these. `second`: of a body, or as ContactPairPartner() tells */
static inline PetscInt ContactNumberPair(Contact contact, PetscInt first, PetscInt second)
{
  return first * (contact->n_bodies + contact->n_obstacles) + second;
}

/* What a body says of itself, without an error: by BodyIsStatic(), BodyIsRigid(), BodyIsLinear(), ... */
static inline PetscBool BodyDoes(Body body, PetscErrorCode (*say)(Body, PetscBool *))
{
  PetscBool does = PETSC_FALSE;

  PetscCallAbort(PETSC_COMM_SELF, (*say)(body, &does));
  return does;
}

PETSC_INTERN PetscErrorCode    ContactWarnOfStages(Contact, PetscBool);
PETSC_INTERN PetscErrorCode    ContactGetStage(Body, PetscReal[2]);
PETSC_INTERN PetscErrorCode    ContactGetTransit(Body, PetscReal, PetscReal *, PetscReal *);
PETSC_INTERN PetscFunctionList ContactList;

PETSC_INTERN PetscErrorCode ContactGetTime(Contact, PetscReal *);
PETSC_INTERN PetscErrorCode ContactSetUpScales(Contact);
PETSC_INTERN PetscErrorCode ContactCheckObstacleName(Contact, const char[]);
PETSC_INTERN PetscErrorCode ContactRefuseInside(Contact, const ContactPair *, PetscReal);
PETSC_INTERN PetscErrorCode ContactRefuseTurned(Contact, const ContactPair *);
PETSC_INTERN PetscErrorCode ContactWarnOfObstacles(Contact);
PETSC_INTERN PetscErrorCode ContactFindDimension(Contact);
PETSC_INTERN PetscErrorCode ContactAddAllPairs(Contact);
PETSC_INTERN PetscErrorCode ContactAddEachPair(Contact);
PETSC_INTERN PetscErrorCode ContactChooseAllPairs(Contact);
PETSC_INTERN PetscErrorCode ContactAppendNeighbours(Contact, PetscInt, ContactPair **);
PETSC_INTERN PetscErrorCode ContactDestroyPair(ContactPair *);
PETSC_INTERN PetscErrorCode ContactSuitsNeighbours(Contact, PetscBool *);
PETSC_INTERN PetscErrorCode ContactSetUpNeighbours(Contact);
PETSC_INTERN PetscErrorCode ContactFindNeighbours(Contact, PetscReal, PetscInt *);
PETSC_INTERN PetscErrorCode ContactNoteNeighbours(Contact, PetscInt, const PetscInt[]);
PETSC_INTERN PetscErrorCode ContactDestroyNeighbours(Contact);
PETSC_INTERN PetscErrorCode ContactLayOutRows(Contact);
PETSC_INTERN PetscErrorCode ContactReplacePairs(Contact, PetscInt, const PetscInt[]);
PETSC_INTERN PetscErrorCode ContactRenewNeighbours(Contact, PetscReal, PetscBool, PetscBool *);
PETSC_INTERN void           ContactListRowState(Contact, StateList *);
PETSC_INTERN PetscErrorCode ContactVisitPairNodes(const ContactPair *, const StateList *, const char[], Tables);
PETSC_INTERN PetscErrorCode ContactSetUpTold(Contact);
PETSC_INTERN void           ContactTell(Contact, const ContactPair *, const ContactPairState *, ContactPairState[]);
PETSC_INTERN PetscErrorCode ContactComputePairStates(Contact, ContactPairState[]);
PETSC_INTERN void           ContactAddPairState(ContactPairState *, PetscInt, const ContactPairState *);
PETSC_INTERN PetscErrorCode ContactSetUpPairResultants(Contact);
PETSC_INTERN PetscErrorCode ContactSetUpRowEnergy(Contact);
PETSC_INTERN PetscErrorCode ContactTakeFirstNeighbours(Contact, PetscReal *);
PETSC_INTERN PetscErrorCode ContactGetPreferences(Contact, const ContactPreference *[]);
PETSC_INTERN PetscBool      ContactChooseSides(const ContactPreference *, const ContactPreference *, const char **);
PETSC_INTERN PetscErrorCode ContactOrderBodies(Contact);
PETSC_INTERN PetscErrorCode ContactDestroyPairs(Contact);
PETSC_INTERN void           ContactFindSets(Contact, PetscInt[]);
PETSC_INTERN PetscErrorCode ContactTakeSurfaces(Contact, PetscReal *);
PETSC_INTERN PetscErrorCode ContactSetUpRows(Contact, PetscReal);
PETSC_INTERN PetscErrorCode ContactCheckNear(Contact);
PETSC_INTERN PetscErrorCode ContactSetUpObstacleTraces(Contact);
PETSC_INTERN PetscErrorCode ContactReadStartGaps(Contact, PetscBool);
PETSC_INTERN PetscErrorCode ContactGetLeastElement(Contact, const PetscInt[2], PetscReal *);
PETSC_INTERN PetscErrorCode ContactLetTouch(Contact, PetscBool);
PETSC_INTERN PetscErrorCode ContactGetBoundary(Contact, PetscInt, Surface *);
PETSC_INTERN PetscErrorCode ContactStartOverlaps(Contact, PetscBool);
PETSC_INTERN PetscErrorCode ContactCreateFacing(Contact, const ContactPair *, Surface[2]);
PETSC_INTERN PetscErrorCode ContactMarkNearNodes(Contact, const ContactPair *, PetscInt);
PETSC_INTERN PetscErrorCode ContactDescribeMoves(Contact, PetscInt, char[CONTACT_MOVES], char[CONTACT_MOVES]);
PETSC_INTERN PetscErrorCode ContactDestroyOverlaps(Contact);
PETSC_INTERN PetscErrorCode ContactCheckAxisymmetric(Contact, const ContactPair *);
PETSC_INTERN PetscErrorCode ContactChooseBalance(Contact);
PETSC_INTERN PetscErrorCode ContactCheckBalance(Contact, const ContactPair *);
PETSC_INTERN PetscErrorCode ContactSetUpTurns(Contact);
PETSC_INTERN PetscErrorCode ContactDestroyTurns(Contact);
PETSC_INTERN PetscErrorCode ContactTurn(Contact, const PetscReal[]);
PETSC_INTERN PetscErrorCode ContactAcceptTurns(Contact);
PETSC_INTERN PetscErrorCode ContactCheckTies(Contact);
PETSC_INTERN PetscErrorCode ContactMeasureTies(Contact, const ContactPair *, PetscBool *);
PETSC_INTERN PetscErrorCode ContactTie(Contact);
PETSC_INTERN void           ContactGetDirection(Contact, const ContactPair *, const TransferRows *, PetscInt, PetscReal[3]);
PETSC_INTERN const char    *ContactNameLaw(Contact, const ContactPair *);
PETSC_INTERN PetscErrorCode ContactReadLaw(Contact, PetscInt);
PETSC_INTERN PetscErrorCode ContactReadLawParameters(Contact);
PETSC_INTERN PetscErrorCode ContactViewLawParameters(Contact, PetscViewer);
PETSC_INTERN PetscErrorCode ContactCreateLaws(Contact);
PETSC_INTERN PetscErrorCode ContactCheckLaws(Contact);
PETSC_INTERN PetscErrorCode ContactBond(Contact);
PETSC_INTERN void           ContactHoldTogether(Contact);
PETSC_INTERN PetscErrorCode ContactChooseTiedMass(Contact);
PETSC_INTERN PetscErrorCode ContactSetUpTiedEnds(Contact);
PETSC_INTERN PetscErrorCode ContactDestroyTiedEnds(Contact);
PETSC_INTERN PetscErrorCode ContactStartTies(Contact);
PETSC_INTERN PetscErrorCode ContactSetMeanForces(Contact);
PETSC_INTERN PetscErrorCode ContactBalanceStart(Contact);
PETSC_INTERN PetscErrorCode ContactMoveSurfaces(Contact);
PETSC_INTERN PetscErrorCode ContactGetRowPlace(Contact, PetscInt, Vec *);
PETSC_INTERN void           ContactForgetAhead(Contact);
PETSC_INTERN PetscErrorCode ContactLayAhead(Contact, PetscInt, PetscReal *, PetscBool *);
PETSC_INTERN PetscErrorCode ContactCreateSurfaces(Contact, ContactPair *, PetscReal *);
PETSC_INTERN PetscErrorCode ContactChooseRowSide(Contact, ContactPair *);
PETSC_INTERN PetscBool      ContactHasRigid(Contact);
PETSC_INTERN PetscErrorCode ContactCreateSurface(Contact, PetscInt, const char[], Surface *);
PETSC_INTERN PetscErrorCode ContactCreateTransfer(Contact, ContactPair *);
PETSC_INTERN PetscErrorCode ContactNumberBodyRows(Contact);
PETSC_INTERN PetscErrorCode ContactDestroyBodyRows(Contact);
PETSC_INTERN PetscErrorCode ContactOrderVisits(Contact);
PETSC_INTERN PetscErrorCode ContactReduce(Contact, PetscInt, MPI_Datatype, MPI_Op, void *);
PETSC_INTERN PetscErrorCode ContactShareRows(Contact);
PETSC_INTERN PetscErrorCode ContactGatherRows(Contact, MPI_Datatype, const void *, void *);
PETSC_INTERN void           ContactPickRows(Contact, PetscInt, const PetscInt[], const PetscScalar[], PetscReal[]);
PETSC_INTERN PetscErrorCode ContactIsAtHome(Contact, PetscInt, PetscMPIInt *, PetscBool *);
PETSC_INTERN void           ContactAffectAll(Contact);
PETSC_INTERN void           ContactForgetMatrices(Contact);
PETSC_INTERN void           ContactTakeRows(Contact, PetscInt, const PetscReal[], PetscReal[]);
PETSC_INTERN void           ContactAddRows(Contact, PetscInt, const PetscReal[], PetscReal[]);
PETSC_INTERN PetscErrorCode ContactCopyAreas(Contact);
PETSC_INTERN PetscErrorCode ContactUpdateBodies(Contact, PetscBool);
PETSC_INTERN PetscErrorCode ContactCreateRowMatrix(Contact, Mat *);
PETSC_INTERN PetscErrorCode ContactAddBodyMatrix(Contact, PetscInt, Mat, Mat);
PETSC_INTERN PetscErrorCode ContactMarkNodes(Contact, const ContactPair *);
PETSC_INTERN PetscErrorCode ContactDescribeRows(Contact, const ContactPair *);
PETSC_INTERN PetscErrorCode ContactMergeDroppedRows(Contact);
PETSC_INTERN PetscErrorCode ContactMarkHeldRows(Contact);
PETSC_INTERN void           ContactLeaveOutDropped(Contact);
PETSC_INTERN PetscErrorCode ContactMergeMatrix(Contact, PetscInt);
PETSC_INTERN PetscErrorCode ContactGetPartForces(Contact, Vec *);
PETSC_INTERN PetscErrorCode ContactDestroyMerger(Contact);
PETSC_INTERN PetscErrorCode ContactFillMatrices(Contact);
/* Numbers of a pair whose least over ranks counts: motion of its surfaces; -1 where it touches, or has; -1 where it may in the step */
enum { MOTION_TOUCHES = TRANSFER_MOTION, MOTION_CLOSES, CONTACT_MOTION };
/* What ContactUpdatePairs() says of the rows of a pair */
enum { ROWS_STAY, ROWS_FOLLOWED, ROWS_REBUILT };

PETSC_INTERN PetscErrorCode ContactUpdatePairs(Contact);
PETSC_INTERN PetscErrorCode ContactLookAtNodes(const SurfaceData *, Vec, PetscReal[4], const PetscReal[3], PetscReal *);
PETSC_INTERN PetscErrorCode ContactMeasureReach(Contact, PetscReal *);
PETSC_INTERN PetscReal      ContactPairReach(Contact, const ContactPair *);
PETSC_INTERN PetscReal      ContactRowReach(Contact, const ContactPair *, const PetscReal[]);
PETSC_INTERN PetscErrorCode ContactUpdateRows(Contact);
PETSC_INTERN PetscBool      ContactPairStartsAnew(Contact, const ContactPair *);
PETSC_INTERN PetscErrorCode ContactListAllRows(Contact);
PETSC_INTERN PetscErrorCode ContactListNearRows(Contact, PetscReal);
PETSC_INTERN void           ContactListActingRows(Contact, const PetscBool[]);
PETSC_INTERN PetscErrorCode ContactRefreshGaps(Contact);
PETSC_INTERN PetscErrorCode ContactGetPairTraces(Contact, const ContactPair *, PetscInt, PetscBool, PetscScalar *[2]);
PETSC_INTERN PetscErrorCode ContactComputeRates(Contact, PetscInt, PetscBool, PetscScalar[]);
PETSC_INTERN PetscErrorCode ContactSaveRowState(Contact);
PETSC_INTERN PetscErrorCode ContactSaveRows(Contact);
PETSC_INTERN PetscErrorCode ContactRestoreRows(Contact);
PETSC_INTERN PetscErrorCode ContactDestroyRows(Contact);
PETSC_INTERN PetscErrorCode ContactLoadRows(Contact, PetscInt, const PetscReal[]);

PETSC_INTERN PetscErrorCode ContactSetUpFriction(Contact);
PETSC_INTERN void           ContactAlignRubbingRows(Contact);
PETSC_INTERN void           ContactCarryFriction(Contact);
PETSC_INTERN PetscErrorCode ContactDriveFriction(Contact);
PETSC_INTERN PetscErrorCode ContactComputeFrictionLoss(Contact, const PetscReal[]);
PETSC_INTERN PetscBool      ContactHasForce(Contact, PetscInt, const PetscReal[]);
PETSC_INTERN PetscErrorCode ContactAddWork(Contact, PetscInt, const PetscReal[], PetscReal[], PetscReal[]);
PETSC_INTERN PetscErrorCode ContactAcceptFriction(Contact);
PETSC_INTERN PetscErrorCode ContactNoteTilt(Contact);
PETSC_INTERN PetscErrorCode ContactRefuseFriction(Contact, const char[]);
PETSC_INTERN PetscErrorCode ContactDestroyFriction(Contact);
PETSC_INTERN void           ContactGetFrictionLimit(Contact, const ContactPair *, PetscReal, PetscReal[2]);
PETSC_INTERN PetscErrorCode ContactComputeSlips(Contact);

PETSC_INTERN PetscErrorCode ContactSetUpEnergy(Contact);
PETSC_INTERN PetscErrorCode ContactBeginEnergy(Contact);
PETSC_INTERN PetscErrorCode ContactNoteRebuild(Contact);
PETSC_INTERN PetscErrorCode ContactLimitEnergy(Contact);
PETSC_INTERN PetscErrorCode ContactBookWork(Contact);
PETSC_INTERN PetscErrorCode ContactDestroyEnergy(Contact);

PETSC_INTERN PetscErrorCode ContactSetUpFloating(Contact);
PETSC_INTERN PetscErrorCode ContactSetUpSprings(Contact);
PETSC_INTERN PetscErrorCode ContactMakeStep(Contact);
PETSC_INTERN PetscErrorCode ContactDestroyFloating(Contact);

PETSC_INTERN PetscErrorCode ContactCreateResultants(Contact);
PETSC_INTERN PetscErrorCode ContactSetUpResultants(Contact);
PETSC_INTERN PetscErrorCode ContactStartImpulses(Contact);
PETSC_INTERN PetscErrorCode ContactAddImpulses(Contact);
PETSC_INTERN PetscBool      ContactHasTouched(Contact, const ContactPair *);
PETSC_INTERN PetscErrorCode ContactDestroyResultants(Contact);

PETSC_INTERN PetscErrorCode ContactSetUpStabilization(Contact);
PETSC_INTERN PetscErrorCode ContactSetOuterFromOptions(Contact, SNES, SNESType);
PETSC_INTERN PetscErrorCode ContactRefuseUnstable(Contact, PetscBool, const char[]);
PETSC_INTERN PetscBool      ContactBodyHasMass(Body);
PETSC_INTERN PetscBool      ContactNeedsImpulse(Contact, PetscInt);
PETSC_INTERN PetscBool      ContactHasMass(Contact, PetscBool);
PETSC_INTERN PetscErrorCode ContactStabilize(Contact);

PETSC_INTERN PetscErrorCode ContactCreate_Schwarz(Contact);
PETSC_INTERN PetscErrorCode ContactCreate_Penalty(Contact);
PETSC_INTERN PetscErrorCode ContactCreate_Lagrange(Contact);
PETSC_INTERN PetscErrorCode ContactCreate_AugmentedLagrangian(Contact);
PETSC_INTERN PetscErrorCode ContactCreate_Alternation(Contact);
PETSC_INTERN PetscErrorCode ContactReadUnconverged(Contact);
