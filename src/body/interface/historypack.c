/* The history of a body's material as a table, for another number of ranks and for runs that begin with the state of another. */
#include <body/layout/bodyimpl.h>
#include "bodyvisit.h"

/* The place of an element: the mean of its nodes' places, added up in ascending order: the order of the nodes depends on the ranks */
static void GetElementKey(Body body, PetscInt e, PetscReal key[TABLES_KEY])
{
  const PetscInt n = body->model.element->nodes, dim = body->mesh.dim;
  PetscReal      sorted[ELEMENT_MAX_DOFS];

  for (PetscInt d = 0; d < TABLES_KEY; d++) {
    key[d] = 0;
    for (PetscInt a = 0; a < n && d < dim; a++) {
      const PetscReal x = body->mesh.coordinates[body->mesh.connectivity[e * n + a] * dim + d];
      PetscInt        k = a;

      for (; k > 0 && sorted[k - 1] > x; k--) sorted[k] = sorted[k - 1];
      sorted[k] = x;
    }
    for (PetscInt a = 0; a < n && d < dim; a++) key[d] += sorted[a] / (PetscReal)n;
  }
}

/* The point of the packed element that has become point g: elements with several have one for each corner, in order; `places`: of nodes */
static PetscInt FindPoint(Body body, PetscInt e, PetscInt g, const PetscReal places[])
{
  const PetscInt   n = body->model.element->nodes, dim = body->mesh.dim, points = body->model.element->history.points;
  const PetscReal *x = body->mesh.coordinates + body->mesh.connectivity[e * n + g] * dim;

  if (points == 1) return g;
  for (PetscInt a = 0; a < points; a++) {
    PetscBool same = PETSC_TRUE;

    for (PetscInt d = 0; d < dim; d++) same = (PetscBool)(same && places[a * dim + d] == x[d]);
    if (same) return a;
  }
  return g;
}

/* Columns of an element: its place, those of its nodes, the history of its points */
static PetscInt HistoryWidth(Body body)
{
  const Element element = body->model.element;

  return TABLES_KEY + element->nodes * body->mesh.dim + element->history.points * element->history.n;
}

/* BodyVisitHistory - the table of the history of the material, element by element */
PetscErrorCode BodyVisitHistory(Body body, Tables tables)
{
  const Element    element = body->model.element;
  const PetscBool  loads   = TablesLoads(tables);
  const PetscInt   nodes = element->nodes, dim = body->mesh.dim, points = element->history.points, n_history = element->history.n;
  const PetscInt   width = HistoryWidth(body);
  const PetscReal *there = NULL;
  PetscReal       *saved, *packed;
  PetscInt         n, row;
  size_t           size;
  char             name[256];

  PetscFunctionBegin;
  saved = BodyHistoryGetSaved(body, &size);
  if (!saved) PetscFunctionReturn(PETSC_SUCCESS);
  /* that of another material means something else */
  PetscCall(PetscSNPrintf(name, sizeof(name), "history of %s", BodyGetMaterialName(body)));
  if (loads) PetscCall(TablesGet(tables, name, width, &n, &there));
  PetscCall(PetscMalloc1(element->count * width, &packed));
  for (PetscInt e = 0; e < element->count; e++) {
    const PetscInt slot = ElementHistorySlot(element, e);
    PetscReal     *line = packed + e * width, *places = line + TABLES_KEY;

    GetElementKey(body, e, line);
    for (PetscInt a = 0; a < nodes; a++)
      PetscCall(PetscArraycpy(places + a * dim, body->mesh.coordinates + body->mesh.connectivity[e * nodes + a] * dim, dim));
    if (loads) {
      PetscCall(TablesFind(tables, name, line, &row));
      PetscCall(PetscArraycpy(line, there + row * width, width));
    }
    for (PetscInt g = 0; g < points; g++) {
      PetscReal *values = places + nodes * dim + (loads ? FindPoint(body, e, g, places) : g) * n_history;

      for (PetscInt c = 0; c < n_history; c++)
        TablesCopyReals(loads, 1, &saved[(slot / 8 * points * n_history + g * n_history + c) * 8 + slot % 8], &values);
    }
  }
  if (loads) BodyHistoryRestore(body);
  else PetscCall(TablesAdd(tables, name, element->count, width, packed));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The name of the material whose history the tables have for a body; NULL if they have none */
static PetscErrorCode FindHistory(Body body, Tables tables, const char *material[])
{
  char     begin[256];
  size_t   length;
  PetscInt n;

  PetscFunctionBegin;
  *material = NULL;
  PetscCall(PetscSNPrintf(begin, sizeof(begin), "%s/history of ", body->hdr.name));
  PetscCall(PetscStrlen(begin, &length));
  TablesGetNumber(tables, &n);
  for (PetscInt i = 0; i < n && !*material; i++) {
    const char      *name;
    PetscInt         rows, width;
    const PetscReal *values;
    PetscBool        same;

    PetscCall(TablesGetTable(tables, i, &name, &rows, &width, &values));
    PetscCall(PetscStrncmp(name, begin, length, &same));
    if (same) *material = name + length;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The history of a body's material from the tables of another run with the same mesh, before BodySetInitialState(). Where the body had
   none, its material stays virgin. BodyNotePlasticBefore() has to follow when the displacements are there. Collective. */
PetscErrorCode BodyTakeHistory(Body body, Tables tables)
{
  const char *before, *now = BodyGetMaterialName(body);
  PetscBool   same;

  PetscFunctionBegin;
  PetscCall(FindHistory(body, tables, &before));
  if (!before) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscStrcmp(before, now, &same));
  PetscCheck(same, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-restart_state: the checkpoint has the history of body '%s' for the material %s, which means nothing for %s; give "
             "-%s_material_type, or those of its blocks, as it was: %s",
             body->hdr.name, before, now, body->hdr.name, before);
  PetscCall(BodyVisitHistory(body, tables));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyNotePlasticBefore - earlier plastic work is none of this run; after BodyTakeHistory() and BodySetInitialState() */
PetscErrorCode BodyNotePlasticBefore(Body body)
{
  BodyMeasures measures;

  PetscFunctionBegin;
  PetscCall(BodyGetMeasures(body, &measures));
  body->plastic_before += measures.plastic_work;
  PetscFunctionReturn(PETSC_SUCCESS);
}
