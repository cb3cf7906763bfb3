/* Gmsh's .msh files, versions 2.2 and 4.1, ASCII and binary. The whole file is in memory, and nothing is read beyond its end.
   PETSc's own reader trusts node numbers, counts and tags as they are in the file, and a damaged one can make it crash. */
#include "meshimpl.h"
#include <sys/stat.h>

/* A file as it is read */
typedef struct {
  MeshFile   *file;
  const char *begin, *at, *end;
  PetscBool   binary, swapped;
  int         version; /* 22 or 41 */
  int         word;    /* bytes of counts and of numbers of nodes and elements in binary files of version 4.1 */
  /* 4.1: geometrical entities, whose physical groups are those of their elements */
  PetscInt n_entities;
  PetscInt (*entities)[4]; /* dimension, number, first of their physical groups, how many; those are in `groups` */
  PetscInt *groups;
} Gmsh;

/* What can be told of a place in the file: its line, or its byte where it has no lines */
static const char *Where(const Gmsh *gmsh, char text[64])
{
  PetscInt line = 1;

  for (const char *c = gmsh->begin; c < gmsh->at; c++) line += *c == '\n';
  if (gmsh->binary) (void)snprintf(text, 64, "byte %ld", (long)(gmsh->at - gmsh->begin));
  else (void)snprintf(text, 64, "line %ld", (long)line);
  return text;
}

#define GmshCheck(gmsh, condition, ...)                                                         \
  do {                                                                                          \
    if (PetscUnlikely(!(condition))) {                                                          \
      char message_[512], where_[64];                                                           \
      PetscCall(PetscSNPrintf(message_, sizeof(message_), __VA_ARGS__));                        \
      SETERRQ(PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "%s (%s)", message_, Where(gmsh, where_)); \
    }                                                                                           \
  } while (0)

static void SkipSpace(Gmsh *gmsh)
{
  while (gmsh->at < gmsh->end && (*gmsh->at == ' ' || (*gmsh->at >= '\t' && *gmsh->at <= '\r'))) gmsh->at++;
}

