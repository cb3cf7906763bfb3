"""Patch tests: what is linear in space is exact on any mesh, whatever the material. Measured: 5e-16 in statics, 2e-14 after 100 steps."""

import itertools

import pytest
from cases import long
from solidmeshes import SHAPES, dim_of, sides, write_box

FACES = {2: (4, 3), 3: (3, 3, 3)}
SIZE = (1.2, 0.9, 0.7)
# displacement gradients of up to 0.3: finite; a linear elastic body takes them as they are
GRADIENT = {2: "0.2*x-0.1*y,0.05*x+0.15*y", 3: "0.2*x-0.1*y+0.05*z,0.05*x+0.15*y-0.08*z,-0.1*x+0.3*y-0.12*z"}
MATERIALS = ["linear_elastic", "saint_venant_kirchhoff", "neo_hookean", "mooney_rivlin"]
# shapes, and the options of their elements
KINDS = [(shape, "") for shape in SHAPES] + [(shape, "-b_plane_stress") for shape in ("tri3", "quad4", "tri6")]
KINDS += [(shape, f"-b_element_formulation {formulation}") for shape in ("quad4", "hex8") for formulation in ("mean_dilatation", "enhanced", "reduced")]
STEEL = "-b_density 3 -b_youngs_modulus 200 -b_poissons_ratio 0.3"


def body(tmp_path, shape, options=""):
    write_box(tmp_path / "patch.msh", shape, FACES[dim_of(shape)], SIZE, 0.25)
    return f"-bodies b -b_dm_plex_filename {tmp_path / 'patch.msh'} {STEEL} {options}"


def held(shape, displacement):
    """The displacement on the whole boundary, and as the exact one."""
    names = sides(shape)
    return f"-b_boundary_displacement {','.join(names)} -b_exact_displacement {displacement} " + " ".join(f"-b_boundary_displacement_{name} {displacement}" for name in names)


# all combinations, of which two materials in turn for each kind are the first
STATIC = [(*kind, MATERIALS[(i + k) % 4]) for k in range(4) for i, kind in enumerate(KINDS)]


@pytest.mark.parametrize(("shape", "options", "material"), STATIC[: 2 * len(KINDS)] + long(*STATIC[2 * len(KINDS) :]))
def test_static(impakt, tmp_path, shape, options, material):
    """Two load steps; the inner nodes are found from equilibrium. Enhanced modes of rubber are refused: quad4 found hourglasses here, 8 % off."""
    displacement = ",".join(f"t*({u})" for u in GRADIENT[dim_of(shape)].split(","))
    rubber = "enhanced" in options and material == "mooney_rivlin"
    more = f"{options} -b_material_type {material} {held(shape, displacement)} -b_ts_type static -time_step 0.5 -time_end 1"
    run = impakt(body(tmp_path, shape, more), expect_failure=rubber)
    if rubber:
        assert "-b_element_formulation enhanced with mooney_rivlin" in run.stderr
    else:
        assert run.summary["bodies"]["b"]["displacement_error"] <= 1e-12


@pytest.mark.parametrize(("shape", "ts"), list(zip(SHAPES, itertools.cycle(("alpha2", "centraldifference")))))
def test_dynamic(impakt, tmp_path, shape, ts):
    """u = t G X: no acceleration, which both integrators take exactly, with any of the nodes held."""
    gradient = GRADIENT[dim_of(shape)]
    displacement = ",".join(f"t*({u})" for u in gradient.split(","))
    options = f"{held(shape, displacement)} -b_initial_velocity {gradient} -b_ts_type {ts} -time_step 0.004 -time_end 0.4"
    run = impakt(body(tmp_path, shape, f"-b_material_type neo_hookean {options}"))
    assert run.summary["bodies"]["b"]["displacement_error"] <= 1e-12


@pytest.mark.parametrize(("shape", "plane"), [("tri3", "-b_plane_stress"), ("quad4", ""), ("tet4", ""), *long(("hex8", ""), ("tri6", "-b_plane_stress"), ("tet10", ""))])
def test_traction(impakt, tmp_path, shape, plane):
    """Pulled by 20 Pa along x, symmetry planes held: u = (s x, -s' y, -s' z) with s = 20 Pa / E and s' = nu s; in plane strain
    s = (1 - nu^2) 20 Pa / E and s' = nu (1 + nu) 20 Pa / E (Timoshenko and Goodier, Theory of Elasticity, section 16)."""
    along, across = 0.1, -0.03
    if dim_of(shape) == 2 and not plane:
        along, across = 0.1 * (1 - 0.3**2), -0.1 * 0.3 * 1.3
    exact = [f"{along!r}*x", f"{across!r}*y", f"{across!r}*z"][: dim_of(shape)]
    symmetry = ["0,free,free", "free,0,free", "free,free,0"]
    mins = sides(shape)[::2]
    conditions = " ".join(f"-b_boundary_displacement_{name} {','.join(s.split(',')[: dim_of(shape)])}" for name, s in zip(mins, symmetry))
    pulled = f"-b_boundary_traction xmax -b_boundary_traction_xmax {','.join(['20', '0', '0'][: dim_of(shape)])}"
    options = f"-b_boundary_displacement {','.join(mins)} {conditions} {pulled} -b_exact_displacement {','.join(exact)} -b_ts_type static -time_step 1 -time_end 1"
    run = impakt(body(tmp_path, shape, f"{plane} {options}"))
    assert run.summary["bodies"]["b"]["displacement_error"] <= 1e-12
    length, area = SIZE[0], SIZE[1] * (SIZE[2] if dim_of(shape) == 3 else 1)
    assert run.summary["bodies"]["b"]["potential"] == pytest.approx(0.5 * 20 * along * length * area, rel=1e-12)
