/* Plasticity of metals at small strain, with no regard to rotations: M = lambda tr(E) 1 + 2 mu E with E = (H + H^T) / 2 - Ep. */
#include "plasticpoint.h"
#include <math.h>

SIMD_INLINE Symmetric ElasticStrain(const PetscReal H[9][8], const PetscReal history[][8], PetscInt part)
{
  const Symmetric strain = {SymmetricLoad(H[0], part),
                            SymmetricLoad(H[4], part),
                            SymmetricLoad(H[8], part),
                            0.5 * (SymmetricLoad(H[1], part) + SymmetricLoad(H[3], part)),
                            0.5 * (SymmetricLoad(H[5], part) + SymmetricLoad(H[7], part)),
                            0.5 * (SymmetricLoad(H[2], part) + SymmetricLoad(H[6], part))};

  return SymmetricAdd(strain, SymmetricAll(-1), SymmetricGet(history + PLASTIC_DEFORMATION, part));
}

SIMD_INLINE void StoreStress(Symmetric m, PetscInt part, PetscReal P[9][8])
{
  const SimdVector rows[9] = {m.xx, m.xy, m.zx, m.xy, m.yy, m.yz, m.zx, m.yz, m.zz};

  for (PetscInt i = 0; i < 9; i++) SimdGetParts(P[i])[part] = rows[i];
}

SIMD_CLONES static void Advance(const void *data, PetscReal dt, const PetscReal H[9][8], const PetscReal start[][8], PetscReal end[][8],
                                PetscReal P[9][8])
{
  const Plastic *plastic = (const Plastic *)data;
  SimdReal       q, ratio, M[6], relative[6];
  PlasticFlow    flow;

  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const Symmetric m = PlasticMandel(&plastic->elastic, ElasticStrain(H, start, part)), s = PlasticRelative(plastic, m, start, part);

    SymmetricStore(m, M, part);
    SymmetricStore(s, relative, part);
    SimdGetParts(q)[part] = 1.5 * SymmetricSquares(s);
  }
#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) q[p] = PetscSqrtReal(q[p]);
  PlasticFindFlow(plastic, dt, q, start, &flow);
  for (int p = 0; p < SIMD_WIDTH; p++) ratio[p] = flow.strain[p] != 0 ? 1.5 * flow.strain[p] / q[p] : 0;
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const SimdVector r = SimdGetParts(ratio)[part];
    const Symmetric  s = SymmetricGet(relative, part), m = SymmetricAdd(SymmetricGet(M, part), -2 * plastic->elastic.mu * r, s);

    StoreStress(m, part, P);
    if (!end) continue;
    SymmetricStore(SymmetricAdd(SymmetricGet(start + PLASTIC_DEFORMATION, part), r, s), end + PLASTIC_DEFORMATION, part);
    for (PetscInt i = 6; i < 9; i++) SimdGetParts(end[i])[part] = SymmetricLoad(start[i], part);
    SimdGetParts(end[PLASTIC_STRAIN])[part]   = SymmetricLoad(start[PLASTIC_STRAIN], part) + SimdGetParts(flow.strain)[part];
    SimdGetParts(end[PLASTIC_WORK])[part]     = SymmetricLoad(start[PLASTIC_WORK], part) + SimdGetParts(flow.work)[part];
    SimdGetParts(end[PLASTIC_STRENGTH])[part] = SimdGetParts(flow.strength)[part];
    if (plastic->kinematic > 0) {
      const SimdVector moved  = 2 * plastic->kinematic / 3 * r;
      const Symmetric  centre = SymmetricGet(start + PLASTIC_CENTRE, part);

      SymmetricStore(SymmetricAdd(centre, moved, s), end + PLASTIC_CENTRE, part);
      SimdGetParts(end[PLASTIC_WORK])[part] += r * SymmetricContract(SymmetricAdd(centre, 0.5 * moved, s), s);
    }
    PlasticStoreStress(m, s, r, start, end, part);
  }
}

SIMD_CLONES static void Hold(const void *data, const PetscReal H[9][8], const PetscReal now[][8], PetscReal W[8], PetscReal P[9][8])
{
  const Isotropic *elastic = &((const Plastic *)data)->elastic;

  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const Symmetric  e     = ElasticStrain(H, now, part);
    const SimdVector trace = e.xx + e.yy + e.zz;

    if (P) StoreStress(PlasticMandel(elastic, e), part, P);
    SimdGetParts(W)[part] = 0.5 * elastic->lambda * trace * trace + elastic->mu * SymmetricSquares(e);
  }
}

/* dP = lambda tr(dE) 1 + 2 mu (1 - 3 mu d / q) dev dE + 2 mu dev dE + (what the growth d of the strain adds) s (s : dE) */
static void AdvanceTangent(const void *data, PetscReal dt, const PetscReal H[9], const PetscReal start[], PetscReal tangent[81])
{
  const Plastic  *plastic = (const Plastic *)data;
  const PetscReal lambda = plastic->elastic.lambda, mu = plastic->elastic.mu;
  const PetscInt  size     = PlasticGetSize(plastic);
  const int       place[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2};
  SimdReal        batch[9], history[PLASTIC_SIZE_CENTRED], s[6], q;
  PetscReal       keep = 1, along = 0;

  for (int p = 0; p < SIMD_WIDTH; p++) {
    for (int i = 0; i < 9; i++) batch[i][p] = H[i];
    for (PetscInt i = 0; i < size; i++) history[i][p] = start ? start[i] : 0;
  }
  for (PetscInt part = 0; part < SIMD_PARTS; part++) {
    const Symmetric m = PlasticMandel(&plastic->elastic, ElasticStrain((const PetscReal(*)[8])batch, (const PetscReal(*)[8])history, part)),
                    r = PlasticRelative(plastic, m, (const PetscReal(*)[8])history, part);

    SymmetricStore(r, s, part);
    SimdGetParts(q)[part] = 1.5 * SymmetricSquares(r);
  }
  for (int p = 0; p < SIMD_WIDTH; p++) q[p] = PetscSqrtReal(q[p]);
  if (start) {
    PlasticFlow flow;

    PlasticFindFlow(plastic, dt, q, (const PetscReal(*)[8])history, &flow);
    if (flow.strain[0] != 0) {
      keep  = 1 - 3 * mu * flow.strain[0] / q[0];
      along = 9 * mu * mu * (flow.strain[0] / q[0] - 1 / (3 * mu + plastic->kinematic + flow.slope[0])) / (q[0] * q[0]);
    }
  }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
          tangent[9 * (3 * i + j) + 3 * k + l] = (i == j && k == l ? lambda + 2 * mu / 3 * (1 - keep) : 0) +
                                                 mu * keep * ((i == k && j == l) + (i == l && j == k)) +
                                                 along * s[place[3 * i + j]][0] * s[place[3 * k + l]][0];
}

/* PlasticKernels_Small - the kernels of small strain */
PetscErrorCode PlasticKernels_Small(Material material, PetscBool plane_stress, MaterialKernels *kernels)
{
  PetscFunctionBegin;
  *kernels = (MaterialKernels){.advance = Advance, .hold = Hold, .advancetangent = AdvanceTangent};
  PetscCall(PlasticCompleteKernels(material, plane_stress, kernels));
  PetscFunctionReturn(PETSC_SUCCESS);
}
