/* The tangent and the viscosity of solid elements, one at a time: fully integrated, with a mean dilatation (dilatation.h), and
   rings (boxpoints.h), whose strain along them is one more term.

   With D = F^-T : dF at a point and d theta = sum of w J D / V over the points, of weights w and volume V,
     dF' = r (dF + g F) with g = (d theta / theta - D) / 3,
   and the second derivative of F' adds, with pi = P' : F',
     r (P' : d1F g2 + P' : d2F g1) + pi g1 g2 + pi / 3 (d2theta / theta - d1theta d2theta / theta^2 + T)
   where T is the trace of F^-1 d1F F^-1 d2F, and d2theta the sum of w J (D1 D2 - T) / V. A share of the mean less than 1, which composite
   elements have, is the factor of 1/3 wherever it stands. Without a mean dilatation F' is F, and g is 0. */
#include <impakt/private/solid.h>

enum { MAX_DOFS = SOLID_MAX_NODES * 3 };

/* A point of integration, with what the displacement of each degree of freedom makes there */
typedef struct {
  PetscReal weight, J, ratio, pi, third;              /* ratio: r; third: pi / 3 times the share */
  PetscReal F[9], inverse[9], H[9], P[9];             /* F, F^-T, F' - 1, P' */
  PetscReal gradient[MAX_DOFS];                       /* of the shape functions, nodes x dim */
  PetscReal hoop[SOLID_MAX_NODES];                    /* of rings: dF_33 for the first component */
  PetscReal turned[MAX_DOFS], along[MAX_DOFS];        /* F^-T : dF of the plane or space, and along rings; D is their sum */
  PetscReal D[MAX_DOFS], g[MAX_DOFS], work[MAX_DOFS]; /* g; P' : dF */
} Point;

/* Of a linear material: tangent_ijkl = F_im C_mjnl F_kn with F = 1 + H, in place of C */
void SolidTurnTangent(const PetscReal H[9], PetscReal tangent[81])
{
  PetscReal half[81];

  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt jkl = 0; jkl < 27; jkl++) {
      half[27 * i + jkl] = tangent[27 * i + jkl];
      for (PetscInt m = 0; m < 3; m++) half[27 * i + jkl] += H[3 * i + m] * tangent[27 * m + jkl];
    }
  for (PetscInt ij = 0; ij < 9; ij++)
    for (PetscInt k = 0; k < 3; k++)
      for (PetscInt l = 0; l < 3; l++) {
        tangent[9 * ij + 3 * k + l] = half[9 * ij + 3 * k + l];
        for (PetscInt n = 0; n < 3; n++) tangent[9 * ij + 3 * k + l] += H[3 * k + n] * half[9 * ij + 3 * n + l];
      }
}

/* The history of point g of element e at the start of the step */
static void GetHistory(const ElementHistory *history, PetscInt e, PetscInt g, PetscReal start[])
{
  for (PetscInt c = 0; c < history->n; c++)
    start[c] = history->start[SolidHistoryOffset(history, e, g) + (size_t)(c * SIMD_WIDTH + e % SIMD_WIDTH)];
}

/* The derivative of the stress at point g of element e, at displacement gradient H */
void SolidTangent(const Solid *solid, PetscInt e, PetscInt g, const PetscReal H[9], PetscReal tangent[81])
{
  PetscReal start[SOLID_MAX_HISTORY];

  if (!solid->history->start) {
    (*solid->kernels.tangent)(solid->kernels.data, H, tangent);
    return;
  }
  GetHistory(solid->history, e, g, start);
  (*solid->kernels.advancetangent)(solid->kernels.data, solid->history->step, H, start, tangent);
}

/* The stress there */
static void PointStress(const Solid *solid, PetscInt e, PetscInt g, const PetscReal H[9], PetscReal P[9])
{
  SimdReal all_H[9], all_P[9], all_start[SOLID_MAX_HISTORY];

  for (PetscInt i = 0; i < 9; i++)
    for (PetscInt p = 0; p < SIMD_WIDTH; p++) all_H[i][p] = H[i];
  if (solid->history->start) {
    PetscReal start[SOLID_MAX_HISTORY];

    GetHistory(solid->history, e, g, start);
    for (PetscInt c = 0; c < solid->history->n; c++)
      for (PetscInt p = 0; p < SIMD_WIDTH; p++) all_start[c][p] = start[c];
    (*solid->kernels.advance)(solid->kernels.data, solid->history->step, (const PetscReal(*)[SIMD_WIDTH])all_H,
                              (const PetscReal(*)[SIMD_WIDTH])all_start, NULL, all_P);
  } else (*solid->kernels.stress)(solid->kernels.data, (const PetscReal(*)[SIMD_WIDTH])all_H, all_P);
  for (PetscInt i = 0; i < 9; i++) P[i] = all_P[i][0];
}

