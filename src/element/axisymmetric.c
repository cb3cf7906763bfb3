/*
   Elements that are rings about the axis x = 0, one at a time: their tangent, and their viscosity. The loops over all of them, and what
   they do, are in axisymmetricloops.h; a mean dilatation is that of meandilatation.c, with the strain along the ring as one more term.
*/
#include <impakt/private/solid.h>

enum { MAX_DOFS = 8, MAX_POINTS = 4 };

/* A point of integration, with what the displacement of each degree of freedom makes there */
typedef struct {
  PetscReal weight, J, ratio, third; /* ratio: r; third: pi / 3; 2 pi radius is in the weight */
  PetscReal F[9], H[9], P[9];        /* F, F' - 1, P' */
  PetscReal gradient[MAX_DOFS][9];   /* dF */
  PetscReal turned[MAX_DOFS][9];     /* F^-1 dF */
  PetscReal D[MAX_DOFS], g[MAX_DOFS];
} Point;

static PetscReal Contract(const PetscReal a[9], const PetscReal b[9])
{
  PetscReal sum = 0;

  for (PetscInt i = 0; i < 9; i++) sum += a[i] * b[i];
  return sum;
}

/* F^-1 of a ring, from which det F is returned */
static PetscReal Invert(const PetscReal F[9], PetscReal inverse[9])
{
  const PetscReal plane = F[0] * F[4] - F[1] * F[3];

  for (PetscInt i = 0; i < 9; i++) inverse[i] = 0;
  inverse[0] = F[4] / plane;
  inverse[1] = -F[1] / plane;
  inverse[3] = -F[3] / plane;
  inverse[4] = F[0] / plane;
  inverse[8] = 1 / F[8];
  return plane * F[8];
}

/* `finite`: with regard to rotations and changes of volume; else F is 1 in all but H */
static void FillPoint(Element element, PetscInt e, PetscInt g, PetscBool finite, const PetscScalar u[], Point *point)
{
  const Solid      *solid = (const Solid *)element->data;
  const SolidShape *shape = solid->shape;
  const PetscInt   *nodes = element->connectivity + e * element->nodes;
  PetscReal         N[SOLID_MAX_NODES], gradient[SOLID_MAX_NODES * 3], inverse[9], radius = 0;

  point->weight = SolidGetShape(element, e, shape->points + 2 * g, N, gradient) * shape->volume / shape->n_points;
  for (PetscInt a = 0; a < element->nodes; a++) radius += N[a] * solid->coordinates[2 * nodes[a]];
  point->weight *= 2 * PETSC_PI * radius;
  point->ratio = 1;
  for (PetscInt i = 0; i < 9; i++) point->H[i] = 0;
  for (PetscInt k = 0; k < 2 * element->nodes; k++) {
    const PetscInt a = k / 2, i = k % 2;

    for (PetscInt j = 0; j < 9; j++) point->gradient[k][j] = 0;
    for (PetscInt j = 0; j < 2; j++) point->gradient[k][3 * i + j] = gradient[2 * a + j];
    if (i == 0) point->gradient[k][8] = N[a] / radius;
    for (PetscInt j = 0; j < 9; j++) point->H[j] += PetscRealPart(u[2 * nodes[a] + i]) * point->gradient[k][j];
  }
  for (PetscInt i = 0; i < 9; i++) point->F[i] = (i % 4 ? 0 : 1) + (finite ? point->H[i] : 0);
  point->J = Invert(point->F, inverse);
  for (PetscInt k = 0; k < 2 * element->nodes; k++) {
    PetscReal *turned = point->turned[k];

    for (PetscInt i = 0; i < 3; i++)
      for (PetscInt j = 0; j < 3; j++) {
        turned[3 * i + j] = 0;
        for (PetscInt m = 0; m < 3; m++) turned[3 * i + j] += inverse[3 * i + m] * point->gradient[k][3 * m + j];
      }
    point->D[k] = turned[0] + turned[4] + turned[8];
    point->g[k] = 0;
  }
}

