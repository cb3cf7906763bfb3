/* Dual mortar integrals over the parts of faces that lie opposite to each other: M_ij = int psi_i N_j and D_i = int phi_i (Wohlmuth 2000;
   Popp, Gee, Wall 2009), with dual functions on the covered part of each face (Cichosz, Bischoff 2011). */
#include "segments.h"

/* Corners at which the shape function of a node differs by less count as equally near to the node */
#define SAME_POINT 1e-9
/* Smallest pivot of a face's mass matrix, scaled to a unit diagonal, for dual functions: weights of rows grow like its inverse */
#define SINGULAR 1e-3

/* Integrals over the covered part of one Dirichlet face */
typedef struct {
  Target    target;
  PetscReal combine[4][4]; /* function of node k: sum_l combine[k][l] phi_l */
  PetscReal lumped[4];     /* int phi_k */
  PetscReal mass[4][4];    /* int phi_k phi_l */
  PetscBool axisymmetric;  /* integrals have the weight 2 pi x */
} Patch;

/* A node far beyond the partner's end has no row. Its neighbours take its shape function over, so that the sum stays one. */
static void CombineFunctions(PetscInt n, const PetscInt nodes[], const PetscInt marks[], PetscReal combine[4][4])
{
  PetscInt all = 0;

  for (PetscInt k = 0; k < n; k++) all += marks[nodes[k]] != MARK_NONE;
  for (PetscInt l = 0; l < n; l++) {
    PetscInt heirs[4] = {0}, count = 0;

    if (marks[nodes[l]]) {
      heirs[l] = count = 1;
    } else {
      for (PetscInt k = 0; k < n; k++) heirs[k] = marks[nodes[k]] != MARK_NONE && (k == (l + 1) % n || l == (k + 1) % n);
      for (PetscInt k = 0; k < n; k++) count += heirs[k];
      for (PetscInt k = 0; k < n && !count; k++) heirs[k] = marks[nodes[k]] != MARK_NONE;
      if (!count) count = PetscMax(all, 1);
    }
    for (PetscInt k = 0; k < n; k++) combine[k][l] = (PetscReal)heirs[k] / count;
  }
}

/* The combined shape functions of the nodes of a face at the point s of its plane */
static void ShapesAt(const Patch *patch, const PetscReal s[], PetscReal shapes[])
{
  PetscReal phi[4];

  FaceShapes(patch->target.n, (const PetscReal(*)[2])patch->target.corners, s, phi);
  for (PetscInt k = 0; k < patch->target.n; k++) {
    shapes[k] = 0;
    for (PetscInt l = 0; l < patch->target.n; l++) shapes[k] += patch->combine[k][l] * phi[l];
  }
}

/* Adds the integrals over a segment to those of its patch, and finds int phi_k N_j over the segment */
static void IntegrateSegment(Patch *patch, const Segment *segment, PetscInt n_partner, PetscReal cross[4][4])
{
  const Frame   *frame = &patch->target.frame;
  PetscReal      points[36][2], weights[36], shapes[4], partner[4];
  const PetscInt n_points = PolygonQuadrature(segment->n, (const PetscReal(*)[2])segment->polygon, points, weights);

  for (PetscInt k = 0; k < 4; k++)
    for (PetscInt j = 0; j < 4; j++) cross[k][j] = 0;
  for (PetscInt q = 0; q < n_points && patch->axisymmetric; q++)
    weights[q] *= 2 * PETSC_PI * PetscMax(0, frame->origin[0] + frame->tangents[0][0] * points[q][0]);
  for (PetscInt q = 0; q < n_points; q++) {
    ShapesAt(patch, points[q], shapes);
    FaceShapes(n_partner, (const PetscReal(*)[2])segment->partner_corners, points[q], partner);
    for (PetscInt k = 0; k < patch->target.n; k++) {
      patch->lumped[k] += weights[q] * shapes[k];
      for (PetscInt l = 0; l < patch->target.n; l++) patch->mass[k][l] += weights[q] * shapes[k] * shapes[l];
      for (PetscInt j = 0; j < n_partner; j++) cross[k][j] += weights[q] * shapes[k] * partner[j];
    }
  }
}

