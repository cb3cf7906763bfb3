/*
   An observer of one's own: a function that is called at the start and after every controller step, with a context in which it remembers
   what it has seen. This one finds when two bars touch, the mean of the contact force and the loss of energy.

   Two equal elastic bars, each of length L = 1 m, fly into each other at +-v = 1 m/s. Waves of speed c = sqrt(E / rho) = 1000 m/s run
   through them; until they come back, for 2 L / c = 2e-3 s, the contact force is rho c A v = 1e4 N.
   Made with the installed library by: cc observer.c -o observer $(pkg-config --cflags --libs impakt)
*/
#include <impakt.h>

typedef struct {
  PetscReal begin, end; /* of contact [s] */
  PetscReal impulse;    /* N s */
  PetscReal energy[2];  /* at the start, and now [J] */
} Seen;

static PetscErrorCode Observe(Controller controller, const ControllerFrame *frame, void *ctx)
{
  Seen     *seen = (Seen *)ctx;
  PetscReal step, energy = 0;

  PetscFunctionBegin;
  PetscCall(ControllerGetTimes(controller, NULL, &step, NULL));
  for (PetscInt b = 0; b < frame->n_bodies; b++) energy += frame->bodies[b].kinetic + frame->bodies[b].potential;
  seen->energy[frame->step ? 1 : 0] = energy;
  if (frame->pairs[0].active) {
    if (seen->begin < 0) seen->begin = frame->time - step;
    seen->end = frame->time;
  }
  seen->impulse = PetscAbsReal(frame->pairs[0].impulse[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The context is the observer's own; the controller frees it with this, and with itself */
static PetscErrorCode Report(void **ctx)
{
  const Seen     *seen     = (const Seen *)*ctx;
  const PetscReal duration = seen->end - seen->begin;

  PetscFunctionBegin;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "contact from %.9g to %.9g s, mean force %.9g N, energy changed by %.3g\n", (double)seen->begin,
                        (double)seen->end, (double)(seen->impulse / duration), (double)(seen->energy[1] / seen->energy[0] - 1)));
  PetscCall(PetscFree(*ctx));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  Controller controller;
  Seen      *seen;

  PetscCall(ImpaktInitialize(&argc, &argv));
  PetscCall(ControllerCreate(PETSC_COMM_WORLD, &controller));
  PetscCall(ControllerSetFromOptions(controller)); /* -options_file observer.opts, beside this file */
  PetscCall(PetscNew(&seen));
  seen->begin = -1;
  PetscCall(ControllerMonitorSet(controller, Observe, seen, Report));
  PetscCall(ControllerSolve(controller));
  PetscCall(ControllerDestroy(&controller));
  PetscCall(ImpaktFinalize());
  return 0;
}
