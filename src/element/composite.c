/* Composite elements: set-up, and what is found of one element at a time.

   P. Thoutireddy, J. F. Molinari, E. A. Repetto, M. Ortiz, International Journal for Numerical Methods in Engineering 53 (2002);
   J. T. Ostien, J. W. Foulk, A. Mota, M. G. Veilleux, ibid. 107 (2016): displacements are linear in each of 12 tetrahedra between the ten
   nodes and a node in the middle, the mean of the six others; of triangles in each of 4. Their gradients are projected on functions that
   are linear over the whole element,

     grad N_a (x) = sum over corners c, d of lambda_c(x) (M^-1)_cd sum over parts s of V_s lambda_d(centre of s) (grad N_a)_s

   with the element's barycentric coordinates lambda, of the undeformed element, and M_cd the integral of lambda_c lambda_d. At points near
   the corners they are found once, with weights that integrate linear functions exactly, so that gradients have their mean and volumes
   are those of the parts.

   The ratio of volumes is the mean of the element to the power s, times that of the point to the power 1 - s (B. Moran, M. Ortiz, C. F.
   Shih, International Journal for Numerical Methods in Engineering 29, 1990). Of the mean alone, s = 1, tetrahedra have three motions that
   store nothing, those that change angles nowhere and volumes not on average; in plane strain angles to the plane change with them. What a
   change of volume that is not the mean stores is (1 - s)^2 kappa, which is made STIFFNESS times the shear modulus mu, as changes of shape
   store whatever Poisson's ratio is. */
#include "composite.h"
#include <impakt/private/materialimpl.h>

/* Modulus of changes of volume within tetrahedra, in parts of the shear modulus. A copper rod of 6 x 44 elements that flattens on a wall
   turned some inside out, or gained 2 % of its energy, with 0.02. */
#define STIFFNESS 0.75
/* 1 - s at most, and for materials without a ratio of Poisson */
#define LARGEST 0.5
#define UNKNOWN 0.1
/* Below this part of the mean of all, the volume of a linear part is round-off */
#define DEGENERATE 1e-10
/* Of what loops over batches read: a line of the cache, and what vectors want [bytes] */
#define ALIGNMENT 64

/* An element where it lies: what is found part by part starts from this */
typedef struct {
  const CompositeShape *shape;
  PetscInt              dim, corners, nodes;
  PetscReal             x[COMPOSITE_MAX_NODES + 1][3]; /* of its nodes, and of the one in the middle; 0 across the plane [m] */
} Geometry;

static Geometry GetGeometry(Element element, PetscInt e)
{
  const Solid    *solid = (const Solid *)element->data;
  const PetscInt *nodes = element->connectivity + e * element->nodes;
  Geometry        at    = {
      .shape = ((const Composite *)solid->own)->shape, .dim = element->dim, .corners = element->dim + 1, .nodes = element->nodes};

  for (PetscInt d = 0; d < at.dim; d++)
    for (PetscInt a = 0; a < at.nodes; a++) {
      at.x[a][d] = solid->coordinates[at.dim * nodes[a] + d];
      if (a >= at.corners) at.x[at.nodes][d] += at.x[a][d] / (PetscReal)(at.nodes - at.corners);
    }
  return at;
}

/* What a function of the nodes of a part is of those of the element: N[part] of its nodes, added to N of the element's */
static void AddToNodes(const CompositeShape *shape, PetscInt part, const PetscReal N[], PetscReal of_element[])
{
  const PetscInt corners = shape->solid.dim + 1, nodes = shape->solid.nodes;

  for (PetscInt k = 0; k < corners; k++) {
    const PetscInt node = shape->parts[part * corners + k];

    if (node < nodes) of_element[node] += N[k];
    else
      for (PetscInt a = corners; a < nodes; a++) of_element[a] += N[k] / (PetscReal)(nodes - corners);
  }
}

