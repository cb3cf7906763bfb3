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
  CARRY_FRICTION_LOSS,
  N_CARRIED
} Carried;

struct _n_ContactFields {
  Contact   contact;  /* borrowed */
  Vec      *rows;     /* per body: one number for each row of it */
  Vec      *nodes;    /* per body: N_CARRIED vectors of its displacements' layout */
  PetscReal smallest; /* smaller areas are round-off [m^2] */
  PetscInt  layouts;  /* how often pairs had come or gone when room was made for the rows */
};

static PetscErrorCode MakeRoom(ContactFields f)
{
  Contact   contact = f->contact;
  PetscReal largest = 0;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(VecDestroy(&f->rows[b]));
    PetscCall(VecCreateMPI(PetscObjectComm((PetscObject)contact), contact->body_rows[b].n, PETSC_DETERMINE, &f->rows[b]));
  }
  for (PetscInt i = 0; i < contact->rows.n; i++)
    largest = PetscMax(largest, contact->rows.area[i] * contact->resultants.cross_section[contact->rows.pair[i]]);
  PetscCall(ContactReduce(contact, 1, MPIU_REAL, MPIU_MAX, &largest));
  f->smallest = NO_AREA * largest;
  f->layouts  = contact->neighbours.layouts;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is needed to compute nodal fields of a contact that has been set up, and outlives them. Collective. */
PetscErrorCode ContactFieldsCreate(Contact contact, ContactFields *fields)
{
  ContactFields f;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(fields, 2);
  PetscCheck(contact->setup, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_WRONGSTATE, "Call ContactSetUp() first");
  PetscCall(PetscNew(&f));
  *fields    = f;
  f->contact = contact;
  PetscCall(PetscCalloc2(contact->n_bodies, &f->rows, N_CARRIED * contact->n_bodies, &f->nodes));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    Vec positions;

    PetscCall(BodyGetReferencePositions(contact->bodies[b], &positions));
    for (PetscInt k = 0; k < N_CARRIED; k++) PetscCall(VecDuplicate(positions, &f->nodes[N_CARRIED * b + k]));
  }
  PetscCall(MakeRoom(f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
static PetscErrorCode Carry(ContactFields fields, PetscInt b, Carried kind)
{
  Contact      contact = fields->contact;
  PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(fields->rows[b], &values));
  for (PetscInt j = 0; j < contact->body_rows[b].n; j++) {
    const PetscInt     i    = contact->body_rows[b].rows[j];
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
  PetscCall(VecRestoreArrayWrite(fields->rows[b], &values));
  PetscCall(MatMultTranspose(contact->interfaces[b], fields->rows[b], fields->nodes[N_CARRIED * b + kind]));
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
PetscErrorCode ContactFieldsCompute(ContactFields fields, PetscInt body, PetscReal values[])
{
  Contact            contact = fields->contact;
  const PetscScalar *carried[N_CARRIED];
  Vec               *nodes = fields->nodes + N_CARRIED * body;
  PetscInt           dim, n;
  Carried            n_carried;

  PetscFunctionBegin;
  PetscAssertPointer(fields, 1);
  PetscCheck(body >= 0 && body < contact->n_bodies, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "There is no body %" PetscInt_FMT "; there are %" PetscInt_FMT, body, contact->n_bodies);
  if (fields->layouts != contact->neighbours.layouts) PetscCall(MakeRoom(fields));
  PetscCall(BodyGetDimension(contact->bodies[body], &dim));
  PetscCall(VecGetLocalSize(nodes[0], &n));
  PetscCall(ContactRefreshGaps(contact));
  n_carried = contact->friction.slip ? N_CARRIED : CARRY_SLIDING_AREA;
  for (Carried k = 0; k < n_carried; k++) {
    PetscCall(Carry(fields, body, k));
    PetscCall(VecGetArrayRead(nodes[k], &carried[k]));
  }
  for (PetscInt dof = 0; dof < n; dof += dim, values += CONTACT_FIELDS_SIZE) {
    const PetscScalar *area = carried[CARRY_AREA] + dof;

    for (PetscInt d = 0; d < 3; d++) values[CONTACT_FIELDS_FORCE + d] = d < dim ? PetscRealPart(carried[CARRY_FORCE][dof + d]) : 0;
    values[CONTACT_FIELDS_PRESSURE] = Ratio(dim, carried[CARRY_FORCE] + dof, area, fields->smallest, 0);
    values[CONTACT_FIELDS_GAP]      = Ratio(dim, carried[CARRY_GAP] + dof, carried[CARRY_GAP_AREA] + dof, fields->smallest, NAN);
    values[CONTACT_FIELDS_ACTIVE] = PetscAbsReal(Ratio(dim, carried[CARRY_ACTIVE_AREA] + dof, area, fields->smallest, 0)) > NOT_ACTIVE ? 1
                                                                                                                                       : 0;
    for (PetscInt k = CONTACT_FIELDS_TRACTION; k < CONTACT_FIELDS_SIZE; k++) values[k] = 0;
    if (n_carried == N_CARRIED) FrictionOf(dim, dof, fields->smallest, carried, values);
  }
  for (Carried k = 0; k < n_carried; k++) PetscCall(VecRestoreArrayRead(nodes[k], &carried[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Frees what ContactFieldsCreate() made. Collective. */
PetscErrorCode ContactFieldsDestroy(ContactFields *fields)
{
  PetscFunctionBegin;
  if (!*fields) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < N_CARRIED * (*fields)->contact->n_bodies; k++) PetscCall(VecDestroy(&(*fields)->nodes[k]));
  for (PetscInt b = 0; b < (*fields)->contact->n_bodies; b++) PetscCall(VecDestroy(&(*fields)->rows[b]));
  PetscCall(PetscFree2((*fields)->rows, (*fields)->nodes));
  PetscCall(PetscFree(*fields));
  PetscFunctionReturn(PETSC_SUCCESS);
}
