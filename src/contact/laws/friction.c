/* Rows across the normals of contact nodes: what they are when rows are built again, by how much they slip in a step, and what friction
   takes of the energy there.

   A row across the normal has no gap: the numbers that others have for it say that it is far open, and what concerns it is its slip, the
   change of B u over the controller step with the rows as the step has them. Where both bodies move as one rigid body, a closed row has the
   same material points on both sides, and no slip. */
#include "pairlaws.h"
#include <sys/units.h>
#include <impakt/private/bodystep.h>

/* Round-off of normals that a velocity may have a part along */
#define ACROSS 1e-6

/* Bound of the force across the normal of a node that has slid at this speed: a force [N], and a part of the normal force */
void ContactGetFrictionLimit(Contact contact, const ContactPair *pair, PetscReal speed, PetscReal limit[2])
{
  PetscReal parameters[ROW_LAW_PARAMETERS];

  ContactGetLawParameters(contact, pair, parameters);
  (*RowLaws[pair->named]->bound)(parameters, speed, limit);
}

PetscErrorCode ContactDestroyFriction(Contact contact)
{
  ContactFriction *friction = &contact->friction;

  PetscFunctionBegin;
  PetscCall(PetscFree7(friction->slip, friction->drive, friction->step_loss, friction->loss, friction->distance, friction->speed,
                       friction->slides));
  PetscCall(PetscFree4(friction->pair_step, friction->pair_loss, friction->pair_work, friction->pair_driven));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for what is kept of the rows and pairs that there are now */
PetscErrorCode ContactSetUpFriction(Contact contact)
{
  ContactFriction *friction = &contact->friction;
  const PetscInt   n        = contact->rows.n;

  PetscFunctionBegin;
  if (!ContactAnyPairHas(contact, CONTACT_LAW_FRICTION) || (!contact->n_pairs && !contact->neighbours.come_and_go))
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactDestroyFriction(contact));
  PetscCall(PetscCalloc7(PetscMax(n, 1), &friction->slip, n, &friction->drive, n, &friction->step_loss, n, &friction->loss, n,
                         &friction->distance, n, &friction->speed, n, &friction->slides));
  PetscCall(PetscCalloc4(contact->n_pairs, &friction->pair_step, contact->n_pairs, &friction->pair_loss, contact->n_pairs,
                         &friction->pair_work, contact->n_pairs, &friction->pair_driven));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows across the normal have a partner where the row along the normal has, and no gap */
void ContactAlignRubbingRows(Contact contact)
{
  PetscInt first = 0;

  for (PetscInt i = 0; i < contact->rows.n; i++) {
    if (!ContactRowRubs(contact, i)) {
      first = i;
      continue;
    }
    contact->rows.opposite[i]    = contact->rows.opposite[first];
    contact->rows.area[i]        = contact->rows.area[first];
    contact->rows.initial_gap[i] = contact->start.gap[i] = contact->end.gap[i] = CONTACT_NO_GAP;
    contact->rows.gap_shift[i]                                                 = 0;
  }
}

/* Turns a vector by the turn that takes the unit vector a to b and leaves what is square to both */
static void TurnAlong(const PetscReal a[], const PetscReal b[], PetscReal v[])
{
  PetscReal axis[3], turned[3], cosine = 0, along = 0;

  for (PetscInt d = 0; d < 3; d++) {
    axis[d] = a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3];
    cosine += a[d] * b[d];
  }
  if (cosine < -0.5) return; /* a node does not turn over in a step */
  for (PetscInt d = 0; d < 3; d++) along += axis[d] * v[d];
  for (PetscInt d = 0; d < 3; d++)
    turned[d] = cosine * v[d] + axis[(d + 1) % 3] * v[(d + 2) % 3] - axis[(d + 2) % 3] * v[(d + 1) % 3] + along / (1 + cosine) * axis[d];
  for (PetscInt d = 0; d < 3; d++) v[d] = turned[d];
}

/* In space, after rows have got new directions: forces across the normals turn with these. The old directions have been put aside. In the
   plane the direction across the normal turns with the normal, and the force along it stays. */