/* F^-T, from which det F is returned */
static PetscReal Invert(const PetscReal F[9], PetscReal inverse[9])
{
  PetscReal J;

  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt j = 0; j < 3; j++)
      inverse[3 * i + j] = F[3 * ((i + 1) % 3) + (j + 1) % 3] * F[3 * ((i + 2) % 3) + (j + 2) % 3] -
                           F[3 * ((i + 1) % 3) + (j + 2) % 3] * F[3 * ((i + 2) % 3) + (j + 1) % 3];
  J = F[0] * inverse[0] + F[1] * inverse[1] + F[2] * inverse[2];
  for (PetscInt i = 0; i < 9; i++) inverse[i] /= J;
  return J;
}

/* The displacement gradient; the rest is for mean dilatation. `finite`: with rotations and changes of volume; else F is 1 in all but H */
static void FillPoint(Element element, PetscInt e, PetscInt g, PetscBool mean, PetscBool finite, const PetscScalar u[], Point *point)
{
  const Solid    *solid = (const Solid *)element->data;
  const PetscInt *nodes = element->connectivity + e * element->nodes;
  const PetscInt  dim   = element->dim;

  point->weight = (*solid->point)(element, e, g, point->gradient, point->hoop);
  point->ratio  = 1;
  for (PetscInt i = 0; i < 9; i++) point->H[i] = 0;
  for (PetscInt a = 0; a < element->nodes; a++) {
    for (PetscInt i = 0; i < dim; i++)
      for (PetscInt j = 0; j < dim; j++) point->H[3 * i + j] += u[dim * nodes[a] + i] * point->gradient[dim * a + j];
    point->H[8] += u[dim * nodes[a]] * point->hoop[a];
  }
  if (!mean) return;
  for (PetscInt i = 0; i < 9; i++) point->F[i] = (i % 4 ? 0 : 1) + (finite ? point->H[i] : 0);
  point->J = Invert(point->F, point->inverse);
  for (PetscInt k = 0; k < element->nodes * dim; k++) {
    const PetscInt a = k / dim, i = k % dim;

    point->turned[k] = 0;
    for (PetscInt j = 0; j < dim; j++) point->turned[k] += point->inverse[3 * i + j] * point->gradient[dim * a + j];
    point->along[k] = i ? 0 : point->inverse[8] * point->hoop[a];
    point->D[k]     = point->turned[k] + point->along[k];
  }
}

/* Of the mean: theta, and its derivative by each degree of freedom; then F' and the stress of each point. Returns theta. */
static PetscReal FillMean(Element element, PetscInt e, PetscBool finite, PetscInt n_points, Point points[], PetscReal dtheta[])
{
  const Solid    *solid = (const Solid *)element->data;
  const PetscInt  dim = element->dim, n = element->nodes * dim;
  const PetscReal third  = solid->mean_share / 3;
  PetscReal       volume = 0, theta = 0;

  for (PetscInt i = 0; i < n; i++) dtheta[i] = 0;
  for (PetscInt g = 0; g < n_points; g++) {
    volume += points[g].weight;
    theta += points[g].weight * (finite ? points[g].J : points[g].H[0] + points[g].H[4] + points[g].H[8]);
    for (PetscInt i = 0; i < n; i++) dtheta[i] += points[g].weight * points[g].J * points[g].D[i];
  }
  theta /= volume;
  for (PetscInt i = 0; i < n; i++) dtheta[i] /= volume;
  for (PetscInt g = 0; g < n_points; g++) {
    Point *point = &points[g];

    point->ratio = finite ? PetscPowReal(theta / point->J, third) : 1; /* NaN where the point is inverted */
    if (finite)
      for (PetscInt i = 0; i < 9; i++) point->H[i] = point->ratio * point->F[i] - (i % 4 ? 0 : 1);
    else {
      const PetscReal change = third * (theta - (point->H[0] + point->H[4] + point->H[8]));

      for (PetscInt i = 0; i < 9; i += 4) point->H[i] += change;
    }
    PointStress(solid, e, g, point->H, point->P);
    point->pi = 0;
    for (PetscInt i = 0; i < 9; i++) point->pi += point->P[i] * ((i % 4 ? 0 : 1) + point->H[i]);
    point->third = third * point->pi;
    for (PetscInt i = 0; i < n; i++) {
      point->g[i]    = third * (dtheta[i] / (finite ? theta : 1) - point->D[i]);
      point->work[i] = i % dim ? 0 : point->P[8] * point->hoop[i / dim];
      for (PetscInt j = 0; j < dim; j++) point->work[i] += point->P[3 * (i % dim) + j] * point->gradient[i / dim * dim + j];
    }
  }
  return theta;
}

