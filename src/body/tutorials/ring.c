/*
   A body from a mesh that the program makes: the quarter of a ring, of quadrilaterals. A surface is a label on faces; here "bore" is the
   inner one, which carries a pressure, and the straight sides are found as xmin and ymin, on which symmetry holds.

   The ring with radii a = 1 m and b = 2 m, in plane strain with nu = 0.25, widens under the pressure p (Lame): the inner radius by
   u = (1 + nu) a p / (E (b^2 - a^2)) ((1 - 2 nu) a^2 + b^2). The mass is that of the polygons which the mesh is made of.
   Made with the installed library by: cc ring.c -o ring $(pkg-config --cflags --libs impakt)
*/
#include <impakt.h>

#define RADIAL       16                              /* elements from the inside to the outside */
#define AROUND       32                              /* elements along the arc */
#define VERTEX(i, j) ((j) * (RADIAL + 1) + (i))      /* i outwards, j along the arc */
#define RADIUS(i)    (1 + (PetscReal)(i) / RADIAL)   /* m */
#define ANGLE(j)     (0.5 * PETSC_PI * (j) / AROUND) /* from the x-axis */

static PetscErrorCode CreateMesh(DM *mesh)
{
  PetscReal   x[(RADIAL + 1) * (AROUND + 1)][2];
  PetscInt    cells[RADIAL * AROUND][4], start, end;
  PetscMPIInt rank;
  DM          distributed;

  PetscFunctionBegin;
  for (PetscInt j = 0; j <= AROUND; j++)
    for (PetscInt i = 0; i <= RADIAL; i++) {
      x[VERTEX(i, j)][0] = j == AROUND ? 0 : RADIUS(i) * PetscCosReal(ANGLE(j));
      x[VERTEX(i, j)][1] = RADIUS(i) * PetscSinReal(ANGLE(j));
    }
  for (PetscInt j = 0; j < AROUND; j++)
    for (PetscInt i = 0; i < RADIAL; i++) { /* counterclockwise */
      const PetscInt corners[4] = {VERTEX(i, j), VERTEX(i + 1, j), VERTEX(i + 1, j + 1), VERTEX(i, j + 1)};

      PetscCall(PetscArraycpy(cells[j * RADIAL + i], corners, 4));
    }
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank)); /* the first rank has all of it at first */
  PetscCall(DMPlexCreateFromCellListPetsc(PETSC_COMM_WORLD, 2, rank ? 0 : RADIAL * AROUND, rank ? 0 : (RADIAL + 1) * (AROUND + 1), 4,
                                          PETSC_TRUE, &cells[0][0], 2, &x[0][0], mesh));
  PetscCall(DMCreateLabel(*mesh, "bore"));
  PetscCall(DMPlexGetDepthStratum(*mesh, 0, &start, &end)); /* vertices are numbered behind cells, as above */
  for (PetscInt j = 0; j < AROUND && !rank; j++) {
    const PetscInt ends[2] = {start + VERTEX(0, j), start + VERTEX(0, j + 1)}, *faces;
    PetscInt       n;

    PetscCall(DMPlexGetJoin(*mesh, 2, ends, &n, &faces));
    PetscCall(DMSetLabelValue(*mesh, "bore", faces[0], 1));
    PetscCall(DMPlexRestoreJoin(*mesh, 2, ends, &n, &faces));
  }
  PetscCall(DMPlexDistribute(*mesh, 0, NULL, &distributed));
  if (distributed) PetscCall(DMDestroy(mesh));
  if (distributed) *mesh = distributed;
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscReal  mass, largest;
  Controller controller;
  Material   material;
  Body       ring;
  Vec        u;
  DM         mesh;

  PetscCall(ImpaktInitialize(&argc, &argv));
  PetscCall(CreateMesh(&mesh));
  PetscCall(MaterialCreate(PETSC_COMM_WORLD, &material));
  PetscCall(MaterialSetType(material, MATERIAL_LINEAR_ELASTIC));
  PetscCall(MaterialSetDensity(material, 1000));
  PetscCall(MaterialSetYoungsModulus(material, 1e6));
  PetscCall(MaterialSetPoissonsRatio(material, 0.25));
  PetscCall(BodyCreate(PETSC_COMM_WORLD, "ring", &ring));
  PetscCall(BodySetDM(ring, mesh));
  PetscCall(BodySetMaterial(ring, material));
  PetscCall(BodySetTSType(ring, TSSTATIC));
  PetscCall(BodyAddDisplacement(ring, "xmin", "0,free"));
  PetscCall(BodyAddDisplacement(ring, "ymin", "free,0"));
  PetscCall(BodyAddTraction(ring, "bore", "-1e4*nx,-1e4*ny"));
  PetscCall(ControllerCreate(PETSC_COMM_WORLD, &controller));
  PetscCall(ControllerAddBody(controller, ring));
  PetscCall(ControllerSetTimes(controller, 0, 1, 1)); /* one load step */
  PetscCall(ControllerSolve(controller));
  PetscCall(BodyGetMass(ring, &mass));
  PetscCall(BodyGetSolution(ring, &u, NULL, NULL));
  PetscCall(VecMax(u, NULL, &largest)); /* on the axes of the bore */
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "mass %.15g kg, displacement of the bore %.9g m\n", (double)mass, (double)largest));
  PetscCall(ControllerDestroy(&controller));
  PetscCall(BodyDestroy(&ring));
  PetscCall(MaterialDestroy(&material));
  PetscCall(DMDestroy(&mesh));
  PetscCall(ImpaktFinalize());
  return 0;
}
