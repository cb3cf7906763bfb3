/* Points in solid elements: those of loads, and the one that is nearest to a position. */
#include <impakt/private/solid.h>

/* det(dX/dxi) where shape functions have these gradients by the reference coordinates; X: positions of the nodes, three numbers each */
static PetscReal GetDeterminant(PetscInt nodes, PetscInt dim, const PetscReal X[], const PetscReal dN[])
{
  PetscReal x[3][3] = {{0}};

  if (dim == 2) {
    for (PetscInt a = 0; a < nodes; a++)
      for (PetscInt i = 0; i < 2; i++)
        for (PetscInt j = 0; j < 2; j++) x[i][j] += X[3 * a + i] * dN[2 * a + j];
    return x[0][0] * x[1][1] - x[0][1] * x[1][0];
  }
  for (PetscInt a = 0; a < nodes; a++)
    for (PetscInt i = 0; i < 3; i++)
      for (PetscInt j = 0; j < 3; j++) x[i][j] += X[3 * a + i] * dN[3 * a + j];
  return x[0][0] * (x[1][1] * x[2][2] - x[1][2] * x[2][1]) + x[0][1] * (x[1][2] * x[2][0] - x[1][0] * x[2][2]) +
         x[0][2] * (x[1][0] * x[2][1] - x[1][1] * x[2][0]);
}

/* Shape functions at a point of an element and their gradients by the undeformed position (nodes x dim); returns det(dX/dxi) */
PetscReal SolidGetShape(Element element, PetscInt e, const PetscReal xi[], PetscReal N[], PetscReal gradient[])
{
  const Solid    *solid = (const Solid *)element->data;
  const PetscInt *nodes = element->connectivity + e * element->nodes;
  const PetscInt  dim   = element->dim;
  PetscReal       dN[SOLID_MAX_NODES * 3], x[3][3] = {{0}}, cofactor[3][3], determinant;

  (*solid->shape->shape)(xi, N, dN);
  if (dim == 2) x[2][2] = 1;
  for (PetscInt a = 0; a < element->nodes; a++)
    for (PetscInt i = 0; i < dim; i++)
      for (PetscInt j = 0; j < dim; j++) x[i][j] += solid->coordinates[dim * nodes[a] + i] * dN[dim * a + j];
  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt j = 0; j < 3; j++)
      cofactor[i][j] = x[(i + 1) % 3][(j + 1) % 3] * x[(i + 2) % 3][(j + 2) % 3] -
                       x[(i + 1) % 3][(j + 2) % 3] * x[(i + 2) % 3][(j + 1) % 3];
  determinant = x[0][0] * cofactor[0][0] + x[0][1] * cofactor[0][1] + x[0][2] * cofactor[0][2];
  for (PetscInt a = 0; a < element->nodes; a++)
    for (PetscInt i = 0; i < dim; i++) {
      gradient[dim * a + i] = 0;
      for (PetscInt j = 0; j < dim; j++) gradient[dim * a + i] += cofactor[i][j] * dN[dim * a + j] / determinant;
    }
  return determinant;
}

