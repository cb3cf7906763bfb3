/* Set-up; what contact tells of itself then is in contactget.c. */
#include <contact/parts.h>
#include <sys/citations.h>
#include <sys/statusline.h>
#include <impakt/private/bodymass.h>
#include <impakt/private/bodystep.h>

/* Arrays with an entry for each body; traces have one more, for all obstacles */
static PetscErrorCode AllocateBodies(Contact contact)
{
  const PetscInt n = contact->n_bodies;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(4 * n, &contact->reach.mean, 2 * n, &contact->reach.spread));
  contact->reach.acceleration = contact->reach.spread + n;
  PetscCall(PetscCalloc1(n, &contact->overlaps.boundaries));
  PetscCall(
      PetscCalloc5(n + 1, &contact->traces, n, &contact->interfaces, n, &contact->spares, n, &contact->order, n, &contact->body_rows));
  PetscCall(PetscCalloc4(n, &contact->ends, n, &contact->ahead, n, &contact->work.hands_over, 8 * n, &contact->work.traces));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Parts of the controller step at whose ends all bodies have a time in common: contact holds at each of them, and rows join and leave */
static PetscErrorCode ShareControllerStep(Contact contact)
{
  PetscInt common = 0;

  PetscFunctionBegin;
  contact->parts = 1;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt substeps;

    PetscCall(BodySetUpSteps(contact->bodies[b]));
    PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
    common = PetscGCD(common, substeps);
  }
  if (!contact->options.shared_times || (!contact->n_pairs && !contact->neighbours.come_and_go)) PetscFunctionReturn(PETSC_SUCCESS);
  contact->parts = common;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyShareControllerStep(contact->bodies[b], common));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lets bodies choose whether their contact nodes are massless. Where some are not, no others of their set are either: their rule is that of
   impulses, by which massless nodes lose more than the kinetic energy with which those that have mass hit, and cost more. */
static PetscErrorCode ChooseMass(Contact contact)
{
  const PetscInt n    = contact->n_bodies;
  PetscInt       kept = n; /* a body that keeps its mass by its own choice */
  PetscInt      *set;
  PetscBool     *keeps;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &set));
  PetscCall(PetscCalloc1(n, &keeps));
  ContactFindSets(contact, set);
  for (PetscInt b = 0; b < n; b++) {
    PetscBool chooses = PETSC_FALSE;

    if (BodyChoosesMass(contact->bodies[b])) {
      const SurfaceData *data;
      Surface            boundary;

      PetscCall(ContactCreateSurface(contact, b, NULL, &boundary));
      PetscCall(SurfaceGetData(boundary, &data));
      PetscCall(BodyChooseMass(contact->bodies[b], data->n_nodes, data->vertices, &chooses));
      PetscCall(SurfaceDestroy(&boundary));
    }
    if (chooses && kept == n) kept = b;
    keeps[set[b]] = (PetscBool)(keeps[set[b]] || chooses ||
                                (contact->impulses && (contact->options.keep_mass || ContactNeedsImpulse(contact, b))));
  }
  for (PetscInt p = 0; p < contact->n_pairs && contact->impulses; p++)
    if (contact->pairs[p].keeps_mass) keeps[set[contact->pairs[p].body[0]]] = PETSC_TRUE;
  for (PetscInt b = 0; b < n; b++)
    if (keeps[set[b]]) PetscCall(BodyKeepMass(contact->bodies[b]));
  PetscCall(PetscFree(keeps));
  PetscCall(PetscFree(set));
  PetscCheck(kept == n || !contact->prescribes, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_type alternation needs massless contact nodes, and body '%s' is thin: it keeps the mass of its own; choose schwarz, "
             "which is the default, or -%s_mass_redistribute true or false",
             ((PetscObject)contact->bodies[PetscMin(kept, n - 1)])->name, ((PetscObject)contact->bodies[PetscMin(kept, n - 1)])->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The alternation replaces the contact step for constraints on rates, stabilizations, and generalized alpha (forces inside steps) */
static PetscErrorCode ChooseMethod(Contact contact)
{
  const char *why = NULL;
  PetscBool   schwarz;

  PetscFunctionBegin;
  PetscCall(PetscObjectTypeCompare((PetscObject)contact, CONTACT_SCHWARZ, &schwarz));
  if (!schwarz) PetscFunctionReturn(PETSC_SUCCESS);
  if (contact->options.constraint != CONTACT_CONSTRAINT_GAP) why = "-contact_constraint";
  if (contact->options.stabilization != CONTACT_STABILIZATION_NONE) why = "-contact_stabilization";
  for (PetscInt b = 0; b < contact->n_bodies && !why; b++) {
    PetscReal stage[2];

    PetscCall(ContactGetStage(contact->bodies[b], stage));
    if (stage[0] != 1 || stage[1] != 1) why = "generalized alpha (-<body>_ts_alpha_...)";
  }
  if (!why) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)contact), stderr,
                         "impakt: warning: %s goes with -contact_type alternation, which is taken; choose it by its name\n", why));
  PetscCall(ContactSetType(contact, CONTACT_ALTERNATION));
  PetscTryTypeMethod(contact, setfromoptions);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the contact surfaces and rows, the first part of ContactSetUp(), before the controller chooses its step; once. Collective. */
