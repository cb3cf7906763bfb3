"""Each warning that gives advice: a run that provokes it, and the same run with the advice followed, in which the figure that was wrong is better and the warning gone.
Advice on moments of inertia is followed in test_mass_moments.py, on nodes beyond the end of the partner in test_overhang.py, on elements that lock in
test_formulations.py and test_composite.py, on corners in test_sharp_corner.py."""

import math

import pytest
from cases import joined, worst_energy_error

BLOCKS = "-options_file options/blocks.opts -controller_step_cuts 0"
COARSE = f"{BLOCKS} -time_step 1e-4 -time_end 3e-3 -contact_energy_cap false -energy_guard 0"
UNEQUAL = f"{BLOCKS} -contact_pairs left:right -time_step 1e-4 -time_end 1e-3 -schwarz_transmission robin -left_ts_time_step 5e-5 -contact_allow_unstable true"
SLIDING = "-options_file options/sliding-flat.opts -time_end 0.3"
# The mass of a bar is 1e-19 of its stiffness times the square of the step
STIFF = "-options_file options/impact-high-speed.opts -exact none -left_youngs_modulus 1e26 -energy_guard 0 -time_end -1.9999e-4"
TWO = "-a_dm_plex_dim 2 -b_dm_plex_dim 2 -a_density 1000 -b_density 1000"
# A square hits another one off its centre, so that both turn by 0.9 rad
TURNING = (
    f"-bodies a,b -contact_pairs a:b {TWO} -a_dm_plex_box_faces 6,6 -b_dm_plex_box_faces 5,5 -a_youngs_modulus 1e7 -b_youngs_modulus 1e7 -b_translate 1.01,0.6 "
    "-a_initial_velocity 5,0 -time_step 2e-4 -time_end 0.2"
)
NONLINEAR = "-a_material_type neo_hookean -b_material_type neo_hookean"
# A block pressed on another one, both of which are turned by 0.05 rad in ten load steps; friction of 0.3
ANGLE, FRICTION, STEPS = 0.05, 0.3, 10
TURN = f"x*(cos({ANGLE}*t)-1)-y*sin({ANGLE}*t){{}},x*sin({ANGLE}*t)+y*(cos({ANGLE}*t)-1){{}}"
TILTED = (
    f"-bodies a,b -contact_pairs a.ymin:b.ymax -contact_law coulomb -contact_friction {FRICTION} -time_step {1 / STEPS} -time_end 1 {TWO} "
    "-a_dm_plex_box_lower 0.3,0 -a_dm_plex_box_upper 0.7,0.2 -a_dm_plex_box_faces 5,2 -b_dm_plex_box_lower 0,-0.2 -b_dm_plex_box_upper 1,0 -b_dm_plex_box_faces 10,2 "
    "-a_youngs_modulus 1e9 -b_youngs_modulus 1e9 -a_ts_type static -b_ts_type static -a_boundary_displacement ymax -b_boundary_displacement ymin "
    f"-b_boundary_displacement_ymin {TURN.format('', '')} "
    f"-a_boundary_displacement_ymax {TURN.format(f'+2e-4*min(1,5*t)*sin({ANGLE}*t)', f'-2e-4*min(1,5*t)*cos({ANGLE}*t)')}"
)
# Two squares hit each other with their whole faces, and nodes with mass
FLAT = (
    "-bodies left,right -all_density 1000 -all_youngs_modulus 1e9 -left_dm_plex_box_faces 8,4 -right_dm_plex_box_faces 6,3 -right_translate 1.005,0 "
    "-left_initial_velocity 20,0 -time_step 2e-5 -time_end 6e-4 -all_mass_redistribute false"
)
# A square of 0.2 m falls on a plate that is two layers of triangles thick
PLATE = (
    f"-bodies a,b -contact_pairs a:b {TWO} -a_dm_plex_simplex -a_dm_plex_box_faces 16,2 -a_dm_plex_box_upper 2,0.1 -b_dm_plex_box_lower 0.9,0.1001 -b_dm_plex_box_upper 1.1,0.3 "
    "-b_dm_plex_box_faces 4,4 -a_youngs_modulus 1e9 -b_youngs_modulus 1e9 -b_initial_velocity 0,-5 -time_step 1e-5 -time_end 1e-4"
)
ALPHA = "-options_file options/blocks.opts -time_step 1e-5 -left_ts_alpha_radius 0.6"
BALL = (
    "-bodies a -a_dm_plex_shape ball -a_dm_plex_dim 3 -a_density 1000 -a_youngs_modulus 1e9 -a_initial_velocity 1,0,0 -time_step 1e-6 -time_end 1e-6 "
    "-a_ball_divisions 4 -a_ball_grading 256"
)
# The halves of a square fly into each other faster than waves do
CRUSHED = (
    "-bodies b -b_density 1000 -b_youngs_modulus 1e7 -b_poissons_ratio 0.3 -b_dm_plex_dim 2 -b_dm_plex_box_faces 8,8 -b_initial_velocity 120*(1-2*(x>0.5)),0 "
    "-time_step 2e-5 -time_end 3e-3"
)


