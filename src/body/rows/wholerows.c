/* Matrices of rows of a body that one of several ranks has all of. All entries of a rank's rows are in one block of such a matrix: that of
   the columns which it has, of the owner, or that of the columns which others have. So rows can get entries in other places without a word
   of other ranks, once each rank knows all columns that these will ever be in. */
#include <body/layout/bodyimpl.h>

/* Has ranks with rows but nothing of the body itself (`owner`) know the columns in which a new matrix will ever have entries, n columns,
   the same on all ranks: there are zeros in the first row. What ranks exchange in products stays when rows get entries in other places,
   and so does the matrix. Assembled again, it needs no other rank. Collective. */
PetscErrorCode BodyWholeRowsTellColumns(Mat matrix, PetscBool owner, PetscInt n, const PetscInt columns[])
{
  PetscInt begin, end;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(matrix, &begin, &end));
  for (PetscInt k = 0; k < n && end > begin && !owner; k++) PetscCall(MatSetValue(matrix, begin, columns[k], 0, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatSetOption(matrix, MAT_NEW_NONZERO_LOCATION_ERR, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* New room for at most `counts` entries of each of this rank's rows. A new matrix, as after a checkpoint, multiplies by groups of rows
   alike in the block of its own columns; one that goes on looks for them anew, or the last bit differs after a checkpoint. */
PetscErrorCode BodyWholeRowsRenew(Mat matrix, PetscBool owner, const PetscInt counts[])
{
  PetscInt n;
  Mat      blocks[2];

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(matrix, &n, NULL));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatMPIAIJGetSeqAIJ(matrix, &blocks[0], &blocks[1], NULL));
  PetscCall(MatSeqAIJSetPreallocation(blocks[owner ? 0 : 1], 0, counts));
  if (owner) PetscCall(MatSetOption(blocks[0], MAT_USE_INODES, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}
