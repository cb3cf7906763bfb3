/* What programs set of contact beside its options, whatever the method. */
#include <impakt/private/contactimpl.h>

const char *const ContactLaws[]        = {"frictionless", "tied", "bonded", "ContactLaw", "CONTACT_LAW_", NULL};
const char *const ContactConstraints[] = {"gap", "gap_rate", "both", "ContactConstraint", "CONTACT_CONSTRAINT_", NULL};

#define CheckNotSetUp(contact)                                                                                                             \
  PetscCheck(!(contact)->setup, PetscObjectComm((PetscObject)(contact)), PETSC_ERR_ARG_WRONGSTATE, "Call %s() before ContactSetUp()",      \
             PETSC_FUNCTION_NAME)

/*@
  ContactSetLaw - sets what contact surfaces do to each other

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
- law - a `ContactLaw`, `CONTACT_LAW_FRICTIONLESS` by default

  Options Database Key:
. -contact_law (frictionless|tied|bonded) - the law

  Level: beginner

.seealso: `Contact`, `ContactGetLaw()`, `ContactSetFromOptions()`
@*/
PetscErrorCode ContactSetLaw(Contact contact, ContactLaw law)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveEnum(contact, law, 2);
  CheckNotSetUp(contact);
  PetscCheck((int)law >= 0 && law <= CONTACT_LAW_BONDED, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "There is no contact law %d", (int)law);
  contact->options.law = law;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetLaw - what contact surfaces do to each other

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. law - see `ContactSetLaw()`

  Level: beginner

.seealso: `Contact`, `ContactSetLaw()`
@*/
PetscErrorCode ContactGetLaw(Contact contact, ContactLaw *law)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(law, 2);
  *law = contact->options.law;
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
  CheckNotSetUp(contact);
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
  CheckNotSetUp(contact);
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
  CheckNotSetUp(contact);
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
  CheckNotSetUp(contact);
  PetscCheck(tolerance >= 0 || tolerance == (PetscReal)PETSC_DEFAULT, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "A contact tolerance of %g m must not be negative", (double)tolerance);
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
  CheckNotSetUp(contact);
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
  CheckNotSetUp(contact);
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

/*@
  ContactSetAllowUnstable - whether choices that are known to gain energy run all the same

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
- allow   - false by default

  Options Database Key:
. -contact_allow_unstable (true|false) - whether they do

  Level: intermediate

  Note:
  Refused otherwise, where contact nodes have mass: Robin and impedance conditions, and Lagrange multipliers at the end of the step without
a stabilization. To compare with.

.seealso: `Contact`, `ContactGetAllowUnstable()`, `ContactSetEnergyCap()`
@*/
PetscErrorCode ContactSetAllowUnstable(Contact contact, PetscBool allow)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveBool(contact, allow, 2);
  CheckNotSetUp(contact);
  contact->options.allow_unstable = allow;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetAllowUnstable - whether choices that are known to gain energy run all the same

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. allow - whether they do

  Level: intermediate

.seealso: `Contact`, `ContactSetAllowUnstable()`
@*/
PetscErrorCode ContactGetAllowUnstable(Contact contact, PetscBool *allow)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(allow, 2);
  *allow = contact->options.allow_unstable;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetSharedTimes - whether contact holds at all times that all bodies have in common, or at the ends of controller steps alone

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
- shared  - true by default

  Options Database Key:
. -contact_shared_times (true|false) - whether it does

  Level: intermediate

  Note:
  Where the substeps of all bodies have a common divisor, a controller step is made in so many parts, each like a controller step of its own
  for the contact: rows join and leave, and monitors see the end of the last one.

.seealso: `Contact`, `ContactGetSharedTimes()`, `ContactGetParts()`
@*/
PetscErrorCode ContactSetSharedTimes(Contact contact, PetscBool shared)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveBool(contact, shared, 2);
  CheckNotSetUp(contact);
  contact->options.shared_times = shared;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetSharedTimes - whether contact holds at all times that all bodies have in common

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. shared - whether it does

  Level: intermediate