/* Theta, which is returned, and its derivative by each degree of freedom; then F' and the stress of each point */
static PetscReal FillMean(Element element, PetscInt e, PetscBool finite, PetscInt n_points, Point points[], PetscReal dtheta[])
{
  const PetscInt n      = 2 * element->nodes;
  PetscReal      volume = 0, theta = 0;

  for (PetscInt i = 0; i < n; i++) dtheta[i] = 0;
  for (PetscInt g = 0; g < n_points; g++) {
    volume += points[g].weight;
    theta += points[g].weight * (finite ? points[g].J : points[g].H[0] + points[g].H[4] + points[g].H[8]);
    for (PetscInt i = 0; i < n; i++) dtheta[i] += points[g].weight * points[g].J * points[g].D[i];
  }
  theta /= volume;
  for (PetscInt i = 0; i < n; i++) dtheta[i] /= volume;
  for (PetscInt g = 0; g < n_points; g++) {
    Point    *point = &points[g];
    PetscReal F[9];

    if (finite) {
      point->ratio = PetscPowReal(theta / point->J, 1. / 3); /* NaN where the point is inverted */
      for (PetscInt i = 0; i < 9; i++) point->H[i] = point->ratio * point->F[i] - (i % 4 ? 0 : 1);
    } else {
      const PetscReal change = (theta - (point->H[0] + point->H[4] + point->H[8])) / 3;

      for (PetscInt i = 0; i < 9; i += 4) point->H[i] += change;
    }
    SolidPointStress((const Solid *)element->data, e, g, point->H, point->P);
    for (PetscInt i = 0; i < 9; i++) F[i] = (i % 4 ? 0 : 1) + point->H[i];
    point->third = Contract(point->P, F) / 3;
    for (PetscInt i = 0; i < n; i++) point->g[i] = (dtheta[i] / (finite ? theta : 1) - point->D[i]) / 3;
  }
  return theta;
}

static void AddMaterialPart(PetscInt n, const Point *point, const PetscReal tangent[81], PetscScalar K[])
{
  PetscReal variation[MAX_DOFS][9];

  for (PetscInt i = 0; i < n; i++)
    for (PetscInt k = 0; k < 9; k++) variation[i][k] = point->ratio * (point->gradient[i][k] + point->g[i] * point->F[k]);
  for (PetscInt j = 0; j < n; j++) {
    PetscReal stress[9];

    for (PetscInt k = 0; k < 9; k++) stress[k] = point->weight * Contract(tangent + 9 * k, variation[j]);
    for (PetscInt i = 0; i < n; i++) K[i * n + j] += Contract(variation[i], stress);
  }
}

/* What the second derivative of F' adds; pressure: sum of w pi / (3 theta V), times V */
static void AddGeometricPart(PetscInt n, const Point *point, PetscReal theta, PetscReal pressure, const PetscReal dtheta[], PetscScalar K[])
{
  const PetscReal third = point->third;
  PetscReal       work[MAX_DOFS];

  for (PetscInt i = 0; i < n; i++) work[i] = Contract(point->P, point->gradient[i]);
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) {
      PetscReal trace = 0; /* T */

      for (PetscInt k = 0; k < 3; k++)
        for (PetscInt l = 0; l < 3; l++) trace += point->turned[i][3 * k + l] * point->turned[j][3 * l + k];
      K[i * n + j] += point->weight * (point->ratio * (work[i] * point->g[j] + point->g[i] * work[j]) +
                                       3 * third * point->g[i] * point->g[j] + third * (trace - dtheta[i] * dtheta[j] / (theta * theta)) +
                                       pressure * point->J * (point->D[i] * point->D[j] - trace));
    }
}

/* `viscous`: of the stress F C : dE/dt by the velocity */
static PetscErrorCode ElementTangent_Axisymmetric(Element element, PetscInt e, PetscBool viscous, const PetscScalar u[], PetscScalar K[])
{
  const Solid    *solid    = (const Solid *)element->data;
  const PetscInt  n_points = solid->shape->n_points, n = 2 * element->nodes;
  const PetscBool finite = (PetscBool)(viscous || !solid->linear), mean = solid->mean_dilatation;
  Point           points[MAX_POINTS];
  PetscReal       dtheta[MAX_DOFS], theta = 1, volume = 0, pressure = 0;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(K, n * n));
  for (PetscInt g = 0; g < n_points; g++) {
    FillPoint(element, e, g, (PetscBool)(mean && finite), u, &points[g]);
    volume += points[g].weight;
  }
  if (mean) theta = FillMean(element, e, finite, n_points, points, dtheta);
  for (PetscInt g = 0; g < n_points && mean; g++) pressure += points[g].weight * points[g].third / (theta * volume);
  for (PetscInt g = 0; g < n_points; g++) {
    PetscReal tangent[81];

    SolidTangent(solid, e, g, points[g].H, tangent);
    if (viscous) SolidTurnTangent(points[g].H, tangent);
    AddMaterialPart(n, &points[g], tangent, K);
    if (mean && finite && !viscous) AddGeometricPart(n, &points[g], theta, pressure, dtheta, K);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All but the loops over all elements */
PetscErrorCode ElementCreate_Solid_Axisymmetric(Element element, PetscBool mean_dilatation)
{
  PetscFunctionBegin;
  ((Solid *)element->data)->mean_dilatation = mean_dilatation;
  element->ops->tangent                     = ElementTangent_Axisymmetric;
  PetscFunctionReturn(PETSC_SUCCESS);
}
