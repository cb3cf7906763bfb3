"""The lines of -monitor_interval and the table that a run ends with."""

import math
import re

import numpy as np
import pytest
from conftest import IMPAKT

# A block of 2 m^3 and 2000 kg that falls for 0.1 s: its energy is the work of its weight, 2000 kg x 13^2 m^2/s^4 x t^2 / 2
FALL = (
    "-bodies block -block_dm_plex_dim 3 -block_dm_plex_simplex 0 -block_dm_plex_box_faces 2,1,1 -block_dm_plex_box_upper 2,1,1 -block_density 1000 "
    "-block_youngs_modulus 1e9 -time_end 0.1 -time_step 1e-3"
)
PULLED = (
    "-bodies bar -bar_dm_plex_dim 2 -bar_dm_plex_simplex 0 -bar_dm_plex_box_faces 4,2 -bar_dm_plex_box_upper 2,1 -bar_density 1000 -bar_youngs_modulus 1e9 "
    "-bar_plane_stress -bar_ts_type static -bar_boundary_displacement xmin -bar_boundary_displacement_xmin 0,0 -bar_boundary_traction xmax "
    "-bar_boundary_traction_xmax 1e6,0"
)


def energy_errors(run):
    return [float(text) for text in re.findall(r"^step .*energy error +(\S+)", run.stdout, re.MULTILINE)]


def value(run, name):
    return float(re.search(rf"^ +{re.escape(name)} +(\S+)", run.stdout, re.MULTILINE).group(1))


@pytest.mark.parametrize("start", ["", "-block_initial_velocity 1,0,0"])
def test_monitor_counts_the_work_of_loads(start, impakt):
    """From rest and from 1 m/s: the block gains as much as its weight does work, up to the round-off of 100 steps, and the line says what the summary has."""
    run = impakt(f"{FALL} {start} -block_gravity 3,4,-12 -monitor_interval 50")
    errors = energy_errors(run)
    assert len(errors) == 3
    assert max(map(abs, errors)) <= 1e-11
    assert errors[-1] == pytest.approx(run.summary["system"]["energy_error_final"], rel=1e-3, abs=1e-300)


@pytest.mark.parametrize("step", [0.25, 1])
def test_sudden_load_of_a_static_body(step, impakt):
    """The load that is there from t = 0 on does half of its force times way, as much as the body stores. It did all of it in the first step before, which
    was an error of -33 %."""
    run = impakt(f"{PULLED} -time_end 1 -time_step {step}")
    body = run.summary["bodies"]["bar"]
    assert body["external_work"] == pytest.approx(body["potential"], rel=1e-12)
    assert abs(run.summary["system"]["energy_error_min"]) <= 1e-12
    assert not run.stderr


def test_momenta_in_the_table(impakt):
    """Two blocks that hit each other: both momenta; bars have no angular momentum."""
    run = impakt("-options_file options/blocks.opts -time_end 1e-4")
    assert value(run, "angular momentum error, worst") == pytest.approx(100 * run.summary["system"]["angular_momentum_error_max"], rel=1e-5)
    assert value(run, "momentum error, worst") == pytest.approx(100 * run.summary["system"]["momentum_error_max"], rel=1e-5)
    bars = impakt("-options_file options/impact-high-speed.opts -time_end -1.9e-4")
    assert "angular momentum" not in bars.stdout


def test_tension_and_nodes_of_ties(impakt):
    """A bar of two tied blocks is pulled with 1 MPa x 1 m^2 at rest: the middle node of the three of the interface has half of it. Three nodes with two
    rows each are three nodes."""
    half = "-dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 2,2 -density 1000 -youngs_modulus 1e9 -ts_type static"
    left = f"-prefix_push left_ {half} -dm_plex_box_upper 1,1 -boundary_displacement xmin -boundary_displacement_xmin 0,0 -prefix_pop"
    right = f"-prefix_push right_ {half} -dm_plex_box_lower 1,0 -dm_plex_box_upper 2,1 -boundary_traction xmax -boundary_traction_xmax 1e6,0 -prefix_pop"
    run = impakt(f"-bodies left,right {left} {right} -contact_pairs left.xmax:right.xmin -contact_law tied -time_end 1 -time_step 1")
    assert ", 3 contact nodes" in run.stdout
    pair = run.summary["pairs"]["left.xmax:right.xmin"]
    assert pair["tension_max"] == pytest.approx(5e5, rel=1e-9)  # no shear, by symmetry, at the middle, and nu = 0 elsewhere
    assert value(run, "tension of a node, peak") == pytest.approx(pair["tension_max"], rel=1e-5)
    assert not re.search(r"^ +impulse", run.stdout, re.MULTILINE)  # nothing has inertia


