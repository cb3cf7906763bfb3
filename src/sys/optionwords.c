/* Options by their meaning: for -help WORD, and for what the message about an unknown option suggests. */
#define _POSIX_C_SOURCE 200809L /* strncasecmp() */
#include <petscsys.h>
#include <ctype.h>
#include <string.h>
#include <strings.h>
#include "names.h"
#include "optionwords.h"
#include "sharedoptions.h"

/* Other words for an option, as they stand in books and in input files of other programs. A word of one letter counts as it is written. */
static const struct {
  const char *option, *words;
} meanings[] = {
    {"bodies", "parts solids subdomains"},
    {"initial_velocity", "velocity speed vel v v0"},
    {"initial_displacement", "displacement u0"},
    {"mass_redistribute", "massless sheet thin plate shell layer"},
    {"rigid", "stiff undeformable"},
    {"damping_mass", "damping damp rayleigh alpha viscosity"},
    {"damping_stiffness", "damping damp rayleigh beta viscosity"},
    {"dm_plex_box_faces", "elements cells resolution nx divisions mesh_size"},
    {"dm_plex_box_lower", "size box corner"},
    {"dm_plex_box_upper", "size box corner length width height"},
    {"dm_plex_filename", "mesh mesh_file gmsh msh exodus file"},
    {"dm_plex_dim", "dim dimension"},
    {"dm_plex_simplex", "triangles tetrahedra tri tet"},
    {"translate", "position offset move origin"},
    {"rotate", "angle tilt orientation"},
    {"material", "named_material"},
    {"material_type", "law model constitutive plasticity plastic rubber"},
    {"density", "rho mass"},
    {"youngs_modulus", "E young modulus elastic_modulus stiffness"},
    {"poissons_ratio", "nu poisson"},
    {"yield_stress", "yield sigma_y plastic"},
    {"boundary_displacement", "displacement fix fixed clamp support roller symmetry dirichlet boundary bc"},
    {"boundary_traction", "traction pressure shear load force neumann"},
    {"body_force", "force load"},
    {"gravity", "g weight acceleration"},
    {"time_start", "start begin t_start t0"},
    {"time_end", "end stop duration end_time final_time t_end tend"},
    {"time_step", "dt step timestep delta_t"},
    {"ts_time_step", "dt step timestep time_step substep substeps"},
    {"ts_type", "integrator explicit implicit static quasistatic newmark time_integrator preload"},
    {"contact_pairs", "pairs contact_surfaces"},
    {"contact_type", "contact_method"},
    {"contact_rule", "sheet thin plate shell impulse restitution inelastic"},
    {"contact_law", "tie glue bond coulomb spring"},
    {"contact_spring_stiffness", "adhesive interface_stiffness glue_stiffness"},
    {"contact_cohesive_strength", "cohesive delamination debonding czm"},
    {"contact_cohesive_toughness", "fracture_energy fracture_toughness gc gic critical_energy_release_rate"},
    {"contact_friction", "friction mu friction_coefficient coefficient_of_friction"},
    {"contact_penalty", "penalty_parameter"},
    {"obstacles", "wall floor ground plane"},
    {"velocity", "speed v belt"},
    {"output_fields", "output paraview vtk xdmf vtu frames results"},
    {"output_history", "output results"},
    {"output_summary", "output results json"},
    {"probe", "point points sensor monitor_point"},
    {"max_wall_time", "walltime time_limit"},
    {"monitor_interval", "monitor verbose print"},
    {"checkpoint", "save"},
    {"restart", "resume"},
    {"restart_state", "preload prestress"},
    {"units", "mm millimetre tonne MPa"},
};

/* What an option needs beside itself: an option that begins so, behind the name of its owner, wants that other one of the owner to have one
   of these values; `standard`: what it has where it is not given. The first line for an option counts */
