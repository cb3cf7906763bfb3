/* Coulomb's law: the force across the normal is at most a coefficient times the normal force. The coefficient may fall with the speed of
   sliding. */
#include "friction.h"
#include "rowlaw.h"
#include <sys/units.h>

/* Of nodes of a pair that stick */
static PetscReal GetStatic(Contact contact, const ContactPair *pair)
{
  return pair->own_friction ? pair->friction : contact->options.friction;
}

static PetscErrorCode SetUp(Contact contact, void *data)
{
  const PetscReal kinetic = contact->options.friction_kinetic;

  PetscFunctionBegin;
  (void)data;
  contact->friction.law.ignores_speed = (PetscBool)(kinetic < 0);
  if (contact->neighbours.come_and_go) { /* pairs that come later have the same coefficient */
    PetscCheck(contact->options.friction >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_law coulomb needs a coefficient of friction: set -contact_friction mu for all pairs");
    PetscCheck(kinetic <= contact->options.friction, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_friction_kinetic %g is above the coefficient %g with which nodes stick", (double)kinetic,
               (double)contact->options.friction);
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    if (pair->law != CONTACT_LAW_FRICTION) continue;
    PetscCheck(GetStatic(contact, pair) >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_law coulomb needs the coefficient of friction of the pair %s: set -contact_friction mu for all pairs, or "
               "-contact_friction_%s mu for this one",
               pair->name, pair->name);
    PetscCheck(kinetic <= GetStatic(contact, pair), PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_friction_kinetic %g is above the coefficient %g with which nodes of the pair %s stick", (double)kinetic,
               (double)GetStatic(contact, pair), pair->name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The coefficient of the node that has the row, from the speed at which it has slid in the last step */
static void GetLimit(Contact contact, const void *data, PetscInt row, PetscReal speed, PetscReal *cohesion, PetscReal *coefficient)
{
  const PetscReal mu = GetStatic(contact, &contact->pairs[contact->rows.pair[row]]), kinetic = contact->options.friction_kinetic;

  (void)data;
  *cohesion    = 0;
  *coefficient = kinetic < 0 ? mu : kinetic + (mu - kinetic) * PetscExpReal(-contact->options.friction_decay * speed);
}

static PetscErrorCode View(Contact contact, const void *data, PetscViewer viewer)
{

  PetscFunctionBegin;
  (void)data;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (contact->pairs[p].law == CONTACT_LAW_FRICTION)
      PetscCall(PetscViewerASCIIPrintf(viewer, "  coefficient of friction of %s: %g\n", contact->pairs[p].name,
                                       (double)GetStatic(contact, &contact->pairs[p])));
  if (contact->options.friction_kinetic >= 0)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  falls to %g as exp(-%g%s times the speed of sliding)\n",
                                     (double)contact->options.friction_kinetic, (double)contact->options.friction_decay,
                                     UnitsOf((PetscObject)contact, UNIT_SLOWNESS)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactLawCreate_Coulomb(Contact contact, ContactFrictionLaw *law)
{
  PetscFunctionBegin;
  (void)contact;
  law->setup    = SetUp;
  law->getlimit = GetLimit;
  law->view     = View;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By how much the forces on the n rows of a node, that along its normal first, miss the law where these open by `opened` [m]: de Saxce's
   residual. With the slip s, v = (g + mu |s|, s) and the compliance c of the normal row that is c |f - P(f - v/c)|, P being the projection
   onto the cone of forces that the law admits without cohesion. */
PetscReal CoulombGetResidual(PetscInt n, PetscReal mu, PetscReal c, const PetscScalar force[], const PetscScalar opened[])
{
  PetscReal slip = 0, f[ROW_LAW_ROWS] = {0}, t[ROW_LAW_ROWS] = {0}, size = 0, normal, bound, square;

  for (PetscInt k = 1; k < n; k++) slip += PetscSqr(PetscRealPart(opened[k]));
  slip = PetscSqrtReal(slip);
  for (PetscInt k = 0; k < n; k++) {
    f[k] = PetscRealPart(force[k]);
    t[k] = f[k] - (PetscRealPart(opened[k]) + (k ? 0 : mu * slip)) / c;
    if (k) size += PetscSqr(t[k]);
  }
  size   = PetscSqrtReal(size);
  normal = t[0];
  bound  = size;
  if (size > mu * t[0]) { /* outside the cone: onto its side, or its tip */
    normal = PetscMax((t[0] + mu * size) / (1 + mu * mu), 0);
    bound  = mu * normal;
  }
  square = PetscSqr(f[0] - normal);
  for (PetscInt k = 1; k < n; k++) square += PetscSqr(f[k] - (size > 0 ? bound / size * t[k] : 0));
  return c * PetscSqrtReal(square);
}
