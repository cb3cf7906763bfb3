/* Displacements of a body's rows under contact forces on them. Private to compliance.c and complianceprobe.c, which make it, and respond.c,
   which applies it. */
#pragma once
#include "probe.h"

struct _BodyCompliance {
  /* rows that are known, on every rank alike; they become so one by one, and keep their place */
  PetscInt     n, capacity;
  PetscInt    *place; /* per row of all ranks: its place among the known ones, or -1 */
  PetscInt    *rows;
  PetscScalar *levels; /* substeps matrices, capacity x capacity by columns: displacement at the end of substep k + 1 for a hat of force in
                          the first [m/N] */
  PetscScalar *ramp;   /* at the end of the controller step, for a force that rises linearly over it [m/N] */
  PetscBool    ramp_valid;
  PetscScalar *mine; /* work space: of the rows of this rank, for each substep */
  /* an integration from which changes are counted: this rank's rows, for each substep */
  PetscScalar *base_displacement, *base_force;
  PetscBool    base_gathered;
  /* what the rows are to be in the response */
  BodyCondition *roles; /* of this rank's rows */
  PetscMPIInt   *all_roles;
  PetscInt       n_prescribed, *prescribed; /* places */
  PetscScalar   *factor;                    /* LU of the first level on them */
  PetscBool      factored;                  /* it is that */
  PetscBLASInt  *pivots;
  /* known rows, for each substep: base, inputs, forces, displacements */
  PetscScalar *known_displacement, *known_force, *input, *force, *displacement;
  PetscScalar *rhs;
};

PETSC_INTERN PetscErrorCode BodyCreateCompliance(Body);
PETSC_INTERN PetscErrorCode BodyProbeCompliance(Body, PetscInt);
PETSC_INTERN PetscErrorCode BodyGatherKnown(Body, const PetscScalar[], PetscScalar[]);
