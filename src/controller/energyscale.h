/* Changes of the energy of all bodies, and what they are relative to. */
#pragma once
#include <impakt/controller.h>

typedef struct {
  PetscReal start;   /* energy of all bodies at the start [J] */
  PetscReal largest; /* kinetic energy, strain energy or work so far [J] */
} EnergyScale;

PETSC_INTERN PetscErrorCode EnergyScaleAdd(EnergyScale *, const Body[], ControllerFrame *);
