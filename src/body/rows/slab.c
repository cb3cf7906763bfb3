/*
   Displacements under unit forces on many nodes, as a slab at the surface answers with what the body may do beyond it on a coarse grid:
   P (P^T A P)^{-1} P^T in place of A^{-1}. A column costs a solution with small factors in place of a controller step. Whoever uses it
   corrects it by what the body does.

   A stands for a whole controller step dt of the undeformed body: for one substep of the trapezoidal rule it is its own, K + 4/dt^2 M, and
   a force that is constant counts twice on nodes with mass, at both ends. Of many substeps, explicit or not, it is K + c/dt^2 M with c = 2
   under a constant force and 6 under one that grows from none: for vibrations that are long beside the step a node goes by dt^2/(c m), for
   short ones by what they do in the mean.
*/
#include "complianceimpl.h"
#include <solver/constrainedsolver.h>

#define COLUMNS 64    /* that are solved for together */
#define SHIFT   1e-10 /* what is added to the diagonal of P^T A P, in parts of it */

struct _BodySlab {
  Mat            functions; /* P */
  Mat            matrix;    /* P^T A P */
  KSP            ksp;
  BodyForceShape shape;
  PetscBool      twice; /* a force counts twice on nodes with mass */
};

PetscErrorCode BodySlabDestroy(struct _BodySlab **slab)
{
  PetscFunctionBegin;
  if (!*slab) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatDestroy(&(*slab)->functions));
  PetscCall(MatDestroy(&(*slab)->matrix));
  PetscCall(KSPDestroy(&(*slab)->ksp));
  PetscCall(PetscFree(*slab));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A of the whole body */
