/* Why a controller step could not be made. */
#pragma once
#include <petscsys.h>

/* A controller step can be cut in halves so many times: a part of 1e-6 of it is left then */
#define STEP_MAX_CUTS 20

/*E
   StepConvergedReason - whether a controller step has been made, and if not, why

   Values:
+ `STEP_CONVERGED`            - it has been made
. `STEP_DIVERGED_NEWTON`      - Newton's method for a nonlinear body did not converge
. `STEP_DIVERGED_LAYER`       - the massless contact layer of an explicit nonlinear body found no balance
. `STEP_DIVERGED_INVERTED`    - an element was inverted
. `STEP_DIVERGED_NAN`         - a displacement, a gap or a force is not a number
. `STEP_DIVERGED_OUTER`       - the outer iteration of the contact method did not converge
. `STEP_DIVERGED_ACTIVE_SET`  - the active set of contact nodes did not settle
. `STEP_DIVERGED_UNSTABLE`    - elements of an explicit body have become so flat that its substep is not stable any more
- `STEP_DIVERGED_LINEAR`      - the linear solver of a linear implicit body did not converge

   Level: intermediate

   Note:
   Negative where the step has not been made; the same on every rank.

.seealso: `ContactTryStep()`, `BodyTryIntegrateRows()`, `ControllerSetStepCuts()`
E*/
typedef enum {
  STEP_CONVERGED           = 0,
  STEP_DIVERGED_NEWTON     = -1,
  STEP_DIVERGED_LAYER      = -2,
  STEP_DIVERGED_INVERTED   = -3,
  STEP_DIVERGED_NAN        = -4,
  STEP_DIVERGED_OUTER      = -5,
  STEP_DIVERGED_ACTIVE_SET = -6,
  STEP_DIVERGED_UNSTABLE   = -7,
  STEP_DIVERGED_LINEAR     = -8
} StepConvergedReason;
