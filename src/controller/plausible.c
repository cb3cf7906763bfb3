/* Densities, Young's moduli, gravity and sizes that no body has in the units of -units: the message names the units that fit best. */
#include "plausible.h"
#include <impakt/private/bodymesh.h>
#include "controllerimpl.h"
#include <sys/units.h>

/* Bodies that a run tells of; its verdict has the number of all */
#define MOST_DOUBTS 3

/* In how many SI units a unit is */
typedef struct {
  const char *name;
  PetscReal   size;
} Unit;

typedef struct {
  UnitDimension dimension;
  const char   *option;
  PetscReal     least, most;   /* of what there is, in SI units */
  PetscReal     common;        /* what is common, in SI units: of several units that fit, the one that is nearest to it */
  PetscReal     mm_t_s;        /* the unit of mm-t-s */
  Unit          candidates[5]; /* up to one without a name */
} Quantity;

/* From foams to osmium, from gels to diamond, each with room above for anvils that are made stiff and heavy on purpose; from a hundredth
   of the gravity of the Earth to 500 times it; from grains to bridges. Numbers in wrong units are off by a thousand or more. */
static const Quantity density = {
    UNIT_DENSITY, "density", 1, 1e6, 3e3, 1e12, {{"kg/m^3", 1}, {"g/cm^3", 1e3}, {"kg/mm^3", 1e9}, {"t/mm^3", 1e12}}};
static const Quantity modulus = {
    UNIT_STRESS, "youngs_modulus", 1e3, 2e13, 1e10, 1e6, {{"Pa", 1}, {"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}}};
static const Quantity gravity = {UNIT_ACCELERATION, "gravity", 0.1, 5e3, 9.81, 1e-3, {{"m/s^2", 1}, {"mm/s^2", 1e-3}}};
static const Quantity extent  = {UNIT_LENGTH, NULL, 1e-7, 1e3, 1, 1e-3, {{"m", 1}, {"mm", 1e-3}, {"um", 1e-6}}};

static PetscReal Distance(PetscReal a, PetscReal b)
{
  return PetscAbsReal(PetscLogReal(a / b));
}

/* Adds a sentence on a value that is implausible */
static PetscErrorCode Doubt(const Quantity *quantity, Units units, const char prefix[], const char option[], PetscReal value,
                            char text[DOUBT_SIZE])
{
  const PetscReal in_si = value * (units == UNITS_MM_T_S ? quantity->mm_t_s : 1);
  const Unit     *best  = NULL;
  size_t          used;

  PetscFunctionBegin;
  if (units == UNITS_NONE || (in_si >= quantity->least && in_si <= quantity->most)) PetscFunctionReturn(PETSC_SUCCESS);
  for (const Unit *unit = quantity->candidates; unit->name; unit++) {
    if (value * unit->size < quantity->least || value * unit->size > quantity->most) continue;
    if (!best || Distance(value * unit->size, quantity->common) < Distance(value * best->size, quantity->common)) best = unit;
  }
  PetscCall(PetscStrlen(text, &used));
  PetscCall(PetscSNPrintf(text + used, DOUBT_SIZE - used, "%s-%s%s %g%s is implausible", used ? "; " : "", prefix, option, (double)value,
                          UnitsText(units, quantity->dimension)));
  PetscCall(PetscStrlen(text, &used));
  if (best) PetscCall(PetscSNPrintf(text + used, DOUBT_SIZE - used, " and would fit %s", best->name));
  else PetscCall(PetscSNPrintf(text + used, DOUBT_SIZE - used, " and fits no common unit"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DoubtMaterial(Material material, PetscBool rigid, Units units, char text[DOUBT_SIZE])
{
  const char *prefix;
  PetscReal   value;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetOptionsPrefix((PetscObject)material, &prefix));
  PetscCall(MaterialGetDensity(material, &value));
  PetscCall(Doubt(&density, units, prefix ? prefix : "", density.option, value, text));
  if (rigid) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MaterialGetYoungsModulus(material, &value));
  PetscCall(Doubt(&modulus, units, prefix ? prefix : "", modulus.option, value, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The option that a body's size comes from: one that has been read for its mesh. PetscOptionsHasName() would count as reading. */
static PetscErrorCode FindSizeOption(Body body, const char prefix[], const char *option[])
{
  static const char *const sizes[][2] = {
      {"ball_radius", "ball_radius"}, {"rod_length", "rod_length"}, {"scale", "scale"}, {"dm_plex_filename", "scale"}};
  char         name[128];
  PetscOptions options;
  PetscBool    used = PETSC_FALSE;

  PetscFunctionBegin;
  *option = "dm_plex_box_upper";
  PetscCall(PetscObjectGetOptions((PetscObject)body, &options));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(sizes) && !used; i++) {
    PetscCall(PetscSNPrintf(name, sizeof(name), "%s%s", prefix ? prefix : "", sizes[i][0]));
    PetscCall(PetscOptionsUsed(options, name, &used));
    if (used) *option = sizes[i][1];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which of a body's density, Young's modulus, gravity and size are implausible in the units of -units. `text`: option, value and the
   unit that it would fit; empty where all is plausible; `box`: see BodyGetAllBoxes() */
PetscErrorCode BodyDoubtUnits(Body body, const PetscReal box[6], char text[DOUBT_SIZE])
{
  const Material *of_blocks;
  const char     *prefix, *option;
  Material        material;
  PetscBool       rigid;
  PetscReal       size = 0, vector[3] = {0}, pull;
  PetscInt        n;
  Units           units;

  PetscFunctionBegin;
  text[0] = 0;
  PetscCall(UnitsGet((PetscObject)body, &units));
  PetscCall(PetscObjectGetOptionsPrefix((PetscObject)body, &prefix));
  PetscCall(BodyIsRigid(body, &rigid));
  PetscCall(BodyGetBlocks(body, &n, NULL, &of_blocks));
  PetscCall(BodyGetMaterial(body, &material));
  if (!n) PetscCall(DoubtMaterial(material, rigid, units, text));
  for (PetscInt k = 0; k < n; k++) PetscCall(DoubtMaterial(of_blocks[k], rigid, units, text));
  PetscCall(BodyGetGravity(body, vector));
  pull = PetscSqrtReal(PetscSqr(vector[0]) + PetscSqr(vector[1]) + PetscSqr(vector[2]));
  if (pull > 0) PetscCall(Doubt(&gravity, units, prefix ? prefix : "", gravity.option, pull, text));
  for (PetscInt d = 0; d < 3; d++) size = PetscMax(size, -box[3 + d] - box[d]);
  PetscCall(FindSizeOption(body, prefix, &option));
  PetscCall(Doubt(&extent, units, prefix ? prefix : "", option, size, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ControllerWarnOfUnits - a line on standard error for each of the first bodies that numbers in other units make implausible; collective */
PetscErrorCode ControllerWarnOfUnits(Controller controller)
{
  char       text[DOUBT_SIZE];
  PetscReal *boxes;
  PetscInt   told = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(6 * controller->n_bodies, &boxes));
  PetscCall(BodyGetAllBoxes(controller->n_bodies, controller->bodies, boxes));
  for (PetscInt b = 0; b < controller->n_bodies && told < MOST_DOUBTS; b++) {
    PetscCall(BodyDoubtUnits(controller->bodies[b], boxes + 6 * b, text));
    if (!text[0]) continue;
    PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)controller), stderr, "impakt: warning: %s (-units)\n", text));
    told++;
  }
  PetscCall(PetscFree(boxes));
  PetscFunctionReturn(PETSC_SUCCESS);
}
