/* The two methods behind -contact_type lagrange. Private to src/contact/impls. */
#pragma once
#include "complementarity.h"
#include <contact/compliance/forces.h>
#include <contact/compliance/interfaceoperator.h>
#include <contact/compliance/outersolver.h>

/* Of the implicit method */
typedef struct {
  OuterSolver       outer;
  PetscReal         atol, rtol; /* on the gap [m], and relative to the displacement of the contact nodes */
  Forces            forces;
  InterfaceOperator S;
  InterfaceMark    *marks;      /* all rows are solved for */
  PetscScalar      *compliance; /* S, all rows by all rows, by columns [m/N], times `scale` */
  PetscBool         have_jacobian, scaled_in_place;
  PetscReal         scale; /* of the forces at the end of the step, as the integrator takes them */
  /* for the rate beside the gap, and for the contact-stabilised prediction */
  Complementarity impulses;
  PetscBool       close_rate, stabilized;
  PetscReal       step;                /* [s] */
  PetscReal       mismatch, magnitude; /* [m] */
} ImplicitLagrange;

PETSC_INTERN PetscErrorCode LagrangeSetUpForward(Contact);
PETSC_INTERN PetscErrorCode LagrangeSetUpImplicit(Contact);
PETSC_INTERN PetscErrorCode LagrangeSetUpOuter(Contact);
PETSC_INTERN PetscErrorCode LagrangeCheckConverged(Contact);
PETSC_INTERN PetscErrorCode LagrangeSetUpImpulses(Contact, const char[], Complementarity *);
PETSC_INTERN PetscErrorCode LagrangeCloseRate(Contact, PetscBool, Complementarity *);
PETSC_INTERN PetscErrorCode LagrangeProjectPrediction(Contact, PetscReal, Complementarity *);
