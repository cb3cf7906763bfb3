/*
   A contact law of one's own: the surface is covered with a soft layer, whose force grows with the depth g of penetration as K g^(3/2) per
   unit of area. A stiff block of mass m = 1 kg flies into a plane with v = 1 m/s. By the energies of this law (Hertz's impact of a sphere)
   the layer is compressed to (5 m v^2 / (4 K))^(2/5), the contact lasts 2.94328 times that depth divided by v; the block leaves as it came.
   Made with the installed library by: cc spring.c -o spring $(pkg-config --cflags --libs impakt)
*/
#include <impakt.h>
#include <impakt/private/contactimpl.h>

typedef struct {
  PetscReal  stiffness; /* N/m^(7/2) */
  PetscReal *force;     /* per row of this rank [N] */
} Spring;

/* Forces at the end of the step are guessed, the bodies are advanced under them, and the law is asked again: until both agree */
static PetscErrorCode ContactStep_Spring(Contact contact)
{
  const Spring *spring = (const Spring *)contact->data;
  PetscBool     off    = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(spring->force, contact->start.force, contact->rows.n));
  for (PetscInt guess = 0; off && !ContactFailed(contact); guess++) { /* a body's step that fails may be made again in halves */
    PetscCheck(guess < 50, PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED, "The spring forces do not settle");
    PetscCall(ContactIntegrateForces(contact, spring->force));
    off = PETSC_FALSE;
    for (PetscInt i = 0; i < contact->rows.n; i++) {
      const PetscReal depth  = PetscMax(-contact->end.gap[i], 0);
      const PetscReal wanted = spring->stiffness * contact->rows.area[i] * depth * PetscSqrtReal(depth);

      if (PetscAbsReal(wanted - spring->force[i]) > 1e-12 * wanted) off = PETSC_TRUE;
      spring->force[i] = wanted;
    }
    PetscCall(ContactOr(contact, &off)); /* on any rank */
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactSetUp_Spring(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(contact->rows.n, &((Spring *)contact->data)->force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactDestroy_Spring(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(((Spring *)contact->data)->force));
  PetscCall(PetscFree(contact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactCreate_Spring(Contact contact)
{
  Spring *spring;

  PetscFunctionBegin;
  PetscCall(PetscNew(&spring));
  spring->stiffness = 1e4;
  PetscCall(PetscOptionsGetReal(NULL, NULL, "-contact_spring_stiffness", &spring->stiffness, NULL));
  contact->data         = spring;
  contact->ops->setup   = ContactSetUp_Spring;
  contact->ops->step    = ContactStep_Spring;
  contact->ops->destroy = ContactDestroy_Spring;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ctx: beginning and end of contact, largest depth, velocity at the end */
static PetscErrorCode Watch(Controller controller, const ControllerFrame *frame, void *ctx)
{
  PetscReal *seen = (PetscReal *)ctx;

  PetscFunctionBegin;
  (void)controller;
  if (frame->pairs[0].active && seen[0] == 0) seen[0] = frame->time;
  if (frame->pairs[0].active) seen[1] = frame->time;
  seen[2] = PetscMax(seen[2], -frame->pairs[0].gap);
  seen[3] = frame->bodies[0].mean_velocity[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscReal  seen[4] = {0};
  Controller controller;

  PetscCall(ImpaktInitialize(&argc, &argv));
  PetscCall(ContactRegister("spring", ContactCreate_Spring));
  PetscCall(ControllerCreate(PETSC_COMM_WORLD, &controller));
  PetscCall(ControllerSetFromOptions(controller)); /* -options_file spring.opts, beside this file */
  PetscCall(ControllerMonitorSet(controller, Watch, seen, NULL));
  PetscCall(ControllerSolve(controller));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "depth %.9g m, contact %.9g s, velocity %.9g m/s\n", (double)seen[2], (double)(seen[1] - seen[0]),
                        (double)seen[3]));
  PetscCall(ControllerDestroy(&controller));
  PetscCall(ImpaktFinalize());
  return 0;
}
