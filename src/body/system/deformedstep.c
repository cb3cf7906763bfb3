/* The stable step of a nonlinear explicit body as it is deformed: elements that are flattened have a shorter one. How thin the thinnest
   element is, is looked at every few steps. The step is found anew, as that of the undeformed body is, only where it may have fallen below
   the substep that the body makes; in between it is taken to go with the thickness. A body whose substep is no longer stable lets the
   controller step fail, which is then cut in halves: so the body makes more substeps by itself, and fewer again where elements recover. */
#include "corners.h"

/* Controller steps from one look to the next */
#define INTERVAL 4
/* By so much the stable step may fall, of an undeformed body, without anything being done: strains of waves */
#define UNDEFORMED 0.9
/* The step that goes with the thickness is trusted where it is longer than the body's by this factor, */
#define TRUSTED 1.25
/* and, after the step has been found, until the thinnest element is thinner by this part */
#define THINNER 0.95

/* Largest norm of the gradient of an element's reference coordinates by the position: 1 over the thickness of the thinnest element, but for
   a factor that depends on the shape [1/m]. Of a composite element it is the root of the mean square of its cells: its gradients are
   projections of theirs, whose squares are less than the mean on average. One thin cell does not make it as stiff as if all were so: taken
   for that, elements at the rim of a rod's foot hid for long how those at its axis were flattened, until these were unstable. */
SIMD_INLINE PetscReal FindThinness(PetscInt dim, const BodyMesh *mesh, const Corners *corners, const PetscScalar u[])
{
  const PetscInt of_element = mesh->cells_of_element;
  PetscReal      largest = 0, squares = 0, place[MOST_CORNERS][3] = {{0}};

  for (PetscInt e = 0; e < mesh->n_cells; e++) {
    PetscReal of_cell = 0;

    if (e % of_element == 0) squares = 0;
    CornersGetPlaces(dim, mesh->cell_nodes, mesh->cell_connectivity + e * mesh->cell_nodes, mesh->coordinates, u, place);
    for (PetscInt c = 0; c < corners->corners; c++) {
      PetscReal edge[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, cofactor[3][3], determinant, rows = 0, columns = 0;

      for (PetscInt i = 0; i < dim; i++)
        for (PetscInt d = 0; d < dim; d++) edge[i][d] = place[corners->ends[c][i]][d] - place[c][d];
      for (PetscInt i = 0; i < 3; i++)
        for (PetscInt j = 0; j < 3; j++)
          cofactor[i][j] = edge[(i + 1) % 3][(j + 1) % 3] * edge[(i + 2) % 3][(j + 2) % 3] -
                           edge[(i + 1) % 3][(j + 2) % 3] * edge[(i + 2) % 3][(j + 1) % 3];
      determinant = edge[0][0] * cofactor[0][0] + edge[0][1] * cofactor[0][1] + edge[0][2] * cofactor[0][2];
      /* the 2-norm of the inverse is at most the root of its 1-norm times its infinity-norm */
      for (PetscInt i = 0; i < dim; i++) {
        PetscReal row = 0, column = 0;

        for (PetscInt j = 0; j < dim; j++) {
          row += PetscAbsReal(cofactor[i][j]);
          column += PetscAbsReal(cofactor[j][i]);
        }
        rows    = PetscMax(rows, row);
        columns = PetscMax(columns, column);
      }
      of_cell = PetscMax(of_cell, rows * columns / PetscSqr(determinant));
    }
    squares += of_cell / (PetscReal)of_element;
    if (e % of_element == of_element - 1) largest = PetscMax(largest, PetscSqrtReal(squares));
  }
  return largest;
}

static PetscReal GetThinness(const BodyMesh *mesh, const Corners *corners, const PetscScalar u[])
{
  if (mesh->dim == 3) return FindThinness(3, mesh, corners, u);
  return mesh->dim == 2 ? FindThinness(2, mesh, corners, u) : FindThinness(1, mesh, corners, u);
}

/* Looks at the present state, which is that of an accepted step. Collective; of a local body the rank that has it looks alone. */
PetscErrorCode BodyUpdateStableStep(Body body)
{
  const Corners     *corners = BodyFindCorners(body);
  const PetscReal    whole   = body->time.whole_step / body->time.substeps;
  const PetscScalar *u;
  PetscReal          thinness[2];
  BodyTime          *time = &body->time;
  Vec                local;

  PetscFunctionBegin;
  if (!body->integrator->needs_stable_step || body->model.linear || !corners) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->local && !body->mesh.is_owner) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->state.step / time->substeps % INTERVAL) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetLocalRead(body, body->state.u, &local, &u));
  thinness[0] = GetThinness(&body->mesh, corners, u);
  thinness[1] = time->thinness > 0 ? 0 : GetThinness(&body->mesh, corners, NULL);
  if (body->rows.size > 1 && !body->local)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, thinness, 2, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)body)));
  if (!(time->thinness > 0)) {
    time->thinness     = thinness[1];
    time->stable_found = time->stable_step;
  }
  time->stable_now = time->stable_found * PetscMin(1, time->thinness / thinness[0]);
  if (time->stable_now < TRUSTED * whole && thinness[0] * THINNER > time->thinness) {
    PetscCall(BodyComputeStableStepAt(body, u, body->local, &time->stable_found));
    time->thinness   = thinness[0];
    time->stable_now = time->stable_found;
  }
  PetscCall(BodyRestoreLocalRead(body, body->state.u, &local, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lets the step fail if its substeps are longer than the stable step as it is */
PetscErrorCode BodyCheckStableStep(Body body)
{
  const BodyTime *time = &body->time;

  PetscFunctionBegin;
  if (body->local && !body->mesh.is_owner) PetscFunctionReturn(PETSC_SUCCESS); /* what a checkpoint has told it may be old */
  if (!(time->stable_now > 0) || time->stable_now > UNDEFORMED * time->stable_step || time->step <= time->stable_now)
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(StepFailureSet(&body->failure, STEP_DIVERGED_UNSTABLE, PETSC_ERR_NOT_CONVERGED,
                           "Body '%s': elements have been deformed so much that its stable step has fallen from %g to %g s at time %.9g s, "
                           "below its step of %g s; choose a smaller -time_step or -%sts_time_step, or more -controller_step_cuts",
                           body->hdr.name, (double)time->stable_step, (double)time->stable_now, (double)body->saved.time,
                           (double)time->step, ((PetscObject)body)->prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}