/* dF' for the displacement of each degree of freedom: a row of it without mean dilatation, and F_33 of rings. `symmetric`: upper half. */
SIMD_INLINE void AddMaterialPart(PetscBool mean, PetscBool symmetric, Element element, const Point *point, const PetscReal tangent[81],
                                 PetscScalar K[])
{
  const PetscInt dim = element->dim, n = element->nodes * dim, length = mean ? 9 : 3;
  PetscReal      variation[MAX_DOFS][9], apart[MAX_DOFS];
  PetscInt       start[MAX_DOFS];

  for (PetscInt i = 0; i < n; i++) {
    const PetscReal hoop = i % dim ? 0 : point->hoop[i / dim];

    for (PetscInt k = 0; k < 9; k++) variation[i][k] = mean ? point->ratio * point->g[i] * point->F[k] : 0;
    for (PetscInt j = 0; j < dim; j++) variation[i][3 * (i % dim) + j] += point->ratio * point->gradient[i / dim * dim + j];
    if (mean) variation[i][8] += point->ratio * hoop;
    apart[i] = mean ? 0 : hoop;
    start[i] = mean ? 0 : 3 * (i % dim);
  }
  for (PetscInt j = 0; j < n; j++) {
    PetscReal stress[9];

    for (PetscInt k = 0; k < 9; k++) {
      stress[k] = point->weight * tangent[9 * k + 8] * apart[j];
      for (PetscInt l = start[j]; l < start[j] + length; l++) stress[k] += point->weight * tangent[9 * k + l] * variation[j][l];
    }
    for (PetscInt i = 0; i < (symmetric ? j + 1 : n); i++) {
      K[i * n + j] += apart[i] * stress[8];
      for (PetscInt k = start[i]; k < start[i] + length; k++) K[i * n + j] += variation[i][k] * stress[k];
    }
  }
}

/* What the second derivative of F' adds; pressure: sum of w pi / (3 theta V), times V */
static void AddGeometricPart(PetscBool symmetric, Element element, const Point *point, PetscReal theta, PetscReal pressure,
                             const PetscReal dtheta[], PetscScalar K[])
{
  const PetscInt  dim = element->dim, n = element->nodes * dim;
  const PetscReal weight = point->weight, third = point->third, square = 1 / (theta * theta);

  for (PetscInt i = 0; i < n; i++) {
    const PetscReal *turned = point->turned + i / dim * dim;
    const PetscInt   along  = i % dim;

    for (PetscInt j = symmetric ? i / dim * dim : 0; j < n; j += dim)
      for (PetscInt d = 0; d < dim; d++) {
        const PetscInt  k     = j + d;
        const PetscReal trace = turned[d] * point->turned[j + along] + point->along[i] * point->along[k]; /* T */

        K[i * n + k] += weight * (point->ratio * (point->work[i] * point->g[k] + point->g[i] * point->work[k]) +
                                  point->pi * point->g[i] * point->g[k] + third * (trace - dtheta[i] * dtheta[k] * square) +
                                  pressure * point->J * (point->D[i] * point->D[k] - trace));
      }
  }
}

/* `viscous`: of the stress F' C : dE'/dt by the velocity */
PetscErrorCode ElementTangent_Solid(Element element, PetscInt e, PetscBool viscous, const PetscScalar u[], PetscScalar K[])
{
  const Solid    *solid    = (const Solid *)element->data;
  const PetscInt  n_points = solid->shape->n_points, n = element->nodes * element->dim;
  const PetscBool finite = (PetscBool)(viscous || !solid->linear), mean = (PetscBool)(solid->mean_share > 0);
  /* half of K is enough where nothing flows; of linear materials it is found once */
  const PetscBool symmetric = (PetscBool)(!solid->linear && !solid->history->start);
  Point           points[SOLID_MAX_POINTS];
  PetscReal       dtheta[MAX_DOFS], theta = 1, volume = 0, pressure = 0;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(K, n * n));
  for (PetscInt g = 0; g < n_points; g++) FillPoint(element, e, g, mean, finite, u, &points[g]);
  if (mean) theta = FillMean(element, e, finite, n_points, points, dtheta);
  for (PetscInt g = 0; g < n_points && mean; g++) {
    volume += points[g].weight;
    pressure += points[g].weight * points[g].third / theta;
  }
  for (PetscInt g = 0; g < n_points; g++) {
    PetscReal tangent[81];

    SolidTangent(solid, e, g, points[g].H, tangent);
    if (viscous) SolidTurnTangent(points[g].H, tangent);
    if (mean) AddMaterialPart(PETSC_TRUE, symmetric, element, &points[g], tangent, K);
    else AddMaterialPart(PETSC_FALSE, symmetric, element, &points[g], tangent, K);
    if (mean && finite && !viscous) AddGeometricPart(symmetric, element, &points[g], theta, pressure / volume, dtheta, K);
  }
  for (PetscInt i = 0; i < n && symmetric; i++)
    for (PetscInt j = 0; j < i; j++) K[i * n + j] = K[j * n + i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives an element that has been made as a fully integrated one a mean dilatation */
PetscErrorCode ElementCreate_Solid_MeanDilatation(Element element)
{
  PetscFunctionBegin;
  PetscCheck(!element->plane_stress, PetscObjectComm((PetscObject)element), PETSC_ERR_USER_INPUT,
             "-%selement_formulation mean_dilatation: bodies in plane stress have a thickness that is free to change, so that their volume "
             "does not lock; use full or enhanced",
             ((PetscObject)element)->prefix ? ((PetscObject)element)->prefix : "");
  ((Solid *)element->data)->mean_share = 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}
