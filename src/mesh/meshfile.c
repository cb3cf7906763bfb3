/* Nodes, elements and groups of a mesh file, as the readers of all formats hand them on. */
#include "meshimpl.h"
#include <sys/names.h>

PetscErrorCode MeshFileInitialize(MeshFile *file, const char path[])
{
  PetscFunctionBegin;
  PetscCall(PetscMemzero(file, sizeof(*file)));
  file->path = path;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MeshFileDestroy(MeshFile *file)
{
  PetscFunctionBegin;
  PetscCall(NamesDestroy(file->n_wanted, &file->wanted));
  PetscCall(PetscFree(file->coordinates));
  PetscCall(PetscFree(file->node_numbers));
  PetscCall(PetscFree(file->sorted_numbers));
  PetscCall(PetscFree(file->sorted_nodes));
  PetscCall(PetscFree(file->groups));
  PetscCall(PetscFree(file->runs));
  PetscCall(PetscFree(file->run_groups));
  PetscCall(PetscFree(file->numbers));
  PetscCall(PetscFree(file->element_nodes));
  PetscCall(PetscFree(file->cells));
  PetscCall(PetscFree(file->cell_numbers));
  PetscCall(PetscFree(file->vertex_of_node));
  PetscCall(PetscFree(file->vertices));
  PetscCall(PetscFree(file->edges));
  PetscCall(PetscFree(file->edge_of_node));
  PetscCall(PetscFree(file->node_of_edge));
  PetscCall(PetscFree(file->text));
  PetscCall(PetscMemzero(file, sizeof(*file)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes room for n items of some size, and for half as many more, so that adding items one by one costs little */
static PetscErrorCode Reserve(void *array, size_t size, PetscInt n, PetscInt *max)
{
  PetscFunctionBegin;
  if (n <= *max) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(n < PETSC_INT_MAX / 2, PETSC_COMM_SELF, PETSC_ERR_SUP, "More than %" PetscInt_FMT " entries of one kind are not supported",
             PETSC_INT_MAX / 2);
  *max = PetscMax(16, n + n / 2);
  PetscCall(PetscRealloc((size_t)*max * size, (void **)array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the group of that kind, dimension and number, or adds it */
PetscErrorCode MeshFileAddGroup(MeshFile *file, MeshGroupKind kind, PetscInt dim, PetscInt number, PetscInt *group)
{
  PetscFunctionBegin;
  for (*group = 0; *group < file->n_groups; (*group)++) {
    const MeshGroup *known = &file->groups[*group];

    if (known->kind == kind && known->dim == dim && known->number == number) PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(Reserve(&file->groups, sizeof(*file->groups), file->n_groups + 1, &file->max_groups));
  file->groups[file->n_groups].kind    = kind;
  file->groups[file->n_groups].dim     = dim;
  file->groups[file->n_groups].number  = number;
  file->groups[file->n_groups].name[0] = 0;
  file->n_groups++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Begins a run: elements that are added from now on have this shape and are in these groups. `second_order`: with a node in the middle of
   each edge, after their corners: lines, triangles, tetrahedra */
PetscErrorCode MeshFileAddRun(MeshFile *file, DMPolytopeType shape, PetscBool second_order, PetscInt n_groups, const PetscInt groups[])
{
  const PetscInt corners = DMPolytopeTypeGetNumVertices(shape), dim = DMPolytopeTypeGetDim(shape);
  const PetscInt nodes = corners + (second_order ? dim * (dim + 1) / 2 : 0);
  MeshRun       *run   = file->n_runs ? &file->runs[file->n_runs - 1] : NULL;

  PetscFunctionBegin;
  if (run && run->shape == shape && run->nodes == nodes && run->n_groups == n_groups) {
    PetscInt same = 0;

    while (same < n_groups && file->run_groups[run->first_group + same] == groups[same]) same++;
    if (same == n_groups) PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(Reserve(&file->runs, sizeof(*file->runs), file->n_runs + 1, &file->max_runs));
  PetscCall(Reserve(&file->run_groups, sizeof(*file->run_groups), file->n_run_groups + n_groups, &file->max_run_groups));
  run              = &file->runs[file->n_runs++];
  run->shape       = shape; /* NOLINT(clang-analyzer-core.NullDereference): Reserve() has set runs, through a void pointer */
  run->dim         = dim;
  run->corners     = corners;
  run->nodes       = nodes;
  run->n           = 0;
  run->first       = file->n_elements;
  run->first_node  = file->n_element_nodes;
  run->n_groups    = n_groups;
  run->first_group = file->n_run_groups;
  run->chosen      = PETSC_FALSE;
  for (PetscInt g = 0; g < n_groups; g++) file->run_groups[file->n_run_groups++] = groups[g];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds an element to the last run. The caller fills in its nodes. */
PetscErrorCode MeshFileAddElement(MeshFile *file, PetscInt number, PetscInt *nodes[])
{
  MeshRun *run = &file->runs[file->n_runs - 1];

  PetscFunctionBegin;
  PetscCall(Reserve(&file->numbers, sizeof(*file->numbers), file->n_elements + 1, &file->max_elements));
  PetscCall(Reserve(&file->element_nodes, sizeof(*file->element_nodes), file->n_element_nodes + run->nodes, &file->max_element_nodes));
  file->numbers[file->n_elements++] = number;
  *nodes                            = file->element_nodes + file->n_element_nodes;
  file->n_element_nodes += run->nodes;
  run->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Prepares the search for nodes by the numbers that the file gives them */
PetscErrorCode MeshFileNumberNodes(MeshFile *file)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(file->n_nodes, &file->sorted_numbers));
  PetscCall(PetscMalloc1(file->n_nodes, &file->sorted_nodes));
  PetscCall(PetscArraycpy(file->sorted_numbers, file->node_numbers, file->n_nodes));
  for (PetscInt i = 0; i < file->n_nodes; i++) file->sorted_nodes[i] = i;
  PetscCall(PetscSortIntWithArray(file->n_nodes, file->sorted_numbers, file->sorted_nodes));
  for (PetscInt i = 1; i < file->n_nodes; i++)
    PetscCheck(file->sorted_numbers[i] != file->sorted_numbers[i - 1], PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "node %" PetscInt_FMT " is there twice", file->sorted_numbers[i]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The node with this number in the file; -1 if there is none */
PetscErrorCode MeshFileFindNode(MeshFile *file, PetscInt number, PetscInt *node)
{
  PetscFunctionBegin;
  PetscCall(PetscFindInt(number, file->n_nodes, file->sorted_numbers, node));
  if (*node >= 0) *node = file->sorted_nodes[*node];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a block belongs to the body: -mesh_blocks lists its name or number, or is not given */
PetscErrorCode MeshFileWants(const MeshFile *file, PetscInt number, const char name[], PetscBool *wants)
{
  char text[32];

  PetscFunctionBegin;
  *wants = (PetscBool)!file->n_wanted;
  PetscCall(PetscSNPrintf(text, sizeof(text), "%" PetscInt_FMT, number));
  for (PetscInt i = 0; i < file->n_wanted && !*wants; i++) {
    PetscCall(PetscStrcmp(file->wanted[i], name, wants));
    if (!*wants) PetscCall(PetscStrcmp(file->wanted[i], text, wants));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
