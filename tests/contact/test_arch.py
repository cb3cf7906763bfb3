"""A semicircular arch of blocks under its weight: it stands where limit analysis finds an equilibrium, and falls where there is none."""

import numpy as np
import pytest
from arch_limit import least_friction, least_thickness
from cases import joined, long

ARCH = "-options_file options/arch.opts"
BLOCKS, FACETS = 20, 4
BODIES = [f"b{i}" for i in range(1, BLOCKS + 1)]
DYNAMIC = " ".join(f"-{body}_ts_type alpha2 -{body}_damping_stiffness 1e-3" for body in BODIES) + " -time_step 2e-3 -time_end 0.4"
NO_REST = ("neither contact nor ties hold it", "have not come to rest", "No forces were found")


def voussoir(path, thickness, high=4):
    """A wedge at the crown of an arch of mean radius 1, which bodies turn to their places, as Gmsh 2.2; groups: left, right, block."""
    angles = np.linspace(np.pi / BLOCKS / 2, -np.pi / BLOCKS / 2, FACETS + 1)
    points = [(-r * np.sin(x), r * np.cos(x)) for r in np.linspace(1 - thickness / 2, 1 + thickness / 2, high + 1) for x in angles]
    row = FACETS + 1
    cells = [(1, 1, (j * row + 1, (j + 1) * row + 1)) for j in range(high)] + [(1, 2, (j * row + row, (j + 1) * row + row)) for j in range(high)]
    cells += [(3, 3, (j * row + i + 1, j * row + i + 2, (j + 1) * row + i + 2, (j + 1) * row + i + 1)) for j in range(high) for i in range(FACETS)]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "3", '1 1 "left"', '1 2 "right"', '2 3 "block"', "$EndPhysicalNames"]
    lines += ["$Nodes", str(len(points))] + [f"{k} {x:.16e} {y:.16e} 0" for k, (x, y) in enumerate(points, 1)] + ["$EndNodes"]
    lines += ["$Elements", str(len(cells))] + [f"{k} {kind} 2 {group} {group} {' '.join(map(str, at))}" for k, (kind, group, at) in enumerate(cells, 1)]
    path.write_text("\n".join(lines) + "\n$EndElements\n")
    return " ".join(f"-{body}_dm_plex_filename {path}" for body in BODIES)


@pytest.fixture
def stands(impakt, tmp_path):
    """stands(thickness, friction) or stands(..., False): that statics finds forces that hold the arch, or says that there are none."""

    def check(thickness, friction, expected=True, high=4, more=""):
        run = impakt(joined(ARCH, voussoir(tmp_path / "block.msh", thickness, high), f"-contact_friction {friction}", more), expect_failure=not expected)
        if expected:
            weight = 1000 * 9.81 * BLOCKS * FACETS * np.sin(np.pi / BLOCKS / FACETS) * thickness
            assert run.history["obstacle/ground/reaction/force"][-1] == pytest.approx([0, weight, 0], abs=1e-8 * weight)
            assert run.summary["contact"]["friction_residual"] <= 1e-10  # [m]
        else:
            assert any(words in run.stderr for words in NO_REST), run.stderr

    return check


@pytest.mark.long
def test_limit_analysis():
    """Of many blocks. The thickness 0.107426 has weights on the centre line, blocks at whose centroids they act come to 0.107478 (400 of them)."""
    assert least_thickness(64, 0.6) == pytest.approx(0.107426, rel=1e-3)  # measured: -4e-4
    assert least_friction(64, 0.3) == pytest.approx(0.309215, rel=2e-4)  # measured: -1e-4, of joints at certain angles
    assert least_friction(64, 1.00001 * least_thickness(64, 0.6)) == pytest.approx(0.395832, rel=2e-3)  # measured: -1.2e-3
    assert least_thickness(BLOCKS, 0.6, FACETS) == pytest.approx(0.107426, rel=5e-4)  # measured: 2.5e-4
    assert least_friction(BLOCKS, 0.3, FACETS) == pytest.approx(0.309215, rel=2e-3)  # measured: -1.1e-3


@pytest.mark.parametrize(("factor", "expected"), [(1.02, True), *long((0.98, False))])
def test_by_force(factor, expected, stands):
    """The same bounds by -contact_type force."""
    more = f"-contact_type force {'' if expected else '-controller_step_cuts 0'}"
    stands(factor * least_thickness(BLOCKS, 0.6, FACETS), 0.6, expected, more=more)
    stands(0.3, factor * least_friction(BLOCKS, 0.3, FACETS), expected, more=more)


def test_steps_in_which_nothing_changes(impakt):
    """Under a load that stays nodes are at the brink of other states: the forces that hold are those of the first step: nodes go on by 1e-9 of
    the way that contact makes them go, which is 3e-8 of the force of stiff blocks."""
    force = impakt(f"{ARCH} -time_step 0.1").history["contact/b10.right:b11.left/force_vector"][()]
    assert len(force) == 11
    assert np.abs(force[2:] - force[1]).max() <= 1e-7 * np.abs(force[1]).max()


@pytest.mark.parametrize(("more", "high"), [("", 4), *long(("-contact_type lagrange", 4), ("", 1))])
def test_least_thickness(more, high, stands):
    """Hinges are at the edges, whatever the number of contact nodes: a node there bears its force where it is."""
    critical = least_thickness(BLOCKS, 0.6, FACETS)
    stands(1.02 * critical, 0.6, high=high, more=more)
    stands(0.98 * critical, 0.6, False, high=high, more=more)


@pytest.mark.parametrize("thickness", [0.3, *long(0.12, 0.15)])
def test_least_friction(thickness, stands):
    """A thick arch slides below 0.3089; thinner ones, in which the thrust has less room, below 0.38 and 0.35."""
    critical = least_friction(BLOCKS, thickness, FACETS)
    stands(thickness, 1.02 * critical)
    stands(thickness, 0.98 * critical, False)


def drop(run):
    """Of the block beside the crown over the time [m], and the kinetic energy of all."""
    v, time = run.history["body/b10/mean_velocity"][:, 1], run.history["time"][()]
    way = np.concatenate([[0], np.cumsum((v[1:] + v[:-1]) / 2 * np.diff(time))])
    return -way, sum(run.history[f"body/{body}/kinetic"][()] for body in BODIES)


@pytest.mark.long
@pytest.mark.parametrize("what", ["thickness", "friction"])
def test_dynamics(what, impakt, tmp_path):
    """With inertia, under gravity from t = 0 on: with 1.02 times what is needed the arch rocks and stays, with 0.98 times it falls faster and faster."""

    def outcome(factor):
        thickness, friction = (factor * least_thickness(BLOCKS, 0.6, FACETS), 0.6) if what == "thickness" else (0.3, factor * least_friction(BLOCKS, 0.3, FACETS))
        return drop(impakt(joined(ARCH, DYNAMIC, voussoir(tmp_path / "block.msh", thickness), f"-contact_friction {friction}")))

    (standing, at_rest), (falling, kinetic) = outcome(1.02), outcome(0.98)
    assert standing.max() <= 4e-3  # [m], measured: 2.0e-3, 5e-4, with a radius of 1 m
    assert falling[-1] > 1e-2  # measured: 1.6e-2, 1.8e-2
    assert falling[-1] > 2.5 * falling[len(falling) // 2]  # measured: 2.7, 3.2
    assert kinetic[-1] == kinetic.max() > 5 * at_rest[-1]  # measured: 14 times, 5e5 times