/* Dual functions psi_k = sum_l dual[k][l] phi_l with int psi_k phi_l = delta_kl int phi_k: dual = diag(lumped) mass^-1. If the mass matrix
   is nearly singular, which happens if only a small part in the middle of the face is covered, the functions phi_k themselves are used. */
static void ComputeDual(const Patch *patch, PetscReal dual[4][4])
{
  PetscInt  which[4], n = 0;
  PetscReal a[4][8], scale[4];

  for (PetscInt k = 0; k < patch->target.n; k++) {
    for (PetscInt l = 0; l < patch->target.n; l++) dual[k][l] = k == l;
    if (patch->lumped[k] > 0 && patch->mass[k][k] > 0) which[n++] = k;
  }
  for (PetscInt i = 0; i < n; i++) scale[i] = 1 / PetscSqrtReal(patch->mass[which[i]][which[i]]);
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) {
      a[i][j]     = patch->mass[which[i]][which[j]] * scale[i] * scale[j];
      a[i][n + j] = i == j;
    }
  for (PetscInt i = 0; i < n; i++) { /* symmetric and positive: no pivoting */
    const PetscReal pivot = a[i][i];

    if (pivot < SINGULAR) return;
    for (PetscInt j = 0; j < 2 * n; j++) a[i][j] /= pivot;
    for (PetscInt r = 0; r < n; r++) {
      const PetscReal factor = a[r][i];

      if (r != i)
        for (PetscInt j = 0; j < 2 * n; j++) a[r][j] -= factor * a[i][j];
    }
  }
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) dual[which[i]][which[j]] = patch->lumped[which[i]] * a[i][n + j] * scale[i] * scale[j];
}

/* Appends the integrals of the nodes of face f with one partner to `shares`, and the ranks that own these nodes to `owners`. `areas`: the
   integrals of the functions of both; `edges`: nodes on sharp edges get slopes */
static void AddShares(Surface surface, PetscBool edges, PetscInt f, PetscInt n_partner, const Face *partner, PetscReal values[4][4],
                      PetscReal areas[4][4], PetscInt *n_shares, Share shares[], PetscMPIInt owners[])
{
  const PetscInt n            = surface->data.face_nodes;
  PetscReal      slopes[4][3] = {{0}};

  if (edges && n > 1) FaceGradients(n_partner, partner->x, slopes);
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt node   = surface->data.faces[f * n + k];
    PetscReal      weight = 0;

    for (PetscInt j = 0; j < n_partner && edges && surface->sharp[node]; j++) weight += areas[k][j];
    for (PetscInt j = 0; j < n_partner; j++) {
      if (values[k][j] == 0 && areas[k][j] == 0 && weight == 0) continue;
      owners[*n_shares]     = surface->owner_rank[node];
      shares[(*n_shares)++] = (Share){.row         = surface->owner_index[node],
                                      .dof         = partner->dofs[j],
                                      .owner_index = partner->owner_index[j],
                                      .owner_rank  = partner->owner_rank[j],
                                      .value       = values[k][j],
                                      .area        = areas[k][j],
                                      .slope       = {weight * slopes[j][0], weight * slopes[j][1], weight * slopes[j][2]}};
    }
  }
}

/* The normal along which the gap of a node counts before a face of the partner: its own, on a sharp edge against that of the face */
static void GapNormal(Surface surface, const Segments *segments, PetscInt node, const Face *partner, PetscReal normal[])
{
  const PetscBool edge = (PetscBool)(segments->guards && surface->sharp[node]);

  for (PetscInt d = 0; d < 3; d++) normal[d] = edge ? -partner->normal[d] : surface->data.normals[3 * node + d];
}

