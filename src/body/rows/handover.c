/* Contact forces that begin along other rows than they end.

   The acceleration at the start of a controller step has in it what forces f_0 did along the rows as they were, B_0^T f_0, at the end of
   the step before. Rows that are built again act along other directions and on other nodes. In the first interval of the force's waveform,
   which ends at the position 1 / n of the controller step, the force on the nodes is to go linearly from the old to the new one: at the
   position s it is

     (1 - n s) B_0^T f_0 + n s B^T f_1.

   The input trace brings (1 - n s) B^T f_0 + n s B^T f_1 along the rows as they are, so that what is missing is (1 - n s) (B_0 - B)^T f_0.
   Bodies whose forces are counted at the ends of the intervals alone do not see it. Without it, bodies that make other substeps would get
   another impulse, and momentum would be lost. */
#include <body/layout/bodyimpl.h>

/* The rows are those of an accepted step: the next one starts with forces along them */
PetscErrorCode BodyHandoverEnd(Body body)
{
  BodyHandover *handover = &body->rows.handover;

  PetscFunctionBegin;
  handover->until = 0;
  if (handover->matrix == body->rows.matrix) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscObjectReference((PetscObject)body->rows.matrix));
  PetscCall(MatDestroy(&handover->matrix));
  handover->matrix = body->rows.matrix;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After BodyUpdateInterface(), lets contact forces go over from the rows of the last accepted step to the new ones, until BodySave(). Of
   each row of this rank: the force at the end of the last step along the old row, that at the start of this one along the new row, 0 for
   a released row [N], and the intervals between which the force is linear; `fewest`: their least over all ranks. Collective. */
PetscErrorCode BodyHandOver(Body body, const PetscReal before[], const PetscReal now[], const PetscInt intervals[], PetscInt fewest)
{
  BodyRows     *rows     = &body->rows;
  BodyHandover *handover = &rows->handover;

  PetscFunctionBegin;
  PetscCheck(handover->matrix, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call after BodySave()");
  PetscCheck(fewest > 0, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_OUTOFRANGE,
             "A controller step has %" PetscInt_FMT " intervals, but must have 1 at least", fewest);
  PetscCall(PetscArraycpy(handover->before, before, rows->local));
  PetscCall(PetscArraycpy(handover->now, now, rows->local));
  PetscCall(PetscArraycpy(handover->intervals, intervals, rows->local));
  handover->until = 1.0 / fewest;
  PetscCall(BodySetHandoverRest(body, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The part of what goes over that remains, for each row of this rank; NULL: all */
PetscErrorCode BodySetHandoverRest(Body body, const PetscReal rest[])
{
  BodyHandover *handover = &body->rows.handover;

  PetscFunctionBegin;
  if (handover->until <= 0) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < body->rows.local; i++) handover->rest[i] = rest ? rest[i] : 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether forces go over anywhere in this controller step. Not while the compliance is probed, which begins without forces. */
PetscBool BodyHandsOver(Body body)
{
  return (PetscBool)(body->rows.handover.until > 0 && !body->unloaded);
}

/* f += B_0^T w f_0 - B^T w f_0 with weights w of the rows: 1 - n s at the position s of the controller step, or zero behind the first
   interval, times the part that remains; or `stopped`: minus the part that does not */
static PetscErrorCode AddWeighted(Body body, PetscReal position, PetscBool stopped, PetscScalar scale, Vec f)
{
  const BodyHandover *handover = &body->rows.handover;
  PetscScalar        *row;

  PetscFunctionBegin;
  for (PetscInt side = 0; side < 2; side++) {
    const PetscReal *force = side ? handover->now : handover->before;

    PetscCall(VecGetArrayWrite(body->work.rows[0], &row));
    for (PetscInt i = 0; i < body->rows.local; i++) {
      const PetscReal weight = stopped ? handover->rest[i] - 1 : handover->rest[i] * PetscMax(1 - handover->intervals[i] * position, 0);

      row[i] = (side ? -scale : scale) * weight * force[i];
    }
    PetscCall(VecRestoreArrayWrite(body->work.rows[0], &row));
    PetscCall(MatMultTransposeAdd(side ? body->rows.matrix : handover->matrix, body->work.rows[0], f, f));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* f += scale (1 - n s) (B_0^T f_0 - B^T f_0) */
PetscErrorCode BodyAddHandover(Body body, PetscReal position, PetscScalar scale, Vec f)
{
  PetscFunctionBegin;
  if (!BodyHandsOver(body) || position >= body->rows.handover.until) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AddWeighted(body, position, PETSC_FALSE, scale, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* f -= the part of B_0^T f_0 - B^T f_0 that does not remain, see BodySetHandoverRest() */
PetscErrorCode BodyAddStoppedHandover(Body body, Vec f)
{
  PetscFunctionBegin;
  if (BodyHandsOver(body)) PetscCall(AddWeighted(body, 0, PETSC_TRUE, 1, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}
