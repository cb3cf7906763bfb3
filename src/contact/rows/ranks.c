/* What all ranks agree on. */
#include <contact/parts.h>
#include <petscsf.h>

/* A flag becomes true where it is on any rank */
PetscErrorCode ContactOr(Contact contact, PetscBool *flag)
{
  PetscFunctionBegin;
  PetscCall(ContactReduce(contact, 1, MPI_C_BOOL, MPI_LOR, flag));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of each of n numbers the sum over ranks, the least or the largest, in its place. Collective. */
PetscErrorCode ContactReduce(Contact contact, PetscInt n, MPI_Datatype type, MPI_Op op, void *numbers)
{
  PetscFunctionBegin;
  if (contact->ranks.size > 1 && n)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, numbers, (PetscMPIInt)n, type, op, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers the rows of all ranks, rank by rank, and prepares their gathering. Collective. */
PetscErrorCode ContactShareRows(Contact contact)
{
  MPI_Comm      comm  = PetscObjectComm((PetscObject)contact);
  ContactRanks *ranks = &contact->ranks;

  PetscFunctionBegin;
  PetscCall(PetscLayoutCreateFromSizes(comm, contact->rows.n, PETSC_DETERMINE, 1, &ranks->layout));
  PetscCall(PetscLayoutGetRange(ranks->layout, &contact->rows.begin, NULL));
  PetscCall(PetscLayoutGetSize(ranks->layout, &contact->rows.n_all));
  PetscCall(PetscSFCreate(comm, &ranks->gather));
  PetscCall(PetscSFSetGraphWithPattern(ranks->gather, ranks->layout, PETSCSF_PATTERN_ALLGATHER));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A number of each row of all ranks, from those of this rank's rows. Collective. */
PetscErrorCode ContactGatherRows(Contact contact, MPI_Datatype type, const void *mine, void *all)
{
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Type_size(type, &size));
  if (contact->ranks.size == 1) PetscCall(PetscMemcpy(all, mine, (size_t)contact->rows.n * (size_t)size));
  else {
    PetscCall(PetscSFBcastBegin(contact->ranks.gather, type, mine, all, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(contact->ranks.gather, type, mine, all, MPI_REPLACE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of numbers of n rows, by their numbers among those of all ranks, those of this rank's rows; others stay as they are */
void ContactPickRows(Contact contact, PetscInt n, const PetscInt rows[], const PetscScalar of_rows[], PetscReal mine[])
{
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt i = rows[k] - contact->rows.begin;

    if (i >= 0 && i < contact->rows.n) mine[i] = PetscRealPart(of_rows[k]);
  }
}

/* Which rank has all of a body, or a negative number; and whether all of its rows are there too. The same on every rank. */
PetscErrorCode ContactIsAtHome(Contact contact, PetscInt b, PetscMPIInt *rank, PetscBool *at_home)
{
  const ContactBodyRows *of = &contact->body_rows[b];
  const PetscInt        *first;

  PetscFunctionBegin;
  PetscCall(BodyGetMeshRank(contact->bodies[b], rank));
  *at_home = (PetscBool)(*rank >= 0);
  if (*rank < 0 || !of->n_all) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLayoutGetRanges(contact->ranks.layout, &first));
  *at_home = (PetscBool)(of->all[0] >= first[*rank] && of->all[of->n_all - 1] < first[*rank + 1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The order in which bodies are integrated that do not wait for each other: those first that take a word of several ranks, since these wait
   for each other there. In any other order a rank would wait for another one that still has bodies of its own to integrate before. */
PetscErrorCode ContactOrderVisits(Contact contact)
{
  PetscInt n = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(contact->n_bodies, &contact->ranks.visits));
  for (PetscInt pass = 0; pass < 2; pass++)
    for (PetscInt b = 0; b < contact->n_bodies; b++) {
      PetscMPIInt rank;
      PetscBool   at_home = PETSC_TRUE;

      if (contact->ranks.size > 1) PetscCall(ContactIsAtHome(contact, b, &rank, &at_home));
      if (at_home == (PetscBool)pass) contact->ranks.visits[n++] = b;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which bodies pairs connect, directly or by others: to each one the first of them */
void ContactFindSets(Contact contact, PetscInt set[])
{
  for (PetscInt b = 0; b < contact->n_bodies; b++) set[b] = contact->neighbours.come_and_go ? 0 : b; /* then any two may come near */
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (!contact->pairs[p].obstacle) ContactJoinGroups(set, contact->pairs[p].body[0], contact->pairs[p].body[1]);
  for (PetscInt b = 0; b < contact->n_bodies; b++) set[b] = ContactGroupOf(set, b);
}
