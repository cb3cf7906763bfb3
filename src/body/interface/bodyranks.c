/* Which ranks have the mesh of a body: what a program sets, what options say, what the body tells of it. */
#include <body/layout/bodyimpl.h>
#include <errno.h>
#include <stdlib.h>
#include <sys/names.h>
#include "bodysetup.h"

/*@
  BodySetRanks - sets the ranks that have a mesh from options among them; others have no cells of it

  Logically Collective

  Input Parameters:
+ body  - the `Body`, before `BodySetFromOptions()`
. n     - number of ranks; 0 (default): all of them
- ranks - ranks of its communicator, ascending

  Options Database Key:
. -<body>_ranks list - ranks and ranges of ranks, such as 0-7 or 0,2,5-6

  Level: intermediate

  Notes:
  The body stays on its communicator: ranks without cells go through the same calls.

  One rank has all of the mesh, as with `-<body>_mesh_division whole`; `ControllerSetFromOptions()` chooses it for bodies with few elements,
  where there are many. Several have a part each: a brick of a box, or of other meshes a part of the graph.

.seealso: `Body`, `BodyGetRanks()`, `BodyGetMeshRank()`, `BodySetFromOptions()`, `MeshCreateOnRanks()`
@*/
PetscErrorCode BodySetRanks(Body body, PetscInt n, const PetscMPIInt ranks[])
{
  PetscMPIInt *own = NULL;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscValidLogicalCollectiveInt(body, n, 2);
  if (n) PetscAssertPointer(ranks, 3);
  PetscCheck(!body->mesh.dm, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Body '%s' has a mesh: call %s() before",
             body->hdr.name, PETSC_FUNCTION_NAME);
  PetscCheck(n >= 0 && n <= body->rows.size, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_OUTOFRANGE,
             "Body '%s' cannot lie on %" PetscInt_FMT " ranks of %d", body->hdr.name, n, body->rows.size);
  for (PetscInt i = 0; i < n; i++)
    PetscCheck(ranks[i] >= 0 && ranks[i] < body->rows.size && (!i || ranks[i] > ranks[i - 1]), PetscObjectComm((PetscObject)body),
               PETSC_ERR_ARG_OUTOFRANGE, "Body '%s' cannot lie on rank %d of %d: ranks are ascending numbers from 0 on", body->hdr.name,
               ranks[i], body->rows.size);
  PetscCall(PetscMalloc1(n, &own));
  PetscCall(PetscArraycpy(own, ranks, n));
  PetscCall(PetscFree(body->mesh.ranks));
  body->mesh.n_ranks = (PetscMPIInt)n;
  body->mesh.ranks   = own;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  BodyGetRanks - the ranks that were chosen to have the mesh among them

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameters:
+ n     - their number; 0: none has been chosen, and the mesh is divided among all, or as the program has divided it
- ranks - these ranks, ascending; owned by the body

  Level: intermediate

.seealso: `Body`, `BodySetRanks()`, `BodyGetMeshRank()`
@*/
PetscErrorCode BodyGetRanks(Body body, PetscInt *n, const PetscMPIInt *ranks[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(n, 2);
  PetscAssertPointer(ranks, 3);
  *n     = body->mesh.n_ranks;
  *ranks = body->mesh.ranks;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetMeshRank - the rank that has all of the mesh

  Not Collective

  Input Parameter:
. body - the `Body`, with its mesh numbered: after `BodySetFromOptions()` or `BodySetUpDiscretization()`

  Output Parameter:
. rank - `PETSC_DECIDE` where several ranks have a part, or may

  Level: intermediate

.seealso: `Body`, `BodySetRanks()`
@*/
PetscErrorCode BodyGetMeshRank(Body body, PetscMPIInt *rank)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(rank, 2);
  *rank = body->mesh.positions && !body->mesh.ghosted ? body->mesh.owner : PETSC_DECIDE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number that a text begins with, and what follows it; NULL: it begins with none */
static const char *ReadNumber(const char text[], long *number)
{
  char *end;

  if (text[0] < '0' || text[0] > '9') return NULL; /* strtol() takes blanks and signs too */
  errno   = 0;
  *number = strtol(text, &end, 10);
  if (errno) *number = PETSC_MPI_INT_MAX; /* there is no such rank in any run */
  return end;
}

/* Marks the ranks of an element of the list, one or a range; next: what follows the element */
static PetscErrorCode MarkRanks(Body body, const char text[], PetscBool marks[], const char **next)
{
  const char *const prefix = ((PetscObject)body)->prefix, *end;
  const PetscMPIInt size   = body->rows.size;
  MPI_Comm          comm   = PetscObjectComm((PetscObject)body);
  long              first = 0, last = 0;

  PetscFunctionBegin;
  end  = ReadNumber(text, &first);
  last = first;
  if (end && *end == '-') end = ReadNumber(end + 1, &last);
  PetscCheck(end && (!*end || *end == ','), comm, PETSC_ERR_USER_INPUT,
             "-%sranks: '%.*s' is neither a rank nor a range of ranks: give them with commas between them and without blanks, as in 0-7 or "
             "0,2,5-6",
             prefix, (int)strcspn(text, ","), text);
  PetscCheck(first <= last, comm, PETSC_ERR_USER_INPUT, "-%sranks: the range %ld-%ld ends before it begins", prefix, first, last);
  PetscCheck(last < size, comm, PETSC_ERR_USER_INPUT,
             "-%sranks %.*s: this run has %d rank%s, the first of which is 0; change the option, or run on more ranks", prefix,
             (int)strcspn(text, ","), text, size, size == 1 ? "" : "s");
  for (long r = first; r <= last; r++) {
    PetscCheck(!marks[r], comm, PETSC_ERR_USER_INPUT, "-%sranks names rank %ld twice", prefix, r);
    marks[r] = PETSC_TRUE;
  }
  *next = *end ? end + 1 : NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The ranks of a list, ascending; there is room for all that there are */
static PetscErrorCode ReadList(Body body, const char text[], PetscBool marks[], PetscInt *n, PetscMPIInt ranks[])
{
  PetscFunctionBegin;
  *n = 0;
  for (const char *next = text; next;) PetscCall(MarkRanks(body, next, marks, &next));
  for (PetscMPIInt r = 0; r < body->rows.size; r++)
    if (marks[r]) ranks[(*n)++] = r;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyReadRanks(Body body)
{
  const char *const prefix = ((PetscObject)body)->prefix;
  const char       *text;
  PetscMPIInt      *ranks;
  PetscInt          n;
  PetscBool         set, *marks;
  PetscErrorCode    error;

  PetscFunctionBegin;
  PetscCall(PetscOptionsFindPair(NULL, prefix, "-ranks", &text, &set));
  if (!set) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(!body->mesh.dm, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%sranks: the program has set the mesh of body '%s', and divided it; leave the option out", prefix, body->hdr.name);
  PetscCall(PetscCalloc2(body->rows.size, &marks, body->rows.size, &ranks));
  error = ReadList(body, text ? text : "", marks, &n, ranks);
  if (!error) error = BodySetRanks(body, n, ranks);
  PetscCall(PetscFree2(marks, ranks));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyViewRanks(Body body, PetscViewer viewer)
{
  const PetscMPIInt *ranks = body->mesh.ranks, n = body->mesh.n_ranks;
  char               list[256] = "", range[32];

  PetscFunctionBegin;
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscMPIInt i = 0, last; i < n; i = last + 1) {
    for (last = i; last + 1 < n && ranks[last + 1] == ranks[last] + 1;) last++;
    if (last > i) PetscCall(PetscSNPrintf(range, sizeof(range), "%d-%d", ranks[i], ranks[last]));
    else PetscCall(PetscSNPrintf(range, sizeof(range), "%d", ranks[i]));
    PetscCall(NamesAppend(list, sizeof(list), ",", range));
  }
  PetscCall(PetscViewerASCIIPrintf(viewer, "  mesh on rank%s %s of %d\n", n == 1 ? "" : "s", list, body->rows.size));
  PetscFunctionReturn(PETSC_SUCCESS);
}