/* The gap where the partner ends before node k of the face [m]: the least at the covered part's corners with the largest shape function */
static PetscReal GapAtEnd(Surface surface, PetscInt k, const PetscInt nodes[], const Patch *patch, const Segments *segments, PetscInt begin,
                          PetscInt end, const Face faces[])
{
  PetscReal largest = 0, smallest = PETSC_MAX_REAL, normal[3];

  for (PetscInt pass = 0; pass < 2; pass++)
    for (PetscInt i = begin; i < end; i++) {
      const Segment *segment = &segments->list[i];

      GapNormal(surface, segments, nodes[k], &faces[segment->partner], normal);
      for (PetscInt v = 0; v < segment->n; v++) {
        PetscReal shapes[4];

        FaceShapes(patch->target.n, (const PetscReal(*)[2])patch->target.corners, segment->polygon[v], shapes);
        if (!pass) largest = PetscMax(largest, shapes[k]);
        else if (shapes[k] >= largest - SAME_POINT)
          smallest = PetscMin(smallest, TargetGap(&patch->target, normal, &faces[segment->partner], segments->face_nodes,
                                                  (const PetscReal(*)[2])segment->partner_corners, segment->polygon[v]));
      }
    }
  return smallest;
}

/* Integrates over the segments `begin` to `end` - 1, which all belong to one Dirichlet face */
static PetscErrorCode IntegrateFace(Surface surface, const Segments *segments, PetscInt begin, PetscInt end, const Face faces[],
                                    const PetscInt marks[], PetscReal lumped[], PetscReal ends[], PetscReal seen[], PetscInt *n_shares,
                                    Share shares[], PetscMPIInt owners[])
{
  const PetscInt n = surface->data.face_nodes, f = segments->list[begin].face, n_partner = segments->face_nodes,
                 *nodes = surface->data.faces + f * n;
  PetscReal(*cross)[4][4], dual[4][4];
  Patch patch;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(end - begin, &cross));
  if (n == 1) {
    patch          = (Patch){.lumped = {1}};
    cross[0][0][0] = dual[0][0] = 1;
  } else {
    patch = (Patch){.axisymmetric = surface->axisymmetric};
    TargetSetUp(&surface->data, f, &patch.target);
    CombineFunctions(n, nodes, marks, patch.combine);
    for (PetscInt i = begin; i < end; i++) IntegrateSegment(&patch, &segments->list[i], n_partner, cross[i - begin]);
    ComputeDual(&patch, dual);
    for (PetscInt k = 0; k < n; k++)
      if (marks[nodes[k]] == MARK_BEYOND)
        ends[nodes[k]] = PetscMin(ends[nodes[k]], GapAtEnd(surface, k, nodes, &patch, segments, begin, end, faces));
  }
  for (PetscInt k = 0; k < n; k++) lumped[nodes[k]] += patch.lumped[k];
  for (PetscInt i = begin; i < end; i++) {
    const Face *partner      = &faces[segments->list[i].partner];
    PetscReal   values[4][4] = {{0}}, weights[4] = {0};

    for (PetscInt k = 0; k < n; k++)
      for (PetscInt l = 0; l < n; l++)
        for (PetscInt j = 0; j < n_partner; j++) values[k][j] += dual[k][l] * cross[i - begin][l][j];
    for (PetscInt k = 0; k < n; k++) {
      for (PetscInt j = 0; j < n_partner; j++) weights[k] += cross[i - begin][k][j];
      for (PetscInt d = 0; d < 3; d++) seen[3 * nodes[k] + d] += weights[k] * partner->normal[d];
    }
    AddShares(surface, segments->guards, f, n_partner, partner, values, cross[i - begin], n_shares, shares, owners);
  }
  PetscCall(PetscFree(cross));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Integrates over all that lies opposite, at most `ahead` before and `behind` behind the Dirichlet side [m]. For each node that this rank
   has: `marks`, what lies opposite; `lumped`, its D_i, summed over all ranks if this rank owns the node; `ends`, the gap where the partner
   ends, if this rank owns the node and it lies beyond that end; `seen`, the
   integral of its function times the normal of the partner, if this rank owns the node. `shares`
   are the M_ij of the rows of this rank, in pieces; free with PetscFree(). */
