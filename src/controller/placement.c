/* Bodies that are whole on one rank. A body that is divided is integrated by all ranks together, which wait for each other in each of its
   steps: with few elements that takes longer than the elements. Where there are many small bodies, each is given to one rank, and those
   that are near each other to the same one as far as they can: their places are halved across their longest extent, with as much work on
   both sides, until there is a part for each rank (recursive coordinate bisection, MeshBisect()). */
#include "controllerimpl.h"
#include <impakt/private/mesh.h>
#include <impakt/private/tssecondorder.h>

/* Most cells of a small body: more take as long as some reductions. Static bodies do not count: all ranks make their steps. */
#define SMALL 2000
/* So many small bodies for each rank, at least: the ranks are to have as much work each, to a quarter */
#define MANY 4

typedef struct {
  PetscInt n, *bodies; /* those that are placed */
  PetscReal (*places)[3], *work;
  PetscInt *ranks; /* of each body of the controller, PETSC_DECIDE: it is divided */
} Placement;

/* Whether a body may be given to one rank if it is small, as its options say, and whether it has to */
static PetscErrorCode MayBePlaced(Body body, PetscBool *may, PetscBool *asks)
{
  char        type[64] = "";
  const char *prefix   = ((PetscObject)body)->prefix;
  PetscBool   is_explicit, is_implicit = PETSC_TRUE, rigid = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(MeshMayBeWhole(PetscObjectComm((PetscObject)body), prefix, may, asks));
  PetscCall(PetscOptionsGetString(NULL, prefix, "-ts_type", type, sizeof(type), NULL));
  PetscCall(PetscStrcasecmp(type, TSCENTRALDIFFERENCE, &is_explicit));
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-rigid", &rigid, NULL));
  if (type[0]) PetscCall(PetscStrcasecmp(type, TSALPHA2, &is_implicit));
  *may = (PetscBool)(*may && (is_explicit || is_implicit) && !rigid);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lists the bodies that are small, or ask for one rank, with their places and work. Where none can come of it, options of meshes are read
   when these are made, so that errors in others are not said to be in them. */
static PetscErrorCode List(Controller controller, PetscInt begin, PetscMPIInt size, Placement *p, PetscInt *small, PetscBool asks[])
{
  const PetscInt n          = controller->n_bodies - begin;
  PetscInt       candidates = 0;
  PetscBool     *may;

  PetscFunctionBegin;
  *small = 0;
  PetscCall(PetscMalloc1(n, &may));
  for (PetscInt b = 0; b < n; b++) {
    PetscCall(MayBePlaced(controller->bodies[begin + b], &may[b], &asks[b]));
    candidates += may[b];
  }
  for (PetscInt b = 0; b < n; b++) {
    PetscInt  cells;
    PetscBool is_small;

    p->ranks[b] = PETSC_DECIDE;
    if (!asks[b] && (!may[b] || size == 1 || candidates < MANY * size)) continue;
    PetscCall(MeshEstimate(((PetscObject)controller->bodies[begin + b])->prefix, &cells, p->places[p->n]));
    p->work[p->n] = (PetscReal)PetscMax(cells, 1);
    is_small      = (PetscBool)(may[b] && cells > 0 && cells <= SMALL);
    if (!is_small && !asks[b]) continue;
    *small += is_small;
    p->bodies[p->n++] = b;
  }
  PetscCall(PetscFree(may));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ControllerPlaceBodies - tells bodies from options that are to be whole on one rank on which, before their meshes are made */
PetscErrorCode ControllerPlaceBodies(Controller controller, PetscInt begin)
{
  const PetscReal weights[3] = {1, 1, 1};
  const PetscInt  n          = controller->n_bodies - begin;
  Placement       p          = {0};
  PetscInt        small, *list, *ranks;
  PetscBool      *asks;
  PetscMPIInt     size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)controller), &size));
  if (n < 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc6(n, &p.bodies, n, &p.places, n, &p.work, n, &p.ranks, n, &list, n, &ranks));
  PetscCall(PetscMalloc1(n, &asks));
  PetscCall(List(controller, begin, size, &p, &small, asks));
  if (small < MANY * size) { /* those alone that ask for it */
    PetscInt kept = 0;

    for (PetscInt i = 0; i < p.n; i++) {
      if (!asks[p.bodies[i]]) continue;
      p.bodies[kept] = p.bodies[i];
      p.work[kept]   = p.work[i];
      PetscCall(PetscArraycpy(p.places[kept], p.places[i], 3));
      kept++;
    }
    p.n = kept;
  }
  for (PetscInt i = 0; i < p.n; i++) list[i] = i;
  PetscCall(MeshBisect(3, weights, &p.places[0][0], p.work, p.n, list, 0, size, ranks));
  for (PetscInt i = 0; i < p.n; i++) p.ranks[p.bodies[i]] = ranks[i];
  for (PetscInt b = 0; b < n && size > 1; b++) {
    const PetscMPIInt rank = (PetscMPIInt)p.ranks[b];

    PetscCall(BodySetRanks(controller->bodies[begin + b], rank == PETSC_DECIDE ? 0 : 1, &rank));
  }
  PetscCall(PetscFree(asks));
  PetscCall(PetscFree6(p.bodies, p.places, p.work, p.ranks, list, ranks));
  PetscFunctionReturn(PETSC_SUCCESS);
}
