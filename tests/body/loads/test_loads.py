"""Runs under loads: prescribed displacements, tractions, forces in the volume, and the state at the start, against closed forms."""

import pytest
from cases import long
from messages import check_message

# E = 1 GPa, rho = 1000 kg/m^3: waves of 1000 m/s, an impedance rho c A of 1e4 N s/m; 1 ms is half the way through it
BAR = (
    "-bodies bar -bar_dm_plex_dim 1 -bar_dm_plex_box_faces 100 -bar_dm_plex_box_upper 2 -bar_density 1000 -bar_youngs_modulus 1e9 -bar_cross_section 1e-2 "
    "-time_end 1e-3 -time_step 1e-5"
)
BLOCK = "-bodies block -block_dm_plex_dim 3 -block_dm_plex_box_faces 3,2,2 -block_dm_plex_box_upper 2,1,1 -block_density 1000 -block_youngs_modulus 1e9"
SHAPES = {"hex8": "-block_dm_plex_simplex 0", "tet4": "-block_dm_plex_simplex 1"}


def energies(run, name):
    body = run.summary["bodies"][name]
    return body["kinetic"], body["potential"], body["external_work"]


@pytest.mark.parametrize(
    ("shape", "integrator"),
    [("hex8", "alpha2"), ("tet4", "centraldifference"), ("tet4 -block_element_formulation composite", "alpha2 -block_ts_alpha_alpha_m 0.5 -block_ts_alpha_alpha_f 0.5 -block_material_type neo_hookean")],
)
def test_free_fall(shape, integrator, impakt):
    """m g^2 t^2 / 2; central differences report the energy that they conserve, m g^2 (t^2 - dt^2 / 4) / 2. Exact for constant
    acceleration, and so is the displacement v t + g t^2 / 2, without strain: round-off of 100 and 1000 steps."""
    shape, _, more = shape.partition(" ")
    exact = "-block_exact_displacement 1.5*t^2,2*t^2,-6*t^2"
    run = impakt(f"{BLOCK} {SHAPES[shape]} {more} -block_ts_type {integrator} -block_gravity 3,4,-12 {exact} -time_end 0.1 -time_step {1e-4 if integrator == 'centraldifference' else 1e-3}")
    kinetic, potential, work = energies(run, "block")
    time = 0.01 - (1e-8 / 4 if integrator == "centraldifference" else 0)
    assert kinetic == pytest.approx(2000 * 13**2 * time / 2, rel=1e-9)
    assert work == pytest.approx(2000 * 13**2 * 0.01 / 2, rel=1e-9)
    assert potential == pytest.approx(0, abs=1e-9)
    assert run.summary["bodies"]["block"]["displacement_error"] <= 3e-12


@pytest.mark.parametrize("load", ["1e6", "1e6*nx^2", "table:step.txt"])
def test_wave_from_a_traction(load, impakt, tmp_path):
    """A pressure s on the end of a bar drives it at s A / (rho c A): half the work goes into motion, half into strain. The end of
    a mesh of elements of 2 cm is ahead by a part of the first one: 0.05 % of the work."""
    (tmp_path / "step.txt").write_text("# time pressure\n-1 1e6\n0.5e-3, 1e6\n1 1e6\n")
    run = impakt(f"{BAR} -bar_boundary_traction xmin -bar_boundary_traction_xmin {load.replace('step.txt', str(tmp_path / 'step.txt'))}")
    kinetic, potential, work = energies(run, "bar")
    exact = (1e6 * 1e-2) ** 2 / 1e4 * 1e-3
    assert work == pytest.approx(exact, rel=6e-4)
    assert kinetic == pytest.approx(exact / 2, rel=2e-4)  # measured: 1.5e-4
    assert potential == pytest.approx(exact / 2, rel=1.3e-3)  # measured: 1.05e-3
    assert kinetic + potential == pytest.approx(work, rel=1e-9)


