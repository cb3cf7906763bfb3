/* What the step does for laws of glue: it tells them of the node, keeps what they keep, and books what damage takes of the energy.

   Glue has the stiffness k, times area, and the force k g with the gap g on which the force of the step does its work: the mean gap of a
   constant force, so that this does 1/2 k (g_1^2 - g_0^2) with the gaps at the ends of the step, or the gap at its end, with the force
   between both linear in time. The glue stores 1/2 k_1 g_1^2 then, where 1/2 k_0 g_0^2 was; the fall of k has taken 1/2 (k_0 - k_1) g_0^2
   in the first case and 1/2 (k_0 - k_1) g_0 g_1 in the second, to round-off. */
#include "stepimpl.h"
#include <checkpoint/checkpoint.h>
#include <impakt/private/bodyforces.h>

static PetscBool IsGlued(Contact contact, const ContactStepper *stepper, PetscInt i)
{
  return (PetscBool)(ContactStepperLaw(contact, stepper, i)->stiffness != NULL);
}

static PetscReal GetArea(Contact contact, PetscInt i)
{
  return contact->rows.area[i] * contact->resultants.cross_section[contact->rows.pair[i]];
}

/* Of the glue of a row, with the numbers kept of its node [N/m]; 0: there is none */
static PetscReal GetStiffness(Contact contact, const ContactStepper *stepper, const PetscReal history[], PetscInt i)
{
  if (!IsGlued(contact, stepper, i)) return 0;
  return GetArea(contact, i) *
         (*ContactStepperLaw(contact, stepper, i)->stiffness)(stepper->parameters + ROW_LAW_PARAMETERS * contact->rows.pair[i],
                                                              history + ROW_LAW_HISTORY * ContactFirstRow(contact, i));
}

/* What the law of a row stores at a gap at the end of the step [J] */
static PetscReal Stored(Contact contact, PetscInt i, PetscReal gap)
{
  const ContactStepper *stepper = (const ContactStepper *)contact->data;

  return 0.5 * GetStiffness(contact, stepper, stepper->grown, i) * gap * gap;
}

/* What the law of a row has stored in the step, and its damage has taken [J] */
PetscReal ContactStepperTaken(Contact contact, const ContactStepper *stepper, PetscInt i)
{
  return Stored(contact, i, contact->end.gap[i]) -
         0.5 * GetStiffness(contact, stepper, stepper->history, i) * PetscSqr(contact->start.gap[i]) + contact->energy.broken[i];
}

