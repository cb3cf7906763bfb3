/* The equations of the laws of all rows that may touch, see lawproblem.c. */
#pragma once
#include <contact/laws/rowlaw.h>
#include <petscsnes.h>

typedef struct {
  PetscInt       n, n_nodes;  /* rows; nodes, whose rows follow each other */
  PetscInt      *begin;       /* per node: its first row; n_nodes + 1 */
  const RowLaw **law;         /* per node; borrowed */
  PetscReal     *limit;       /* two numbers per node */
  RowLawGlue    *glue;        /* per node: of laws of glue */
  Mat            S;           /* what rows read by forces on them: dense, sparse, or products [m/N] */
  Mat            entries;     /* S, or a sparse matrix near it where S is products alone */
  PetscReal     *diagonal;    /* of the latter */
  PetscReal     *weight;      /* per row: 1 / r of the trial force lambda - r y [m/N] */
  PetscReal     *derivatives; /* per node: those of P that the Jacobian has, ROW_LAW_ROWS^2 */
  PetscReal      resolution;  /* what rows read is right to so much, by round-off of positions [m] */
  PetscReal      rtol;        /* where S is products: laws hold to so much, if that is more than LAW_TOLERANCE */
  PetscReal      proximal;    /* weight of the proximal term, in parts of the diagonal of S */
  PetscBool      regular;     /* S is, so that there need be no such term: springs are on its diagonal */
  PetscScalar   *base, *read; /* per row: a force [N], and what is read under it [m] */
  PetscScalar   *centre;      /* per row: the force that the proximal term pulls to [N] */
  PetscScalar   *force;       /* per row: the solution [N] */
  PetscScalar   *work;        /* three numbers per row */
  PetscReal      largest;     /* on the diagonal of S [m/N] */
  PetscInt       room, rows;  /* rows that there is room for; of the solvers */
  PetscInt       iterations;  /* of Newton's method, and node by node, in the last solution */
  PetscBool      softens;     /* the force of a node falls as its gap grows */
  PetscBool      secant;      /* glue has its present stiffness in the Jacobian, see lawsolve.c */
  PetscBool      asked;       /* options name the solvers, which are called then whatever sweeps have found */
  PetscBool      solved;      /* there is a solution since the last call */
  PetscBool      by_nodes;    /* Newton's method failed, so that sweeps or secants came in */
  PetscBool      sparse;      /* the matrix of entries is */
  Vec            x, y;
  Vec            in, out;            /* the last product with S */
  PetscInt64     product_of;         /* state of the S of that; -1: none */
  Mat            derivative;         /* of P at the trial forces, times r [N/m] */
  Mat            jacobian, operator; /* by entries; products with it, where entries precondition alone, or NULL */
  PetscInt64     jacobian_of;        /* state of the entries that it has; -1: none */
  PetscBool      factored;           /* there are factors of an earlier Jacobian of this pattern */
  SNES           newton, nodes;
} LawProblem;

PETSC_INTERN PetscErrorCode LawProblemSetUp(LawProblem *);
PETSC_INTERN PetscErrorCode LawProblemResize(LawProblem *, PetscInt);
PETSC_INTERN PetscErrorCode LawProblemTakeS(LawProblem *, Mat *, Mat *);
PETSC_INTERN PetscErrorCode LawProblemMultiply(LawProblem *, const PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscErrorCode LawProblemMatchTrace(Mat, Mat);
PETSC_INTERN PetscErrorCode LawProblemSolve(LawProblem *);
PETSC_INTERN PetscErrorCode LawProblemDestroy(LawProblem *);
PETSC_INTERN PetscReal      LawProblemGetFrictionResidual(const LawProblem *);
PETSC_INTERN PetscErrorCode LawProblemIsAmbiguous(const LawProblem *, PetscBool *);

/* Whether S has no entries, and is only multiplied with */
static inline PetscBool LawProblemHasProducts(const LawProblem *problem)
{
  return (PetscBool)(problem->entries != problem->S);
}

/* Whether a node that pushes slides, by the forces of the last solution */
static inline PetscBool LawProblemSlides(const LawProblem *problem, PetscInt node)
{
  const PetscInt  first = problem->begin[node], end = problem->begin[node + 1];
  const PetscReal bound  = problem->limit[2 * node] + problem->limit[2 * node + 1] * PetscRealPart(problem->force[first]);
  PetscReal       across = 0;

  for (PetscInt i = first + 1; i < end; i++) across += PetscSqr(PetscRealPart(problem->force[i]));
  return (PetscBool)(end > first + 1 && !problem->law[node]->pulls && PetscSqrtReal(across) >= bound * (1 - PETSC_SQRT_MACHINE_EPSILON));
}

#define LAW_TOLERANCE      1e-13 /* of the largest force, and of the largest force that would close what is read */
#define LAW_LAG_AFTER_NEXT (-2)  /* for PETSc: the preconditioner is made anew once, and then stays */
PETSC_INTERN PetscErrorCode LawProblemRead(LawProblem *, const PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscErrorCode LawProblemHolds(LawProblem *, PetscBool *);
PETSC_INTERN PetscErrorCode LawProblemSweep(LawProblem *, PetscScalar[]);
PETSC_INTERN PetscErrorCode LawProblemLetGo(LawProblem *, PetscReal);
PETSC_INTERN void           LawProblemFindWeights(LawProblem *);
PETSC_INTERN void      LawProblemProject(const LawProblem *, PetscInt, const PetscScalar[], const PetscScalar[], PetscReal[], PetscReal[]);
PETSC_INTERN PetscBool LawProblemIsLagged(const LawProblem *);
PETSC_INTERN PetscErrorCode LawProblemCreateJacobian(LawProblem *);
PETSC_INTERN PetscReal      LawProblemForceScale(const LawProblem *, const PetscScalar[]);
