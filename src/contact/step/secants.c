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
  stepper->assembled = -1;
  stepper->corrected = PETSC_TRUE;
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
