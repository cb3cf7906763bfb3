/* How much a point flows in a step: the radial return. With q the equivalent stress at the end of the step if nothing flowed, the
   equivalent plastic strain grows by the root d of

     q - (3 mu + K) d = strength(strain + d),

   K the modulus of kinematic hardening (Simo, Hughes, Computational Inelasticity, 1998, section 3.3). Where strength is no linear function
   of the strain, nor one in pieces, the root is found by Halley's method, kept between 0 and q / (3 mu + K), where the two sides change
   order: the logarithm of the rate is so curved that Newton's method takes half as many iterations more. */
#include <impakt/private/plastic.h>
#include <impakt/private/simdmath.h>
#include <math.h>

#define MAX_ITERATIONS 60
#define TOLERANCE      (8 * PETSC_MACHINE_EPSILON)
/* A step of Halley's method, in parts of the growth, after which its cube is left: nothing */
#define LAST_STEP 1e-6
/* Strains below, of which powers are taken, count as this */
#define SMALLEST 1e-300

/* PlasticGetSize - numbers of the history of a point */
PetscInt PlasticGetSize(const Plastic *plastic)
{
  return plastic->kinematic > 0 ? PLASTIC_SIZE_CENTRED : PLASTIC_SIZE;
}

static const PetscReal virgin[PLASTIC_SIZE_CENTRED][SIMD_WIDTH] = {{0}};

/* The virgin material, as long as nothing flows */
static void Stress(const void *data, const PetscReal H[9][8], PetscReal P[9][8])
{
  SimdReal W;

  (*((const Plastic *)data)->kernels.hold)(data, H, virgin, W, P);
}

static void Energy(const void *data, const PetscReal H[9][8], PetscReal W[8])
{
  (*((const Plastic *)data)->kernels.hold)(data, H, virgin, W, NULL);
}

static void Tangent(const void *data, const PetscReal H[9], PetscReal tangent[81])
{
  (*((const Plastic *)data)->kernels.advancetangent)(data, 0, H, NULL, tangent);
}

