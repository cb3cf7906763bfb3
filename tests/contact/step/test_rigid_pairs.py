"""Rigid bodies with each other and with obstacles, by `-contact_type force`: S has more rows than they have degrees of freedom. They do not give, so that what meets stays
together, and loses the energy of the hit."""

import math

import numpy as np
import pytest
from cases import joined, long
from messages import check_message
from setups import box, plane, words

FORCE = "-contact_type force -contact_facing false"
G = 9.81


def rubs(mu):
    return f"-contact_law coulomb -contact_friction {mu}" if mu else ""


def rigid(name, faces, lower, upper, more=""):
    return box(name, faces, lower, upper, f"-{name}_rigid true -{name}_density 1000 {more}")


def floor(kind, dim=2):
    """Its options, and the words for bodies and obstacles: a plane, or a rigid plate that is led nowhere."""
    across = (0,) * (dim - 1)
    if kind == "plane":
        return f"-obstacles t {plane('t', (*across, 0), (*across, 1))}", ""
    lower, upper = ((-1, -0.1), (2, 0)) if dim == 2 else ((-1, -1, -0.1), (2, 2, 0))
    return rigid("t", (5,) * (dim - 1) + (1,), lower, upper, f"-t_rigid_displacement {words((0,) * dim)} -t_rigid_rotation {words((0,) * (1 if dim == 2 else 3))}"), ",t"


def block(dim, more):
    upper = (0.1, 0.05) if dim == 2 else (0.1, 0.06, 0.05)
    return rigid("b", (8, 4) if dim == 2 else (4, 3, 2), (0,) * dim, upper, more)


def way(run, body="b"):
    centre = run.history[f"body/{body}/centre"][()]
    return centre[-1] - centre[0]


@pytest.mark.parametrize(("kind", "dim", "ranks"), [("plane", 2, 1), ("rigid", 2, 1), ("plane", 3, 1), ("plane", 2, 3), *long(("rigid", 3, 1), ("rigid", 3, 3))])
def test_slides_to_rest(kind, dim, ranks, impakt):
    """From 1 m/s after v^2 / 2 mu g = 0.16989 m, to 1e-3; measured 1e-5, and 3e-4 on the plate, where its nodes come on and leave. The mean force is the weight but for
    the first record, which has none."""
    options, more = floor(kind, dim)
    gravity = words((0,) * (dim - 1) + (-G,))
    run = impakt(
        joined(
            f"-bodies b{more} -contact_pairs b:t {FORCE} -time_step 1e-3 -time_end 0.4",
            rubs(0.3),
            options,
            block(dim, f"-b_initial_velocity {words((1,) + (0,) * (dim - 1))} -b_gravity {gravity}"),
        ),
        ranks,
    )
    assert way(run)[0] == pytest.approx(1 / (2 * 0.3 * G), rel=1e-3)
    assert run.history["contact/b:t/force"][1:].mean() == pytest.approx(run.summary["bodies"]["b"]["mass"]["total"] * G, rel=2e-3)
    assert run.summary["system"]["energy_error_max"] <= 1e-8  # measured: 3e-10, by the tolerance of passes
    assert run.summary["schwarz"]["mean_contact_steps"] <= 3.2  # measured 2.0 to 2.6


@pytest.mark.parametrize(("part", "dim"), [(0.98, 2), (1.02, 2), *long((0.98, 3), (1.02, 3))])
def test_incline(part, dim, impakt):
    """Sticks at 0.98 of the angle of friction, slides at 1.02 of it, as gravity and friction have it."""
    angle = math.atan(0.3 * part)
    along, down = 1000 * G * math.sin(angle), -1000 * G * math.cos(angle)
    force = words((along, *(0,) * (dim - 2), down))
    run = impakt(joined(f"-bodies b -contact_pairs b:t {FORCE} -time_step 1e-3 -time_end 0.2", rubs(0.3), floor("plane", dim)[0], block(dim, f"-b_body_force {force}")))
    expected = 0.5 * G * (math.sin(angle) - 0.3 * math.cos(angle)) * 0.2**2 if part > 1 else 0
    assert way(run)[0] == pytest.approx(expected, abs=1e-9)  # m; measured 1e-11: rows are right to 1e-13 m a step
    assert run.summary["warnings"] == []


