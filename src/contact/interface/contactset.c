/* What programs set of contact beside its options, whatever the method. */
#include <contact/parts.h>
#include <sys/units.h>

const char *const ContactConstraints[] = {"gap", "gap_rate", "both", "ContactConstraint", "CONTACT_CONSTRAINT_", NULL};

/*@
  ContactSetConstraint - sets what contact forces keep from becoming negative

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
- constraint - a `ContactConstraint`, `CONTACT_CONSTRAINT_GAP` by default

  Options Database Key:
. -contact_constraint (gap|gap_rate|both) - the constraint

  Level: intermediate

  Reference:
. * - T. A. Laursen, V. Chawla, Design of energy conserving algorithms for frictionless dynamic contact problems, 1997 (gap rate)

.seealso: `Contact`, `ContactGetConstraint()`, `ContactSetFromOptions()`
@*/
PetscErrorCode ContactSetConstraint(Contact contact, ContactConstraint constraint)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveEnum(contact, constraint, 2);
  ContactCheckNotSetUp(contact);
  PetscCheck((int)constraint >= 0 && constraint <= CONTACT_CONSTRAINT_BOTH, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "There is no constraint %d", (int)constraint);
  contact->options.constraint = constraint;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetConstraint - what contact forces keep from becoming negative

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. constraint - see `ContactSetConstraint()`

  Level: intermediate

.seealso: `Contact`, `ContactSetConstraint()`
@*/
PetscErrorCode ContactGetConstraint(Contact contact, ContactConstraint *constraint)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(constraint, 2);
  *constraint = contact->options.constraint;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetStabilization - sets what is done against chatter where contact nodes have mass

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
- stabilization - a `ContactStabilization`, `CONTACT_STABILIZATION_NONE` by default

  Options Database Key:
. -contact_stabilization (none|naive|contact_stabilized) - the stabilization

  Level: intermediate

.seealso: `Contact`, `ContactGetStabilization()`, `ContactSetFromOptions()`
@*/
PetscErrorCode ContactSetStabilization(Contact contact, ContactStabilization stabilization)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveEnum(contact, stabilization, 2);
  ContactCheckNotSetUp(contact);
  PetscCheck((int)stabilization >= 0 && stabilization <= CONTACT_STABILIZATION_CONTACT_STABILIZED, PetscObjectComm((PetscObject)contact),
             PETSC_ERR_ARG_OUTOFRANGE, "There is no stabilization %d", (int)stabilization);
  contact->options.stabilization = stabilization;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetStabilization - what is done against chatter where contact nodes have mass

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. stabilization - see `ContactSetStabilization()`

  Level: intermediate

.seealso: `Contact`, `ContactSetStabilization()`
@*/
PetscErrorCode ContactGetStabilization(Contact contact, ContactStabilization *stabilization)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(stabilization, 2);
  *stabilization = contact->options.stabilization;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetFacing - sets whether pairs of whole bodies keep only the faces that see each other at the start

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
- facing - `PETSC_TRUE` by default; `PETSC_FALSE` where bodies move round each other, as balls do

  Options Database Key:
. -contact_facing (true|false) - the faces that are kept

  Level: intermediate

.seealso: `Contact`, `ContactGetFacing()`, `ContactSetFromOptions()`
@*/
PetscErrorCode ContactSetFacing(Contact contact, PetscBool facing)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveBool(contact, facing, 2);
  ContactCheckNotSetUp(contact);
  contact->options.facing = facing;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetFacing - whether pairs of whole bodies keep only the faces that see each other at the start

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. facing - see `ContactSetFacing()`

  Level: intermediate

.seealso: `Contact`, `ContactSetFacing()`
@*/
PetscErrorCode ContactGetFacing(Contact contact, PetscBool *facing)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(facing, 2);
  *facing = contact->options.facing;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetTolerance - sets the depth that does not yet count as penetration

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
- tolerance - [m]; `PETSC_DEFAULT`: a small part of the size of the problem

  Options Database Key:
