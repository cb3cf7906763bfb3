/* The two methods behind -contact_type lagrange. Private to src/contact/impls. */
#pragma once
#include "../contactimpl.h"

PETSC_INTERN PetscErrorCode LagrangeSetUpForward(Contact);
PETSC_INTERN PetscErrorCode LagrangeSetUpImplicit(Contact);
