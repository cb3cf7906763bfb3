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
