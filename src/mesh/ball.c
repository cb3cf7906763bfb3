/* Discs and balls from options: an O-grid, graded toward a pole by a conformal map, or a part of it. PETSc needs a generator for these. */
#include "ballimpl.h"

static PetscErrorCode ReadPole(MPI_Comm comm, const char prefix[], Ball *ball)
{
  const PetscInt dim = ball->dim;
  PetscReal      pole[4], length = 0;
  PetscBool      set;

  PetscFunctionBegin;
  PetscCall(MeshReadNumbers(comm, prefix, "-ball_pole", dim, "a direction from the centre", pole, &set));
  if (!set)
    for (PetscInt d = 0; d < dim; d++) pole[d] = d == dim - 1 ? -1 : 0;
  for (PetscInt d = 0; d < dim; d++) length = PetscMax(length, PetscAbsReal(pole[d]));
  PetscCheck(length > 0, comm, PETSC_ERR_USER_INPUT, "-%sball_pole: all its components are zero, which is no direction", prefix);
  for (PetscInt d = 0; d < dim; d++) ball->pole[d] = pole[d] / length; /* so that squares neither overflow nor vanish */
  length = 0;
  for (PetscInt d = 0; d < dim; d++) length += PetscSqr(ball->pole[d]);
  for (PetscInt d = 0; d < dim; d++) ball->pole[d] /= PetscSqrtReal(length);
  for (PetscInt d = 0; d < ball->n_cuts; d++)
    PetscCheck(ball->pole[d] == 0, comm, PETSC_ERR_USER_INPUT,
               "-%sball_pole: its component along %c is %g; for -%sball_part %s it must be 0, so that the pole is in the cut plane", prefix,
               (char)('x' + d), (double)pole[d], prefix, ball->n_cuts == 1 ? "half" : "quarter");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A number that an option may give, with a value before */
static PetscErrorCode ReadNumber(MPI_Comm comm, const char prefix[], const char option[], const char meaning[], PetscReal *value)
{
  PetscReal values[4];
  PetscBool set;

  PetscFunctionBegin;
  PetscCall(MeshReadNumbers(comm, prefix, option, 1, meaning, values, &set));
  if (set) *value = values[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BallReadLength(MPI_Comm comm, const char prefix[], const char option[], PetscReal *value)
{
  PetscFunctionBegin;
  PetscCall(ReadNumber(comm, prefix, option, "a length [m]", value));
  PetscCheck(*value > 0, comm, PETSC_ERR_USER_INPUT, "-%s%s %g: must be positive", prefix, option + 1, (double)*value);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BallReadCount(MPI_Comm comm, const char prefix[], const char option[], PetscInt *value)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsGetInt(NULL, prefix, option, value, NULL));
  PetscCheck(*value >= 1, comm, PETSC_ERR_USER_INPUT, "-%s%s %" PetscInt_FMT ": there must be at least 1", prefix, option + 1, *value);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What balls and rods have in common. For composite elements the grid is twice as fine: every second node is a corner, others are mid-edge,
   on the true surface */
PetscErrorCode BallReadSection(MPI_Comm comm, const char prefix[], const BallOptions *options, Ball *ball)
{
  const char *const parts[]  = {"full", "half", "quarter"};
  char              part[64] = "full";
  PetscBool         composite, found;

  PetscFunctionBegin;
  PetscCall(BallReadLength(comm, prefix, options->radius, &ball->radius));
  PetscCall(BallReadCount(comm, prefix, options->divisions, &ball->divisions));
  ball->layers = (ball->divisions + 1) / 2; /* the central block is as wide as the radius, and the layers beside it as half the radius */
  PetscCall(BallReadCount(comm, prefix, options->layers, &ball->layers));
  PetscCall(PetscOptionsGetString(NULL, prefix, options->part, part, sizeof(part), NULL));
  PetscCall(PetscEListFind(3, parts, part, &ball->n_cuts, &found));
  PetscCheck(found, comm, PETSC_ERR_USER_INPUT, "-%s%s %s: expected full, half (x >= centre) or quarter (also y >= centre)", prefix,
             options->part + 1, part);
  PetscCheck(!ball->n_cuts || ball->divisions % 2 == 0, comm, PETSC_ERR_USER_INPUT,
             "-%s%s %" PetscInt_FMT ": must be even for -%s%s %s, which cuts the central block in its middle", prefix,
             options->divisions + 1, ball->divisions, prefix, options->part + 1, parts[ball->n_cuts]);
  PetscCall(PetscOptionsGetBool(NULL, prefix, options->keep_volume, &ball->keep_volume, NULL));
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-dm_plex_simplex", &ball->simplex, NULL));
  PetscCall(MeshWantsComposite(prefix, &composite));
  ball->step = composite && ball->simplex ? 2 : 1; /* other cells are refused when they are to be divided */
  ball->divisions *= ball->step;
  ball->layers *= ball->step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadBall(MPI_Comm comm, const char prefix[], Ball *ball)
{
  const BallOptions options = {"-ball_radius", "-ball_divisions", "-ball_layers", "-ball_part", "-ball_keep_volume"};
  PetscReal         centre[4];
  PetscBool         set;

  PetscFunctionBegin;
  *ball = (Ball){.dim = 2, .divisions = 4, .radius = 1, .grading = 1, .keep_volume = PETSC_TRUE};
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-dm_plex_dim", &ball->dim, NULL));
  PetscCheck(ball->dim == 2 || ball->dim == 3, comm, PETSC_ERR_USER_INPUT,
             "-%sdm_plex_dim %" PetscInt_FMT ": -%sdm_plex_shape ball makes a disc (2) or a ball (3)", prefix, ball->dim, prefix);
  PetscCall(BallReadSection(comm, prefix, &options, ball));
  PetscCheck(ball->n_cuts < ball->dim, comm, PETSC_ERR_USER_INPUT,
             "-%sball_part quarter: a disc can be full or half; quarters are for -%sdm_plex_dim 3", prefix, prefix);
  PetscCall(MeshReadNumbers(comm, prefix, "-ball_centre", ball->dim, "a point [m]", centre, &set));
  for (PetscInt d = 0; d < ball->dim && set; d++) ball->centre[d] = centre[d];
  PetscCall(ReadNumber(comm, prefix, "-ball_grading", "a ratio of element sizes", &ball->grading));
  PetscCheck(
      ball->grading >= 1, comm, PETSC_ERR_USER_INPUT,
      "-%sball_grading %g: the ratio of the largest to the smallest element size is 1 or more; -%sball_pole says where they are small",
      prefix, (double)ball->grading, prefix);
  PetscCall(ReadPole(comm, prefix, ball));
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-axisymmetric", &ball->turned, NULL));
  ball->turned = (PetscBool)(ball->turned && ball->dim == 2 && ball->n_cuts == 1 && ball->centre[0] == 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What lies whole on a rank, `PETSC_DECIDE`: on the first one; and how much of its volume is missing [parts of it] */
PetscErrorCode BallCreate(MPI_Comm comm, Ball *ball, const char where[], PetscMPIInt rank, DM *dm, MeshMiddles *middles, PetscReal *missing)
{
  MeshFile       file;
  BallGrid       grid = {.file = &file, .ball = ball};
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(MeshFileInitialize(&file, NULL));
  file.rank = PetscMax(rank, 0);
  error     = MeshOnRank(comm, file.rank, MeshFillBall, &grid, where);
  PetscCallMPI(MPI_Bcast(&grid.missing, 1, MPIU_REAL, file.rank, comm));
  *missing = grid.missing;
  if (!error) error = MeshBuild(comm, &file, where, dm, middles);
  PetscCall(PetscFree(grid.rim));
  PetscCall(MeshFileDestroy(&file));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MeshCreateBall(MPI_Comm comm, const char prefix[], const char name[], PetscMPIInt rank, DM *dm, MeshMiddles *middles)
{
  Ball      ball;
  PetscReal missing;
  char      where[256];

  PetscFunctionBegin;
  PetscCall(ReadBall(comm, prefix, &ball));
  PetscCall(PetscSNPrintf(where, sizeof(where), "Body '%s', -%sdm_plex_shape ball", name, prefix));
  PetscCall(BallCreate(comm, &ball, where, rank, dm, middles, &missing));
  if (missing > 0 && ball.keep_volume)
    PetscCall(
        PetscFPrintf(comm, stderr,
                     "impakt: warning: body '%s' has %.2g %% less volume than the ball of its radius: elements opposite to the pole are "
                     "too large to be moved outward; take more -%sball_divisions, or a weaker -%sball_grading\n",
                     name, (double)(100 * missing), prefix, prefix));
  else if (missing > 0)
    PetscCall(PetscPrintf(comm, "body '%s' has %.2g %% less volume than the ball of its radius (-%sball_keep_volume false)\n", name,
                          (double)(100 * missing), prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}
