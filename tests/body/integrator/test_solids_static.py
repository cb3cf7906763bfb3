"""Static bodies: load steps without inertia against closed forms; what nothing holds is refused."""

import numpy as np
import pytest
from solidmeshes import dim_of, made_by_options, sides

E, NU = 200.0, 0.3
LAMBDA, MU = E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU)
SIZE = (1.0, 0.3, 0.2)
KINDS = ["tri3 strain", "tri3 stress", "quad4 strain", "quad4 stress", "tet4", "hex8", "tri6 strain", "tri6 stress", "tet10"]


def bar(kind):
    shape = kind.split()[0]
    dim = dim_of(shape)
    plane = " -b_plane_stress" if "stress" in kind else ""
    mesh = f"-b_dm_plex_dim {dim} {made_by_options(shape)} -b_dm_plex_box_faces {','.join('421'[:dim])} -b_dm_plex_box_upper {','.join(map(str, SIZE[:dim]))}"
    return f"-bodies b {mesh} -b_density 1 -b_youngs_modulus {E} -b_poissons_ratio {NU} -b_ts_type static{plane}"


def symmetric(kind):
    """Planes of symmetry at xmin, ymin and zmin; the other sides are free."""
    dim = dim_of(kind.split()[0])
    mins = sides(kind.split()[0])[::2]
    held = [",".join("0" if i == k else "free" for i in range(dim)) for k in range(dim)]
    return f"-b_boundary_displacement {','.join(mins)} " + " ".join(f"-b_boundary_displacement_{name} {u}" for name, u in zip(mins, held))


def pull(kind, traction):
    zeros = ",0" * (dim_of(kind.split()[0]) - 1)
    return f"-b_boundary_traction xmax -b_boundary_traction_xmax {traction}{zeros}"


def volume(kind):
    return np.prod(SIZE[: dim_of(kind.split()[0])])


def measures(run):
    body = run.history["body/b"]
    return run.summary["bodies"]["b"]["displacement_error"], body["external_work"][:].ravel(), body["potential"][:].ravel()