static const struct {
  OptionOwner owner;
  const char *begin, *other, *values, *standard;
} needs[] = {
    {OPTION_OF_RUN, "contact_friction", "contact_law", "coulomb", "frictionless"},
    {OPTION_OF_RUN, "contact_penalty", "contact_type", "penalty", "schwarz"},
    {OPTION_OF_RUN, "contact_augmentation_", "contact_type", "augmented_lagrangian", "schwarz"},
    {OPTION_OF_RUN, "contact_swap_sides", "contact_type", "alternation", "schwarz"},
    {OPTION_OF_RUN, "contact_monitor", "contact_type", "schwarz|force|penalty|lagrange|augmented_lagrangian", "schwarz"},
    {OPTION_OF_RUN, "contact_rule", "contact_type", "schwarz|force", "schwarz"},
    {OPTION_OF_RUN, "law_", "contact_type", "schwarz|force|penalty|lagrange|augmented_lagrangian", "schwarz"},
    {OPTION_OF_RUN, "schwarz_snes_", "contact_type", "schwarz|force|alternation|penalty|lagrange|augmented_lagrangian", "schwarz"},
    {OPTION_OF_RUN, "schwarz_unconverged", "contact_type", "schwarz|force|alternation", "schwarz"},
    {OPTION_OF_RUN, "schwarz_", "contact_type", "alternation", "schwarz"},
    {OPTION_OF_BODY, "yield_stress", "material_type", "j2|j2_small|johnson_cook", "linear_elastic"},
    {OPTION_OF_BODY, "hardening_exponent", "material_type", "johnson_cook", "linear_elastic"},
    {OPTION_OF_BODY, "hardening_modulus", "material_type", "j2|j2_small|johnson_cook", "linear_elastic"},
    {OPTION_OF_BODY, "hardening", "material_type", "j2|j2_small", "linear_elastic"},
    {OPTION_OF_BODY, "kinematic_modulus", "material_type", "j2|j2_small", "linear_elastic"},
    {OPTION_OF_BODY, "saturation_", "hardening", "voce", "linear"},
    {OPTION_OF_BODY, "rate_coefficient", "material_type", "johnson_cook", "linear_elastic"},
    {OPTION_OF_BODY, "melting_temperature", "material_type", "johnson_cook", "linear_elastic"},
    {OPTION_OF_BODY, "mooney_rivlin_share", "material_type", "mooney_rivlin", "linear_elastic"},
    {OPTION_OF_BODY, "ball_", "dm_plex_shape", "ball", "box"},
};

/* Whether a text is one of the words of a list with blanks between them */
static PetscBool HasWord(const char list[], const char word[])
{
  const size_t length = strlen(word);

  for (const char *at = list; *at; at += strspn(at, " ")) {
    const size_t end = strcspn(at, " ");

    if (end == length && !(length == 1 ? strncmp(at, word, 1) : strncasecmp(at, word, length))) return PETSC_TRUE;
    at += end;
  }
  return PETSC_FALSE;
}

static PetscBool Means(const char word[], const char option[])
{
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(meanings); i++)
    if (!strcmp(meanings[i].option, option) && HasWord(meanings[i].words, word)) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Whether a word of a text begins with another, in whichever case: "roller" is not in "controller" */
