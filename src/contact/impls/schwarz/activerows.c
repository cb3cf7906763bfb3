/* How the active set of Schwarz's method changes from round to round. */
#include "schwarzimpl.h"

/* Whether the active set is another than that of the last round, after rows of shared nodes have been put in order, of which some may be
   let go again; notes the forces of rows that leave */
PetscErrorCode SchwarzTakeActiveSet(Contact contact, PetscBool *changed)
{
  const Schwarz   *schwarz = (const Schwarz *)contact->data;
  const PetscBool *before  = RoundsLast(&schwarz->rounds);
  int              any     = 0;

  PetscFunctionBegin;
  ContactArrangeShared(contact);
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscInt  p   = contact->rows.pair[i];
    const PetscBool was = (PetscBool)(before && before[i]);
    PetscInt        partner;

    if (contact->end.active[i] == was) continue;
    any = 1;
    if (!was || !contact->release.fades) continue;
    PetscCall(TraceGetSizes(contact->traces[NeumannBody(&contact->pairs[p])].displacement, NULL, &partner));
    PetscCall(ContactReleaseRow(contact, i, (PetscBool)(contact->pairs[p].by_force ? partner > 1 : schwarz->levels[p] > 1)));
  }
  PetscCall(ContactOr(contact, &any));
  *changed = (PetscBool)(any > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that penetrate join, rows that are pulled leave, or the first of them alone */
PetscErrorCode SchwarzUpdateActiveSet(Contact contact, PetscBool *changed)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  /* while sweeps run on the compliance, the gaps of rows that it does not know are not told */
  schwarz->rounds.known = schwarz->step == STEP_CONDENSED ? schwarz->known : NULL;
  if (schwarz->rounds.early) PetscCall(SchwarzTakeMargins(contact));
  PetscCall(RoundsChange(&schwarz->rounds));
  PetscCall(SchwarzTakeActiveSet(contact, changed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Another rule for an active set that has been seen before */
PetscErrorCode SchwarzBreakCycle(Contact contact, PetscBool *flips)
{
  Schwarz        *schwarz = (Schwarz *)contact->data;
  const PetscBool single  = schwarz->rounds.single;

  PetscFunctionBegin;
  PetscCall(RoundsBreakCycle(&schwarz->rounds, flips));
  if (*flips || single) ContactArrangeShared(contact);
  PetscFunctionReturn(PETSC_SUCCESS);
}
