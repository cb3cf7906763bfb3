/* Contact and Coulomb friction: a node pushes along its normal, and across it with a force within a bound. The natural map of Alart and
   Curnier, A mixed formulation for frictional contact problems prone to Newton like solution methods, CMAME 92 (1991). */
#include "rowlaw.h"
#include <petscmath.h>

/* The first row is along the normal */
static void Project(PetscInt n, const PetscReal limit[2], const RowLawGlue *glue, const PetscReal p[], PetscReal force[],
                    PetscReal derivative[])
{
  const PetscBool pushes = (PetscBool) !(p[0] <= 0); /* what is no number stays none, and is found out */
  PetscReal       bound, size = 0;

  (void)glue;
  force[0] = pushes ? p[0] : 0;
  for (PetscInt k = 0; k < n * n; k++) derivative[k] = 0;
  derivative[0] = pushes;
  bound         = pushes ? limit[0] + limit[1] * force[0] : 0;
  for (PetscInt i = 1; i < n; i++) size += PetscSqr(p[i]);
  size = PetscSqrtReal(size);
  for (PetscInt i = 1; i < n; i++) {
    force[i] = size > bound ? p[i] / size * bound : p[i];
    if (size <= bound) derivative[i * n + i] = 1;
    else {
      derivative[i * n] = pushes ? limit[1] * p[i] / size : 0;
      for (PetscInt j = 1; j < n; j++) derivative[i * n + j] = bound / size * ((i == j) - p[i] * p[j] / PetscSqr(size));
    }
  }
}

const RowLaw RowLawUnilateral = {.reads = ROW_LAW_READS_CLOSED, .project = Project};
