/* Points of a body whose motion and stress are observed: -<body>_probe. */
#include <body/layout/bodyimpl.h>
#include "bodysetup.h"
#include <sys/units.h>

/* A point counts as one of an element if it is farther from it by less than this part of the element: round-off of positions */
#define INSIDE 1e-9
/* How many more points there is room for, when there is no room left */
#define GROWTH 8
#define N_SUMS 12

/* Where points lie in the elements of this rank: one of these for each point and element that has it, several where elements meet */
typedef struct {
  PetscInt  point, element;
  PetscReal weight;                  /* one part of as many as there are elements that have the point, on all ranks */
  PetscReal shape[ELEMENT_MAX_DOFS]; /* shape functions of the element's nodes there */
} Place;

struct _BodyPoints {
  PetscInt   n;
  PetscReal *x; /* undeformed positions, 3 each */
  /* below: after BodySetUpPoints() */
  PetscInt   n_places;
  Place     *places;
  PetscInt  *connectivity; /* of the elements of the places, one by one */
  Element    element;      /* these: their stress is computed */
  PetscInt  *of_body;      /* the number of each in the body */
  char      *memory;       /* of their history */
  PetscReal *history;      /* NULL where the material has none */
  PetscReal *stress, *sums;
};

/*@
  BodyAddProbe - observes a point of the body

  Collective

  Input Parameters:
+ body - the `Body`, with its mesh, not yet set up
- x    - where it is in the undeformed body, after all that places the mesh: as many numbers as space has dimensions [m]

  Options Database Key:
. -<body>_probe x,y,z;x,y,z - points, with semicolons between them

  Level: intermediate

  Note:
  A point outside the mesh is an error of `BodySetUp()`, which says how far outside.

.seealso: `Body`, `BodyGetProbes()`, `BodyGetNumProbes()`
@*/
PetscErrorCode BodyAddProbe(Body body, const PetscReal x[])
{
  struct _BodyPoints *points;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(x, 2);
  BodyCheckNotSetUp(body);
  if (!body->points) PetscCall(PetscNew(&body->points));
  points = body->points;
  if (points->n % GROWTH == 0) PetscCall(PetscRealloc((size_t)(3 * (points->n + GROWTH)) * sizeof(PetscReal), &points->x));
  for (PetscInt d = 0; d < 3; d++) points->x[3 * points->n + d] = d < body->mesh.dim ? x[d] : 0;
  points->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetNumProbes - how many points of the body are observed

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. n - the number

  Level: intermediate

.seealso: `Body`, `BodyAddProbe()`, `BodyGetProbes()`
@*/
PetscErrorCode BodyGetNumProbes(Body body, PetscInt *n)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(n, 2);
  *n = body->points ? body->points->n : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One point, "x,y,z": numbers, or formulas that are constant */
static PetscErrorCode ReadPoint(Body body, const char option[], const char text[])
{
  MPI_Comm   comm    = PetscObjectComm((PetscObject)body);
  Expression list[3] = {NULL};
  PetscReal  x[3]    = {0};
  PetscBool  steady  = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(ExpressionListCreate(comm, option + 1, text, body->mesh.dim, PETSC_FALSE, list));
  for (PetscInt d = 0; d < body->mesh.dim; d++) {
    PetscBool constant;

    PetscCall(ExpressionIsConstant(list[d], &constant, &x[d]));
    if (!constant) steady = PETSC_FALSE;
    PetscCall(ExpressionDestroy(&list[d]));
  }
  PetscCheck(steady, comm, PETSC_ERR_USER_INPUT, "%s '%s': coordinates of points are numbers", option, text);
  PetscCall(BodyAddProbe(body, x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyReadPoints(Body body)
{
  MPI_Comm       comm = PetscObjectComm((PetscObject)body);
  char           option[256], **parts;
  const char    *text;
  int            n, wanted = 1;
  PetscBool      set;
  PetscErrorCode error = PETSC_SUCCESS;

  PetscFunctionBegin;
  PetscCall(PetscOptionsFindPair(NULL, ((PetscObject)body)->prefix, "-probe", &text, &set));
  if (!set) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(option, sizeof(option), "-%sprobe", ((PetscObject)body)->prefix));
  PetscCheck(text && text[0], comm, PETSC_ERR_USER_INPUT, "%s has no value; give points with semicolons between them, as in 0,0;1,0.5",
             option);
  for (const char *c = text; *c; c++) wanted += *c == ';';
  PetscCall(PetscStrToArray(text, ';', &n, &parts)); /* without what is empty */
  if (n != wanted) PetscCall(PetscStrToArrayDestroy(n, parts));
  PetscCheck(n == wanted, comm, PETSC_ERR_USER_INPUT, "%s '%s' has an empty point in it; give points with semicolons between them", option,
             text);
  for (int i = 0; i < n && !error; i++) error = ReadPoint(body, option, parts[i]);
  PetscCall(PetscStrToArrayDestroy(n, parts));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Distance of a point from the box around an element, and the largest edge of the box */
static PetscReal DistanceFromBox(Body body, PetscInt e, const PetscReal x[], PetscReal *size)
{
  const PetscInt *nodes   = body->mesh.connectivity + e * body->model.element->nodes;
  PetscReal       squares = 0;

  *size = 0;
  for (PetscInt d = 0; d < body->mesh.dim; d++) {
    PetscReal lower = PETSC_MAX_REAL, upper = -PETSC_MAX_REAL;

    for (PetscInt a = 0; a < body->model.element->nodes; a++) {
      lower = PetscMin(lower, body->mesh.coordinates[nodes[a] * body->mesh.dim + d]);
      upper = PetscMax(upper, body->mesh.coordinates[nodes[a] * body->mesh.dim + d]);
    }
    squares += PetscSqr(PetscMax(0, PetscMax(lower - x[d], x[d] - upper)));
    *size = PetscMax(*size, upper - lower);
  }
  return PetscSqrtReal(squares);
}

/* Adds the places of a point in this rank's elements; `nearest`: its distance from the nearest of them, 0 where it is inside */
static PetscErrorCode FindPlaces(Body body, PetscInt point, PetscReal *nearest)
{
  struct _BodyPoints *points  = body->points;
  const Element       element = body->model.element;
  const PetscReal    *x       = points->x + 3 * point;

  PetscFunctionBegin;
  *nearest = PETSC_MAX_REAL;
  for (PetscInt e = 0; e < element->count; e++) {
    Place     place = {.point = point, .element = e, .weight = 1};
    PetscReal size, distance = DistanceFromBox(body, e, x, &size);

    if (distance > *nearest + INSIDE * size) continue;
    PetscCall((*element->ops->nearest)(element, e, x, place.shape, &distance));
    if (distance <= INSIDE * size) {
      distance = 0;
      if (points->n_places % GROWTH == 0) PetscCall(PetscRealloc((size_t)(points->n_places + GROWTH) * sizeof(Place), &points->places));
      points->places[points->n_places++] = place;
    }
    *nearest = PetscMin(*nearest, distance);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Each place of a point has the same weight, and all of them 1 */
static PetscErrorCode WeighPlaces(Body body)
{
  struct _BodyPoints *points = body->points;
  PetscInt           *counts;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(points->n, &counts));
  for (PetscInt i = 0; i < points->n_places; i++) counts[points->places[i].point]++;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counts, (PetscMPIInt)points->n, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
  for (PetscInt i = 0; i < points->n_places; i++) points->places[i].weight = 1 / (PetscReal)counts[points->places[i].point];
  PetscCall(PetscFree(counts));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the elements that have the points; an error where a point is outside */
PetscErrorCode BodySetUpPoints(Body body)
{
  MPI_Comm            comm   = PetscObjectComm((PetscObject)body);
  struct _BodyPoints *points = body->points;
  const PetscInt      nodes  = body->model.element->nodes;
  PetscInt            size;

  PetscFunctionBegin;
  if (!points) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(body->model.element->ops->nearest, comm, PETSC_ERR_SUP, "-%sprobe: elements of shape '%s' do not support it",
             ((PetscObject)body)->prefix, DMPolytopeTypes[body->mesh.cell_shape]);
  for (PetscInt k = 0; k < points->n; k++) {
    const PetscReal *x = points->x + 3 * k;
    PetscReal        nearest;

    PetscCall(FindPlaces(body, k, &nearest));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &nearest, 1, MPIU_REAL, MPIU_MIN, comm));
    PetscCheck(
        nearest == 0, comm, PETSC_ERR_USER_INPUT,
        "-%sprobe: the point (%g, %g, %g)%s lies outside the mesh of body '%s', about %.3g%s from its nearest element; positions are "
        "those of the undeformed body, after its placement",
        ((PetscObject)body)->prefix, (double)x[0], (double)x[1], (double)x[2], UnitsOf((PetscObject)body, UNIT_LENGTH), body->hdr.name,
        (double)nearest, UnitsOf((PetscObject)body, UNIT_LENGTH));
  }
  PetscCall(WeighPlaces(body));
  PetscCall(PetscMalloc3(points->n_places * nodes, &points->connectivity, 6 * points->n_places, &points->stress, N_SUMS * points->n,
                         &points->sums));
  for (PetscInt i = 0; i < points->n_places; i++)
    PetscCall(PetscArraycpy(points->connectivity + i * nodes, body->mesh.connectivity + points->places[i].element * nodes, nodes));
  PetscCall(PetscMalloc1(points->n_places, &points->of_body));
  for (PetscInt i = 0; i < points->n_places; i++) points->of_body[i] = points->places[i].element;
  PetscCall(ElementCreateSelection(body->model.element, PETSC_FALSE, points->n_places, points->of_body, points->connectivity,
                                   body->mesh.coordinates, &points->element));
  PetscCall(BodyHistoryCreateBuffer(body, points->n_places, &size, &points->memory, &points->history));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyDestroyPoints(Body body)
{
  PetscFunctionBegin;
  if (!body->points) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ElementDestroy(&body->points->element));
  PetscCall(PetscFree(body->points->of_body));
  PetscCall(PetscFree(body->points->memory));
  PetscCall(PetscFree3(body->points->connectivity, body->points->stress, body->points->sums));
  PetscCall(PetscFree(body->points->places));
  PetscCall(PetscFree(body->points->x));
  PetscCall(PetscFree(body->points));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* This rank's shares of displacement, velocity and stress at all points */
static void SumPlaces(Body body, const PetscScalar u[], const PetscScalar v[])
{
  const struct _BodyPoints *points = body->points;
  const PetscInt            dim = body->mesh.dim, nodes = body->model.element->nodes;

  for (PetscInt i = 0; i < points->n_places; i++) {
    const Place    *place = &points->places[i];
    const PetscInt *node  = points->connectivity + i * nodes;
    PetscReal      *sums  = points->sums + N_SUMS * place->point;

    for (PetscInt a = 0; a < nodes; a++)
      for (PetscInt d = 0; d < dim; d++) {
        sums[d] += place->weight * place->shape[a] * PetscRealPart(u[node[a] * dim + d]);
        sums[3 + d] += place->weight * place->shape[a] * PetscRealPart(v[node[a] * dim + d]);
      }
    for (PetscInt k = 0; k < 6; k++) sums[6 + k] += place->weight * points->stress[6 * i + k];
  }
}

/*@
  BodyGetProbes - where the observed points are now, and how they move and are stressed

  Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameters:
+ position     - 3 for each point, zeros beyond the dimension: where it is now [m]
. displacement - 3 for each [m]
. velocity     - 3 for each [m/s]
- stress       - Cauchy stress xx, yy, zz, xy, yz, xz for each: the mean over the element that has the point, and over all elements that
                 have it, where they meet [Pa]

  Level: intermediate

.seealso: `Body`, `BodyAddProbe()`, `BodyGetNumProbes()`, `BodyComputeStress()`
@*/
PetscErrorCode BodyGetProbes(Body body, PetscReal position[], PetscReal displacement[], PetscReal velocity[], PetscReal stress[])
{
  struct _BodyPoints *points = body->points;
  const PetscScalar  *u, *v;
  Vec                 u_local, v_local;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call after BodySetUp()");
  if (!points) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArrayzero(points->sums, N_SUMS * points->n));
  PetscCall(BodyGetLocalRead(body, body->state.u, &u_local, &u));
  PetscCall(BodyGetLocalRead(body, body->state.v, &v_local, &v));
  if (points->history) BodyHistoryGather(body, PETSC_TRUE, points->element, points->of_body, points->history);
  points->element->history.start = points->history;
  points->element->history.step  = -1;
  if (body->integrator->deforms) PetscCall((*points->element->ops->stress)(points->element, u, points->stress));
  else PetscCall(PetscArrayzero(points->stress, 6 * points->n_places));
  SumPlaces(body, u, v);
  PetscCall(BodyRestoreLocalRead(body, body->state.v, &v_local, &v));
  PetscCall(BodyRestoreLocalRead(body, body->state.u, &u_local, &u));
  if (body->rows.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, points->sums, (PetscMPIInt)(N_SUMS * points->n), MPIU_REAL, MPIU_SUM,
                               PetscObjectComm((PetscObject)body)));
  for (PetscInt k = 0; k < points->n; k++) {
    const PetscReal *sums = points->sums + N_SUMS * k;

    for (PetscInt d = 0; d < 3; d++) {
      position[3 * k + d]     = points->x[3 * k + d] + sums[d];
      displacement[3 * k + d] = sums[d];
      velocity[3 * k + d]     = sums[3 + d];
    }
    PetscCall(PetscArraycpy(stress + 6 * k, sums + 6, 6));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
