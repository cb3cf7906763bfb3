/* Loads that come suddenly, at the start of a run, and formulas that let them grow. */
#include "loadsimpl.h"
#include <stdlib.h>

/* Controller steps over which such a formula lets a load grow; a step that fails later does not fail for it */
#define STEPS 10
/* Of the text of such a formula */
#define LENGTH 320

/* Whether a component is not zero at the start, whatever the place. One that depends on time and place is taken to grow. */
static PetscErrorCode IsSudden(Expression component, PetscReal start, PetscBool *sudden)
{
  const ExpressionPoint point = {.t = start};
  PetscBool             steady, uniform;
  PetscReal             value = 0;

  PetscFunctionBegin;
  *sudden = PETSC_FALSE;
  if (!component) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ExpressionIsSteady(component, &steady));
  PetscCall(ExpressionIsUniform(component, &uniform));
  if (uniform) PetscCall(ExpressionEvaluate(component, &point, &value));
  *sudden = uniform ? (PetscBool)(value != 0) : steady;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a formula to a list, times a factor that grows from 0 at the start to 1 if it is sudden */
static PetscErrorCode AddFormula(Body body, const char formula[], PetscBool sudden, char list[LENGTH])
{
  const double start = (double)body->time.start, duration = (double)(STEPS * body->time.whole_step);
  char         piece[LENGTH], from[32]                    = "t", *end;

  PetscFunctionBegin;
  (void)strtod(formula, &end);
  if (start != 0) PetscCall(PetscSNPrintf(from, sizeof(from), "(t%+.9g)", -start));
  if (!sudden) PetscCall(PetscSNPrintf(piece, sizeof(piece), "%s%s", list[0] ? "," : "", formula));
  else
    PetscCall(PetscSNPrintf(piece, sizeof(piece), "%s%s%s%s*min(1,%s/%.4g)", list[0] ? "," : "", *end ? "(" : "", formula, *end ? ")" : "",
                            from, duration));
  PetscCall(PetscStrlcat(list, piece, LENGTH));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* "-left_boundary_traction_xmax -1e5*min(1,t/0.001),0" where any of the components is sudden, else nothing; of a table neither, which
   cannot stand in a formula */
static PetscErrorCode DescribeFormulas(Body body, const Expression components[], char text[BODY_SUDDEN_LENGTH])
{
  const char *option       = NULL;
  char        list[LENGTH] = "";
  PetscBool   any = PETSC_FALSE, table = PETSC_FALSE;
  size_t      length;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < body->mesh.dim; d++) {
    const char *formula = "free";
    PetscBool   sudden;

    PetscCall(IsSudden(components[d], body->time.start, &sudden));
    if (components[d]) PetscCall(ExpressionGetOption(components[d], &option));
    if (components[d]) PetscCall(ExpressionGetText(components[d], &formula));
    PetscCall(AddFormula(body, formula, sudden, list));
    any = (PetscBool)(any || sudden);
    if (sudden && !table) PetscCall(PetscStrbeginswith(formula, "table:", &table));
  }
  PetscCall(PetscStrlen(list, &length));
  if (any && !table && length + 1 < LENGTH) PetscCall(PetscSNPrintf(text, BODY_SUDDEN_LENGTH, "-%s %s", option, list));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gravity takes no formula: a force in the volume of a static body with one material. Bodies with inertia fall as they are to. */
static PetscErrorCode DescribeGravity(Body body, char text[BODY_SUDDEN_LENGTH])
{
  const char *prefix       = ((PetscObject)body)->prefix;
  char        list[LENGTH] = "", number[32];
  PetscReal   density;

  PetscFunctionBegin;
  if (!body->loads->has_gravity || body->integrator->has_inertia || body->model.blocks.n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MaterialGetDensity(body->model.material, &density));
  for (PetscInt d = 0; d < body->mesh.dim; d++) {
    const PetscReal force = density * body->loads->gravity[d];

    PetscCall(PetscSNPrintf(number, sizeof(number), "%.9g", (double)force));
    PetscCall(AddFormula(body, force == 0 ? "0" : number, (PetscBool)(force != 0), list));
  }
  PetscCall(PetscSNPrintf(text, BODY_SUDDEN_LENGTH, "-%sbody_force %s in place of -%sgravity", prefix, list, prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A remedy where a step fails soon after the start: "A load comes suddenly: ..." with an option whose formula lets it grow; empty where
   no load or prescribed displacement is there at once, or after the first ten controller steps */
PetscErrorCode BodyDescribeSuddenLoad(Body body, char text[BODY_SUDDEN_LENGTH])
{
  const struct _BodyLoads *loads                      = body->loads;
  const PetscReal          since                      = body->saved.time - body->time.start;
  char                     remedy[BODY_SUDDEN_LENGTH] = "";

  PetscFunctionBegin;
  text[0] = 0;
  if (!loads || !(since < STEPS * body->time.whole_step)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < loads->n_loads && !remedy[0]; i++) PetscCall(DescribeFormulas(body, loads->loads[i].component, remedy));
  for (PetscInt i = 0; i < loads->n_prescribed && !remedy[0]; i++)
    PetscCall(DescribeFormulas(body, loads->prescribed[i].component, remedy));
  if (!remedy[0]) PetscCall(DescribeGravity(body, remedy));
  if (!remedy[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(
      PetscSNPrintf(text, BODY_SUDDEN_LENGTH, "A load comes suddenly: let it grow, as over %d controller steps by %s", STEPS, remedy));
  PetscFunctionReturn(PETSC_SUCCESS);
}
