/* A preconditioner P of S where it is only multiplied with: pair by pair that of linear bodies with mass (interfacejoint.c), or that of the
   massless layer of the Dirichlet side (interfacelayer.c). */
#include "interfacejoint.h"
#include "interfacelayer.h"

struct _n_InterfacePreconditioner {
  InterfaceJoint  joint; /* NULL: of no pair */
  PetscInt        n;
  InterfaceLayer *layers;
};

/* The pairs of which a body is the Dirichlet side with a massless layer, and that are not joint */
static PetscErrorCode AddLayer(InterfaceOperator op, InterfacePreconditioner p, PetscInt b)
{
  const Contact   contact = op->contact;
  InterfaceLayer *layer   = &p->layers[p->n];
  PetscBool       any     = PETSC_FALSE;
  Mat             K;

  PetscFunctionBegin;
  PetscCall(BodyGetLayerMatrices(contact->bodies[b], &K, NULL));
  if (!K || !op->feels[b]) PetscFunctionReturn(PETSC_SUCCESS);
  layer->body = b;
  PetscCall(PetscCalloc1(contact->n_pairs, &layer->has));
  for (PetscInt k = 0; k < contact->n_pairs; k++)
    if (contact->pairs[k].body[contact->pairs[k].dirichlet] == b && !InterfaceJointHasPair(p->joint, k)) layer->has[k] = any = PETSC_TRUE;
  if (any) p->n++;
  else PetscCall(InterfaceLayerReset(layer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* NULL where there is none for any pair */
PetscErrorCode InterfacePreconditionerCreate(InterfaceOperator op, InterfacePreconditioner *preconditioner)
{
  const Contact           contact = op->contact;
  InterfacePreconditioner p;

  PetscFunctionBegin;
  *preconditioner = NULL;
  PetscCall(PetscNew(&p));
  PetscCall(PetscCalloc1(contact->n_bodies, &p->layers));
  PetscCall(InterfaceJointCreate(op, &p->joint));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(AddLayer(op, p, b));
  if (p->n || p->joint) *preconditioner = p;
  else PetscCall(InterfacePreconditionerDestroy(&p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode InterfacePreconditionerDestroy(InterfacePreconditioner *preconditioner)
{
  PetscFunctionBegin;
  if (!*preconditioner) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(InterfaceJointDestroy(&(*preconditioner)->joint));
  for (PetscInt k = 0; k < (*preconditioner)->n; k++) PetscCall(InterfaceLayerReset(&(*preconditioner)->layers[k]));
  PetscCall(PetscFree((*preconditioner)->layers));
  PetscCall(PetscFree(*preconditioner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether P is there, for some row */
PetscBool InterfaceOperatorHasPreconditioner(InterfaceOperator op)
{
  return (PetscBool)(op->preconditioner != NULL);
}

/* From now on P is for the rows of this rank that are `in`, with the matrices of the bodies as they are */
PetscErrorCode InterfaceOperatorChoose(InterfaceOperator op, const PetscBool in[])
{
  InterfacePreconditioner p = op->preconditioner;

  PetscFunctionBegin;
  PetscCall(InterfaceOperatorFactor(op, in, NULL));
  if (!p) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(InterfaceJointUpdate(op, p->joint));
  for (PetscInt k = 0; k < p->n; k++) PetscCall(InterfaceLayerUpdate(op, &p->layers[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = P x on these; elsewhere, and where the Dirichlet side has no part in P, y stays as it comes in */
PetscErrorCode InterfaceOperatorPrecondition(InterfaceOperator op, const PetscScalar x[], PetscScalar y[])
{
  InterfacePreconditioner p = op->preconditioner;

  PetscFunctionBegin;
  if (!p) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(InterfaceJointApply(op, p->joint, x, y));
  for (PetscInt k = 0; k < p->n; k++) PetscCall(InterfaceLayerApply(op, &p->layers[k], x, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}
