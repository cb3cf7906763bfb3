/* Glue: springs between both sides of each row, lambda = -k g, with the gap g along which the step's force works: no energy is lost. */
#include "rowlaw.h"

static PetscReal Stiffness(const PetscReal parameters[], const PetscReal history[])
{
  (void)history;
  return parameters[0];
}

/* With the gap m, -k m - r m = p */
static void Project(PetscInt n, const PetscReal limit[2], const RowLawGlue *glue, const PetscReal p[], PetscReal force[],
                    PetscReal derivative[])
{
  const PetscReal k = Stiffness(glue->parameters, glue->history) * glue->area, part = k / (k + glue->r);

  (void)limit;
  for (PetscInt i = 0; i < n; i++) {
    force[i] = part * p[i];
    for (PetscInt j = 0; j < n; j++) derivative[i * n + j] = i == j ? part : 0;
  }
}

const RowLaw RowLawSpring = {
    .name         = "spring",
    .reads        = ROW_LAW_READS_MEAN,
    .pulls        = PETSC_TRUE,
    .project      = Project,
    .stiffness    = Stiffness,
    .n_parameters = 1,
    .parameters   = {{.name = "stiffness",
                      .what = "stiffness of springs per unit of area",
                      .unit = UNIT_STIFFNESS_ON_AREA,
                      .hint = "glue of the modulus E and the thickness t has about E/t; -contact_law tied is rigid"}}};
