/* Elements with one point of integration, one at a time: their tangent, and their viscosity. The formulation is in reducedloops.h. */
#include <element/reduced.h>

enum { MAX_DOFS = SOLID_MAX_NODES * 3, MOST_HOURGLASSES = 4, COMPONENTS = 3 * MOST_HOURGLASSES };

static const PetscReal middle[3] = {0};

/* One element. Hourglasses in the order of reducedloops.h: that without coordinate k is number k, the product of all three number 3. */
typedef struct {
  PetscInt  dim, nodes, hourglasses;
  PetscReal volume;                                       /* with the thickness */
  PetscReal modes[SOLID_MAX_NODES][3 + MOST_HOURGLASSES]; /* coefficients of the coordinates and their products in a shape function */
  PetscReal gradient[SOLID_MAX_NODES * 3],
      gamma[SOLID_MAX_NODES][MOST_HOURGLASSES]; /* mean gradients; the part of an hourglass that is left */
  PetscReal x[3][3], q[3][MOST_HOURGLASSES], squares[3];
} Reduced;

/* The mean gradients by the rule of the loads, which is exact for them; the volume with the thickness */
static PetscReal GetPoint(Element element, PetscInt e, PetscInt point, PetscReal mean[], PetscReal hoop[])
{
  const Solid      *solid  = (const Solid *)element->data;
  const SolidShape *shape  = solid->shape;
  PetscReal         volume = 0;

  (void)point;
  for (PetscInt a = 0; a < element->nodes; a++) hoop[a] = 0;
  for (PetscInt k = 0; k < element->nodes * element->dim; k++) mean[k] = 0;
  for (PetscInt g = 0; g < shape->n_load_points; g++) {
    PetscReal       N[SOLID_MAX_NODES], gradient[SOLID_MAX_NODES * 3];
    const PetscReal weight = SolidGetShape(element, e, shape->load_points + element->dim * g, N, gradient) * element->cross_section *
                             shape->volume / shape->n_load_points;

    volume += weight;
    for (PetscInt k = 0; k < element->nodes * element->dim; k++) mean[k] += weight * gradient[k];
  }
  for (PetscInt k = 0; k < element->nodes * element->dim; k++) mean[k] /= volume;
  return volume;
}

/* Coefficients of the coordinates and their products: a shape function is the product of (1 + corner_k xi_k) / 2 */
static void GetModes(Element element, Reduced *reduced)
{
  const PetscReal *corners = ((const Solid *)element->data)->shape->corners;
  const PetscInt   dim     = element->dim;

  for (PetscInt a = 0; a < element->nodes; a++) {
    const PetscReal *c    = corners + dim * a;
    PetscReal       *mode = reduced->modes[a], part = 1. / element->nodes;

    for (PetscInt k = 0; k < dim; k++) mode[k] = part * c[k];
    if (dim == 2) mode[3] = part * c[0] * c[1];
    for (PetscInt k = 0; k < 3 && dim == 3; k++) mode[3 + k] = part * c[(k + 1) % 3] * c[(k + 2) % 3];
    if (dim == 3) mode[6] = part * c[0] * c[1] * c[2];
  }
}

static void Prepare(Element element, PetscInt e, PetscBool finite, const PetscScalar u[], Reduced *reduced)
{
  const Solid    *solid = (const Solid *)element->data;
  const PetscInt *nodes = element->connectivity + e * element->nodes;
  const PetscInt  dim = element->dim, n = element->nodes;
  PetscReal       X[3][3 + MOST_HOURGLASSES] = {{0}}, hoop[SOLID_MAX_NODES];

  PetscArrayzero(reduced, 1);
  reduced->dim         = dim;
  reduced->nodes       = n;
  reduced->hourglasses = dim == 3 ? MOST_HOURGLASSES : 1;
  reduced->volume      = GetPoint(element, e, 0, reduced->gradient, hoop);
  GetModes(element, reduced);
  for (PetscInt a = 0; a < n; a++)
    for (PetscInt i = 0; i < dim; i++) {
      const PetscReal at = solid->coordinates[dim * nodes[a] + i], moved = u[dim * nodes[a] + i];

      for (PetscInt k = 0; k < 3 + MOST_HOURGLASSES; k++) X[i][k] += at * reduced->modes[a][k];
      for (PetscInt k = 0; k < dim; k++) reduced->x[i][k] += (at + (finite ? moved : 0)) * reduced->modes[a][k];
    }
  for (PetscInt k = 0; k < dim; k++) {
    PetscReal square = 0;

    for (PetscInt i = 0; i < dim; i++) square += X[i][k] * X[i][k];
    reduced->squares[k] = 1 / square;
  }
  for (PetscInt a = 0; a < n; a++)
    for (PetscInt h = 0; h < reduced->hourglasses; h++) {
      reduced->gamma[a][h] = reduced->modes[a][3 + h];
      for (PetscInt j = 0; j < dim; j++) reduced->gamma[a][h] -= reduced->gradient[dim * a + j] * X[j][3 + h];
      for (PetscInt i = 0; i < dim; i++) reduced->q[i][h] += reduced->gamma[a][h] * u[dim * nodes[a] + i];
    }
}

