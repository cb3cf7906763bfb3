/* The two methods behind -contact_type lagrange. Private to src/contact/impls. */
#pragma once
#include "complementarity.h"
#include "../endforces.h"

PETSC_INTERN PetscErrorCode LagrangeSetUpForward(Contact);
PETSC_INTERN PetscErrorCode LagrangeSetUpImplicit(Contact);
PETSC_INTERN PetscErrorCode LagrangeSetUpImpulses(Contact, const char[], Complementarity *);
PETSC_INTERN PetscErrorCode LagrangeCloseRate(Contact, PetscBool, Complementarity *);
PETSC_INTERN PetscErrorCode LagrangeProjectPrediction(Contact, PetscReal, Complementarity *);
