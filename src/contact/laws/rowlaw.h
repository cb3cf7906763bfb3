/*
   Laws of the one contact step: the relation between the forces on the rows of a node and what these rows read. A law is a projection,
   lambda = P(lambda - r y) for any r > 0, with its derivative; y is what it reads. Nobody asks for the name of a law.
*/
#pragma once
#include <petscsys.h>

#define ROW_LAW_ROWS 3 /* of a node, at most: along its normal, and across it */

typedef enum {
  ROW_LAW_READS_CLOSED, /* by how much the way of a row in the step misses that with which it counts as closed */
  ROW_LAW_READS_END,    /* the gap at the end of the step */
  ROW_LAW_READS_MEAN    /* the gap that the force of the step does its work on, and what the law gives way by */
} RowLawReads;

typedef struct {
  RowLawReads reads;
  PetscBool   pulls; /* it pulls as well as pushes, and its rows across the normal stick */
  /* P(p) of the rows of a node, and dP_i/dp_j at [i * n + j]; the force across the normal is at most limit[0] [N], and limit[1] times the
     normal force more */
  void (*project)(PetscInt n, const PetscReal limit[2], const PetscReal p[], PetscReal force[], PetscReal derivative[]);
  /* (NULL: rigid) of a row with springs of a stiffness [N/m]: how far it gives way under a force [m/N]; what it stores at a gap [J] */
  PetscReal (*compliance)(PetscReal stiffness);
  PetscReal (*stored)(PetscReal stiffness, PetscReal gap);
} RowLaw;

PETSC_INTERN PetscErrorCode RowLawRegister(const char[], PetscErrorCode (*)(RowLaw *));
PETSC_INTERN PetscErrorCode RowLawRegisterAll(void);
PETSC_INTERN PetscErrorCode RowLawDestroyList(void);
PETSC_INTERN PetscErrorCode RowLawCreate(const char[], RowLaw *);
PETSC_INTERN PetscErrorCode RowLawCreate_Unilateral(RowLaw *);
PETSC_INTERN PetscErrorCode RowLawCreate_Tie(RowLaw *);
PETSC_INTERN PetscErrorCode RowLawCreate_Hold(RowLaw *);
PETSC_INTERN PetscErrorCode RowLawCreate_Spring(RowLaw *);
