/* One row: weights that balance forces and moments, the normal, and the bend of the partner. */
#include "interfaceimpl.h"

/* A diagonal entry of the scaled equations of RowCorrect() below which its condition says nothing new: what the node shares with the
   partner lies within 1e-4 of the face size of a line or of a point */
#define NOTHING_NEW 1e-8
/* What a weight changes in proportion to has this part of the node's area beside its size: where a row sees the partner's edge alone, nodes
   behind the edge make up for what those on it cannot, and elsewhere they hardly change */
#define OF_AREA 0.01
/* Of a node at a corner, whose normal is not that of its faces, what lies before a face lies the more beside the normal the farther it is
   away. Beyond this, in parts of the face, weights would continue the partner as a line. */
#define BESIDE 2
/* Cosines of the angles up to which normals of both sides belong to a bend, 10 degrees, and from which on to an edge, 18 degrees. Discs of
   16 edges, whose faces are 22 degrees from each other, roll on their edges. */
#define BENT 0.985
#define EDGE 0.95

/* What a row makes of vectors of the nodes: n . (sum_j P_j x_j - x), and the part across the normal */
PetscReal TransferSplitRow(const Transfer transfer, const RowSet *set, PetscInt row, const PetscReal x[], const PetscReal columns[],
                           PetscReal across[])
{
  const PetscReal *normal = set->normals + transfer->dim * row;
  PetscReal        along  = 0;

  for (PetscInt d = 0; d < transfer->dim; d++) {
    across[d] = -x[3 * row + d];
    for (PetscInt j = set->offsets[row]; j < set->offsets[row + 1]; j++)
      across[d] += set->shares[j].value * columns[3 * set->columns[j] + d];
    along += normal[d] * across[d];
  }
  for (PetscInt d = 0; d < transfer->dim; d++) across[d] -= along * normal[d];
  return along;
}

/* What the conditions of RowCorrect() say of a point of the partner */
static void FindConditions(const PetscReal x[], PetscReal tangents[2][3], PetscReal size, const PetscReal point[], PetscReal condition[3])
{
  const PetscReal from[3] = {point[0] - x[0], point[1] - x[1], point[2] - x[2]};

  condition[0] = 1;
  condition[1] = Dot(from, tangents[0]) / size;
  condition[2] = Dot(from, tangents[1]) / size;
}

/* The a-th condition less what those before it say already */
static PetscReal Remainder(PetscInt a, PetscReal lower[3][3], const PetscReal condition[3])
{
  PetscReal rest[3];

  for (PetscInt k = 0; k <= a; k++) {
    rest[k] = condition[k];
    for (PetscInt b = 0; b < k; b++) rest[k] -= lower[k][b] * rest[b];
  }
  return rest[a];
}

/* Whether the row's place lies far beside all of the partner's nodes, as the a-th condition sees them */
static PetscBool IsBeside(PetscInt a, PetscReal lower[3][3], PetscInt n, const PetscReal x[], PetscReal tangents[2][3], PetscReal size,
                          const PetscReal *partners[], const Share shares[])
{
  const PetscReal place[3] = {1, 0, 0}, there = Remainder(a, lower, place);
  PetscReal       least = PETSC_MAX_REAL, most = -PETSC_MAX_REAL;

  for (PetscInt j = 0; j < n; j++) {
    PetscReal condition[3], rest;

    if (shares[j].area == 0) continue;
    FindConditions(x, tangents, size, partners[j], condition);
    rest  = Remainder(a, lower, condition);
    least = PetscMin(least, rest);
    most  = PetscMax(most, rest);
  }
  return (PetscBool)(PetscMax(least - there, there - most) > BESIDE);
}

/* What the change of a weight is proportional to */
static PetscReal Mobility(PetscReal weight, PetscReal area)
{
  return PetscAbsReal(weight) + OF_AREA * area;
}

/* Changes the weights by as little as possible, each in proportion to its size and area, such that they sum to one and sum_j P_j x_j - x is
   along the normal: then a force along the normal has the same resultant and the same moment on both sides. Along a tangent in which the
   partner's nodes do not differ, or lie far away, nothing is changed. */
