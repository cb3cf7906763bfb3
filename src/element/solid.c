/* Solid elements: set-up, and what is found of one element at a time. */
#include <impakt/private/solid.h>

/* Below this, times the largest extent of an element to the power of the dimension, a determinant is round-off */
#define DEGENERATE 1e-14

/* An error where the map from the reference element folds over, at a point of integration or at a node */
static PetscErrorCode CheckElement(Element element, PetscInt e)
{
  const Solid      *solid  = (const Solid *)element->data;
  const SolidShape *shape  = solid->shape;
  const PetscInt   *nodes  = element->connectivity + e * element->nodes;
  const PetscInt    dim    = element->dim;
  const PetscReal  *origin = solid->coordinates + dim * nodes[0];
  PetscReal         N[SOLID_MAX_NODES], gradient[SOLID_MAX_NODES * 3], extent = 0, least = PETSC_MAX_REAL;

  PetscFunctionBegin;
  for (PetscInt a = 1; a < element->nodes; a++)
    for (PetscInt i = 0; i < dim; i++) extent = PetscMax(extent, PetscAbsReal(solid->coordinates[dim * nodes[a] + i] - origin[i]));
  for (PetscInt k = 0; k < shape->n_points + element->nodes; k++) {
    const PetscReal *xi          = k < shape->n_points ? shape->points + dim * k : shape->corners + dim * (k - shape->n_points);
    const PetscReal  determinant = SolidGetShape(element, e, xi, N, gradient);

    if (!(determinant >= least)) least = determinant; /* keeps a NaN */
  }
  PetscCheck(least > DEGENERATE * PetscPowRealInt(extent, (int)dim), PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "Element %" PetscInt_FMT " of this rank, with a node at (%g, %g, %g) m, is inverted or degenerate: its Jacobian falls to %g; "
             "mend the mesh, in which vertices must run counterclockwise (the lower face of a hexahedron seen "
             "from above, the first face of a tetrahedron seen from its fourth vertex)",
             e, (double)origin[0], (double)origin[1], (double)(dim == 3 ? origin[2] : 0), (double)least);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether CheckElement() would pass all elements of a batch, beyond doubt: extents are taken twice as large, for round-off. At all the
   points at once, as one by one they would cost more than several time steps. */
SIMD_CLONES static PetscBool IsSound(const PetscInt connectivity[], PetscInt first, PetscInt count, PetscInt dim, PetscInt nodes,
                                     PetscInt n, const PetscReal dN[][SOLID_MAX_NODES * 3], const PetscReal coordinates[])
{
  SimdReal  x[SOLID_MAX_NODES][3], allowed;
  PetscBool sound = PETSC_TRUE;

  for (PetscInt p = 0; p < SIMD_WIDTH; p++) {
    const PetscInt *node   = connectivity + nodes * PetscMin(first + p, count - 1);
    PetscReal       extent = 0;

    for (PetscInt a = 0; a < nodes; a++)
      for (PetscInt i = 0; i < dim; i++) {
        x[a][i][p] = coordinates[dim * node[a] + i];
        extent     = PetscMax(extent, PetscAbsReal(x[a][i][p] - x[0][i][p]));
      }
    allowed[p] = DEGENERATE * 4 * extent * extent * (dim == 3 ? 2 * extent : 1);
  }
  for (PetscInt part = 0; part < SIMD_PARTS; part++)
    for (PetscInt k = 0; k < n; k++) {
      SimdVector J[3][3] = {{{0}}}, margin;

      if (dim == 2) J[2][2] += 1;
      for (PetscInt a = 0; a < nodes; a++)
        for (PetscInt i = 0; i < dim; i++)
          for (PetscInt j = 0; j < dim; j++) J[i][j] += SimdGetParts(x[a][i])[part] * dN[k][dim * a + j];
      margin = J[0][0] * (J[1][1] * J[2][2] - J[1][2] * J[2][1]) + J[0][1] * (J[1][2] * J[2][0] - J[1][0] * J[2][2]) +
               J[0][2] * (J[1][0] * J[2][1] - J[1][1] * J[2][0]) - SimdGetParts(allowed)[part];
      for (PetscInt p = 0; p < SIMD_WIDTH / SIMD_PARTS; p++)
        if (!(margin[p] > 0)) sound = PETSC_FALSE;
    }
  return sound;
}

static PetscErrorCode CheckElements(Element element)
{
  const Solid      *solid = (const Solid *)element->data;
  const SolidShape *shape = solid->shape;
  const PetscInt    dim = element->dim, n = shape->n_points + element->nodes;
  PetscReal         N[SOLID_MAX_NODES], dN[SOLID_MAX_POINTS + SOLID_MAX_NODES][SOLID_MAX_NODES * 3];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++)
    (*shape->shape)(k < shape->n_points ? shape->points + dim * k : shape->corners + dim * (k - shape->n_points), N, dN[k]);
  for (PetscInt first = 0; first < element->count; first += SIMD_WIDTH) {
    if (IsSound(element->connectivity, first, element->count, dim, element->nodes, n, (const PetscReal(*)[SOLID_MAX_NODES * 3]) dN,
                solid->coordinates))
      continue;
    for (PetscInt e = first; e < PetscMin(first + SIMD_WIDTH, element->count); e++) PetscCall(CheckElement(element, e));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementSetFromOptions_Solid(Element element)
{
  PetscBool plane_stress = element->plane_stress;

  PetscFunctionBegin;
  if (element->dim == 3) PetscFunctionReturn(PETSC_SUCCESS);
  PetscObjectOptionsBegin((PetscObject)element);
  PetscCall(
      PetscOptionsBool("-plane_stress", "Plane stress, else plane strain", "ElementSetPlaneStress", plane_stress, &plane_stress, NULL));
  PetscOptionsEnd();
  PetscCall(ElementReadSection(element));
  PetscCall(ElementSetPlaneStress(element, plane_stress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Additions and multiplications of the internal force of one element: at each point gradients of positions and displacements, cofactors,
   the displacement gradient, the stress (20 in three dimensions and 9 in two where it is linear; else those of neo-Hooke's law, whatever
   the law is), and the way back; then the sums at the nodes */
static PetscLogDouble CountFlops(const SolidShape *shape, PetscBool linear)
{
  const PetscInt dim = shape->dim, of_gradient = shape->n_points == 1 ? 0 : dim == 2 ? 4 : 18; /* of one component, by monomials */
  const PetscInt of_stress = dim == 3 ? (linear ? 20 : 68) : (linear ? 9 : 30), of_cofactors = dim == 3 ? 32 : 3;

  return (PetscLogDouble)(shape->n_points *
                              (3 * dim * of_gradient + of_cofactors + 1 + 2 * dim * dim * dim + of_stress + dim * dim * (2 * dim - 1)) +
                          shape->nodes * dim * (3 * dim + 1));
}

/* The part of the set-up that asks the material, and takes the coordinates */
PetscErrorCode SolidSetUpMaterial(Element element, const PetscReal coordinates[])
{
  Solid *solid = (Solid *)element->data;

  PetscFunctionBegin;
  solid->coordinates  = coordinates;
  solid->plane_stress = element->plane_stress;
  PetscCall(MaterialIsLinear(element->material, &solid->linear));
  PetscCall(MaterialSetPlaneStress(element->material, PETSC_FALSE));
  PetscCall(MaterialGetKernels(element->material, &solid->unconstrained));
  PetscCall(MaterialSetPlaneStress(element->material, solid->plane_stress));
  PetscCall(MaterialGetKernels(element->material, &solid->kernels));
  element->history.n      = solid->kernels.n_history ? solid->kernels.n_history + solid->own_history : 0;
  element->history.points = solid->shape->n_points;
  PetscCheck(element->history.n <= SOLID_MAX_HISTORY, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "The material has %" PetscInt_FMT " numbers of history for each point; at most %" PetscInt_FMT, solid->kernels.n_history,
             SOLID_MAX_HISTORY - solid->own_history);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementSetUp_Solid(Element element, const PetscReal coordinates[])
{
  const Solid *solid = (const Solid *)element->data;

  PetscFunctionBegin;
  PetscCall(SolidSetUpMaterial(element, coordinates));
  element->flops = CountFlops(solid->shape, solid->linear);
  PetscCall(CheckElements(element));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal GetPoint(Element element, PetscInt e, PetscInt g, PetscReal gradient[], PetscReal hoop[])
{
  const Solid      *solid = (const Solid *)element->data;
  const SolidShape *shape = solid->shape;
  const PetscInt   *nodes = element->connectivity + e * element->nodes;
  PetscReal         N[SOLID_MAX_NODES], weight, radius = 0;

  weight = SolidGetShape(element, e, shape->points + element->dim * g, N, gradient) * element->cross_section * shape->volume /
           shape->n_points;
  for (PetscInt a = 0; a < element->nodes; a++) hoop[a] = 0;
  if (!element->axisymmetric) return weight;
  for (PetscInt a = 0; a < element->nodes; a++) radius += N[a] * solid->coordinates[2 * nodes[a]];
  for (PetscInt a = 0; a < element->nodes; a++) hoop[a] = N[a] / radius;
  return weight * 2 * PETSC_PI * radius;
}

/* The viscous force of formulations that have no loop of their own for it: element by element, by the tangent */
PetscErrorCode SolidViscousForce(Element element, const PetscScalar u[], const PetscScalar v[], PetscScalar f[])
{
  const PetscInt dim = element->dim, n = element->nodes * dim;
  PetscScalar    C[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS];

  PetscFunctionBegin;
  for (PetscInt e = 0; e < element->count; e++) {
    const PetscInt *nodes = element->connectivity + e * element->nodes;

    PetscUseTypeMethod(element, tangent, e, PETSC_TRUE, u, C);
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt j = 0; j < n; j++) f[dim * nodes[i / dim] + i % dim] += C[i * n + j] * v[dim * nodes[j / dim] + j % dim];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By the load points: exact on simplices and parallelepipeds, where products of two shape functions are quadratic in each coordinate */
static PetscErrorCode ElementMass_Solid(Element element, PetscInt e, PetscScalar M[])
{
  const PetscInt n = element->nodes;
  PetscReal      positions[SOLID_MAX_POINTS * 3], weights[SOLID_MAX_POINTS], density;

  PetscFunctionBegin;
  PetscCall(MaterialGetDensity(element->material, &density));
  PetscCall(ElementPoints_Solid(element, e, positions, weights));
  PetscCall(PetscArrayzero(M, n * n));
  for (PetscInt g = 0; g < element->n_points; g++) {
    const PetscReal *N = element->shape + g * n;

    for (PetscInt a = 0; a < n; a++) {
      const PetscReal part = density * weights[g] * N[a];

      for (PetscInt b = 0; b < n; b++) M[a * n + b] += part * N[b];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementDestroy_Solid(Element element)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(((Solid *)element->data)->own));
  PetscCall(PetscFree(element->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All but the loops over all elements, which each shape has of its own */
PetscErrorCode ElementCreate_Solid(Element element, const SolidShape *shape)
{
  Solid *solid;

  PetscFunctionBegin;
  PetscCall(PetscNew(&solid));
  solid->shape = shape;
  solid->point = GetPoint;
  for (PetscInt g = 0; g < shape->n_load_points; g++)
    (*shape->shape)(shape->load_points + shape->dim * g, solid->load_shape + g * shape->nodes, solid->load_gradients[g]);
  solid->history               = &element->history;
  element->data                = solid;
  element->dim                 = shape->dim;
  element->nodes               = shape->nodes;
  element->n_points            = shape->n_load_points;
  element->shape               = solid->load_shape;
  element->ops->setfromoptions = ElementSetFromOptions_Solid;
  element->ops->setup          = ElementSetUp_Solid;
  element->ops->tangent        = ElementTangent_Solid;
  element->ops->energy         = ElementEnergy_Solid;
  element->ops->stress         = ElementStress_Solid;
  element->ops->plastic        = ElementPlastic_Solid;
  element->ops->nearest        = ElementNearest_Solid;
  element->ops->mass           = ElementMass_Solid;
  element->ops->points         = ElementPoints_Solid;
  element->ops->destroy        = ElementDestroy_Solid;
  PetscFunctionReturn(PETSC_SUCCESS);
}
