/* All options that Impakt has beside PETSc's. To add one: a line here, in the order of the printed table; then `make docs`. */
#include "optiontable.h"

static const OptionTopic topics[] = {
    {"bodies", "which bodies there are, their mass, and what they start from"},
    {"meshes", "boxes, balls and mesh files; where they are placed"},
    {"materials", "material law, its constants, and sections"},
    {"loads", "prescribed displacements, tractions, body forces, gravity"},
    {"time", "start, end, controller step; integrators and their substeps"},
    {"contact", "what may touch what, and by which method and law"},
    {"obstacles", "rigid planes, spheres and cylinders"},
    {"schwarz", "the contact step: its outer iteration, rules and laws of rows"},
    {"alternation", "the Schwarz alternation of the paper: -contact_type alternation"},
    {"penalty", "the penalty method"},
    {"lagrange", "Lagrange multipliers and the augmented Lagrangian"},
    {"files", "what a run reads, writes, and shows on the terminal"},
};

static const KnownOption options[] = {
    {"bodies", OPTION_OF_RUN, "bodies", "a,b", "names of the bodies; options of body a begin with -a_"},
    {"bodies", OPTION_OF_RUN, "all_<option>", "value",
     "an option of all bodies: each body that -bodies names has it, unless it, or its material, has an option of that name of its own"},
    {"bodies", OPTION_OF_BODY, "initial_velocity", "v[,v,v]", "velocity at the start [m/s], numbers or formulas in x, y, z; default 0"},
    {"bodies", OPTION_OF_BODY, "initial_displacement", "u[,u,u]",
     "displacement at the start [m], numbers or formulas in x, y, z; default 0"},
    {"bodies", OPTION_OF_BODY, "rigid", "true|false",
     "whether it moves as a whole, without deforming, by the mass and inertia of its mesh; needs a density alone; default false"},
    {"bodies", OPTION_OF_BODY, "mass_type", "lumped|consistent|averaged",
     "mass matrix; averaged: the mean of the two others. Default averaged, but lumped for explicit bodies in 2-D and 3-D"},
    {"bodies", OPTION_OF_BODY, "mass_redistribute", "true|false|near|auto",
     "whether contact nodes are massless. auto, the default: their mass moves to inner neighbours in fine bodies, in coarse ones they move "
     "as inner nodes do, and thin bodies and what may touch these keep it. true: it moves; false: it stays; near: it moves from nodes that "
     "face a partner at the start, and contact that comes to others is an error"},
    {"bodies", OPTION_OF_BODY, "mass_moments", "total|centre|inertia",
     "what that keeps: the total mass, its centre too, or (default) the moments of inertia too, where positive masses allow"},
    {"bodies", OPTION_OF_BODY, "damping_mass", "alpha",
     "Rayleigh damping: forces alpha M v against the velocity [1/s]; damping ratio alpha/(2 omega) of angular frequency omega [rad/s]; "
     "default 0"},
    {"bodies", OPTION_OF_BODY, "damping_stiffness", "beta",
     "Rayleigh damping: forces beta K v against the rate of strain [s]; damping ratio beta omega/2; not of elements at massless contact "
     "nodes; default 0"},

    {"meshes", OPTION_OF_BODY, "dm_plex_dim", "1|2|3", "space dimension of the mesh"},
    {"meshes", OPTION_OF_BODY, "dm_plex_shape", "box|ball", "shape of the mesh, default box; a ball in 2-D is a disc"},
    {"meshes", OPTION_OF_BODY, "dm_plex_box_faces", "n[,n,n]", "number of elements of a box along each axis"},
    {"meshes", OPTION_OF_BODY, "dm_plex_box_lower", "x[,y,z]", "lower corner of a box [m]"},
    {"meshes", OPTION_OF_BODY, "dm_plex_box_upper", "x[,y,z]", "upper corner of a box [m]"},
    {"meshes", OPTION_OF_BODY, "dm_plex_simplex", "true|false",
     "whether a box or a ball is made of triangles or tetrahedra, default false: quadrilaterals or hexahedra"},
    {"meshes", OPTION_OF_BODY, "mesh_division", "bricks|graph|whole",
     "how a mesh is divided among ranks: of a box each makes its own brick, or the first makes all and it is divided as a graph, or one "
     "rank has all of it; default whole for explicit bodies of up to 2000 elements of a box, a ball or a rod where there are 4 or more for "
     "each rank, else bricks, but graph where a brick would have 1.1 times the mean number of elements, or where another option needs it "
     "(petscpartitioner_type, dm_distribute, dm_distribute_overlap, dm_plex_box_bd)"},
    {"meshes", OPTION_OF_BODY, "ranks", "0-7|0,2,5-6",
     "ranks among which the mesh is divided; others have none of it; one: it has all; default all, or, of small explicit bodies, one (see "
     "mesh_division)"},
    {"meshes", OPTION_OF_BODY, "mesh_contact_surfaces", "a,b",
     "surfaces that may touch another body, whose faces are spread over the ranks; default those that contact_pairs names"},
    {"meshes", OPTION_OF_BODY, "mesh_contact_cost", "c",
     "work for a face of these surfaces, in units of that for an element, default 15; 0: elements alone are spread"},
    {"meshes", OPTION_OF_BODY, "ball_radius", "r", "radius of a ball [m], default 1"},
    {"meshes", OPTION_OF_BODY, "ball_keep_volume", "true|false",
     "whether the nodes of a ball's surface move outward until the mesh has the ball's volume, default true; or lie at the radius"},
    {"meshes", OPTION_OF_BODY, "ball_centre", "x,y[,z]", "centre of a ball [m], default the origin"},
    {"meshes", OPTION_OF_BODY, "ball_divisions", "n",
     "number of elements along an edge of the central block of a ball, default 4; even for a half or a quarter"},
    {"meshes", OPTION_OF_BODY, "ball_layers", "m",
     "number of elements from the central block of a ball to its surface, default n/2 rounded up"},
    {"meshes", OPTION_OF_BODY, "ball_pole", "x,y[,z]", "direction in which the elements of a ball are small, default 0,0,-1 (0,-1 in 2-D)"},
    {"meshes", OPTION_OF_BODY, "ball_grading", "g", "ratio of the largest to the smallest element of a ball, default 1"},
    {"meshes", OPTION_OF_BODY, "ball_part", "full|half|quarter",
     "part of a ball: all, x >= centre, or y >= centre too; default full. Its surfaces are called surface, cut_x, cut_y"},
    {"meshes", OPTION_OF_BODY, "rod_radius", "r", "radius of a rod along z from 0 [m], default 1"},
    {"meshes", OPTION_OF_BODY, "rod_length", "l", "its length [m], default 1"},
    {"meshes", OPTION_OF_BODY, "rod_divisions", "n",
     "number of elements along an edge of the central block of its section, default 4; even for a half or a quarter"},
    {"meshes", OPTION_OF_BODY, "rod_layers", "m", "number of elements from there to its surface, default n/2 rounded up"},
    {"meshes", OPTION_OF_BODY, "rod_elements", "k", "number of elements along a rod, default 10"},
    {"meshes", OPTION_OF_BODY, "rod_part", "full|half|quarter",
     "part of a rod: all, x >= 0, or y >= 0 too; default full. Its surfaces are called surface, cut_x, cut_y, zmin, zmax"},
    {"meshes", OPTION_OF_BODY, "rod_keep_volume", "true|false",
     "whether the nodes of a rod's surface move outward until its section has the area of the disc, default true"},
    {"meshes", OPTION_OF_BODY, "dm_plex_filename", "file", "mesh from a file: Gmsh .msh, Exodus II .g .e .exo"},
    {"meshes", OPTION_OF_BODY, "mesh_blocks", "a,b", "blocks of the mesh file that the body is made of, default all"},
    {"meshes", OPTION_OF_BODY, "scale", "s", "factor on the coordinates of the mesh, default 1"},
    {"meshes", OPTION_OF_BODY, "rotate", "ax,ay,az,degrees", "rotation of the mesh about an axis; in 2-D degrees alone"},
    {"meshes", OPTION_OF_BODY, "rotate_centre", "x,y[,z]", "point that the rotation leaves in place [m], default the origin"},
    {"meshes", OPTION_OF_BODY, "translate", "x,y[,z]", "translation of the mesh, after the rotation [m]"},

    {"materials", OPTION_OF_BODY, "material", "name", "named material: the body has the options that begin with -material_<name>_"},
    {"materials", OPTION_OF_RUN, "material_<name>_<option>", "value",
     "an option of the named material, as in -material_steel_density 7800: each body with that material has it, unless it has its own"},
    {"materials", OPTION_OF_BODY, "material_type",
     "linear_elastic|saint_venant_kirchhoff|neo_hookean|mooney_rivlin|j2|j2_small|johnson_cook",
     "constitutive model, default linear_elastic"},
    {"materials", OPTION_OF_BODY, "<block>_material_type", "type",
     "of a block of the mesh, by its name in a Gmsh or Exodus II file or its number: a model of its own; so with density and all constants "
     "below, "
     "but for those of sections and elements. What a block does not say is as the body says"},
    {"materials", OPTION_OF_BODY, "density", "rho", "mass density [kg/m^3]"},
    {"materials", OPTION_OF_BODY, "youngs_modulus", "E", "Young's modulus [Pa]"},
    {"materials", OPTION_OF_BODY, "poissons_ratio", "nu", "Poisson's ratio, default 0"},
    {"materials", OPTION_OF_BODY, "mooney_rivlin_share", "m", "of mooney_rivlin: c01 / (c10 + c01), default 0: isochoric neo-Hookean"},
    {"materials", OPTION_OF_BODY, "yield_stress", "s", "of plastic models: stress at which the virgin material flows [Pa]"},
    {"materials", OPTION_OF_BODY, "hardening", "linear|voce|table",
     "of j2, j2_small: how strength grows with plastic strain, default linear"},
    {"materials", OPTION_OF_BODY, "hardening_modulus", "H",
     "of plastic models: growth of strength per plastic strain, default 0; B of johnson_cook [Pa]"},
    {"materials", OPTION_OF_BODY, "kinematic_modulus", "K", "of j2, j2_small: modulus of kinematic hardening, default 0 [Pa]"},
    {"materials", OPTION_OF_BODY, "saturation_stress", "s", "of Voce's law: the strength that it tends to [Pa]"},
    {"materials", OPTION_OF_BODY, "saturation_rate", "d", "of Voce's law: how fast it does, per plastic strain"},
    {"materials", OPTION_OF_BODY, "hardening_table", "0,s0,e1,s1,...", "pairs of plastic strain and strength [Pa], linear in between"},
    {"materials", OPTION_OF_BODY, "hardening_exponent", "n", "of johnson_cook: exponent of the plastic strain, default 1"},
    {"materials", OPTION_OF_BODY, "rate_coefficient", "C", "of johnson_cook: factor of the logarithm of the strain rate, default 0"},
    {"materials", OPTION_OF_BODY, "reference_rate", "r",
     "of johnson_cook: rate below which strength does not depend on it [1/s], default 1"},
    {"materials", OPTION_OF_BODY, "softening_exponent", "m", "of johnson_cook: exponent of the homologous temperature, default 1"},
    {"materials", OPTION_OF_BODY, "initial_temperature", "T", "of johnson_cook: temperature at the start [K], default 293"},
    {"materials", OPTION_OF_BODY, "room_temperature", "T", "of johnson_cook: temperature of the strength as given [K], default 293"},
    {"materials", OPTION_OF_BODY, "melting_temperature", "T",
     "of johnson_cook: temperature without strength [K]; default so high that temperature does not matter"},
    {"materials", OPTION_OF_BODY, "heat_fraction", "f", "of johnson_cook: part of plastic work that becomes heat, default 0.9"},
    {"materials", OPTION_OF_BODY, "specific_heat", "c", "of johnson_cook: specific heat [J/(kg K)], default 400"},
    {"materials", OPTION_OF_BODY, "cross_section", "A", "cross-sectional area of a bar [m^2], default 1"},
    {"materials", OPTION_OF_BODY, "thickness", "h", "thickness of a plane body [m], default 1"},
    {"materials", OPTION_OF_BODY, "plane_stress", "true|false", "plane stress in 2-D, default false: plane strain"},
    {"materials", OPTION_OF_BODY, "axisymmetric", "true|false",
     "in 2-D: rings about the axis x = 0, which x is the distance from and y goes along; forces, masses and contact areas are those of "
     "whole "
     "rings; default false"},
    {"materials", OPTION_OF_BODY, "element_formulation", "full|mean_dilatation|enhanced|reduced|composite",
     "of quadrilaterals and hexahedra: fully integrated; with one change of volume for each element, against locking of nearly "
     "incompressible "
     "bodies; with modes of their own that bend, for implicit and static bodies, and for thin ones that flow; or with one point, for "
     "explicit ones that do not flow. Default full, but "
     "mean_dilatation where Poisson's "
     "ratio is "
     "larger than 0.4, except in plane stress. Of triangles and tetrahedra: composite divides each into 4 or 8, which together are an "
     "element of six or "
     "ten nodes that does not lock; default for files of such elements"},

    {"loads", OPTION_OF_BODY, "boundary_displacement", "a,b", "surfaces or node sets whose displacement is prescribed"},
    {"loads", OPTION_OF_BODY, "boundary_displacement_<surface>", "u[,u,u]",
     "displacement of such a surface [m], formulas in x, y, z, t, or table:file; free: along that axis it is not prescribed"},
    {"loads", OPTION_OF_BODY, "boundary_traction", "a,b", "surfaces that carry a traction"},
    {"loads", OPTION_OF_BODY, "boundary_traction_<surface>", "t[,t,t]",
     "traction on such a surface [Pa], formulas in x, y, z, t and the outward normal nx, ny, nz, or table:file"},
    {"loads", OPTION_OF_BODY, "body_force", "f[,f,f]", "force per volume [N/m^3], formulas in x, y, z, t, or table:file"},
    {"loads", OPTION_OF_BODY, "gravity", "g[,g,g]", "acceleration of gravity [m/s^2]"},
    {"loads", OPTION_OF_BODY, "rigid_displacement", "u[,u,u]",
     "leads the centre of mass of a rigid body [m]: formulas in t, or table:file; free: along that axis forces move it"},
    {"loads", OPTION_OF_BODY, "rigid_rotation", "r[,r,r]",
     "leads the rotation of a rigid body about its centre of mass [rad]: in 2-D an angle, in 3-D axis times angle; formulas in t, or "
     "table:file"},

    {"time", OPTION_OF_RUN, "time_start", "t", "start [s], default 0"},
    {"time", OPTION_OF_RUN, "time_end", "t", "end [s]"},
    {"time", OPTION_OF_RUN, "energy_guard", "part",
     "a run ends with an error where its energy has grown by more than this part, less the work of loads; default 0.05, 0: none"},
    {"time", OPTION_OF_RUN, "time_step", "dt|auto",
     "controller step, at whose ends all bodies are at the same time [s]; auto: the largest that resolves contact"},
    {"time", OPTION_OF_BODY, "ts_type", "alpha2|centraldifference|static|rigid",
     "integrator: implicit, explicit, none (no inertia), or that of rigid bodies; default alpha2"},
    {"time", OPTION_OF_BODY, "artificial_stiffness", "part",
     "of the springs that hold a static body, where contact or ties alone do, while contact forces are found, in parts of that of the "
     "softest "
     "static body; default 5e-2, of a nonlinear one 1"},
    {"time", OPTION_OF_RUN, "controller_step_cuts", "n",
     "how often a controller step that does not converge, inverts an element, or loses or gains energy at contact, is cut in halves, "
     "default 4, with static bodies 10; 0: it ends the run"},
    {"time", OPTION_OF_BODY, "ts_time_step", "dt|auto",
     "substep [s], default the controller step, and auto for an explicit body that is unstable in it; auto: 0.9 of the stable step of an "
     "explicit body, made smaller to divide the controller step"},
    {"time", OPTION_OF_BODY, "ts_alpha_radius", "r", "numerical dissipation of alpha2, from 1 (none) to 0"},
    {"time", OPTION_OF_BODY, "ts_alpha_alpha_m", "a",
     "parameter alpha_m of alpha2, default 1; alpha_m and alpha_f of 0.5 make the implicit midpoint rule"},
    {"time", OPTION_OF_BODY, "ts_alpha_alpha_f", "a", "parameter alpha_f of alpha2, default 1"},
    {"time", OPTION_OF_BODY, "ts_alpha_gamma", "g", "Newmark's gamma of alpha2, default 1/2"},
    {"time", OPTION_OF_BODY, "ts_alpha_beta", "b", "Newmark's beta of alpha2, default 1/4: the trapezoidal rule"},

    {"contact", OPTION_OF_RUN, "contact_pairs", "a:b,b~c|auto|none",
     "pairs that may touch, Dirichlet side first, or, with a tilde, in the order that is better; a.xmax:b.xmin for certain surfaces, a.all "
     "for the whole boundary; a:o with an obstacle; "
     "auto: all with all; more than 100 pairs of bodies come and go as bodies are near, where -contact_facing is false, and not with "
     "-contact_type alternation"},
    {"contact", OPTION_OF_RUN, "contact_rows", "first|second",
     "which body of a pair has a contact row for each of its nodes, and takes displacements: the one named first, which is the default, or "
     "second; or a value for each pair, with commas"},
    {"contact", OPTION_OF_RUN, "contact_type", "schwarz|alternation|penalty|lagrange|augmented_lagrangian",
     "contact method, default schwarz, the contact step, where contact nodes may have mass, as in sheets and plates; "
     "alternation: displacements one way, tractions the other, as in the paper; force "
     "is "
     "another name of schwarz"},
    {"contact", OPTION_OF_RUN, "contact_law", "frictionless|tied|bonded|spring|cohesive|coulomb",
     "what surfaces do to each other, default frictionless; bonded: they stick once they have met; spring: glued by springs, cohesive: by "
     "glue that breaks, both with -contact_type schwarz; coulomb: friction"},
    {"contact", OPTION_OF_RUN, "contact_law_<pair>", "frictionless|tied|bonded|spring|cohesive|coulomb",
     "the same of one pair, which is named as in -contact_pairs; pairs of different laws need -contact_type schwarz"},
    {"contact", OPTION_OF_RUN, "contact_spring_stiffness", "k",
     "stiffness per unit of area of the springs of all pairs that have none of their own [N/m^3]"},
    {"contact", OPTION_OF_RUN, "contact_spring_stiffness_<pair>", "k", "the same of one pair, which is named as in -contact_pairs"},
    {"contact", OPTION_OF_RUN, "contact_cohesive_stiffness", "k", "stiffness of unbroken glue per unit of area [N/m^3]"},
    {"contact", OPTION_OF_RUN, "contact_cohesive_stiffness_<pair>", "k", "the same of one pair"},
    {"contact", OPTION_OF_RUN, "contact_cohesive_strength", "s",
     "the largest traction of glue that breaks, along its opening as a vector: in all modes [Pa]"},
    {"contact", OPTION_OF_RUN, "contact_cohesive_strength_<pair>", "s", "the same of one pair"},
    {"contact", OPTION_OF_RUN, "contact_cohesive_toughness", "G",
     "energy that breaking takes per unit of area, above s^2/(2 k); nothing is left of the glue at the opening 2 G/s [J/m^2]"},
    {"contact", OPTION_OF_RUN, "contact_cohesive_toughness_<pair>", "G", "the same of one pair"},
    {"contact", OPTION_OF_RUN, "contact_friction", "mu", "coefficient of friction of all pairs that have none of their own"},
    {"contact", OPTION_OF_RUN, "contact_friction_<pair>", "mu", "coefficient of friction of a pair, which is named as in -contact_pairs"},
    {"contact", OPTION_OF_RUN, "contact_friction_kinetic", "mu",
     "mu_k, what the coefficient mu_s falls to with the speed v of sliding: mu_k + (mu_s - mu_k) exp(-d v)"},
    {"contact", OPTION_OF_RUN, "contact_friction_decay", "d", "d in that [s/m]"},
    {"contact", OPTION_OF_RUN, "contact_separation", "true|false",
     "whether surfaces that have met may come apart again, default true; false, of frictionless ones under schwarz or alternation: they "
     "slide on "
     "each other, pushed or pulled"},
    {"contact", OPTION_OF_RUN, "contact_tie_distance", "d",
     "gap or overlap at the start up to which nodes are tied, in parts of a face, default 0.01; more is an error"},
    {"contact", OPTION_OF_RUN, "contact_constraint", "gap|gap_rate|both", "what contact forces keep from becoming negative, default gap"},
    {"contact", OPTION_OF_RUN, "contact_stabilization", "none|naive|contact_stabilized",
     "treatment of chatter where contact nodes have mass, default none"},
    {"contact", OPTION_OF_RUN, "contact_facing", "true|false",
     "whether pairs of whole bodies keep only the faces that see each other at the start, default true; false where bodies roll or turn"},
    {"contact", OPTION_OF_RUN, "contact_slip_bound", "s", "slip after which contact rows are built again, in parts of a face, default 0.2"},
    {"contact", OPTION_OF_RUN, "contact_angle_bound", "a",
     "turn of a contact normal after which its row is built again [rad], default 0.1"},
    {"contact", OPTION_OF_RUN, "contact_energy_tolerance", "t",
     "part of the system's energy that contact may take or bring in a controller step before it is made again in halves, default 1e-3; "
     "not with -contact_rule impulse"},
    {"contact", OPTION_OF_RUN, "contact_tolerance", "g", "depth that does not yet count as penetration [m]"},
    {"contact", OPTION_OF_RUN, "contact_allow_unstable", "true|false",
     "whether choices that are known to gain energy run all the same, default false"},
    {"contact", OPTION_OF_RUN, "contact_balance", "true|false|auto",
     "forces have the same sum along the normals of both sides, so that discs and balls without friction do not spin; default auto: where "
     "all pairs are of bodies with smooth, round surfaces, not both held, that suit it"},
    {"contact", OPTION_OF_RUN, "contact_shared_times", "true|false",
     "whether contact holds at all times that all bodies have in common, default true, or at the ends of controller steps alone"},
    {"contact", OPTION_OF_RUN, "contact_balanced_start", "true|false",
     "whether massless nodes are brought into balance in the first state, default true"},
    {"contact", OPTION_OF_RUN, "contact_energy_cap", "true|false",
     "whether steps in which contact would gain energy are made again with less force at their start, default true; not with "
     "-contact_rule impulse, where contact gains none"},
    {"contact", OPTION_OF_RUN, "contact_energy_excess", "e",
     "part of the energy that contact may gain in the whole run all the same, default 1e-3; not with -contact_rule impulse"},

    {"obstacles", OPTION_OF_RUN, "obstacles", "o,p", "names of rigid obstacles; options of obstacle o begin with -o_"},
    {"obstacles", OPTION_OF_OBSTACLE, "obstacle_type", "plane|sphere|cylinder", "shape of the obstacle"},
    {"obstacles", OPTION_OF_OBSTACLE, "point", "x,y,z", "point of the plane or of the axis, or the centre [m]"},
    {"obstacles", OPTION_OF_OBSTACLE, "normal", "x,y,z", "normal of the plane, away from what is solid"},
    {"obstacles", OPTION_OF_OBSTACLE, "axis", "x,y,z", "axis of the cylinder, default 0,0,1: a disc in 2-D"},
    {"obstacles", OPTION_OF_OBSTACLE, "radius", "r", "radius of the sphere or cylinder [m]"},
    {"obstacles", OPTION_OF_OBSTACLE, "velocity", "v,v[,v]",
     "velocity of its surface along itself, as of a belt or a turning roll, which bodies feel by friction [m/s]; formulas in x, y, z, t"},

    {"schwarz", OPTION_OF_RUN, "schwarz_snes_type", "nrichardson|anderson|ngmres|qn",
     "outer iteration, default nrichardson; with -contact_type alternation anderson"},
    {"schwarz", OPTION_OF_RUN, "schwarz_snes_atol", "a",
     "absolute tolerance on the change of position [m], default 2e-15 of the size of the smallest body, with -contact_type alternation "
     "4e-12"},
    {"schwarz", OPTION_OF_RUN, "schwarz_snes_rtol", "r",
     "relative tolerance on it, in parts of the largest way that contact makes a row go in the step, default 1e-7, 1e-9 where all bodies "
     "are linear or one is static, and 1e-13 where contact alone holds linear bodies; with -contact_type alternation 1e-15"},
    {"schwarz", OPTION_OF_RUN, "schwarz_snes_max_it", "n", "limit of outer iterations, default 50"},
    {"schwarz", OPTION_OF_RUN, "schwarz_snes_linesearch_damping", "theta", "relaxation of nrichardson, default 1"},
    {"schwarz", OPTION_OF_RUN, "schwarz_unconverged", "error|accept",
     "what to do with a controller step that does not converge, default error"},

    {"schwarz", OPTION_OF_RUN, "contact_monitor", "[ascii[:file]]",
     "a line for each pass of a contact step, and why it ended; default none"},
    {"schwarz", OPTION_OF_RUN, "contact_rule", "auto|impulse|linear",
     "how the force of a row runs within a step, and when the row is closed; impulse: constant, and its gap does not change, where contact "
     "nodes have mass; linear: from the last step's to the new one, and it has no gap at the end, where they are massless. Default auto: "
     "impulse for bodies that pairs connect and that have mass on some contact node, else linear"},
    {"schwarz", OPTION_OF_RUN, "law_snes_type", "newtonls|...", "solver of the law of all rows, default newtonls"},
    {"schwarz", OPTION_OF_RUN, "law_snes_rtol", "r",
     "its tolerance, in parts of the largest force, or of that which alone would close a row, default 1e-13"},
    {"schwarz", OPTION_OF_RUN, "law_snes_max_it", "n", "limit of its iterations, default 50; beyond, sweeps node by node help it"},
    {"schwarz", OPTION_OF_RUN, "law_nodes_snes_max_it", "n", "limit of these sweeps, default 5120; less than 5: none"},

    {"alternation", OPTION_OF_RUN, "schwarz_relaxation", "fixed|aitken", "whether nrichardson adapts its relaxation, default fixed"},
    {"alternation", OPTION_OF_RUN, "schwarz_traction", "internal|reaction",
     "nodal force handed to the Neumann side: without or with inertia, default internal"},
    {"alternation", OPTION_OF_RUN, "schwarz_traction_waveform", "linear|constant",
     "traction over the substeps of a partner that makes more of them, default linear"},
    {"alternation", OPTION_OF_RUN, "schwarz_transmission", "dirichlet_neumann|robin|impedance",
     "what is prescribed on the two sides, default dirichlet_neumann"},
    {"alternation", OPTION_OF_RUN, "schwarz_robin_parameter", "alpha",
     "stiffness of Robin conditions [N/m^3; 2-D N/m^2; 1-D N/m], default E/h of the Neumann side; of ties that of the nodes of the first "
     "side"},
    {"alternation", OPTION_OF_RUN, "schwarz_impedance_parameter", "z",
     "impedance of impedance conditions [N s/m^3; 2-D N s/m^2; 1-D N s/m], default that of plane waves in the Neumann side"},
    {"alternation", OPTION_OF_RUN, "schwarz_predictor", "last|inelastic",
     "where the first sweep of a controller step starts from, default inelastic"},
    {"alternation", OPTION_OF_RUN, "contact_swap_sides", "true|false",
     "whether Dirichlet and Neumann side change places with every controller step, default false"},

    {"penalty", OPTION_OF_RUN, "contact_penalty", "tau", "penalty parameter [N/m^3; N/m in 1-D], default from material and element size"},
    {"penalty", OPTION_OF_RUN, "contact_penalty_scale", "s",
     "that default relative to the stiffness of an element of each side in series; default 10 with massless contact nodes, else 1"},
    {"penalty", OPTION_OF_RUN, "contact_penalty_damping", "c", "damping of the gap rate [N s/m^3; N s/m in 1-D]"},

    {"lagrange", OPTION_OF_RUN, "contact_augmentation_tolerance", "g",
     "gap that the augmented Lagrangian leaves [m], default 4e-10 of the size of the smallest body"},
    {"lagrange", OPTION_OF_RUN, "contact_augmentation_max_it", "n", "limit of augmentations in a controller step, default 200"},

    {"files", OPTION_OF_RUN, "example", "[name]",
     "lists options files to start from, or writes the one with this name, with remarks; and ends"},
    {"files", OPTION_OF_RUN, "check", "true|false",
     "set-up alone: prints moments of inertia, the elements that bound explicit steps, steps and wall time to expect; of all files writes "
     "output_fields alone, with the frame of the start, and not over the fields of a run; default false"},
    {"files", OPTION_OF_RUN, "options_file", "file",
     "more options from a file, which those of the command line overrule; a FILE.opts may stand alone"},
    {"files", OPTION_OF_RUN, "units", "SI|mm-t-s|none",
     "what the numbers of the run are in: m, kg, s, N, J, Pa; or mm, t, s, N, mJ, MPa; or any consistent set. For labels, and warnings of "
     "implausible densities, moduli and sizes; default SI"},
    {"files", OPTION_OF_RUN, "output_history", "file.h5|none", "history of every controller step"},
    {"files", OPTION_OF_RUN, "output_summary", "file.json|none", "summary of the run"},
    {"files", OPTION_OF_BODY, "probe", "x,y[,z];x,y[,z]",
     "points of the undeformed body [m] whose position, displacement, velocity and stress are in the history"},
    {"files", OPTION_OF_RUN, "output_fields", "file.h5|none",
     "displacement, velocity, stress, ... of all bodies over time, with file.xdmf for ParaView; obstacles in file-obstacles.xdmf"},
    {"files", OPTION_OF_RUN, "output_fields_interval", "n",
     "a frame of fields every n controller steps, default: at most 100 frames in all"},
    {"files", OPTION_OF_RUN, "output_fields_precision", "single|double", "precision of the numbers in the frames, default single"},
    {"files", OPTION_OF_RUN, "checkpoint", "file.h5|none",
     "file that the run can be continued from; the one before it is kept as file.prev.h5"},
    {"files", OPTION_OF_RUN, "checkpoint_interval", "n", "a checkpoint every n controller steps"},
    {"files", OPTION_OF_RUN, "checkpoint_wall_interval", "t", "a checkpoint every t minutes, default 15 without -checkpoint_interval"},
    {"files", OPTION_OF_RUN, "restart", "file.h5",
     "checkpoint that the run is continued from; the run begins at its start if it is not there"},
    {"files", OPTION_OF_RUN, "restart_allow_changes", "true|false", "whether a run may be continued with other options, default false"},
    {"files", OPTION_OF_RUN, "restart_state", "file.h5",
     "checkpoint whose displacements, plastic history and velocities the bodies begin with"},
    {"files", OPTION_OF_RUN, "max_wall_time", "t|h:mm:ss",
     "minutes, or hours, minutes and seconds, after which the run ends with a checkpoint"},
    {"files", OPTION_OF_RUN, "exact", "none|impact|characteristics",
     "exact solution to compare with, of two bars by the method of characteristics, whichever name it has; default none"},
    {"files", OPTION_OF_BODY, "exact_displacement", "u[,u,u]",
     "displacement to compare with at the end of the run [m], formulas in x, y, z, t"},
    {"files", OPTION_OF_RUN, "monitor_interval", "n", "a line on the terminal every n controller steps, default 0: none"},
    {"files", OPTION_OF_RUN, "progress", "true|false",
     "progress bar on standard error, default where that is a terminal; else a line after 1, 2, 4, ... min; false: nothing"},
    {"files", OPTION_OF_RUN, "controller_view", "[viewer]", "prints times and bodies"},
    {"files", OPTION_OF_BODY, "body_view", "[viewer]", "prints mesh, material, integrator and steps of the body"},
    {"files", OPTION_OF_BODY, "material_view", "[viewer]", "prints the body's material"},
    {"files", OPTION_OF_BODY, "element_view", "[viewer]", "prints the body's elements"},
    {"files", OPTION_OF_OBSTACLE, "obstacle_view", "[viewer]", "prints shape and place of the obstacle"},
    {"files", OPTION_OF_RUN, "contact_view", "[viewer]", "prints pairs and contact method"},
    {"files", OPTION_OF_RUN, "exact_view", "[viewer]", "prints the exact solution"},
    {"files", OPTION_OF_RUN, "output_view", "[viewer]", "prints which files are written"},
};

const KnownOption *KnownOptionsGet(size_t *n)
{
  *n = PETSC_STATIC_ARRAY_LENGTH(options);
  return options;
}

const OptionTopic *OptionTopicsGet(size_t *n)
{
  *n = PETSC_STATIC_ARRAY_LENGTH(topics);
  return topics;
}
