/* What a contact problem prints of itself. */
#include <contact/parts.h>
#include <sys/units.h>

#define MOST_NAMED 50
/* Up to so many pairs are printed with their distances; of more, those that the user has named, and the nearest one */
#define MOST_DISTANCES 10

/* How far apart surfaces of pairs are: a mesh in other units or places shows here. Of many automatic pairs the nearest alone. */
static PetscErrorCode ViewDistances(Contact contact, PetscViewer viewer)
{
  const PetscInt    n       = PetscMin(contact->n_pairs, MOST_NAMED);
  PetscInt          nearest = 0;
  const char       *between = "";
  ContactPairState *states  = contact->resultants.states;

  PetscFunctionBegin;
  PetscCall(ContactComputePairStates(contact, states));
  PetscCall(PetscViewerASCIIPrintf(viewer, "  smallest distance%s:", n > MOST_DISTANCES ? " (of chosen pairs that of the nearest)" : ""));
  for (PetscInt p = 1; p < n; p++)
    if (states[p].gap < states[nearest].gap) nearest = p;
  for (PetscInt p = 0; p < n; p++) {
    const ContactPair *pair = &contact->pairs[p];

    if (n > MOST_DISTANCES && pair->chosen && p != nearest) continue;
    PetscCall(PetscViewerASCIIPrintf(viewer, "%s %s ", between, pair->name));
    between = ",";
    if (states[p].gap < CONTACT_NO_GAP)
      PetscCall(PetscViewerASCIIPrintf(viewer, "%.4g%s", (double)states[p].gap, UnitsOf((PetscObject)contact, UNIT_LENGTH)));
    else PetscCall(PetscViewerASCIIPrintf(viewer, "nothing lies opposite"));
  }
  PetscCall(PetscViewerASCIIPrintf(viewer, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactView - prints pairs and method

  Collective

  Input Parameters:
+ contact - the `Contact`
- viewer  - an ASCII viewer, `NULL` for standard output

  Options Database Key:
. -contact_view - print pairs and method at the end of the set-up

  Level: beginner

.seealso: `Contact`
@*/
PetscErrorCode ContactView(Contact contact, PetscViewer viewer)
{
  PetscBool ascii;
  PetscInt  nodes = 0;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)contact), &viewer));
  PetscValidHeaderSpecific(viewer, PETSC_VIEWER_CLASSID, 2);
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(PETSC_SUCCESS);
  if (!contact->n_pairs) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPrintf(viewer, "contact %s:", ((PetscObject)contact)->type_name));
  for (PetscInt p = 0; p < PetscMin(contact->n_pairs, MOST_NAMED); p++) {
    const ContactPair *pair = &contact->pairs[p];

    PetscCall(PetscViewerASCIIPrintf(viewer, pair->why ? " %s (sides chosen: %s)" : " %s", pair->name, pair->why));
    if (pair->turned) PetscCall(PetscViewerASCIIPrintf(viewer, " (rows on %s)", ((PetscObject)contact->bodies[pair->body[0]])->name));
  }
  if (contact->n_pairs > MOST_NAMED)
    PetscCall(PetscViewerASCIIPrintf(viewer, " and %" PetscInt_FMT " more pairs", contact->n_pairs - MOST_NAMED));
  for (PetscInt p = 0; p < contact->n_pairs && contact->setup; p++) /* nodes of several pairs count once in each */
    nodes += (contact->pairs[p].end - contact->pairs[p].begin) / contact->pairs[p].components;
  PetscCall(ContactReduce(contact, 1, MPIU_INT, MPI_SUM, &nodes));
  PetscCall(PetscViewerASCIIPrintf(viewer, ", %" PetscInt_FMT " contact node%s\n", nodes, nodes == 1 ? "" : "s"));
  if (contact->setup) PetscCall(ViewDistances(contact, viewer));
  if (contact->neighbours.stay[0])
    PetscCall(PetscViewerASCIIPrintf(viewer, "  all pairs have rows all the time, also of bodies that are far apart, since %s\n",
                                     contact->neighbours.stay));
  if (contact->options.law != CONTACT_LAW_FRICTIONLESS)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  law %s\n", ContactNameLaw(contact, NULL)));
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (contact->pairs[p].own_law)
      PetscCall(PetscViewerASCIIPrintf(viewer, "  law of %s: %s\n", contact->pairs[p].name, ContactNameLaw(contact, &contact->pairs[p])));
  if (!contact->options.separation)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  surfaces that have met slide on each other and do not come apart\n"));
  if (contact->options.constraint != CONTACT_CONSTRAINT_GAP)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  constraint %s\n", ContactConstraints[contact->options.constraint]));
  if (contact->options.stabilization != CONTACT_STABILIZATION_NONE)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  stabilization %s\n", ContactStabilizations[contact->options.stabilization]));
  if (contact->options.balance)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  forces balanced along the normals of both sides%s\n",
                                     contact->options.auto_balance ? " (-contact_balance auto)" : ""));
  if (contact->energy.unlimited) PetscCall(PetscViewerASCIIPrintf(viewer, "  energy not limited: %s\n", contact->energy.unlimited));
  else if (contact->options.energy_cap)
    PetscCall(PetscViewerASCIIPrintf(
        viewer, "  energy limited: contact may gain %g of it in all%s%s\n", (double)contact->options.energy_excess,
        contact->energy.not_always ? "; not in every step, since " : "", contact->energy.not_always ? contact->energy.not_always : ""));
  if (contact->rows.n_all) PetscTryTypeMethod(contact, view, viewer); /* without rows the method has not been set up */
  PetscFunctionReturn(PETSC_SUCCESS);
}
