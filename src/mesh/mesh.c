/* The mesh of a body from its options. */
#include "meshimpl.h"
#include <petsc/private/petscimpl.h>
#include <sys/names.h>
#include <sys/stat.h>
#if defined(PETSC_HAVE_PTSCOTCH)
#  include <ptscotch.h>
#endif

typedef PetscErrorCode (*Reader)(MeshFile *);

typedef struct {
  MeshFile *file;
  Reader    read;
} Reading;

/* The reader of a file, by the end of the file's name; NULL if that is not known */
static PetscErrorCode FindReader(const char path[], Reader *reader)
{
  const char *const extensions[] = {".msh", ".g", ".e", ".exo", ".ex2"};
  char             *dot;

  PetscFunctionBegin;
  *reader = NULL;
  PetscCall(PetscStrrchr((char *)path, '.', &dot)); /* what follows the dot; the whole path if it has none */
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(extensions); i++) {
    PetscBool same;

    PetscCall(PetscStrcasecmp(dot, extensions[i] + 1, &same));
    if (same && dot != path) *reader = i ? MeshReadExodus : MeshReadGmsh;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadFile(void *ctx)
{
  const Reading *reading = (Reading *)ctx;
  struct stat    about;

  PetscFunctionBegin;
  PetscCheck(!stat(reading->file->path, &about), PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "there is no such file");
  PetscCheck(S_ISREG(about.st_mode), PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "it is no file%s",
             S_ISDIR(about.st_mode) ? ", but a directory" : "");
  PetscCheck(reading->read, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "its format is not known from its name; known: .msh (Gmsh), .g, .e, .exo, .ex2 (Exodus II)");
  PetscCall((*reading->read)(reading->file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mesh of a file, all of it on the first rank, and where the nodes in the middle of its edges are */
PetscErrorCode MeshCreateFromFile(MPI_Comm comm, const char prefix[], const char name[], const char path[], DM *dm, MeshMiddles *middles)
{
  MeshFile       file;
  Reading        reading = {.file = &file};
  PetscInt       asked, dim;
  PetscBool      set;
  char           where[PETSC_MAX_PATH_LEN + 256];
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-dm_plex_dim", &asked, &set));
  PetscCall(MeshFileInitialize(&file, path));
  PetscCall(NamesRead(prefix, "-mesh_blocks", &file.n_wanted, &file.wanted, NULL));
  PetscCall(FindReader(path, &reading.read));
  PetscCall(PetscSNPrintf(where, sizeof(where), "Body '%s', mesh file '%s'", name, path));
  error = MeshOnRank(comm, file.rank, ReadFile, &reading, where);
  if (!error) error = MeshBuild(comm, &file, where, dm, middles);
  PetscCall(MeshFileDestroy(&file));
  PetscCall(error);
  PetscCall(DMGetDimension(*dm, &dim));
  PetscCheck(!set || dim == asked, comm, PETSC_ERR_USER_INPUT,
             "%s: its elements have dimension %" PetscInt_FMT "; -%sdm_plex_dim asks for %" PetscInt_FMT, where, dim, prefix, asked);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The prefix of the body for the mesh and for its partitioner. PETSc's partitioner options without prefix are for all other bodies. */
static PetscErrorCode SetPrefix(DM dm, const char prefix[])
{
  PetscBool of_body, of_all;

  PetscFunctionBegin;
  PetscCall(PetscOptionsHasName(NULL, prefix, "-petscpartitioner_type", &of_body));
  PetscCall(PetscOptionsHasName(NULL, NULL, "-petscpartitioner_type", &of_all));
  if (of_body || !of_all) PetscCall(DMPlexSetOptionsPrefix(dm, prefix));
  else PetscCall(DMSetOptionsPrefix(dm, prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mesh of a body from options, distributed over the ranks: a DMPLEX with faces and edges, on each rank its own part. Groups of a file
   become labels: their numbers in "Cell Sets", "Face Sets" and "Vertex Sets", their names as labels with the value 1; the sides of a box
   have labels xmin, xmax, ... which a rotation takes along. The dimension of space is that of the elements: coordinates beyond it must be
   zero in the file. Nodes of no element are left out. After an error the mesh is NULL, or to be destroyed. Collective */
PetscErrorCode MeshCreate(MPI_Comm comm, const char prefix[], const char name[], DM *dm)
{
  PetscFunctionBegin;
  PetscCall(MeshCreateOnRanks(comm, prefix, name, 0, NULL, dm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Opens a mesh from options, as far as it can be made before DMSetFromOptions(). rank: the one that is to have all of it, or none */
static PetscErrorCode Begin(MPI_Comm comm, const char prefix[], const char name[], const MeshRanks *ranks, PetscMPIInt rank, DM *dm,
                            MeshMiddles *middles, MeshStage *stage, PetscBool *there)
{
  char      path[PETSC_MAX_PATH_LEN];
  PetscBool from_file, blocks, ball = PETSC_FALSE, rod = PETSC_FALSE;

  PetscFunctionBegin;
  *stage = MESH_ON_ONE_RANK;
  PetscCall(PetscOptionsGetString(NULL, prefix, "-dm_plex_filename", path, sizeof(path), &from_file));
  PetscCall(PetscOptionsHasName(NULL, prefix, "-mesh_blocks", &blocks));
  PetscCheck(from_file || !blocks, comm, PETSC_ERR_USER_INPUT, "-%smesh_blocks needs a mesh file: give -%sdm_plex_filename", prefix,
             prefix);
  if (!from_file) PetscCall(MeshHasShape(prefix, "ball", &ball));
  if (!from_file) PetscCall(MeshHasShape(prefix, "rod", &rod));
  if (from_file) PetscCall(MeshCreateFromFile(comm, prefix, name, path, dm, middles));
  else if (rod) PetscCall(MeshCreateRod(comm, prefix, name, rank, dm, middles));
  else if (ball) PetscCall(MeshCreateBall(comm, prefix, name, rank, dm, middles));
  else PetscCall(MeshCreateBox(comm, prefix, name, ranks, dm, stage));
  *there = (PetscBool)(rank >= 0 && (rod || ball));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same, divided among `n` ranks of an ascending list, all with n = 0; others have nothing of it. Each of them makes its brick of a box.
   Other meshes are made on the first rank of the communicator, divided there into `n` parts, and sent; discs, balls and rods of one rank
   are made there. The parts are the same whichever ranks these are. Collective */
PetscErrorCode MeshCreateOnRanks(MPI_Comm comm, const char prefix[], const char name[], PetscMPIInt n, const PetscMPIInt list[], DM *dm)
{
  MeshRanks   ranks   = {n, list};
  MeshMiddles middles = {NULL, NULL};
  MeshStage   stage   = MESH_TO_BE_MADE;
  PetscMPIInt size, rank;
  PetscBool   file, composite, spread, there = PETSC_FALSE;

  PetscFunctionBegin;
  PetscAssertPointer(dm, 6);
  *dm = NULL;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  if (n) PetscCall(MeshRanksCheck(comm, prefix, size, &ranks));
  if (!n || n == size) ranks = (MeshRanks){size, NULL};
  rank = ranks.list && n == 1 ? list[0] : PETSC_DECIDE;
  PetscCall(PetscOptionsHasName(NULL, prefix, "-dm_plex_filename", &file));
  PetscCall(Begin(comm, prefix, name, &ranks, rank, dm, &middles, &stage, &there));
  PetscCall(SetPrefix(*dm, prefix));
  if (ranks.list) PetscCall(DMPlexDistributeSetDefault(*dm, PETSC_FALSE));
  else if (stage == MESH_ON_ONE_RANK) PetscCall(MeshSpreadContact(*dm, &ranks, prefix, name, (PetscBool)!file, &spread));
#if defined(PETSC_HAVE_PTSCOTCH)
  SCOTCH_randomReset(); /* what it draws goes on from one mesh to the next: a body's parts would hang on what was divided before it */
#endif
  if (!middles.section) PetscCall(DMSetFromOptions(*dm)); /* distributes it among all ranks */
  else if (!ranks.list) PetscCall(MeshDistributeWithMiddles(dm, prefix, &middles));
  if (there) PetscCall(MeshTellLabels(rank, *dm));
  else if (ranks.list && stage != MESH_DIVIDED) PetscCall(MeshDivideAmong(&ranks, prefix, name, stage, (PetscBool)!file, dm, &middles));
  PetscCall(PetscObjectSetName((PetscObject)*dm, name));
  if (!file) PetscCall(MeshMarkSides(*dm));
  PetscCall(MeshWantsComposite(prefix, &composite));
  if (composite || middles.section) PetscCall(MeshMakeComposite(dm, prefix, name, &middles));
  PetscCall(MeshMiddlesDestroy(&middles));
  PetscCall(MeshCheckContact(*dm, prefix));
  PetscCall(MeshPlace(*dm, prefix, name));
  PetscCall(DMViewFromOptions(*dm, NULL, "-dm_view"));
  PetscFunctionReturn(PETSC_SUCCESS);
}
