/* What is done against chatter, whatever the method: the naive stabilisation. */
#include <contact/parts.h>
#include <sys/citations.h>
#include <impakt/private/bodyforces.h>

const char *const ContactStabilizations[] = {"none", "naive", "contact_stabilized", "ContactStabilization", "CONTACT_STABILIZATION_", NULL};

/* Ends with an error if the chosen stabilisation would have no effect, and makes room for it */
PetscErrorCode ContactSetUpStabilization(Contact contact)
{
  MPI_Comm  comm = PetscObjectComm((PetscObject)contact);
  PetscBool lagrange;

  PetscFunctionBegin;
  if (contact->options.stabilization == CONTACT_STABILIZATION_NONE) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(!ContactHasRigid(contact), comm, PETSC_ERR_USER_INPUT,
             "-contact_stabilization changes accelerations of contact nodes, and those of a rigid body have none of their own; leave it at "
             "none");
  PetscCheck(ContactHasMass(contact, PETSC_FALSE), comm, PETSC_ERR_USER_INPUT,
             "-contact_stabilization %s acts on contact nodes with mass, and all are massless here, which do not chatter; leave it at "
             "none, or set -<body>_mass_redistribute false",
             ContactStabilizations[contact->options.stabilization]);
  PetscCall(PetscObjectTypeCompare((PetscObject)contact, CONTACT_LAGRANGE, &lagrange));
  if (contact->options.stabilization == CONTACT_STABILIZATION_CONTACT_STABILIZED)
    PetscCheck(lagrange, comm, PETSC_ERR_USER_INPUT,
               "-contact_stabilization contact_stabilized works with -contact_type lagrange and implicit bodies only, not with %s; choose "
               "these, or -contact_stabilization naive",
               ((PetscObject)contact)->type_name);
  contact->energy.unlimited = "a stabilization changes accelerations or forces between steps";
  if (contact->options.stabilization == CONTACT_STABILIZATION_CONTACT_STABILIZED) PetscCall(ImpaktCite(CITE_CONTACT_STABILIZED));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The naive stabilisation (Hoy, Tezaur, Mota, section 5): zero acceleration of nodes in contact after the step */
PetscErrorCode ContactStabilize(Contact contact)
{
  PetscBool in_contact;

  PetscFunctionBegin;
  PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
  if (!in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const ContactBodyRows *of = &contact->body_rows[b];

    for (PetscInt k = 0; k < of->n; k++) contact->work.flags[k] = contact->end.active[of->rows[k]];
    PetscCall(BodyClearAcceleration(contact->bodies[b], contact->work.flags));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
