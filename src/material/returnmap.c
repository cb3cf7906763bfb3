/*
   How much a point flows in a step: the radial return. With q the equivalent stress at the end of the step if nothing flowed, the
   equivalent plastic strain grows by the root d of

     q - (3 mu + K) d = strength(strain + d),

   K the modulus of kinematic hardening (Simo, Hughes, Computational Inelasticity, 1998, section 3.3). Where strength is no linear function
   of the strain the root is found by Newton's method, kept between 0 and q / (3 mu + K), where the two sides change order.
*/
#include <impakt/private/plastic.h>
#include <math.h>

#define MAX_ITERATIONS 60
#define TOLERANCE      (8 * PETSC_MACHINE_EPSILON)

/* Strength less that of the virgin material, by the equivalent plastic strain alone, and its slope [Pa] */
static PetscReal StrengthAt(const Plastic *plastic, PetscReal strain, PetscReal *slope)
{
  PetscInt k = 1;

  switch (plastic->hardening) {
  case HARDENING_VOCE: {
    const PetscReal rise = plastic->saturation - plastic->yield, rest = PetscExpReal(-plastic->saturate_at * strain);

    *slope = plastic->modulus + rise * plastic->saturate_at * rest;
    return plastic->modulus * strain - rise * expm1(-plastic->saturate_at * strain);
  }
  case HARDENING_TABLE:
    while (k + 1 < plastic->n_table && strain > plastic->strain[k]) k++;
    *slope = (plastic->stress[k] - plastic->stress[k - 1]) / (plastic->strain[k] - plastic->strain[k - 1]);
    if (strain > plastic->strain[k]) { /* beyond the table the strength stays */
      *slope = 0;
      return plastic->stress[k] - plastic->stress[0];
    }
    return plastic->stress[k - 1] - plastic->stress[0] + *slope * (strain - plastic->strain[k - 1]);
  case HARDENING_JOHNSON_COOK:
    if (!(strain > 0)) {
      *slope = 0;
      return 0;
    }
    *slope = plastic->modulus * plastic->exponent * PetscPowReal(strain, plastic->exponent - 1);
    return plastic->modulus * PetscPowReal(strain, plastic->exponent);
  default:
    *slope = plastic->modulus;
    return plastic->modulus * strain;
  }
}

/* Johnson and Cook's factor of temperature, from the work that has become heat */
static PetscReal Softened(const Plastic *plastic, PetscReal work)
{
  PetscReal homologous;

  if (plastic->hardening != HARDENING_JOHNSON_COOK) return 1;
  homologous = (plastic->initial + plastic->heat_fraction * work / (plastic->density * plastic->specific_heat) - plastic->room) /
               (plastic->melting - plastic->room);
  if (homologous <= 0) return 1;
  return homologous >= 1 ? 0 : 1 - PetscPowReal(homologous, plastic->softening);
}

/* Their factor of the strain rate, 1 below the reference rate, and its slope by the growth of the strain in the step */
static PetscReal Rated(const Plastic *plastic, PetscReal growth, PetscReal dt, PetscReal *slope)
{
  const PetscReal ratio = dt > 0 ? growth / (dt * plastic->reference_rate) : 0;

  *slope = 0;
  if (plastic->hardening != HARDENING_JOHNSON_COOK || !(ratio > 1)) return 1;
  *slope = plastic->rate / growth;
  return 1 + plastic->rate * PetscLogReal(ratio);
}

/* The root at one point, whose equivalent stress is above its strength; NaN where there is none to be found */
static PetscReal FindRoot(const Plastic *plastic, PetscReal dt, PetscReal q, PetscReal strain, PetscReal soft, PetscReal *slope)
{
  const PetscReal stiffness = 3 * plastic->elastic.mu + plastic->kinematic;
  PetscReal       low = 0, high = q / stiffness, growth = 0;

  /* from the start of the step the slope of a power law may be infinite */
  if (plastic->hardening == HARDENING_JOHNSON_COOK) growth = PetscMax(0, (q - soft * plastic->yield) / stiffness) * 0.5;
  for (PetscInt iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
    PetscReal       by_strain, by_rate;
    const PetscReal hardened = plastic->yield + StrengthAt(plastic, strain + growth, &by_strain);
    const PetscReal rated    = Rated(plastic, growth, dt, &by_rate);
    const PetscReal excess = q - stiffness * growth - soft * rated * hardened, next = soft * (rated * by_strain + by_rate * hardened);
    PetscReal       step;

    *slope = next;
    if (PetscAbsReal(excess) <= TOLERANCE * q) return growth;
    if (excess > 0) low = growth;
    else high = growth;
    step = excess / (stiffness + next);
    if (!(growth + step > low && growth + step < high)) step = 0.5 * (low + high) - growth;
    growth += step;
    if (PetscAbsReal(step) <= TOLERANCE * growth || high - low <= TOLERANCE * high) return growth;
  }
  return NAN;
}

/* Of linear hardening, for all points at once */
SIMD_CLONES static void FindLinearFlow(const Plastic *plastic, const PetscReal q[8], const PetscReal start[][8], PlasticFlow *flow)
{
  const PetscReal modulus = plastic->modulus, yield = plastic->yield,
                  inverse = 1 / (3 * plastic->elastic.mu + plastic->kinematic + modulus);

#pragma omp simd
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal strength = yield + start[PLASTIC_STRENGTH][p], excess = q[p] - strength, growth = excess > 0 ? inverse * excess : 0;

    flow->strain[p]   = growth;
    flow->strength[p] = start[PLASTIC_STRENGTH][p] + modulus * growth;
    flow->work[p]     = growth * (strength + 0.5 * modulus * growth);
    flow->slope[p]    = modulus;
  }
}

/* PlasticFindFlow - what flows in a step of dt at a batch of points, whose equivalent stress is q if nothing does;
   a negative dt: nothing is to flow */
void PlasticFindFlow(const Plastic *plastic, PetscReal dt, const PetscReal q[8], const PetscReal start[][8], PlasticFlow *flow)
{
  if (plastic->hardening == HARDENING_LINEAR && dt >= 0) {
    FindLinearFlow(plastic, q, start, flow);
    return;
  }
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal strain = start[PLASTIC_STRAIN][p], before = start[PLASTIC_STRENGTH][p],
                    soft = Softened(plastic, start[PLASTIC_WORK][p]);
    PetscReal       slope, rate_slope, growth;

    flow->strain[p] = flow->work[p] = flow->slope[p] = 0;
    flow->strength[p]                                = before;
    if (dt < 0 || q[p] <= soft * (plastic->yield + before) || q[p] == 0 || isnan(q[p]))
      continue; /* a stress that is none goes on as it is */
    growth            = FindRoot(plastic, dt, q[p], strain, soft, &flow->slope[p]);
    flow->strain[p]   = growth;
    flow->strength[p] = StrengthAt(plastic, strain + growth, &slope);
    /* at rest the mean of the strengths at both ends; what the rate adds is what it adds at the end */
    flow->work[p] = soft * growth *
                    (plastic->yield + 0.5 * (before + flow->strength[p]) +
                     (Rated(plastic, growth, dt, &rate_slope) - 1) * (plastic->yield + flow->strength[p]));
  }
}