static PetscErrorCode CreateMatrix(Body body, struct _BodySlab *slab, Mat *A)
{
  const PetscBool one     = (PetscBool)(body->time.substeps == 1 && body->integrator->staggered <= 0);
  const PetscReal inertia = one ? 4 : slab->shape == BODY_FORCE_CONSTANT ? 2 : 6;

  PetscFunctionBegin;
  slab->twice = (PetscBool)(one && slab->shape == BODY_FORCE_CONSTANT);
  PetscCall(BodyCreateMatrix(body, A));
  PetscCall(BodyAssembleTangent(body, NULL, *A));
  PetscCall(BodyAddMassMatrix(body, inertia / PetscSqr(body->time.step * body->time.substeps), *A));
  PetscCall(BodyAddSpringStiffness(body, *A));
  PetscCall(BodyEliminateHeld(body, *A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The dofs that rows of this rank have entries at, and those asked for */
static PetscErrorCode ListSurface(Body body, PetscInt n, const PetscInt dofs[], IS *surface)
{
  PetscInt begin, end, count = n, *list;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(body->rows.matrix, &begin, &end));
  for (PetscInt pass = 0; pass < 2; pass++) {
    if (pass) {
      PetscCall(PetscMalloc1(count, &list));
      PetscCall(PetscArraycpy(list, dofs, n));
      count = n;
    }
    for (PetscInt row = begin; row < end; row++) {
      const PetscInt *columns;
      PetscInt        entries;

      PetscCall(MatGetRow(body->rows.matrix, row, &entries, &columns, NULL));
      if (pass) PetscCall(PetscArraycpy(list + count, columns, entries));
      count += entries;
      PetscCall(MatRestoreRow(body->rows.matrix, row, &entries, &columns, NULL));
    }
  }
  PetscCall(ISCreateGeneral(PetscObjectComm((PetscObject)body), count, list, PETSC_OWN_POINTER, surface));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodySlabCreate - the slab of a body at its rows and at some displacements, all of which may be asked for later */
PetscErrorCode BodySlabCreate(Body body, BodyForceShape shape, PetscInt n, const PetscInt dofs[], struct _BodySlab **result)
{
  struct _BodySlab *slab;
  Vec               diagonal;
  IS                surface;
  Mat               A;
  PC                pc;

  PetscFunctionBegin;
  PetscCall(PetscNew(&slab));
  *result     = slab;
  slab->shape = shape;
  PetscCall(CreateMatrix(body, slab, &A));
  PetscCall(ListSurface(body, n, dofs, &surface));
  PetscCall(BodyCreateSlabFunctions(A, body->mesh.positions, body->mesh.dim, surface, &slab->functions));
  PetscCall(ISDestroy(&surface));
  PetscCall(MatPtAP(A, slab->functions, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &slab->matrix));
  PetscCall(MatDestroy(&A));
  PetscCall(MatCreateVecs(slab->matrix, &diagonal, NULL));
  PetscCall(MatGetDiagonal(slab->matrix, diagonal));
  PetscCall(VecScale(diagonal, SHIFT));
  PetscCall(MatDiagonalSet(slab->matrix, diagonal, ADD_VALUES));
  PetscCall(VecDestroy(&diagonal));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)body), &slab->ksp));
  PetscCall(KSPSetType(slab->ksp, KSPPREONLY));
  PetscCall(KSPGetPC(slab->ksp, &pc));
  PetscCall(KSPSetOperators(slab->ksp, slab->matrix, slab->matrix));
  PetscCall(ConstrainedSolverChooseMUMPS(pc));
  PetscCall(KSPSetUp(slab->ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsMassless(Body body, PetscInt dof)
{
  return (PetscBool)(body->layer.exists && body->layer.contains[dof / body->mesh.dim]);
}

/* Unit forces on some displacements, in terms of P */
static PetscErrorCode FillForces(Body body, const struct _BodySlab *slab, PetscInt n, const PetscInt dofs[], Mat forces)
{
  PetscInt begin, end;

  PetscFunctionBegin;
  PetscCall(MatZeroEntries(forces));
  PetscCall(MatGetOwnershipRange(slab->functions, &begin, &end));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           entries;
    PetscScalar        scaled[8]; /* a dof of the coarse grid lies in a cell of so many nodes at most */

    if (dofs[k] < begin || dofs[k] >= end) continue;
    PetscCall(MatGetRow(slab->functions, dofs[k], &entries, &columns, &values));
    for (PetscInt e = 0; e < entries; e++) scaled[e] = values[e] * (slab->twice && !IsMassless(body, dofs[k] - begin) ? 2 : 1);
    PetscCall(MatSetValues(forces, entries, columns, 1, &k, scaled, INSERT_VALUES));
    PetscCall(MatRestoreRow(slab->functions, dofs[k], &entries, &columns, &values));
  }
  PetscCall(MatAssemblyBegin(forces, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(forces, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Columns of some displacements, at most COLUMNS */
static PetscErrorCode SolveColumns(Body body, const struct _BodySlab *slab, PetscInt n, const PetscInt dofs[], Compliance nodal)
{
  PetscInt           local, size, leading;
  Mat                forces, answers, moves, factors;
  PC                 pc;
  const PetscScalar *u;

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(slab->matrix, &local, NULL));
  PetscCall(MatGetSize(slab->matrix, &size, NULL));
  PetscCall(MatCreateDense(PetscObjectComm((PetscObject)body), local, PETSC_DECIDE, size, n, NULL, &forces));
  PetscCall(FillForces(body, slab, n, dofs, forces));
  PetscCall(MatDuplicate(forces, MAT_DO_NOT_COPY_VALUES, &answers));
  PetscCall(KSPGetPC(slab->ksp, &pc));
  PetscCall(PCFactorGetMatrix(pc, &factors));
  PetscCall(MatMatSolve(factors, forces, answers));
  PetscCall(MatMatMult(slab->functions, answers, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &moves));
  PetscCall(MatDenseGetLDA(moves, &leading));
  PetscCall(MatDenseGetArrayRead(moves, &u));
  for (PetscInt k = 0; k < n; k++) PetscCall(ComplianceSetColumn(nodal, dofs[k], 1, u + k * leading));
  PetscCall(MatDenseRestoreArrayRead(moves, &u));
  PetscCall(MatDestroy(&forces));
  PetscCall(MatDestroy(&answers));
  PetscCall(MatDestroy(&moves));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodySlabProbe - columns of displacements, by their numbers on all ranks, at the end of a controller step */
PetscErrorCode BodySlabProbe(Body body, const struct _BodySlab *slab, PetscInt n, const PetscInt dofs[], Compliance nodal)
{
  PetscInt some[COLUMNS], count = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) {
    if (!ComplianceKnows(nodal, dofs[i])) some[count++] = dofs[i];
    if (!count || (count < COLUMNS && i < n - 1)) continue;
    PetscCall(SolveColumns(body, slab, count, some, nodal));
    count = 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
