/* What contact does at each node: force, pressure, gap, whether it touches; traction, slip and loss of friction. */
#include <contact/parts.h>
#include <math.h>

/* Areas that rows bring to a node count as round-off if they are smaller, in parts of the largest area of a row */
#define NO_AREA 1e-9
/* A node touches if a larger part of the area that rows bring to it belongs to active rows; the least possible part is a mortar weight */
#define NOT_ACTIVE 1e-9

/* What the transposes of the rows carry to the nodes. Rows are weighed by areas, so that both sides of a pair have the same pressures. */
typedef enum {
  CARRY_FORCE,
  CARRY_AREA,
  CARRY_ACTIVE_AREA,
  CARRY_GAP_AREA, /* area of rows that have a partner opposite, and so a gap */
  CARRY_GAP,
  CARRY_SLIDING_AREA,
  CARRY_SLIP_DISTANCE,
  CARRY_FRICTION_LOSS
} Carried;

/* What row i carries of one kind. `along` is the component of the node's normal along the row: 1 but for tied nodes, which have a row for
   each axis, so that the areas they carry point along the normal as those of other nodes do. */
static PetscReal RowValue(Contact contact, PetscInt i, PetscReal along, Carried kind)
{
  const PetscReal area = contact->rows.area[i] * contact->resultants.cross_section[contact->rows.pair[i]];

  switch (kind) {
  case CARRY_FORCE:
    return contact->end.force[i];
  case CARRY_AREA:
    return along * area;
  case CARRY_ACTIVE_AREA:
    return contact->end.active[i] ? along * area : 0;
  case CARRY_GAP_AREA:
    return contact->rows.opposite[i] ? along * area : 0;
  case CARRY_SLIDING_AREA:
    return along != 0 && contact->end.active[i] && contact->friction.slides[i] ? along * area : 0;
  case CARRY_SLIP_DISTANCE:
    return along != 0 ? along * area * contact->friction.distance[i] : 0;
  case CARRY_FRICTION_LOSS:
    return along != 0 ? along * contact->friction.loss[i] : 0;
  default:
    return contact->rows.opposite[i] && !ContactRowRubs(contact, i) ? area * contact->end.gap[i] : 0;
  }
}