# A block that falls by 1 cm on a floor, without inertia: nothing stores the work of its weight
FLOATING = (
    "-bodies block -obstacles floor -floor_obstacle_type plane -floor_point 0,0 -floor_normal 0,1 -contact_pairs block.ymin:floor -block_dm_plex_box_faces 3,3 "
    "-block_dm_plex_box_lower 0,0.01 -block_dm_plex_box_upper 1,1.01 -block_density 1000 -block_youngs_modulus 1e9 -block_gravity 0,-10 -time_end 1"
)


def verdict(run):
    """The first line of the table: behind those of the set-up, before all others."""
    lines = [line for line in run.stdout.splitlines() if not line.startswith("step ")]
    found = [i for i, line in enumerate(lines) if re.match(r"(finished|stopped)\b", line)]
    assert len(found) == 1
    assert lines[found[0] + 1].startswith(("contact", "energy"))
    return lines[found[0]]


def forces(run, pair, name):
    """Sum along normals, and resultant where there is one."""
    block = run.stdout.split("\ncontact forces ")[1].split(f"\n  {pair}\n")[1]
    line = re.search(rf"^    {name} +(.*)$", block, re.MULTILINE).group(1)
    return [float(text) for text in re.findall(r"(\S+) N\b", line)]


@pytest.mark.parametrize("ranks", [1, 3])
def test_verdict(ranks, impakt):
    """Of a run that is as it should be, of one with two warnings, which stand on standard error and in the summary, and of one that is ended before its end."""
    good = impakt("-options_file options/blocks.opts -time_end 1e-4", ranks)
    worst = 100 * good.summary["system"]["energy_error_min"]
    found = re.fullmatch(r"finished: 100 steps, energy error (\S+) %, nothing to warn of in its figures", verdict(good))
    assert float(found[1]) == pytest.approx(worst, rel=0.05, abs=1e-9)
    bad = impakt("-options_file options/blocks.opts -time_end 1e-4 -left_density 1e9 -right_density 1e9 -left_youngs_modulus 1e15 -right_youngs_modulus 1e15", ranks)
    assert len(bad.summary["warnings"]) == 2
    assert verdict(bad).startswith("finished with 2 warnings, see below: 100 steps, energy error ")
    stopped = impakt("-options_file options/blocks.opts -max_wall_time 0:00:00.2 -time_step 1e-8", ranks, expect_failure=True)
    assert re.match(r"stopped: \d+ of 60000 steps, ", verdict(stopped))


def test_resultants_apart_from_sums_along_normals(shared_run):
    """A band half round a drum, drawn by P and held by P exp(mu pi): what its ends bear is the resultant, P (1 + exp(mu pi)) = 3566 N, and friction bears the
    difference with mu times the sum along the normals, P (exp(mu pi) - 1) / mu = 5220 N; both to half a thousandth of half the band's thickness, h/2 = R/1000."""
    run = shared_run("-options_file options/capstan.opts")
    ratio = math.exp(0.3 * math.pi)
    along, resultant = forces(run, "band.inside:drum", "at the end")
    assert along == pytest.approx(1e3 * (ratio - 1) / 0.3, rel=2e-3)
    assert resultant == pytest.approx(1e3 * (1 + ratio), rel=2e-3)
    assert re.search(r"^contact forces +sum along normals +resultant$", run.stdout, re.MULTILINE)
    pair = run.summary["pairs"]["band.inside:drum"]
    assert [pair["force_peak"], pair["resultant_peak"]] == pytest.approx(forces(run, "band.inside:drum", "peak"), rel=1e-5)
    assert [pair["force_final"], math.hypot(*pair["resultant"])] == pytest.approx([along, resultant], rel=1e-5)
    np.testing.assert_array_equal(pair["resultant"], run.history["contact/band.inside:drum/force_vector"][-1])