/* Numbers in text; the text ends with a 0, so that none runs beyond its end */
static PetscErrorCode ReadText(Gmsh *gmsh, PetscInt n, PetscInt64 values[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) {
    char *after;

    SkipSpace(gmsh); /* to the place that messages tell */
    values[i] = strtoll(gmsh->at, &after, 10);
    GmshCheck(gmsh, after != gmsh->at, gmsh->at == gmsh->end ? "the file ends within its data: it is cut short" : "a whole number is expected");
    gmsh->at = after;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadBytes(Gmsh *gmsh, size_t size, PetscInt n, void *values)
{
  PetscFunctionBegin;
  GmshCheck(gmsh, (size_t)(gmsh->end - gmsh->at) / size >= (size_t)n, "the file ends within its data: it is cut short");
  PetscCall(PetscMemcpy(values, gmsh->at, size * (size_t)n));
  gmsh->at += size * (size_t)n;
  if (gmsh->swapped)
    for (PetscInt i = 0; i < n; i++)
      for (size_t b = 0; b < size / 2; b++) {
        char      *bytes = (char *)values + size * (size_t)i;
        const char byte  = bytes[b];

        bytes[b]            = bytes[size - 1 - b];
        bytes[size - 1 - b] = byte;
      }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the format calls int */
static PetscErrorCode ReadInts(Gmsh *gmsh, PetscInt n, PetscInt64 values[])
{
  PetscFunctionBegin;
  if (gmsh->binary) {
    for (PetscInt i = 0; i < n; i++) {
      int32_t value;

      PetscCall(ReadBytes(gmsh, sizeof(value), 1, &value));
      values[i] = value;
    }
  } else PetscCall(ReadText(gmsh, n, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the format of version 4.1 calls size_t */
static PetscErrorCode ReadWords(Gmsh *gmsh, PetscInt n, PetscInt64 values[])
{
  PetscFunctionBegin;
  if (gmsh->binary && gmsh->word == 8) PetscCall(ReadBytes(gmsh, 8, n, values));
  else PetscCall(ReadInts(gmsh, n, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadReals(Gmsh *gmsh, PetscInt n, double values[])
{
  PetscFunctionBegin;
  if (gmsh->binary) PetscCall(ReadBytes(gmsh, sizeof(double), n, values));
  else
    for (PetscInt i = 0; i < n; i++) {
      char *after;

      SkipSpace(gmsh);
      values[i] = strtod(gmsh->at, &after);
      GmshCheck(gmsh, after != gmsh->at, gmsh->at == gmsh->end ? "the file ends within its data: it is cut short" : "a number is expected");
      gmsh->at = after;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A count of things of some bytes at least, which the rest of the file must have room for */
static PetscErrorCode CheckCount(Gmsh *gmsh, const char what[], PetscInt64 count, PetscInt64 bytes, PetscInt *n)
{
  PetscFunctionBegin;
  GmshCheck(gmsh, count >= 0 && count <= (gmsh->end - gmsh->at) / bytes, "%" PetscInt64_FMT " %s cannot be in the rest of the file, which has %ld bytes: a wrong number, or the file is cut short", count, what, (long)(gmsh->end - gmsh->at));
  GmshCheck(gmsh, count < PETSC_INT_MAX / 8, "%" PetscInt64_FMT " %s are too many", count, what);
  *n = (PetscInt)count;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts are text in version 2.2, binary or not; the data begin after the end of their line */
static PetscErrorCode ReadCount(Gmsh *gmsh, const char what[], PetscInt64 bytes, PetscInt *n)
{
  PetscInt64 count;

  PetscFunctionBegin;
  PetscCall(ReadText(gmsh, 1, &count));
  while (gmsh->at < gmsh->end && *gmsh->at != '\n') gmsh->at++;
  if (gmsh->at < gmsh->end) gmsh->at++;
  PetscCall(CheckCount(gmsh, what, count, bytes, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number of a node, an element or a group */
static PetscErrorCode CheckNumber(Gmsh *gmsh, PetscInt64 value, PetscInt *number)
{
  PetscFunctionBegin;
  *number = -1;
  GmshCheck(gmsh, value >= 0 && value < PETSC_INT_MAX, "%" PetscInt64_FMT " is no number of a node, an element or a group", value);
  *number = (PetscInt)value;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadFormat(Gmsh *gmsh)
{
  double     version;
  PetscInt64 type, size;
  char      *after;

  PetscFunctionBegin;
  version = strtod(gmsh->at, &after);
  GmshCheck(gmsh, after != gmsh->at, "the version of the format is expected");
  gmsh->at = after;
  PetscCall(ReadText(gmsh, 1, &type));
  PetscCall(ReadText(gmsh, 1, &size));
  gmsh->version = (int)(10 * version + 0.5);
  PetscCheck(gmsh->version == 22 || gmsh->version == 41, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "version %g of Gmsh's format is not supported: save it as 2.2 or 4.1 (gmsh -format msh41)", version);
  GmshCheck(gmsh, type == 0 || type == 1, "file type %" PetscInt64_FMT " is neither 0 (ASCII) nor 1 (binary)", type);
  GmshCheck(gmsh, size == 4 || size == 8, "data size %" PetscInt64_FMT " is neither 4 nor 8", size);
  GmshCheck(gmsh, gmsh->version != 22 || size == 8, "data size %" PetscInt64_FMT " is not 8", size);
  gmsh->word = (int)size;
  if (type == 1) {
    int32_t one;

    while (gmsh->at < gmsh->end && *gmsh->at != '\n') gmsh->at++;
    if (gmsh->at < gmsh->end) gmsh->at++;
    PetscCall(ReadBytes(gmsh, sizeof(one), 1, &one));
    GmshCheck(gmsh, one == 1 || one == 0x01000000, "the binary file does not begin with the number 1");
    gmsh->binary  = PETSC_TRUE;
    gmsh->swapped = (PetscBool)(one != 1);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Text in binary files as well */
static PetscErrorCode ReadNames(Gmsh *gmsh)
{
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(ReadCount(gmsh, "physical names", 6, &n));
  for (PetscInt i = 0; i < n; i++) {
    PetscInt64  values[2];
    PetscInt    number, group;
    const char *name;
    size_t      length;

    PetscCall(ReadText(gmsh, 2, values));
    GmshCheck(gmsh, values[0] >= 0 && values[0] <= 3, "a physical group has dimension %" PetscInt64_FMT, values[0]);
    PetscCall(CheckNumber(gmsh, values[1], &number));
    SkipSpace(gmsh);
    GmshCheck(gmsh, gmsh->at < gmsh->end && *gmsh->at == '"', "the name of a physical group in quotation marks is expected");
    for (name = ++gmsh->at; gmsh->at < gmsh->end && *gmsh->at != '"' && *gmsh->at != '\n'; gmsh->at++);
    GmshCheck(gmsh, gmsh->at < gmsh->end && *gmsh->at == '"', "the name of a physical group does not end");
    length = (size_t)(gmsh->at++ - name);
    GmshCheck(gmsh, length < MESH_NAME_LENGTH, "the name of a physical group is longer than %d characters", MESH_NAME_LENGTH - 1);
    PetscCall(MeshFileAddGroup(gmsh->file, MESH_UNDECIDED, (PetscInt)values[0], number, &group));
    PetscCall(PetscStrncpy(gmsh->file->groups[group].name, name, length + 1));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadEntities(Gmsh *gmsh)
{
  PetscInt64 counts[4];
  PetscInt   n_groups = 0, total = 0;

  PetscFunctionBegin;
  PetscCall(ReadWords(gmsh, 4, counts));
  for (PetscInt dim = 0; dim < 4; dim++) {
    PetscInt n;

    PetscCall(CheckCount(gmsh, "entities", counts[dim], 8, &n));
    total += n;
  }
  GmshCheck(gmsh, !gmsh->entities, "the section is there twice");
  PetscCall(PetscMalloc1(total, &gmsh->entities));
  for (PetscInt dim = 0; dim < 4; dim++)
    for (PetscInt i = 0; i < counts[dim]; i++) {
      PetscInt  *entity = gmsh->entities[gmsh->n_entities++], n;
      PetscInt64 value, number;
      double     box[6];

      PetscCall(ReadInts(gmsh, 1, &number));
      PetscCall(ReadReals(gmsh, dim ? 6 : 3, box));
      PetscCall(ReadWords(gmsh, 1, &value));
      PetscCall(CheckCount(gmsh, "physical groups", value, gmsh->binary ? 4 : 2, &n));
      entity[0] = dim;
      entity[1] = (PetscInt)number;
      entity[2] = n_groups;
      entity[3] = n;
      PetscCall(PetscRealloc(sizeof(*gmsh->groups) * (size_t)(n_groups + n), &gmsh->groups));
      for (PetscInt g = 0; g < n; g++) {
        PetscInt group;

        PetscCall(ReadInts(gmsh, 1, &value));
        PetscCall(CheckNumber(gmsh, value < 0 ? -value : value, &group)); /* negative: turned round */
        PetscCall(MeshFileAddGroup(gmsh->file, MESH_UNDECIDED, dim, group, &gmsh->groups[n_groups++]));
      }
      if (!dim) continue;
      PetscCall(ReadWords(gmsh, 1, &value));
      PetscCall(CheckCount(gmsh, "boundaries of an entity", value, gmsh->binary ? 4 : 2, &n));
      for (PetscInt b = 0; b < n; b++) PetscCall(ReadInts(gmsh, 1, &value));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AllocateNodes(Gmsh *gmsh, PetscInt n)
{
  PetscFunctionBegin;
  GmshCheck(gmsh, !gmsh->file->coordinates, "the section is there twice");
  PetscCall(PetscMalloc1(3 * n, &gmsh->file->coordinates));
  PetscCall(PetscMalloc1(n, &gmsh->file->node_numbers));
  gmsh->file->n_nodes = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadNodes22(Gmsh *gmsh)
{
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(ReadCount(gmsh, "nodes", gmsh->binary ? 28 : 8, &n));
  PetscCall(AllocateNodes(gmsh, n));
  for (PetscInt i = 0; i < n; i++) {
    PetscInt64 number;

    PetscCall(ReadInts(gmsh, 1, &number));
    PetscCall(CheckNumber(gmsh, number, &gmsh->file->node_numbers[i]));
    PetscCall(ReadReals(gmsh, 3, gmsh->file->coordinates + 3 * i));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In blocks: first their numbers, then their coordinates, with those on the entity where there are such */
static PetscErrorCode ReadNodes41(Gmsh *gmsh)
{
  PetscInt64 header[4], entity[3], count;
  PetscInt   n_blocks, n, done = 0;

  PetscFunctionBegin;
  PetscCall(ReadWords(gmsh, 4, header));
  PetscCall(CheckCount(gmsh, "blocks of nodes", header[0], 8, &n_blocks));
  PetscCall(CheckCount(gmsh, "nodes", header[1], gmsh->binary ? 28 : 8, &n));
  PetscCall(AllocateNodes(gmsh, n));
  for (PetscInt b = 0; b < n_blocks; b++) {
    PetscInt in_block;

    PetscCall(ReadInts(gmsh, 3, entity));
    PetscCall(ReadWords(gmsh, 1, &count));
    GmshCheck(gmsh, entity[0] >= 0 && entity[0] <= 3, "nodes of an entity of dimension %" PetscInt64_FMT, entity[0]);
    GmshCheck(gmsh, count >= 0 && count <= n - done, "a block has %" PetscInt64_FMT " nodes, where %" PetscInt_FMT " are left of the %" PetscInt_FMT " that were announced", count, n - done, n);
    in_block = (PetscInt)count;
    for (PetscInt i = 0; i < in_block; i++) {
      PetscInt64 number;

      PetscCall(ReadWords(gmsh, 1, &number));
      PetscCall(CheckNumber(gmsh, number, &gmsh->file->node_numbers[done + i]));
    }
    for (PetscInt i = 0; i < in_block; i++) {
      double parameters[3];

      PetscCall(ReadReals(gmsh, 3, gmsh->file->coordinates + 3 * (done + i)));
      if (entity[2]) PetscCall(ReadReals(gmsh, (PetscInt)entity[0], parameters));
    }
    done += in_block;
  }
  GmshCheck(gmsh, done == n, "%" PetscInt_FMT " nodes were announced, %" PetscInt_FMT " are there", n, done);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindShape(Gmsh *gmsh, PetscInt64 type, PetscInt64 element, DMPolytopeType *shape)
{
  PetscFunctionBegin;
  switch (type) {
  case 1:
    *shape = DM_POLYTOPE_SEGMENT;
    break;
  case 2:
    *shape = DM_POLYTOPE_TRIANGLE;
    break;
  case 3:
    *shape = DM_POLYTOPE_QUADRILATERAL;
    break;
  case 4:
    *shape = DM_POLYTOPE_TETRAHEDRON;
    break;
  case 5:
    *shape = DM_POLYTOPE_HEXAHEDRON;
    break;
  case 15:
    *shape = DM_POLYTOPE_POINT;
    break;
  case 6:
  case 7:
    SETERRQ(PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "element %" PetscInt64_FMT " is a %s (Gmsh's type %" PetscInt64_FMT "), which is not supported; supported: lines, triangles, quadrilaterals, tetrahedra, hexahedra, one shape in a body", element, type == 6 ? "prism" : "pyramid", type);
  default:
    GmshCheck(gmsh, type > 0 && type <= 140, "element %" PetscInt64_FMT " has type %" PetscInt64_FMT ", which Gmsh does not have", element, type);
    SETERRQ(PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "element %" PetscInt64_FMT " has Gmsh's type %" PetscInt64_FMT ", which is not supported; supported are first-order elements: lines, triangles, quadrilaterals, tetrahedra, hexahedra (gmsh -order 1)", element, type);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes an element with the numbers of its nodes in the file */
static PetscErrorCode AddElement(Gmsh *gmsh, PetscInt64 number, PetscInt corners, const PetscInt64 numbers[])
{
  PetscInt element, *nodes;

  PetscFunctionBegin;
  PetscCall(CheckNumber(gmsh, number, &element));
  PetscCall(MeshFileAddElement(gmsh->file, element, &nodes));
  for (PetscInt k = 0; k < corners; k++) {
    nodes[k] = -1;
    if (numbers[k] >= 0 && numbers[k] < PETSC_INT_MAX) PetscCall(MeshFileFindNode(gmsh->file, (PetscInt)numbers[k], &nodes[k]));
    GmshCheck(gmsh, nodes[k] >= 0, "element %" PetscInt_FMT " names node %" PetscInt64_FMT ", which is not in the file", element, numbers[k]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One after the other in ASCII files, in blocks with a common type and number of tags in binary ones. The first tag is the
   physical group; 0: none */
static PetscErrorCode ReadElements22(Gmsh *gmsh)
{
  PetscInt n, done = 0;

  PetscFunctionBegin;
  PetscCall(ReadCount(gmsh, "elements", gmsh->binary ? 8 : 6, &n));
  while (done < n) {
    PetscInt64     header[3], count = 1, number = 0, values[8], tag = 0;
    DMPolytopeType shape;

    if (gmsh->binary) {
      PetscCall(ReadInts(gmsh, 3, header));
      count = header[1];
    } else {
      PetscCall(ReadInts(gmsh, 1, &number));
      PetscCall(ReadInts(gmsh, 1, header));
      PetscCall(ReadInts(gmsh, 1, header + 2));
    }
    PetscCall(FindShape(gmsh, header[0], gmsh->binary ? done + 1 : number, &shape));
    GmshCheck(gmsh, count > 0 && count <= n - done, "a block has %" PetscInt64_FMT " elements, where %" PetscInt_FMT " are left of the %" PetscInt_FMT " that were announced", count, n - done, n);
    GmshCheck(gmsh, header[2] >= 0 && header[2] < 1000, "an element has %" PetscInt64_FMT " tags", header[2]);
    for (PetscInt i = 0; i < count; i++) {
      const PetscInt corners = DMPolytopeTypeGetNumVertices(shape);
      PetscInt       group   = 0;

      if (gmsh->binary) PetscCall(ReadInts(gmsh, 1, &number));
      for (PetscInt t = 0; t < header[2]; t++) {
        PetscInt64 value;

        PetscCall(ReadInts(gmsh, 1, &value));
        if (!t) tag = value < 0 ? -value : value;
      }
      PetscCall(ReadInts(gmsh, corners, values));
      if (tag) {
        PetscCall(CheckNumber(gmsh, tag, &group));
        PetscCall(MeshFileAddGroup(gmsh->file, MESH_UNDECIDED, DMPolytopeTypeGetDim(shape), group, &group));
      }
      PetscCall(MeshFileAddRun(gmsh->file, shape, tag ? 1 : 0, &group));
      PetscCall(AddElement(gmsh, number, corners, values));
    }
    done += (PetscInt)count;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In blocks of the elements of one entity */
static PetscErrorCode ReadElements41(Gmsh *gmsh)
{
  PetscInt64 header[4], entity[3], count, values[9];
  PetscInt   n_blocks, n, done = 0;

  PetscFunctionBegin;
  PetscCall(ReadWords(gmsh, 4, header));
  PetscCall(CheckCount(gmsh, "blocks of elements", header[0], 8, &n_blocks));
  PetscCall(CheckCount(gmsh, "elements", header[1], gmsh->binary ? 8 : 4, &n));
  for (PetscInt b = 0; b < n_blocks; b++) {
    DMPolytopeType shape;
    PetscInt       corners, e = 0;

    PetscCall(ReadInts(gmsh, 3, entity));
    PetscCall(ReadWords(gmsh, 1, &count));
    GmshCheck(gmsh, count >= 0 && count <= n - done, "a block has %" PetscInt64_FMT " elements, where %" PetscInt_FMT " are left of the %" PetscInt_FMT " that were announced", count, n - done, n);
    PetscCall(FindShape(gmsh, entity[2], done + 1, &shape));
    corners = DMPolytopeTypeGetNumVertices(shape);
    GmshCheck(gmsh, entity[0] == DMPolytopeTypeGetDim(shape), "elements of type %" PetscInt64_FMT " on an entity of dimension %" PetscInt64_FMT, entity[2], entity[0]);
    while (e < gmsh->n_entities && (gmsh->entities[e][0] != entity[0] || gmsh->entities[e][1] != entity[1])) e++;
    GmshCheck(gmsh, e < gmsh->n_entities || !gmsh->entities, "elements of an entity %" PetscInt64_FMT " of dimension %" PetscInt64_FMT ", which is not in $Entities", entity[1], entity[0]);
    if (gmsh->entities) PetscCall(MeshFileAddRun(gmsh->file, shape, gmsh->entities[e][3], gmsh->groups + gmsh->entities[e][2]));
    else PetscCall(MeshFileAddRun(gmsh->file, shape, 0, NULL));
    for (PetscInt i = 0; i < count; i++) {
      PetscCall(ReadWords(gmsh, corners + 1, values));
      PetscCall(AddElement(gmsh, values[0], corners, values + 1));
    }
    done += (PetscInt)count;
  }
  GmshCheck(gmsh, done == n, "%" PetscInt_FMT " elements were announced, %" PetscInt_FMT " are there", n, done);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The name of the section that begins here; empty: the file ends */
static PetscErrorCode BeginSection(Gmsh *gmsh, char name[64])
{
  PetscInt n = 0;

  PetscFunctionBegin;
  name[0] = 0;
  SkipSpace(gmsh);
  if (gmsh->at == gmsh->end) PetscFunctionReturn(PETSC_SUCCESS);
  GmshCheck(gmsh, *gmsh->at == '$', "a section, $..., is expected");
  for (gmsh->at++; gmsh->at < gmsh->end && n < 63 && *gmsh->at > ' '; gmsh->at++) name[n++] = *gmsh->at;
  name[n] = 0;
  while (gmsh->at < gmsh->end && *gmsh->at != '\n') gmsh->at++;
  if (gmsh->at < gmsh->end) gmsh->at++; /* binary data may begin with what looks like white space */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Its end; what is before it is of no interest where the section is not known */
static PetscErrorCode EndSection(Gmsh *gmsh, const char name[], PetscBool known)
{
  char   mark[72];
  size_t length;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(mark, sizeof(mark), "$End%s", name));
  PetscCall(PetscStrlen(mark, &length));
  if (known) SkipSpace(gmsh);
  else
    while ((size_t)(gmsh->end - gmsh->at) >= length && (*gmsh->at != '$' || strncmp(gmsh->at, mark, length))) gmsh->at++;
  GmshCheck(gmsh, (size_t)(gmsh->end - gmsh->at) >= length && !strncmp(gmsh->at, mark, length), "section $%s does not end with %s here: its count is wrong, or the file is cut short", name, mark);
  gmsh->at += length;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadSection(Gmsh *gmsh, const char name[], PetscBool *known)
{
  const char *const names[] = {"MeshFormat", "PhysicalNames", "Entities", "Nodes", "Elements"};
  PetscInt          section = 0;
  PetscBool         same    = PETSC_FALSE;

  PetscFunctionBegin;
  for (; section < 5; section++) {
    PetscCall(PetscStrcmp(name, names[section], &same));
    if (same) break;
  }
  *known = (PetscBool)(section < 5);
  GmshCheck(gmsh, !*known || !section == !gmsh->version, section ? "the file does not begin with $MeshFormat" : "$MeshFormat is there twice");
  switch (section) {
  case 0:
    PetscCall(ReadFormat(gmsh));
    break;
  case 1:
    PetscCall(ReadNames(gmsh));
    break;
  case 2:
    if (gmsh->version == 41) PetscCall(ReadEntities(gmsh));
    else *known = PETSC_FALSE;
    break;
  case 3:
    if (gmsh->version == 41) PetscCall(ReadNodes41(gmsh));
    else PetscCall(ReadNodes22(gmsh));
    PetscCall(MeshFileNumberNodes(gmsh->file));
    break;
  case 4:
    GmshCheck(gmsh, gmsh->file->coordinates, "$Elements comes before $Nodes");
    GmshCheck(gmsh, !gmsh->file->n_elements, "$Elements is there twice");
    if (gmsh->version == 41) PetscCall(ReadElements41(gmsh));
    else PetscCall(ReadElements22(gmsh));
    break;
  default:
    break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadSections(Gmsh *gmsh)
{
  PetscFunctionBegin;
  while (PETSC_TRUE) {
    char      name[64];
    PetscBool known;

    PetscCall(BeginSection(gmsh, name));
    if (!name[0]) break;
    PetscCall(ReadSection(gmsh, name, &known));
    PetscCall(EndSection(gmsh, name, known));
  }
  PetscCheck(gmsh->version, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "the file is empty");
  PetscCheck(gmsh->file->coordinates, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "it has no section $Nodes: is it cut short?");
  PetscCheck(gmsh->file->n_elements, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "it has no elements in a section $Elements: is it cut short?");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* On the first rank */
PetscErrorCode MeshReadGmsh(MeshFile *file)
{
  Gmsh           gmsh = {.file = file};
  struct stat    about;
  FILE          *stream;
  size_t         n;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCheck(!stat(file->path, &about), PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "it cannot be read");
  stream = fopen(file->path, "rb");
  PetscCheck(stream, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "it cannot be opened");
  error = PetscMalloc1((size_t)about.st_size + 1, &file->text);
  n     = error ? 0 : fread(file->text, 1, (size_t)about.st_size, stream);
  (void)fclose(stream);
  PetscCall(error);
  PetscCheck(n == (size_t)about.st_size, PETSC_COMM_SELF, PETSC_ERR_FILE_READ, "it cannot be read to its end");
  file->text[n] = 0;
  gmsh.begin = gmsh.at = file->text;
  gmsh.end             = file->text + n;
  error                = ReadSections(&gmsh);
  PetscCall(PetscFree(gmsh.entities));
  PetscCall(PetscFree(gmsh.groups));
  PetscCall(PetscFree(file->text));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}