@pytest.mark.parametrize(("load", "ranks"), [("1e9*t", 1), ("1e9*t+0*x", 2), ("table:ramp.txt", 1)])
def test_wave_from_a_growing_traction(load, ranks, impakt, tmp_path):
    """s = 1e9 Pa/s t: the work is the integral of (s A)^2 / (rho c A), T^3 / 3 times that at 1 s. Smooth: 1e-4 at 100 steps."""
    (tmp_path / "ramp.txt").write_text("0 0\n2e-4 2e5\n1 1e9\n")
    run = impakt(f"{BAR} -bar_boundary_traction xmin -bar_boundary_traction_xmin {load.replace('ramp.txt', str(tmp_path / 'ramp.txt'))}", ranks=ranks)
    kinetic, potential, work = energies(run, "bar")
    assert work == pytest.approx((1e9 * 1e-2) ** 2 / 1e4 * 1e-9 / 3, rel=1e-3)
    assert kinetic + potential == pytest.approx(work, rel=1e-11)


@pytest.mark.parametrize(
    ("integrator", "ranks"),
    [("alpha2 -bar_mass_type averaged", 1), ("alpha2 -bar_mass_type lumped", 1), ("centraldifference -bar_mass_type lumped", 1), ("centraldifference -bar_mass_type averaged", 2)],
)
def test_wave_from_a_prescribed_displacement(integrator, ranks, impakt):
    """The end moves by 500 m/s^2 t^2: the work is rho c A times the integral of the squared velocity, (1000 m/s^2)^2 T^3 / 3. Measured:
    3e-5 less."""
    run = impakt(f"{BAR} -bar_ts_type {integrator} -bar_boundary_displacement xmin -bar_boundary_displacement_xmin 500*t^2", ranks=ranks)
    kinetic, potential, work = energies(run, "bar")
    assert work == pytest.approx(1e4 * 1e6 * 1e-9 / 3, rel=1e-4)
    assert kinetic + potential == pytest.approx(work, rel=1e-6)  # measured: 3.8e-7, of central differences


@pytest.mark.parametrize("load", ["gravity 9.81", "body_force 9810", "body_force 9810*t", "body_force 9810*t+0*x"])
def test_bar_that_hangs(load, impakt):
    """(rho g)^2 A L^3 / (6 E); linear elements have the exact displacement of the nodes and the mean strain of each element, which
    loses 1 / (4 n^2) of the energy."""
    run = impakt(f"{BAR} -bar_ts_type static -bar_{load} -bar_boundary_displacement xmin -bar_boundary_displacement_xmin 0 -time_end 1 -time_step 1", ranks=2 if "x" in load else 1)
    _, potential, _ = energies(run, "bar")
    assert potential == pytest.approx(9810**2 * 1e-2 * 8 / 6e9 * (1 - 1 / (4 * 100**2)), rel=1e-9)


@pytest.mark.parametrize(("shape", "ranks"), [("tet4", 3), *long(("hex8", 2))])
def test_the_same_on_all_ranks(shape, ranks, impakt):
    """Loads that vary in time and place, on faces and nodes that ranks share."""
    options = (
        f"{BLOCK} {SHAPES[shape]} -block_dm_plex_box_faces 4,3,3 -block_poissons_ratio 0.3 -time_end 2e-3 -time_step 5e-5 "
        "-block_boundary_displacement zmin,xmin -block_boundary_displacement_zmin 1e-3*sin(2e3*t)*x,free,0 -block_boundary_displacement_xmin 0,0,0 "
        "-block_boundary_traction xmax,ymax -block_boundary_traction_xmax 1e6*y*t,0,1e5 -block_boundary_traction_ymax -1e9*t*x*nx,-1e9*t*x*ny,0 "
        "-block_body_force 0,1e6*z*t,0 -block_gravity 0,0,-9.81"
    )
    alone = energies(impakt(options), "block")
    assert min(alone) > 0.1
    assert energies(impakt(options, ranks=ranks), "block") == pytest.approx(alone, rel=1e-9)