/* s = dE / dc, linear in c; component h of coordinate k is number 4 k + h */
static void GetForcesOfHourglasses(const Hourglass *constants, const Reduced *reduced, const PetscReal c[COMPONENTS],
                                   PetscReal s[COMPONENTS])
{
  const PetscReal *squares = reduced->squares, third = reduced->volume / 3, ninth = reduced->volume / 9;

  for (PetscInt i = 0; i < COMPONENTS; i++) s[i] = 0;
  if (reduced->dim == 2) {
    for (PetscInt k = 0; k < 2; k++) s[4 * k] = third * constants->bending * squares[k] * squares[k] * c[4 * k];
    return;
  }
  for (PetscInt m = 0; m < 3; m++) {
    const PetscInt  k = (m + 1) % 3, l = (m + 2) % 3;
    const PetscReal along = c[4 * k + l] * squares[k], across = c[4 * l + k] * squares[l];
    const PetscReal twist = third * constants->shear * squares[k] * squares[l] * (c[5 * k] + c[5 * l]);

    s[4 * k + l] = third * squares[k] * (constants->bending * along + constants->coupling * across);
    s[4 * l + k] = third * squares[l] * (constants->bending * across + constants->coupling * along);
    s[5 * k] += twist;
    s[5 * l] += twist;
    s[4 * m + 3] = ninth * squares[m] * c[4 * m + 3] * (constants->stretch * squares[m] + constants->shear * (squares[k] + squares[l]));
  }
}

/* How c changes with the displacement of node a along i */
static void GetVariation(const Reduced *reduced, PetscBool finite, PetscInt a, PetscInt i, PetscReal dc[COMPONENTS])
{
  for (PetscInt k = 0; k < COMPONENTS; k++) dc[k] = 0;
  for (PetscInt k = 0; k < reduced->dim; k++)
    for (PetscInt h = 0; h < reduced->hourglasses; h++)
      dc[4 * k + h] = reduced->x[i][k] * reduced->gamma[a][h] + (finite ? reduced->modes[a][k] * reduced->q[i][h] : 0);
}

/* `geometric`: with what the forces of the hourglasses turn */
static void AddHourglasses(const Hourglass *constants, const Reduced *reduced, PetscBool finite, PetscBool geometric, PetscScalar K[])
{
  const PetscInt dim = reduced->dim, n = reduced->nodes * dim;
  PetscReal      c[COMPONENTS] = {0}, s[COMPONENTS], variation[MAX_DOFS][COMPONENTS];

  for (PetscInt k = 0; k < dim; k++)
    for (PetscInt h = 0; h < reduced->hourglasses; h++)
      for (PetscInt i = 0; i < dim; i++) c[4 * k + h] += reduced->x[i][k] * reduced->q[i][h];
  GetForcesOfHourglasses(constants, reduced, c, s);
  for (PetscInt row = 0; row < n; row++) GetVariation(reduced, finite, row / dim, row % dim, variation[row]);
  for (PetscInt column = 0; column < n; column++) {
    PetscReal change[COMPONENTS];

    GetForcesOfHourglasses(constants, reduced, variation[column], change);
    for (PetscInt row = 0; row < n; row++) {
      const PetscInt a = row / dim, b = column / dim;

      for (PetscInt k = 0; k < COMPONENTS; k++) K[row * n + column] += variation[row][k] * change[k];
      for (PetscInt k = 0; k < dim && geometric && row % dim == column % dim; k++)
        for (PetscInt h = 0; h < reduced->hourglasses; h++)
          K[row * n + column] += s[4 * k + h] * (reduced->modes[a][k] * reduced->gamma[b][h] + reduced->modes[b][k] * reduced->gamma[a][h]);
    }
  }
}

/* Hourglasses are damped as they are held */
static PetscErrorCode ElementTangent_Reduced(Element element, PetscInt e, PetscBool viscous, const PetscScalar u[], PetscScalar K[])
{
  const Solid    *solid  = (const Solid *)element->data;
  const PetscBool finite = (PetscBool)(viscous || !solid->linear);
  Reduced         reduced;

  PetscFunctionBegin;
  PetscCall(ElementTangent_Solid(element, e, viscous, u, K));
  Prepare(element, e, finite, u, &reduced);
  AddHourglasses((const Hourglass *)solid->own, &reduced, finite, (PetscBool)(finite && !viscous), K);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Constants of the material at zero strain, as MaterialLinearize() finds them */
static PetscErrorCode GetConstants(Element element, Hourglass *constants)
{
  const PetscReal undeformed[9] = {0};
  PetscReal       tangent[81], lambda, mu;
  MaterialKernels kernels;

  PetscFunctionBegin;
  PetscCall(MaterialSetPlaneStress(element->material, PETSC_FALSE));
  PetscCall(MaterialGetKernels(element->material, &kernels));
  (*kernels.tangent)(kernels.data, undeformed, tangent);
  lambda             = tangent[4];
  mu                 = tangent[9 + 1];
  constants->shear   = mu;
  constants->stretch = mu * (3 * lambda + 2 * mu) / (lambda + mu);
  /* the second strain of the plane is free to follow in two dimensions, and a strain of its own in three */
  constants->bending  = element->plane_stress ? constants->stretch : 4 * mu * (lambda + mu) / (lambda + 2 * mu);
  constants->coupling = constants->bending * 0.5 * lambda / (lambda + mu);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All but the loops over all elements */
PetscErrorCode ElementCreate_Solid_Reduced(Element element)
{
  Solid     *solid = (Solid *)element->data;
  Hourglass *constants;

  PetscFunctionBegin;
  PetscCall(PetscNew(&constants));
  solid->own = constants;
  PetscCall(GetConstants(element, constants));
  solid->reduced             = *solid->shape;
  solid->reduced.n_points    = 1;
  solid->reduced.points      = middle;
  solid->shape               = &solid->reduced;
  solid->point               = GetPoint;
  element->ops->tangent      = ElementTangent_Reduced;
  element->ops->viscousforce = SolidViscousForce;
  PetscFunctionReturn(PETSC_SUCCESS);
}
