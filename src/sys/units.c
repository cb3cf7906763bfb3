/* -units: the one table of what a physical dimension is called in each set of units. */
#include "units.h"

const char *const UnitsNames[] = {"SI", "mm-t-s", "none", "Units", "UNITS_", NULL};

/* With a space in front, as behind a number */
static const char *const labels[UNIT_DIMENSIONS][2] = {
    [UNIT_LENGTH]            = {" m", " mm"},
    [UNIT_AREA]              = {" m^2", " mm^2"},
    [UNIT_TIME]              = {" s", " s"},
    [UNIT_VELOCITY]          = {" m/s", " mm/s"},
    [UNIT_ACCELERATION]      = {" m/s^2", " mm/s^2"},
    [UNIT_RATE]              = {" 1/s", " 1/s"},
    [UNIT_ANGLE]             = {" rad", " rad"},
    [UNIT_ANGULAR_VELOCITY]  = {" rad/s", " rad/s"},
    [UNIT_MASS]              = {" kg", " t"},
    [UNIT_INERTIA]           = {" kg m^2", " t mm^2"},
    [UNIT_DENSITY]           = {" kg/m^3", " t/mm^3"},
    [UNIT_FORCE]             = {" N", " N"},
    [UNIT_MOMENT]            = {" N m", " N mm"},
    [UNIT_IMPULSE]           = {" N s", " N s"},
    [UNIT_MOMENTUM]          = {" kg m/s", " t mm/s"},
    [UNIT_ANGULAR_MOMENTUM]  = {" kg m^2/s", " t mm^2/s"},
    [UNIT_ENERGY]            = {" J", " mJ"},
    [UNIT_ENERGY_ON_AREA]    = {" J/m^2", " mJ/mm^2"},
    [UNIT_STRESS]            = {" Pa", " MPa"},
    [UNIT_STIFFNESS]         = {" N/m", " N/mm"},
    [UNIT_STIFFNESS_ON_AREA] = {" N/m^3", " N/mm^3"},
    [UNIT_DASHPOT]           = {" N s/m", " N s/mm"},
    [UNIT_DASHPOT_ON_AREA]   = {" N s/m^3", " N s/mm^3"},
    [UNIT_SLOWNESS]          = {" s/m", " s/mm"},
    [UNIT_SPECIFIC_HEAT]     = {" J/(kg K)", " mJ/(t K)"},
    [UNIT_TEMPERATURE]       = {" K", " K"},
    [UNIT_ONE]               = {" 1", " 1"},
};

/* The set of units that -units names. `object`: whose options; `NULL`: those of all. Reads the options, so it is for set-ups, tables and
   warnings, not for every step. ControllerSetFromOptions() reports a wrong value */
PetscErrorCode UnitsGet(PetscObject object, Units *units)
{
  PetscEnum    value   = (PetscEnum)UNITS_SI;
  PetscOptions options = NULL;

  PetscFunctionBegin;
  if (object) PetscCall(PetscObjectGetOptions(object, &options));
  PetscCall(PetscOptionsGetEnum(options, NULL, "-units", UnitsNames, &value, NULL));
  *units = (Units)value;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* UnitsText - what stands behind a number of this dimension: a space and the unit, or nothing */
const char *UnitsText(Units units, UnitDimension dimension)
{
  if (units != UNITS_NONE) return labels[dimension][units];
  return dimension == UNIT_ANGLE ? labels[UNIT_ANGLE][UNITS_SI] : ""; /* radians are the same in every set */
}

/* UnitsLabel - the unit by itself, as attributes of files have it: "1" for counts; empty where units are not known */
const char *UnitsLabel(Units units, UnitDimension dimension)
{
  const char *text = dimension == UNIT_ONE ? labels[UNIT_ONE][UNITS_SI] : UnitsText(units, dimension);

  return text[0] ? text + 1 : text;
}

/* UnitsOf - `UnitsText()` in the units of an object's options; a wrong value there, which no set-up has reported, ends the program */
const char *UnitsOf(PetscObject object, UnitDimension dimension)
{
  Units units = UNITS_SI;

  PetscCallAbort(object ? PetscObjectComm(object) : PETSC_COMM_SELF, UnitsGet(object, &units));
  return UnitsText(units, dimension);
}
