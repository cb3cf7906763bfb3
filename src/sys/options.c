/* Option hygiene: every option that is given must have been read by somebody. */
#include <impakt.h>
<<<<<<< HEAD

typedef struct {
  const char *name;  /* after the body's prefix, for those of bodies */
  const char *value; /* what it takes */
  const char *text;
} KnownOption;

static const KnownOption global_options[] = {
    {"bodies", "a,b", "names of the bodies; options of body a begin with -a_"},
    {"contact_pairs", "a:b,b:c|auto|none",
     "pairs that may touch, Dirichlet side first; a.xmax:b.xmin for certain surfaces, a.all for the whole boundary; a:o with an obstacle; "
     "auto: all with all"},
    {"obstacles", "o,p", "names of rigid obstacles; options of obstacle o begin with -o_"},
    {"contact_law", "frictionless|tied", "what surfaces do to each other, default frictionless"},
    {"contact_facing", "true|false",
     "pairs of whole bodies keep only the faces that see each other at the start, default true; false where bodies roll or turn"},
    {"contact_slip_bound", "s", "slip after which contact rows are built again, in parts of a face, default 0.2"},
    {"contact_angle_bound", "a", "turn of a normal after which they are [rad], default 0.1"},
    {"contact_type", "schwarz|penalty|lagrange|augmented_lagrangian", "contact method"},
    {"contact_constraint", "gap|gap_rate|both", "what contact forces keep from becoming negative, default gap"},
    {"contact_stabilization", "none|naive|contact_stabilized", "against chatter of contact nodes with mass, default none"},
    {"contact_penalty", "tau", "penalty parameter [N/m^3; N/m in 1-D], default from material and element size"},
    {"contact_penalty_scale", "s",
     "of that default, relative to an element of each side in series; default 10 with massless contact nodes, else 1"},
    {"contact_penalty_damping", "c", "damping of the gap rate with penalty [N s/m^3; N s/m in 1-D]"},
    {"contact_augmentation_tolerance", "g", "gap that the augmented Lagrangian leaves [m], default 4e-10 of the size of the smallest body"},
    {"contact_augmentation_max_it", "n", "limit of its rounds in a step, default 200"},
    {"contact_swap_sides", "true|false", "Schwarz: sides change with every controller step, default false"},
    {"contact_tolerance", "g", "depth that does not yet count as penetration [m]"},
    {"time_start", "t", "start [s], default 0"},
    {"time_end", "t", "end [s]"},
    {"time_step", "dt", "controller step [s]"},
    {"schwarz_snes_type", "newtonls|anderson|nrichardson|ngmres|qn", "outer iteration, default newtonls"},
    {"schwarz_snes_atol", "a", "absolute tolerance on the change of position [m], default 4e-12 of the size of the smallest body"},
    {"schwarz_snes_rtol", "r", "relative tolerance, default 1e-15"},
    {"schwarz_snes_max_it", "n", "limit of iterations, default 50"},
    {"schwarz_snes_linesearch_damping", "theta", "relaxation of nrichardson, default 1"},
    {"schwarz_relaxation", "fixed|aitken", "relaxation of nrichardson, default fixed"},
    {"schwarz_traction", "internal|reaction", "nodal force handed over: without or with inertia, default internal"},
    {"schwarz_traction_waveform", "linear|constant", "traction over the substeps of a partner that makes more of them, default linear"},
    {"schwarz_transmission", "dirichlet_neumann|robin|impedance", "what is prescribed on both sides, default dirichlet_neumann"},
    {"schwarz_robin_parameter", "alpha", "stiffness of Robin conditions [N/m in 1-D], default E A / h of the Neumann side"},
    {"schwarz_predictor", "last|trial|extrapolate|inelastic", "where the first sweep of a step starts from, default inelastic"},
    {"schwarz_convergence", "auto|position|contact_position|mismatch", "what change of position is tested, default auto"},
    {"schwarz_condense", "0|1|auto",
     "whether sweeps run on the interface compliance of linear bodies, default auto: in two and three dimensions"},
    {"schwarz_dense_limit", "n", "interface unknowns up to which its matrices are dense, conjugate gradients beyond, default 2000"},
    {"schwarz_recheck", "true|false", "let tensile nodes leave contact within the step, default true"},
    {"schwarz_unconverged", "error|accept", "what to do with a step that does not converge, default error"},
    {"penalty_snes_type", "newtonls|...", "outer iteration of the penalty method, default newtonls"},
    {"penalty_snes_rtol", "r", "its relative tolerance on the force, default 1e-9"},
    {"penalty_snes_atol", "a", "its absolute tolerance [N], default 1e-17 of the modulus times the area of an element's face"},
    {"penalty_snes_max_it", "n", "its limit of iterations, default 50"},
    {"lagrange_snes_type", "vinewtonrsls|vinewtonssls", "outer iteration of implicit Lagrange multipliers, default vinewtonrsls"},
    {"lagrange_snes_atol", "a", "its tolerance on the gap [m], default 4e-12 of the size of the smallest body"},
    {"lagrange_snes_rtol", "r", "relative to the displacement of the contact nodes, default 1e-15"},
    {"lagrange_snes_max_it", "n", "its limit of iterations, default 50"},
    {"exact", "none|impact|characteristics", "compare with an exact solution: of two equal bars, of any two bars"},
    {"output_history", "file.h5", "history of every controller step"},
    {"output_summary", "file.json", "summary of the run"},
    {"output_fields", "file.h5", "displacement, velocity, stress, ... of all bodies over time, with file.xdmf for ParaView"},
    {"output_fields_interval", "n", "a frame of fields every n steps, default: at most 100 frames in all"},
    {"output_fields_precision", "single|double", "of the numbers in the frames, default single"},
    {"monitor_interval", "n", "a line on the terminal every n steps, default 0: none"},
    {"progress", "true|false", "progress bar on standard error"},
    {"options_file", "file", "more options from a file"},
};

