/* Composite elements: which cells of the mesh make one, and its nodes. */
#include "bodyimpl.h"
#include "cells.h"
#include <impakt/private/mesh.h>

enum { MOST_CELLS = 8, MOST_CORNERS = 4 };

/* Makes the elements composite where the mesh is one of such elements, unless another formulation has been chosen */
PetscErrorCode BodyFindComposite(Body body)
{
  const char *formulation;
  PetscBool   divided, asked = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(MeshIsComposite(body->mesh.dm, &divided));
  PetscCall(ElementGetFormulation(body->model.element, &formulation));
  if (formulation) PetscCall(PetscStrcmp(formulation, ELEMENT_COMPOSITE, &asked));
  PetscCheck(!asked || divided, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "Body '%s', -%selement_formulation composite: its mesh, of cells of shape '%s', is not one of six-node triangles or ten-node "
             "tetrahedra; make it of triangles or tetrahedra by options or from a file, or by MeshCreateComposite()",
             body->hdr.name, ((PetscObject)body)->prefix ? ((PetscObject)body)->prefix : "", DMPolytopeTypes[body->mesh.cell_shape]);
  if (divided && (asked || !formulation)) PetscCall(ElementSetComposite(body->model.element));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many of the cells from the first on have a node, and the last of those that have */
static PetscInt CountCells(const PetscInt cells[], PetscInt n_cells, PetscInt nodes, PetscInt node, PetscInt *last)
{
  PetscInt count = 0;

  for (PetscInt c = 0; c < n_cells; c++)
    for (PetscInt k = 0; k < nodes; k++)
      if (cells[c * nodes + k] == node) {
        count++;
        *last = c;
      }
  return count;
}

/* The node that two cells have in common; -1: none, or several */
static PetscInt CommonNode(const PetscInt a[], const PetscInt b[], PetscInt nodes)
{
  PetscInt common = -1, n = 0;

  for (PetscInt k = 0; k < nodes; k++)
    for (PetscInt l = 0; l < nodes; l++)
      if (a[k] == b[l]) {
        common = a[k];
        n++;
      }
  return n == 1 ? common : -1;
}

/* Turns the nodes of a cell, its orientation kept, so that one of them is the first */
static void TurnTo(PetscInt node, PetscInt nodes, const PetscInt from[], PetscInt to[])
{
  PetscInt at = 0;

  while (at < nodes - 1 && from[at] != node) at++;
  /* of triangles the cycles, of tetrahedra the pairs of swaps */
  for (PetscInt k = 0; k < nodes; k++) to[k] = nodes == 3 ? from[(at + k) % 3] : from[at ^ k];
}

/* The nodes of an element from those of its cells. A corner is in one cell, which has the middles of the edges that meet there. */
static PetscBool FindNodes(const PetscInt cells[], PetscInt n_cells, PetscInt nodes, PetscInt element[])
{
  static const PetscInt edges[6][2]          = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  PetscInt              corner[MOST_CORNERS] = {0}, cell[MOST_CORNERS] = {0}, first[MOST_CORNERS], n = 0;
  const PetscInt        n_edges = nodes == 3 ? 3 : 6;

  for (PetscInt i = 0; i < n_cells * nodes; i++) {
    PetscInt in = -1;

    if (CountCells(cells, n_cells, nodes, cells[i], &in) != 1) continue;
    if (n == nodes) return PETSC_FALSE;
    corner[n] = cells[i];
    cell[n++] = in;
  }
  if (n != nodes) return PETSC_FALSE;
  /* the other corners in the order of the edges that lead to them from the first */
  TurnTo(corner[0], nodes, cells + cell[0] * nodes, first);
  for (PetscInt k = 1; k < nodes; k++) {
    PetscInt at = k;

    while (at < nodes && CommonNode(cells + cell[0] * nodes, cells + cell[at] * nodes, nodes) != first[k]) at++;
    if (at == nodes) return PETSC_FALSE;
    {
      const PetscInt other[2] = {corner[at], cell[at]};

      corner[at] = corner[k];
      cell[at]   = cell[k];
      corner[k]  = other[0];
      cell[k]    = other[1];
    }
  }
  for (PetscInt k = 0; k < nodes; k++) element[k] = corner[k];
  for (PetscInt k = 0; k < n_edges; k++) {
    element[nodes + k] = CommonNode(cells + cell[edges[k][0]] * nodes, cells + cell[edges[k][1]] * nodes, nodes);
    if (element[nodes + k] < 0) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* The nodes and the blocks of composite elements, whose cells follow each other */
PetscErrorCode BodySetUpComposite(Body body)
{
  BodyMesh      *mesh   = &body->mesh;
  BodyBlocks    *blocks = &body->model.blocks;
  const PetscInt cells = mesh->dim == 2 ? 4 : MOST_CELLS, n = mesh->n_cells / cells, nodes = body->model.element->nodes;
  PetscBool      mixed = PETSC_FALSE, wrong = (PetscBool)(mesh->n_cells % cells != 0);

  PetscFunctionBegin;
  mesh->cells_of_element = cells;
  PetscCall(PetscMalloc1(n * nodes, &mesh->connectivity));
  for (PetscInt e = 0; e < n && !wrong; e++)
    wrong = (PetscBool)!FindNodes(mesh->cell_connectivity + e * cells * mesh->cell_nodes, cells, mesh->cell_nodes,
                                  mesh->connectivity + e * nodes);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &wrong, 1, MPI_C_BOOL, MPI_LOR, PetscObjectComm((PetscObject)body)));
  PetscCheck(
      !wrong, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONG,
      "Body '%s': the mesh has the label of composite elements, but its cells are not what MeshCreateComposite() makes; do not refine "
      "or distribute a mesh after it",
      body->hdr.name);
  if (!blocks->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(n + 1, &blocks->of_element));
  for (PetscInt e = 0; e < n; e++) {
    blocks->of_element[e] = blocks->of_cell[e * cells];
    for (PetscInt c = 0; c < cells; c++) mixed = (PetscBool)(mixed || blocks->of_cell[e * cells + c] != blocks->of_element[e]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &mixed, 1, MPI_C_BOOL, MPI_LOR, PetscObjectComm((PetscObject)body)));
  PetscCheck(!mixed, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONG,
             "Body '%s': the cells of a composite element are in different blocks of the mesh", body->hdr.name);
  PetscFunctionReturn(PETSC_SUCCESS);
}
