/*
   What sweeps tell of the compliance of bodies that are not linear.

   S is that of a body as it was when the factors of its layer or its tangent were made. Under the change d of forces from one sweep to the
   next S tells that rows open by S d, and the bodies open by y. The compliance of elastic bodies is symmetric and positive definite, as S
   is; so it is corrected in a way that keeps both,

     S <- S - S d (S d)' / (d' S d) + y y' / (d' y),

   after which S d = y (Broyden 1970, Fletcher 1970, Goldfarb 1970, Shanno 1970, here for a compliance in place of a Hessian). It holds for
   the step under way alone: the next one begins with the bodies' own S, and needs no memory. Where S is no matrix, the vectors of these
   corrections are kept in its place.
*/
#include "friction.h"

/* Differences below this part of what rows open by are round-off: linear bodies have no others */
#define EXACT 1e-8
/* Where bodies answer to a change by less than this part of what S says, along it, something else is going on */
#define LEAST_ANSWER 1e-3

/* Corrects S by what it has told for the change of all forces in the last sweep, and what the bodies have answered; the same on every rank
 */
void FrictionLearn(FrictionProblem *problem)
{
  const PetscInt     n      = problem->n;
  const PetscScalar *change = problem->change, *told = problem->told, *answer = problem->answer;
  PetscReal          tells = 0, answers = 0, differs = 0, size = 0;

  for (PetscInt i = 0; i < n; i++) {
    tells += PetscRealPart(change[i] * told[i]);
    answers += PetscRealPart(change[i] * answer[i]);
    differs = PetscMax(differs, PetscAbsScalar(answer[i] - told[i]));
    size    = PetscMax(size, PetscAbsScalar(told[i]));
  }
  if (differs <= EXACT * size || !(tells > 0) || !(answers > LEAST_ANSWER * tells)) return;
  if (!problem->S) {
    PetscScalar *secants = problem->secants + 2 * problem->n_secants * n;

    if (problem->n_secants == FRICTION_SECANTS) return;
    for (PetscInt i = 0; i < n; i++) {
      secants[i]     = answer[i] / PetscSqrtReal(answers);
      secants[n + i] = told[i] / PetscSqrtReal(tells);
    }
    problem->n_secants++;
    return;
  }
  for (PetscInt j = 0; j < n; j++) {
    const PetscScalar out = told[j] / tells, in = answer[j] / answers;

    for (PetscInt i = 0; i < n; i++) problem->S[j * n + i] += answer[i] * in - told[i] * out;
  }
}