static const KnownOption obstacle_options[] = {
    {"obstacle_type", "plane|sphere|cylinder", "shape of the obstacle"},
    {"point", "x,y,z", "point of the plane or of the axis, or the centre [m]"},
    {"normal", "x,y,z", "of the plane, away from what is solid"},
    {"axis", "x,y,z", "of the cylinder, default 0,0,1: a disc in 2-D"},
    {"radius", "r", "of the sphere or cylinder [m]"},
};

static const KnownOption body_options[] = {
    {"dm_plex_dim", "1|2|3", "space dimension of the mesh"},
    {"dm_plex_shape", "box|ball", "shape of the mesh, default box; ball: a disc in 2-D"},
    {"dm_plex_box_faces", "n[,n,n]", "elements along the axes of a box"},
    {"dm_plex_box_lower", "x[,y,z]", "its lower corner [m]"},
    {"dm_plex_box_upper", "x[,y,z]", "its upper corner [m]"},
    {"dm_plex_simplex", "true|false", "box or ball of triangles or tetrahedra, default false"},
    {"ball_radius", "r", "of a ball [m], default 1"},
    {"ball_centre", "x,y[,z]", "its centre [m], default the origin"},
    {"ball_divisions", "n", "elements along an edge of its central block, default 4; even for a half or quarter"},
    {"ball_layers", "m", "elements from the central block to the surface, default n/2 rounded up"},
    {"ball_pole", "x,y[,z]", "direction in which its elements are small, default 0,0,-1 (0,-1 in 2-D)"},
    {"ball_grading", "g", "ratio of the largest to the smallest element, default 1"},
    {"ball_part", "full|half|quarter", "all of it, x >= centre, or y >= centre too, default full; surfaces: surface, cut_x, cut_y"},
    {"dm_plex_filename", "file", "mesh from a file: Gmsh .msh, Exodus II .g .e .exo"},
    {"mesh_blocks", "a,b", "only these blocks of the file"},
    {"scale", "s", "factor on the coordinates of the mesh, default 1"},
    {"rotate", "ax,ay,az,degrees", "rotation of the mesh about an axis; degrees alone in 2-D"},
    {"rotate_centre", "x,y[,z]", "point that the rotation leaves in place [m], default the origin"},
    {"translate", "x,y[,z]", "translation of the mesh, after the rotation [m]"},
    {"material_type", "linear_elastic|saint_venant_kirchhoff|neo_hookean", "constitutive model, default linear_elastic"},
    {"density", "rho", "mass density [kg/m^3]"},
    {"youngs_modulus", "E", "Young's modulus [Pa]"},
    {"poissons_ratio", "nu", "Poisson's ratio, default 0"},
    {"cross_section", "A", "cross-sectional area of bars [m^2], default 1"},
    {"thickness", "h", "of plane bodies [m], default 1"},
    {"plane_stress", "true|false", "plane stress in 2-D, default false: plane strain"},
    {"initial_velocity", "v[,v,v]", "[m/s], numbers or formulas in x, y, z, default 0"},
    {"initial_displacement", "u[,u,u]", "[m], numbers or formulas in x, y, z, default 0"},
    {"boundary_displacement", "a,b", "surfaces or node sets whose displacement is prescribed"},
    {"boundary_displacement_<surface>", "u[,u,u]", "[m], formulas in x, y, z, t, table:file, or free"},
    {"boundary_traction", "a,b", "surfaces that carry a traction"},
    {"boundary_traction_<surface>", "t[,t,t]", "[Pa], formulas in x, y, z, t and the outward normal nx, ny, nz, or table:file"},
    {"body_force", "f[,f,f]", "force per volume [N/m^3], formulas in x, y, z, t, or table:file"},
    {"gravity", "g[,g,g]", "acceleration [m/s^2]"},
    {"exact_displacement", "u[,u,u]", "[m], formulas in x, y, z, t to compare with at the end of the run"},
    {"mass_type", "lumped|consistent|averaged", "mass matrix, default averaged; lumped for explicit bodies in 2-D and 3-D"},
    {"mass_redistribute", "true|false", "massless contact nodes, default true"},
    {"ts_type", "alpha2|centraldifference|static", "implicit or explicit integrator, or none (no inertia), default alpha2"},
    {"ts_time_step", "dt|auto", "substep [s], default the controller step"},
    {"ts_alpha_radius", "r", "numerical dissipation of alpha2, 1 (none) to 0"},
    {"ts_alpha_alpha_m", "a", "parameter of alpha2, default 1"},
    {"ts_alpha_alpha_f", "a", "parameter of alpha2, default 1"},
    {"ts_alpha_gamma", "g", "Newmark's gamma, default 1/2"},
    {"ts_alpha_beta", "b", "Newmark's beta, default 1/4"},
};
=======
#include "names.h"
#include "optiontable.h"
>>>>>>> wt-words

