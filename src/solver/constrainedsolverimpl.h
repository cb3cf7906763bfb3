/* What the sources of the constrained solver share. Private to src/solver. */
#pragma once
#include "compliance.h"
#include "constrainedsolver.h"

struct _n_ConstrainedSolver {
  KSP                ksp;
  PC                 direct;  /* the preconditioner where it is the whole solver, else NULL */
  PC                 factors; /* what has factors of A that all ranks made together, or this one alone; NULL: nothing */
  PetscBool          home;    /* one of several ranks has A, and `factors`; those of others are of nothing */
  PetscBool          alone;   /* and all rows of B too: then it solves without a word of others, who may not even ask */
  Mat                B;
  PetscInt           local, global, begin; /* rows of B */
  PetscMPIInt        size;
  PetscBool          constant;    /* A is */
  KSPConvergedReason failed;      /* why a solution with a matrix that is not constant did not converge; 0: none failed */
  PetscReal         *constrained; /* of all rows: its flexibility, 0 where it is prescribed, less than 0 where it is free */
  PetscInt           n;           /* how many rows are constrained */
  PetscInt          *rows;        /* which */
  Vec               *columns;     /* per row: A^{-1} B^T e, or NULL until needed */
  PetscBool         *fresh;       /* per row: its column is there, with A and B as they are */
  /* the matrix of the constraint forces */
  PetscInt       room; /* rows that there is room for */
  PetscScalar   *W;    /* LU factors of W_mm, the same on every rank */
  PetscBLASInt  *pivots;
  PetscScalar   *force; /* of constrained rows, on every rank */
  Vec           *used;  /* columns */
  Vec            row, rhs, product;
  PetscLogDouble solve_flops; /* of one solution with A */
  PetscBool      mumps;       /* all ranks have `factors` of MUMPS, which take many right-hand sides at once */
  /* corrections by stored columns: their changes, all rows on every rank */
  PetscInt     most;   /* columns that are kept at most, of rows whose forces change */
  PetscBool    exact;  /* corrections for which columns are missing are solutions, see ConstrainedSolverSetExact() */
  PetscInt     missed; /* corrections for lack of columns by solutions, since rows changed or columns were made */
  PetscScalar *changes;
  PetscBool    by_columns; /* what a correction starts from is in `changes`, and else in `rhs` */
};

/* Interfaces of so few rows in all make the column of each row that is asked for: a correction adds them up in place of a solution */
#define FEW_ROWS 16

PETSC_INTERN PetscErrorCode ConstrainedSolverFindFactors(ConstrainedSolver, Mat);
PETSC_INTERN PetscErrorCode ConstrainedSolverCountFlops(ConstrainedSolver, Mat);
PETSC_INTERN PetscErrorCode ConstrainedSolverMakeColumn(ConstrainedSolver, PetscInt);
