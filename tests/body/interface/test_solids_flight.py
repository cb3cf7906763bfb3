"""Bodies that fly and spin: momentum and angular momentum are kept, energy where the integrator keeps it; a body that a load turns
inside out ends the run with a message."""

import re

import numpy as np
import pytest
from cases import long
from solidmeshes import dim_of, made_by_options

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


FLIGHTS = [("tri3", "", MIDPOINT), ("quad4", "", CENTRAL), ("tet4", "", CENTRAL), ("hex8", "", MIDPOINT), ("tri6", "", MIDPOINT), ("tet10", "", CENTRAL)]
FLIGHTS += [("quad4", "enhanced", MIDPOINT), ("hex8", "mean_dilatation", MIDPOINT), ("hex8", "reduced", CENTRAL)]
FLIGHTS += long(("quad4", "", MIDPOINT), ("hex8", "", CENTRAL), ("tet10", "", MIDPOINT), ("hex8", "enhanced", CENTRAL), ("quad4", "mean_dilatation", CENTRAL), ("quad4", "reduced", MIDPOINT))


@pytest.mark.parametrize(("shape", "formulation", "ts"), FLIGHTS)
def test_free_flight(impakt, shape, formulation, ts):
    """Nearly a turn of a body that its spin stretches. Central differences keep both momenta with lumped mass."""
    dim = dim_of(shape)
    formulated = f"-b_element_formulation {formulation}" if formulation else ""
    run = impakt(f"{COMMON} {box(shape)} {formulated} -b_initial_velocity {SPIN[dim]} {ts} -time_end 0.5")
    system, body = run.summary["system"], run.history["body/b"]
    assert system["momentum_error_max"] <= 1e-10
    assert system["angular_momentum_error_max"] <= 1e-10
    # neither keeps the energy of a nonlinear body; it comes and goes with the square of the step. Measured: 5e-5 of what it has with its flight, at most
    assert np.abs(run.history["energy/change"]).max() <= 6.5e-5 * body["kinetic"][0]
    # density times volume times v0, and the moment of inertia about the centre
    mass = 1000 * 0.3 * 0.2 * (0.2 if dim == 3 else 1)
    np.testing.assert_allclose(body["momentum"][-1], mass * np.array([2, -1, 0.5])[:dim], rtol=1e-10)
    assert body["potential"][:].max() > 0.01 * body["kinetic"][0]


@pytest.mark.parametrize(("ts", "ranks"), [("alpha2", 1), ("centraldifference", 3)])
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