/* Carries values of one kind to the nodes of a body as the forces of its rows act on them */
static PetscErrorCode Carry(Contact contact, PetscInt b, Carried kind)
{
  const ContactBodyRows *of = &contact->body_rows[b];
  PetscScalar           *values;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(of->of_rows, &values));
  for (PetscInt j = 0; j < of->n; j++) {
    const PetscInt     i    = of->rows[j];
    const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];
    const PetscInt     node = (i - pair->begin) / pair->components, k = (i - pair->begin) % pair->components;
    PetscReal          along = k == 0;

    if (ContactPairTies(pair)) {
      TransferRows rows;

      PetscCall(TransferGetRows(pair->transfer, &rows));
      along = rows.normals[contact->dim * node + k];
    }
    values[j] = RowValue(contact, i, along, kind);
  }
  PetscCall(VecRestoreArrayWrite(of->of_rows, &values));
  PetscCall(MatMultTranspose(contact->interfaces[b], of->of_rows, of->of_nodes[kind]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* a.b / b.b; `none` if b is shorter than `smallest`, which means round-off */
static PetscReal Ratio(PetscInt dim, const PetscScalar a[], const PetscScalar b[], PetscReal smallest, PetscReal none)
{
  PetscReal product = 0, square = 0;

  for (PetscInt d = 0; d < dim; d++) {
    product += PetscRealPart(a[d]) * PetscRealPart(b[d]);
    square += PetscSqr(PetscRealPart(b[d]));
  }
  return square > PetscSqr(smallest) ? product / square : none;
}

/* What friction does at a node: of its force the part along the surface, across what areas point along */
static void FrictionOf(PetscInt dim, PetscInt dof, PetscReal smallest, const PetscScalar *const carried[], PetscReal values[])
{
  const PetscScalar *area = carried[CARRY_AREA] + dof, *force = carried[CARRY_FORCE] + dof;
  PetscReal          size = 0;

  for (PetscInt d = 0; d < dim; d++) size += PetscSqr(PetscRealPart(area[d]));
  size = PetscSqrtReal(size);
  if (size <= smallest) return;
  for (PetscInt d = 0; d < dim; d++)
    values[CONTACT_FIELDS_TRACTION + d] = (PetscRealPart(force[d]) - values[CONTACT_FIELDS_PRESSURE] * PetscRealPart(area[d])) / size;
  values[CONTACT_FIELDS_SLIDING] = PetscAbsReal(Ratio(dim, carried[CARRY_SLIDING_AREA] + dof, area, smallest, 0)) > NOT_ACTIVE ? 1 : 0;
  values[CONTACT_FIELDS_SLIP_DISTANCE] = Ratio(dim, carried[CARRY_SLIP_DISTANCE] + dof, area, smallest, 0);
  values[CONTACT_FIELDS_FRICTION_LOSS] = Ratio(dim, carried[CARRY_FRICTION_LOSS] + dof, area, smallest, 0);
}

/* Nodal fields of a body at the end of the last step: for each node of this rank the CONTACT_FIELDS_SIZE numbers that contact.h lists; the
   gap is not-a-number where there is none, the others are zeros where the node is on no contact surface. A Dirichlet node has the values
   of its row, a Neumann node means of the rows that act on it, weighed by the areas that they bring there: the pressure is
   sum_i P_ij f_i / sum_i P_ij A_i, so that it is uniform on both sides if it is on one. It touches if any of them does. A node on several
   contact surfaces has the mean of their values. Collective. */
PetscErrorCode ContactGetFields(Contact contact, PetscInt body, PetscReal values[])
{
  const PetscScalar *carried[CONTACT_CARRIED];
  ContactBodyRows   *of;
  PetscReal          smallest = 0; /* smaller areas are round-off [m^2] */
  PetscInt           dim, n;
  Carried            n_carried;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscCheck(contact->setup, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_WRONGSTATE, "Call ContactSetUp() first");
  PetscCheck(body >= 0 && body < contact->n_bodies, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "There is no body %" PetscInt_FMT "; there are %" PetscInt_FMT, body, contact->n_bodies);
  for (PetscInt i = 0; i < contact->rows.n; i++)
    smallest = PetscMax(smallest, NO_AREA * contact->rows.area[i] * contact->resultants.cross_section[contact->rows.pair[i]]);
  PetscCall(ContactReduce(contact, 1, MPIU_REAL, MPIU_MAX, &smallest));
  PetscCall(BodyGetDimension(contact->bodies[body], &dim));
  of = &contact->body_rows[body];
  if (!of->of_rows) {
    Vec positions;

    PetscCall(BodyGetReferencePositions(contact->bodies[body], &positions));
    PetscCall(VecDuplicateVecs(positions, CONTACT_CARRIED, &of->of_nodes));
    PetscCall(VecCreateMPI(PetscObjectComm((PetscObject)contact), of->n, PETSC_DETERMINE, &of->of_rows));
  }
  PetscCall(ContactRefreshGaps(contact));
  n_carried = contact->friction.slip ? CONTACT_CARRIED : CARRY_SLIDING_AREA;
  for (Carried k = 0; k < n_carried; k++) {
    PetscCall(Carry(contact, body, k));
    PetscCall(VecGetArrayRead(of->of_nodes[k], &carried[k]));
  }
  PetscCall(VecGetLocalSize(of->of_nodes[0], &n));
  for (PetscInt dof = 0; dof < n; dof += dim, values += CONTACT_FIELDS_SIZE) {
    const PetscScalar *area = carried[CARRY_AREA] + dof;

    for (PetscInt d = 0; d < 3; d++) values[CONTACT_FIELDS_FORCE + d] = d < dim ? PetscRealPart(carried[CARRY_FORCE][dof + d]) : 0;
    values[CONTACT_FIELDS_PRESSURE] = Ratio(dim, carried[CARRY_FORCE] + dof, area, smallest, 0);
    values[CONTACT_FIELDS_GAP]      = Ratio(dim, carried[CARRY_GAP] + dof, carried[CARRY_GAP_AREA] + dof, smallest, NAN);
    values[CONTACT_FIELDS_ACTIVE]   = PetscAbsReal(Ratio(dim, carried[CARRY_ACTIVE_AREA] + dof, area, smallest, 0)) > NOT_ACTIVE ? 1 : 0;
    for (PetscInt k = CONTACT_FIELDS_TRACTION; k < CONTACT_FIELDS_SIZE; k++) values[k] = 0;
    if (n_carried == CONTACT_CARRIED) FrictionOf(dim, dof, smallest, carried, values);
  }
  for (Carried k = 0; k < n_carried; k++) PetscCall(VecRestoreArrayRead(of->of_nodes[k], &carried[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
