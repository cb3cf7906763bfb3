/* Laws of the one contact step: the relation between the forces on the rows of a node and what these rows read. A law is a projection,
   lambda = P(lambda - r y), with its derivative; y is what it reads.

   Laws of glue and of friction have parameters that users give. Users name them in -contact_law, and their parameters in
   -contact_<law>_<parameter>, of friction in -contact_<parameter>. Glue has a stiffness, and may have numbers that it keeps of each node,
   as damage. Friction has a bound. */
#pragma once
#include <petscsys.h>
#include <sys/units.h>

#define ROW_LAW_ROWS       3 /* of a node, at most: along its normal, and across it; of glue along the axes */
#define ROW_LAW_PARAMETERS 4 /* at most */
#define ROW_LAW_HISTORY    2 /* numbers that a law keeps of a node, at most */

typedef enum {
  ROW_LAW_READS_CLOSED, /* by how much the way of a row in the step misses that with which it counts as closed */
  ROW_LAW_READS_END,    /* the gap at the end of the step */
  ROW_LAW_READS_MEAN    /* a multiple of the gap that the force of the step does its work on: at its end, or the mean of the step */
} RowLawReads;

/* A number that users give to a law of glue or friction; positive, unless it may be zero */
typedef struct {
  const char   *name, *what; /* in options; in words */
  UnitDimension unit;
  const char   *hint; /* (NULL) for those who have not set it */
  PetscBool     may_be_zero;
  PetscBool     optional; /* it may be left out, and pairs have no option for one of their own */
} RowLawParameter;

/* What glue knows of a node. Its rows are along the axes, and the gap is a vector by which the second body has gone from the first. */
typedef struct {
  PetscReal        times;                    /* what its rows read is this number of times the gap that the force does its work on */
  PetscReal        r;                        /* that of the trial force, for that gap [N/m] */
  PetscReal        area;                     /* [m^2] */
  PetscReal        normal[ROW_LAW_ROWS];     /* along which the node opens */
  PetscBool        secant;                   /* the derivative is to be that at the present stiffness, as if it stayed */
  PetscReal        least;                    /* gap along the normal that contact lets it have, at least [m] */
  PetscReal        history[ROW_LAW_HISTORY]; /* at the start of the step */
  const PetscReal *parameters;
} RowLawGlue;

typedef struct {
  const char *name; /* that users give to it; NULL: none */
  RowLawReads reads;
  PetscBool   pulls; /* it pulls as well as pushes, and its rows across the normal stick */
  /* P(p) of the rows of a node, and dP_i/dp_j at [i * n + j]; the force across the normal is at most limit[0] [N], and limit[1] times the
     normal force more. Of glue r is the same for all rows: the force is that which a gap m has with force + r m = -p, and - r m - p. */
  void (*project)(PetscInt n, const PetscReal limit[2], const RowLawGlue *, const PetscReal p[], PetscReal force[], PetscReal derivative[]);
  PetscInt        n_parameters;
  RowLawParameter parameters[ROW_LAW_PARAMETERS];     /* those that are not set are less than 0 in what follows */
  const char *(*check)(const PetscReal parameters[]); /* (NULL) what is wrong with them together; NULL: nothing */
  /* (NULL: it is no friction) `limit` of a node that has slid at this speed [m/s] in the last step */
  void (*bound)(const PetscReal parameters[], PetscReal speed, PetscReal limit[2]);
  /* Of glue: its force is stiffness times gap, beside contact; it stores half of that times the gap, and damage takes the rest. */
  PetscReal (*stiffness)(const PetscReal parameters[], const PetscReal history[]); /* per unit of area [N/m^3]; NULL: it is no glue */
  PetscReal (*softening)(const PetscReal parameters[]); /* (NULL) by how much force falls as the gap grows, at most [N/m^3] */
  PetscInt n_history;                                   /* numbers that it keeps of each node, zeros at the start */
  void (*grow)(PetscInt n, const RowLawGlue *, const PetscReal gap[],
               PetscReal history[]); /* what these are after a step with such a gap */
} RowLaw;

PETSC_INTERN PetscReal CoulombGetResidual(PetscInt, PetscReal, PetscReal, const PetscScalar[], const PetscScalar[]);

/* Laws that users name, in the order in which they are told. To add one: its file, and a line here. */
#define ROW_LAWS(LAW)                                                                                                                      \
  LAW(Cohesive)                                                                                                                            \
  LAW(Coulomb)                                                                                                                             \
  LAW(Spring)

#define ROW_LAW_DECLARE(law) extern const RowLaw RowLaw##law;
ROW_LAWS(ROW_LAW_DECLARE)
extern const RowLaw RowLawHold, RowLawTie, RowLawUnilateral, *const RowLaws[]; /* the last: those that users name, then NULL */
