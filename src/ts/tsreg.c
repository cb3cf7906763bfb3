/* Registration of time integrators, and `TSALPHA2` as a static one. */
#include <impakt/private/tssecondorder.h>
#include "constructors.h"

/*MC
   TSSTATIC - static balance at the end of each step, K(u) = f(t): `TSALPHA2` with its stage at the end of the step, for bodies without
   inertia

   Level: beginner

.seealso: `TSALPHA2`
M*/
static PetscErrorCode TSCreate_Static(TS ts)
{
  PetscFunctionBegin;
  PetscCall(TSSetType(ts, TSALPHA2));
  PetscCall(TSAlpha2SetParams(ts, 1, 1, 0.5, 0.25));
  PetscCall(PetscObjectChangeTypeName((PetscObject)ts, TSSTATIC));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Registers Impakt's time integrators with `TS` */
PetscErrorCode TSSecondOrderRegisterAll(void)
{
  PetscFunctionBegin;
  PetscCall(TSRegister(TSCENTRALDIFFERENCE, TSCreate_CentralDifference));
  PetscCall(TSRegister(TSSTATIC, TSCreate_Static));
  PetscCall(TSRegister(TSRIGID, TSCreate_Rigid));
  PetscFunctionReturn(PETSC_SUCCESS);
}
