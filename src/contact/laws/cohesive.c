/* Glue that breaks: a bilinear law with damage d, one number for each node, for mode I and mixed modes.

   The traction is (1 - d) k g. It rises with the opening to the strength s, at s / k, and falls linearly to zero at 2 G / s, so that
   breaking takes the toughness G per unit of area. d follows from the largest opening of all steps. Unloading goes straight to the origin.
   The opening is the length of the gap as a vector, without its part along the normal where that is negative. All modes have the same
   strength and toughness.

   In compression a node without damage has the stiffness k: springs that push and pull keep their energy. A node with damage is held by
   contact, as other nodes are: a spring of the stiffness k would give back more at the gap 0 than the damaged one had stored.

   Sources: P. P. Camanho, C. G. Davila, Mixed-mode decohesion finite elements for the simulation of delamination in composite materials,
   NASA/TM-2002-211737 (2002), for the law and one damage of all modes; M. Ortiz, A. Pandolfi, Finite-deformation irreversible cohesive
   elements for three-dimensional crack-propagation analysis, IJNME 44 (1999), for the effective opening. */
#include "rowlaw.h"
#include <petscmath.h>

enum { STIFFNESS, STRENGTH, TOUGHNESS };

/* Opening at which nothing is left [m] */
static PetscReal FailsAt(const PetscReal parameters[])
{
  return 2 * parameters[TOUGHNESS] / parameters[STRENGTH];
}

/* By how much the traction falls as the opening grows [N/m^3] */
static PetscReal Softening(const PetscReal parameters[])
{
  return parameters[STRENGTH] / (FailsAt(parameters) - parameters[STRENGTH] / parameters[STIFFNESS]);
}

static PetscReal Stiffness(const PetscReal parameters[], const PetscReal history[])
{
  return (1 - history[0]) * parameters[STIFFNESS];
}

static const char *Check(const PetscReal parameters[])
{
  if (FailsAt(parameters) > parameters[STRENGTH] / parameters[STIFFNESS]) return NULL;
  return "it would fail before it has its strength s: the stiffness k must be above s^2/(2 G), with the toughness G; raise "
         "-contact_cohesive_stiffness or -contact_cohesive_toughness, or lower -contact_cohesive_strength";
}

/* The part of a vector that opens, along the normal and across it, and its length */
static PetscReal GetOpening(PetscInt n, const RowLawGlue *glue, const PetscReal v[], PetscReal opens[])
{
  PetscReal along = 0, size = 0;

  for (PetscInt i = 0; i < n; i++) along += glue->normal[i] * v[i];
  for (PetscInt i = 0; i < n; i++) {
    opens[i] = v[i] - PetscMin(along, 0) * glue->normal[i];
    size += PetscSqr(opens[i]);
  }
  return PetscSqrtReal(size);
}

/* The opening from which on damage grows [m]: where the traction (1 - d) k g is that of the softening branch */
static PetscReal GrowsFrom(const RowLawGlue *glue)
{
  const PetscReal slope = Softening(glue->parameters);

  return slope * FailsAt(glue->parameters) / (Stiffness(glue->parameters, glue->history) + slope);
}

/* The gap m and the force -K m, K being the stiffness at the end of the step, follow from the trial force p = -K m - r m, so that
   m = -p / (K + r). Where damage grows, the opening x of m solves T(x) + r x = size, with the traction T of the softening branch and the
   size of -p: one x, since r is larger than the slope of T. A damaged node is not let deeper than contact lets it. */
static void Project(PetscInt n, const PetscReal limit[2], const RowLawGlue *glue, const PetscReal p[], PetscReal force[],
                    PetscReal derivative[])
{
  const PetscReal *parameters = glue->parameters, r = glue->r / glue->area, slope = Softening(parameters), fails = FailsAt(parameters);
  const PetscReal  old = Stiffness(parameters, glue->history);
  PetscReal        q[ROW_LAW_ROWS], opens[ROW_LAW_ROWS], size, part = 1 / (old + r), change = 0, along = 0;

  (void)limit;
  for (PetscInt i = 0; i < n; i++) q[i] = -p[i] / glue->area;
  size = GetOpening(n, glue, q, opens);
  if (size >= r * fails) part = 1 / r;
  else if (size > GrowsFrom(glue) * (old + r)) {
    part   = (size - slope * fails) / ((r - slope) * size);
    change = glue->secant ? 0 : (1 / (r - slope) - part) / PetscSqr(size); /* of part with size, over size */
  }
  /* m = part q, and force = r m - q */
  for (PetscInt i = 0; i < n; i++) {
    along += glue->normal[i] * part * q[i];
    force[i] = (r * part - 1) * q[i] * glue->area;
    for (PetscInt j = 0; j < n; j++) derivative[i * n + j] = (i == j) * (1 - r * part) - r * change * q[i] * opens[j];
  }
  if (glue->history[0] == 0 || along >= glue->least) return;
  /* contact: m is `least` along the normal, and force = r m - q */
  for (PetscInt i = 0; i < n; i++) force[i] += r * (glue->least - along) * glue->normal[i] * glue->area;
  for (PetscInt j = 0; j < n; j++) {
    PetscReal moved = 0;

    for (PetscInt i = 0; i < n; i++) moved += glue->normal[i] * ((i == j) - derivative[i * n + j]);
    for (PetscInt i = 0; i < n; i++) derivative[i * n + j] += moved * glue->normal[i];
  }
}

static void Grow(PetscInt n, const RowLawGlue *glue, const PetscReal gap[], PetscReal history[])
{
  const PetscReal *parameters = glue->parameters;
  PetscReal        opens[ROW_LAW_ROWS], opening = GetOpening(n, glue, gap, opens);

  if (opening >= FailsAt(parameters)) history[0] = 1;
  else if (opening > GrowsFrom(glue))
    history[0] = PetscMax(history[0], 1 - Softening(parameters) * (FailsAt(parameters) - opening) / (parameters[STIFFNESS] * opening));
}

const RowLaw RowLawCohesive = {
    .name         = "cohesive",
    .reads        = ROW_LAW_READS_MEAN,
    .pulls        = PETSC_TRUE,
    .project      = Project,
    .n_parameters = 3,
    .parameters = {[STIFFNESS] = {.name = "stiffness",
                                  .what = "stiffness of unbroken glue per unit of area",
                                  .unit = UNIT_STIFFNESS_ON_AREA,
                                  .hint = "a layer of the modulus E and the thickness t has E/t; 50 E/h, with the height h of the part "
                                          "that is glued, hardly gives way"},
                   [STRENGTH]  = {.name = "strength", .what = "largest traction of glue that breaks", .unit = UNIT_STRESS},
                   [TOUGHNESS] = {.name = "toughness", .what = "energy that breaking takes per unit of area", .unit = UNIT_ENERGY_ON_AREA}},
    .check      = Check,
    .stiffness  = Stiffness,
    .softening  = Softening,
    .n_history  = 1,
    .grow       = Grow};
