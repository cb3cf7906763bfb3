/* Materials of blocks: parts of a body, named in its mesh, that have materials of their own. */
#include <body/layout/bodyimpl.h>
#include <impakt/private/mesh.h>
#include <sys/names.h>
#include <sys/units.h>

/*@C
  BodySetBlockMaterial - gives a block of the mesh a material of its own

  Collective

  Input Parameters:
+ body     - the `Body`, before its set-up and before functions that look at the mesh, such as `BodyAddTraction()`
. block    - name of a physical volume of a Gmsh file (surface in two dimensions, curve in one), of an element block of an Exodus II file,
             or its number
- material - its `Material`, with type and constants

  Options Database Keys:
+ -<body>_<block>_material_type (linear_elastic|saint_venant_kirchhoff|neo_hookean|mooney_rivlin|j2|j2_small|johnson_cook) - its model
. -<body>_<block>_density rho      - its mass density [kg/m^3]
- -<body>_<block>_youngs_modulus E - and its other constants, as those of a body

  Level: intermediate

  Notes:
  Cells in no such block have the material of the body, which is not needed where there are none. What the options do not say of a block is
  what they say of the body. A cell can be in one block with a material only.

  All blocks have the formulation of `-<body>_element_formulation`; without one, each has the default of its material.

.seealso: `Body`, `BodySetMaterial()`, `BodyGetBlocks()`, `BodyGetSurfaceMaterial()`
@*/
PetscErrorCode BodySetBlockMaterial(Body body, const char block[], Material material)
{
  BodyBlocks *blocks;
  char      **names;
  Material   *materials;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(block, 2);
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 3);
  blocks = &body->model.blocks;
  PetscCheck(
      !body->mesh.positions && !blocks->of_cell, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
      "Body '%s' has its elements already: call BodySetBlockMaterial() before BodySetFromOptions() and functions that look at the mesh",
      body->hdr.name);
  for (PetscInt k = 0; k < blocks->n; k++) {
    PetscBool same;

    PetscCall(PetscStrcmp(blocks->names[k], block, &same));
    if (!same) continue;
    PetscCall(PetscObjectReference((PetscObject)material));
    PetscCall(MaterialDestroy(&blocks->materials[k]));
    blocks->materials[k] = material;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /* room for one more, the body's own */
  PetscCall(PetscCalloc2(blocks->n + 2, &names, blocks->n + 2, &materials));
  PetscCall(PetscArraycpy(names, blocks->names, blocks->n));
  PetscCall(PetscArraycpy(materials, blocks->materials, blocks->n));
  PetscCall(PetscFree2(blocks->names, blocks->materials));
  blocks->names     = names;
  blocks->materials = materials;
  PetscCall(PetscStrallocpy(block, &names[blocks->n]));
  PetscCall(PetscObjectReference((PetscObject)material));
  materials[blocks->n] = material;
  blocks->given        = ++blocks->n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyDestroyBlocks(Body body)
{
  BodyBlocks *blocks = &body->model.blocks;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < blocks->n; k++) {
    PetscCall(PetscFree(blocks->names[k]));
    PetscCall(MaterialDestroy(&blocks->materials[k]));
  }
  PetscCall(PetscFree2(blocks->names, blocks->materials));
  if (blocks->of_element != blocks->of_cell) PetscCall(PetscFree(blocks->of_element));
  PetscCall(PetscFree(blocks->of_cell));
  PetscCall(PetscFree(blocks->material_name));
  PetscCall(PetscFree(blocks->mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the cells of each block; -1: those of none */
static PetscErrorCode MarkCells(Body body)
{
  BodyBlocks *blocks = &body->model.blocks;
  PetscInt    cstart, cend, twice[2] = {-1, -1};

  PetscFunctionBegin;
  PetscCall(DMPlexGetHeightStratum(body->mesh.dm, 0, &cstart, &cend));
  PetscCall(PetscMalloc1(cend - cstart + 1, &blocks->of_cell));
  for (PetscInt c = 0; c < cend - cstart; c++) blocks->of_cell[c] = -1;
  for (PetscInt k = 0; k < blocks->given; k++) {
    PetscInt n, *cells;

    PetscCall(MeshGetBlock(body->mesh.dm, blocks->names[k], &n, &cells));
    for (PetscInt i = 0; i < n; i++) {
      PetscInt *block = &blocks->of_cell[cells[i] - cstart];

      if (*block >= 0) {
        twice[0] = *block;
        twice[1] = k;
      }
      *block = k;
    }
    PetscCall(PetscFree(cells));
    /* of all ranks, the same pair */
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, twice, 2, MPIU_INT, MPI_MAX, PetscObjectComm((PetscObject)body)));
    PetscCheck(twice[1] < 0, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
               "Body '%s': cells of its mesh are in block '%s' and in block '%s' at once, and both have a material; give one to blocks "
               "without common cells",
               body->hdr.name, blocks->names[twice[0]], blocks->names[twice[1]]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the history of the body belongs to */
static PetscErrorCode NameMaterials(Body body)
{
  BodyBlocks *blocks     = &body->model.blocks;
  char        text[1024] = "";

  PetscFunctionBegin;
  for (PetscInt k = 0; k < blocks->n; k++) {
    char one[512];

    PetscCall(PetscSNPrintf(one, sizeof(one), "%s%s%s", blocks->names[k], blocks->names[k][0] ? ":" : "",
                            ((PetscObject)blocks->materials[k])->type_name));
    PetscCall(NamesAppend(text, sizeof(text), " ", one));
  }
  PetscCall(PetscStrallocpy(text, &blocks->material_name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the block of each cell once. `own`: whether cells have the material of the body; NULL: complete the blocks by those. Collective. */
PetscErrorCode BodySetUpBlocks(Body body, PetscBool *own)
{
  BodyBlocks *blocks = &body->model.blocks;
  PetscInt    cstart, cend;
  PetscBool   others = PETSC_FALSE;

  PetscFunctionBegin;
  if (own) *own = PETSC_TRUE;
  if (!blocks->n || blocks->material_name) PetscFunctionReturn(PETSC_SUCCESS);
  if (!blocks->of_cell) PetscCall(MarkCells(body));
  PetscCall(DMPlexGetHeightStratum(body->mesh.dm, 0, &cstart, &cend));
  for (PetscInt c = 0; c < cend - cstart; c++) others = (PetscBool)(others || blocks->of_cell[c] < 0);
  PetscCall(BodyAnyRank(body, &others));
  if (own) {
    *own = others;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (others) {
    PetscCheck(
        body->model.material, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
        "Body '%s' has cells in no block that has a material, and no material itself: call BodySetMaterial() or BodySetFromOptions()",
        body->hdr.name);
    for (PetscInt c = 0; c < cend - cstart; c++)
      if (blocks->of_cell[c] < 0) blocks->of_cell[c] = blocks->given;
    PetscCall(PetscStrallocpy("", &blocks->names[blocks->given]));
    PetscCall(PetscObjectReference((PetscObject)body->model.material));
    blocks->materials[blocks->given] = body->model.material;
    blocks->n                        = blocks->given + 1;
  } else {
    PetscCall(PetscObjectReference((PetscObject)blocks->materials[0]));
    PetscCall(MaterialDestroy(&body->model.material));
    body->model.material = blocks->materials[0];
  }
  PetscCall(NameMaterials(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyGetMaterialName - the model, or those of all blocks: what histories in checkpoints belong to */
const char *BodyGetMaterialName(Body body)
{
  return body->model.blocks.n ? body->model.blocks.material_name : ((PetscObject)body->model.material)->type_name;
}

/*@C
  BodyGetBlocks - the parts of a body that have materials of their own

  Not Collective

  Input Parameter:
. body - the `Body`, after `BodySetFromOptions()` or its set-up

  Output Parameters:
+ n         - their number, with the rest of the body, if there is one; 0: all of it has the material of `BodyGetMaterial()`
. names     - of each; that of the rest of the body is empty, and the last. May be `NULL`
- materials - of each; all of it is owned by the body. May be `NULL`

  Level: intermediate

.seealso: `Body`, `BodySetBlockMaterial()`, `BodyGetCellBlocks()`, `BodyGetBlockMass()`
@*/
PetscErrorCode BodyGetBlocks(Body body, PetscInt *n, const char *const *names[], const Material *materials[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(n, 2);
  *n = body->model.blocks.n;
  if (names) *names = (const char *const *)body->model.blocks.names;
  if (materials) *materials = body->model.blocks.materials;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  BodyGetCellBlocks - which block each cell belongs to

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. blocks - for each cell of this rank, in the order of `BodyGetCells()`, its place among those of `BodyGetBlocks()`; owned by the body;
           `NULL` where there are no blocks

  Level: intermediate

.seealso: `Body`, `BodyGetBlocks()`
@*/
PetscErrorCode BodyGetCellBlocks(Body body, const PetscInt *blocks[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(blocks, 2);
  *blocks = body->model.blocks.n ? body->model.blocks.of_cell : NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  BodyGetBlockMass - the mass of each block

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. mass - of each of `BodyGetBlocks()` [kg]; owned by the body; `NULL` where there are none

  Level: intermediate

.seealso: `Body`, `BodyGetBlocks()`, `BodyGetMass()`
@*/
PetscErrorCode BodyGetBlockMass(Body body, const PetscReal *mass[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(mass, 2);
  *mass = body->model.blocks.mass;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyComputeBlockMass - finds what BodyGetBlockMass() tells, with the elements */
PetscErrorCode BodyComputeBlockMass(Body body)
{
  BodyBlocks    *blocks  = &body->model.blocks;
  const Element  element = body->model.element;
  const PetscInt n       = element->nodes;
  PetscScalar    M[ELEMENT_MAX_NODES * ELEMENT_MAX_NODES];

  PetscFunctionBegin;
  if (!blocks->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc1(blocks->n, &blocks->mass));
  for (PetscInt e = 0; e < element->count; e++) {
    PetscCall((*element->ops->mass)(element, e, M));
    for (PetscInt a = 0; a < n; a++)
      for (PetscInt b = 0; b < n; b++) blocks->mass[blocks->of_element[e]] += PetscRealPart(M[a * n + b]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, blocks->mass, (PetscMPIInt)blocks->n, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyViewBlocks - names, models and masses */
PetscErrorCode BodyViewBlocks(Body body, PetscViewer viewer)
{
  const BodyBlocks *blocks = &body->model.blocks;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < blocks->n; k++)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  %s%s: %s, mass %g%s\n", k < blocks->given ? "block " : "the rest", blocks->names[k],
                                     ((PetscObject)blocks->materials[k])->type_name, (double)blocks->mass[k],
                                     UnitsOf((PetscObject)body, UNIT_MASS)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The elements of which block have a contact node on any rank; all blocks, where there are none */
static PetscErrorCode FindTouching(Body body, int touching[])
{
  const BodyBlocks *blocks = &body->model.blocks;
  const PetscInt    nodes  = body->model.element->nodes;
  PetscBool         any    = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < blocks->n; k++) touching[k] = 0;
  for (PetscInt e = 0; e < body->model.element->count; e++)
    for (PetscInt a = 0; a < nodes; a++)
      if (body->layer.contains[body->mesh.connectivity[e * nodes + a]]) touching[blocks->of_element[e]] = 1;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, touching, (PetscMPIInt)blocks->n, MPI_INT, MPI_MAX, PetscObjectComm((PetscObject)body)));
  for (PetscInt k = 0; k < blocks->n; k++) any = (PetscBool)(any || touching[k]);
  for (PetscInt k = 0; k < blocks->n && !any; k++) touching[k] = 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyNoteSurfaceMaterial - finds what BodyGetSurfaceMaterial() tells, when elements, or contact nodes, have been set up */
PetscErrorCode BodyNoteSurfaceMaterial(Body body)
{
  const BodyBlocks *blocks  = &body->model.blocks;
  PetscReal         largest = 0;
  int              *touching;

  PetscFunctionBegin;
  if (!blocks->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(blocks->n, &touching));
  PetscCall(FindTouching(body, touching));
  for (PetscInt k = 0; k < blocks->n; k++) {
    PetscReal modulus;

    if (!touching[k]) continue;
    if (body->mesh.dim == 1) PetscCall(MaterialGetUniaxialModulus(blocks->materials[k], &modulus));
    else PetscCall(MaterialGetWaveModulus(blocks->materials[k], &modulus));
    if (modulus <= largest) continue;
    largest                      = modulus;
    body->model.surface_material = blocks->materials[k];
  }
  PetscCall(PetscFree(touching));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The material that impedances, penalty parameters and scales of contact are taken from: that of the body; of one with several, the
   stiffest of the elements with a contact node, and before these are known, or where there are none, the stiffest of all. Owned by the
   body. Not collective. */
PetscErrorCode BodyGetSurfaceMaterial(Body body, Material *material)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(material, 2);
  *material = body->model.surface_material ? body->model.surface_material : body->model.material;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the stiffness of a body is constant: all its materials are linear, or it is rigid and cannot turn. Not collective. */
PetscErrorCode BodyIsLinear(Body body, PetscBool *linear)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(linear, 2);
  if (body->integrator && !body->integrator->deforms) {
    *linear = (PetscBool)(body->mesh.dim == 1 || body->model.element->axisymmetric);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!body->model.blocks.n) {
    PetscCall(MaterialIsLinear(body->model.material, linear));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  *linear = PETSC_TRUE;
  for (PetscInt k = 0; k < body->model.blocks.n && *linear; k++) PetscCall(MaterialIsLinear(body->model.blocks.materials[k], linear));
  PetscFunctionReturn(PETSC_SUCCESS);
}
