/* The comparison with an exact solution, for checkpoints. Private to Impakt. */
#pragma once
#include <checkpoint/checkpoint.h>
#include <impakt/exact.h>

PETSC_INTERN PetscErrorCode ExactVisit(Exact, Checkpoint);