/* Points at which loads of the body are integrated, with the part of the element's volume that each stands for */
PetscErrorCode ElementPoints_Solid(Element element, PetscInt e, PetscReal positions[], PetscReal weights[])
{
  const Solid      *solid                  = (const Solid *)element->data;
  const SolidShape *shape                  = solid->shape;
  const PetscInt   *nodes                  = element->connectivity + e * element->nodes;
  const PetscInt    dim                    = element->dim;
  PetscReal         X[SOLID_MAX_NODES * 3] = {0};

  PetscFunctionBegin;
  for (PetscInt a = 0; a < element->nodes; a++)
    for (PetscInt i = 0; i < dim; i++) X[3 * a + i] = solid->coordinates[dim * nodes[a] + i];
  for (PetscInt g = 0; g < shape->n_load_points; g++) {
    const PetscReal *N = solid->load_shape + g * shape->nodes;

    weights[g] = GetDeterminant(element->nodes, dim, X, solid->load_gradients[g]) * element->cross_section * shape->volume /
                 shape->n_load_points;
    for (PetscInt i = 0; i < dim; i++) {
      positions[dim * g + i] = 0;
      for (PetscInt a = 0; a < element->nodes; a++) positions[dim * g + i] += N[a] * X[3 * a + i];
    }
    if (element->axisymmetric) weights[g] *= 2 * PETSC_PI * positions[dim * g];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves a point of the reference coordinates into the reference element: a cube from -1 to 1, or a simplex from 0 to 1 */
static void MoveInside(Element element, PetscReal xi[])
{
  const PetscInt  dim     = element->dim;
  const PetscBool simplex = (PetscBool)(element->nodes == dim + 1);
  PetscReal       sum     = 0;

  for (PetscInt i = 0; i < dim; i++) {
    xi[i] = PetscMin(1, PetscMax(simplex ? 0 : -1, xi[i]));
    sum += xi[i];
  }
  for (PetscInt i = 0; i < dim && simplex && sum > 1; i++) xi[i] /= sum;
}

/* Shape functions at reference coordinates, and the residual to a position [m]; `change`: Newton's step of the reference coordinates */
static void GetMiss(Element element, PetscInt e, const PetscReal xi[], const PetscReal x[], PetscReal N[], PetscReal miss[3],
                    PetscReal change[3])
{
  const Solid    *solid = (const Solid *)element->data;
  const PetscInt *nodes = element->connectivity + e * element->nodes;
  const PetscInt  dim   = element->dim;
  PetscReal       dN[SOLID_MAX_NODES * 3], gradient[SOLID_MAX_NODES * 3];

  (*solid->shape->shape)(xi, N, dN);
  for (PetscInt d = 0; d < 3; d++) {
    miss[d] = d < dim ? x[d] : 0;
    for (PetscInt a = 0; a < element->nodes && d < dim; a++) miss[d] -= N[a] * solid->coordinates[dim * nodes[a] + d];
  }
  if (!change) return;
  /* the gradients of the reference coordinates by the position, from those of the shape functions: xi_i is sum_a N_a corner_a,i */
  (void)SolidGetShape(element, e, xi, N, gradient);
  for (PetscInt i = 0; i < dim; i++) {
    change[i] = 0;
    for (PetscInt a = 0; a < element->nodes; a++)
      for (PetscInt d = 0; d < dim; d++) change[i] += solid->shape->corners[dim * a + i] * gradient[dim * a + d] * miss[d];
  }
}

/* Newton's method for the reference coordinates, and then into the reference element */
PetscErrorCode ElementNearest_Solid(Element element, PetscInt e, const PetscReal x[], PetscReal N[], PetscReal *distance)
{
  const Solid *solid = (const Solid *)element->data;
  PetscReal    xi[3] = {0}, miss[3], change[3] = {0};

  PetscFunctionBegin;
  for (PetscInt d = 0; d < element->dim; d++) xi[d] = solid->shape->points[d];
  for (PetscInt iteration = 0; iteration < 50; iteration++) {
    PetscReal largest = 0;

    GetMiss(element, e, xi, x, N, miss, change);
    for (PetscInt d = 0; d < element->dim; d++) {
      xi[d]   = PetscMin(2, PetscMax(-2, xi[d] + change[d])); /* beyond, a distorted element may fold over */
      largest = PetscMax(largest, PetscAbsReal(change[d]));
    }
    if (largest < 1e-14) break;
  }
  MoveInside(element, xi);
  GetMiss(element, e, xi, x, N, miss, NULL);
  *distance = PetscSqrtReal(miss[0] * miss[0] + miss[1] * miss[1] + miss[2] * miss[2]);
  PetscFunctionReturn(PETSC_SUCCESS);
}