void ContactCarryFriction(Contact contact)
{
  const PetscReal *old = contact->saved.state, *now = contact->rows.normal;

  for (PetscInt i = 0; i + 2 < contact->rows.n && contact->dim == 3; i++) {
    PetscReal *force = contact->start.force + i, v[3];

    if (!ContactRowRubs(contact, i + 1) || ContactRowRubs(contact, i)) continue; /* the first row of a node with friction */
    if (!(contact->rows.changed[i] || contact->rows.followed[i]) || !contact->rows.opposite[i]) continue;
    for (PetscInt d = 0; d < 3; d++) v[d] = force[1] * old[3 * (i + 1) + d] + force[2] * old[3 * (i + 2) + d];
    TurnAlong(old + 3 * i, now + 3 * i, v);
    for (PetscInt k = 1; k < 3; k++) {
      force[k] = 0;
      for (PetscInt d = 0; d < 3; d++) force[k] += v[d] * now[3 * (i + k) + d];
    }
  }
}

/* How fast the surface of an obstacle passes a node of `pair` that is at x, square to the normal of the node's row. The velocity has to lie
   in the surface where the node is. The row may be older than that: it keeps its normal until the surface has turned by
   -contact_angle_bound. So the velocity turns with the normals, and keeps its size. */
static PetscErrorCode GetDrive(Contact contact, const ContactPair *pair, PetscInt row, const PetscReal x[], PetscReal t,
                               PetscReal velocity[])
{
  const PetscReal *normal = contact->rows.normal + 3 * row;
  PetscReal        distance, surface[3], across = 0, size = 0, cosine = 0;

  PetscFunctionBegin;
  PetscCall(ObstacleGetVelocity(pair->obstacle, x, t, velocity, NULL));
  PetscCall(ObstacleGetGap(pair->obstacle, x, &distance, surface));
  for (PetscInt d = 0; d < 3; d++) {
    across += velocity[d] * surface[d];
    size += PetscSqr(velocity[d]);
    cosine += normal[d] * surface[d];
  }
  PetscCheck(!contact->start.active[row] || PetscAbsReal(across) <= ACROSS * PetscSqrtReal(size), PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "The velocity (%g, %g, %g)%s of the obstacle of %s at (%g, %g, %g)%s has a part across its surface; an obstacle moves "
             "along its surface alone",
             (double)velocity[0], (double)velocity[1], (double)velocity[2], UnitsOf((PetscObject)contact, UNIT_VELOCITY), pair->name,
             (double)x[0], (double)x[1], (double)x[2], UnitsOf((PetscObject)contact, UNIT_LENGTH));
  for (PetscInt d = 0; d < 3 && cosine < 0; d++) surface[d] = -surface[d]; /* rows have the normal of the body */
  TurnAlong(surface, normal, velocity);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At the start of a step: how far the surfaces of obstacles go along themselves in it, at the places of nodes with which rows are laid */
PetscErrorCode ContactDriveFriction(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs && contact->friction.slip; p++) {
    const ContactPair *pair  = &contact->pairs[p];
    PetscBool          moves = PETSC_FALSE;
    const SurfaceData *data;
    PetscReal          time;

    if (pair->obstacle) PetscCall(ObstacleGetVelocity(pair->obstacle, NULL, 0, NULL, &moves));
    if (!moves || pair->law != CONTACT_LAW_FRICTION) continue;
    PetscCall(BodyGetStartTime(contact->bodies[pair->body[0]], &time));
    PetscCall(SurfaceGetData(pair->surfaces[0], &data));
    for (PetscInt first = pair->begin; first < pair->end; first += pair->components) {
      const PetscReal *x = data->positions + 3 * ((first - pair->begin) / pair->components);
      PetscReal        velocity[3];

      if (!contact->rows.opposite[first]) continue;
      PetscCall(GetDrive(contact, pair, first, x, time + 0.5 * contact->step, velocity));
      for (PetscInt i = first; i < first + pair->components; i++) {
        contact->friction.drive[i] = 0;
        for (PetscInt d = 0; d < 3; d++) contact->friction.drive[i] += contact->step * velocity[d] * contact->rows.normal[3 * i + d];
      }
      contact->friction.drive[first] = 0;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Slips over the controller step, from the bodies' traces */
PetscErrorCode ContactComputeSlips(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscScalar       *start[2], *end[2];

    PetscCall(ContactGetPairTraces(contact, pair, 0, PETSC_FALSE, start));
    PetscCall(ContactGetPairTraces(contact, pair, 0, PETSC_TRUE, end));
    for (PetscInt k = pair->near_begin; k < pair->near_end; k++) {
      const PetscInt i = contact->rows.near[k], first = i - pair->shift[0], second = i - pair->shift[1];

      contact->friction.slip[i] = PetscRealPart((end[0][first] - start[0][first]) + (end[1][second] - start[1][second])) +
                                  contact->friction.drive[i];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What friction takes in the step with these forces at its start: of rows across normals, and of each pair on all ranks. Collective. */
PetscErrorCode ContactComputeFrictionLoss(Contact contact, const PetscReal start_force[])
{
  ContactFriction *friction = &contact->friction;

  PetscFunctionBegin;
  if (!friction->slip) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < contact->rows.n_acting; k++) friction->step_loss[contact->rows.acting[k]] = 0;
  PetscCall(PetscArrayzero(friction->pair_step, contact->n_pairs));
  PetscCall(PetscArrayzero(friction->pair_work, contact->n_pairs));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(ContactAddWork(contact, b, start_force, friction->step_loss, NULL));
  for (PetscInt k = 0; k < contact->rows.n_acting; k++) {
    const PetscInt  i    = contact->rows.acting[k];
    const PetscReal work = -0.5 * (start_force[i] + contact->end.force[i]) * friction->drive[i];

    if (!ContactHasForce(contact, i, start_force)) continue;
    /* what friction takes is the work of the surfaces on each other; the obstacle brings its part */
    friction->step_loss[i] += work;
    if (ContactRowRubs(contact, i))
      friction->step_loss[i] -= (*contact->ops->stored)(contact, i, CONTACT_NO_GAP) - contact->energy.last_stored[i];
    friction->pair_work[contact->rows.pair[i]] += work;
    friction->pair_step[contact->rows.pair[i]] += friction->step_loss[i];
  }
  PetscCall(ContactReduce(contact, contact->n_pairs, MPIU_REAL, MPIU_SUM, friction->pair_work));
  PetscCall(ContactReduce(contact, contact->n_pairs, MPIU_REAL, MPIU_SUM, friction->pair_step));
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (friction->pair_step[p] != 0)
      PetscCall(PetscInfo(contact, "friction of %s takes %g J in the step\n", contact->pairs[p].name, (double)friction->pair_step[p]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Books what friction has taken in the accepted step, and how far nodes have slid; the slips are those that the step has left */
PetscErrorCode ContactAcceptFriction(Contact contact)
{
  ContactFriction *friction = &contact->friction;
  PetscReal        least    = contact->counts.friction_least;

  PetscFunctionBegin;
  if (!friction->slip) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    friction->pair_loss[p] += friction->pair_step[p];
    friction->pair_driven[p] += friction->pair_work[p];
    if (pair->law != CONTACT_LAW_FRICTION) continue;
    for (PetscInt k = pair->near_begin; k < pair->near_end; k += pair->components) {
      const PetscInt first = contact->rows.near[k];
      PetscReal      way   = 0;

      for (PetscInt i = first + 1; i < first + pair->components; i++) {
        way += PetscSqr(friction->slip[i]);
        friction->loss[first] += friction->step_loss[i];
        least = PetscMin(least, -0.5 * (contact->start.force[i] + contact->end.force[i]) * friction->slip[i]);
      }
      way                    = contact->rows.opposite[first] ? PetscSqrtReal(way) : 0;
      friction->speed[first] = way / contact->step;
      if (contact->end.active[first]) friction->distance[first] += way;
    }
  }
  PetscCall(ContactReduce(contact, 1, MPIU_REAL, MPIU_MIN, &least));
  contact->counts.friction_least = least;
  PetscFunctionReturn(PETSC_SUCCESS);
}
