/* What contact tells of itself. */
#include <contact/laws/pairlaws.h>

/*@
  ContactGetNumPairs - number of contact pairs

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. n - their number

  Level: intermediate

.seealso: `Contact`, `ContactGetPair()`
@*/
PetscErrorCode ContactGetNumPairs(Contact contact, PetscInt *n)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(n, 2);
  *n = contact->neighbours.come_and_go ? contact->neighbours.told.n : contact->n_pairs;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ContactGetPair - name and bodies of a pair

  Not Collective

  Input Parameters:
+ contact - the `Contact`
- pair    - 0 to the number of pairs - 1

  Output Parameters:
+ name      - as it was given, or `NULL`
. dirichlet - body that is named first, or `NULL`
- neumann   - body that is named second, `NULL` for an obstacle; or `NULL`

  Level: intermediate

  Note:
  Of many pairs that the program has chosen those alone have rows whose bodies are near. Then a pair is what all other bodies together do to
a body, `body:others`, of which that body is both the first and the second, or a body and an obstacle: first all of the former, in the order
of the bodies.

  The first body takes displacements and has the contact rows, the second one takes tractions, unless `-contact_rows` has turned that
  round: see `ContactGetPairRowSide()`.

.seealso: `Contact`, `ContactGetNumPairs()`, `ContactGetPairRowSide()`
@*/
PetscErrorCode ContactGetPair(Contact contact, PetscInt pair, const char *name[], Body *dirichlet, Body *neumann)
{
  const ContactPair *told;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  ContactCheckPair(contact, pair);
  told = ContactToldPair(contact, pair);
  if (name) *name = told->name;
  if (dirichlet) *dirichlet = contact->bodies[told->body[told->turned ? 1 : 0]];
  if (neumann) *neumann = told->obstacle ? NULL : contact->bodies[told->body[told->turned ? 0 : 1]];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of a pair, each or `NULL`: whether the user has named it, not the program chosen it as one of all bodies with each other; number of the
   obstacle that it has for its second side, -1 where both sides are bodies; mean outward normal of its first body, 3 numbers, zeros beyond
   the space dimension, and of pairs that come and go */
PetscErrorCode ContactGetPairTraits(Contact contact, PetscInt pair, PetscBool *named, PetscInt *obstacle, PetscReal normal[])
{
  const ContactPair *told;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  ContactCheckPair(contact, pair);
  told = ContactToldPair(contact, pair);
  if (named) *named = (PetscBool)!told->chosen;
  if (obstacle) *obstacle = told->obstacle ? ContactPairPartner(contact, told) - contact->n_bodies : -1;
  for (PetscInt d = 0; d < 3 && normal; d++) normal[d] = ContactPairSign(told) * told->normal[d];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetTraits - what laws and options let contact do

  Not Collective

  Input Parameter:
. contact - the `Contact`, set up

  Output Parameter:
. traits - see `ContactTraits`

  Level: intermediate

.seealso: `Contact`, `ContactGetPairLaw()`, `ContactGetCounts()`
@*/
PetscErrorCode ContactGetTraits(Contact contact, ContactTraits *traits)
{
  const ContactOptions *options = &contact->options;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(traits, 2);
  *traits       = (ContactTraits){.friction         = ContactAnyPairHas(contact, CONTACT_LAW_FRICTION),
                                  .glue             = ContactAnyPairHas(contact, CONTACT_LAW_GLUE),
                                  .breaks           = ContactGlueBreaks(contact),
                                  .parts            = contact->parts,
                                  .cuts             = (PetscBool)!contact->attempt.moves_start,
                                  .separation       = options->separation,
                                  .balance          = options->balance,
                                  .energy_cap       = options->energy_cap,
                                  .energy_excess    = options->energy_excess,
                                  .energy_tolerance = options->energy_tolerance,
                                  .unlimited        = contact->energy.takes ? NULL : contact->energy.unlimited,
                                  .not_always       = contact->energy.not_always,
                                  .takes            = contact->energy.takes};
  traits->pulls = (PetscBool)(traits->friction || traits->glue || ContactAnyPairHas(contact, CONTACT_LAW_TIED) ||
                              ContactAnyPairHas(contact, CONTACT_LAW_BONDED));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetCounts - sweeps, changes of the active set, and what contact has done to energy

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. counts - see `ContactCounts`

  Level: intermediate

.seealso: `Contact`
@*/
PetscErrorCode ContactGetCounts(Contact contact, ContactCounts *counts)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(counts, 2);
  *counts               = contact->counts;
  counts->spring_energy = contact->resultants.penalty_energy;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    if (contact->friction.pair_loss) counts->friction_loss += contact->friction.pair_loss[p];
    if (contact->friction.pair_driven) counts->obstacle_work += contact->friction.pair_driven[p];
  }
  for (PetscInt p = 0; p < contact->neighbours.told.n; p++) {
    counts->friction_loss += contact->neighbours.told.gone[p].friction_loss;
    counts->obstacle_work += contact->neighbours.told.gone[p].obstacle_work;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Mean position [m] and velocity [m/s] of the contact nodes of each body in its first pair: 3 numbers each. Collective. */
PetscErrorCode ContactGetBodyTraces(Contact contact, PetscReal positions[], PetscReal velocities[])
{
  const PetscInt n    = contact->n_bodies;
  PetscReal     *sums = contact->work.traces;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(positions, 2);
  PetscAssertPointer(velocities, 3);
  PetscCall(PetscArrayzero(sums, 8 * n));
  for (PetscInt s = 0; s < contact->n_surfaces; s++) {
    PetscReal         *of = sums + 8 * contact->surfaces[s].body;
    const SurfaceData *data;
    Vec                u, v;

    if (!contact->surfaces[s].first) continue;
    PetscCall(SurfaceGetData(contact->surfaces[s].surface, &data));
    PetscCall(BodyGetSolution(contact->bodies[contact->surfaces[s].body], &u, &v, NULL));
    PetscCall(ContactLookAtNodes(data, u, of, NULL, NULL));
    PetscCall(ContactLookAtNodes(data, v, of + 4, NULL, NULL));
    for (PetscInt i = 0; i < 3 * data->n_owned; i++) of[i % 3] += data->reference[i];
  }
  PetscCall(ContactReduce(contact, 8 * n, MPIU_REAL, MPIU_SUM, sums));
  for (PetscInt b = 0; b < n; b++, sums += 8)
    for (PetscInt d = 0; d < 3; d++) {
      positions[3 * b + d]  = sums[d] / PetscMax(sums[3], 1);
      velocities[3 * b + d] = sums[4 + d] / PetscMax(sums[7], 1);
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the bodies are, for messages [s] */
PetscErrorCode ContactGetTime(Contact contact, PetscReal *time)
{
  TS ts;

  PetscFunctionBegin;
  PetscCall(BodyGetTS(contact->bodies[0], &ts));
  PetscCall(TSGetTime(ts, time));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many faces of the surfaces of all pairs, of both sides, and rows of all pairs lie on this rank */
PetscErrorCode ContactGetShare(Contact contact, PetscInt *facets, PetscInt *rows)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(facets, 2);
  PetscAssertPointer(rows, 3);
  *facets = *rows = 0;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    for (PetscInt side = 0; side < 2; side++) {
      const SurfaceData *data;

      if (!pair->surfaces[side]) continue;
      PetscCall(SurfaceGetData(pair->surfaces[side], &data));
      *facets += data->n_faces;
    }
    *rows += pair->end - pair->begin;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
