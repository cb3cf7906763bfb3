/* What finite and small plastic strains share at half a batch of points. */
#pragma once
#include "symmetric.h"
#include <impakt/private/plastic.h>

/* The stress that works on the elastic strain, M = lambda tr(E) 1 + 2 mu E */
SIMD_INLINE Symmetric PlasticMandel(const Isotropic *elastic, Symmetric e)
{
  const SimdVector d      = elastic->lambda * (e.xx + e.yy + e.zz);
  const PetscReal  two_mu = 2 * elastic->mu;

  return (Symmetric){d + two_mu * e.xx, d + two_mu * e.yy, d + two_mu * e.zz, two_mu * e.xy, two_mu * e.yz, two_mu * e.zx};
}

/* Deviator of M less the centre of the yield surface */
SIMD_INLINE Symmetric PlasticRelative(const Plastic *plastic, Symmetric m, const PetscReal history[][8], PetscInt part)
{
  const SimdVector mean = (m.xx + m.yy + m.zz) / 3;
  const Symmetric  s    = {m.xx - mean, m.yy - mean, m.zz - mean, m.xy, m.yz, m.zx};

  return plastic->kinematic > 0 ? SymmetricAdd(s, SymmetricAll(-1), SymmetricGet(history + PLASTIC_CENTRE, part)) : s;
}

/* Stress at the end of a step, and what it has taken of the energy where the plastic strain grows by a ratio times `relative` */
SIMD_INLINE void PlasticStoreStress(Symmetric m, Symmetric relative, SimdVector ratio, const PetscReal start[][8], PetscReal end[][8],
                                    PetscInt part)
{
  const Symmetric twice = SymmetricAdd(SymmetricGet(start + PLASTIC_STRESS, part), SymmetricAll(1), m);

  SimdGetParts(end[PLASTIC_TAKEN])[part] = SymmetricLoad(start[PLASTIC_TAKEN], part) + 0.5 * ratio * SymmetricContract(twice, relative);
  SymmetricStore(m, end + PLASTIC_STRESS, part);
}
