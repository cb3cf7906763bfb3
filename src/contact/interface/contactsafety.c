/* What keeps the energy of a run: steps made again, contact at all shared times, refusals of what is known to be unstable. */
#include <contact/parts.h>

/* Line searches that want the slope of the residual's norm multiply with the Jacobian, of which there is only what divides by it */
PetscErrorCode ContactRefuseSlopes(Contact contact, const char prefix[], SNESLineSearch line_search)
{
  SNESLineSearchType type;
  PetscBool          slope;

  PetscFunctionBegin;
  PetscCall(SNESLineSearchGetType(line_search, &type));
  PetscCall(PetscStrcmpAny(type, &slope, SNESLINESEARCHBT, SNESLINESEARCHNLEQERR, ""));
  PetscCheck(!slope, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-%ssnes_linesearch_type %s needs products with the Jacobian, which this iteration does not have; choose none, secant or cp",
             prefix, type);
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
  Refused otherwise, where contact nodes have mass: Robin and impedance conditions, Lagrange multipliers at the end of the step without a
  stabilization, and in two and three dimensions `-schwarz_traction reaction` over several substeps. Robin and impedance conditions are
  refused as well where two bodies make unequal substeps. To compare with.

.seealso: `Contact`, `ContactGetAllowUnstable()`, `ContactSetEnergyCap()`
@*/
PetscErrorCode ContactSetAllowUnstable(Contact contact, PetscBool allow)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveBool(contact, allow, 2);
  ContactCheckNotSetUp(contact);
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
  ContactCheckNotSetUp(contact);
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
  ContactGetUnlimitedReason - why steps may gain energy at contact in spite of `ContactSetEnergyCap()`

  Not Collective

  Input Parameter:
. contact - the `Contact`, set up

  Output Parameters:
+ always - the reason why no step is kept from it, or `NULL`, as where contact never gains energy
- some   - the reason why some steps are not, or `NULL`

  Level: intermediate

.seealso: `Contact`, `ContactGetLossReason()`, `ContactSetEnergyCap()`, `ContactView()`
@*/
PetscErrorCode ContactGetUnlimitedReason(Contact contact, const char *always[], const char *some[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  if (always) *always = contact->energy.takes ? NULL : contact->energy.unlimited;
  if (some) *some = contact->energy.not_always;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetLossReason - what energy contact takes by its rule, which lets it gain none

  Not Collective

  Input Parameter:
. contact - the `Contact`, set up

  Output Parameter:
. reason - what it takes, and what makes that less, as the part of a sentence; or `NULL`

  Level: intermediate

.seealso: `Contact`, `CONTACT_FORCE`, `ContactGetUnlimitedReason()`
@*/
PetscErrorCode ContactGetLossReason(Contact contact, const char *reason[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(reason, 2);
  *reason = contact->energy.takes;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetBalancedStart - whether massless nodes are brought into balance in the first state

  Logically Collective

  Input Parameters:
+ contact  - the `Contact`, not yet set up
- balanced - true by default

  Options Database Key:
. -contact_balanced_start (true|false) - whether they are

  Level: intermediate

  Notes:
  Initial displacements and loads need not leave massless nodes in balance. These have no inertia: at the end of the first step they would
  be in balance all the same, at a loss of energy. So they are moved there before the run starts, under the forces of ties and closed
  contacts, and what is compared with later is that state. All other nodes start as they have been told.

  Where a body has no inertia, all bodies start as they have been told.

.seealso: `Contact`, `ContactGetBalancedStart()`, `ContactCheckInitialGap()`, `BodySetMassRedistribute()`
@*/
PetscErrorCode ContactSetBalancedStart(Contact contact, PetscBool balanced)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveBool(contact, balanced, 2);
  ContactCheckNotSetUp(contact);
  contact->options.balanced_start = balanced;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetBalancedStart - whether massless nodes are brought into balance in the first state

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. balanced - whether they are

  Level: intermediate

.seealso: `Contact`, `ContactSetBalancedStart()`
@*/
PetscErrorCode ContactGetBalancedStart(Contact contact, PetscBool *balanced)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(balanced, 2);
  *balanced = contact->options.balanced_start;
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
  ContactCheckNotSetUp(contact);
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

/* Where in a substep the inertia and the forces of a body are in balance: alpha_m and alpha_f of the generalised-alpha method, 1 and 1 for
   others */
static PetscErrorCode GetStage(Body body, PetscReal stage[2])
{
  PetscBool newmark;
  TS        ts;

  PetscFunctionBegin;
  stage[0] = stage[1] = 1;
  PetscCall(BodyGetTS(body, &ts));
  PetscCall(PetscObjectTypeCompare((PetscObject)ts, TSALPHA2, &newmark));
  if (!newmark) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TSAlpha2GetParams(ts, &stage[0], &stage[1], NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Says for which pairs forces act at different times of a step on both bodies, or, of ties whose displacements the method prescribes on
   nodes with mass, at times inside a step */
PetscErrorCode ContactWarnOfStages(Contact contact, PetscBool of_ties)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const char        *name;
    PetscReal          stage[2][2];
    PetscBool          differ, between;

    if (pair->obstacle) continue;
    for (PetscInt side = 0; side < 2; side++) PetscCall(GetStage(contact->bodies[pair->body[side]], stage[side]));
    differ  = (PetscBool)(stage[0][0] != stage[1][0] || stage[0][1] != stage[1][1]);
    between = (PetscBool)(pair->keeps_mass && !(stage[0][0] == stage[0][1] && (stage[0][0] == 1 || stage[0][0] == 0.5)));
    if (of_ties ? differ || !between : !differ) continue;
    PetscCall(ContactGetPair(contact, p, &name, NULL, NULL));
    PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)contact), stderr,
                           "impakt: warning: %s: -<body>_ts_alpha_... lets forces act at %s, so that energy and momentum at contact have "
                           "errors of first order in the step; %s\n",
                           name, of_ties ? "times inside a step on tied nodes with mass" : "different times of a step on both bodies",
                           of_ties ? "choose -schwarz_transmission robin, or a radius of 1" : "give both bodies the same parameters"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