/* These are read by PETSc when it solves or finalises, so they are unread before the run */
static const char *const late_options[] = {"schwarz_snes_view",
                                           "schwarz_snes_view_pre",
                                           "schwarz_snes_view_solution",
                                           "penalty_snes_view",
                                           "penalty_snes_view_pre",
                                           "penalty_snes_view_solution",
                                           "lagrange_snes_view",
                                           "lagrange_snes_view_pre",
                                           "lagrange_snes_view_solution",
                                           "options_left",
                                           "options_view",
                                           "malloc_dump",
                                           "malloc_view",
                                           "malloc_debug",
                                           "objects_dump",
                                           "memory_view",
                                           "log_view",
                                           "log_trace",
                                           "log_view_memory",
                                           "log_view_gpu_time",
                                           "log_nested",
                                           "get_total_flops",
                                           "mpidump",
                                           "citations",
                                           "petsc_mpi",
                                           "x_virtual",
                                           "on_error_abort",
                                           "on_error_mpiabort"};

/* Levenshtein's distance between two short words */
static PetscInt EditDistance(const char a[], const char b[])
{
  size_t   n, m;
  PetscInt row[129];

  if (PetscStrlen(a, &n) || PetscStrlen(b, &m) || n > 128 || m > 128) return 1000;
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

/* The options of one kind, each behind a prefix, if one is nearer than what there is */
static PetscErrorCode FindNearestOf(const char name[], OptionOwner owner, const char prefix[], PetscInt *best, char nearest[], size_t size)
{
  const KnownOption *options;
  size_t             n;

  PetscFunctionBegin;
  options = KnownOptionsGet(&n);
  for (size_t i = 0; i < n; i++) {
    char     full[128];
    PetscInt distance;

    if (options[i].owner != owner) continue;
    PetscCall(PetscSNPrintf(full, sizeof(full), "%s%s%s", prefix, prefix[0] ? "_" : "", options[i].name));
    distance = EditDistance(name, full);
    if (distance >= *best) continue;
    *best = distance;
    PetscCall(PetscStrncpy(nearest, full, size));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindNearest(const char name[], PetscInt n_bodies, const char *const bodies[], char nearest[], size_t size)
{
  char   **obstacles;
  PetscInt best = 1000, n;

  PetscFunctionBegin;
  nearest[0] = 0;
  PetscCall(FindNearestOf(name, OPTION_OF_RUN, "", &best, nearest, size));
  for (PetscInt b = 0; b < n_bodies; b++) PetscCall(FindNearestOf(name, OPTION_OF_BODY, bodies[b], &best, nearest, size));
  PetscCall(NamesRead(NULL, "-obstacles", &n, &obstacles, NULL));
  for (PetscInt o = 0; o < n; o++) PetscCall(FindNearestOf(name, OPTION_OF_OBSTACLE, obstacles[o], &best, nearest, size));
  PetscCall(NamesDestroy(n, &obstacles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ImpaktCheckOptions - stops with an error if an option has been given that nobody has read

  Collective on `PETSC_COMM_WORLD`

  Input Parameters:
+ n      - number of bodies
- bodies - their names

  Level: developer

  Note:
  To be called when everything has been set up and nothing been computed. Names the nearest known option.

.seealso: `ImpaktPrintOptions()`
@*/
PetscErrorCode ImpaktCheckOptions(PetscInt n, const char *const bodies[])
{
  PetscInt n_left;
  char   **names, **values, message[2048] = "";
  PetscInt unread = 0;

  PetscFunctionBegin;
  PetscCall(PetscOptionsLeftGet(NULL, &n_left, &names, &values));
  for (PetscInt i = 0; i < n_left; i++) {
    PetscBool late = PETSC_FALSE, known;
    char      nearest[128], reason[256], line[512];

    for (size_t k = 0; k < sizeof(late_options) / sizeof(late_options[0]) && !late; k++)
      PetscCall(PetscStrcmp(names[i], late_options[k], &late));
    if (late) continue;
    PetscCall(FindNearest(names[i], n, bodies, nearest, sizeof(nearest)));
    PetscCall(PetscStrcmp(names[i], nearest, &known));
    if (known) PetscCall(PetscSNPrintf(reason, sizeof(reason), "it goes with another method or type than the one chosen"));
    else PetscCall(PetscSNPrintf(reason, sizeof(reason), "the nearest known one is -%s", nearest));
    PetscCall(PetscSNPrintf(line, sizeof(line), "%s-%s%s%s (%s)", unread ? ", " : "", names[i], values[i] ? " " : "",
                            values[i] ? values[i] : "", reason));
    PetscCall(PetscStrlcat(message, line, sizeof(message)));
    unread++;
  }
  PetscCall(PetscOptionsLeftRestore(NULL, &n_left, &names, &values));
  PetscCheck(!unread, PETSC_COMM_WORLD, PETSC_ERR_USER_INPUT,
             "Unknown option%s, or without effect here: %s. `impakt -help all` lists the options", unread == 1 ? "" : "s", message);
  PetscFunctionReturn(PETSC_SUCCESS);
}