PetscErrorCode ContactSetUpSurfaces(Contact contact)
{
  PetscReal extent;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  if (contact->surfaces_known) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(contact->bodies, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_WRONGSTATE, "Call ContactSetBodies() first");
  if (!((PetscObject)contact)->type_name) PetscCall(ContactSetType(contact, CONTACT_SCHWARZ));
  PetscCall(ChooseMethod(contact));
  if (contact->options.constraint != CONTACT_CONSTRAINT_GAP) PetscCall(ImpaktCite(CITE_GAP_RATE));
  PetscCall(AllocateBodies(contact));
  PetscCall(ContactChooseAllPairs(contact));
  PetscCall(ContactOrderBodies(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    StatusLineTell("elements of body %s", ((PetscObject)contact->bodies[b])->name);
    PetscCall(BodySetUpDiscretization(contact->bodies[b]));
  }
  PetscCall(ContactFindDimension(contact));
  StatusLineTell("contact surfaces");
  PetscCall(ContactTakeSurfaces(contact, &extent));
  PetscCall(ChooseMass(contact));
  PetscCall(ContactCheckLaws(contact));
  PetscCall(ContactSetUpRows(contact, extent));
  PetscCall(ContactWarnOfObstacles(contact));
  contact->surfaces_known = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the contact rows, sets up the bodies and the method. Collective. */
PetscErrorCode ContactSetUp(Contact contact)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  if (contact->setup) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactSetUpSurfaces(contact));
  PetscCall(ContactSetUpScales(contact));
  PetscCall(ShareControllerStep(contact));
  PetscCall(ContactSetUpSprings(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    StatusLineTell("matrices of body %s", ((PetscObject)contact->bodies[b])->name);
    PetscCall(BodyBeginSetUp(contact->bodies[b]));
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyFactor(contact->bodies[b]));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(BodySetUp(contact->bodies[b]));
    PetscCall(BodyGetTraces(contact->bodies[b], &contact->traces[b]));
  }
  StatusLineTell("contact method");
  PetscCall(ContactWarnOfStages(contact, PETSC_FALSE));
  PetscCall(ContactSetUpFloating(contact));
  PetscCall(ContactSetUpObstacleTraces(contact));
  PetscCall(ContactSetUpResultants(contact));
  PetscCall(ContactSetUpEnergy(contact));
  PetscCall(ContactSetUpFriction(contact));
  PetscCall(ContactSetUpStabilization(contact));
  /* some are set up even where no bodies are near yet, and say at once what they cannot do: friction, and impulses */
  if (contact->rows.n_all || (contact->neighbours.come_and_go && (ContactAnyPairHas(contact, CONTACT_LAW_FRICTION) || contact->sideless)))
    PetscTryTypeMethod(contact, setup);
  for (PetscInt o = 0; o < contact->n_obstacles && !ContactAnyPairHas(contact, CONTACT_LAW_FRICTION); o++) {
    const char *name;
    PetscBool   moves;

    PetscCall(ObstacleGetVelocity(contact->obstacles[o], NULL, 0, NULL, &moves));
    PetscCall(PetscObjectGetName((PetscObject)contact->obstacles[o], &name));
    PetscCheck(!moves, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-%s_velocity: bodies feel the velocity of an obstacle by friction alone; set -contact_law coulomb", name);
  }
  PetscCheck(!contact->energy.takes || !contact->energy.unlimited || !contact->energy.asked, PetscObjectComm((PetscObject)contact),
             PETSC_ERR_USER_INPUT, "%s has no effect: %s, and no step is made again for what it takes; leave it out", contact->energy.asked,
             contact->energy.unlimited);
  if (!contact->ops->stored && !contact->energy.unlimited) contact->energy.unlimited = "the method does not tell what its forces store";
  contact->setup = PETSC_TRUE;
  StatusLineTell("first state");
  PetscCall(ContactTakeStart(contact, PETSC_FALSE));
  PetscCall(PetscObjectViewFromOptions((PetscObject)contact, NULL, "-contact_view"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the present states as the start: ties what lies on each other, refuses bodies that overlap, and brings massless nodes into balance
   where loads, strains, ties and closed rows have them, unless -contact_balanced_start false is given. To be called again when states have
   been changed after ContactSetUp(). A tied pair that ties nothing, a gap above the tie distance or an overlap is an error. `of_state`: the
   states come from another run; bodies in contact there may overlap by what rows of the other side leave. Collective. */
PetscErrorCode ContactTakeStart(Contact contact, PetscBool of_state)
{
  PetscBool renewed;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscCall(ContactRenewNeighbours(contact, 0, PETSC_TRUE, &renewed)); /* initial displacements count */
  PetscCall(ContactReadStartGaps(contact, PETSC_TRUE));
  PetscCall(ContactTie(contact));
  ContactAlignRubbingRows(contact);
  PetscCall(ContactLetTouch(contact, of_state));
  if (contact->n_pairs || contact->neighbours.come_and_go) PetscCall(ContactStartOverlaps(contact, of_state));
  PetscCall(ContactSetMeanForces(contact));
  PetscCall(ContactBalanceStart(contact));
  PetscCall(ContactStartTies(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