PetscErrorCode TransferIntegrate(Transfer transfer, PetscReal ahead, PetscReal behind, PetscInt marks[], PetscReal lumped[],
                                 PetscReal ends[], PetscReal seen[], PetscInt *n_shares, Share *shares[])
{
  Surface      dirichlet = transfer->dirichlet;
  Segments     segments  = {.ahead      = ahead,
                            .behind     = behind,
                            .guards     = (PetscBool)!transfer->options.unguarded,
                            .face_nodes = transfer->neumann->data.face_nodes};
  PetscInt     n_faces, n_mine = 0;
  Face        *faces;
  Share       *mine;
  PetscMPIInt *owners;

  PetscFunctionBegin;
  PetscCall(ExchangeFaces(transfer->comm, dirichlet, transfer->neumann, ahead, behind, &n_faces, &faces));
  for (PetscInt i = 0; i < dirichlet->data.n_nodes; i++) {
    marks[i] = MARK_NONE;
    ends[i]  = PETSC_MAX_REAL;
  }
  PetscCall(SegmentsFind(dirichlet, n_faces, faces, marks, &segments));
  PetscCall(PetscSFReduceBegin(dirichlet->sf, MPIU_INT, marks, marks, MPI_MAX));
  PetscCall(PetscSFReduceEnd(dirichlet->sf, MPIU_INT, marks, marks, MPI_MAX));
  PetscCall(PetscSFBcastBegin(dirichlet->sf, MPIU_INT, marks, marks, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(dirichlet->sf, MPIU_INT, marks, marks, MPI_REPLACE));
  PetscCall(PetscMalloc2(segments.n * 16, &mine, segments.n * 16, &owners));
  PetscCall(PetscArrayzero(lumped, dirichlet->data.n_nodes));
  PetscCall(PetscArrayzero(seen, 3 * dirichlet->data.n_nodes));
  for (PetscInt begin = 0, end; begin < segments.n; begin = end) {
    for (end = begin + 1; end < segments.n && segments.list[end].face == segments.list[begin].face;) end++;
    PetscCall(IntegrateFace(dirichlet, &segments, begin, end, faces, marks, lumped, ends, seen, &n_mine, mine, owners));
  }
  PetscCall(PetscSFReduceBegin(dirichlet->sf, MPIU_REAL, lumped, lumped, MPIU_SUM));
  PetscCall(PetscSFReduceEnd(dirichlet->sf, MPIU_REAL, lumped, lumped, MPIU_SUM));
  PetscCall(PetscSFReduceBegin(dirichlet->vectors, MPIU_REAL, seen, seen, MPIU_SUM));
  PetscCall(PetscSFReduceEnd(dirichlet->vectors, MPIU_REAL, seen, seen, MPIU_SUM));
  PetscCall(PetscSFReduceBegin(dirichlet->sf, MPIU_REAL, ends, ends, MPIU_MIN));
  PetscCall(PetscSFReduceEnd(dirichlet->sf, MPIU_REAL, ends, ends, MPIU_MIN));
  if (transfer->options.owned) PetscCall(PetscArrayzero(owners, n_mine)); /* of one rank alone that is its number */
  PetscCall(ExchangeRecords(transfer->comm, sizeof(Share), n_mine, owners, mine, n_shares, (void **)shares));
  PetscCall(PetscFree2(mine, owners));
  PetscCall(PetscFree(segments.list));
  PetscCall(PetscFree(faces));
  PetscFunctionReturn(PETSC_SUCCESS);
}