BAD = {
    "formula": ("-bar_boundary_traction xmin -bar_boundary_traction_xmin 1e6*sn(t)", ["-bar_boundary_traction_xmin", "1e6*sn(t)", "character 5", "x, y, z, t"]),
    "table": ("-bar_boundary_displacement xmin -bar_boundary_displacement_xmin table:none.txt", ["-bar_boundary_displacement_xmin", "none.txt", "No such file"]),
    "no-values": ("-bar_boundary_traction xmin", ["-bar_boundary_traction", "-bar_boundary_traction_xmin"]),
    "not-in-list": ("-bar_boundary_traction xmin -bar_boundary_traction_xmin 1 -bar_boundary_traction_xmax 1", ["-bar_boundary_traction_xmax"]),
    "surface": ("-bar_boundary_traction top -bar_boundary_traction_top 1", ["bar", "top", "xmin", "xmax"]),
    "components": ("-bar_boundary_displacement xmin -bar_boundary_displacement_xmin 1,free", ["-bar_boundary_displacement_xmin", "2 components", "1-dimensional"]),
    "gravity": ("-bar_gravity 0,9.81", ["-bar_gravity", "2 components", "1-dimensional"]),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_loads(case, impakt):
    options, words = BAD[case]
    check_message(impakt(f"{BAR} {options}", ranks=2 if case == "table" else 1, expect_failure=True, timeout=60), words)


@pytest.mark.parametrize(("load", "ranks"), [("traction", 2), ("displacement", 1), *long(("displacement", 2))])
def test_load_that_ends(load, ranks, impakt):
    """A formula that is not defined from half of the run on: told with place and time, on whichever rank has it; no rank is left waiting."""
    run = impakt(f"{BAR} -bar_boundary_{load} xmin -bar_boundary_{load}_xmin 1e-3*sqrt(5e-4-t+0*x)", ranks=ranks, expect_failure=True, timeout=60)
    for word in (f"-bar_boundary_{load}_xmin", "1e-3*sqrt(5e-4-t+0*x)", "x = 0", "t = 0.0005", "finite"):
        assert word in run.stderr


# A beam, in one step, under a shear that turns its elements inside out, or that it cannot bear
BEAM = (
    "-bodies beam -beam_dm_plex_dim 2 -beam_dm_plex_box_faces 8,2 -beam_dm_plex_box_upper 2,1 -beam_density 1000 -beam_youngs_modulus 1e9 -beam_material_type neo_hookean "
    "-beam_boundary_displacement xmin -beam_boundary_displacement_xmin 0,0 -controller_step_cuts 0 -time_step 0.5 -time_end 1"
)
SHEAR = "-beam_boundary_traction xmax -beam_boundary_traction_xmax"
# Statics find where rubber hangs under any load, but not what metal cannot bear
FLOWS = "-beam_ts_type static -beam_material_type j2 -beam_yield_stress 1e6"


@pytest.mark.parametrize(
    ("load", "remedy"),
    [
        (f"{FLOWS} {SHEAR} 0,-1e10", "by a factor of min(1,t/5) in -beam_boundary_traction_xmax"),
        (f"{SHEAR} 0,-1e10+1e6*y -time_step 0.01", "by a factor of min(1,t/0.1) in -beam_boundary_traction_xmax"),
        (f"{FLOWS} -beam_gravity 0,-1e9 -time_start 1 -time_end 2", "by a factor of min(1,(t-1)/5) in -beam_body_force, of density times -beam_gravity in place of that"),
        (f"{FLOWS} {SHEAR} 0,-1e11*t", None),  # it grows already
    ],
)
def test_sudden_load(load, remedy, impakt):
    """A step that fails soon after a load has come at once says how to let that grow, in which option."""
    told = impakt(f"{BEAM} {load}", expect_failure=True).stderr
    assert "is inverted, or not a number" in told or "did not converge" in told
    assert (f"A load comes suddenly: let it grow, as over 10 controller steps {remedy}" in told) if remedy else "suddenly" not in told


def test_remedy_is_taken(impakt):
    """The factor that is told of is one that a run takes, under which the load is there after ten steps, and none of it before."""
    run = impakt(f"{BEAM} -beam_ts_type static {SHEAR} 0,-1e6*min(1,t/5) -time_end 6")
    force = -run.history["body/beam/reaction/xmin/force"][()][:, 1]
    assert force[[5, 10, 12]] == pytest.approx([-5e5, -1e6, -1e6], rel=1e-6)
