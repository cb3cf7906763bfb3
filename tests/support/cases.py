"""Options of the runs that the paper names, and figures that many tests ask for."""

import numpy as np
import pytest

DEFAULTS = "-options_file options/impact-high-speed.opts"
LUMPED = f"{DEFAULTS} -left_mass_type lumped -right_mass_type lumped"
ANDERSON = "-schwarz_snes_type anderson"

# What computations of the same iterates may differ by: sweeps on the compliance or on the bodies, one rank or several
SAME = 1e-9
# Contact forces to round-off: for comparisons of runs of nonlinear bodies, whose default of 1e-7 would be seen
TIGHT = "-schwarz_snes_rtol 1e-12"

# Integrators of left and right body; substeps of the explicit one in the mixed pairings: 10, once 7
PAIRINGS = {
    "EE": "-left_ts_type centraldifference -right_ts_type centraldifference",
    "IE": "-right_ts_type centraldifference -right_ts_time_step 1e-8",
    "EI": "-left_ts_type centraldifference -left_ts_time_step 1e-8",
    "IE7": "-right_ts_type centraldifference -right_ts_time_step 1.4285714285714286e-8",
}

# The same impact, made harder. As the paper has it, it is symmetric, so that the trace of the contact nodes from the step
# before is the solution already, and impact is at the end of a step.
INSIDE = "-left_dm_plex_box_lower -0.2700037 -left_dm_plex_box_upper -0.0200037"  # after 0.185 of a step of 1e-7 s
MOVING = "-left_initial_velocity 150 -right_initial_velocity -50"
# The right bar has another impedance, which is 2.4 times that of the left one, and waves of 816 m/s, 1000 m/s in the left one
UNLIKE = "-exact characteristics -right_density 3000 -right_youngs_modulus 2e9"
FRAMES = {"as-is": "", "inside": INSIDE, "moving": MOVING, "moving-inside": f"{MOVING} {INSIDE}"}


def marked(mark, cases):
    return [pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=mark) for case in cases]


def long(*cases):
    """Values of a test's parameters that `make test` leaves to `make test-all`."""
    return marked(pytest.mark.long, cases)


def validate(*cases):
    """Those that both leave to `make validate`."""
    return marked(pytest.mark.validate, cases)


def joined(*parts):
    """Joins those that are not empty."""
    return " ".join(filter(None, parts))


def worst_energy_error(summary):
    """Of the system, relative to its initial energy, without sign."""
    system = summary["system"]
    return max(abs(system["energy_error_min"]), abs(system["energy_error_max"]))


def force_scatter(summary):
    """Standard deviation of the contact force, relative to its mean."""
    return summary["contact"]["force_std"] / summary["contact"]["force_mean"]


def least_force(run, pair="left:right"):
    """Of all steps in contact; there must be some, and no force in the others."""
    force, active = (run.history[f"contact/{pair}/{name}"][()] for name in ("force", "active"))
    if not active.any() or force[active == 0].any():
        raise AssertionError(f"{pair}: {(active > 0).sum()} steps in contact, {(force[active == 0] != 0).sum()} others with a force")
    return force[active > 0].min()


def never_tensile(run, pair="left:right"):
    return run.summary["contact"]["tension_max"] == 0 and least_force(run, pair) >= 0


def last(run, pair, name):
    return run.history[f"contact/{pair}/{name}"][()][-1]


def same(first, second, tolerance, bodies, pairs):
    for pair in pairs:
        np.testing.assert_array_equal(first.history[f"contact/{pair}/active"], second.history[f"contact/{pair}/active"])
    for name in [f"contact/{pair}/force" for pair in pairs] + [f"body/{b}/{energy}" for b in bodies for energy in ("kinetic", "potential")]:
        values = first.history[name][()]
        np.testing.assert_allclose(second.history[name][()], values, rtol=0, atol=tolerance * np.abs(values).max(), err_msg=name)
