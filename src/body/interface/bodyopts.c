/* A body from its options, and its initial state. */
#include <body/layout/bodyimpl.h>
#include <impakt/private/mesh.h>
#include <sys/optionvalues.h>
#include "bodysetup.h"

/* Every body named by -bodies must be described somewhere */
static PetscErrorCode CheckDescribed(Body body)
{
  const char *prefix = ((PetscObject)body)->prefix, *mesh[] = {"-dm_plex_filename", "-dm_plex_box_faces", "-dm_plex_dim"};
  PetscBool   found = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < 3 && !found; i++) PetscCall(PetscOptionsHasName(NULL, prefix, mesh[i], &found));
  PetscCheck(found, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "Body '%s', named by -bodies, has no mesh: give -%sdm_plex_dim and -%sdm_plex_box_faces, or -%sdm_plex_filename",
             body->hdr.name, prefix, prefix, prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateMesh(Body body)
{
  PetscFunctionBegin;
  PetscCall(MeshCreateOnRanks(PetscObjectComm((PetscObject)body), ((PetscObject)body)->prefix, body->hdr.name, body->mesh.n_ranks,
                              body->mesh.ranks, &body->mesh.dm));
  PetscCall(DMGetCoordinateDim(body->mesh.dm, &body->mesh.dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadMaterial(Body body)
{
  PetscBool rigid;

  PetscFunctionBegin;
  if (body->model.material) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MaterialCreate(PetscObjectComm((PetscObject)body), &body->model.material));
  PetscCall(PetscObjectSetOptionsPrefix((PetscObject)body->model.material, ((PetscObject)body)->prefix));
  PetscCall(BodyAsksForRigid(body, &rigid));
  if (rigid) { /* any modulus does where none is given */
    PetscCall(MaterialSetType(body->model.material, MATERIAL_LINEAR_ELASTIC));
    PetscCall(MaterialSetYoungsModulus(body->model.material, 1));
  }
  PetscCall(MaterialSetFromOptions(body->model.material));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadMass(Body body)
{
  BodyMassType type;
  PetscBool    redistribute = body->mass.redistribute, near = body->mass.near, automatic = body->mass.automatic, given;
  char         value[16] = "", name[256];

  PetscFunctionBegin;
  PetscCall(BodySetUpMassType(body));
  type = body->mass.type;
  PetscObjectOptionsBegin((PetscObject)body);
  PetscCall(PetscOptionsEnum("-mass_type", "Mass matrix", "BodySetMassType", BodyMassTypes, (PetscEnum)type, (PetscEnum *)&type, NULL));
  PetscCall(PetscOptionsString("-mass_redistribute", "Move the mass of contact nodes to their inner neighbours", "BodySetMassRedistribute",
                               near        ? "near"
                               : automatic ? "auto"
                                           : PetscBools[redistribute],
                               value, sizeof(value), &given));
  if (given) {
    PetscCall(PetscStrcasecmp(value, "near", &near));
    PetscCall(PetscStrcasecmp(value, "auto", &automatic));
    redistribute = PETSC_TRUE;
    if (!near && !automatic && value[0]) {
      PetscCall(PetscSNPrintf(name, sizeof(name), "%smass_redistribute", ((PetscObject)body)->prefix));
      PetscCall(OptionsReadSwitch(PetscObjectComm((PetscObject)body), name, ", near or auto", value, &redistribute));
    }
  }
  PetscCall(PetscOptionsEnum("-mass_moments", "What is kept when mass moves", "BodySetFromOptions", BodyMassMomentsNames,
                             (PetscEnum)body->mass.moments, (PetscEnum *)&body->mass.moments, NULL));
  PetscOptionsEnd();
  PetscCall(BodySetMassType(body, type));
  PetscCheck(!given || !redistribute || automatic || body->integrator->deforms, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%smass_redistribute %s: body '%s' is rigid, and its nodes keep their mass; leave the option out",
             ((PetscObject)body)->prefix, value, body->hdr.name);
  if (given) {
    if (!automatic) PetscCall(BodySetMassRedistribute(body, redistribute));
    if (automatic) body->mass.redistribute = PETSC_TRUE;
    body->mass.near      = near;
    body->mass.automatic = automatic;
  }
  PetscCall(BodySetUpMassType(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads what only bodies with inertia have that deform, so that it is an unused option of others */
static PetscErrorCode ReadDamping(Body body)
{
  const char *prefix = ((PetscObject)body)->prefix;
  PetscReal   mass, stiffness;
  PetscBool   set[2];

  PetscFunctionBegin;
  if (!body->integrator->has_inertia || !body->integrator->deforms) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetDamping(body, &mass, &stiffness));
  PetscObjectOptionsBegin((PetscObject)body);
  PetscCall(PetscOptionsReal("-damping_mass", "Rayleigh damping: forces against the velocity in parts of the mass [1/s]", "BodySetDamping",
                             mass, &mass, &set[0]));
  PetscCall(PetscOptionsReal("-damping_stiffness", "Rayleigh damping: forces against the rate of strain in parts of the stiffness [s]",
                             "BodySetDamping", stiffness, &stiffness, &set[1]));
  PetscOptionsEnd();
  PetscCheck(mass >= 0 && !PetscIsInfReal(mass), PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%sdamping_mass %g 1/s must not be negative: it takes energy", prefix, (double)mass);
  PetscCheck(stiffness >= 0 && !PetscIsInfReal(stiffness), PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%sdamping_stiffness %g s must not be negative: it takes energy", prefix, (double)stiffness);
  if (set[0] || set[1]) PetscCall(BodySetDamping(body, mass, stiffness));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads what only static bodies have, so that it is an unused option of others */
static PetscErrorCode ReadStatic(Body body)
{
  PetscBool set;

  PetscFunctionBegin;
  if (body->integrator->has_inertia) PetscFunctionReturn(PETSC_SUCCESS);
  PetscObjectOptionsBegin((PetscObject)body);
  PetscCall(PetscOptionsReal("-artificial_stiffness", "Stiffness of springs where contact or ties alone hold the body, in parts of its own",
                             "BodySetFromOptions", body->springs.part, &body->springs.part, &set));
  PetscOptionsEnd();
  PetscCheck(!set || (body->springs.part > 0 && body->springs.part < PETSC_INFINITY), PetscObjectComm((PetscObject)body),
             PETSC_ERR_ARG_OUTOFRANGE, "-%sartificial_stiffness %g must be positive", ((PetscObject)body)->prefix,
             (double)body->springs.part);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* -<body>_ts_time_step takes a word where PETSc's own option of that name takes a number */
static PetscErrorCode ReadTimeStep(Body body, PetscBool *hidden)
{
  const char *prefix = ((PetscObject)body)->prefix;
  char        text[64], full[160];
  PetscBool   set, is_auto;

  PetscFunctionBegin;
  *hidden = PETSC_FALSE;
  PetscCall(PetscOptionsGetString(NULL, prefix, "-ts_time_step", text, sizeof(text), &set));
  if (!set) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscStrcasecmp(text, "auto", &is_auto));
  if (is_auto) {
    PetscCall(BodySetTimeStep(body, PETSC_DETERMINE));
    PetscCall(PetscSNPrintf(full, sizeof(full), "-%sts_time_step", prefix));
    PetscCall(PetscOptionsClearValue(NULL, full));
    *hidden = PETSC_TRUE;
  } else {
    PetscReal step = 0;

    PetscCall(PetscOptionsGetReal(NULL, prefix, "-ts_time_step", &step, NULL));
    PetscCheck(step > 0, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT, "-%sts_time_step %s: a time step must be positive",
               prefix, text);
    PetscCall(BodySetTimeStep(body, step));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Type, substep and parameters; what the program has chosen holds where the options are silent */
static PetscErrorCode ReadTime(Body body)
{
  const char *prefix = ((PetscObject)body)->prefix;
  char        type[64], full[160];
  PetscBool   hidden, set, rigid;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetString(NULL, prefix, "-ts_type", type, sizeof(type), &set));
  PetscCall(BodyReadRigid(body, set ? type : NULL, &rigid));
  if (rigid) set = PETSC_FALSE;
  if (set || !body->time.ts) PetscCall(BodySetTSType(body, set ? type : TSALPHA2));
  PetscCall(TSSetDM(body->time.ts, body->mesh.dm));
  PetscCall(ReadTimeStep(body, &hidden));
  PetscCall(TSSetFromOptions(body->time.ts));
  if (hidden) {
    PetscCall(PetscSNPrintf(full, sizeof(full), "-%sts_time_step", prefix));
    PetscCall(PetscOptionsSetValue(NULL, full, "auto"));
    PetscCall(PetscOptionsHasName(NULL, prefix, "-ts_time_step", NULL)); /* it has been used */
  }
  PetscCall(BodySetUpIntegrator(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetFromOptions - mesh, material, mass, integrator and initial state from the options that begin with the body's name

  Collective

  Input Parameter:
. body - the `Body`

  Options Database Keys:
+ -<body>_dm_plex_...        - the mesh: `DMPLEX`'s own options
. -<body>_<block>_...        - the material of a block of the mesh, see `BodySetBlockMaterial()`
. -<body>_ts_alpha_...       - parameters of `TSALPHA2`, default Newmark's trapezoidal rule
- -<body>_<setter without Set> - all others, with defaults in options/README.md, which `impakt -help` prints too

  Level: beginner

  Note:
  Mesh and material that the program has set before (`BodySetDM()`, `BodySetMaterial()`) are left as they are, and so is what else it has
  set and the options do not name. Functions that look at the mesh, such as `BodyAddTraction()`, come after this one.

  Moments are kept by a smooth factor on the masses that are left, linear for the centre, quadratic for the moments of inertia, which moves
  mass from the middle of a body to its ends: waves in bars of 25 elements with massless ends have 0.4 % less force there. Choose `centre`
  where waves matter and nothing turns.

.seealso: `Body`, `BodySetDM()`, `BodySetMaterial()`, `BodySetTSType()`, `BodySetMassType()`, `BodySetUp()`
@*/
PetscErrorCode BodySetFromOptions(Body body)
{
  MPI_Comm  comm = PetscObjectComm((PetscObject)body);
  PetscBool from_file;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(!body->mesh.positions, comm, PETSC_ERR_ARG_WRONGSTATE,
             "Body '%s' has its options, or its loads, already: call BodySetFromOptions() once, and before functions that look at the mesh",
             body->hdr.name);
  PetscCall(BodyReadRanks(body));
  if (!body->mesh.dm) PetscCall(CheckDescribed(body));
  PetscCall(PetscOptionsHasName(NULL, ((PetscObject)body)->prefix, "-dm_plex_filename", &from_file));
  if (!body->mesh.dm && from_file) PetscCall(CreateMesh(body));
  if (body->mesh.dm) {
    PetscBool own;

    PetscCall(BodyReadBlocks(body));
    PetscCall(BodySetUpBlocks(body, &own));
    if (own) PetscCall(ReadMaterial(body));
    PetscCall(BodySetUpBlocks(body, NULL));
  } else PetscCall(ReadMaterial(body));
  if (!body->mesh.dm) PetscCall(CreateMesh(body));
  PetscCall(BodySetUpCells(body));
  PetscCall(ElementSetFromOptions(body->model.element));
  PetscCall(BodySetUpMesh(body));
  PetscCall(ReadTime(body));
  PetscCall(ReadMass(body));
  PetscCall(ReadStatic(body));
  PetscCall(ReadDamping(body));
  PetscCall(BodyReadPoints(body));
  PetscCall(BodyLoadsSetFromOptions(body));
  PetscCall(BodyNoteHeld(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  BodySetInitialState - sets displacement and velocity at the start, and the acceleration that belongs to them

  Collective

  Input Parameters:
+ body     - the `Body`, set up, before its first step
. function - (dim, x, u, v, ctx): displacement [m] and velocity [m/s] of the node with reference position x; `NULL` for the
             constants of the options
- ctx      - its context

  Level: intermediate

.seealso: `Body`, `BodySetUp()`
@*/
PetscErrorCode BodySetInitialState(Body body, PetscErrorCode (*function)(PetscInt, const PetscReal[], PetscScalar[], PetscScalar[], void *),
                                   void *ctx)
{
  PetscScalar *u, *v;
  PetscReal    norm;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->setup && !body->state.step, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
             "Call after BodySetUp(), before the first step");
  PetscCall(BodyLoadsInitialState(body, body->state.u, body->state.v));
  if (function) {
    PetscCall(VecGetArray(body->state.u, &u));
    PetscCall(VecGetArray(body->state.v, &v));
    for (PetscInt node = 0; node < body->mesh.owned_nodes; node++)
      PetscCall((*function)(body->mesh.dim, body->mesh.coordinates + node * body->mesh.dim, u + node * body->mesh.dim,
                            v + node * body->mesh.dim, ctx));
    PetscCall(VecRestoreArray(body->state.v, &v));
    PetscCall(VecRestoreArray(body->state.u, &u));
  }
  PetscCall(BodyPrescribeHeld(body, body->state.time, body->state.u, body->state.v, NULL));
  if (body->integrator->ops.start) PetscCall((*body->integrator->ops.start)(body));
  PetscCall(BodyComputeInternalForce(body, body->state.u, body->state.internal_force));
  PetscCall(VecNorm(body->state.internal_force, NORM_2, &norm));
  StepFailureClear(&body->failure);
  if (PetscIsInfOrNanReal(norm) && !body->model.linear) PetscCall(BodyNoteInverted(body, PETSC_FALSE));
  PetscCall(StepFailureRaise(PetscObjectComm((PetscObject)body), &body->failure));
  PetscCall(BodyStartUnderForces(body, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}
