/*
   A parameter study in one process: one simulation after the other, each set up by function calls and destroyed, on one mesh for each bar
   that all of them share. No options file, nothing left behind; options on the command line still work (-contact_type penalty).

   A bar hits another one, of a modulus that changes from run to run. Until waves come back from the far ends the contact force is
   v Z1 Z2 / (Z1 + Z2), with the impedances Z = A sqrt(E rho) of the bars and the speed v at which they meet.
   Made with the installed library by: cc study.c -o study $(pkg-config --cflags --libs impakt)
*/
#include <impakt.h>

#define LENGTH  1.  /* m */
#define DENSITY 1e3 /* kg/m^3 */
#define SPEED   1.  /* m/s */

static PetscErrorCode CreateMesh(PetscReal lower, DM *mesh)
{
  const PetscReal upper    = lower + LENGTH;
  const PetscInt  elements = 200;

  PetscFunctionBegin;
  PetscCall(DMPlexCreateBoxMesh(PETSC_COMM_WORLD, 1, PETSC_FALSE, &elements, &lower, &upper, NULL, PETSC_TRUE, 0, PETSC_FALSE, mesh));
  PetscCall(DMSetFromOptions(*mesh)); /* distributes it over the ranks */
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddBar(Controller controller, const char name[], DM mesh, PetscReal modulus, PetscReal velocity)
{
  Material material;
  Body     body;

  PetscFunctionBegin;
  PetscCall(MaterialCreate(PETSC_COMM_WORLD, &material));
  PetscCall(MaterialSetType(material, MATERIAL_LINEAR_ELASTIC));
  PetscCall(MaterialSetDensity(material, DENSITY));
  PetscCall(MaterialSetYoungsModulus(material, modulus));
  PetscCall(BodyCreate(PETSC_COMM_WORLD, name, &body));
  PetscCall(BodySetDM(body, mesh));
  PetscCall(BodySetMaterial(body, material));
  PetscCall(BodySetTSType(body, TSCENTRALDIFFERENCE));
  PetscCall(BodySetTimeStep(body, PETSC_DETERMINE));
  PetscCall(BodySetInitialVelocity(body, &velocity));
  PetscCall(ControllerAddBody(controller, body)); /* which holds the body from now on, as the body holds the material */
  PetscCall(BodyDestroy(&body));
  PetscCall(MaterialDestroy(&material));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Run(const DM meshes[], PetscReal modulus, PetscReal *force)
{
  const PetscReal  end = LENGTH / PetscSqrtReal(4e9 / DENSITY); /* waves are at the far end of the stiffest bar [s] */
  Controller       controller;
  Contact          contact;
  ContactPairState state;

  PetscFunctionBegin;
  PetscCall(ControllerCreate(PETSC_COMM_WORLD, &controller));
  PetscCall(AddBar(controller, "left", meshes[0], 1e9, SPEED));
  PetscCall(AddBar(controller, "right", meshes[1], modulus, 0));
  PetscCall(ControllerSetTimes(controller, 0, end, end / 100));
  PetscCall(ControllerGetContact(controller, &contact));
  PetscCall(ContactAddPair(contact, "left:right"));
  PetscCall(ControllerSetFromOptions(controller));
  PetscCall(ControllerSolve(controller));
  PetscCall(ContactGetPairStates(contact, &state));
  *force = state.force;
  PetscCall(ControllerDestroy(&controller));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  DM meshes[2];

  PetscCall(ImpaktInitialize(&argc, &argv));
  PetscCall(CreateMesh(-LENGTH, &meshes[0]));
  PetscCall(CreateMesh(0, &meshes[1]));
  for (int doubled = 0; doubled < 5; doubled++) {
    const PetscReal modulus = ldexp(2.5e8, doubled), z[2] = {PetscSqrtReal(1e9 * DENSITY), PetscSqrtReal(modulus * DENSITY)};
    PetscReal       force;

    PetscCall(Run(meshes, modulus, &force));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "modulus %.3g Pa: force %.9g N, exact %.9g N\n", (double)modulus, (double)force,
                          (double)(SPEED * z[0] * z[1] / (z[0] + z[1]))));
  }
  for (PetscInt i = 0; i < 2; i++) PetscCall(DMDestroy(&meshes[i]));
  PetscCall(ImpaktFinalize());
  return 0;
}
