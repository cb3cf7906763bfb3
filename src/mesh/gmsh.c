/* Reader of Gmsh's .msh files, versions 2.2 and 4.1, ASCII and binary. The whole file is in memory, and nothing is read beyond its end.
   PETSc's own reader trusts the node numbers, counts and tags of a file, and a damaged file can make it crash. */
#include "gmshimpl.h"
#include <sys/stat.h>

static PetscErrorCode ReadFormat(Gmsh *gmsh)
{
  double     version;
  PetscInt64 type, size;
  char      *after;

  PetscFunctionBegin;
  version = strtod(gmsh->at, &after);
  GmshCheck(gmsh, after != gmsh->at, "the version of the format is expected");
  gmsh->at = after;
  PetscCall(GmshReadText(gmsh, 1, &type));
  PetscCall(GmshReadText(gmsh, 1, &size));
  gmsh->version = version > 0 && version < 100 ? (int)(10 * version + 0.5) : 0;
  PetscCheck(gmsh->version == 22 || gmsh->version == 41, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "version %g of Gmsh's format is not supported: save it as 2.2 or 4.1 (gmsh -format msh41)", version);
  GmshCheck(gmsh, type == 0 || type == 1, "file type %" PetscInt64_FMT " is neither 0 (ASCII) nor 1 (binary)", type);
  GmshCheck(gmsh, size == 4 || size == 8, "data size %" PetscInt64_FMT " is neither 4 nor 8", size);
  GmshCheck(gmsh, gmsh->version != 22 || size == 8, "data size %" PetscInt64_FMT " is not 8", size);
  gmsh->word = (int)size;
  if (type == 1) {
    int32_t one;

    while (gmsh->at < gmsh->end && *gmsh->at != '\n') gmsh->at++;
    if (gmsh->at < gmsh->end) gmsh->at++;
    PetscCall(GmshReadBytes(gmsh, sizeof(one), 1, &one));
    GmshCheck(gmsh, one == 1 || one == 0x01000000, "the binary file does not begin with the number 1");
    gmsh->binary  = PETSC_TRUE;
    gmsh->swapped = (PetscBool)(one != 1);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads the names of physical groups, which are text in binary files too */
static PetscErrorCode ReadNames(Gmsh *gmsh)
{
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(GmshReadCount(gmsh, "physical names", 6, &n));
  for (PetscInt i = 0; i < n; i++) {
    PetscInt64  values[2];
    PetscInt    number, group;
    const char *name;
    size_t      length;

    PetscCall(GmshReadText(gmsh, 2, values));
    GmshCheck(gmsh, values[0] >= 0 && values[0] <= 3, "a physical group has dimension %" PetscInt64_FMT, values[0]);
    PetscCall(GmshCheckNumber(gmsh, values[1], &number));
    GmshSkipSpace(gmsh);
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
  PetscCall(GmshReadWords(gmsh, 4, counts));
  for (PetscInt dim = 0; dim < 4; dim++) {
    PetscInt n;

    PetscCall(GmshCheckCount(gmsh, "entities", counts[dim], 8, &n));
    total += n;
  }
  GmshCheck(gmsh, !gmsh->entities, "the section is there twice");
  PetscCall(PetscMalloc1(total, &gmsh->entities));
  for (PetscInt dim = 0; dim < 4; dim++)
    for (PetscInt i = 0; i < counts[dim]; i++) {
      PetscInt  *entity = gmsh->entities[gmsh->n_entities++], n;
      PetscInt64 value, number;
      double     box[6];

      PetscCall(GmshReadInts(gmsh, 1, &number));
      PetscCall(GmshReadReals(gmsh, dim ? 6 : 3, box));
      PetscCall(GmshReadWords(gmsh, 1, &value));
      PetscCall(GmshCheckCount(gmsh, "physical groups", value, gmsh->binary ? 4 : 2, &n));
      entity[0] = dim;
      entity[1] = (PetscInt)number;
      entity[2] = n_groups;
      entity[3] = n;
      PetscCall(PetscRealloc(sizeof(*gmsh->groups) * (size_t)(n_groups + n), &gmsh->groups));
      for (PetscInt g = 0; g < n; g++) {
        PetscInt group;

        PetscCall(GmshReadInts(gmsh, 1, &value));
        PetscCall(GmshCheckNumber(gmsh, value < 0 ? -value : value, &group)); /* a negative number means a reversed orientation */
        PetscCall(MeshFileAddGroup(gmsh->file, MESH_UNDECIDED, dim, group, &gmsh->groups[n_groups++]));
      }
      if (!dim) continue;
      PetscCall(GmshReadWords(gmsh, 1, &value));
      PetscCall(GmshCheckCount(gmsh, "boundaries of an entity", value, gmsh->binary ? 4 : 2, &n));
      for (PetscInt b = 0; b < n; b++) PetscCall(GmshReadInts(gmsh, 1, &value));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The name of the section that begins here; empty at the end of the file */
static PetscErrorCode BeginSection(Gmsh *gmsh, char name[64])
{
  PetscInt n = 0;

  PetscFunctionBegin;
  name[0] = 0;
  GmshSkipSpace(gmsh);
  if (gmsh->at == gmsh->end) PetscFunctionReturn(PETSC_SUCCESS);
  GmshCheck(gmsh, *gmsh->at == '$', "a section, $..., is expected");
  for (gmsh->at++; gmsh->at < gmsh->end && n < 63 && *gmsh->at > ' '; gmsh->at++) name[n++] = *gmsh->at;
  name[n] = 0;
  while (gmsh->at < gmsh->end && *gmsh->at != '\n') gmsh->at++;
  if (gmsh->at < gmsh->end) gmsh->at++; /* binary data may begin with what looks like white space */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the end of a section. If the section is not a known one, what it contains is skipped. */
static PetscErrorCode EndSection(Gmsh *gmsh, const char name[], PetscBool known)
{
  char   mark[72];
  size_t length;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(mark, sizeof(mark), "$End%s", name));
  PetscCall(PetscStrlen(mark, &length));
  if (known) GmshSkipSpace(gmsh);
  else
    while ((size_t)(gmsh->end - gmsh->at) >= length && (*gmsh->at != '$' || strncmp(gmsh->at, mark, length) != 0)) gmsh->at++;
  GmshCheck(gmsh, (size_t)(gmsh->end - gmsh->at) >= length && !strncmp(gmsh->at, mark, length),
            "section $%s does not end with %s here: its count is wrong, or the file is cut short", name, mark);
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
  GmshCheck(gmsh, !*known || !section == !gmsh->version,
            section ? "the file does not begin with $MeshFormat" : "$MeshFormat is there twice");
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
    if (gmsh->version == 41) PetscCall(GmshReadNodes41(gmsh));
    else PetscCall(GmshReadNodes22(gmsh));
    PetscCall(MeshFileNumberNodes(gmsh->file));
    break;
  case 4:
    GmshCheck(gmsh, gmsh->file->coordinates, "$Elements comes before $Nodes");
    GmshCheck(gmsh, !gmsh->file->n_elements, "$Elements is there twice");
    if (gmsh->version == 41) PetscCall(GmshReadElements41(gmsh));
    else PetscCall(GmshReadElements22(gmsh));
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
