/* Which element it was, and where: for messages. */
#include <body/layout/bodyimpl.h>

/* Where an element of this rank lies in the undeformed mesh, three numbers [m] */
void BodyGetElementCentre(Body body, PetscInt e, PetscReal centre[3])
{
  const PetscInt n = body->model.element->nodes;

  for (PetscInt d = 0; d < 3; d++) centre[d] = 0;
  for (PetscInt a = 0; a < n; a++)
    for (PetscInt d = 0; d < body->mesh.dim; d++)
      centre[d] += body->mesh.coordinates[body->mesh.connectivity[e * n + a] * body->mesh.dim + d] / (PetscReal)n;
}

/* The first rank that has an element to tell of, and where that lies; `e`: of this rank, -1: none. `first` is the number of ranks where no
   rank has one; else `centre` is that of the element in the undeformed mesh, three numbers [m]. Collective. */
PetscErrorCode BodyFindFirstElement(Body body, PetscInt e, PetscMPIInt *first, PetscReal centre[3])
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)body);
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  *first = e < 0 ? body->rows.size : rank;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, first, 1, MPI_INT, MPI_MIN, comm));
  if (*first == body->rows.size) PetscFunctionReturn(PETSC_SUCCESS);
  if (rank == *first) BodyGetElementCentre(body, e, centre);
  PetscCallMPI(MPI_Bcast(centre, 3, MPIU_REAL, *first, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of an element that all ranks have to tell of, or one notes alone: number, rank after rank from 0, and place; -1: none */
static PetscErrorCode Locate(Body body, PetscBool alone, PetscInt e, PetscInt *number, PetscReal centre[3])
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)body);
  PetscInt    offset;
  PetscMPIInt first;

  PetscFunctionBegin;
  *number = e;
  if (alone) {
    if (e >= 0) BodyGetElementCentre(body, e, centre);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyFindFirstElement(body, e, &first, centre));
  if (first == body->rows.size) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Scan(&body->model.element->count, &offset, 1, MPIU_INT, MPI_SUM, comm));
  *number = offset - body->model.element->count + e;
  PetscCallMPI(MPI_Bcast(number, 1, MPIU_INT, first, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes that the step has failed, and where, if the last internal force found an element inverted on any rank. Collective: to be called
   where it is known to all ranks that something is wrong; but where the rank that has the body knows it alone. */
PetscErrorCode BodyNoteInverted(Body body, PetscBool alone)
{
  PetscReal centre[3] = {0};
  PetscInt  number;
  Element   element;
  char      sudden[BODY_SUDDEN_LENGTH];

  PetscFunctionBegin;
  PetscCall(BodyGetElement(body, &element));
  PetscCall(Locate(body, alone, element->inverted, &number, centre));
  if (number < 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyDescribeSuddenLoad(body, sudden));
  PetscCall(StepFailureSet(&body->failure, STEP_DIVERGED_INVERTED, PETSC_ERR_FP,
                           "Body '%s': element %" PetscInt_FMT
                           " (rank after rank, from 0), around (%g, %g, %g) m of the undeformed mesh, is inverted, or "
                           "not a number%s, at time %.9g s (step %" PetscInt_FMT
                           " of the body); is a time step too large, a load too strong, or the mesh too coarse there?%s%s",
                           body->hdr.name, number, (double)centre[0], (double)centre[1], (double)centre[2],
                           element->history.n ? ", or how much it flows was not found" : "", (double)body->state.time, body->state.step,
                           sudden[0] ? " " : "", sudden));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first element of this rank that has a node; -1: none */
static PetscInt FindElementOfNode(Body body, PetscInt node)
{
  const PetscInt n = body->model.element->nodes;

  for (PetscInt k = 0; k < n * body->model.element->count; k++)
    if (body->mesh.connectivity[k] == node) return k / n;
  return -1;
}

/* BodyLocateLargest - an element at the largest entry of a vector of forces: its number, rank after rank from 0, where it lies in the
   undeformed mesh [m], and that entry without its sign [N]; the number is -1 where no element has it. Collective unless `alone`. */
PetscErrorCode BodyLocateLargest(Body body, PetscBool alone, Vec forces, PetscInt *number, PetscReal centre[3], PetscReal *largest)
{
  MPI_Comm           comm = PetscObjectComm((PetscObject)body);
  PetscReal          here = 0;
  PetscInt           n, node = -1;
  const PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(forces, &n));
  PetscCall(VecGetArrayRead(forces, &array));
  for (PetscInt i = 0; i < n; i++)
    if (PetscAbsScalar(array[i]) > here) {
      here = PetscAbsScalar(array[i]);
      node = i / body->mesh.dim;
    }
  PetscCall(VecRestoreArrayRead(forces, &array));
  *largest = here;
  if (!alone) PetscCallMPI(MPIU_Allreduce(&here, largest, 1, MPIU_REAL, MPIU_MAX, comm));
  PetscCall(Locate(body, alone, node >= 0 && here == *largest ? FindElementOfNode(body, node) : -1, number, centre));
  PetscFunctionReturn(PETSC_SUCCESS);
}