PetscErrorCode ContactStepperSetUpGlue(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  stepper->glued = ContactAnyPairHas(contact, CONTACT_LAW_GLUE);
  if (!stepper->glued) PetscFunctionReturn(PETSC_SUCCESS);
  contact->ops->stored = Stored;
  PetscCall(PetscCalloc3(ROW_LAW_PARAMETERS * contact->n_pairs, &stepper->parameters, ROW_LAW_HISTORY * contact->rows.n, &stepper->history,
                         ROW_LAW_HISTORY * contact->rows.n, &stepper->grown));
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (contact->pairs[p].law == CONTACT_LAW_GLUE)
      ContactGetLawParameters(contact, &contact->pairs[p], stepper->parameters + ROW_LAW_PARAMETERS * p);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers of the nodes of glue, in the order in which they are gathered: normals and gaps have one for each row */
enum { GLUE_AREA, GLUE_NORMAL, GLUE_GAP, GLUE_HISTORY };

/* Normals of nodes of this rank, whose rows lie along the axes, or a number that the law has kept of them */
static PetscErrorCode FillNumbers(Contact contact, ContactStepper *stepper, PetscInt which)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    TransferRows       rows;

    if (pair->law != CONTACT_LAW_GLUE) continue;
    PetscCall(TransferGetRows(pair->transfer, &rows));
    for (PetscInt i = pair->begin; i < pair->end; i++)
      stepper->mine[i] = which == GLUE_NORMAL ? rows.normals[i - pair->begin]
                                              : stepper->history[ROW_LAW_HISTORY * i + which - GLUE_HISTORY];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As a step begins, once its touching rows are listed: what the law of each node of glue is told, on all ranks. Contact keeps a node from a
   gap below `least`. A force that is constant in the step keeps it from going deeper, or, of a node that was apart, keeps the mean gap of
   the step from being one of overlap: its work on the bodies is never positive. */
PetscErrorCode ContactStepperBeginGlue(Contact contact, ContactStepper *stepper)
{
  LawProblem *problem = &stepper->problem;

  PetscFunctionBegin;
  for (PetscInt which = 0; which < GLUE_HISTORY + ROW_LAW_HISTORY && stepper->glued; which++) {
    if (which == GLUE_NORMAL || which >= GLUE_HISTORY) PetscCall(FillNumbers(contact, stepper, which));
    PetscCall(ContactStepperGather(contact, stepper,
                                   which == GLUE_AREA  ? contact->rows.area
                                   : which == GLUE_GAP ? contact->start.gap
                                                       : stepper->mine,
                                   stepper->gathered));
    for (PetscInt node = 0; node < problem->n_nodes; node++) {
      const PetscInt first = problem->begin[node], n = problem->begin[node + 1] - first, p = contact->ranks.row_pair[stepper->rows[first]];
      const PetscScalar *value = stepper->gathered + first;
      RowLawGlue        *glue  = &problem->glue[node];
      PetscReal          along = 0;

      glue->parameters = stepper->parameters + ROW_LAW_PARAMETERS * p;
      glue->times      = ContactStepperRule(stepper, &contact->pairs[p])->shape == BODY_FORCE_CONSTANT ? 2 : 1;
      if (which == GLUE_AREA) glue->area = PetscRealPart(value[0]) * contact->resultants.cross_section[p];
      if (which >= GLUE_HISTORY) glue->history[which - GLUE_HISTORY] = PetscRealPart(value[0]);
      for (PetscInt k = 0; k < n && which == GLUE_NORMAL; k++) glue->normal[k] = PetscRealPart(value[k]);
      for (PetscInt k = 0; k < n && which == GLUE_GAP; k++) along += glue->normal[k] * PetscRealPart(value[k]);
      if (which == GLUE_GAP) glue->least = glue->times == 1 ? 0 : PetscMin(along, 0);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At the end of a step: what laws keep of the nodes of a pair, and what its damage takes */
static PetscErrorCode EndPair(Contact contact, ContactStepper *stepper, PetscInt p)
{
  const ContactPair *pair = &contact->pairs[p];
  TransferRows       rows;

  PetscFunctionBegin;
  PetscCall(TransferGetRows(pair->transfer, &rows));
  for (PetscInt k = pair->near_begin; k < pair->near_end; k += pair->components) {
    const PetscInt first = contact->rows.near[k], node = (first - pair->begin) / pair->components;
    const RowLaw  *law   = ContactStepperLaw(contact, stepper, first);
    RowLawGlue     glue  = {.area = GetArea(contact, first), .parameters = stepper->parameters + ROW_LAW_PARAMETERS * p};
    PetscReal     *grown = stepper->grown + ROW_LAW_HISTORY * first, gap[ROW_LAW_ROWS];

    if (!law->stiffness || !law->grow) continue;
    glue.times = ContactStepperTimes(contact, stepper, first);
    PetscCall(PetscArraycpy(glue.normal, rows.normals + contact->dim * node, contact->dim));
    PetscCall(PetscArraycpy(glue.history, stepper->history + ROW_LAW_HISTORY * first, ROW_LAW_HISTORY));
    for (PetscInt c = 0; c < pair->components; c++)
      gap[c] = (contact->end.gap[first + c] + (glue.times - 1) * contact->start.gap[first + c]) / glue.times;
    PetscCall(PetscArraycpy(grown, glue.history, ROW_LAW_HISTORY));
    (*law->grow)(pair->components, &glue, gap, grown);
    for (PetscInt i = first; i < first + pair->components; i++)
      contact->energy.broken[i] = 0.5 *
                                  (GetStiffness(contact, stepper, stepper->history, i) -
                                   GetStiffness(contact, stepper, stepper->grown, i)) *
                                  contact->start.gap[i] * (glue.times == 1 ? contact->end.gap[i] : contact->start.gap[i]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperEndGlue(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (contact->pairs[p].law == CONTACT_LAW_GLUE) PetscCall(EndPair(contact, stepper, p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperAcceptGlue(Contact contact, ContactStepper *stepper)
{
  PetscReal sum = 0;

  PetscFunctionBegin;
  if (!ContactGlueBreaks(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArraycpy(stepper->history, stepper->grown, ROW_LAW_HISTORY * contact->rows.n));
  for (PetscInt i = 0; i < contact->rows.n; i++) sum += contact->energy.broken[i];
  PetscCall(ContactReduce(contact, 1, MPIU_REAL, MPIU_SUM, &sum));
  contact->counts.glue_loss += sum;
  if (sum != 0) PetscCall(PetscInfo(contact, "damage of glue takes %g J in the step\n", (double)sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}