@pytest.mark.parametrize("kind", KINDS)
def test_linear(impakt, kind):
    """Uniaxial stress of 20 Pa t; in plane strain with E / (1 - nu^2) and nu / (1 - nu). Force and displacement grow together, so that
    the trapezoidal rule has the work exactly in every step."""
    along, across = (20 * (1 - NU**2) / E, -20 * NU * (1 + NU) / E) if kind.endswith("strain") else (20 / E, -20 * NU / E)
    exact = ",".join(f"({c!r})*{x}*t" for c, x in zip((along, across, across), "xyz"[: dim_of(kind.split()[0])]))
    run = impakt(f"{bar(kind)} {symmetric(kind)} {pull(kind, '20*t')} -b_exact_displacement {exact} -time_step 0.2 -time_end 1")
    error, work, potential = measures(run)
    assert error <= 1e-13
    steps = np.arange(6) / 5
    np.testing.assert_allclose(potential, 0.5 * 20 * along * volume(kind) * steps**2, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(work, potential, rtol=1e-12, atol=1e-15)
    assert run.summary["bodies"]["b"]["kinetic"] == 0


def stretched(kind, stretch):
    """Lateral stretch, nominal stress and energy per volume of a neo-Hookean bar at a given stretch along x. With s the square of the
    lateral stretch and J = stretch s (plane strain: stretch sqrt s), no lateral stress is mu (s - 1) + lambda/2 (J^2 - 1) = 0."""
    if kind.endswith("strain"):
        s = (MU + LAMBDA / 2) / (MU + LAMBDA / 2 * stretch**2)
        J, trace = stretch * np.sqrt(s), stretch**2 + s + 1
    else:
        a, c = LAMBDA / 2 * stretch**2, MU + LAMBDA / 2
        s = (np.sqrt(MU**2 + 4 * a * c) - MU) / (2 * a)
        J, trace = stretch * s, stretch**2 + 2 * s
    stress = MU * (stretch - 1 / stretch) + LAMBDA / 2 * (J**2 - 1) / stretch
    energy = MU / 2 * (trace - 3) - MU * np.log(J) + LAMBDA / 4 * (J**2 - 1 - 2 * np.log(J))
    return np.sqrt(s), stress, energy


@pytest.mark.parametrize(("kind", "stretch"), [("quad4 strain", 1.4), ("tri3 stress", 0.75), ("tet4", 1.4), ("hex8", 0.75), ("tri6 stress", 1.4), ("tet10", 0.75)])
def test_neo_hookean(impakt, kind, stretch):
    """To its closed form in 5 load steps, and in 10: the work comes to be the energy with the square of the load step."""
    across, stress, energy = stretched(kind, stretch)
    exact = ",".join(f"({c!r})*{x}" for c, x in zip((stretch - 1, float(across) - 1, float(across) - 1), "xyz"[: dim_of(kind.split()[0])]))
    options = f"{bar(kind)} -b_material_type neo_hookean {symmetric(kind)} {pull(kind, f'{float(stress)!r}*t')} -b_exact_displacement {exact} -time_end 1"
    gaps = []
    for step in (0.2, 0.1):
        error, work, potential = measures(impakt(f"{options} -time_step {step}"))
        assert error <= 1e-11
        assert potential[-1] == pytest.approx(energy * volume(kind), rel=1e-11)
        gaps.append(abs(work[-1] / potential[-1] - 1))
    assert gaps[0] < 0.0045  # 0.0033 measured, a quarter of it in half the step
    assert np.log2(gaps[0] / gaps[1]) > 1.8


LOOSE = {
    "free": "",
    "sliding": "-b_boundary_displacement ymin -b_boundary_displacement_ymin free,0,free",  # along x and z, and it turns about y
    "turning": "-b_boundary_displacement xmin,zmin -b_boundary_displacement_xmin 0,free,free -b_boundary_displacement_zmin free,free,0",
}


@pytest.mark.parametrize(("supports", "ranks"), [("free", 1), ("turning", 1), ("sliding", 2)])
def test_loose(impakt, supports, ranks):
    """A body without supports, or with too few of them: its stiffness is singular, which the factors need not show."""
    run = impakt(f"{bar('hex8')} {pull('hex8', '20*t')} {LOOSE[supports]} -time_step 0.5 -time_end 1", ranks, expect_failure=True, timeout=60)
    assert 0 < run.returncode < 128
    lines = [line for line in run.stderr.splitlines() if line.startswith("impakt: error")]
    assert len(lines) == 1, run.stderr
    for words in ("Body 'b' is static", "nothing holds it", "-b_boundary_displacement"):
        assert words in lines[0]


HELD = "-block_boundary_displacement zmin -block_boundary_displacement_zmin 0,0,0 -block_boundary_traction zmax -block_boundary_traction_zmax 0,0,1e5 "
ON_ANOTHER = (
    "-bodies block,other -contact_pairs block.zmin:other.zmax -block_initial_velocity 0,0,-3 -other_dm_plex_dim 3 -other_dm_plex_box_faces 3,3,3 -other_density 1000 "
    "-other_youngs_modulus 1e9 -other_poissons_ratio 0.3 -other_dm_plex_box_lower 0,0,-1 -other_dm_plex_box_upper 1,1,-1e-5 "
)


@pytest.mark.parametrize(("case", "ranks"), [(f"{HELD} -block_ts_type static", 1), (HELD, 2), (ON_ANOTHER, 1)])
def test_linear_solver_that_fails(case, ranks, impakt):
    """Multigrid with too few iterations, with contact and without: the error names body, time, and why the solver has stopped; not that there is a
    displacement which is not a number."""
    run = impakt(
        "-bodies block -block_dm_plex_dim 3 -block_dm_plex_box_faces 4,4,4 -block_density 1000 -block_youngs_modulus 1e9 -block_poissons_ratio 0.3 -block_ksp_type cg "
        f"-block_pc_type gamg -block_ksp_max_it 2 -controller_step_cuts 0 -time_step 1e-4 -time_end 3e-4 {case}",
        ranks,
        expect_failure=True,
    )
    error = " ".join(run.stderr.split())
    assert "The linear solver of body 'block' did not converge at time 0.0001 s (its step 1): DIVERGED_ITS" in error
    assert "-block_ksp_max_it" in error and "-block_pc_type cholesky" in error
    assert "not a number" not in error