static PetscReal GetPart(const Geometry *at, PetscInt part, PetscReal gradient[4][3])
{
  const PetscInt  dim = at->dim, *nodes = at->shape->parts + part * at->corners;
  PetscReal       edge[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, determinant = 0;
  const PetscReal unit_volume = dim == 2 ? 0.5 : 1. / 6;

  for (PetscInt i = 0; i < dim; i++)
    for (PetscInt d = 0; d < dim; d++) edge[i][d] = at->x[nodes[i + 1]][d] - at->x[nodes[0]][d];
  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt j = 0; j < 3; j++)
      gradient[1 + i][j] = edge[(i + 1) % 3][(j + 1) % 3] * edge[(i + 2) % 3][(j + 2) % 3] -
                           edge[(i + 1) % 3][(j + 2) % 3] * edge[(i + 2) % 3][(j + 1) % 3];
  for (PetscInt d = 0; d < 3; d++) determinant += edge[0][d] * gradient[1][d];
  for (PetscInt d = 0; d < 3; d++) {
    gradient[0][d] = 0;
    for (PetscInt i = 0; i < dim; i++) {
      gradient[1 + i][d] /= determinant;
      gradient[0][d] -= gradient[1 + i][d];
    }
  }
  return unit_volume * determinant;
}

static void GetBarycentric(const CompositeShape *shape, PetscReal lambda[COMPOSITE_MAX_NODES + 1][4])
{
  static const PetscInt edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  const PetscInt        corners = shape->solid.dim + 1, nodes = shape->solid.nodes;

  for (PetscInt c = 0; c < corners; c++) {
    for (PetscInt a = 0; a < corners; a++) lambda[a][c] = a == c;
    for (PetscInt a = corners; a < nodes; a++) lambda[a][c] = 0.5 * ((edges[a - corners][0] == c) + (edges[a - corners][1] == c));
    lambda[nodes][c] = 1 / (PetscReal)corners;
  }
}

/* Solves M x = b for several right sides, M symmetric and positive definite; x in place of b */
static void Solve(PetscInt n, PetscReal M[4][4], PetscInt n_sides, PetscReal b[4][COMPOSITE_MAX_PARTS])
{
  for (PetscInt k = 0; k < n; k++)
    for (PetscInt i = 0; i < n; i++) {
      const PetscReal factor = M[i][k] / M[k][k];

      if (i == k) continue;
      for (PetscInt j = k; j < n; j++) M[i][j] -= factor * M[k][j];
      for (PetscInt s = 0; s < n_sides; s++) b[i][s] -= factor * b[k][s];
    }
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt s = 0; s < n_sides; s++) b[i][s] /= M[i][i];
}

