"""Coulomb friction: force, slip and energy against closed forms; the law node by node; what is refused."""

import numpy as np
import pytest
from cases import joined, worst_energy_error

PULSE = "-options_file options/shear-pulse.opts"
SLOPE = "-options_file options/slope.opts"
LOWER, UPPER = (f"-{body}_ts_type centraldifference" for body in ("lower", "upper"))
PAIRINGS = {"II": "", "IE": UPPER, "EI": LOWER, "EE": f"{LOWER} {UPPER}"}
G, TILT = 9.81, np.radians(30)


def frames(run, path):
    """Mean slip [m], and the largest |f_x / f_y - mu| and |f_x / f_y| of the nodes of the upper body, of the middle of the shear pulse in each frame."""
    import h5py

    with h5py.File(path) as fields:
        x, body = fields["mesh/positions"][()], np.zeros(len(fields["mesh/positions"]), int)
        body[fields["mesh/cells"][()]] = fields["mesh/body"][()][:, None]
        middle = (np.abs(x[:, 1]) < 1e-9) & (np.abs(x[:, 0]) < 0.25)
        slips, ratios = [], []
        for frame in range(len(fields["time"])):
            u, force = fields[f"displacement/{frame:04d}"][()], fields[f"contact_force/{frame:04d}"][()]
            slips.append(u[middle & (body == 1), 0].mean() - u[middle & (body == 0), 0].mean())
            with np.errstate(invalid="ignore"):
                ratios.append(np.abs(force[middle & (body == 1), 0] / force[middle & (body == 1), 1]))
        return fields["time"][()], np.array(slips), np.array(ratios)


def pulse(impakt, options=""):
    run = impakt(joined(PULSE, "-output_fields fields.h5 -output_fields_interval 1 -output_fields_precision double", options))
    return run, *frames(run, run.folder / "fields.h5")


@pytest.mark.parametrize("pairing", [pytest.param(name, marks=() if name in ("II", "EE") else pytest.mark.long) for name in PAIRINGS])
def test_shear_pulse(pairing, impakt):
    run, time, slip, ratio = pulse(impakt, PAIRINGS[pairing])
    late = time > 5e-4  # the whole pulse has come in
    exact = 2 * (0.06 - 3e4 / (1000 * np.sqrt(5e8 / 1000)))
    assert np.abs(ratio[late] / 0.3 - 1).max() <= 1e-8  # each node has the force of the law: measured 4e-16
    rate = np.polyfit(time[late], slip[late], 1)[0]
    assert rate == pytest.approx(exact, rel=5e-3)  # measured: 3e-3 of dispersion with elements of 6 mm
    assert worst_energy_error(run.summary) <= (1e-9 if pairing == "II" else 1e-4)  # measured: 5e-15 in all
    assert run.summary["schwarz"]["max"] <= 4  # measured: 2
    contact = run.summary["contact"]
    assert contact["friction_least"] >= -1e-12  # of 13.6 J
    assert contact["friction_residual"] <= 1e-15  # [m], measured: 4e-19
    assert 0.5 < contact["friction_loss"] < 0.7  # 3e4 Pa times what the middle slides, over 2 m: 0.61 J


def test_shear_pulse_sticks(impakt):
    """Z v < mu p, from both sides: nothing slips in the middle."""
    run, time, slip, ratio = pulse(impakt, '-lower_initial_velocity -0.03*(1-exp(-(10*y)^2)),0 -upper_initial_velocity 0.03*(1-exp(-(10*y)^2)),0')
    assert np.abs(slip).max() <= 1e-6 * 0.06 * 6e-4  # means over nodes at other places, of what comes from the edges: measured 1e-7
    assert ratio[time > 5e-4].mean() == pytest.approx(0.03 * 1000 * np.sqrt(5e5) / 1e5, rel=5e-3)  # measured: 1e-3
    assert worst_energy_error(run.summary) <= 1e-9


@pytest.mark.parametrize("options", ["", "-contact_rows second", "-contact_type lagrange"])
def test_block_slides(options, impakt):
    run = impakt(joined(SLOPE, options))
    time, speed = run.history["time"][()], run.history["body/block/mean_velocity"][:, 0]
    late = time >= 0.1
    assert np.polyfit(time[late], speed[late], 1)[0] == pytest.approx(G * (np.sin(TILT) - 0.3 * np.cos(TILT)), rel=1e-3)  # measured: 2e-5
    (name,) = run.history["contact"]
    force = run.history[f"contact/{name}/force_vector"][-1]
    assert force[0] / force[1] == pytest.approx(-0.3, rel=1e-4)  # measured: 5e-6, of rows that follow the bent surface
    assert worst_energy_error(run.summary) <= 1e-5


def test_block_sticks(impakt):
    """tan 30 < 0.6: without creep once the loads have come and their waves are damped, for a second."""
    run = impakt(joined(SLOPE, "-contact_friction 0.6 -time_end 1.5"))
    time, position = run.history["time"][()], run.history["body/block/contact_position"][:, 0]
    late = time >= 0.5
    assert np.ptp(position[late]) <= 1e-9 * 0.4
    (name,) = run.history["contact"]
    assert run.history[f"contact/{name}/sliding"][-1] == 0


def test_block_on_tilted_obstacle(impakt):
    """The same on a rigid plane that is tilted itself."""
    run = impakt(
        "-bodies block -obstacles ground -ground_obstacle_type plane -ground_point 0,0 -ground_normal 0,1 -contact_law coulomb "
        "-contact_friction 0.3 -time_end 0.2 -time_step 1e-3 -block_dm_plex_dim 2 -block_dm_plex_box_lower -0.2,0 -block_dm_plex_box_upper 0.2,0.1 "
        "-block_dm_plex_box_faces 8,2 -block_density 1000 -block_youngs_modulus 1e8 -block_poissons_ratio 0.25 -block_damping_stiffness 1e-2 "
        "-block_body_force 4905*sin(pi*min(0.5,10*t))^2,-8495.709211125343*sin(pi*min(0.5,10*t))^2"
    )
    time, speed = run.history["time"][()], run.history["body/block/mean_velocity"][:, 0]
    late = time >= 0.1
    assert np.polyfit(time[late], speed[late], 1)[0] == pytest.approx(G * (np.sin(TILT) - 0.3 * np.cos(TILT)), rel=1e-3)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("-contact_friction -0.1", "must not be negative"),
        ("-contact_friction_kinetic 0.4 -contact_friction_decay 1", "is above the coefficient"),
        ("-contact_friction_kinetic 0.2", "go together"),
        ("-contact_type penalty", "has no friction"),
        ("-contact_type augmented_lagrangian", "has no friction"),
        ("-block_mass_redistribute false", "massless contact nodes"),
        ("-contact_law sticky", "sticky"),
    ],
)
def test_refused(options, message, impakt):
    assert message in impakt(joined(SLOPE, options), expect_failure=True).stderr


def test_missing_coefficient(impakt):
    words = "-bodies a,b -contact_law coulomb -a_dm_plex_dim 2 -b_dm_plex_dim 2 -b_dm_plex_box_lower 1.1,0 -b_dm_plex_box_upper 2,1"
    words += " -time_end 1e-3 -time_step 1e-3 -a_density 1 -b_density 1 -a_youngs_modulus 1 -b_youngs_modulus 1"
    assert "needs the coefficient of friction of the pair " in impakt(words, expect_failure=True).stderr
