#include "outersolver.h"
#include <sys/optionstext.h>
#include <sys/petsccompat.h>
#include <strings.h>

/* A SNES of `local` unknowns on this rank: a fixed-point iteration, accelerated or not */
PetscErrorCode OuterSolverCreate(Contact contact, const char prefix[], PetscInt local, PetscErrorCode (*function)(SNES, Vec, Vec, void *),
                                 OuterSolver *solver)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)contact);

  PetscFunctionBegin;
  PetscCall(VecCreate(comm, &solver->x));
  PetscCall(VecSetSizes(solver->x, local, PETSC_DETERMINE));
  PetscCall(VecSetType(solver->x, VECSTANDARD));
  PetscCall(VecDuplicate(solver->x, &solver->residual));
  PetscCall(SNESCreate(comm, &solver->snes));
  PetscCall(SNESSetOptionsPrefix(solver->snes, prefix));
  PetscCall(SNESSetFunction(solver->snes, solver->residual, function, contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A value for an option that PETSc has no setter for: put in before the options are read, taken out again afterwards. One that is given
   stays, unless it is to be replaced. */
typedef struct {
  const char *prefix, *option;
  char        given[64];
  PetscBool   is_given, inserted;
} Insertion;

static PetscErrorCode SetValue(const Insertion *insertion, const char value[])
{
  char full[128];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(full, sizeof(full), "-%s%s", insertion->prefix, insertion->option + 1));
  PetscCall(value ? PetscOptionsSetValue(NULL, full, value) : PetscOptionsClearValue(NULL, full));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode InsertValue(const char value[], PetscBool replaces, Insertion *insertion)
{
  PetscFunctionBegin;
  PetscCall(
      PetscOptionsGetString(NULL, insertion->prefix, insertion->option, insertion->given, sizeof(insertion->given), &insertion->is_given));
  insertion->inserted = (PetscBool)(replaces || !insertion->is_given);
  if (insertion->inserted) PetscCall(SetValue(insertion, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RemoveValue(const Insertion *insertion)
{
  PetscFunctionBegin;
  if (insertion->inserted) PetscCall(SetValue(insertion, insertion->is_given ? insertion->given : NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether options name the SNES with anything but what says how it solves */
static PetscErrorCode FindWatched(const char prefix[], PetscBool *watched)
{
  const char *solves[] = {"type", "atol", "rtol", "stol", "max_it", "linesearch_type", "linesearch_damping"};
  const char *name, *value;
  char        begin[128], *all, *text;

  PetscFunctionBegin;
  *watched = PETSC_FALSE;
  PetscCall(PetscSNPrintf(begin, sizeof(begin), "-%ssnes_", prefix));
  PetscCall(PetscOptionsGetAll(NULL, &all));
  for (text = all; OptionsTextNext(&text, &name, &value);) {
    PetscBool known = PETSC_FALSE;

    if (strncasecmp(name, begin, strlen(begin)) != 0) continue;
    for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(solves) && !known; i++)
      known = (PetscBool)!strcasecmp(name + strlen(begin), solves[i]);
    if (!known) *watched = PETSC_TRUE;
  }
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The type of the iteration, as the options have it: Newton's method needs a Jacobian, and Anderson's acceleration serves where there is
 * none
 */
static PetscErrorCode ReadType(Contact contact, const char prefix[], char type[], size_t size)
{
  const char *known[] = {SNESANDERSON, SNESNRICHARDSON, SNESNGMRES, SNESQN};
  PetscBool   newton, same = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(type, SNESANDERSON, size));
  PetscCall(PetscOptionsGetString(NULL, prefix, "-snes_type", type, size, NULL));
  PetscCall(PetscStrcmp(type, SNESNEWTONLS, &newton));
  if (newton) { /* the default of older versions */
    PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)contact), stderr,
                           "impakt: warning: -%ssnes_type newtonls has no effect any more: sweeps have no Jacobian, and anderson is taken; "
                           "leave it out\n",
                           prefix));
    PetscCall(PetscStrncpy(type, SNESANDERSON, size));
  }
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(known) && !same; i++) PetscCall(PetscStrcmp(type, known[i], &same));
  PetscCheck(same || newton, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_UNKNOWN_TYPE,
             "Unknown -%ssnes_type '%s'; known: anderson, nrichardson, ngmres, qn", prefix, type);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads type and tolerances. The defaults for Anderson (mixing 1/2, eight vectors) suit an iteration with a gain of about -1,
   which is that of the Dirichlet-Neumann alternation between equal bodies. */
PetscErrorCode OuterSolverSetFromOptions(Contact contact, OuterSolver *solver, PetscReal atol, PetscReal rtol, PetscInt max_it)
{
  const char    *prefix;
  char           type[64];
  PetscBool      anderson;
  SNESLineSearch line_search;
  Insertion      inserted[] = {{.option = "-snes_type"}, {.option = "-snes_anderson_beta"}, {.option = "-snes_anderson_m"}};

  PetscFunctionBegin;
  PetscCall(SNESGetOptionsPrefix(solver->snes, &prefix));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(inserted); i++) inserted[i].prefix = prefix;
  PetscCall(ReadType(contact, prefix, type, sizeof(type)));
  PetscCall(PetscStrcmp(type, SNESANDERSON, &anderson));
  PetscCall(SNESSetType(solver->snes, type));
  /* after the type, which brings a line search of its own */
  PetscCall(SNESGetLineSearch(solver->snes, &line_search));
  PetscCall(SNESLineSearchSetType(line_search, LINESEARCH_FULL_STEP));
  PetscCall(SNESSetTolerances(solver->snes, atol, rtol, 0, max_it, OUTER_MAX_EVALUATIONS));
  PetscCall(InsertValue(type, PETSC_TRUE, &inserted[0]));
  if (anderson) {
    PetscCall(InsertValue("0.5", PETSC_FALSE, &inserted[1]));
    PetscCall(InsertValue("8", PETSC_FALSE, &inserted[2]));
  }
  PetscCall(SNESSetFromOptions(solver->snes));
  PetscCall(FindWatched(prefix, &solver->watched));
  PetscCall(ContactRefuseSlopes(contact, prefix, line_search));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(inserted); i++) PetscCall(RemoveValue(&inserted[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Solves from x on. Newton's method evaluates the function first: where that is `converged` then, as in most steps of linear bodies, there
   is nothing to solve, and no SNESSolve(), which looks for a dozen options each time. The function is not evaluated twice where there is.
 */
PetscErrorCode OuterSolverSolve(Contact contact, OuterSolver *solver, PetscErrorCode (*function)(SNES, Vec, Vec, void *),
                                const PetscBool *converged)
{
  PetscBool newton;

  PetscFunctionBegin;
  PetscCall(PetscObjectTypeCompare((PetscObject)solver->snes, SNESNEWTONLS, &newton));
  if (newton && !solver->watched) {
    PetscReal norm;

    PetscCall((*function)(solver->snes, solver->x, solver->residual, contact));
    PetscCall(VecNorm(solver->residual, NORM_2, &norm));
    if (*converged && !PetscIsInfOrNanReal(norm)) {
      PetscCall(SNESSetConvergedReason(solver->snes, SNES_CONVERGED_FNORM_ABS));
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    PetscCall(SNESSetInitialFunction(solver->snes, solver->residual));
  }
  PetscCall(SNESSolve(solver->snes, NULL, solver->x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OuterSolverDestroy(OuterSolver *solver)
{
  PetscFunctionBegin;
  PetscCall(SNESDestroy(&solver->snes));
  PetscCall(VecDestroy(&solver->x));
  PetscCall(VecDestroy(&solver->residual));
  PetscFunctionReturn(PETSC_SUCCESS);
}