# A bar that is stretched by a third of its length in one load step, over which its force bends from a straight line
STRETCHED = (
    "-bodies a -a_dm_plex_box_faces 4,2 -a_dm_plex_box_upper 2,1 -a_density 1000 -a_youngs_modulus 1e9 -a_material_type neo_hookean -a_ts_type static "
    "-a_boundary_displacement xmin -a_boundary_displacement_xmin 0,0 -a_boundary_traction xmax -a_boundary_traction_xmax 4e8*t,0 -time_step 1 -time_end 1"
)


# A steel block slides over a base after it has fallen on it, in ten times the step that resolves that
SLAP = (
    "-units mm-t-s -bodies a,b -all_density 7.85e-9 -all_youngs_modulus 210e3 -all_poissons_ratio 0.3 -a_dm_plex_box_faces 10,10 -a_dm_plex_box_upper 50,50 "
    "-a_translate 0,0.3 -a_initial_velocity 1000,-626 -b_dm_plex_box_faces 20,4 -b_dm_plex_box_lower -50,-20 -b_dm_plex_box_upper 150,0 -b_boundary_displacement ymin "
    "-b_boundary_displacement_ymin 0,0 -contact_law coulomb -contact_friction 0.3 -time_step 1e-5 -time_end 8e-4 -controller_step_cuts 2"
)


def energy(run):
    return worst_energy_error(run.summary)


def system(name):
    return lambda run: run.summary["system"][f"{name}_error_max"]


def contact(name):
    return lambda run: run.summary["contact"][name]


def centre_shift(run):
    return max(abs(value) for value in run.summary["bodies"]["a"]["mass"]["centre_shift"])


def missing(run):
    """Of a ball's volume."""
    return 1 - run.summary["bodies"]["a"]["mass"]["total"] / (4000 / 3 * math.pi)


