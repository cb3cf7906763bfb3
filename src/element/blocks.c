/* Elements of several materials: each block of the mesh has elements of its own, with one material, whose loops are those of a body with
   that material alone. What is asked of all elements goes to each of them in turn, and what is asked of one to the block that it is in.

   Elements keep their numbers. Their history lies block by block, each from a whole batch on: see ElementHistorySlot(). */
#include <impakt/private/elementimpl.h>

struct _n_ElementBlocks {
  PetscInt  n;
  Material *materials;
  char    **formulations; /* NULL: the default of the material */
  PetscInt *block;        /* of each element */
  /* set-up */
  Element   *parts;        /* the elements of each block */
  PetscInt **numbers;      /* of the elements of each, ascending */
  PetscInt **connectivity; /* theirs */
  PetscInt  *local;        /* number of each element in its block */
  PetscInt  *first_slot;   /* where the history of each block begins, in elements */
  PetscReal *values;       /* work: 6 for each element of a block */
};

/* Batches of elements whose history lies together */
#define BATCH 8

/* ElementHistorySlot - what takes the place of the number of an element where its history is looked for */
PetscInt ElementHistorySlot(Element element, PetscInt e)
{
  const ElementBlocks blocks = element->blocks;

  return blocks ? blocks->first_slot[blocks->block[e]] + blocks->local[e] : e;
}

