/* Elements of a linear body that are inside out: its material knows no limit, and would go on with them.

   They are looked for where they can be at all. At a point where det(I + H) <= 0, for the displacement gradient H, the strain has an
   eigenvalue of -1 or less, since x.(I + H) x > 0 otherwise; an element with such a corner stores at least 1/2 E V c. E is Young's modulus,
   V the volume, and c = 1 where strains are constant, 4^-dim where they have as many modes along each axis. As long as the whole body
   stores less than that, which the energy balance knows anyway, no element is looked at. That holds for fully integrated elements; those of
   other formulations are looked at whenever the body stores energy.

   Of an element the displacements of its nodes are compared first. Edges M that meet at a corner become M + E, which is singular only where
   the norm of E is at least the smallest singular value of M. Each of the dim edges in E is at most the diagonal of the box around the
   displacements, and that singular value is at least |det M| over the largest product of the others, (|M|^2 / 2) in space and |M| in the
   plane. */
#include "corners.h"

/* The Jacobian at a corner of a cell whose nodes are at these places */
SIMD_INLINE PetscReal Jacobian(PetscInt dim, PetscReal place[][3], PetscInt corner, const PetscInt ends[3])
{
  PetscReal e[3][3] = {{0}};

  for (PetscInt i = 0; i < dim; i++)
    for (PetscInt d = 0; d < dim; d++) e[i][d] = place[ends[i]][d] - place[corner][d];
  if (dim == 1) return e[0][0];
  if (dim == 2) return e[0][0] * e[1][1] - e[0][1] * e[1][0];
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) + e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/* How far apart displacements must be for such a corner to be inside out, at least [m] */
SIMD_INLINE PetscReal LeastStretch(PetscInt dim, PetscReal place[][3], PetscInt corner, const PetscInt ends[3], PetscReal jacobian)
{
  PetscReal squares = 0;

  for (PetscInt i = 0; i < dim; i++)
    for (PetscInt d = 0; d < dim; d++) squares += PetscSqr(place[ends[i]][d] - place[corner][d]);
  if (dim == 1) return jacobian;
  return jacobian / (dim == 2 ? PetscSqrtReal(2 * squares) : 0.86602540378443865 * squares);
}

/* Whether the displacements of the nodes of a cell differ by less than that */
SIMD_INLINE PetscBool IsNearlyRigid(PetscInt dim, PetscInt n, const PetscInt nodes[], const PetscScalar u[], PetscReal least)
{
  PetscReal squares = 0;

  for (PetscInt d = 0; d < dim; d++) {
    PetscReal lower = PetscRealPart(u[nodes[0] * dim + d]), upper = lower;

    for (PetscInt a = 1; a < n; a++) {
      const PetscReal at = PetscRealPart(u[nodes[a] * dim + d]);

      lower = PetscMin(lower, at);
      upper = PetscMax(upper, at);
    }
    squares += PetscSqr(upper - lower);
  }
  return (PetscBool)(squares < PetscSqr(least));
}

/* How many cells have a corner that is inside out in the state u and was not before, and the first of them; -1: none */
SIMD_INLINE PetscInt CountInverted(PetscInt dim, const BodyMesh *mesh, const Corners *shape, const PetscScalar u[], PetscReal least,
                                   PetscInt *found)
{
  PetscReal place[MOST_CORNERS][3] = {{0}}, before[MOST_CORNERS][3] = {{0}};
  PetscInt  number = 0;

  *found = -1;
  for (PetscInt e = 0; e < mesh->n_cells; e++) {
    const PetscInt *nodes    = mesh->cell_connectivity + e * mesh->cell_nodes;
    PetscReal       smallest = PETSC_MAX_REAL;
    PetscBool       inside   = PETSC_FALSE;

    if (IsNearlyRigid(dim, mesh->cell_nodes, nodes, u, least)) continue;
    CornersGetPlaces(dim, mesh->cell_nodes, nodes, mesh->coordinates, u, place);
    for (PetscInt c = 0; c < shape->corners; c++) smallest = PetscMin(smallest, Jacobian(dim, place, c, shape->ends[c]));
    if (smallest > 0) continue;
    for (PetscInt c = 0; c < shape->corners && !inside; c++) {
      CornersGetPlaces(dim, mesh->cell_nodes, nodes, mesh->coordinates, NULL, before);
      inside = (PetscBool)(Jacobian(dim, place, c, shape->ends[c]) <= 0 && Jacobian(dim, before, c, shape->ends[c]) > 0);
    }
    if (inside && *found < 0) *found = e;
    number += inside;
  }
  return number;
}