/* PlasticCompleteKernels - what the kernels of all plastic models have in common, beside the functions that the caller has put in */
PetscErrorCode PlasticCompleteKernels(Material material, PetscBool plane_stress, MaterialKernels *kernels)
{
  PetscFunctionBegin;
  PetscCheck(!plane_stress, PetscObjectComm((PetscObject)material), PETSC_ERR_SUP,
             "The material of type %s is there for solids and plane strain, not for plane stress: leave -%splane_stress out",
             ((PetscObject)material)->type_name, ((PetscObject)material)->prefix ? ((PetscObject)material)->prefix : "");
  kernels->data           = material->data;
  kernels->stress         = Stress;
  kernels->energy         = Energy;
  kernels->tangent        = Tangent;
  kernels->n_history      = PlasticGetSize((const Plastic *)material->data);
  kernels->plastic_strain = PLASTIC_STRAIN;
  kernels->plastic_work   = PLASTIC_WORK;
  kernels->taken          = PLASTIC_TAKEN;

  ((Plastic *)material->data)->kernels = *kernels;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of Voce's law or Johnson and Cook's: strength of half a batch less that of the virgin material, by the equivalent plastic strain alone,
   its slope, and what that changes by [Pa] */
SIMD_INLINE SimdVector GetStrength(const Plastic *plastic, SimdVector strain, SimdVector *slope, SimdVector *curvature)
{
  if (plastic->hardening == HARDENING_VOCE) {
    const PetscReal  rise = plastic->saturation - plastic->yield;
    const SimdVector rest = SimdExp(-plastic->saturate_at * strain);

    *slope     = plastic->modulus + rise * plastic->saturate_at * rest;
    *curvature = -plastic->saturate_at * plastic->saturate_at * rise * rest;
    return plastic->modulus * strain + rise * (1 - rest);
  } else {
    const SimdVector inside = SimdMax(strain, SimdAll(SMALLEST)), power = plastic->modulus * SimdExp(plastic->exponent * SimdLog(inside));
    const SimdBits   any = (SimdBits)(strain > SMALLEST);

    *slope     = SimdSelect(any, plastic->exponent * power / inside, SimdAll(0));
    *curvature = (plastic->exponent - 1) / inside * *slope;
    return SimdSelect(any, power, SimdAll(0));
  }
}

/* Johnson and Cook's factor of temperature, from the work that has become heat */
SIMD_INLINE SimdVector GetSoftening(const Plastic *plastic, SimdVector work)
{
  const PetscReal  by_work    = plastic->heat_fraction / (plastic->density * plastic->specific_heat);
  const SimdVector homologous = (plastic->initial - plastic->room + by_work * work) / (plastic->melting - plastic->room);
  const SimdVector inside     = SimdMin(SimdMax(homologous, SimdAll(SMALLEST)), SimdAll(1));

  return 1 - SimdSelect((SimdBits)(homologous > SMALLEST), SimdExp(plastic->softening * SimdLog(inside)), SimdAll(0));
}

/* Their factor of the strain rate, 1 below the reference rate, and its slope by the growth of the strain in the step */
SIMD_INLINE SimdVector GetRate(const Plastic *plastic, SimdVector growth, PetscReal dt, SimdVector *slope)
{
  const PetscReal  inverse = dt > 0 ? 1 / (dt * plastic->reference_rate) : 0;
  const SimdVector ratio = growth * inverse, fast = SimdMax(ratio, SimdAll(1));

  *slope = SimdSelect((SimdBits)(ratio > 1), plastic->rate * inverse / fast, SimdAll(0));
  return 1 + plastic->rate * SimdLog(fast);
}

/* First step by the slope at the start, below the root of a flattening law; half of perfect plasticity's where it may be infinite */
SIMD_INLINE SimdVector FirstGuess(const Plastic *plastic, SimdVector excess, PetscReal stiffness, SimdVector soft, SimdVector strain,
                                  SimdVector strength)
{
  if (plastic->hardening == HARDENING_VOCE)
    return excess / (stiffness + plastic->modulus +
                     plastic->saturate_at * (plastic->saturation - plastic->yield - strength + plastic->modulus * strain));
  return excess / SimdSelect((SimdBits)(strain > SMALLEST),
                             stiffness + soft * (plastic->exponent * strength / SimdMax(strain, SimdAll(SMALLEST))),
                             SimdAll(2 * stiffness));
}

/* What the law is at a root */
typedef struct {
  SimdVector strength; /* by the strain alone, less that of the virgin material [Pa] */
  SimdVector rated;    /* factor of the rate */
  SimdVector slope;    /* of the whole [Pa] */
} AtRoot;

/* The roots of those points of half a batch that flow, from a first guess; NaN where there is none to be found */
SIMD_INLINE SimdVector FindRoots(const Plastic *plastic, PetscReal dt, SimdVector q, SimdVector strain, SimdVector soft, SimdBits flows,
                                 SimdVector growth, AtRoot *at)
{
  const PetscReal stiffness = 3 * plastic->elastic.mu + plastic->kinematic;
  SimdVector      low = {0}, high = q / stiffness, by_rate = {0}, by_strain, by_strain2, slope;
  SimdBits        open = flows;

  at->rated = SimdAll(1);
  for (PetscInt iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
    SimdVector whole, excess, over, bend, step, moved;
    SimdBits   found, settled;
    int64_t    left = 0;

    at->strength = GetStrength(plastic, strain + growth, &by_strain, &by_strain2);
    whole        = plastic->yield + at->strength;
    if (plastic->hardening == HARDENING_JOHNSON_COOK) at->rated = GetRate(plastic, growth, dt, &by_rate);
    excess    = q - stiffness * growth - soft * at->rated * whole;
    slope     = soft * (at->rated * by_strain + by_rate * whole);
    at->slope = iteration ? SimdSelect(open, slope, at->slope) : slope;
    low       = SimdSelect((SimdBits)(excess > 0), growth, low);
    high      = SimdSelect((SimdBits)(excess > 0), high, growth);
    /* of the logarithm: (log x)'' = -(log x)' / x */
    over  = 1 / (stiffness + slope);
    bend  = soft * (at->rated * by_strain2 + by_rate * (2 * by_strain - whole / SimdMax(growth, SimdAll(SMALLEST))));
    moved = growth + excess * over / SimdMax(1 + 0.5 * excess * over * over * bend, SimdAll(0.5));
    moved = SimdSelect((SimdBits)(moved > low) & (SimdBits)(moved < high), moved, 0.5 * (low + high));
    step  = moved - growth;
    /* whether the excess is round-off, and whether what is left to go is */
    found   = (SimdBits)(SimdMax(excess, -excess) <= TOLERANCE * q);
    settled = (SimdBits)(SimdMax(step, -step) <= LAST_STEP * moved) | (SimdBits)(high - low <= TOLERANCE * high);
    step    = SimdSelect(open & ~found, step, SimdAll(0));
    open &= ~(found | settled);
    growth += step;
    at->strength += by_strain * step;
    at->rated += by_rate * step;
    for (int p = 0; p < SIMD_WIDTH / SIMD_PARTS; p++) left |= open[p];
    if (!left) return growth;
  }
  return SimdSelect(open, SimdAll(NAN), growth);
}

/* Of these two, half a batch */
SIMD_INLINE void FindCurvedFlowOfPart(const Plastic *plastic, PetscReal dt, PetscInt part, const PetscReal equivalent[8],
                                      const PetscReal start[][8], PlasticFlow *flow)
{
  const SimdVector q = ((const SimdVector *)equivalent)[part], strain = ((const SimdVector *)start[PLASTIC_STRAIN])[part];
  const SimdVector before = ((const SimdVector *)start[PLASTIC_STRENGTH])[part], zero = {0};
  const PetscReal  stiffness = 3 * plastic->elastic.mu + plastic->kinematic, yield = plastic->yield;
  SimdVector       soft = SimdAll(1), excess, growth = zero, strength = before;
  AtRoot           at = {.rated = SimdAll(1)};
  SimdBits         flows;
  int64_t          any = 0;

  if (plastic->hardening == HARDENING_JOHNSON_COOK) soft = GetSoftening(plastic, ((const SimdVector *)start[PLASTIC_WORK])[part]);
  excess = q - soft * (yield + before);
  flows  = (SimdBits)(excess > 0); /* not where the stress is no number */
  for (int p = 0; p < SIMD_WIDTH / SIMD_PARTS; p++) any |= flows[p];
  if (any) {
    growth   = SimdSelect(flows, FirstGuess(plastic, excess, stiffness, soft, strain, before), zero);
    growth   = FindRoots(plastic, dt, q, strain, soft, flows, growth, &at);
    strength = SimdSelect(flows, at.strength, before);
    at.slope = SimdSelect(flows, at.slope, zero);
  }
  SimdGetParts(flow->strain)[part]   = growth;
  SimdGetParts(flow->strength)[part] = strength;
  SimdGetParts(flow->slope)[part]    = at.slope;
  /* at rest the mean of the strengths at both ends; what the rate adds is what it adds at the end */
  SimdGetParts(flow->work)[part] = soft * growth * (yield + 0.5 * (before + strength) + (at.rated - 1) * (yield + strength));
}

SIMD_CLONES static void FindCurvedFlow(const Plastic *plastic, PetscReal dt, const PetscReal q[8], const PetscReal start[][8],
                                       PlasticFlow *flow)
{
  for (PetscInt part = 0; part < SIMD_PARTS; part++) FindCurvedFlowOfPart(plastic, dt, part, q, start, flow);
}

/* Of a table: from one of its points to the next, and beyond them without hardening */
static void FlowAlongTable(const Plastic *plastic, PetscReal excess, PetscReal strain, PetscReal *growth, PetscReal *strength,
                           PetscReal *slope)
{
  const PetscReal stiffness = 3 * plastic->elastic.mu + plastic->kinematic;
  PetscInt        k         = 1;

  while (k < plastic->n_table && strain >= plastic->strain[k]) k++;
  for (;; k++) {
    const PetscBool last = (PetscBool)(k == plastic->n_table);
    const PetscReal room = last ? PETSC_MAX_REAL : plastic->strain[k] - (strain + *growth);
    PetscReal       step;

    *slope = last ? 0 : (plastic->stress[k] - plastic->stress[k - 1]) / (plastic->strain[k] - plastic->strain[k - 1]);
    step   = PetscMin(room, excess / (stiffness + *slope));
    *growth += step;
    *strength += *slope * step;
    excess -= (stiffness + *slope) * step;
    if (last || step < room) return;
  }
}

static void FindTableFlow(const Plastic *plastic, const PetscReal q[8], const PetscReal start[][8], PlasticFlow *flow)
{
  for (int p = 0; p < SIMD_WIDTH; p++) {
    const PetscReal before = start[PLASTIC_STRENGTH][p], excess = q[p] - (plastic->yield + before);

    flow->strain[p] = flow->slope[p] = 0;
    flow->strength[p]                = before;
    if (excess > 0) FlowAlongTable(plastic, excess, start[PLASTIC_STRAIN][p], &flow->strain[p], &flow->strength[p], &flow->slope[p]);
    flow->work[p] = flow->strain[p] * (plastic->yield + 0.5 * (before + flow->strength[p]));
  }
}

/* Where nothing is to flow */
static void FindNoFlow(const PetscReal start[][8], PlasticFlow *flow)
{
  for (int p = 0; p < SIMD_WIDTH; p++) {
    flow->strain[p] = flow->work[p] = flow->slope[p] = 0;
    flow->strength[p]                                = start[PLASTIC_STRENGTH][p];
  }
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

/* PlasticFindFlow - flow in a step dt at a batch of points, with the equivalent stress q without it; dt < 0: none */
void PlasticFindFlow(const Plastic *plastic, PetscReal dt, const PetscReal q[8], const PetscReal start[][8], PlasticFlow *flow)
{
  if (dt < 0) FindNoFlow(start, flow);
  else if (plastic->hardening == HARDENING_LINEAR) FindLinearFlow(plastic, q, start, flow);
  else if (plastic->hardening == HARDENING_TABLE) FindTableFlow(plastic, q, start, flow);
  else FindCurvedFlow(plastic, dt, q, start, flow);
}
