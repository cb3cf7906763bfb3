/*
   Laws of the one contact step: the relation between the forces on the rows of a node and what these rows read. A law is a projection,
   lambda = P(lambda - r y) for any r > 0, with its derivative; y is what it reads. Nobody asks for the name of a law.
*/
#pragma once
#include <petscsys.h>

#define ROW_LAW_ROWS 3 /* of a node, at most: along its normal, and across it */

typedef enum {
  ROW_LAW_READS_CLOSED, /* by how much the way of a row in the step misses that with which it counts as closed */
  ROW_LAW_READS_END     /* the gap at the end of the step */
} RowLawReads;

typedef struct {
  RowLawReads reads;
  /* P(p) of the rows of a node, and dP_i/dp_j at [i * n + j]; the force across the normal is at most limit[0] [N], and limit[1] times the
     normal force more */
  void (*project)(PetscInt n, const PetscReal limit[2], const PetscReal p[], PetscReal force[], PetscReal derivative[]);
} RowLaw;

extern const RowLaw RowLawUnilateral, RowLawTie;