void RowCorrect(PetscInt dim, PetscInt n, const PetscReal x[], const PetscReal normal[], const PetscReal *partners[], const Share shares[],
                PetscReal size, PetscReal weights[])
{
  PetscReal tangents[2][3], gram[3][3] = {{0}}, lower[3][3] = {{0}}, rest[3] = {1, 0, 0}, factors[3] = {0};

  if (dim == 1) return;
  UnitsAcross(dim, normal, tangents[0], tangents[1]);
  for (PetscInt j = 0; j < n; j++) {
    PetscReal condition[3];

    FindConditions(x, tangents, size, partners[j], condition);
    for (PetscInt a = 0; a < dim; a++) {
      rest[a] -= weights[j] * condition[a];
      for (PetscInt b = 0; b < dim; b++) gram[a][b] += Mobility(weights[j], shares[j].area) * condition[a] * condition[b];
    }
  }
  for (PetscInt a = 0; a < dim; a++) { /* Gaussian elimination that leaves out equations which say nothing new */
    if (gram[a][a] < NOTHING_NEW || (a && IsBeside(a, lower, n, x, tangents, size, partners, shares))) {
      for (PetscInt b = 0; b < dim; b++) gram[a][b] = gram[b][a] = a == b;
      rest[a] = 0;
      continue;
    }
    for (PetscInt r = a + 1; r < dim; r++) {
      lower[r][a] = gram[r][a] / gram[a][a];
      for (PetscInt b = a; b < dim; b++) gram[r][b] -= lower[r][a] * gram[a][b];
      rest[r] -= lower[r][a] * rest[a];
    }
  }
  for (PetscInt a = dim - 1; a >= 0; a--) {
    factors[a] = rest[a]; /* NOLINT(clang-analyzer-core.uninitialized.Assign): dim is at most 3 */
    for (PetscInt b = a + 1; b < dim; b++) factors[a] -= gram[a][b] * factors[b];
    factors[a] /= gram[a][a];
  }
  for (PetscInt j = 0; j < n; j++) {
    PetscReal condition[3];

    FindConditions(x, tangents, size, partners[j], condition);
    weights[j] += Mobility(weights[j], shares[j].area) * (factors[0] + factors[1] * condition[1] + factors[2] * condition[2]);
  }
}

/* A node of the partner on a sharp edge has no normal here: its faces count as flat */
static PetscBool IsOnEdge(const PetscReal normal[])
{
  return (PetscBool)(normal[0] == 0 && normal[1] == 0 && normal[2] == 0);
}

/* How far a bend counts, from 1 to 0, by the cosine of the angle of the normals */
static PetscReal BendCounts(PetscReal cosine)
{
  return PetscMin(1, PetscMax(0, (cosine - EDGE) / (BENT - EDGE)));
}

/* The normal of a row is between that of its node and those of the partner, with this share of the latter, where they are opposed but for a
   bend, and that of the node at an edge. With a half it does not depend on which of the surfaces has the nodes of the rows. */
void RowNormal(PetscInt dim, PetscInt n, PetscReal share, const PetscReal node[], const PetscReal *normals[], const PetscReal weights[],
               PetscReal normal[])
{
  PetscReal partner[3] = {0}, sum[3] = {0}, square = 0, cosine = 0, of_node, of_partner;

  for (PetscInt j = 0; j < n; j++)
    for (PetscInt d = 0; d < dim; d++) partner[d] -= weights[j] * normals[j][d];
  if (Normalize(partner) > 0) cosine = Dot(partner, node);
  of_partner = share * BendCounts(cosine);
  of_node    = 1 - share + PetscMax(0, 2 * share - 1) * (1 - BendCounts(cosine)); /* at an edge not nothing */
  for (PetscInt d = 0; d < 3; d++) {
    sum[d] = d < dim ? of_node * node[d] + of_partner * partner[d] : 0;
    square += PetscSqr(sum[d]);
  }
  for (PetscInt d = 0; d < dim; d++) normal[d] = square > 0 ? sum[d] / PetscSqrtReal(square) : node[d];
}

/* How much closer the partner is than its faces, at the place of a row, if it is curved as its normals m_j say [m]. Half way between its
   nodes and the planes through them across their normals a surface of second order is met:

     gap = sum_j P_j 1/2 (n . (x_j - x) + m_j . (x_j - x) / (m_j . n))

   Where the row sees an edge, by its dual functions, it sees faces. */
PetscReal RowBulge(PetscInt dim, PetscInt n, const PetscReal x[], const PetscReal normal[], const PetscReal *partners[],
                   const PetscReal *normals[], const PetscReal weights[], const Share shares[])
{
  PetscReal bulge = 0, counts = 1;

  for (PetscInt j = 0; j < n; j++) {
    PetscReal along = 0, plane = 0, cosine = 0;

    if (PetscAbsReal(shares[j].goal) <= ROUND_OFF_WEIGHT || IsOnEdge(normals[j])) continue;
    for (PetscInt d = 0; d < dim; d++) {
      along += normal[d] * (partners[j][d] - x[d]);
      plane += normals[j][d] * (partners[j][d] - x[d]);
      cosine += normals[j][d] * normal[d];
    }
    counts = PetscMin(counts, BendCounts(-cosine));
    if (counts == 0) return 0;
    bulge += 0.5 * weights[j] * (along - plane / cosine);
  }
  return counts * bulge;
}

/* Depth that a row may have between surfaces that only touch [m]. The dual functions are negative at the far ends of a node's faces, so
   that the row of the node at which two balls meet, or before which the partner has a corner, sees the partner in front of its vertex: by
   no more than the nodes with such weights lie before the node. */
PetscReal RowBow(PetscInt dim, PetscInt n, const PetscReal x[], const PetscReal normal[], const PetscReal *partners[],
                 const PetscReal weights[])
{
  PetscReal bow = 0;

  for (PetscInt j = 0; j < n; j++) {
    PetscReal gap = 0;

    for (PetscInt d = 0; d < dim; d++) gap += normal[d] * (partners[j][d] - x[d]);
    bow -= PetscMin(weights[j], 0) * PetscMax(gap, 0);
  }
  return bow;
}