.seealso: `Contact`, `ContactSetSharedTimes()`
@*/
PetscErrorCode ContactGetSharedTimes(Contact contact, PetscBool *shared)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(shared, 2);
  *shared = contact->options.shared_times;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetEnergyCap - whether controller steps in which contact would gain energy are made again, and how much it may gain all the same

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
. cap     - whether steps are made again; true by default
- excess  - part of the system's energy that contact may gain in the whole run, 1e-3 by default

  Options Database Keys:
+ -contact_energy_cap (true|false) - whether steps are made again
- -contact_energy_excess e         - the part

  Level: intermediate

  Notes:
  A controller step that does not resolve the contact gains energy where rows open: with the trapezoidal rule half the force at the start of
  the step times the gap at its end. Beyond what contact has lost before and the excess, such a step is made again, with less force at its
  start on the rows that open, on both bodies.

  The energy is that at the start or, where all starts at rest without strain, the largest one so far.

.seealso: `Contact`, `ContactGetEnergyCap()`, `ContactCounts`
@*/
PetscErrorCode ContactSetEnergyCap(Contact contact, PetscBool cap, PetscReal excess)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveBool(contact, cap, 2);
  PetscValidLogicalCollectiveReal(contact, excess, 3);
  CheckNotSetUp(contact);
  PetscCheck(excess >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE, "The energy excess %g must not be negative",
             (double)excess);
  contact->energy.limits = cap;
  contact->energy.excess = excess;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetEnergyCap - whether controller steps in which contact would gain energy are made again, and how much it may gain all the same

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameters:
+ cap    - whether steps are made again, or `NULL`
- excess - part of the system's energy, or `NULL`

  Level: intermediate

.seealso: `Contact`, `ContactSetEnergyCap()`
@*/
PetscErrorCode ContactGetEnergyCap(Contact contact, PetscBool *cap, PetscReal *excess)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  if (cap) *cap = contact->energy.limits;
  if (excess) *excess = contact->energy.excess;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Pairs find bodies and obstacles by their names */
PetscErrorCode ContactCheckObstacleName(Contact contact, const char name[])
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)contact);
  const char *other;
  PetscBool   same;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(PetscStrcmp(name, ((PetscObject)contact->bodies[b])->name, &same));
    PetscCheck(!same, comm, PETSC_ERR_USER_INPUT, "-obstacles: '%s' is the name of a body already", name);
  }
  for (PetscInt o = 0; o < contact->n_obstacles; o++) {
    PetscCall(ObstacleGetName(contact->obstacles[o], &other));
    PetscCall(PetscStrcmp(name, other, &same));
    PetscCheck(!same, comm, PETSC_ERR_USER_INPUT, "-obstacles: '%s' is the name of an obstacle already", name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactAddObstacle - adds a rigid obstacle that bodies may touch

  Logically Collective

  Input Parameters:
+ contact  - the `Contact`, with its bodies, not yet set up
- obstacle - the `Obstacle`, complete

  Options Database Key:
. -obstacles o,p - names of obstacles, with options of their own

  Level: beginner

  Note:
  A pair of a body and the obstacle makes that body touch it: `ContactAddPair()` with "body:obstacle".

.seealso: `Contact`, `ObstacleCreate()`, `ContactAddPair()`
@*/
PetscErrorCode ContactAddObstacle(Contact contact, Obstacle obstacle)
{
  const char *name;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidHeaderSpecific(obstacle, OBSTACLE_CLASSID, 2);
  CheckNotSetUp(contact);
  PetscCall(ObstacleSetUp(obstacle));
  PetscCall(ObstacleGetName(obstacle, &name));
  PetscCall(ContactCheckObstacleName(contact, name));
  PetscCall(PetscRealloc((size_t)(contact->n_obstacles + 1) * sizeof(*contact->obstacles), &contact->obstacles));
  PetscCall(PetscObjectReference((PetscObject)obstacle));
  contact->obstacles[contact->n_obstacles++] = obstacle;
  PetscFunctionReturn(PETSC_SUCCESS);
}