/* Gradients of the shape functions at the points, and weights, of one element */
static PetscErrorCode FillElement(Element element, PetscInt e, PetscReal gradients[][COMPOSITE_MAX_NODES][3], PetscReal weights[])
{
  const Geometry        at    = GetGeometry(element, e);
  const CompositeShape *shape = at.shape;
  const PetscInt        dim = at.dim, corners = at.corners;
  PetscReal             lambda[COMPOSITE_MAX_NODES + 1][4], volumes[COMPOSITE_MAX_PARTS], volume = 0;
  PetscReal             of_part[COMPOSITE_MAX_PARTS][COMPOSITE_MAX_NODES][3] = {{{0}}};
  PetscReal             M[4][4] = {{0}}, moments[4] = {0}, b[4][COMPOSITE_MAX_PARTS];

  PetscFunctionBegin;
  GetBarycentric(shape, lambda);
  for (PetscInt s = 0; s < shape->n_parts; s++) {
    PetscReal gradient[4][3], sum[4];

    volumes[s] = GetPart(&at, s, gradient);
    volume += volumes[s];
    for (PetscInt d = 0; d < dim; d++) {
      PetscReal N[4], nodal[COMPOSITE_MAX_NODES] = {0};

      for (PetscInt k = 0; k < corners; k++) N[k] = gradient[k][d];
      AddToNodes(shape, s, N, nodal);
      for (PetscInt a = 0; a < element->nodes; a++) of_part[s][a][d] = nodal[a];
    }
    for (PetscInt c = 0; c < corners; c++) {
      sum[c] = 0;
      for (PetscInt k = 0; k < corners; k++) sum[c] += lambda[shape->parts[s * corners + k]][c];
      b[c][s] = volumes[s] * sum[c] / (PetscReal)corners;
      moments[c] += b[c][s];
    }
    for (PetscInt c = 0; c < corners; c++)
      for (PetscInt d = 0; d < corners; d++) {
        PetscReal products = sum[c] * sum[d];

        for (PetscInt k = 0; k < corners; k++)
          products += lambda[shape->parts[s * corners + k]][c] * lambda[shape->parts[s * corners + k]][d];
        M[c][d] += volumes[s] * products / (PetscReal)(corners * (corners + 1));
      }
  }
  for (PetscInt s = 0; s < shape->n_parts; s++)
    PetscCheck(volumes[s] > DEGENERATE * PetscAbsReal(volume) / (PetscReal)shape->n_parts, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "Element %" PetscInt_FMT " of this rank, of %" PetscInt_FMT
               " nodes and with a corner at (%g, %g, %g) m, is inverted or degenerate: one of the %" PetscInt_FMT
               " linear elements that it is made of has the %s %g; mend the mesh, in which mid-side nodes must lie near the "
               "middle of their edges",
               e, element->nodes, (double)at.x[0][0], (double)at.x[0][1], (double)at.x[0][2], shape->n_parts, dim == 3 ? "volume" : "area",
               (double)volumes[s]);
  for (PetscInt g = 0; g < corners; g++) {
    weights[g] = (moments[g] - shape->far * volume) / (shape->near - shape->far);
    PetscCheck(weights[g] > 0, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "Element %" PetscInt_FMT " of this rank, of %" PetscInt_FMT
               " nodes and with a corner at (%g, %g, %g) m, is too distorted: move its mid-side nodes nearer to the middle of their edges",
               e, element->nodes, (double)at.x[0][0], (double)at.x[0][1], (double)at.x[0][2]);
  }
  Solve(corners, M, shape->n_parts, b);
  for (PetscInt g = 0; g < corners; g++)
    for (PetscInt a = 0; a < element->nodes; a++)
      for (PetscInt d = 0; d < dim; d++) {
        gradients[g][a][d] = 0;
        for (PetscInt s = 0; s < shape->n_parts; s++) {
          PetscReal share = 0;

          for (PetscInt c = 0; c < corners; c++) share += (c == g ? shape->near : shape->far) * b[c][s];
          gradients[g][a][d] += share * of_part[s][a][d];
        }
      }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gradients of all elements; past the last one in a batch, it is taken again */
static PetscErrorCode FillAll(Element element)
{
  Solid         *solid     = (Solid *)element->data;
  Composite     *composite = (Composite *)solid->own;
  const PetscInt points = solid->shape->n_points, nodes = element->nodes, dim = element->dim;
  const PetscInt batches  = (element->count + SIMD_WIDTH - 1) / SIMD_WIDTH;
  const size_t   of_batch = (size_t)points * SIMD_WIDTH, size = (size_t)batches * of_batch * (size_t)(nodes * dim);
  size_t         beyond;

  PetscFunctionBegin;
  PetscCall(PetscMalloc((size + (size_t)batches * of_batch) * sizeof(PetscReal) + ALIGNMENT, &composite->memory));
  beyond               = (size_t)((PETSC_UINTPTR_T)composite->memory % ALIGNMENT);
  composite->gradients = (PetscReal *)(void *)((char *)composite->memory + (ALIGNMENT - beyond) % ALIGNMENT);
  composite->weights   = composite->gradients + size;
  for (PetscInt slot = 0; slot < batches * SIMD_WIDTH; slot++) {
    PetscReal  gradients[4][COMPOSITE_MAX_NODES][3] = {{{0}}}, weights[4] = {0};
    PetscReal *to         = composite->gradients + (size_t)(slot / SIMD_WIDTH) * of_batch * (size_t)(nodes * dim) + slot % SIMD_WIDTH;
    PetscReal *weights_to = composite->weights + (size_t)(slot / SIMD_WIDTH) * of_batch + slot % SIMD_WIDTH;

    PetscCall(FillElement(element, PetscMin(slot, element->count - 1), gradients, weights));
    for (PetscInt g = 0; g < points; g++) {
      weights_to[g * SIMD_WIDTH] = weights[g];
      for (PetscInt a = 0; a < nodes; a++)
        for (PetscInt d = 0; d < dim; d++) to[((g * nodes + a) * dim + d) * SIMD_WIDTH] = gradients[g][a][d];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gradients of the shape functions at a point of an element, and its weight with the thickness */
static PetscReal GetPoint(Element element, PetscInt e, PetscInt g, PetscReal gradient[], PetscReal hoop[])
{
  const Solid     *solid     = (const Solid *)element->data;
  const Composite *composite = (const Composite *)solid->own;
  const PetscInt   points = solid->shape->n_points, n = element->nodes * element->dim;
  const PetscReal *from = composite->gradients + (size_t)(e / SIMD_WIDTH * points + g) * (size_t)(n * SIMD_WIDTH) + e % SIMD_WIDTH;

  for (PetscInt i = 0; i < n; i++) gradient[i] = from[i * SIMD_WIDTH];
  for (PetscInt a = 0; a < element->nodes; a++) hoop[a] = 0;
  return element->cross_section * composite->weights[(size_t)(e / SIMD_WIDTH * points + g) * SIMD_WIDTH + (size_t)(e % SIMD_WIDTH)];
}

/* Points at which loads are integrated: those of all parts, near their nodes */
static PetscErrorCode ElementPoints_Composite(Element element, PetscInt e, PetscReal positions[], PetscReal weights[])
{
  const Geometry        at    = GetGeometry(element, e);
  const CompositeShape *shape = at.shape;
  const PetscInt        dim = at.dim, corners = at.corners;

  PetscFunctionBegin;
  for (PetscInt s = 0; s < shape->n_parts; s++) {
    PetscReal       gradient[4][3];
    const PetscReal volume = GetPart(&at, s, gradient);

    for (PetscInt g = 0; g < corners; g++) {
      weights[s * corners + g] = element->cross_section * volume / (PetscReal)corners;
      for (PetscInt d = 0; d < dim; d++) {
        PetscReal *position = &positions[(s * corners + g) * dim + d];

        *position = 0;
        for (PetscInt k = 0; k < corners; k++) *position += (k == g ? shape->near : shape->far) * at.x[shape->parts[s * corners + k]][d];
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Exact: products of functions that are linear in each part */
static PetscErrorCode ElementMass_Composite(Element element, PetscInt e, PetscScalar M[])
{
  const Geometry        at      = GetGeometry(element, e);
  const CompositeShape *shape   = at.shape;
  const PetscInt        corners = at.corners, nodes = at.nodes;
  PetscReal             density;

  PetscFunctionBegin;
  PetscCall(MaterialGetDensity(element->material, &density));
  PetscCall(PetscArrayzero(M, nodes * nodes));
  for (PetscInt s = 0; s < shape->n_parts; s++) {
    PetscReal       gradient[4][3], of_node[4][COMPOSITE_MAX_NODES] = {{0}};
    const PetscReal mass = density * element->cross_section * GetPart(&at, s, gradient) / (PetscReal)(corners * (corners + 1));

    for (PetscInt k = 0; k < corners; k++) {
      PetscReal one[4] = {0};

      one[k] = 1;
      AddToNodes(shape, s, one, of_node[k]);
    }
    for (PetscInt k = 0; k < corners; k++)
      for (PetscInt l = 0; l < corners; l++)
        for (PetscInt a = 0; a < nodes; a++)
          for (PetscInt b = 0; b < nodes && of_node[k][a] != 0; b++)
            M[a * nodes + b] += mass * (k == l ? 2 : 1) * of_node[k][a] * of_node[l][b];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In the part that is nearest */
static PetscErrorCode ElementNearest_Composite(Element element, PetscInt e, const PetscReal point[], PetscReal N[], PetscReal *distance)
{
  const Geometry        at    = GetGeometry(element, e);
  const CompositeShape *shape = at.shape;
  const PetscInt        dim = at.dim, corners = at.corners;

  PetscFunctionBegin;
  *distance = PETSC_MAX_REAL;
  for (PetscInt s = 0; s < shape->n_parts; s++) {
    const PetscInt *nodes = shape->parts + s * corners;
    PetscReal       gradient[4][3], L[4], sum = 0, squares = 0;

    (void)GetPart(&at, s, gradient);
    for (PetscInt k = 0; k < corners; k++) {
      L[k] = k ? 0 : 1;
      for (PetscInt d = 0; d < dim; d++) L[k] += gradient[k][d] * (point[d] - at.x[nodes[0]][d]);
      L[k] = PetscMax(0, L[k]);
      sum += L[k];
    }
    for (PetscInt d = 0; d < dim; d++) {
      PetscReal miss = point[d];

      for (PetscInt k = 0; k < corners; k++) miss -= L[k] / sum * at.x[nodes[k]][d];
      squares += PetscSqr(miss);
    }
    if (PetscSqrtReal(squares) >= *distance) continue;
    *distance = PetscSqrtReal(squares);
    for (PetscInt k = 0; k < corners; k++) L[k] /= sum;
    for (PetscInt a = 0; a < element->nodes; a++) N[a] = 0;
    AddToNodes(shape, s, L, N);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementSetUp_Composite(Element element, const PetscReal coordinates[])
{
  Solid         *solid = (Solid *)element->data;
  const PetscInt dim   = element->dim;

  PetscFunctionBegin;
  PetscCall(SolidSetUpMaterial(element, coordinates));
  /* as those of fully integrated elements: what changes is that gradients are those of all nodes, and are read */
  element->flops = (PetscLogDouble)(solid->shape->n_points * (4 * element->nodes * dim * dim + (solid->linear ? 20 : 100)));
  PetscCall(FillAll(element));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementDestroy_Composite(Element element)
{
  Composite *composite = (Composite *)((Solid *)element->data)->own;

  PetscFunctionBegin;
  PetscCall(PetscFree(composite->memory));
  PetscCall(PetscFree(composite));
  PetscCall(PetscFree(element->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* s */
static PetscErrorCode GetShare(Element element, PetscReal *share)
{
  PetscReal ratio, shear;

  PetscFunctionBegin;
  *share = element->dim == 3 ? 1 - UNKNOWN : 1;
  if (element->dim == 2 || !element->material->isotropic) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MaterialGetPoissonsRatio(element->material, &ratio));
  shear = 1.5 * (1 - 2 * ratio) / (1 + ratio); /* mu / kappa */
  if (shear > 0) *share = 1 - PetscMin(LARGEST, PetscSqrtReal(STIFFNESS * shear));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All but the loops over all elements, of an element that has been made as one of the linear ones */
PetscErrorCode ElementCreate_Composite(Element element, const CompositeShape *shape)
{
  Solid         *solid   = (Solid *)element->data;
  const PetscInt corners = shape->solid.dim + 1;
  Composite     *composite;

  PetscFunctionBegin;
  PetscCall(PetscNew(&composite));
  composite->shape    = shape;
  solid->own          = composite;
  solid->shape        = &shape->solid;
  solid->point        = GetPoint;
  element->nodes      = shape->solid.nodes;
  element->n_points   = shape->solid.n_load_points;
  element->shape      = composite->load_shape;
  element->ops->setup = ElementSetUp_Composite;
  for (PetscInt s = 0; s < shape->n_parts; s++)
    for (PetscInt g = 0; g < corners; g++) {
      PetscReal N[4];

      for (PetscInt k = 0; k < corners; k++) N[k] = k == g ? shape->near : shape->far;
      AddToNodes(shape, s, N, composite->load_shape + (s * corners + g) * element->nodes);
    }
  element->ops->nearest = ElementNearest_Composite;
  element->ops->mass    = ElementMass_Composite;
  element->ops->points  = ElementPoints_Composite;
  element->ops->destroy = ElementDestroy_Composite;
  if (!element->plane_stress) PetscCall(GetShare(element, &solid->mean_share));
  PetscFunctionReturn(PETSC_SUCCESS);
}
