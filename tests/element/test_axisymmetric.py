"""Bodies that are rings about x = 0: what is known exactly of one body on its own."""

import numpy as np
import pytest
from pairs import pairwise
from solidmeshes import write_box

KINDS = {"tri3": ("tri3", ""), "quad4": ("quad4", "-b_element_formulation full"), "mean": ("quad4", "-b_element_formulation mean_dilatation")}
STEEL = "-b_density 3 -b_youngs_modulus 200 -b_poissons_ratio 0.3"


def body(tmp_path, kind, faces=(4, 3), size=(1.2, 0.9), inside=0.0, distortion=0.25):
    shape, options = KINDS[kind]
    write_box(tmp_path / "ring.msh", shape, faces, size, distortion)
    return f"-bodies b -b_axisymmetric true -b_dm_plex_filename {tmp_path / 'ring.msh'} -b_translate {inside},0 {STEEL} {options}"


def held(names, displacement):
    """The displacement on some sides, and as the exact one."""
    return f"-b_boundary_displacement {','.join(names)} -b_exact_displacement {displacement} " + " ".join(f"-b_boundary_displacement_{name} {displacement}" for name in names)


@pytest.mark.parametrize("kind, material, inside", pairwise(KINDS, ["linear_elastic", "neo_hookean", "j2 -b_yield_stress 1e9"], [0, 0.5]))
def test_patch(impakt, tmp_path, kind, inside, material):
    """Rings that widen by 20 % and get shorter by 10 %, with and without the axis: inner nodes are found from equilibrium. Measured: 4e-15 at most."""
    names = ["xmax", "ymin", "ymax"] + (["xmin"] if inside else [])
    run = impakt(f"{body(tmp_path, kind, inside=inside)} -b_material_type {material} {held(names, 't*0.2*x,-t*0.1*y')} -b_ts_type static -time_step 0.5 -time_end 1")
    assert run.summary["bodies"]["b"]["displacement_error"] <= 1e-12


def lame(inner, outer, pressure, e, nu):
    """Displacement of a thick tube under pressure from within that cannot get longer: u = (1 + nu) / E ((1 - 2 nu) A r + B / r), A = p a^2 / (b^2 - a^2), B = A b^2
    (Timoshenko and Goodier, Theory of Elasticity, section 28)."""
    a = pressure * inner**2 / (outer**2 - inner**2)
    return (1 + nu) / e * (1 - 2 * nu) * a, (1 + nu) / e * a * outer**2


def tube(tmp_path, kind, n, nu=0.3):
    linear, inverse = lame(1, 2, 1, 200, nu)
    conditions = f"-b_boundary_displacement ymin,ymax -b_boundary_displacement_ymin free,0 -b_boundary_displacement_ymax free,0 -b_boundary_traction xmin -b_boundary_traction_xmin 1,0 -b_exact_displacement {linear!r}*x+{inverse!r}/x,0"
    return f"{body(tmp_path, kind, (n, n // 4), (1, 0.3), 1, 0)} -b_poissons_ratio {nu} {conditions} -b_ts_type static -time_step 1 -time_end 1"


@pytest.mark.parametrize("kind", KINDS)
def test_thick_tube(impakt, tmp_path, kind):
    """Lame's tube under pressure: of second order. Measured: errors of 3.6e-4 at most with 16 elements across the wall, 4.0 times as large with 8, of triangles
    3.4 (3.9 between 32 and 64)."""
    coarse, fine = (impakt(tube(tmp_path, kind, n)).summary["bodies"]["b"]["displacement_error"] for n in (8, 16))
    assert fine <= 4e-4
    assert coarse / fine > 3.3


def test_thick_tube_does_not_lock(impakt, tmp_path):
    """Of nearly incompressible material, nu = 0.4999, quadrilaterals have a mean dilatation unless told otherwise."""
    default, full = (impakt(tube(tmp_path, "mean", 16, 0.4999).replace("-b_element_formulation mean_dilatation", f)).summary["bodies"]["b"]["displacement_error"] for f in ("", "-b_element_formulation full"))
    assert default <= 2e-3
    assert full >= 5 * default