def test_mean_resultant(shared_run):
    """Of bars it is the force, in each step."""
    run = shared_run("-options_file options/impact-high-speed.opts")
    assert run.summary["contact"]["resultant_mean"] == pytest.approx(run.summary["contact"]["force_mean"], rel=1e-12)
    assert forces(run, "left:right", "mean") == pytest.approx([run.summary["contact"]["force_mean"]] * 2, rel=1e-5)
    assert re.search(r"^    mean .* N  exact 100$", run.stdout, re.MULTILINE)


def test_peak_at_first_touch(shared_run):
    """Forward increments stop the mass of contact nodes in the first step: a line says so, with the step and the mean. In half the step the peak is twice as
    large, and the mean the same, as the line says. Without such a peak there is no such line."""
    told = r"^    the peak is that of step 1 of a contact, (\S+) times the mean of (\S+) N: it depends on the step"
    whole, half = (shared_run(f"-options_file options/impact-lagrange.opts -time_step {step}") for step in (1e-7, 5e-8))
    (factor, mean), (factor_of_half, mean_of_half) = (map(float, re.search(told, run.stdout, re.MULTILINE).groups()) for run in (whole, half))
    assert factor == pytest.approx(whole.summary["contact"]["force_peak"] / whole.summary["contact"]["force_mean"], rel=1e-2)
    assert factor_of_half == pytest.approx(2 * factor, rel=0.01)
    assert mean_of_half == pytest.approx(mean, rel=1e-3)
    assert "the peak is that" not in shared_run("-options_file options/impact-high-speed.opts").stdout


@pytest.mark.parametrize("ranks", [1, 3])
def test_statics(ranks, impakt):
    """Neither what has no meaning without inertia, nor energy errors of a body that contact alone holds: it loses the work of its weight in the gap, -100 % here. The
    same block with inertia has all of it."""
    run = impakt(f"{FLOATING} -block_ts_type static -time_step 0.25 -monitor_interval 1", ranks)
    assert run.summary["system"]["energy_error_min"] < -0.9
    assert not run.stderr and not run.summary["warnings"]
    assert verdict(run) == "finished: 4 steps, nothing to warn of in its figures"
    table = run.stdout.split("\nfinished")[1]
    dynamic = ("kinetic", "momentum", "energy error", "impulse", "first contact", "release", "onsets", "mean  ", "standard deviation")
    assert not [word for word in dynamic if word in table]
    assert "energy error" not in run.stdout
    assert re.search(r"^  steps in contact +4 of 4$", table, re.MULTILINE)
    moving = impakt(f"{FLOATING} -time_step 1e-4 -time_end 0.1", ranks).stdout.split("\nfinished")[1]
    assert not [word for word in dynamic if word not in moving and word != "momentum"]


def test_statics_that_touch_late(impakt):
    """Where contact begins amid the load steps, the load at which it does means something."""
    run = impakt(f"{FLOATING} -block_ts_type static -time_step 0.25 -block_gravity 0,0 -block_boundary_displacement ymax -block_boundary_displacement_ymax 0,-0.02*t")
    assert value(run, "first contact") == pytest.approx(0.5, rel=1e-6)
    assert "still in contact" in run.stdout


def test_energy_error_of_statics(impakt):
    """Held bodies balance, and the error is told."""
    run = impakt(f"{PULLED} -time_end 1 -time_step 1")
    assert value(run, "system energy error, final") == pytest.approx(100 * run.summary["system"]["energy_error_final"], abs=1e-9)


def test_what_is_not_written(launch, tmp_path):
    """A run without files says so in one line, with the options; one file is enough for the line to be gone."""
    words = f"{PULLED} -time_end 1 -time_step 1".split()
    told = re.findall(r"^not written: .*$", launch([IMPAKT, *words], cwd=tmp_path).stdout, re.MULTILINE)
    assert len(told) == 1
    options = re.findall(r"(-output_\w+) (\S+\.\w+)", told[0])
    assert [option for option, _ in options] == ["-output_history", "-output_summary", "-output_fields"]
    assert not list(tmp_path.iterdir())
    assert re.search(r"^files\n  checkpoint +c.h5\nnot written: ", launch([IMPAKT, *words, "-checkpoint", "c.h5"], cwd=tmp_path).stdout, re.MULTILINE)
    for option, path in options:
        assert "not written" not in launch([IMPAKT, *words, option, path], cwd=tmp_path).stdout
        assert (tmp_path / path).is_file()
