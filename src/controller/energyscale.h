/* The energy of all bodies less the work of loads, and what its changes are relative to: in the summary and on the terminal alike. */
#pragma once
#include <impakt/controller.h>

typedef struct {
  PetscReal start;     /* energy of all bodies at the start [J] */
  PetscReal given;     /* of that, kinetic energy of rigid bodies that are led: no measure of what contact may change [J] */
  PetscReal largest;   /* energies and work of all bodies, so far [J] */
  PetscBool from_rest; /* all bodies start at rest without strain: then the largest is what changes are relative to */
} EnergyScale;

PETSC_INTERN EnergyScale   *ControllerGetEnergyScale(Controller);
PETSC_INTERN PetscErrorCode EnergyScaleAdd(EnergyScale *, Controller, const ControllerFrame *);
PETSC_INTERN PetscReal      EnergyScaleGet(const EnergyScale *);
PETSC_INTERN PetscReal      EnergyScaleChange(const EnergyScale *, const ControllerFrame *);
