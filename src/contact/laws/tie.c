/* Ties hold the rows of a node where they are; surfaces that have met and do not come apart stay as closed as they are. */
#include "rowlaw.h"

static void Project(PetscInt n, const PetscReal limit[2], const RowLawGlue *glue, const PetscReal p[], PetscReal force[],
                    PetscReal derivative[])
{
  (void)limit;
  (void)glue;
  for (PetscInt i = 0; i < n; i++) {
    force[i] = p[i];
    for (PetscInt j = 0; j < n; j++) derivative[i * n + j] = i == j;
  }
}

const RowLaw RowLawTie  = {.reads = ROW_LAW_READS_END, .pulls = PETSC_TRUE, .project = Project};
const RowLaw RowLawHold = {.reads = ROW_LAW_READS_CLOSED, .pulls = PETSC_TRUE, .project = Project};
