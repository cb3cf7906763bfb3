/*
   Batches of parallelepipeds and parallelograms. Their Jacobian is constant: it is found once, not at each point. Gradients of
   displacements are a sum of a few products of reference coordinates, `terms`, which are orthogonal over the points of integration, so that
   of a linear material the stress of each against its own gradients makes up the forces: what the points give, but for round-off. A
   template, of solidloops.h; a shape's file defines

     TERMS, terms[TERMS]           products of reference coordinates in the gradients of its monomials
*/

/* Elements are parallelepipeds where their shape is off by so little: coordinates of 1 m have as much round-off in elements of 0.1 mm */
#define AFFINE 1e-12

/* What is constant in a batch: cofactors of the Jacobian, its determinant, and the former over the latter */
typedef struct {
  SimdVector cofactor[SIMD_PARTS][DIM][DIM], inverse[SIMD_PARTS][DIM][DIM];
  SimdReal   determinant;
} Frame;

SIMD_INLINE PetscBool IsAffine(SimdVector X[SIMD_PARTS][DIM][MODES])
{
  SimdReal rest = {0};
  PetscInt any  = 0;

  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    SimdVector straight = {0}, bent = {0};

#pragma GCC unroll 3
    for (PetscInt i = 0; i < DIM; i++) {
#pragma GCC unroll 3
      for (PetscInt k = 0; k < DIM; k++) straight += X[part][i][k] * X[part][i][k];
#pragma GCC unroll 4
      for (PetscInt k = DIM; k < MODES; k++) bent += X[part][i][k] * X[part][i][k];
    }
    SimdGetParts(rest)[part] = bent - AFFINE * AFFINE * straight;
  }
  for (PetscInt p = 0; p < SIMD_WIDTH; p++) any |= !(rest[p] <= 0);
  return (PetscBool)!any;
}

/* False where an element is no parallelepiped */
SIMD_INLINE PetscBool GetFrame(SimdVector X[SIMD_PARTS][DIM][MODES], Frame *frame)
{
  if (!IsAffine(X)) return PETSC_FALSE;
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    SimdVector x[DIM][DIM], determinant, over;

#pragma GCC unroll 3
    for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
      for (PetscInt k = 0; k < DIM; k++) x[i][k] = X[part][i][k];
    Cofactors(x, frame->cofactor[part], &determinant);
    SimdGetParts(frame->determinant)[part] = determinant;
    over                                   = 1 / determinant;
#pragma GCC unroll 3
    for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
      for (PetscInt k = 0; k < DIM; k++) frame->inverse[part][i][k] = over * frame->cofactor[part][i][k];
  }
  return PETSC_TRUE;
}

/* The displacement gradient that stands with a term */
SIMD_INLINE void GetTerm(const SolidTerm *term, const Frame *frame, SimdVector U[SIMD_PARTS][DIM][MODES], SimdReal H[9])
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++)
#pragma GCC unroll 3
    for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
      for (PetscInt j = 0; j < DIM; j++) {
        SimdVector h = U[part][i][term->mode[0]] * frame->inverse[part][j][term->axis[0]];

#pragma GCC unroll 3
        for (PetscInt k = 1; k < term->n; k++) h += U[part][i][term->mode[k]] * frame->inverse[part][j][term->axis[k]];
        SimdGetParts(H[3 * i + j])[part] = h;
      }
}

/* Adds the force of a term, by monomials */
SIMD_INLINE void AddTerm(const SolidTerm *term, const Frame *frame, SimdReal P[9], SimdVector F[SIMD_PARTS][DIM][MODES])
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++)
#pragma GCC unroll 3
    for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
      for (PetscInt k = 0; k < term->n; k++) {
        SimdVector q = SimdGetParts(P[3 * i])[part] * frame->cofactor[part][0][term->axis[k]];

#pragma GCC unroll 3
        for (PetscInt j = 1; j < DIM; j++) q += SimdGetParts(P[3 * i + j])[part] * frame->cofactor[part][j][term->axis[k]];
        F[part][i][term->mode[k]] += term->weight * q;
      }
}

/* The forces of a batch of a linear material, by monomials */
SIMD_INLINE void AddTerms(const Solid *solid, PetscInt first, const Frame *frame, SimdVector U[SIMD_PARTS][DIM][MODES],
                          SimdVector F[SIMD_PARTS][DIM][MODES])
{
  SimdReal H[2][9], P[9];

  ZeroAcross(H[0]);
  ZeroAcross(H[1]);
  GetTerm(&terms[0], frame, U, H[0]);
#pragma GCC unroll 7
  for (PetscInt t = 0; t < TERMS; t++) {
    if (t + 1 < TERMS) GetTerm(&terms[t + 1], frame, U, H[(t + 1) % 2]); /* ahead, as gradients are in AddForces() */
    SolidStress(solid, first, t, (const SimdReal *)H[t % 2], P);
    AddTerm(&terms[t], frame, P, F);
  }
}

/* Displacement gradients at a point */
SIMD_INLINE void GetFrameGradients(const Frame *frame, SimdVector U[SIMD_PARTS][DIM][MODES], const PetscReal xi[DIM], SimdReal H[9])
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++)
#pragma GCC unroll 3
    for (PetscInt i = 0; i < DIM; i++) {
      SimdVector u[DIM];

      GradientOfModes(U[part][i], xi, u);
#pragma GCC unroll 3
      for (PetscInt j = 0; j < DIM; j++) {
        SimdVector h = u[0] * frame->inverse[part][j][0];

#pragma GCC unroll 3
        for (PetscInt k = 1; k < DIM; k++) h += u[k] * frame->inverse[part][j][k];
        SimdGetParts(H[3 * i + j])[part] = h;
      }
    }
}

/* What is the same at all points */
SIMD_INLINE void SetFrame(const Frame *frame, Gradients *at)
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    SimdGetParts(at->determinant)[part] = SimdGetParts((PetscReal *)frame->determinant)[part];
#pragma GCC unroll 3
    for (PetscInt i = 0; i < DIM; i++)
#pragma GCC unroll 3
      for (PetscInt k = 0; k < DIM; k++) at->cofactor[part][i][k] = frame->cofactor[part][i][k];
  }
}

/* GetGradients(), with the rest set by SetFrame() where the batch is affine */
SIMD_INLINE void GetGradientsOf(PetscBool affine, const Frame *frame, SimdVector X[SIMD_PARTS][DIM][MODES],
                                SimdVector U[SIMD_PARTS][DIM][MODES], const PetscReal xi[DIM], Gradients *at)
{
  if (affine) GetFrameGradients(frame, U, xi, at->H);
  else GetGradients(X, U, xi, at);
}

/* Additions and multiplications for the force of one element */
SIMD_INLINE PetscLogDouble CountAffineFlops(PetscBool linear)
{
  const PetscInt of_gradient = DIM == 2 ? 4 : 18, of_stress = DIM == 3 ? (linear ? 20 : 68) : (linear ? 9 : 30);
  PetscInt       count = NODES * DIM * (3 * DIM + 1) + 9 * DIM + 10; /* nodes and frame */

  if (linear)
    for (PetscInt t = 0; t < TERMS; t++) count += of_stress + terms[t].n * DIM * (4 * DIM + 1);
  else count += POINTS * (2 * DIM * of_gradient + of_stress + 2 * DIM * DIM * (2 * DIM - 1));
  return (PetscLogDouble)count;
}