@pytest.mark.parametrize(("dim", "mu", "ranks"), [(2, 0, 1), (3, 0.3, 1), *long((2, 0.3, 1), (3, 0, 1), (3, 0.3, 3), (2, 0.3, 3))])
def test_stack_of_three(dim, mu, ranks, impakt):
    """At rest on each other, on meshes that do not match: nothing moves, and each bears what stands on it. Nor does round-off end the run as a gain of energy."""
    bodies = []
    for i, name in enumerate("abc"):
        lower, upper = (*(0,) * (dim - 1), 0.1 * i), (*(0.2,) * (dim - 1), 0.1 * i + 0.1)
        bodies.append(rigid(name, (4 - i % 2, *(3,) * (dim - 2), 2), lower, upper, f"-{name}_gravity {words((0,) * (dim - 1) + (-G,))}"))
    low, high = ("ymin", "ymax") if dim == 2 else ("zmin", "zmax")
    pairs = [f"a.{low}:t", f"b.{low}:a.{high}", f"c.{low}:b.{high}"]
    run = impakt(
        joined(f"-bodies a,b,c -contact_pairs {','.join(pairs)} -contact_type force -time_step 1e-3 -time_end 0.2", rubs(mu), floor("plane", dim)[0], *bodies), ranks
    )
    weight = run.summary["bodies"]["a"]["mass"]["total"] * G
    for i, pair in enumerate(pairs):
        np.testing.assert_allclose(run.history[f"contact/{pair}/force"][1:], (3 - i) * weight, rtol=1e-5)
        assert np.abs(way(run, "abc"[i])).max() <= 1e-11  # m; measured 4e-14
    assert run.summary["step_control"]["step_cuts"] == 0
    assert run.summary["warnings"] == []


@pytest.mark.parametrize(("dim", "mu", "ranks"), [(2, 0, 1), (3, 0.3, 1), *long((2, 0.3, 1), (3, 0, 1), (3, 0.3, 3))])
def test_impact(dim, mu, ranks, impakt):
    """Two free ones that hit off their centres: momentum to round-off, no energy beyond its start. Rows lie where the bodies would be in the middle of the step without the
    hit; so the moments of its forces are off by half of the way that it makes them slide, 2.1e-4 of the angular momentum at most, in proportion to the step."""

    def hit(step):
        sizes = ((4, 4), (0, 0), (0.1, 0.1)), ((4, 4), (0.105, 0.03), (0.2, 0.13))
        if dim == 3:
            sizes = ((4, 4, 3), (0, 0, 0), (0.1, 0.1, 0.1)), ((4, 4, 3), (0.105, 0.03, 0.02), (0.2, 0.13, 0.13))
        a, b = (rigid(name, *size) for name, size in zip("ab", sizes, strict=True))
        velocity = words((1, 0.1, 0)[:dim])
        return impakt(joined(f"-bodies a,b -contact_pairs a:b {FORCE} -time_step {step} -time_end 0.02 -a_initial_velocity {velocity}", rubs(mu), a, b), ranks)

    errors = []
    for step in (5e-5, 1.25e-5) if ranks == 1 else (1e-4,):
        run = hit(step)
        system = run.summary["system"]
        assert run.summary["contact"]["onsets"] > 0
        assert system["momentum_error_max"] <= 3e-12  # measured 4e-13 in 400 steps, 1.5e-12 in 1600
        assert system["energy_error_max"] <= 1e-12
        errors.append(system["angular_momentum_error_max"])
    assert errors[0] <= 4e-4
    assert len(errors) == 1 or errors[1] <= 0.3 * errors[0]


