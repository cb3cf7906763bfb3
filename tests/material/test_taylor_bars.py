"""Two copper rods that hit each other: by symmetry each does what a rod does at a wall that holds its foot, J. W. Foulk et al.'s (2021) of 7.226 and 21.43 mm."""

import h5py
import numpy as np
import pytest

RODS = ("left", "right")
FIELDS = "-output_fields fields.h5 -output_fields_interval 100000"
RINGS, ALONE = "-options_file options/taylor-bars-axisymmetric.opts", "-options_file options/taylor-bar-axisymmetric.opts"
SOLID = "-options_file options/taylor-bars.opts"
# The rod of taylor-bar.opts with its foot held: no wall, no contact
SOLID_ALONE = "-bodies rod " + " ".join(
    f"-rod_{option}"
    for option in (
        "dm_plex_dim 3", "dm_plex_shape rod", "rod_radius 3.2e-3", "rod_length 32.4e-3", "rod_part quarter", "density 8930", "youngs_modulus 117e9", "poissons_ratio 0.35", "material_type j2",
        "yield_stress 400e6", "hardening_modulus 100e6", "initial_velocity 0,0,-227", "boundary_displacement cut_x,cut_y,zmin", "boundary_displacement_cut_x 0,free,free",
        "boundary_displacement_cut_y free,0,free", "boundary_displacement_zmin free,free,0", "ts_type centraldifference", "mass_type lumped",
    )
)  # fmt: skip
PUSHES = "-contact_law frictionless -contact_type lagrange"


def rods(run, along):
    """Positions of the nodes of each rod, undeformed and as they are: distance from the axis, height above its foot [m]."""
    with h5py.File(run.folder / "fields.h5") as fields:
        positions = fields["mesh/positions"][()]
        moved = positions + fields["displacement"][max(fields["displacement"])][()]
    count = len(run.summary["bodies"])
    for first, last in zip(np.split(positions, count), np.split(moved, count), strict=True):
        sign = np.sign(first[:, along].sum())
        yield [np.column_stack([np.hypot(x[:, 0], x[:, 1] if along == 2 else 0), sign * x[:, along]]) for x in (first, last)]


def radius_and_length(rod):
    return rod[:, 0].max(), np.ptp(rod[:, 1])


def sorted_nodes(first, last):
    return last[np.lexsort(np.round(first, 9).T)]


def largest_energy_error(run):
    return max(abs(run.summary["system"][f"energy_error_{end}"]) for end in ("min", "max"))


def meshes(faces, bodies):
    if "," in faces:
        return " ".join(f"-{b}_dm_plex_box_faces {faces}" for b in bodies)
    divisions, elements = faces.split("x")
    return " ".join(f"-{b}_rod_divisions {divisions} -{b}_rod_elements {elements}" for b in bodies)


@pytest.mark.parametrize(
    ("pair", "alone", "along", "mesh", "step", "end"),
    [
        (RINGS, ALONE, 1, "6,60", 2e-8, 1e-5),
        pytest.param(RINGS, ALONE, 1, "6,60", 5e-9, 8e-5, marks=pytest.mark.long),
        pytest.param(SOLID, SOLID_ALONE, 2, "4x24", 1e-8, 8e-5, marks=pytest.mark.long),
    ],
)
def test_as_at_a_wall(impakt, pair, alone, along, mesh, step, end):
    """Nodes of both rods are where those of one are whose foot is held, on the same mesh in the same steps, to round-off; the energy with plastic work to 1e-3. Measured: radii and lengths
    to the last digit but one, 7.132 and 21.445 mm by rings of 6 x 60 (-1.3 %, +0.07 %), 7.113 and 21.504 mm by hexahedra (-1.6 %, +0.3 %); energy to 1.2e-4, 7e-6 and 1.1e-5."""
    case = f"-time_step {step} -time_end {end} {FIELDS}"
    both = impakt(f"{pair} {meshes(mesh, RODS)} {case}")
    one = impakt(f"{alone} {meshes(mesh, ['rod'])} {case}")
    wanted = sorted_nodes(*next(rods(one, along)))
    for first, last in rods(both, along):
        if along == 2:  # nodes off the axes come in pairs of equal distance and height
            np.testing.assert_allclose(radius_and_length(last), radius_and_length(wanted), rtol=1e-9)
        else:
            np.testing.assert_allclose(sorted_nodes(first, last), wanted, rtol=0, atol=1e-12)
    assert largest_energy_error(both) <= 1e-3
    work = [both.summary["bodies"][b]["plastic_work"] for b in RODS]
    assert work == pytest.approx(2 * [one.summary["bodies"]["rod"]["plastic_work"]], rel=1e-9)


