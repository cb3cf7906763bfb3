/* What becomes of the mass of contact nodes where that is left to the body (-<body>_mass_redistribute auto). */
#include <body/layout/bodyimpl.h>

/* Where the contact nodes have no more than this part of the mass, and factors on the masses that are left leave moments of inertia off by
   less than this part, factors are chosen before extrapolated velocities; in explicit bodies that are thin, if they are above GOOD_FACTOR.
   Bars of 6 and 8 elements across have their first frequencies within 1.1 and 0.8 % then, bars of 3 elements within 8 %. Behind the front
   of a wave in a bar of 200 elements the contact force scatters by 1e-5 with a factor, by 2.5e-3 with extrapolated velocities. */
#define SMALL_LAYER  0.2
#define GOOD_FACTOR  (2. / 3.)
#define GOOD_INERTIA 1e-3
/* Elements without inner nodes may lose this part of the mass to a factor, which puts it elsewhere */
#define MOST_LOST 0.05
/* Explicit bodies that are thin keep their mass even where inner nodes span the body around those in contact, since massless layers cost
   most of their steps: a bracket of two elements took twelve times as long. So do implicit nonlinear bodies that are thin nearly
   everywhere, whose sweeps are steps of the body: a bracket of 3036 neo-Hookean tet10 took 43 s for a step, and takes 13 s; a linear
   one took the same with both. Bodies with fewer vertices on their boundary cost little. */
#define FEW_EXPLICIT 30
#define FEW_IMPLICIT 300
#define NEARLY_ALL   (2. / 3.)

static PetscErrorCode GetLayerPart(Body body, PetscReal *part)
{
  const PetscInt n       = body->model.element->nodes;
  PetscReal      sums[2] = {0};
  PetscScalar    lumped[ELEMENT_MAX_NODES], consistent[ELEMENT_MAX_NODES * ELEMENT_MAX_NODES];

  PetscFunctionBegin;
  for (PetscInt e = 0; e < body->model.element->count; e++) {
    PetscCall(BodyGetElementMassParts(body, e, PETSC_FALSE, lumped, consistent));
    for (PetscInt a = 0; a < n; a++) {
      PetscReal mass = lumped[a];

      for (PetscInt b = 0; b < n; b++) mass += consistent[a * n + b];
      sums[0] += mass;
      if (body->layer.contains[body->mesh.connectivity[e * n + a]]) sums[1] += mass;
    }
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  *part = sums[1] / sums[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The part of the whole mass that contact nodes have before any of it moves. Collective. */
PetscErrorCode BodyGetContactPart(Body body, PetscReal *part)
{
  PetscFunctionBegin;
  PetscCall(BodySetUpDiscretization(body));
  PetscCall(GetLayerPart(body, part));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DropFactor(BodyMass *mass)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(mass->factor));
  mass->moved        = PETSC_FALSE;
  mass->least_factor = mass->largest_factor = 0;
  mass->inertia_error = mass->turn_error = 0;
  PetscCall(PetscArrayzero(mass->shift, 3));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves mass, if a factor on the rest keeps centre and inertia, or what -<body>_mass_moments wants. `good`: the factor is near one, too */
static PetscErrorCode TryFactor(Body body, PetscBool *good)
{
  BodyMass       *mass = &body->mass;
  const PetscBool less = (PetscBool)(mass->moments != BODY_MASS_INERTIA);
  PetscReal       lost;
  PetscBool       bad;

  PetscFunctionBegin;
  PetscCall(BodyFindMassFactor(body, &lost));
  bad = (PetscBool)(lost > MOST_LOST);
  for (PetscInt d = 0; d < 3 && !less; d++) bad = (PetscBool)(bad || mass->shift[d] != 0);
  if (!less && mass->inertia_error > GOOD_INERTIA) bad = PETSC_TRUE;
  mass->moved = (PetscBool)!bad;
  if (bad) PetscCall(DropFactor(mass));
  *good = (PetscBool)(mass->moved && (less || mass->least_factor >= GOOD_FACTOR));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the body is thin: around more than `part` of the nodes of its boundary that nothing holds inner nodes do not span it */
static PetscErrorCode FindThin(Body body, PetscInt n, const PetscInt boundary[], PetscReal part)
{
  PetscBool *contains = body->layer.contains;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(body->mesh.local_nodes, &body->layer.contains));
  PetscCall(BodyMarkNodes(body, n, boundary, body->layer.contains));
  for (PetscInt i = 0; i < body->held.n; i++) body->layer.contains[body->held.dofs[i] / body->mesh.dim] = PETSC_FALSE;
  PetscCall(BodyFindExtrapolation(body));
  PetscCall(PetscFree(body->layer.contains));
  body->layer.contains = contains;
  if (body->mass.n_keep <= part * body->mass.n_contact) body->mass.n_keep = 0;
  PetscCall(MatDestroy(&body->mass.extrapolation));
  body->mass.extrapolated_by = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Chooses what becomes of the mass of contact nodes under `-<body>_mass_redistribute auto`; calls beyond the first cost nothing. Where the
   nodes have little mass and a factor on the remaining masses keeps centre and inertia to 1e-3, the mass moves to inner neighbours: a
   lumped mass stays diagonal. Else velocities are extrapolated, see extrapolation.c, if inner nodes span the body around each node. Else
   the body is `thin`, and BodyKeepMass() is to follow. `boundary`: its vertices there, or none. Collective. */
PetscErrorCode BodyChooseMass(Body body, PetscInt n, const PetscInt boundary[], PetscBool *thin)
{
  BodyMass *mass  = &body->mass;
  PetscInt  n_all = n;
  PetscReal part;
  PetscBool good = PETSC_FALSE, is_explicit;

  PetscFunctionBegin;
  PetscCall(BodySetUpDiscretization(body));
  is_explicit = body->integrator->divides_by_mass;
  if (mass->automatic && mass->redistribute && body->integrator->has_inertia && !mass->decided) {
    mass->decided = PETSC_TRUE;
    PetscCall(GetLayerPart(body, &part));
    if (part > 0 && (part <= SMALL_LAYER || mass->moments != BODY_MASS_INERTIA)) PetscCall(TryFactor(body, &good));
    if (part > 0 && !good && (is_explicit || !body->model.linear)) {
      PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &n_all, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
      if (n_all > (is_explicit ? FEW_EXPLICIT : FEW_IMPLICIT)) PetscCall(FindThin(body, n, boundary, is_explicit ? 0 : NEARLY_ALL));
    }
    if (mass->n_keep) PetscCall(DropFactor(mass));
    else if (part > 0 && !mass->moved) PetscCall(BodyFindExtrapolation(body));
  }
  *thin = (PetscBool)(mass->n_keep > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether what becomes of the mass of contact nodes is left to the body, which then wants to know its boundary, see BodyChooseMass() */
PetscBool BodyChoosesMass(Body body)
{
  return body->mass.automatic;
}

/* Lets contact nodes keep their mass under `-<body>_mass_redistribute auto`, after BodyChooseMass(). Collective. */
PetscErrorCode BodyKeepMass(Body body)
{
  BodyMass *mass = &body->mass;

  PetscFunctionBegin;
  BodyCheckNotSetUp(body);
  if (!mass->automatic || !mass->redistribute) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DropFactor(mass));
  PetscCall(MatDestroy(&mass->extrapolation));
  mass->redistribute = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