static PetscErrorCode BlocksDestroy(ElementBlocks *blocks)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < (*blocks)->n; k++) {
    PetscCall(MaterialDestroy(&(*blocks)->materials[k]));
    PetscCall(PetscFree((*blocks)->formulations[k]));
    PetscCall(ElementDestroy(&(*blocks)->parts[k]));
    PetscCall(PetscFree((*blocks)->numbers[k]));
    PetscCall(PetscFree((*blocks)->connectivity[k]));
  }
  PetscCall(PetscFree6((*blocks)->materials, (*blocks)->formulations, (*blocks)->parts, (*blocks)->numbers, (*blocks)->connectivity,
                       (*blocks)->first_slot));
  PetscCall(PetscFree2((*blocks)->block, (*blocks)->local));
  PetscCall(PetscFree((*blocks)->values));
  PetscCall(PetscFree(*blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The elements of a block, ready to compute with the history that all elements have at present; NULL where this rank has none of them */
static Element OpenPart(Element element, PetscInt k)
{
  const ElementBlocks   blocks  = element->blocks;
  const ElementHistory *history = &element->history;
  const Element         part    = blocks->parts[k];
  const size_t          at      = (size_t)blocks->first_slot[k] * (size_t)(history->points * history->n);

  if (!part->count) return NULL;
  part->history.start   = part->history.n && history->start ? history->start + at : NULL;
  part->history.end     = part->history.n && history->end ? history->end + at : NULL;
  part->history.step    = history->step;
  part->history.by_ends = history->by_ends;
  return part;
}

/* The first element that is inverted, by its number among all */
static void NoteInverted(Element element, PetscInt k)
{
  const ElementBlocks blocks   = element->blocks;
  const PetscInt      inverted = blocks->parts[k]->inverted;

  if (inverted < 0) return;
  if (element->inverted < 0 || blocks->numbers[k][inverted] < element->inverted) element->inverted = blocks->numbers[k][inverted];
}

static PetscErrorCode ElementInternalForce_Blocks(Element element, const PetscScalar u[], PetscScalar f[])
{
  PetscFunctionBegin;
  element->inverted = -1;
  for (PetscInt k = 0; k < element->blocks->n; k++) {
    Element part = OpenPart(element, k);

    if (!part) continue;
    PetscCall((*part->ops->internalforce)(part, u, f));
    NoteInverted(element, k);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementEnergy_Blocks(Element element, const PetscScalar u[], PetscReal *energy)
{
  PetscFunctionBegin;
  *energy               = 0;
  element->inverted     = -1;
  element->plastic_work = 0;
  for (PetscInt k = 0; k < element->blocks->n; k++) {
    Element   part = OpenPart(element, k);
    PetscReal of_block;

    if (!part) continue;
    PetscCall((*part->ops->energy)(part, u, &of_block));
    *energy += of_block;
    if (part->history.n) element->plastic_work += part->plastic_work;
    NoteInverted(element, k);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementHourglass_Blocks(Element element, const PetscScalar u[], PetscReal *energy)
{
  PetscFunctionBegin;
  *energy = 0;
  for (PetscInt k = 0; k < element->blocks->n; k++) {
    Element   part = OpenPart(element, k);
    PetscReal of_block;

    if (!part) continue;
    PetscCall((*part->ops->hourglass)(part, u, &of_block));
    *energy += of_block;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementViscousForce_Blocks(Element element, const PetscScalar u[], const PetscScalar v[], PetscScalar f[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < element->blocks->n; k++) {
    Element part = OpenPart(element, k);

    if (part) PetscCall((*part->ops->viscousforce)(part, u, v, f));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementTangent_Blocks(Element element, PetscInt e, PetscBool viscous, const PetscScalar u[], PetscScalar K[])
{
  const Element part = OpenPart(element, element->blocks->block[e]);

  PetscFunctionBegin;
  PetscCall((*part->ops->tangent)(part, element->blocks->local[e], viscous, u, K));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementMass_Blocks(Element element, PetscInt e, PetscScalar M[])
{
  const Element part = element->blocks->parts[element->blocks->block[e]];

  PetscFunctionBegin;
  PetscCall((*part->ops->mass)(part, element->blocks->local[e], M));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementPoints_Blocks(Element element, PetscInt e, PetscReal positions[], PetscReal weights[])
{
  const Element part = element->blocks->parts[element->blocks->block[e]];

  PetscFunctionBegin;
  PetscCall((*part->ops->points)(part, element->blocks->local[e], positions, weights));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementNearest_Blocks(Element element, PetscInt e, const PetscReal x[], PetscReal N[], PetscReal *distance)
{
  const Element part = element->blocks->parts[element->blocks->block[e]];

  PetscFunctionBegin;
  PetscCall((*part->ops->nearest)(part, element->blocks->local[e], x, N, distance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementStress_Blocks(Element element, const PetscScalar u[], PetscReal stress[])
{
  const ElementBlocks blocks = element->blocks;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < blocks->n; k++) {
    Element part = OpenPart(element, k);

    if (!part) continue;
    PetscCall((*part->ops->stress)(part, u, blocks->values));
    for (PetscInt i = 0; i < part->count; i++)
      for (PetscInt c = 0; c < 6; c++) stress[6 * blocks->numbers[k][i] + c] = blocks->values[6 * i + c];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nothing is plastic in blocks without history */
static PetscErrorCode ElementPlastic_Blocks(Element element, PetscReal *work, PetscReal strain[])
{
  const ElementBlocks blocks = element->blocks;

  PetscFunctionBegin;
  *work = 0;
  for (PetscInt i = 0; i < element->count && strain; i++) strain[i] = 0;
  for (PetscInt k = 0; k < blocks->n; k++) {
    Element   part = OpenPart(element, k);
    PetscReal of_block;

    if (!part || !part->history.n || !part->ops->plastic) continue;
    PetscCall((*part->ops->plastic)(part, &of_block, strain ? blocks->values : NULL));
    *work += of_block;
    for (PetscInt i = 0; i < part->count && strain; i++) strain[blocks->numbers[k][i]] = blocks->values[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ElementView_Blocks(Element element, PetscViewer viewer)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < element->blocks->n; k++)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  block %" PetscInt_FMT ": %s, formulation %s\n", k,
                                     ((PetscObject)element->blocks->materials[k])->type_name, element->blocks->parts[k]->formulation));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void SetOps(Element element)
{
  PetscBool hourglass = PETSC_TRUE, viscous = PETSC_TRUE, plastic = PETSC_FALSE, nearest = PETSC_TRUE;

  for (PetscInt k = 0; k < element->blocks->n; k++) {
    const struct _ElementOps *ops = element->blocks->parts[k]->ops;

    hourglass = (PetscBool)(hourglass && ops->hourglass);
    viscous   = (PetscBool)(viscous && ops->viscousforce);
    nearest   = (PetscBool)(nearest && ops->nearest);
    plastic   = (PetscBool)(plastic || ops->plastic);
  }
  element->ops->internalforce = ElementInternalForce_Blocks;
  element->ops->energy        = ElementEnergy_Blocks;
  element->ops->hourglass     = hourglass ? ElementHourglass_Blocks : NULL;
  element->ops->tangent       = ElementTangent_Blocks;
  element->ops->viscousforce  = viscous ? ElementViscousForce_Blocks : NULL;
  element->ops->mass          = ElementMass_Blocks;
  element->ops->stress        = ElementStress_Blocks;
  element->ops->plastic       = plastic ? ElementPlastic_Blocks : NULL;
  element->ops->points        = ElementPoints_Blocks;
  element->ops->nearest       = nearest ? ElementNearest_Blocks : NULL;
  element->ops->view          = ElementView_Blocks;
}

/* One stride for the histories of all blocks: that of the longest. Blocks without history have none of it. */
static PetscErrorCode SetUpHistory(Element element)
{
  const ElementBlocks blocks  = element->blocks;
  ElementHistory     *history = &element->history;
  PetscInt            slots   = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < blocks->n; k++) {
    const ElementHistory *of_block = &blocks->parts[k]->history;

    if (!of_block->n) continue;
    PetscCheck(!history->n || history->points == of_block->points, PetscObjectComm((PetscObject)element), PETSC_ERR_SUP,
               "-%selement_formulation: blocks of a body whose materials flow need formulations with the same points of integration",
               ((PetscObject)element)->prefix ? ((PetscObject)element)->prefix : "");
    history->n      = PetscMax(history->n, of_block->n);
    history->points = of_block->points;
  }
  for (PetscInt k = 0; k < blocks->n; k++) {
    if (blocks->parts[k]->history.n) blocks->parts[k]->history.n = history->n;
    blocks->first_slot[k] = slots;
    slots += (blocks->parts[k]->count + BATCH - 1) / BATCH * BATCH;
  }
  history->padding = blocks->n * (BATCH - 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The part of ElementSetUp() that makes the elements of each block */
static PetscErrorCode SetUpBlocks(Element element, const PetscReal coordinates[])
{
  const ElementBlocks blocks = element->blocks;
  PetscInt           *counts, largest = 0;
  PetscBool           same = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(blocks->n, &counts));
  for (PetscInt e = 0; e < element->count; e++) blocks->local[e] = counts[blocks->block[e]]++;
  for (PetscInt k = 0; k < blocks->n; k++) {
    PetscCall(PetscMalloc1(counts[k], &blocks->numbers[k]));
    PetscCall(PetscMalloc1(counts[k] * element->nodes, &blocks->connectivity[k]));
    largest = PetscMax(largest, counts[k]);
  }
  for (PetscInt e = 0; e < element->count; e++) {
    const PetscInt k = blocks->block[e], i = blocks->local[e];

    blocks->numbers[k][i] = e;
    PetscCall(PetscArraycpy(blocks->connectivity[k] + i * element->nodes, element->connectivity + e * element->nodes, element->nodes));
  }
  PetscCall(PetscMalloc1(6 * largest, &blocks->values));
  for (PetscInt k = 0; k < blocks->n; k++) {
    PetscCall(ElementDuplicateOn(element, PetscObjectComm((PetscObject)element), blocks->materials[k], &blocks->parts[k]));
    if (blocks->formulations[k]) PetscCall(ElementSetFormulation(blocks->parts[k], blocks->formulations[k]));
    PetscCall(PetscObjectSetName((PetscObject)blocks->parts[k], ((PetscObject)element)->name));
    PetscCall(ElementSetUp(blocks->parts[k], counts[k], blocks->connectivity[k], coordinates));
    if (k) PetscCall(PetscStrcmp(blocks->parts[k]->formulation, blocks->parts[k - 1]->formulation, &same));
    if (!same) largest = -1;
  }
  PetscCall(PetscFree(counts));
  if (largest >= 0 && !element->formulation) PetscCall(PetscStrallocpy(blocks->parts[0]->formulation, &element->formulation));
  element->n_points = blocks->parts[0]->n_points;
  element->shape    = blocks->parts[0]->shape;
  PetscCall(SetUpHistory(element));
  SetOps(element);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WarnOfLocking(Element element)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < element->blocks->n; k++) PetscCall(ElementWarnOfLocking(element->blocks->parts[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const ElementBlocksOps ops = {SetUpBlocks, WarnOfLocking, BlocksDestroy};

/* Gives elements several materials, before ElementSetUp(). `materials`: n, by block; `block`: of each of the `count` elements here */
PetscErrorCode ElementSetBlocks(Element element, PetscInt n, const Material materials[], PetscInt count, const PetscInt block[])
{
  ElementBlocks blocks;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(element, ELEMENT_CLASSID, 1);
  PetscCheck(!element->setup && !element->blocks, PetscObjectComm((PetscObject)element), PETSC_ERR_ARG_WRONGSTATE,
             "Call once, before ElementSetUp()");
  PetscCall(PetscNew(&blocks));
  element->blocks     = blocks;
  element->blocks_ops = &ops;
  blocks->n           = n;
  element->count      = count;
  PetscCall(PetscCalloc6(n, &blocks->materials, n, &blocks->formulations, n, &blocks->parts, n, &blocks->numbers, n, &blocks->connectivity,
                         n, &blocks->first_slot));
  PetscCall(PetscMalloc2(count, &blocks->block, count, &blocks->local));
  PetscCall(PetscArraycpy(blocks->block, block, count));
  for (PetscInt k = 0; k < n; k++) {
    PetscCall(PetscObjectReference((PetscObject)materials[k]));
    blocks->materials[k] = materials[k];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Some of the elements of another set, with nodes of their own, on this rank alone. `linearized`: with the materials of
   MaterialLinearize(); `elements`: their numbers there; `NULL`: the first ones; `connectivity`: numbers of their nodes; kept by reference;
   `coordinates`: of the nodes [m]; kept by reference */
PetscErrorCode ElementCreateSelection(Element element, PetscBool linearized, PetscInt count, const PetscInt elements[],
                                      const PetscInt connectivity[], const PetscReal coordinates[], Element *selection)
{
  const ElementBlocks blocks = element->blocks;
  Material            own    = element->material;

  PetscFunctionBegin;
  if (linearized && !blocks) PetscCall(MaterialLinearize(element->material, &own));
  PetscCall(ElementDuplicateOn(element, PETSC_COMM_SELF, own, selection));
  if (linearized && !blocks) PetscCall(MaterialDestroy(&own));
  if (blocks) {
    Material *materials;
    PetscInt *block;

    PetscCall(PetscMalloc2(blocks->n, &materials, count, &block));
    for (PetscInt e = 0; e < count; e++) block[e] = blocks->block[elements ? elements[e] : e];
    for (PetscInt k = 0; k < blocks->n; k++) {
      materials[k] = blocks->materials[k];
      if (linearized) PetscCall(MaterialLinearize(blocks->materials[k], &materials[k]));
    }
    PetscCall(ElementSetBlocks(*selection, blocks->n, materials, count, block));
    for (PetscInt k = 0; k < blocks->n; k++) {
      PetscCall(PetscStrallocpy(blocks->parts[k]->formulation, &(*selection)->blocks->formulations[k]));
      if (linearized) PetscCall(MaterialDestroy(&materials[k]));
    }
    PetscCall(PetscFree2(materials, block));
  }
  PetscCall(ElementSetUp(*selection, count, connectivity, coordinates));
  PetscFunctionReturn(PETSC_SUCCESS);
}