@pytest.mark.validate
def test_radius(impakt):
    """To 0.5 and 0.3 % of 7.226 and 21.43 mm, as rings of 16 x 160 elements have them at the wall. Measured: 7.195 and 21.428 mm, -0.43 and -0.01 %, energy to 1.2e-6; 6, 8, 12, 16 elements to the radius converge from -1.3 % on."""
    run = impakt(f"{RINGS} {FIELDS}", timeout=900)
    for _, last in rods(run, 1):
        assert radius_and_length(last)[0] == pytest.approx(7.226e-3, rel=5e-3)
        assert radius_and_length(last)[1] == pytest.approx(21.43e-3, rel=3e-3)
    assert largest_energy_error(run) <= 1e-3


@pytest.mark.validate
def test_radius_of_hexahedra(impakt):
    """The same of one rod in three dimensions, 12 elements to the radius, by the largest and by the mean distance of the rim of its foot from the axis. Measured: 7.207 and 7.194 mm, -0.26 and
    -0.44 %, where 6 elements have 7.155 mm; 21.432 mm; energy to 6e-5; 8 minutes of processor time on a busy machine. Two rods that hit each other are as this one (test_as_at_a_wall)."""
    run = impakt(f"{SOLID_ALONE} {meshes('12x120', ['rod'])} -time_step 1e-8 -time_end 8e-5 {FIELDS}", timeout=1400)
    ((first, last),) = rods(run, 2)
    rim = last[(first[:, 1] < 1e-9) & (first[:, 0] > 3.2e-3)]
    assert len(rim) == 13
    assert [rim[:, 0].max(), rim[:, 0].mean()] == pytest.approx([7.226e-3, 7.226e-3], rel=5e-3)
    assert radius_and_length(last)[1] == pytest.approx(21.43e-3, rel=3e-3)
    assert largest_energy_error(run) <= 1e-3


@pytest.mark.validate
def test_feet_that_push(impakt):
    """Feet that come off at the rim: after 4 us no longer by the same amount, since nothing holds the plane between them. The mean of both radii is that of the rod at a wall that only pushes, 7.241 mm
    on this mesh, 7.287 mm with 8 elements to the radius (test_axisymmetric_contact.py). Measured: 7.225 and 7.258 mm, with 8 elements 7.265 and 7.310 mm. Contact nodes keep their mass, and what they had
    is lost as they stop: half an element of 60, 0.83 % of the mass, and what of the rest faces of contact share; measured: 1.0 %."""
    run = impakt(f"{RINGS} {PUSHES} {meshes('6,60', RODS)} -time_step 2.5e-9 {FIELDS}")
    radii = [radius_and_length(last)[0] for _, last in rods(run, 1)]
    assert np.mean(radii) == pytest.approx(7.241e-3, rel=1e-3)
    assert radii == pytest.approx(2 * [7.241e-3], rel=5e-3)
    assert [radius_and_length(last)[1] for _, last in rods(run, 1)] == pytest.approx(2 * [21.5e-3], rel=3e-3)
    assert -0.0125 < run.summary["system"]["energy_error_final"] < -0.008