. -contact_tolerance g - the depth [m]

  Level: intermediate

.seealso: `Contact`, `ContactGetTolerance()`, `ContactSetFromOptions()`
@*/
PetscErrorCode ContactSetTolerance(Contact contact, PetscReal tolerance)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveReal(contact, tolerance, 2);
  ContactCheckNotSetUp(contact);
  PetscCheck(tolerance >= 0 || tolerance == (PetscReal)PETSC_DEFAULT, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "A contact tolerance of %g%s must not be negative", (double)tolerance, UnitsOf((PetscObject)contact, UNIT_LENGTH));
  contact->options.tolerance = tolerance;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetTolerance - the depth that does not yet count as penetration

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. tolerance - see `ContactSetTolerance()`

  Level: intermediate

.seealso: `Contact`, `ContactSetTolerance()`
@*/
PetscErrorCode ContactGetTolerance(Contact contact, PetscReal *tolerance)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(tolerance, 2);
  *tolerance = contact->options.tolerance;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetTieDistance - sets how far from each other tied surfaces may lie at the start

  Logically Collective

  Input Parameters:
+ contact  - the `Contact`, not yet set up
- distance - gap or overlap up to which a node is tied to the partner [parts of its face; in 1-D of an element], 0.01 by default

  Options Database Key:
. -contact_tie_distance d - the distance [parts of a face]

  Level: intermediate

  Note:
  Under `CONTACT_LAW_TIED`. A node within this distance keeps the gap that it has at the start. A larger overlap, a larger gap of up to
  half a face, and a pair in which nothing is tied are errors of the set-up. Nodes that are farther apart are left alone.

.seealso: `Contact`, `ContactSetLaw()`, `ContactGetTieDistance()`, `ContactSetFromOptions()`
@*/
PetscErrorCode ContactSetTieDistance(Contact contact, PetscReal distance)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveReal(contact, distance, 2);
  ContactCheckNotSetUp(contact);
  PetscCheck(distance > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "A tie distance of %g of a face must be positive", (double)distance);
  contact->options.tie_distance = distance;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetTieDistance - how far from each other tied surfaces may lie at the start

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. distance - see `ContactSetTieDistance()`

  Level: intermediate

.seealso: `Contact`, `ContactSetTieDistance()`
@*/
PetscErrorCode ContactGetTieDistance(Contact contact, PetscReal *distance)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(distance, 2);
  *distance = contact->options.tie_distance;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetBounds - sets how far contact surfaces may move along each other before the rows between them are built again

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
. slip    - in parts of a face, 0.2 by default
- angle   - by which a normal may turn, 0.1 by default [rad]

  Options Database Keys:
+ -contact_slip_bound s  - the slip
- -contact_angle_bound a - the angle

  Level: intermediate

.seealso: `Contact`, `ContactGetBounds()`, `TransferSetBounds()`
@*/
PetscErrorCode ContactSetBounds(Contact contact, PetscReal slip, PetscReal angle)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveReal(contact, slip, 2);
  PetscValidLogicalCollectiveReal(contact, angle, 3);
  ContactCheckNotSetUp(contact);
  PetscCheck(slip > 0 && angle > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "The bounds of slip, %g, and angle, %g, must be positive", (double)slip, (double)angle);
  contact->options.slip_bound  = slip;
  contact->options.angle_bound = angle;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetBounds - how far contact surfaces may move along each other before the rows between them are built again

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameters:
+ slip  - in parts of a face, or `NULL`
- angle - by which a normal may turn [rad], or `NULL`

  Level: intermediate

.seealso: `Contact`, `ContactSetBounds()`
@*/
PetscErrorCode ContactGetBounds(Contact contact, PetscReal *slip, PetscReal *angle)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  if (slip) *slip = contact->options.slip_bound;
  if (angle) *angle = contact->options.angle_bound;
  PetscFunctionReturn(PETSC_SUCCESS);
}