# What provokes a warning, words of it, the advice, the figure, and that figure before (at least) and after (at most); those measured behind
CASES = {
    "step": (COARSE, "-time_step auto", "-time_step auto", energy, 0.1, 5e-3),  # 0.17, 2.9e-3
    "much too large a step": (COARSE, "18 times the 5.67e-06 s that resolve contact", "-time_step auto", energy, 0.1, 5e-3),
    "load steps": ("-options_file options/hertz-sphere-axisymmetric.opts", "smaller -time_step", "-time_step 0.125", energy, 0.05, 1e-2),  # 0.063, 4.6e-3
    "sliding": (SLIDING, "together with a smaller -contact_slip_bound", "-time_step 1e-3 -contact_slip_bound 0.01", energy, 0.02, 6e-3),  # 0.022, 5.0e-3
    "energy of nodes with mass": ("-options_file options/impact-low-speed.opts", "massless contact nodes", "-left_mass_redistribute true -right_mass_redistribute true", energy, 0.03, 3e-3),  # 0.032, 2.3e-3
    "energy that a rule takes": (FLAT, "finer elements lose less", "-left_dm_plex_box_faces 32,16 -right_dm_plex_box_faces 24,12", energy, 0.05, 0.02),  # 5.9e-2, 1.8e-2
    "energy of nodes with mass, by a rule": (FLAT, "massless contact nodes", "-all_mass_redistribute true", energy, 0.05, 2e-3),  # 5.9e-2, 6.8e-4
    "momentum of nodes with mass": (f"{BLOCKS} -contact_type alternation -left_mass_redistribute false -right_mass_redistribute false", "massless contact nodes", "-left_mass_redistribute true -right_mass_redistribute true", system("momentum"), 5e-3, 1e-12),  # 9.8e-3, 1.6e-14
    "unequal substeps": (UNEQUAL, "choose equal substeps, or leave -schwarz_transmission out", "-left_ts_time_step 1e-4 -schwarz_snes_atol 1e-15", system("momentum"), 0.1, 1e-12),  # 0.19, 8e-14; the outer iteration leaves up to 1.5e-11 at its default, another part on each processor
    "round-off, step": (f"{STIFF} -time_step 1e-7 -time_end -1.999e-4", "smaller -time_step", "-time_step 1e-9 -time_end -1.9999e-4", system("momentum"), 0.05, 1e-4),  # 0.063, 1.5e-5
    "round-off, units": (f"{STIFF} -time_step 1e-7 -time_end -1.999e-4", "check units", "-left_youngs_modulus 1e9", system("momentum"), 0.05, 1e-12),
    "linear bodies that turn": (TURNING, "less with nonlinear materials", f"{NONLINEAR} -contact_slip_bound 0.02", system("angular_momentum"), 0.5, 1e-3),  # 0.55, 1.3e-4
    "bodies that turn, step": (f"{TURNING} {NONLINEAR} -time_step 2e-3", "and with a smaller -time_step", "-time_step 2e-4", system("angular_momentum"), 1.5e-3, 1e-4),  # 2.5e-3, 3.1e-5
    # angle beside coefficient of friction: all of it where rows are as old as the run, that of a step where they are not
    "tilt": (f"{TILTED} {NONLINEAR}", "smaller -contact_angle_bound", "-contact_angle_bound 1e-4", contact("friction_tilt"), 0.999 * ANGLE / FRICTION, 1.001 * ANGLE / STEPS / FRICTION),
    "tilt of linear bodies": (TILTED, "take materials that are not linear", f"{NONLINEAR} -contact_angle_bound 1e-4", contact("friction_tilt"), 1.9 * ANGLE / FRICTION, 1.001 * ANGLE / STEPS / FRICTION),
    "centre of mass": (f"{PLATE} -a_mass_redistribute true", "refine it across", "-a_dm_plex_box_faces 16,4", centre_shift, 5e-3, 1e-12),  # 6.4e-3 m, 0
    "mass of a plate": (f"{PLATE} -a_mass_redistribute true", "set -a_mass_redistribute auto", "-a_mass_redistribute auto", centre_shift, 5e-3, 1e-12),  # the same
    "never touched": (f"{PLATE} -time_end 1e-5", "pair a:b never touched: its smallest gap was 5e-05 m", "-time_end 1e-4", lambda run: run.summary["pairs"]["a:b"]["gap_min"], 4.99e-5, 1e-10),
    "stretched in a load step": (STRETCHED, "a smaller -time_step makes it less", "-time_step 0.1", energy, 0.04, 6e-4),  # 5.0e-2, 4.9e-4: the square of the step
    "lossy steps, step": (SLAP, "than -contact_energy_tolerance after the last cut, to 2.5e-06 s; a smaller -time_step", "-time_step 1e-6", energy, 0.01, 2e-3),  # 1.6e-2, 5.5e-4
    "lossy steps, cuts": (SLAP, "or more -controller_step_cuts, makes it less", "-controller_step_cuts 8", energy, 0.01, 2e-3),  # 1.6e-2, 3.1e-4
    "alpha": (ALPHA, "give both bodies the same parameters", "-right_ts_alpha_radius 0.6", system("momentum"), 4e-4, 1e-12),  # 5.4e-4, 1.2e-15
    "inside out": (CRUSHED, "set -b_material_type neo_hookean", "-b_material_type neo_hookean", lambda run: run.summary["bodies"]["b"]["inverted_max"], 8, 0),
    "divisions of a ball": (BALL, "take more -a_ball_divisions", "-a_ball_divisions 12", missing, 0.8, 1e-12),  # 0.89, 0
    "grading of a ball": (BALL, "a weaker -a_ball_grading", "-a_ball_grading 16", missing, 0.8, 1e-12),
}


@pytest.mark.parametrize("name", CASES)
def test_advice_helps(name, shared_run):
    options, words, advice, figure, before, after = CASES[name]
    run, better = shared_run(options), shared_run(joined(options, advice))
    assert words in run.stderr
    assert words not in better.stderr
    assert figure(run) >= before
    assert figure(better) <= after
