/* What the step does for laws of glue: it tells them of the node, keeps what they keep, and books what damage takes of the energy.

   Glue has the stiffness k, times area, and the force k g with the gap g on which the force of the step does its work: the mean gap of a
   constant force, so that this does 1/2 k (g_1^2 - g_0^2) with the gaps at the ends of the step, or the gap at its end, with the force
   between both linear in time. The glue stores 1/2 k_1 g_1^2 then, where 1/2 k_0 g_0^2 was; the fall of k has taken 1/2 (k_0 - k_1) g_0^2
   in the first case and 1/2 (k_0 - k_1) g_0 g_1 in the second, to round-off. */
#include "stepimpl.h"
#include <checkpoint/checkpoint.h>
#include <impakt/private/bodyforces.h>

static PetscReal GetArea(Contact contact, PetscInt i)
{
  return contact->rows.area[i] * contact->resultants.cross_section[contact->rows.pair[i]];
}

/* Of the glue of a row, with the numbers kept of its node [N/m]; 0: there is none */
static PetscReal GetStiffness(Contact contact, const ContactStepper *stepper, const PetscReal history[], PetscInt i)
{
  const RowLaw *law = ContactStepperLaw(contact, stepper, i);

  if (!law->stiffness) return 0;
  return GetArea(contact, i) * (*law->stiffness)(stepper->parameters + ROW_LAW_PARAMETERS * contact->rows.pair[i],
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

/* What the law of a node of this rank is told as a step begins, by its first row; of glue rows lie along the axes. Contact keeps the node
   from a gap below `least`. A force that is constant in the step keeps it from going deeper, or, of a node that was apart, keeps the mean
   gap of the step from being one of overlap: its work on the bodies is never positive. */
static PetscErrorCode DescribeNode(Contact contact, const ContactStepper *stepper, PetscInt first, RowLawGlue *glue)
{
  const ContactPair *pair  = &contact->pairs[contact->rows.pair[first]];
  const PetscInt     node  = (first - pair->begin) / pair->components;
  PetscReal          along = 0;
  TransferRows       rows;

  PetscFunctionBegin;
  PetscCall(TransferGetRows(pair->transfer, &rows));
  *glue = (RowLawGlue){.area       = GetArea(contact, first),
                       .times      = ContactStepperTimes(contact, stepper, first),
                       .parameters = stepper->parameters + ROW_LAW_PARAMETERS * contact->rows.pair[first]};
  PetscCall(PetscArraycpy(glue->normal, rows.normals + contact->dim * node, contact->dim));
  PetscCall(PetscArraycpy(glue->history, stepper->history + ROW_LAW_HISTORY * first, ROW_LAW_HISTORY));
  for (PetscInt d = 0; d < contact->dim; d++) along += glue->normal[d] * contact->start.gap[first + d];
  glue->least = glue->times == 1 ? 0 : PetscMin(along, 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As a step begins, once its touching rows are listed: what the law of each node of glue is told, on all ranks */
PetscErrorCode ContactStepperBeginGlue(Contact contact, ContactStepper *stepper)
{
  LawProblem  *problem = &stepper->problem;
  RowLawGlue  *mine, *all; /* per row, of first rows alone */
  MPI_Datatype type;

  PetscFunctionBegin;
  if (!stepper->glued) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc2(contact->rows.n, &mine, contact->rows.n_all, &all));
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (contact->pairs[contact->rows.pair[i]].law == CONTACT_LAW_GLUE && i == ContactFirstRow(contact, i))
      PetscCall(DescribeNode(contact, stepper, i, &mine[i]));
  PetscCallMPI(MPI_Type_contiguous(sizeof(*mine), MPI_BYTE, &type));
  PetscCallMPI(MPI_Type_commit(&type));
  PetscCall(ContactGatherRows(contact, type, mine, all));
  PetscCallMPI(MPI_Type_free(&type));
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt row = stepper->rows[problem->begin[node]];

    problem->glue[node]            = all[row];
    problem->glue[node].parameters = stepper->parameters + ROW_LAW_PARAMETERS * contact->ranks.row_pair[row];
  }
  PetscCall(PetscFree2(mine, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At the end of a step: what laws keep of nodes, and what their damage takes */
PetscErrorCode ContactStepperEndGlue(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  for (PetscInt first = 0; first < contact->rows.n && stepper->glued; first++) {
    const RowLaw *law   = ContactStepperLaw(contact, stepper, first);
    PetscReal    *grown = stepper->grown + ROW_LAW_HISTORY * first, gap[ROW_LAW_ROWS];
    RowLawGlue    glue;

    if (first != ContactFirstRow(contact, first) || !law->stiffness || !law->grow) continue;
    PetscCall(DescribeNode(contact, stepper, first, &glue));
    for (PetscInt c = 0; c < contact->dim; c++)
      gap[c] = (contact->end.gap[first + c] + (glue.times - 1) * contact->start.gap[first + c]) / glue.times;
    PetscCall(PetscArraycpy(grown, glue.history, ROW_LAW_HISTORY));
    (*law->grow)(contact->dim, &glue, gap, grown);
    for (PetscInt i = first; i < first + contact->dim; i++)
      contact->energy.broken[i] = 0.5 *
                                  (GetStiffness(contact, stepper, stepper->history, i) -
                                   GetStiffness(contact, stepper, stepper->grown, i)) *
                                  contact->start.gap[i] * (glue.times == 1 ? contact->end.gap[i] : contact->start.gap[i]);
  }
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
