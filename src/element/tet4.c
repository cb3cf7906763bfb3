/* Four-node tetrahedron, linear, one point. Vertices: the first three counterclockwise seen from the fourth. */
#include <impakt/private/solid.h>

#define DIM    3
#define NODES  4
#define MODES  3
#define POINTS 1
#define WEIGHT (1.0 / 6)
/* (5 - sqrt 5) / 20 and (5 + 3 sqrt 5) / 20: exact for quadratic functions (Hammer and Stroud 1956) */
#define A 0.13819660112501051518
#define B 0.58541019662496845446

static const PetscReal points[POINTS][DIM] = {{0.25, 0.25, 0.25}};
static const PetscReal load_points[4][DIM] = {{A, A, A}, {B, A, A}, {A, B, A}, {A, A, B}};
static const PetscReal corners[NODES][DIM] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/* Gradients of the monomials are constant */
#define TERMS 1
static const SolidTerm terms[TERMS] = {{1, 3, {0, 1, 2}, {0, 1, 2}}};

SIMD_INLINE void ModesOfNodes(const SimdVector n[NODES], SimdVector m[MODES])
{
  m[0] = n[1] - n[0];
  m[1] = n[2] - n[0];
  m[2] = n[3] - n[0];
}

SIMD_INLINE void NodesOfModes(const SimdVector m[MODES], SimdVector n[NODES])
{
  n[0] = -(m[0] + m[1] + m[2]);
  n[1] = m[0];
  n[2] = m[1];
  n[3] = m[2];
}

SIMD_INLINE void GradientOfModes(const SimdVector m[MODES], const PetscReal xi[DIM], SimdVector d[DIM])
{
  (void)xi;
  d[0] = m[0];
  d[1] = m[1];
  d[2] = m[2];
}

SIMD_INLINE void ModesOfGradient(const SimdVector d[DIM], const PetscReal xi[DIM], SimdVector m[MODES])
{
  (void)xi;
  m[0] += d[0];
  m[1] += d[1];
  m[2] += d[2];
}

#include <impakt/private/solidloops.h>

static void Shape(const PetscReal xi[], PetscReal N[], PetscReal dN[])
{
  N[0] = 1 - xi[0] - xi[1] - xi[2];
  for (PetscInt i = 0; i < DIM; i++) {
    N[1 + i] = xi[i];
    dN[i]    = -1;
    for (PetscInt a = 1; a < NODES; a++) dN[DIM * a + i] = a == 1 + i ? 1 : 0;
  }
}

static const SolidShape shape = {DIM, NODES, POINTS, 4, 1.0 / 6, &points[0][0], &load_points[0][0], &corners[0][0], Shape};

PetscErrorCode ElementCreate_Tet4(Element element)
{
  PetscFunctionBegin;
  PetscCall(Create(element, &shape));
  PetscFunctionReturn(PETSC_SUCCESS);
}
