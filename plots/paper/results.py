"""What the runs left: summaries, histories, and the exact solution beside them."""

import json
from functools import cached_property

import impact
import numpy as np


class NoResult(Exception):
    """A run has failed or has not been made; the message says which."""


class Results:
    """results["mesh/ii-200"] is a Result; that of a run which failed raises NoResult when its figures are asked for."""

    def __init__(self, runner, experiments):
        self.runner, self.experiments, self.known = runner, experiments, {}

    def __getitem__(self, name):
        if name not in self.experiments:
            raise NoResult(f"there is no experiment {name}")
        return self.known.setdefault(name, Result(self.runner, self.experiments[name]))

    def of_group(self, group):
        return [self[name] for name, experiment in self.experiments.items() if experiment.group == group]


class Result:
    def __init__(self, runner, experiment):
        self.runner, self.experiment = runner, experiment

    @property
    def error(self):
        """Why there are no figures; empty where there are."""
        record = self.runner.record(self.experiment)
        return record["error"] if record else "not run"

    def path(self, ending):
        if self.error:
            raise NoResult(f"{self.experiment.name}: {self.error}")
        return self.runner.path(self.experiment, ending)

    @cached_property
    def summary(self):
        return json.loads(self.path(".json").read_text(encoding="utf-8"))

    def figure(self, path):
        """Of the summary, as "schwarz.max", or made of several."""
        return figure(self.summary, path)

    @cached_property
    def history(self):
        """As plots/impact.py reads it, with the exact solution as `exact`."""
        history = impact.read(self.path(".h5"))
        return {**history, "exact": impact.exact_solution(history, None)}

    @property
    def time(self):
        return self.history["time"]

    @property
    def sweeps(self):
        return self.history["sweeps"]

    @property
    def force(self):
        return next(iter(self.history["forces"].values()))

    def left(self, quantity):
        """Of the left bar: kinetic, potential, contact_position, contact_velocity, mean_velocity."""
        return self.history["bodies"]["left"][quantity]

    def contact_velocity(self):
        """Of the left bar. The velocities that the forward-increment multipliers leave at the end of a step do not have the force
        yet that begins there; for them, the mean velocity of the step, which is what central differences work with."""
        if self.summary["contact"]["type"] != "lagrange":
            return self.left("contact_velocity")
        rate = np.diff(self.left("contact_position")) / np.diff(self.time)
        return np.concatenate([self.left("contact_velocity")[:1], rate])

    def exact(self, quantity):
        """The same, and force."""
        values = self.history["exact"][quantity.removeprefix("contact_")]
        return values["left"] if isinstance(values, dict) else values

    def energy_error(self, system=False):
        """Of the left bar's total energy or the system's, relative to the initial value."""
        bodies = self.history["bodies"]
        total = sum(body["kinetic"] + body["potential"] for name, body in bodies.items() if system or name == "left")
        return total / total[0] - 1


def largest(*ends):
    return max(ends, key=abs)


# Figures that the summary does not have as they are
MADE = {
    "force_scatter": lambda summary: summary["contact"]["force_std"] / summary["contact"]["force_mean"],
    "system.energy_error": lambda summary: largest(*(summary["system"][f"energy_error_{end}"] for end in ("min", "max"))),
    "left.energy_error": lambda summary: largest(
        *(summary["bodies"]["left"][f"total_energy_error_{end}"] for end in ("min", "max"))
    ),
}


def figure(summary, path):
    if path in MADE:
        return MADE[path](summary)
    for key in path.split("."):
        summary = summary[key]
    return summary


def convergence_rate(meshes, errors):
    """The order p of errors ~ N^-p, by least squares."""
    return -np.polyfit(np.log(meshes), np.log(errors), 1)[0]
