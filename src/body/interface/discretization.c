/* A body's mesh, elements and integrator made ready: what can be asked of it before its contact rows are known. */
#include <body/layout/bodyimpl.h>
#include <body/loads/loadsimpl.h>
#include <impakt/private/materialimpl.h>
#include "bodysetup.h"

/* Mass matrices that are not diagonal have to be factored: too dear in two and three dimensions for division in each substep */
PetscErrorCode BodySetUpMassType(Body body)
{
  PetscFunctionBegin;
  if (!body->integrator->deforms) { /* lumped masses have other moments of inertia than the body */
    PetscCheck((int)body->mass.type == PETSC_DECIDE || body->mass.type == BODY_MASS_CONSISTENT, PetscObjectComm((PetscObject)body),
               PETSC_ERR_USER_INPUT, "-%smass_type %s: the mass of a rigid body is that of its mesh; leave the option out",
               ((PetscObject)body)->prefix, BodyMassTypes[body->mass.type]);
    body->mass.type         = BODY_MASS_CONSISTENT;
    body->mass.redistribute = PETSC_FALSE;
    body->mass.near         = PETSC_FALSE;
    body->mass.automatic    = PETSC_FALSE;
  }
  if ((int)body->mass.type == PETSC_DECIDE)
    body->mass.type = body->integrator->divides_by_mass && body->mesh.dim > 1 ? BODY_MASS_LUMPED : BODY_MASS_AVERAGED;
  if (!body->integrator->has_inertia) body->mass.redistribute = PETSC_FALSE; /* there is none to move */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nodes and elements, from mesh and material; nothing where they are there already */
PetscErrorCode BodySetUpMesh(Body body)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)body);

  PetscFunctionBegin;
  if (body->mesh.positions) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(body->mesh.dm, comm, PETSC_ERR_ARG_WRONGSTATE, "Body '%s' has no mesh: call BodySetDM() or BodySetFromOptions() first",
             body->hdr.name);
  PetscCall(BodySetUpBlocks(body, NULL));
  PetscCheck(body->model.material, comm, PETSC_ERR_ARG_WRONGSTATE,
             "Body '%s' has no material: call BodySetMaterial() or BodySetFromOptions() first", body->hdr.name);
  PetscCall(MaterialSetUp(body->model.material));
  for (PetscInt k = 0; k < body->model.blocks.n; k++) PetscCall(MaterialSetUp(body->model.blocks.materials[k]));
  PetscCall(BodyIsLinear(body, &body->model.linear));
  PetscCall(BodySetUpCells(body));
  PetscCall(BodySetUpLayout(body));
  PetscCall(BodyComputeBlockMass(body));
  PetscCall(BodyNoteSurfaceMaterial(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the loads hold, where the rest of the body looks for it */
PetscErrorCode BodyNoteHeld(Body body)
{
  PetscFunctionBegin;
  body->held.n    = body->loads ? body->loads->n_held : 0;
  body->held.dofs = body->loads ? body->loads->held_dofs : NULL;
  body->held.any  = (PetscBool)(body->held.n > 0);
  PetscCall(BodyAnyRank(body, &body->held.any));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first part of BodySetUp(): elements, numbering and integrator, which contact needs before rows are made. Mesh and elements are
   fixed then; parameters of the integrator, mass, loads and initial state are not. Collective. */
PetscErrorCode BodySetUpDiscretization(Body body)
{
  PetscFunctionBegin;
  if (body->setup) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodySetUpMesh(body));
  if (body->mesh.touches_axis && !body->loads) {
    PetscCall(BodyLoadsHoldAxis(body));
    PetscCall(BodyNoteHeld(body));
  }
  PetscCall(BodySetUpIntegrator(body));
  PetscCall(BodySetUpMassType(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
