/*
   What passes show of S: secants by the formula of Broyden, Fletcher, Goldfarb and Shanno.

   C. G. Broyden, IMA Journal of Applied Mathematics 6 (1970) 76-90 and 222-231, and Fletcher, Goldfarb, Shanno in the same year.
*/
#include "stepimpl.h"

#define CURVATURE 1e-10 /* a secant counts whose work is at least this part of what S tells of it */
#define EXACT     1e-9  /* S has told right what differs by less than this part of it */

/* The block of a group in a dense S is corrected by what the last two passes have shown of it, unless it has told right. A sparse S does.
 */
static PetscErrorCode CorrectGroup(ContactStepper *stepper, PetscInt n, const PetscInt places[], PetscScalar S[])
{
  LawProblem        *problem = &stepper->problem;
  const PetscScalar *product = stepper->gathered;
  PetscReal          work = 0, told_work = 0, off = 0, largest = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt    i     = places[k];
    const PetscScalar force = problem->base[i] - stepper->told[i], read = problem->read[i] - stepper->told[problem->n + i];

    work += PetscRealPart(force * read);
    told_work += PetscRealPart(force * product[i]);
    off     = PetscMax(off, PetscAbsScalar(read - product[i]));
    largest = PetscMax(largest, PetscAbsScalar(product[i]));
  }
  if (off <= EXACT * largest || !(work > CURVATURE * told_work) || !(told_work > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt l = 0; l < n; l++) {
    const PetscInt    j    = places[l];
    const PetscScalar read = (problem->read[j] - stepper->told[problem->n + j]) / work, told = product[j] / told_work;

    for (PetscInt k = 0; k < n; k++) {
      const PetscInt i = places[k];

      S[j * problem->n + i] += read * (problem->read[i] - stepper->told[problem->n + i]) - told * product[i];
    }
    problem->diagonal[j] = PetscRealPart(S[j * problem->n + j]);
  }
  stepper->corrected = stepper->has_secants = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S as it has been assembled */
static PetscErrorCode StorePlain(ContactStepper *stepper)
{
  PetscInt size = -1;

  PetscFunctionBegin;
  if (stepper->plain) PetscCall(MatGetSize(stepper->plain, &size, NULL));
  if (size != stepper->problem.n) {
    PetscCall(MatDestroy(&stepper->plain));
    PetscCall(MatDuplicate(stepper->problem.S, MAT_DO_NOT_COPY_VALUES, &stepper->plain));
  }
  PetscCall(MatCopy(stepper->problem.S, stepper->plain, SAME_NONZERO_PATTERN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Secants are of one step: a run that is continued from a checkpoint has none */
PetscErrorCode ContactStepperForgetSecants(ContactStepper *stepper)
{
  Mat S = stepper->problem.S;

  PetscFunctionBegin;
  if (!stepper->has_secants) PetscFunctionReturn(PETSC_SUCCESS);
  stepper->has_secants = PETSC_FALSE;
  PetscCall(MatCopy(stepper->plain, S, SAME_NONZERO_PATTERN));
  PetscCall(PetscObjectReference((PetscObject)S));
  PetscCall(LawProblemTakeS(&stepper->problem, &S));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S after a pass, group by group */
PetscErrorCode ContactStepperCorrectS(Contact contact, ContactStepper *stepper)
{
  LawProblem    *problem = &stepper->problem;
  const PetscInt n       = problem->n;
  PetscScalar   *S;

  PetscFunctionBegin;
  stepper->corrected = PETSC_FALSE;
  if (problem->sparse || !stepper->has_told) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < n; i++) stepper->gathered[i] = problem->base[i] - stepper->told[i];
  PetscCall(LawProblemMultiply(problem, stepper->gathered, stepper->gathered));
  if (!stepper->has_secants) PetscCall(StorePlain(stepper));
  PetscCall(MatDenseGetArray(problem->S, &S));
  for (PetscInt g = 0; g < contact->n_bodies; g++) {
    PetscInt of_group = 0;

    for (PetscInt i = 0; i < n && stepper->group[g] == g; i++)
      if (ContactStepperGroup(contact, stepper, i) == g) stepper->places[of_group++] = i;
    if (of_group) PetscCall(CorrectGroup(stepper, of_group, stepper->places, S));
  }
  PetscCall(MatDenseRestoreArray(problem->S, &S));
  PetscFunctionReturn(PETSC_SUCCESS);
}