static PetscBool Contains(const char text[], const char part[])
{
  const size_t length = strlen(part);

  for (const char *at = text; *at; at++)
    if ((at == text || !isalnum((unsigned char)at[-1])) && !strncasecmp(at, part, length)) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* How near an option is to a word: 0, the word means it; 1, its name has the word; 2, its text has the word; -1, it has nothing to do with
   the word. Words of one and two letters are in the middle of too many others. */
PetscErrorCode OptionGetRank(const KnownOption *option, const char word[], PetscInt *rank)
{
  const PetscBool is_long = (PetscBool)(strlen(word) > 2);

  PetscFunctionBegin;
  *rank = -1;
  if (is_long && Contains(option->text, word)) *rank = 2;
  if (is_long && Contains(option->name, word)) *rank = 1;
  if (Means(word, option->name) || !strcasecmp(option->name, word)) *rank = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Levenshtein's distance between two short words */
static PetscInt EditDistance(const char a[], const char b[])
{
  const size_t n = strlen(a), m = strlen(b);
  PetscInt     row[129];

  if (n > 128 || m > 128) return 1000;
  for (size_t j = 0; j <= m; j++) row[j] = (PetscInt)j;
  for (size_t i = 1; i <= n; i++) {
    PetscInt diagonal = row[0];

    row[0] = (PetscInt)i;
    for (size_t j = 1; j <= m; j++) {
      const PetscInt above = row[j];

      row[j]   = PetscMin(PetscMin(row[j] + 1, row[j - 1] + 1), diagonal + (a[i - 1] != b[j - 1]));
      diagonal = above;
    }
  }
  return row[m];
}

typedef struct {
  const char *name;
  OptionOwner owner;        /* whose the name of that owner is which the option begins with; of the run: it begins with none */
  char        prefix[256];  /* that name, with an underscore; nothing: of the run */
  const char *rest;         /* what follows */
  char        another[256]; /* a body that an option may be meant for which begins with no name */
  PetscInt    distance;     /* of the nearest option, by its letters */
  char        nearest[256];
} Unknown;

/* The options of one kind, each behind the name of an owner, if one is nearer than what there is */
static PetscErrorCode TryOwner(Unknown *unknown, OptionOwner owner, const char name[])
{
  const KnownOption *options;
  char               prefix[256];
  size_t             n;

  PetscFunctionBegin;
  options = KnownOptionsGet(&n);
  PetscCall(PetscSNPrintf(prefix, sizeof(prefix), "%s%s", name, name[0] ? "_" : ""));
  if (!strncasecmp(unknown->name, prefix, strlen(prefix)) && strlen(prefix) > strlen(unknown->prefix)) {
    unknown->owner = owner;
    unknown->rest  = unknown->name + strlen(prefix);
    PetscCall(PetscStrncpy(unknown->prefix, prefix, sizeof(unknown->prefix)));
  }
  for (size_t i = 0; i < n; i++) {
    char     full[256];
    PetscInt distance;

    if (options[i].owner != owner) continue;
    PetscCall(PetscSNPrintf(full, sizeof(full), "%s%s", prefix, options[i].name));
    distance = EditDistance(unknown->name, full);
    if (distance >= unknown->distance) continue;
    unknown->distance = distance;
    PetscCall(PetscStrncpy(unknown->nearest, full, sizeof(unknown->nearest)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The owners of options: the run, the bodies, all of them, materials, obstacles */
static PetscErrorCode TryOwners(Unknown *unknown, PetscInt n_bodies, const char *const bodies[])
{
  char   **obstacles, material[128];
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(TryOwner(unknown, OPTION_OF_RUN, ""));
  for (PetscInt b = 0; b < n_bodies; b++) PetscCall(TryOwner(unknown, OPTION_OF_BODY, bodies[b]));
  PetscCall(TryOwner(unknown, OPTION_OF_BODY, "all"));
  PetscCall(OptionsFindMaterial(unknown->name, material, sizeof(material)));
  if (material[0]) {
    char name[160];

    PetscCall(PetscSNPrintf(name, sizeof(name), "material_%s", material));
    PetscCall(TryOwner(unknown, OPTION_OF_BODY, name));
  }
  PetscCall(NamesRead(NULL, "-obstacles", &n, &obstacles, NULL));
  for (PetscInt o = 0; o < n; o++) PetscCall(TryOwner(unknown, OPTION_OF_OBSTACLE, obstacles[o]));
  PetscCall(NamesDestroy(n, &obstacles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The options of an owner that have this rank for the rest of the unknown option, as "-a or -b" */
static PetscErrorCode AddMeant(const Unknown *unknown, OptionOwner owner, const char prefix[], PetscInt wanted, char text[], size_t size)
{
  const KnownOption *options;
  size_t             n;

  PetscFunctionBegin;
  options = KnownOptionsGet(&n);
  for (size_t i = 0; i < n; i++) {
    char     full[256];
    PetscInt rank;

    if (options[i].owner != owner || strchr(options[i].name, '<')) continue;
    PetscCall(OptionGetRank(&options[i], unknown->rest, &rank));
    if (rank != wanted) continue;
    PetscCall(PetscSNPrintf(full, sizeof(full), "-%s%s", prefix, options[i].name));
    PetscCall(NamesAppend(text, size, " or ", full));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What an unknown option may mean: of the owner that it names, of the run, or, where it names none, of the bodies */
static PetscErrorCode FindMeant(const Unknown *unknown, char text[], size_t size)
{
  PetscFunctionBegin;
  for (PetscInt rank = 0; rank < 2 && !text[0]; rank++) {
    PetscCall(AddMeant(unknown, unknown->owner, unknown->prefix, rank, text, size));
    if (!text[0] && unknown->owner != OPTION_OF_RUN) PetscCall(AddMeant(unknown, OPTION_OF_RUN, "", rank, text, size));
    if (!text[0] && unknown->owner == OPTION_OF_RUN) {
      if (unknown->another[0]) PetscCall(AddMeant(unknown, OPTION_OF_BODY, unknown->another, rank, text, size));
      if (text[0]) PetscCall(AddMeant(unknown, OPTION_OF_BODY, "all_", rank, text, size));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the name that begins so is in an option: at its start, or, of a body or a material, somewhere behind their name; NULL: nowhere */
static const char *FindName(const char option[], OptionOwner owner, const char begin[])
{
  const char *at = option;

  if (owner == OPTION_OF_RUN) return strncasecmp(at, begin, strlen(begin)) ? NULL : at;
  while ((at = strchr(at, '_')))
    if (!strncasecmp(++at, begin, strlen(begin))) return at;
  return NULL;
}

/* The contact law that an option is a parameter of, as spring in contact_spring_stiffness: one that the table lists. Or nothing */
static PetscErrorCode FindLaw(const char option[], char law[], size_t size)
{
  const KnownOption *options;
  size_t             n;

  PetscFunctionBegin;
  law[0]  = 0;
  options = KnownOptionsGet(&n);
  for (size_t i = 0; i < n && !law[0]; i++) {
    const char *at = options[i].value;

    if (strcmp(options[i].name, "contact_law") != 0) continue;
    for (size_t length = strcspn(at, "|"); length && !law[0]; at += length + (at[length] == '|'), length = strcspn(at, "|")) {
      char begin[128];

      PetscCall(PetscSNPrintf(begin, sizeof(begin), "contact_%.*s_", (int)length, at));
      if (!strncasecmp(option, begin, strlen(begin))) PetscCall(PetscSNPrintf(law, size, "%.*s", (int)length, at));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What an option (without its dash) needs that the run has not chosen, as "-contact_law coulomb"; or nothing */
PetscErrorCode OptionsFindNeed(const char option[], char need[], size_t size)
{
  char law[64];

  PetscFunctionBegin;
  need[0] = 0;
  PetscCall(FindLaw(option, law, sizeof(law)));
  if (law[0]) {
    char chosen[64] = "";

    PetscCall(PetscOptionsGetString(NULL, NULL, "-contact_law", chosen, sizeof(chosen), NULL));
    if (strcmp(chosen, law) != 0) PetscCall(PetscSNPrintf(need, size, "-contact_law %s", law));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(needs); i++) {
    const char *at = FindName(option, needs[i].owner, needs[i].begin);
    char        other[128], value[64];
    PetscBool   fits;

    if (!at) continue;
    PetscCall(PetscSNPrintf(other, sizeof(other), "-%.*s%s", (int)(at - option), option, needs[i].other));
    PetscCall(PetscStrncpy(value, needs[i].standard, sizeof(value)));
    PetscCall(PetscOptionsGetString(NULL, NULL, other, value, sizeof(value), NULL));
    PetscCall(PetscStrInList(value, needs[i].values, '|', &fits));
    if (!fits) PetscCall(PetscSNPrintf(need, size, "%s %s", other, needs[i].values));
    break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What an option that nobody has read may have been meant to be. A slip of the pen first, up to two letters; then what the words mean;
   then the nearest by letters. `known`: there is such an option, and nothing is suggested */
PetscErrorCode OptionsSuggest(const char name[], PetscInt n, const char *const bodies[], PetscBool *known, char text[], size_t size)
{
  Unknown unknown = {.name = name, .rest = name, .owner = OPTION_OF_RUN, .distance = 1000};
  char    need[160];

  PetscFunctionBegin;
  text[0] = 0;
  if (n) PetscCall(PetscSNPrintf(unknown.another, sizeof(unknown.another), "%s_", bodies[0]));
  PetscCall(TryOwners(&unknown, n, bodies));
  *known = (PetscBool)(unknown.distance == 0);
  if (*known) PetscFunctionReturn(PETSC_SUCCESS);
  if (unknown.distance > 2 || 4 * (size_t)unknown.distance > strlen(name)) PetscCall(FindMeant(&unknown, text, size));
  if (!text[0]) PetscCall(PetscSNPrintf(text, size, "-%s", unknown.nearest));
  PetscCall(OptionsFindNeed(text + 1, need, sizeof(need)));
  if (need[0]) PetscCall(PetscSNPrintf(text + strlen(text), size - strlen(text), ", with %s", need));
  PetscFunctionReturn(PETSC_SUCCESS);
}