@pytest.mark.parametrize("kind", KINDS)
def test_manufactured(impakt, tmp_path, kind):
    """u = (r^2 z, r^2 z^2) / 10 needs the force -div sigma of linear elasticity, in the cylinder with its axis: of second order, on distorted meshes."""
    e, nu = 200, 0.3
    lam, mu = e * nu / (1 + nu) / (1 - 2 * nu), e / 2 / (1 + nu)
    force = f"-0.1*({lam!r}*(3*y+4*x*y)+{mu!r}*(6*y+4*x*y)),-0.1*({lam!r}*(3*x+2*x^2)+{mu!r}*(3*x+4*y^2+4*x^2))"
    case = f"{held(['xmax', 'ymin', 'ymax'], '0.1*x^2*y,0.1*x^2*y^2')} -b_body_force {force} -b_ts_type static -time_step 1 -time_end 1"
    coarse, fine = (impakt(f"{body(tmp_path, kind, (n, n), (1, 1), 0, 0.2)} {case}").summary["bodies"]["b"]["displacement_error"] for n in (8, 32))
    assert coarse / fine > 10  # 16 of second order; the two meshes are not distorted alike
    assert fine < 1e-3


@pytest.mark.parametrize("ts", ["alpha2", "centraldifference"])
def test_free_flight(impakt, tmp_path, ts):
    """A ring that rings as it flies along the axis: energy, and momentum along it, to round-off and what central differences leave of order two."""
    run = impakt(f"{body(tmp_path, 'mean')} -b_material_type neo_hookean -b_initial_velocity x*sin(3*y),5+x*y -b_ts_type {ts} -time_step 0.002 -time_end 1")
    system = run.summary["system"]
    assert max(abs(system["energy_error_min"]), abs(system["energy_error_max"])) <= 1e-3
    assert system["momentum_error_max"] <= 1e-12
    momentum = run.history["body/b/momentum"][:]
    assert np.all(momentum[:, 0] == 0)
    assert np.all(run.history["body/b/angular_momentum"][:] == 0)
    volume = np.pi * 1.2**2 * 0.9
    mean = 5 + 2 / 3 * 1.2 * 0.45  # of x y over the cylinder; interpolated, and lumped or not
    assert momentum[0, 1] == pytest.approx(3 * volume * mean, rel=0.02)


def test_gravity_and_damping(impakt, tmp_path):
    """A cylinder falls as a point does, with a lumped mass, and dashpots of its stiffness feel nothing of that."""
    run = impakt(f"{body(tmp_path, 'quad4')} -b_gravity 0,-10 -b_damping_stiffness 1e-3 -b_mass_type lumped -time_step 0.01 -time_end 1")
    velocity = run.history["body/b/mean_velocity"][-1]
    assert velocity[1] == pytest.approx(-10, rel=1e-12)
    assert abs(run.summary["bodies"]["b"]["potential"]) < 1e-20


REFUSED = {
    "negative": ("-b_translate -0.5,0", ["the mesh reaches from x = -0.5", "not negative"]),
    "plane-stress": ("-b_plane_stress true", ["rings have a stress along them"]),
    "thickness": ("-b_thickness 0.1", ["rings have no thickness"]),
    "reduced": ("-b_element_formulation reduced", ["axisymmetric elements of shape 'quadrilateral' do not have it; they have full, mean_dilatation"]),
    "enhanced": ("-b_element_formulation enhanced", ["axisymmetric elements"]),
    "gravity": ("-b_gravity 1,0", ["-b_gravity", "along its axis, y"]),
    "velocity": ("-b_initial_velocity 1,0", ["-b_initial_velocity moves nodes on the axis"]),
    "displacement": ("-b_initial_displacement 0.1,0", ["-b_initial_displacement moves nodes on the axis"]),
    "held": ("-b_boundary_displacement ymin -b_boundary_displacement_ymin t,0", ["-b_boundary_displacement_ymin moves nodes on the axis"]),
    "hexahedra": ("-b_dm_plex_dim 3 -b_dm_plex_box_faces 1,1,1", ["-b_axisymmetric true: the mesh has 3 dimensions"]),
    "bar": ("-b_dm_plex_dim 1 -b_dm_plex_box_faces 2", ["-b_axisymmetric true: the mesh has 1 dimensions"]),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused(impakt, case):
    options, words = REFUSED[case]
    run = impakt(f"-bodies b -b_axisymmetric true -b_dm_plex_dim 2 -b_dm_plex_box_faces 4,4 {STEEL} -time_step 0.1 -time_end 1 {options}", 3 if case == "velocity" else 1, expect_failure=True)
    for word in words:
        assert word in run.stderr