/* The energy that the body must store before an element can be inside out; infinity where nobody can tell [J]. Volumes: the corners'
   Jacobians, scaled to the volume of the body. And by how much the displacements of an element must differ [m]. */
static PetscErrorCode ComputeLeast(Body body, const Corners *shape, PetscReal *energy, PetscReal *stretch)
{
  const BodyMesh *mesh = &body->mesh;
  PetscReal       sum = 0, least[2] = {PETSC_MAX_REAL, PETSC_MAX_REAL}, modulus, density, place[MOST_CORNERS][3] = {{0}};
  const char     *formulation;
  PetscBool       full;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < mesh->n_cells; e++) {
    CornersGetPlaces(mesh->dim, mesh->cell_nodes, mesh->cell_connectivity + e * mesh->cell_nodes, mesh->coordinates, NULL, place);
    for (PetscInt c = 0; c < shape->corners; c++) {
      const PetscReal jacobian = Jacobian(mesh->dim, place, c, shape->ends[c]);

      sum += jacobian / (PetscReal)shape->corners;
      if (!(jacobian > 0)) continue;
      least[0] = PetscMin(least[0], jacobian);
      least[1] = PetscMin(least[1], LeastStretch(mesh->dim, place, c, shape->ends[c], jacobian));
    }
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, least, 2, MPIU_REAL, MPIU_MIN, PetscObjectComm((PetscObject)body)));
  *stretch = least[1];
  PetscCall(MaterialGetUniaxialModulus(body->model.material, &modulus));
  PetscCall(MaterialGetDensity(body->model.material, &density));
  /* other formulations, several materials and rings have no such bound: their elements are looked at once they store something */
  PetscCall(ElementGetFormulation(body->model.element, &formulation));
  PetscCall(PetscStrcmp(formulation, ELEMENT_FULL, &full)); /* NULL where blocks differ in it */
  *energy = !full || body->model.element->blocks || body->model.element->axisymmetric
                ? PETSC_REAL_MIN
                : 0.5 * modulus * shape->part * least[0] / sum * body->mass.total / density;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Number of elements of a linear body that have a corner with a negative volume, and the undeformed centre of one of them [m]; steps of
   nonlinear bodies fail by that. Elements are looked at only where `potential` [J] can turn one inside out. Collective. */
PetscErrorCode BodyGetInverted(Body body, PetscReal potential, PetscInt *number, PetscReal centre[3])
{
  const Corners     *shape = BodyFindCorners(body);
  PetscInt           found;
  PetscMPIInt        first;
  Vec                local;
  const PetscScalar *u;

  PetscFunctionBegin;
  *number = 0;
  if (!body->model.linear || !shape) PetscFunctionReturn(PETSC_SUCCESS);
  if (!body->model.least_inverting) PetscCall(ComputeLeast(body, shape, &body->model.least_inverting, &body->model.least_stretch));
  if (!(potential >= body->model.least_inverting)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetLocalRead(body, body->state.u, &local, &u));
  if (body->mesh.dim == 3) *number = CountInverted(3, &body->mesh, shape, u, body->model.least_stretch, &found);
  else if (body->mesh.dim == 2) *number = CountInverted(2, &body->mesh, shape, u, body->model.least_stretch, &found);
  else *number = CountInverted(1, &body->mesh, shape, u, body->model.least_stretch, &found);
  PetscCall(BodyRestoreLocalRead(body, body->state.u, &local, &u));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, number, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
  if (*number) PetscCall(BodyFindFirstElement(body, found < 0 ? -1 : found / body->mesh.cells_of_element, &first, centre));
  PetscFunctionReturn(PETSC_SUCCESS);
}