@pytest.mark.parametrize(("divisions", "kind"), [(8, "plane"), *long((8, "rigid"), (16, "plane"), (32, "plane"))])
def test_rolls_as_its_polygon(divisions, kind, impakt):
    """A disc of n = 4 d corners rolls on them: at each, the angular velocity becomes (I + m r^2 cos 2 pi/n) / (I + m r^2) of what it was, as the moment of momentum about the
    new corner stays. Over the way x there are n x / (2 pi r) of them. It does not slide: friction takes nothing."""
    radius, corners = 0.1, 4 * divisions
    options, more = floor(kind)
    ball = f"-d_dm_plex_dim 2 -d_dm_plex_shape ball -d_ball_radius {radius} -d_ball_keep_volume false -d_ball_centre 0,{radius} -d_ball_divisions {divisions}"
    run = impakt(
        joined(
            f"-bodies d{more} -contact_pairs d:t {FORCE} -time_step 1e-3 -time_end 0.3",
            rubs(0.5),
            options,
            f"{ball} -d_rigid true -d_density 1000 -d_gravity 0,{-G} -d_initial_velocity 1+10*(y-{radius}),-10*x",
        )
    )
    mass, inertia = run.summary["bodies"]["d"]["mass"]["total"], run.history["body/d/kinetic"][0].item() * 2 / 100
    inertia -= mass * radius**2  # of m v^2 / 2 + I w^2 / 2 with v = 1, w = 10
    kept = (inertia + mass * radius**2 * math.cos(2 * math.pi / corners)) / (inertia + mass * radius**2)
    impacts = way(run, "d")[0] * corners / (2 * math.pi * radius)
    spin = run.history["body/d/angular_velocity"][:, 2]
    assert abs(spin[-1]) == pytest.approx(10 * kept**impacts, rel=0.01)  # one impact more or less; measured 0.5 %
    assert abs(run.summary["contact"]["friction_loss"]) <= 1e-3 * run.history["body/d/kinetic"][0].item()
    assert run.summary["system"]["energy_error_max"] <= 1e-12


@pytest.mark.parametrize("more", ["", *long("-plate_ts_type centraldifference", "-plate_ts_type centraldifference -plate_ts_time_step 1e-5")])
def test_angular_momentum_where_a_disc_slides(more, impakt):
    """A rigid disc slides at 2.5 m/s on a plate whose nodes keep their mass: rows lie where the force acts, in the middle of the step. Measured 3.4e-7; half a step ahead of
    that or behind it, 1e-3 and 5e-4. A quarter of the step leaves a sixteenth."""
    errors = [
        impakt(
            joined(
                f"-bodies plate,disc -contact_pairs plate:disc {FORCE} -time_end 8e-3 -time_step {step}",
                box("plate", (30, 6), (-0.5, -0.2), (0.5, 0), "-plate_density 1000 -plate_youngs_modulus 1e8 -plate_poissons_ratio 0.3 -plate_material_type neo_hookean"),
                "-plate_mass_redistribute false -disc_dm_plex_dim 2 -disc_dm_plex_shape ball -disc_ball_radius 0.1 -disc_ball_centre 0.1,0.101 -disc_ball_divisions 6",
                "-disc_density 8000 -disc_rigid true -disc_initial_velocity 0.5-20*(y-0.101),-1+20*(x-0.1)",
                more,
            )
        ).summary["system"]["angular_momentum_error_max"]
        for step in (4e-5, 1e-5)
    ]
    assert errors[0] <= 1e-6 and errors[1] <= 1.5 / 16 * errors[0]


def test_other_methods_refuse_and_name_this_one(impakt):
    for more, what in (("plane", "obstacle"), ("rigid", "both bodies are rigid")):
        options, bodies = floor(more)
        check_message(impakt(joined(f"-bodies b{bodies} -contact_pairs b:t -contact_type alternation -time_step 1e-3 -time_end 1e-2", options, block(2, "")), expect_failure=True), ["b:t", what, "-contact_type schwarz"])
