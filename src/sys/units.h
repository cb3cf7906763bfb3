/* Labels of physical units in what a run prints and writes. */
#pragma once
#include <petscsys.h>

/* What numbers of a run are in: Impakt computes alike in any consistent set */
typedef enum { UNITS_SI, UNITS_MM_T_S, UNITS_NONE } Units;

extern const char *const UnitsNames[];

typedef enum {
  UNIT_LENGTH,
  UNIT_AREA,
  UNIT_TIME,
  UNIT_VELOCITY,
  UNIT_ACCELERATION,
  UNIT_RATE,
  UNIT_ANGLE,
  UNIT_ANGULAR_VELOCITY,
  UNIT_MASS,
  UNIT_INERTIA,
  UNIT_DENSITY,
  UNIT_FORCE,
  UNIT_MOMENT,
  UNIT_IMPULSE,
  UNIT_MOMENTUM,
  UNIT_ANGULAR_MOMENTUM,
  UNIT_ENERGY,
  UNIT_ENERGY_ON_AREA,
  UNIT_STRESS,
  UNIT_STIFFNESS,
  UNIT_STIFFNESS_ON_AREA,
  UNIT_DASHPOT,
  UNIT_DASHPOT_ON_AREA,
  UNIT_SLOWNESS,
  UNIT_SPECIFIC_HEAT,
  UNIT_TEMPERATURE,
  UNIT_ONE,
  UNIT_DIMENSIONS
} UnitDimension;

PETSC_INTERN PetscErrorCode UnitsGet(PetscObject, Units *);
PETSC_INTERN const char    *UnitsLabel(Units, UnitDimension);
PETSC_INTERN const char    *UnitsOf(PetscObject, UnitDimension);
PETSC_INTERN const char    *UnitsText(Units, UnitDimension);
