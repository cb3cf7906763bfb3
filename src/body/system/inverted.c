/*
   Elements of a linear body that are inside out: its material knows no limit, and would go on with them.

   They are looked for where they can be at all. At a point where det(I + H) <= 0, for the displacement gradient H, the strain has an
   eigenvalue of -1 or less, since x.(I + H) x > 0 otherwise; an element with such a corner stores at least 1/2 E V c. E is Young's modulus,
   V the volume, and c = 1 where strains are constant, 4^-dim where they have as many modes along each axis. As long as the whole body
   stores less than that, which the energy balance knows anyway, no element is looked at. That holds for fully integrated elements; those of
   other formulations are looked at whenever the body stores energy.
*/
#include "corners.h"

/* The Jacobian at a corner, as moved by u; NULL: undeformed */
static PetscReal Jacobian(PetscInt dim, const PetscInt nodes[], PetscInt corner, const PetscInt ends[3], const PetscReal x[],
                          const PetscScalar u[])
{
  PetscReal e[3][3] = {{0}};

  for (PetscInt i = 0; i < dim; i++)
    for (PetscInt d = 0; d < dim; d++) {
      const PetscInt to = nodes[ends[i]] * dim + d, from = nodes[corner] * dim + d;

      e[i][d] = x[to] - x[from] + (u ? PetscRealPart(u[to] - u[from]) : 0);
    }
  if (dim == 1) return e[0][0];
  if (dim == 2) return e[0][0] * e[1][1] - e[0][1] * e[1][0];
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) + e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/* The energy that the body must store before an element of this rank can be inside out; infinity where nobody can tell [J]. Volumes are
   those of the corners' Jacobians, scaled so that their sum is the volume of the body, with thickness and cross section. */
static PetscErrorCode ComputeLeastEnergy(Body body, const Corners *shape, PetscReal *energy)
{
  const PetscInt n   = body->mesh.cell_nodes;
  PetscReal      sum = 0, least = PETSC_MAX_REAL, modulus, density;
  const char    *formulation;
  PetscBool      full;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < body->mesh.n_cells; e++)
    for (PetscInt c = 0; c < shape->corners; c++) {
      const PetscReal jacobian = Jacobian(body->mesh.dim, body->mesh.cell_connectivity + e * n, c, shape->ends[c], body->mesh.coordinates,
                                          NULL);

      sum += jacobian / (PetscReal)shape->corners;
      if (jacobian > 0) least = PetscMin(least, jacobian);
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPIU_REAL, MPIU_MIN, PetscObjectComm((PetscObject)body)));
  PetscCall(MaterialGetUniaxialModulus(body->model.material, &modulus));
  PetscCall(MaterialGetDensity(body->model.material, &density));
  /* nothing is known of other formulations and of several materials, and volumes of rings grow with their radius: their elements are looked
   * at as soon as they store something */
  PetscCall(ElementGetFormulation(body->model.element, &formulation));
  PetscCall(PetscStrcmp(formulation, ELEMENT_FULL, &full)); /* NULL where blocks differ in it */
  *energy = !full || body->model.element->blocks || body->model.element->axisymmetric
                ? PETSC_REAL_MIN
                : 0.5 * modulus * shape->part * least / sum * body->mass.total / density;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetInverted - elements of a linear body that are inside out at present

  Collective

  Input Parameters:
+ body      - the `Body`, set up
- potential - its potential energy, as `BodyGetMeasures()` tells it [J]

  Output Parameters:
+ number - how many of the elements have a corner with a negative volume; 0 for nonlinear bodies, whose steps fail by that
- centre - of one of them in the undeformed mesh, three numbers; not changed where there is none [m]

  Level: developer

  Note:
  Elements are looked at only where the body has enough energy to turn one of them inside out: in most runs the call costs a comparison.

.seealso: `Body`, `BodyGetMeasures()`
@*/
PetscErrorCode BodyGetInverted(Body body, PetscReal potential, PetscInt *number, PetscReal centre[3])
{
  const Corners     *shape = BodyFindCorners(body);
  const PetscInt     n = body->mesh.cell_nodes, dim = body->mesh.dim;
  PetscInt           found = -1;
  PetscMPIInt        first;
  Vec                local;
  const PetscScalar *u;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(number, 3);
  PetscAssertPointer(centre, 4);
  *number = 0;
  if (!body->model.linear || !shape) PetscFunctionReturn(PETSC_SUCCESS);
  if (!body->model.least_inverting) PetscCall(ComputeLeastEnergy(body, shape, &body->model.least_inverting));
  if (!(potential >= body->model.least_inverting)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetLocalRead(body, body->state.u, &local, &u));
  for (PetscInt e = 0; e < body->mesh.n_cells; e++) {
    const PetscInt *nodes  = body->mesh.cell_connectivity + e * n;
    PetscBool       inside = PETSC_FALSE;

    for (PetscInt c = 0; c < shape->corners && !inside; c++)
      inside = (PetscBool)(Jacobian(dim, nodes, c, shape->ends[c], body->mesh.coordinates, u) <= 0 &&
                           Jacobian(dim, nodes, c, shape->ends[c], body->mesh.coordinates, NULL) > 0);
    if (inside && found < 0) found = e;
    *number += inside;
  }
  PetscCall(BodyRestoreLocalRead(body, body->state.u, &local, &u));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, number, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
  if (*number) PetscCall(BodyFindFirstElement(body, found < 0 ? -1 : found / body->mesh.cells_of_element, &first, centre));
  PetscFunctionReturn(PETSC_SUCCESS);
}
