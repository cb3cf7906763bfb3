/* What a body tells about itself. */
#include <body/layout/bodyimpl.h>
#include "bodysetup.h"
#include <sys/units.h>

static PetscErrorCode ViewBox(Body body, PetscViewer viewer)
{
  PetscReal box[6];

  PetscFunctionBegin;
  PetscCall(BodyGetAllBoxes(1, &body, box));
  for (PetscInt d = 0; d < body->mesh.dim; d++)
    PetscCall(PetscViewerASCIIPrintf(viewer, "%s %c from %.6g to %.6g", d ? "," : " ", "xyz"[d], (double)box[d], (double)-box[3 + d]));
  PetscCall(PetscViewerASCIIPrintf(viewer, "%s\n", UnitsOf((PetscObject)body, UNIT_LENGTH)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What there is to tell of bodies in two and three dimensions */
static PetscErrorCode ViewSolid(Body body, PetscViewer viewer)
{
  PetscInt count = body->model.element->count;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
  if (body->model.element->composite)
    PetscCall(PetscViewerASCIIPrintf(
        viewer, "  %" PetscInt_FMT " composite elements of %" PetscInt_FMT " nodes, each of %" PetscInt_FMT " cells of shape %s\n", count,
        body->model.element->nodes, body->mesh.cells_of_element, DMPolytopeTypes[body->mesh.cell_shape]));
  else PetscCall(PetscViewerASCIIPrintf(viewer, "  %" PetscInt_FMT " cells of shape %s\n", count, DMPolytopeTypes[body->mesh.cell_shape]));
  if (body->integrator->ops.view) PetscCall((*body->integrator->ops.view)(body, viewer));
  if (body->integrator->needs_stable_step)
    PetscCall(
        PetscViewerASCIIPrintf(viewer, "  stable step %g%s\n", (double)body->time.stable_step, UnitsOf((PetscObject)body, UNIT_TIME)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the massless contact layer has changed */
static PetscErrorCode ViewLayer(Body body, PetscViewer viewer)
{
  const BodyMass *mass = &body->mass;

  PetscFunctionBegin;
  if (mass->extrapolation)
    PetscCall(PetscViewerASCIIPrintf(viewer,
                                     "  massless contact layer: moves as inner nodes do, with weights of up to %g in sum; mass, centre and "
                                     "moments of inertia are kept\n",
                                     (double)mass->extrapolated_by));
  if (mass->n_keep)
    PetscCall(PetscViewerASCIIPrintf(viewer,
                                     "  thin: contact nodes keep their mass, since nodes inside do not span the body around %" PetscInt_FMT
                                     " of %" PetscInt_FMT " nodes at its surface, as at (%g, %g, %g)%s\n",
                                     mass->n_keep, mass->n_contact, (double)mass->keeps_at[0], (double)mass->keeps_at[1],
                                     (double)mass->keeps_at[2], UnitsOf((PetscObject)body, UNIT_LENGTH)));
  if (mass->least_factor == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPrintf(viewer, "  massless contact layer: factor %g to %g on the masses that are left\n",
                                   (double)mass->least_factor, (double)mass->largest_factor));
  if (mass->shift[0] != 0 || mass->shift[1] != 0 || mass->shift[2] != 0)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  massless contact layer: centre of mass moved by (%g, %g, %g)%s\n", (double)mass->shift[0],
                                     (double)mass->shift[1], (double)mass->shift[2], UnitsOf((PetscObject)body, UNIT_LENGTH)));
  if (mass->inertia_error != 0)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  massless contact layer: moments of inertia changed by up to %g %%\n",
                                     100 * (double)mass->inertia_error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyView - prints a body

  Collective

  Input Parameters:
+ body   - the `Body`
- viewer - an ASCII viewer, `NULL` for standard output

  Options Database Key:
. -<body>_body_view - print the body at its set-up, by `PetscObjectViewFromOptions()`

  Level: beginner

.seealso: `Body`, `BodySetUp()`
@*/
PetscErrorCode BodyView(Body body, PetscViewer viewer)
{
  TSType    type;
  PetscInt  dofs;
  PetscBool ascii;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)body), &viewer));
  PetscValidHeaderSpecific(viewer, PETSC_VIEWER_CLASSID, 2);
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetUp() first");
  PetscCall(VecGetSize(body->mesh.positions, &dofs));
  PetscCall(TSGetType(body->time.ts, &type));
  PetscCall(PetscViewerASCIIPrintf(
      viewer, "body %s: %" PetscInt_FMT " degrees of freedom, mass %g%s (%s%s), %s, %" PetscInt_FMT " substep%s of %g%s\n", body->hdr.name,
      dofs, (double)body->mass.total, UnitsOf((PetscObject)body, UNIT_MASS), BodyMassTypes[body->mass.type],
      body->mass.redistribute && (body->rows.global || body->rows.expected)
          ? (body->rows.tied_mass ? ", tied nodes keep theirs" : ", contact layer massless")
          : "",
      type, body->time.shared * body->time.substeps, body->time.shared * body->time.substeps == 1 ? "" : "s", (double)body->time.step,
      UnitsOf((PetscObject)body, UNIT_TIME)));
  PetscCall(ViewBox(body, viewer));
  PetscCall(BodyViewRanks(body, viewer));
  if (body->mesh.dim > 1) PetscCall(ViewSolid(body, viewer));
  PetscCall(BodyViewBlocks(body, viewer));
  PetscCall(ViewLayer(body, viewer));
  PetscCall(BodyViewDamping(body, viewer));
  if (body->springs.n)
    PetscCall(PetscViewerASCIIPrintf(viewer,
                                     "  floating, held by contact or ties alone: artificial springs of %g%s on %" PetscInt_FMT
                                     " displacement%s, moved until they do not pull; motions that nothing drives stay as they are\n",
                                     (double)body->springs.stiffness, UnitsOf((PetscObject)body, UNIT_STIFFNESS), body->springs.n,
                                     body->springs.n == 1 ? "" : "s"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetDM - the mesh

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. dm - its `DMPLEX`, owned by the body; `NULL` until it has one

  Level: intermediate

.seealso: `Body`, `BodySetDM()`
@*/
PetscErrorCode BodyGetDM(Body body, DM *dm)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(dm, 2);
  *dm = body->mesh.dm;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetMaterial - the material

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. material - its `Material`, owned by the body; `NULL` until it has one

  Level: intermediate

.seealso: `Body`, `BodySetMaterial()`
@*/
PetscErrorCode BodyGetMaterial(Body body, Material *material)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(material, 2);
  *material = body->model.material;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetSubsteps - number of substeps from one time that all bodies have in common to the next: of a controller step, or of a part of it

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. substeps - at least 1

  Level: intermediate

.seealso: `Body`
@*/
PetscErrorCode BodyGetSubsteps(Body body, PetscInt *substeps)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(substeps, 2);
  *substeps = body->time.substeps;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetStableStep - the largest step for which central differences are stable, from below

  Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. step - [s]

  Level: intermediate

  Note:
  2 / omega_max with the largest eigenvalue of any element in place of that of the body (Irons and Treharne 1971).

.seealso: `Body`
@*/
PetscErrorCode BodyGetStableStep(Body body, PetscReal *step)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(step, 2);
  PetscCall(BodyComputeStableStep(body));
  *step = body->time.stable_step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetSolution - displacement, velocity and acceleration at the current time

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameters:
+ u - displacement [m], or `NULL`
. v - velocity [m/s], or `NULL`
- a - acceleration [m/s^2], or `NULL`

  Level: intermediate

  Note:
  The vectors are the body's own; they have the layout of the global vectors of its `DM`.

.seealso: `Body`, `BodyGetReferencePositions()`
@*/
PetscErrorCode BodyGetSolution(Body body, Vec *u, Vec *v, Vec *a)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (u) *u = body->state.u;
  if (v) *v = body->state.v;
  if (a) *a = body->state.a;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetReferencePositions - positions of the nodes in the undeformed body

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. positions - [m], owned by the body, laid out as its displacements

  Level: intermediate

.seealso: `Body`, `BodyGetSolution()`
@*/
PetscErrorCode BodyGetReferencePositions(Body body, Vec *positions)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(positions, 2);
  *positions = body->mesh.positions;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyIsStatic - whether the body has no inertia

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. is_static - `PETSC_TRUE` if so

  Level: intermediate

.seealso: `Body`, `TSSTATIC`
@*/
PetscErrorCode BodyIsStatic(Body body, PetscBool *is_static)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(is_static, 2);
  *is_static = body->integrator ? (PetscBool)!body->integrator->has_inertia : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyIsRedistributed - whether the contact nodes of the body are massless

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. redistributed - `PETSC_TRUE` if so, also of a static body, which has no inertia at all

  Level: intermediate

.seealso: `Body`, `BodySetFromOptions()`
@*/
PetscErrorCode BodyIsRedistributed(Body body, PetscBool *redistributed)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(redistributed, 2);
  *redistributed = (PetscBool)(body->mass.redistribute || !body->integrator->has_inertia);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Degrees of freedom of this rank whose displacement is prescribed, ascending; owned by the body */
PetscErrorCode BodyGetHeldDofs(Body body, PetscInt *n, const PetscInt *dofs[])
{
  PetscFunctionBegin;
  *n    = body->held.n;
  *dofs = body->held.dofs;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Newmark's formulas of an implicit body: at the end of a substep v1 = v_u (u1 - u0) + v_v v0 + v_a a0 and a1 = a_u (u1 - u0) + a_v v0 +
   a_a a0. v_u and a_v are in [1/s], v_a in [s], a_u in [1/s^2]. Massless nodes report u1 - u0 over the step and zero instead. */
PetscErrorCode BodyGetNewmark(Body body, PetscReal *v_u, PetscReal *v_v, PetscReal *v_a, PetscReal *a_u, PetscReal *a_v, PetscReal *a_a)
{
  const PetscReal dt = body->time.step, beta = body->integrator->beta, gamma = body->integrator->gamma;
  const PetscBool massless = (PetscBool)(!body->integrator->has_inertia || (body->mass.redistribute && !body->rows.tied_mass));

  PetscFunctionBegin;
  PetscCheck(beta > 0, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONG, "Body '%s' is explicit", body->hdr.name);
  *v_u = massless ? 1 / dt : gamma / (beta * dt);
  *v_v = massless ? 0 : 1 - gamma / beta;
  *v_a = massless ? 0 : dt * (1 - gamma / (2 * beta));
  *a_u = massless ? 0 : 1 / (beta * dt * dt);
  *a_v = massless ? 0 : -1 / (beta * dt);
  *a_a = massless ? 0 : -(1 - 2 * beta) / (2 * beta);
  PetscFunctionReturn(PETSC_SUCCESS);
}
