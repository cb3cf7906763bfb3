/* When contact begins and ends, inside controller steps. */
#pragma once
#include <checkpoint/checkpoint.h>
#include <impakt/controller.h>

typedef struct {
  PetscReal onset;             /* when bodies touched first [s]; not-a-number if they did not */
  PetscReal separation;        /* when they parted last [s]; not-a-number if they did not, or are in contact at the end */
  PetscBool in_contact_at_end; /* the last controller step ended in contact */
} ContactTimesResults;

typedef struct _n_ContactTimes *ContactTimes;

PETSC_INTERN PetscErrorCode ContactTimesCreate(Controller, ContactTimes *);
PETSC_INTERN PetscErrorCode ContactTimesAdd(ContactTimes, const ControllerFrame *);
PETSC_INTERN PetscErrorCode ContactTimesGetResults(ContactTimes, PetscInt, ContactTimesResults *);
PETSC_INTERN PetscErrorCode ContactTimesVisit(ContactTimes, Checkpoint);
PETSC_INTERN PetscErrorCode ContactTimesDestroy(ContactTimes *);
