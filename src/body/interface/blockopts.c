/* Materials of blocks from options, -<body>_<block>_density and others. */
#include <body/layout/bodyimpl.h>
#include <impakt/private/mesh.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/names.h>
#include <sys/optionstext.h>
#include <sys/optiontable.h>
#include <sys/sharedoptions.h>

/* An option of the body: what stands behind its prefix, and its value */
typedef struct {
  const char *full, *name, *value;
} BodyOption;

/* The options that begin with the name of the body; `text` has to stay as long as they are used */
static PetscErrorCode CollectOptions(const char prefix[], char text[], PetscInt *n, BodyOption *options[])
{
  const size_t length = strlen(prefix);
  const char  *name, *value;
  PetscInt     room = 1;

  PetscFunctionBegin;
  for (const char *c = text; *c; c++) room += *c == ' ';
  PetscCall(PetscMalloc1(room, options));
  *n = 0;
  while (OptionsTextNext(&text, &name, &value)) {
    if (strncasecmp(name + 1, prefix, length) != 0 || !name[1 + length]) continue;
    (*options)[*n].full      = name;
    (*options)[*n].name      = name + 1 + length;
    (*options)[(*n)++].value = value;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Options of materials that a block may have; those of elements and sections are the body's, and so is the named material */
static PetscBool IsOfMaterial(const KnownOption *option)
{
  const char *const others[] = {"material", "cross_section", "thickness", "plane_stress", "axisymmetric", "element_formulation"};

  if (option->owner != OPTION_OF_BODY || strcmp(option->topic, "materials") != 0) return PETSC_FALSE;
  if (option->name[0] == '<') return PETSC_FALSE; /* this kind of options itself */
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(others); i++)
    if (!strcmp(option->name, others[i])) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* The name of the block that an option is of: what stands before the name of an option of materials. Empty: it is another option. */
static void GetBlockName(const char name[], size_t size, char block[])
{
  const KnownOption *known;
  size_t             n;
  const size_t       length = strlen(name);

  block[0] = 0;
  known    = KnownOptionsGet(&n);
  for (size_t i = 0; i < n; i++)
    if (known[i].owner == OPTION_OF_BODY && !strcasecmp(known[i].name, name)) return;
  for (size_t i = 0; i < n; i++) {
    const size_t of_option = strlen(known[i].name);

    if (!IsOfMaterial(&known[i]) || length < of_option + 2 || length - of_option > size) continue;
    if (name[length - of_option - 1] != '_' || strcasecmp(name + length - of_option, known[i].name) != 0) continue;
    memcpy(block, name, length - of_option - 1);
    block[length - of_option - 1] = 0;
    return;
  }
}

/* Whether -bodies names a body whose options begin as those of the block do; `listed`: it is given at all */
static PetscErrorCode IsBody(Body body, const char block[], PetscBool *listed, PetscBool *is_body)
{
  PetscInt n;
  char   **names, full[512];

  PetscFunctionBegin;
  *is_body = PETSC_FALSE;
  PetscCall(PetscSNPrintf(full, sizeof(full), "%s%s", ((PetscObject)body)->prefix, block));
  PetscCall(NamesRead(NULL, "-bodies", &n, &names, listed));
  for (PetscInt i = 0; i < n; i++)
    if (!strcasecmp(names[i], full)) *is_body = PETSC_TRUE;
  PetscCall(NamesDestroy(n, &names));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether an option is one of a block of this body's mesh */
static PetscErrorCode CheckBlock(Body body, const BodyOption *option, const char block[], PetscBool *is_block)
{
  PetscBool listed, is_body;
  char      list[1024], shared[PETSC_MAX_OPTION_NAME];

  PetscFunctionBegin;
  PetscCall(IsBody(body, block, &listed, &is_body));
  PetscCall(MeshHasBlock(body->mesh.dm, block, is_block));
  PetscCheck(!*is_block || !is_body, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "%s is an option of body '%s%s' and of block '%s' of body '%s': rename one of them", option->full, ((PetscObject)body)->prefix,
             block, block, body->hdr.name);
  /* in programs without -bodies it may be the option of a body that comes later */
  if (*is_block || is_body || !listed) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(OptionsFindShared(option->full + 1, option->value, shared, sizeof(shared)));
  if (shared[0]) PetscFunctionReturn(PETSC_SUCCESS); /* of all bodies: others may have such a block */
  PetscCall(MeshListBlocks(body->mesh.dm, list, sizeof(list)));
  SETERRQ(PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT, "%s: the mesh of body '%s' has no block '%s'; it has: %s", option->full,
          body->hdr.name, block, list[0] ? list : "none");
}

/* Options that the material of a block has read, its own or the body's in their place, count as read in the run; others stay unread. */
static PetscErrorCode NoteUsed(PetscOptions options, const char prefix[], const char of_block[], PetscInt n,
                               const BodyOption body_options[])
{
  const size_t length = strlen(of_block) - strlen(prefix);

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) {
    const char *name = body_options[i].name;
    char        full[1024];
    PetscBool   own = (PetscBool)!strncasecmp(name, of_block + strlen(prefix), length), used, given = PETSC_FALSE;

    PetscCall(PetscSNPrintf(full, sizeof(full), "-%s%s", of_block, own ? name + length : name));
    PetscCall(PetscOptionsUsed(options, full + 1, &used));
    if (!used) continue;
    if (!own) PetscCall(PetscOptionsHasName(NULL, NULL, full, &given));
    if (own || !given) PetscCall(PetscOptionsHasName(NULL, NULL, body_options[i].full, &given));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A material with the options of a block, which are those of the body where it has none of its own */
static PetscErrorCode ReadBlock(Body body, const char block[], PetscInt n, const BodyOption body_options[])
{
  const char  *prefix = ((PetscObject)body)->prefix;
  char         of_block[512];
  PetscOptions options;
  Material     material;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(of_block, sizeof(of_block), "%s%s_", prefix, block));
  PetscCall(PetscOptionsCreate(&options));
  for (int own = 0; own < 2; own++)
    for (PetscInt i = 0; i < n; i++) {
      const size_t length = strlen(of_block) - strlen(prefix);
      const char  *name   = body_options[i].name;
      char         full[1024];

      if (own != !strncasecmp(name, of_block + strlen(prefix), length)) continue;
      if (own && !name[length]) continue;
      PetscCall(PetscSNPrintf(full, sizeof(full), "-%s%s", of_block, own ? name + length : name));
      PetscCall(PetscOptionsSetValue(options, full, body_options[i].value[0] ? body_options[i].value : NULL));
    }
  PetscCall(MaterialCreate(PetscObjectComm((PetscObject)body), &material));
  PetscCall(PetscObjectSetOptionsPrefix((PetscObject)material, of_block));
  PetscCall(PetscObjectSetOptions((PetscObject)material, options));
  PetscCall(MaterialSetFromOptions(material));
  PetscCall(PetscObjectSetOptions((PetscObject)material, NULL));
  PetscCall(NoteUsed(options, prefix, of_block, n, body_options));
  PetscCall(PetscOptionsDestroy(&options));
  PetscCall(BodySetBlockMaterial(body, block, material));
  PetscCall(MaterialDestroy(&material));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static int CompareNames(const void *a, const void *b)
{
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* BodyReadBlocks - materials of the mesh's blocks that have options, by their names; before its elements */
PetscErrorCode BodyReadBlocks(Body body)
{
  BodyOption *options;
  PetscInt    n = 0, n_blocks = 0;
  char       *text, **blocks;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetAll(NULL, &text));
  PetscCall(CollectOptions(((PetscObject)body)->prefix, text, &n, &options));
  PetscCall(PetscMalloc1(n, &blocks));
  for (PetscInt i = 0; i < n; i++) {
    char      name[256];
    PetscBool is_block, known = PETSC_FALSE;

    GetBlockName(options[i].name, sizeof(name), name);
    for (PetscInt k = 0; k < n_blocks && !known; k++) PetscCall(PetscStrcmp(blocks[k], name, &known));
    if (!name[0] || known) continue;
    PetscCall(CheckBlock(body, &options[i], name, &is_block));
    if (is_block) PetscCall(PetscStrallocpy(name, &blocks[n_blocks++]));
  }
  qsort(blocks, (size_t)n_blocks, sizeof(*blocks), CompareNames);
  for (PetscInt k = 0; k < n_blocks; k++) PetscCall(ReadBlock(body, blocks[k], n, options));
  for (PetscInt k = 0; k < n_blocks; k++) PetscCall(PetscFree(blocks[k]));
  PetscCall(PetscFree(blocks));
  PetscCall(PetscFree(options));
  PetscCall(PetscFree(text));
  PetscFunctionReturn(PETSC_SUCCESS);
}
