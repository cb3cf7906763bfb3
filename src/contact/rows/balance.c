/* Whether forces have the same sum along the normals of both sides. */
#include <impakt/private/contactimpl.h>

/* Chords of angles between the normals of the two nodes of a face: from 18 degrees on the face is beside an edge; faces that bend by more
   than 8.6 degrees are too coarse, since their pairs were seen to gain energy (discs of 32 edges), which discs of 48 edges do not */
#define EDGE   0.31
#define COARSE 0.15

/*@
  ContactSetBalance - whether the forces of a pair have the same sum along the normals of both of its surfaces

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
- balance - false by default

  Options Database Key:
. -contact_balance (true|false) - whether they have

  Level: intermediate

  Notes:
  Without friction they should. Where few nodes are in contact the centre of pressure hangs on where the nodes lie, which spins discs that
  hit each other off-centre: by up to 0.06 of the ratio of speed and radius for discs of 64 and 48 edges, and by up to 1.3e-3 with this
  option, 6e-4 where the finer side comes first. It costs energy at the times when rows join and leave, 1e-4 to 3e-3 of it, in proportion to
  the controller step, which should resolve a tenth of the time that the contact takes to spread over a face.

  It means something for rows that follow the surfaces: frictionless pairs of bodies with inertia in two dimensions that are not both
  linear. For others it is an error. A pair should touch in one place.

.seealso: `Contact`, `ContactGetBalance()`, `ContactSetBounds()`
@*/
PetscErrorCode ContactSetBalance(Contact contact, PetscBool balance)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveBool(contact, balance, 2);
  ContactCheckNotSetUp(contact);
  contact->options.balance = balance;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetBalance - whether the forces of a pair have the same sum along the normals of both of its surfaces

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. balance - whether they have

  Level: intermediate

.seealso: `Contact`, `ContactSetBalance()`
@*/
PetscErrorCode ContactGetBalance(Contact contact, PetscBool *balance)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(balance, 2);
  *balance = contact->options.balance;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest bend of a face of one side of a pair, as a chord, edges left out */
static PetscErrorCode GetBend(Contact contact, const ContactPair *pair, PetscInt side, PetscReal *bend)
{
  const SurfaceData *data;

  PetscFunctionBegin;
  *bend = 0;
  PetscCall(SurfaceGetData(pair->surfaces[side], &data));
  for (PetscInt f = 0; f < data->n_faces; f++) {
    PetscReal square = 0;

    for (PetscInt d = 0; d < 2; d++)
      square += PetscSqr(data->normals[3 * data->faces[2 * f] + d] - data->normals[3 * data->faces[2 * f + 1] + d]);
    if (square < PetscSqr(EDGE)) *bend = PetscMax(*bend, PetscSqrtReal(square));
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, bend, 1, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells the transfer of a pair how stiff both bodies are against a force on a node: in two dimensions their modulus times the thickness */
PetscErrorCode ContactSetUpBalance(Contact contact, ContactPair *pair)
{
  PetscReal softness = 0;
  PetscBool linear   = PETSC_TRUE;

  PetscFunctionBegin;
  if (!contact->options.balance) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(contact->dim == 2 && !pair->obstacle && contact->options.law == CONTACT_LAW_FRICTIONLESS,
             PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_balance: pair %s is not a frictionless one of two bodies in two dimensions", pair->name);
  for (PetscInt side = 0; side < 2; side++) {
    PetscReal stiffness, size, thickness, bend;
    PetscBool is_static, is_linear;
    Material  material;

    PetscCall(BodyIsStatic(contact->bodies[pair->body[side]], &is_static));
    PetscCall(BodyGetMaterial(contact->bodies[pair->body[side]], &material));
    PetscCall(MaterialIsLinear(material, &is_linear));
    PetscCheck(!is_static, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_balance: body '%s' of pair %s has no inertia", ((PetscObject)contact->bodies[pair->body[side]])->name, pair->name);
    PetscCall(GetBend(contact, pair, side, &bend));
    PetscCheck(bend <= COARSE, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_balance: faces of body '%s' of pair %s bend by up to %.3g degrees; refine its surface until that is 8.6 or less",
               ((PetscObject)contact->bodies[pair->body[side]])->name, pair->name, (double)(bend * 180 / PETSC_PI));
    linear = (PetscBool)(linear && is_linear);
    PetscCall(BodyGetElementStiffness(contact->bodies[pair->body[side]], &stiffness));
    PetscCall(BodyGetElementSize(contact->bodies[pair->body[side]], &size));
    PetscCall(BodyGetCrossSection(contact->bodies[pair->body[side]], &thickness));
    softness += 1 / (stiffness * size * thickness);
  }
  PetscCheck(!linear, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_balance: the bodies of pair %s are both linear elastic, and their rows do not follow the surfaces", pair->name);
  PetscCall(TransferSetBalance(pair->transfer, 1 / softness));
  PetscFunctionReturn(PETSC_SUCCESS);
}
