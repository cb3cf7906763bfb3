"""Bodies that fly, spin and fall: momentum and angular momentum are kept, energy where the integrator keeps it; a body that a load turns
inside out ends the run with a message."""

import re

import numpy as np
import pytest
from solidmeshes import SHAPES, dim_of, made_by_options

# A box off the origin, of soft material: 12 rad/s stretch it by some 5 %
COMMON = "-bodies b -b_density 1000 -b_youngs_modulus 2e4 -b_poissons_ratio 0.3 -b_material_type neo_hookean"


def box(shape, n=(3, 2, 2)):
    dim = dim_of(shape)
    lower, upper = [0.1, -0.2, 0.3][:dim], [0.4, 0.0, 0.5][:dim]
    return f"-b_dm_plex_dim {dim} {made_by_options(shape)} -b_dm_plex_box_faces {','.join(map(str, n[:dim]))} -b_dm_plex_box_lower {','.join(map(str, lower))} -b_dm_plex_box_upper {','.join(map(str, upper))}"


# v = v0 + omega x (r - c), about the centre c of the box
SPIN = {
    2: "2-12*(y+0.1),-1+12*(x-0.25)",
    3: "2+5*(z-0.4)-12*(y+0.1),-1+12*(x-0.25)-7*(z-0.4),0.5+7*(y+0.1)-5*(x-0.25)",
}
MIDPOINT = "-b_ts_type alpha2 -b_ts_alpha_alpha_m 0.5 -b_ts_alpha_alpha_f 0.5 -time_step 1e-3"
CENTRAL = "-b_ts_type centraldifference -time_step 1e-3"


@pytest.mark.parametrize("ts", [MIDPOINT, CENTRAL], ids=["midpoint", "central"])
@pytest.mark.parametrize("shape", list(SHAPES))
def test_free_flight(impakt, shape, ts):
    """Nearly a turn of a body that its spin stretches. Central differences keep both momenta with lumped mass."""
    dim = dim_of(shape)
    run = impakt(f"{COMMON} {box(shape)} -b_initial_velocity {SPIN[dim]} {ts} -time_end 0.5")
    system, body = run.summary["system"], run.history["body/b"]
    assert system["momentum_error_max"] <= 1e-10
    assert system["angular_momentum_error_max"] <= 1e-10
    # neither keeps the energy of a nonlinear body; it comes and goes with the square of the step. Measured: 5e-5 at most
    assert max(-system["energy_error_min"], system["energy_error_max"]) <= 6.5e-5
    # density times volume times v0, and the moment of inertia about the centre
    mass = 1000 * 0.3 * 0.2 * (0.2 if dim == 3 else 1)
    np.testing.assert_allclose(body["momentum"][-1], mass * np.array([2, -1, 0.5])[:dim], rtol=1e-10)
    assert body["potential"][:].max() > 0.01 * body["kinetic"][0]


FALLS = {"midpoint": (MIDPOINT, "neo_hookean"), "alpha2": ("-time_step 1e-3", "linear_elastic"), "central": (CENTRAL, "neo_hookean")}


@pytest.mark.parametrize("fall", list(FALLS))
@pytest.mark.parametrize("shape", list(SHAPES))
def test_fall(impakt, shape, fall):
    """A body thrown upwards in the plane of x and y falls along u = v t + g t^2 / 2, without strain; all integrators take a constant
    acceleration exactly. Gravity does the work that the kinetic energy gains. Errors are what 500 solutions leave: 5e-13 and 4e-12."""
    ts, material = FALLS[fall]
    dim = dim_of(shape)
    velocity, gravity = [2, 3, -1][:dim], [0.5, -9.81, 0.25][:dim]
    exact = ",".join(f"({v})*t+({g / 2!r})*t^2" for v, g in zip(velocity, gravity))
    options = f"-b_initial_velocity {','.join(map(str, velocity))} -b_gravity {','.join(map(str, gravity))} -b_exact_displacement {exact}"
    run = impakt(f"{COMMON} {box(shape)} -b_material_type {material} {options} {ts} -time_end 0.5")
    body, system = run.summary["bodies"]["b"], run.summary["system"]
    assert body["displacement_error"] <= 3e-12
    assert max(-system["energy_error_min"], system["energy_error_max"]) <= 1e-11
    way = np.array(velocity) * 0.5 + np.array(gravity) / 8
    assert body["external_work"] == pytest.approx(1000 * 0.3 * 0.2 * (0.2 if dim == 3 else 1) * np.array(gravity) @ way, rel=1e-11)


@pytest.mark.parametrize("ranks", [1, 3])
@pytest.mark.parametrize("ts", ["alpha2", "centraldifference"])
def test_inverted(impakt, ts, ranks):
    """Pushed by many times its stiffness: the run ends with a message that names the body, the place and the time."""
    options = "-b_boundary_displacement xmin -b_boundary_displacement_xmin 0,0,0 -b_boundary_traction xmax -b_boundary_traction_xmax -1e6*t,0,0"
    run = impakt(f"{COMMON} {box('hex8')} {options} -b_ts_type {ts} -time_step 1e-3 -time_end 1 -controller_step_cuts 0", ranks, expect_failure=True, timeout=60)
    assert 0 < run.returncode < 128
    lines = [line for line in run.stderr.splitlines() if line.startswith("impakt: error")]
    assert len(lines) == 1, run.stderr
    assert re.search(r"Body 'b': element \d+ .* around \(", lines[0])
    assert "is inverted" in lines[0]
    place = [float(x) for x in re.search(r"around \(([^)]*)\) m", lines[0])[1].split(",")]
    assert all(low < x < high for x, low, high in zip(place, (0.1, -0.2, 0.3), (0.4, 0.0, 0.5)))
    time, step = re.search(r"at time (\S+) s \(step (\d+) of", lines[0]).groups()
    assert float(time) == pytest.approx(1e-3 * int(step), rel=1e-5)
    assert 0.02 < float(time) < 0.1  # from where the traction is Young's modulus
