"""Two bars of one element across meet head on: quadrilaterals and hexahedra give the figures of bars in one dimension.

Poisson's ratio is 0, the surfaces are named, and their nodes match. Other contact of solids is not tested yet.
"""

import pytest

pytest_plugins = "shared_runs"

TIMES = "-time_start -2e-4 -time_end 8e-4 -time_step 2e-6"
SHAPES = {
    "bar2": "-{b}_dm_plex_dim 1 -{b}_dm_plex_box_faces 25 -{b}_dm_plex_box_lower {low} -{b}_dm_plex_box_upper {high} -{b}_cross_section 1e-4 -{b}_initial_velocity {v}",
    "quad4": "-{b}_dm_plex_dim 2 -{b}_dm_plex_box_faces 25,1 -{b}_dm_plex_box_lower {low},0 -{b}_dm_plex_box_upper {high},0.01 -{b}_thickness 0.01 -{b}_initial_velocity {v},0",
    "hex8": "-{b}_dm_plex_dim 3 -{b}_dm_plex_box_faces 25,1,1 -{b}_dm_plex_box_lower {low},0,0 -{b}_dm_plex_box_upper {high},0.01,0.01 -{b}_initial_velocity {v},0,0",
}
BODIES = (("l", -0.27, -0.02, 100), ("r", 0.02, 0.27, -100))
INTEGRATORS = {"implicit": "", "explicit": "-l_ts_type centraldifference -r_ts_type centraldifference -l_mass_type lumped -r_mass_type lumped"}


def options(shape, more):
    bodies = [SHAPES[shape].format(b=b, low=low, high=high, v=v) + f" -{b}_density 1000 -{b}_youngs_modulus 1e9" for b, low, high, v in BODIES]
    return " ".join(["-bodies l,r -contact_pairs l.xmax:r.xmin", TIMES, *bodies, more])


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("shape", ["quad4", "hex8"])
def test_impact(shape, integrator, shared_run):
    """To 1e-9: the outer iteration stops at 1e-12 m, of displacements of 1e-2 m."""
    bars, solids = (shared_run(options(each, INTEGRATORS[integrator])).summary for each in ("bar2", shape))
    for name in ("release_time", "onsets", "force_mean", "impulse"):
        assert solids["contact"][name] == pytest.approx(bars["contact"][name], rel=1e-9), name
    assert bars["contact"]["onsets"] == 1 and bars["contact"]["impulse"] == pytest.approx(5, rel=0.02)  # rho A c v over two passages; 25 elements lose 1.1 %
    for name in ("kinetic", "potential", "peak_potential"):
        assert solids["bodies"]["l"][name] == pytest.approx(bars["bodies"]["l"][name], rel=1e-7), name
    assert solids["system"]["momentum_error_max"] <= 1e-10
