/* What the summary has of the bodies and obstacles. */
#include "summaryimpl.h"

/* The mass of a body, and what its massless contact layer has changed */
static PetscErrorCode AddMass(json_t *object, Body body)
{
  PetscReal total, least, largest, shift[3] = {0}, inertia;
  json_t   *mass;

  PetscFunctionBegin;
  PetscCall(BodyGetMass(body, &total));
  PetscCall(BodyGetMassRedistribution(body, &least, &largest, shift, &inertia));
  PetscCall(SummarySetObject(object, "mass", &mass));
  PetscCall(SummarySetReal(mass, "total", total));
  PetscCall(SummarySetReal(mass, "factor_min", least));
  PetscCall(SummarySetReal(mass, "factor_max", largest));
  PetscCall(SummarySetVector(mass, "centre_shift", shift));
  PetscCall(SummarySetReal(mass, "inertia_error", inertia));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The reactions at the held surfaces of a body, or, with -1 for its number, at all obstacles */
static PetscErrorCode AddReactions(json_t *object, PetscInt body, const StatisticsResults *results)
{
  json_t *member;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < results->n_supports; i++) {
    const SupportStatistics *support = &results->supports[i];

    if (support->body != body) continue;
    PetscCall(SummarySetObject(object, support->name, &member));
    PetscCall(SummarySetVector(member, "force", support->force));
    PetscCall(SummarySetVector(member, "moment", support->moment));
    PetscCall(SummarySetReal(member, "force_peak", support->force_peak));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SummaryAddObstacles(json_t *root, const StatisticsResults *results)
{
  json_t *object;

  PetscFunctionBegin;
  PetscCall(SummarySetObject(root, "obstacles", &object));
  PetscCall(AddReactions(object, -1, results));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Model and mass of the blocks with materials of their own, and of the rest */
static PetscErrorCode AddBlocks(json_t *object, Body body)
{
  json_t            *blocks, *block;
  const char *const *names;
  const Material    *materials;
  const PetscReal   *mass;
  PetscInt           n;

  PetscFunctionBegin;
  PetscCall(BodyGetBlocks(body, &n, &names, &materials));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetBlockMass(body, &mass));
  PetscCall(SummarySetObject(object, "blocks", &blocks));
  for (PetscInt k = 0; k < n; k++) {
    MaterialType type;

    PetscCall(PetscObjectGetType((PetscObject)materials[k], &type));
    PetscCall(SummarySetObject(blocks, names[k][0] ? names[k] : "(rest)", &block));
    PetscCall(SummarySetMember(block, "material", json_string(type)));
    PetscCall(SummarySetReal(block, "mass", mass[k]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SummaryAddBodies(json_t *root, const Body bodies[], const StatisticsResults *results)
{
  json_t     *objects, *object, *reactions;
  const char *name;
  PetscInt    dofs;
  PetscInt64  substeps;
  Vec         u;

  PetscFunctionBegin;
  PetscCall(SummarySetObject(root, "bodies", &objects));
  for (PetscInt i = 0; i < results->n_bodies; i++) {
    const BodyStatistics *body = &results->bodies[i];

    PetscCall(PetscObjectGetName((PetscObject)bodies[i], &name));
    PetscCall(BodyGetSolution(bodies[i], &u, NULL, NULL));
    PetscCall(VecGetSize(u, &dofs));
    PetscCall(BodyGetTotalSubsteps(bodies[i], &substeps, NULL));
    PetscCall(SummarySetObject(objects, name, &object));
    PetscCall(SummarySetInteger(object, "dofs", dofs));
    PetscCall(AddMass(object, bodies[i]));
    PetscCall(AddBlocks(object, bodies[i]));
    PetscCall(SummarySetReal(object, "kinetic", body->kinetic));
    PetscCall(SummarySetReal(object, "potential", body->potential));
    PetscCall(SummarySetReal(object, "peak_potential", body->peak_potential));
    PetscCall(SummarySetReal(object, "external_work", body->external_work));
    PetscCall(SummarySetReal(object, "damping_work", body->damping_work));
    if (body->plastic) PetscCall(SummarySetReal(object, "plastic_work", body->plastic_work));
    PetscCall(SummarySetReal(object, "hourglass_energy", body->hourglass_energy));
    PetscCall(SummarySetReal(object, "hourglass_energy_max", body->hourglass_energy_max));
    PetscCall(SummarySetReal(object, "rotation_max", body->rotation_max));
    PetscCall(SummarySetInteger(object, "inverted_max", body->inverted_max));
    if (!PetscIsNanReal(body->displacement_error)) PetscCall(SummarySetReal(object, "displacement_error", body->displacement_error));
    PetscCall(SummarySetReal(object, "total_energy_error_min", body->energy_error_min));
    PetscCall(SummarySetReal(object, "total_energy_error_max", body->energy_error_max));
    PetscCall(SummarySetInteger(object, "substeps", substeps));
    PetscCall(SummarySetObject(object, "reactions", &reactions));
    PetscCall(AddReactions(reactions, i, results));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
