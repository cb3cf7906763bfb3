/* The state of a simulation, for checkpoints. Private to Impakt. */
#pragma once
#include <checkpoint/checkpoint.h>
#include <impakt/controller.h>

PETSC_INTERN PetscErrorCode ControllerVisit(Controller, Checkpoint);
