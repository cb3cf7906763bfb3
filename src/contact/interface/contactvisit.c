/* The state of contact and of its bodies, for checkpoints: pairs and rows first, with the matrices that the bodies have of them, then what
   the method remembers, then the bodies, since a method that is set up for a level of cut steps asks them for their compliance. */
#include <contact/parts.h>
#include <body/interface/bodyvisit.h>
#include <interface/transfervisit.h>
#include "contactvisit.h"

static PetscErrorCode VisitMatrices(Contact contact, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  if (!contact->rows.n_all) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(CheckpointVisitMat(checkpoint, "rows of a body", &contact->interfaces[b]));
  if (!CheckpointLoads(checkpoint)) PetscFunctionReturn(PETSC_SUCCESS);
  ContactForgetMatrices(contact); /* those of later steps are made anew */
  PetscCall(ContactUpdateBodies(contact, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Loading, shares of rows that have been dropped go to others as they have; that leaves rows as they are loaded */
static PetscErrorCode VisitRows(Contact contact, Checkpoint checkpoint)
{
  StateList list;

  PetscFunctionBegin;
  ContactListRowState(contact, &list);
  PetscCall(StateListVisit(&list, "rows", checkpoint));
  if (!CheckpointLoads(checkpoint)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactSaveRowState(contact));
  PetscCall(ContactMergeDroppedRows(contact));
  PetscCall(StateListCopy(&list, PETSC_TRUE, contact->saved.state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode VisitEnergy(Contact contact, Checkpoint checkpoint)
{
  ContactEnergy *energy  = &contact->energy;
  PetscBool     *flags[] = {&energy->begun,       &energy->at_rest, &energy->known,      &energy->rebuilt,
                            &energy->start_known, &energy->changed, &energy->stays_whole};

  PetscFunctionBegin;
  PetscCall(CheckpointVisitReals(checkpoint, "scale", 1, &energy->scale));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(flags); i++) PetscCall(CheckpointVisitBools(checkpoint, "flag", 1, flags[i]));
  PetscCall(CheckpointVisitReals(checkpoint, "largest force", 1, &energy->largest_force));
  PetscCall(CheckpointVisitReals(checkpoint, "work", 1, &energy->work));
  PetscCall(CheckpointVisitReals(checkpoint, "step work", 1, &energy->step_work));
  PetscCall(CheckpointVisitReals(checkpoint, "room", contact->n_bodies, energy->room));
  PetscCall(CheckpointVisitReals(checkpoint, "change", contact->n_bodies, energy->change));
  PetscCall(CheckpointVisitInts(checkpoint, "group", contact->n_bodies, energy->group));
  PetscCall(CheckpointVisitReals(checkpoint, "group work", contact->n_bodies, energy->group_work));
  PetscCall(CheckpointVisitReals(checkpoint, "start energy", contact->n_bodies, energy->start_energy));
  PetscCall(CheckpointVisitReals(checkpoint, "pair sums", 2 * contact->n_pairs, energy->pair_sums));
  if (contact->friction.slip) {
    PetscCall(CheckpointVisitReals(checkpoint, "friction", contact->n_pairs, contact->friction.pair_loss));
    PetscCall(CheckpointVisitReals(checkpoint, "obstacle work", contact->n_pairs, contact->friction.pair_driven));
  }
  PetscCall(CheckpointVisitBytes(checkpoint, "gone", (size_t)contact->neighbours.told.n * sizeof(ContactPairState),
                                 contact->neighbours.told.gone));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactHasVisit - whether runs with the method can have checkpoints */
PetscBool ContactHasVisit(Contact contact)
{
  return (PetscBool)(contact->ops->rowschanged || (!contact->rows.n_all && !contact->neighbours.come_and_go));
}

/* ContactRepeatsBits - whether sums over rows are the same to the last bit in another run: those over rows that lie on three ranks or more
   need not be, of which runs of an explicit rod on a plane have been seen to have two. Bodies tell of themselves. Collective. */
PetscErrorCode ContactRepeatsBits(Contact contact, PetscBool *sums)
{
  int with_rows = contact->rows.n > 0;

  PetscFunctionBegin;
  PetscCall(ContactReduce(contact, 1, MPI_INT, MPI_SUM, &with_rows));
  *sums = (PetscBool)(with_rows < 3);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Pairs that come and go: those that there are, and when they are looked for again */
static PetscErrorCode VisitNeighbours(Contact contact, Checkpoint checkpoint)
{
  ContactNeighbours *neighbours = &contact->neighbours;
  PetscInt           n          = contact->n_pairs, *list;

  PetscFunctionBegin;
  if (!neighbours->come_and_go) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckpointVisitInts(checkpoint, "pairs that are near", 1, &n));
  PetscCheck(n >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_FILE_UNEXPECTED, "The checkpoint has %" PetscInt_FMT " pairs", n);
  PetscCall(PetscMalloc1(n, &list));
  if (!CheckpointLoads(checkpoint)) PetscCall(PetscArraycpy(list, neighbours->living, n));
  PetscCall(CheckpointVisitInts(checkpoint, "their numbers", n, list));
  for (PetscInt p = 0; p < n; p++)
    PetscCheck(list[p] >= 0 && list[p] < ContactNumberPair(contact, contact->n_bodies, 0), PetscObjectComm((PetscObject)contact),
               PETSC_ERR_FILE_UNEXPECTED, "The checkpoint has a pair of bodies that are not there: it is of another problem");
  PetscCall(CheckpointVisitReals(checkpoint, "near", 1, &neighbours->near));
  PetscCall(CheckpointVisitReals(checkpoint, "room left", 1, &neighbours->room_left));
  if (CheckpointLoads(checkpoint)) PetscCall(ContactReplacePairs(contact, n, list));
  PetscCall(PetscFree(list));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactVisitShared - what all ranks have of the state of contact and of its bodies, to or from a checkpoint */
PetscErrorCode ContactVisitShared(Contact contact, Checkpoint checkpoint)
{
  PetscInt sizes[] = {contact->n_bodies, contact->n_pairs, contact->rows.n_all, contact->parts};

  PetscFunctionBegin;
  PetscCall(CheckpointBegin(checkpoint, "contact"));
  PetscCall(ContactListAllRows(contact));
  PetscCall(VisitNeighbours(contact, checkpoint));
  sizes[1] = contact->n_pairs;
  sizes[2] = contact->rows.n_all;
  PetscCall(CheckpointCheckInts(checkpoint, "bodies, pairs, rows and parts", PETSC_STATIC_ARRAY_LENGTH(sizes), sizes));
  PetscCall(CheckpointVisitBytes(checkpoint, "counts", sizeof(contact->counts), &contact->counts));
  PetscCall(CheckpointVisitReals(checkpoint, "step", 1, &contact->step));
  PetscCall(CheckpointVisitInts(checkpoint, "level", 1, &contact->attempt.level));
  PetscCall(CheckpointVisitInts(checkpoint, "accepted level", 1, &contact->attempt.accepted_level));
  PetscCall(CheckpointVisitReals(checkpoint, "whole step", 1, &contact->attempt.whole_step));
  PetscCall(CheckpointVisitReals(checkpoint, "penalty energy", 1, &contact->resultants.penalty_energy));
  PetscCall(VisitEnergy(contact, checkpoint));
  PetscCall(CheckpointVisitInts(checkpoint, "order", contact->n_bodies, contact->order));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    ContactPair   *pair    = &contact->pairs[p];
    const PetscInt side[1] = {pair->turned ? 2 : 1};

    PetscCall(CheckpointBegin(checkpoint, pair->name));
    PetscCall(CheckpointCheckInts(checkpoint, "the side that has the rows (-contact_rows)", 1, side));
    PetscCall(CheckpointVisitInts(checkpoint, "dirichlet", 1, &pair->dirichlet));
    PetscCall(CheckpointVisitBools(checkpoint, "bonded", 1, &pair->bonded));
    PetscCall(TransferVisitShared(pair->transfer, checkpoint));
  }
  PetscCall(CheckpointVisitReals(checkpoint, "turns", contact->turns.n, contact->turns.change));
  if (contact->rows.n_all) PetscTryTypeMethod(contact, visitshared, checkpoint);
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyVisitShared(contact->bodies[b], checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A rank's state of contact, set up, and of its bodies, to or from a checkpoint; loading, after ContactVisitShared(). Collective. */
PetscErrorCode ContactVisit(Contact contact, Checkpoint checkpoint)
{
  const PetscInt sizes[] = {contact->rows.n, contact->rows.begin};

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyVisitMesh(contact->bodies[b], checkpoint));
  PetscCall(CheckpointBegin(checkpoint, "contact"));
  PetscCall(CheckpointCheckInts(checkpoint, "rows, and the first of them", PETSC_STATIC_ARRAY_LENGTH(sizes), sizes));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscCall(CheckpointBegin(checkpoint, contact->pairs[p].name));
    PetscCall(TransferVisit(contact->pairs[p].transfer, checkpoint));
  }
  PetscCall(CheckpointBegin(checkpoint, "contact rows"));
  PetscCall(VisitRows(contact, checkpoint));
  PetscCall(VisitMatrices(contact, checkpoint));
  /* before the method, which notes the matrices of their layers as they are */
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyVisit(contact->bodies[b], checkpoint));
  PetscCall(CheckpointBegin(checkpoint, "contact method"));
  if (contact->rows.n_all && CheckpointLoads(checkpoint)) PetscUseTypeMethod(contact, rowschanged);
  if (contact->rows.n_all) PetscTryTypeMethod(contact, visit, checkpoint);
  PetscCall(CheckpointBegin(checkpoint, "contact states"));
  if (CheckpointLoads(checkpoint)) contact->attempt.again = PETSC_FALSE;
  PetscCall(CheckpointVisitReals(checkpoint, "impulses", CONTACT_IMPULSES * contact->n_pairs, contact->resultants.impulse));
  for (PetscInt t = BODY_FIRST_FORCE; t < BODY_TRACES; t++)
    PetscCall(CheckpointVisitTrace(checkpoint, "obstacle", contact->traces[contact->n_bodies].all[t]));
  if (contact->turns.n) PetscCall(CheckpointVisitReals(checkpoint, "turned", contact->rows.n, contact->turns.turned));
  PetscFunctionReturn(PETSC_SUCCESS);
}
