/* Discs and balls from options: an O-grid, graded toward a pole by a conformal map, or a part of it. PETSc needs a generator for these. */
#include "ballimpl.h"

static PetscErrorCode ReadPart(MPI_Comm comm, const char prefix[], Ball *ball)
{
  const char *const parts[] = {"full", "half", "quarter"};
  char              part[64];
  PetscBool         set, same = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetString(NULL, prefix, "-ball_part", part, sizeof(part), &set));
  if (!set) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < 3 && !same; p++) {
    PetscCall(PetscStrcasecmp(part, parts[p], &same));
    if (same) ball->n_cuts = p;
  }
  PetscCheck(same, comm, PETSC_ERR_USER_INPUT, "-%sball_part %s: expected full, half (x >= centre) or quarter (also y >= centre)", prefix,
             part);
  PetscCheck(ball->n_cuts < ball->dim, comm, PETSC_ERR_USER_INPUT,
             "-%sball_part %s: a disc can be full or half; quarters are for -%sdm_plex_dim 3", prefix, part, prefix);
  PetscCheck(!ball->n_cuts || ball->divisions % 2 == 0, comm, PETSC_ERR_USER_INPUT,
             "-%sball_divisions %" PetscInt_FMT ": must be even for -%sball_part %s, which cuts the central block in its middle", prefix,
             ball->divisions, prefix, part);
  PetscFunctionReturn(PETSC_SUCCESS);
}

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

static PetscErrorCode ReadNumber(MPI_Comm comm, const char prefix[], const char option[], const char meaning[], PetscReal *value)
{
  PetscReal values[4];
  PetscBool set;

  PetscFunctionBegin;
  PetscCall(MeshReadNumbers(comm, prefix, option, 1, meaning, values, &set));
  if (set) *value = values[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For composite elements the grid is twice as fine: every second node is a corner, others are mid-edge, on the true surface */
PetscErrorCode BallChooseOrder(const char prefix[], Ball *ball)
{
  PetscBool composite;

  PetscFunctionBegin;
  PetscCall(MeshWantsComposite(prefix, &composite));
  ball->step = composite && ball->simplex ? 2 : 1; /* other cells are refused when they are to be divided */
  ball->divisions *= ball->step;
  ball->layers *= ball->step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadBall(MPI_Comm comm, const char prefix[], Ball *ball)
{
  PetscReal centre[4];
  PetscBool set;

  PetscFunctionBegin;
  *ball = (Ball){.dim = 2, .divisions = 4, .radius = 1, .grading = 1, .keep_volume = PETSC_TRUE};
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-dm_plex_dim", &ball->dim, NULL));
  PetscCheck(ball->dim == 2 || ball->dim == 3, comm, PETSC_ERR_USER_INPUT,
             "-%sdm_plex_dim %" PetscInt_FMT ": -%sdm_plex_shape ball makes a disc (2) or a ball (3)", prefix, ball->dim, prefix);
  PetscCall(ReadNumber(comm, prefix, "-ball_radius", "a radius [m]", &ball->radius));
  PetscCheck(ball->radius > 0, comm, PETSC_ERR_USER_INPUT, "-%sball_radius %g: must be positive", prefix, (double)ball->radius);
  PetscCall(MeshReadNumbers(comm, prefix, "-ball_centre", ball->dim, "a point [m]", centre, &set));
  for (PetscInt d = 0; d < ball->dim && set; d++) ball->centre[d] = centre[d];
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-ball_divisions", &ball->divisions, NULL));
  PetscCheck(ball->divisions >= 1, comm, PETSC_ERR_USER_INPUT,
             "-%sball_divisions %" PetscInt_FMT ": the central block has at least 1 element along an edge", prefix, ball->divisions);
  ball->layers = (ball->divisions + 1) / 2; /* the central block is as wide as the radius, and the layers beside it as half the radius */
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-ball_layers", &ball->layers, NULL));
  PetscCheck(ball->layers >= 1, comm, PETSC_ERR_USER_INPUT,
             "-%sball_layers %" PetscInt_FMT ": there is at least 1 around the central block", prefix, ball->layers);
  PetscCall(ReadNumber(comm, prefix, "-ball_grading", "a ratio of element sizes", &ball->grading));
  PetscCheck(
      ball->grading >= 1, comm, PETSC_ERR_USER_INPUT,
      "-%sball_grading %g: the ratio of the largest to the smallest element size is 1 or more; -%sball_pole says where they are small",
      prefix, (double)ball->grading, prefix);
  PetscCall(ReadPart(comm, prefix, ball));
  PetscCall(ReadPole(comm, prefix, ball));
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-dm_plex_simplex", &ball->simplex, NULL));
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-ball_keep_volume", &ball->keep_volume, NULL));
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-axisymmetric", &ball->turned, NULL));
  ball->turned = (PetscBool)(ball->turned && ball->dim == 2 && ball->n_cuts == 1 && ball->centre[0] == 0);
  PetscCall(BallChooseOrder(prefix, ball));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Fill(void *ctx)
{
  PetscFunctionBegin;
  PetscCall(MeshFillBall((BallGrid *)ctx));
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
  error     = MeshOnRank(comm, file.rank, Fill, &grid, where);
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
