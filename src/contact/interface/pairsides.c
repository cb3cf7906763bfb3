/* Which body of a pair takes displacements where the user leaves that to the program, and the order of the bodies in a sweep. */
#include <contact/parts.h>
#include <impakt/private/bodymesh.h>
#include <impakt/private/bodystep.h>

/* Mean elements of two bodies are alike if the ratio of their edges is above this, so that round-off does not choose the sides */
#define ALIKE 0.999

/* Time that a plane wave takes through an element of a body [s], and the impedance of these waves [N s/m^3] */
PetscErrorCode ContactGetTransit(Body body, PetscReal size, PetscReal *transit, PetscReal *impedance)
{
  PetscReal density, cross_section;
  Material  material;

  PetscFunctionBegin;
  PetscCall(BodyGetSurfaceMaterial(body, &material));
  PetscCall(MaterialGetDensity(material, &density));
  PetscCall(BodyGetScale(body, BODY_IMPEDANCE, impedance));
  PetscCall(BodyGetScale(body, BODY_CROSS_SECTION, &cross_section));
  *impedance /= cross_section;
  *transit = *impedance > 0 ? size * density / *impedance : 0; /* h / c, c = Z / rho */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Expected substeps of explicit bodies. A step still to be chosen lies between wave times of both sides, see ContactGetResolvedStep(). */
static PetscErrorCode EstimateSubsteps(Contact contact, const PetscReal size[], ContactPreference preferences[])
{
  PetscReal *transit, step, least = PETSC_MAX_REAL, most = 0, impedance;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(contact->n_bodies, &transit));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(ContactGetTransit(contact->bodies[b], size[b], &transit[b], &impedance));
    if (!preferences[b].is_explicit || !(transit[b] > 0)) continue;
    least = PetscMin(least, transit[b]);
    most  = PetscMax(most, transit[b]);
  }
  PetscCall(BodyGetControllerStep(contact->bodies[0], &step));
  if (!(step > 0)) step = PetscSqrtReal(least) * PetscSqrtReal(most);
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    PetscCall(BodyEstimateSubsteps(contact->bodies[b], transit[b], step, &preferences[b].substeps));
  PetscCall(PetscFree(transit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The preferences of all bodies as they are now; owned by the contact. Sizes are compared with the largest that is alike, not two by two:
   of three bodies each could be alike to the next, and the first not to the last, so that the order could go round in a circle. */
PetscErrorCode ContactGetPreferences(Contact contact, const ContactPreference *all[])
{
  ContactPreference *preferences;
  PetscReal         *size, level = PETSC_MAX_REAL;
  PetscInt          *ascending;

  PetscFunctionBegin;
  if (!contact->neighbours.preferences) PetscCall(PetscMalloc1(contact->n_bodies, &contact->neighbours.preferences));
  *all = preferences = contact->neighbours.preferences;
  PetscCall(PetscMalloc2(contact->n_bodies, &size, contact->n_bodies, &ascending));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(BodyIsExplicit(contact->bodies[b], &preferences[b].is_explicit));
    PetscCall(BodyIsRigid(contact->bodies[b], &preferences[b].is_rigid));
    PetscCall(BodyGetScale(contact->bodies[b], BODY_ELEMENT_SIZE, &size[b]));
    ascending[b] = b;
  }
  PetscCall(PetscSortRealWithPermutation(contact->n_bodies, size, ascending));
  for (PetscInt k = contact->n_bodies - 1; k >= 0; k--) {
    if (size[ascending[k]] < ALIKE * level) level = size[ascending[k]];
    preferences[ascending[k]].size = level;
  }
  PetscCall(EstimateSubsteps(contact, size, preferences));
  PetscCall(PetscFree2(size, ascending));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the second of two bodies is to take displacements. A rigid body never does. An implicit body does rather than an explicit one. Of
   two explicit bodies the one with fewer substeps does: the compliance of rows on a body with substeps is found by integrating that body
   under a unit force on each, so that the fewer such rows the better. If both are alike in that, the one with the finer mesh: of two discs
   without friction that hit each other off-centre the coarser one as the first side has 1.5 to 5 times the spin. If both are alike in that
   too, the one that is named first does. */
PetscBool ContactChooseSides(const ContactPreference *a, const ContactPreference *b, const char **why)
{
  if (a->is_rigid != b->is_rigid) {
    *why = "the rigid body takes forces";
    return a->is_rigid;
  }
  if (a->is_explicit != b->is_explicit) {
    *why = "implicit body first";
    return a->is_explicit;
  }
  if (a->substeps != b->substeps) {
    *why = "fewer substeps first";
    return (PetscBool)(b->substeps < a->substeps);
  }
  *why = a->size == b->size ? "alike, as named" : "finer mesh first";
  return (PetscBool)(b->size < a->size);
}

/* As many bodies as can be with each Dirichlet side before its Neumann side. Methods that prescribe nothing have the user's order. */
static PetscErrorCode FindOrder(Contact contact, PetscInt *done)
{
  PetscBool moved = PETSC_TRUE, *placed;

  PetscFunctionBegin;
  *done = 0;
  PetscCall(PetscCalloc1(contact->n_bodies, &placed));
  while (*done < contact->n_bodies && moved) {
    moved = PETSC_FALSE;
    for (PetscInt b = 0; b < contact->n_bodies; b++) {
      PetscBool ready = (PetscBool)!placed[b];

      for (PetscInt p = 0; p < contact->n_pairs; p++) {
        const PetscInt *body = contact->pairs[p].body;

        if (contact->prescribes && body[1] == b && body[0] != b && !placed[body[0]]) ready = PETSC_FALSE;
      }
      if (!ready) continue;
      contact->order[(*done)++] = b;
      placed[b] = moved = PETSC_TRUE;
    }
  }
  PetscCall(PetscFree(placed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static int ComparePreferences(const void *a, const void *b, void *context)
{
  const ContactPreference *preferences = (const ContactPreference *)context;
  const PetscInt           i = *(const PetscInt *)a, j = *(const PetscInt *)b;
  const char              *why;

  if (i == j) return 0;
  return ContactChooseSides(&preferences[PetscMin(i, j)], &preferences[PetscMax(i, j)], &why) ? (i < j ? 1 : -1) : (i < j ? -1 : 1);
}

/* Bodies in an order in which every Dirichlet side comes before its Neumann side; where pairs come and go, in which any two of them would
   have their sides */
PetscErrorCode ContactOrderBodies(Contact contact)
{
  ContactNeighbours *neighbours = &contact->neighbours;
  PetscInt           done;

  PetscFunctionBegin;
  if (neighbours->come_and_go) {
    for (PetscInt b = 0; b < contact->n_bodies; b++) contact->order[b] = b;
    PetscCall(PetscTimSort(contact->n_bodies, contact->order, sizeof(PetscInt), ComparePreferences, neighbours->preferences));
    for (PetscInt k = 0; k < contact->n_bodies; k++) neighbours->place[contact->order[k]] = k;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(FindOrder(contact, &done));
  PetscCheck(done == contact->n_bodies, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_pairs: the pairs form a circle, each body waiting for the reaction of the one before; turn one pair round (b:a "
             "instead of a:b, or another side in -contact_rows)");
  PetscFunctionReturn(PETSC_SUCCESS);
}
