"""Reads what a run has written, in one call, for notebooks and programs of your own.

    import sys; sys.path.append("plots")
    from impakt_results import read

    run = read("out/impact-high-speed.h5")                 # history; summary and fields beside it, where there are any
    run.time                                               # [s], one number for each controller step, and one for the start
    run.bodies["left"]["kinetic"]                          # [J] over time
    run.bodies["left"]["momentum"]                         # [kg m/s], an array of steps x dimension in two and three dimensions
    run.pairs["left:right"]["force"]                       # [N]
    run.reactions["beam.xmin"]["moment"]                   # what holds a surface [N m], steps x 3; of an obstacle run.reactions["floor"]
    run.probes["beam/0"]["displacement"]                   # what the first point of -beam_probe does [m]
    run.units["contact/left:right/force"]                  # "N"; empty for -units none
    run.unit_system                                        # "SI", "mm-t-s" or "none": units in these brackets are those of SI
    run.options["-time_step"], run.number("-time_step")    # as the run was given them: text, and as a number
    run.energy, run.energy_error                           # of all bodies [J]; relative, less the work of loads
    run.summary["contact"]["impulse"]                      # figures of the JSON file; None where there is none
    run.figure("contact/impulse")                          # the same by its path
    run.fields.times, run.fields.positions(-1)             # frames of -output_fields; nodes as deformed [m]
    run.fields["von_mises", -1]                            # a field of a frame: one number for each element or node

All series are numpy arrays. `read()` takes the path of a history; or of fields alone, `read("f.h5")` or `read("f.xdmf")`, whose time is then
that of the frames, and which have neither bodies nor pairs. The summary is looked for where the options of the run say, and beside the history
under its name with `.json`; `read(path, summary=..., fields=...)` names them. What cannot be read is a `CannotRead`, whose message says why.
"""

import difflib
import json
from functools import cached_property
from pathlib import Path

import h5py
import numpy as np

NO_GAP = 1e20  # gaps beyond have nothing opposite


class CannotRead(Exception):
    """The file is not what it should be; the message says why."""


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def open_file(path):
    """An HDF5 file, which stays open."""
    if not Path(path).is_file():
        raise CannotRead(f"there is no file {path}")
    try:
        return h5py.File(path, "r")
    except OSError as error:
        raise CannotRead(f"{path} cannot be read as HDF5: {error}") from error


def datasets(group):
    return {key: data[()] for key, data in group.items() if isinstance(data, h5py.Dataset)}


def figures(summary, path=""):
    """Paths of all numbers of a summary, but for cost."""
    for key, value in summary.items():
        if isinstance(value, dict) and key != "timing":
            yield from figures(value, f"{path}{key}/")
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            yield path + key


class Fields:
    """Frames of -output_fields: `times` [s], `nodes` (positions before anything moves), `cells`, `body` (number of each cell's body), `names` of the
    bodies, `names_of_fields`; numbers are read when they are asked for."""

    def __init__(self, path):
        self.path = Path(path)
        self.file = open_file(self.path.with_suffix(".h5") if self.path.suffix in (".xdmf", ".xmf") else self.path)
        try:
            times = self.file["time"][()]
            self.nodes, self.cells, self.body = (self.file[f"mesh/{name}"][()] for name in ("positions", "cells", "body"))
            self.names = text(self.file["mesh/body"].attrs["names"]).split(",")
            self.names_of_fields = [name for name in self.file if name not in ("time", "mesh")]
        except KeyError as error:
            raise CannotRead(f"{path} has no fields of an Impakt run: {error}") from error
        self.frames = np.flatnonzero(~np.isnan(times))  # places of frames that the run did not come to have no time
        self.times = times[self.frames]
        self.length, self.time_unit = (text(self.file[name].attrs["units"]) for name in ("mesh/positions", "time"))

    def __len__(self):
        return len(self.times)

    def __getitem__(self, which):
        """A field of a frame: fields["velocity", 3], or fields["velocity", -1] of the last."""
        name, frame = which
        if name not in self.names_of_fields:
            raise CannotRead(f"{self.path} has no field {name}; it has {', '.join(self.names_of_fields)}")
        return self.file[f"{name}/{self.frames[frame]:04d}"][()]

    def positions(self, frame):
        """Nodes as deformed [m]."""
        return self.nodes + self["displacement", frame]

    def units(self, name):
        return text(self.file[f"{name}/0000"].attrs["units"])


class Results:
    """What a run has written; see the head of this file."""

    def __init__(self, path, summary=None, fields=None):
        self.path = Path(path)
        self.summary_path, self.fields_path = summary, fields
        self.bodies, self.pairs, self.reactions, self.probes, self.units = {}, {}, {}, {}, {}
        if self.path.suffix in (".xdmf", ".xmf"):
            self.fields_path = self.path
            self._attributes(self.fields.file)
            self.time = self.fields.times
            return
        with open_file(self.path) as file:
            self._attributes(file)
            if "mesh" in file:
                self.fields_path = self.path
                self.time = self.fields.times
                return
            try:
                self.time = file["time"][()]
                self.sweeps = file["schwarz/iterations"][()]
                self.energy_change, self.energy_scale = file["energy/change"][()], file["energy/scale"][-1]
                self.bodies = {name: datasets(each) for name, each in file["body"].items()}
                for name, each in file["body"].items():
                    self.reactions |= {f"{name}.{surface}": datasets(group) for surface, group in each.get("reaction", {}).items()}
                    self.probes |= {f"{name}/{number}": datasets(group) for number, group in each.get("probe", {}).items()}
                self.reactions |= {name: datasets(each["reaction"]) for name, each in file.get("obstacle", {}).items()}
            except KeyError as error:
                raise CannotRead(f"{path} is not the history of an Impakt run: {error}") from error
            self.pairs = {name: datasets(each) for name, each in file.get("contact", {}).items()}
            file.visititems(self._note_units)

    def _attributes(self, file):
        self.version = text(file.attrs.get("version", ""))
        self.unit_system = text(file.attrs.get("units", "SI"))
        self.options = {name: text(value) for name, value in file.attrs.items() if name.startswith("-")}

    def _note_units(self, name, item):
        if "units" in item.attrs:
            self.units[name] = text(item.attrs["units"])

    def number(self, option):
        """The value of an option of the run as a number."""
        try:
            return float(self.options[option])
        except KeyError:
            raise CannotRead(f"{self.path}: the run was not given {option}") from None
        except ValueError:
            raise CannotRead(f"{self.path}: {option} {self.options[option]} is not a number") from None

    def series(self, name):
        """A series by its name in the file, such as body/left/kinetic, contact/left:right/force or system/energy."""
        group, _, rest = name.partition("/")
        of, _, key = rest.rpartition("/")
        if name == "system/energy":
            return self.energy
        if name == "system/energy_error":
            return self.energy_error
        try:
            return {"body": self.bodies, "contact": self.pairs}[group][of][key]
        except KeyError:
            raise CannotRead(f"{self.path} has no series {name}; it has {', '.join(self.names)}") from None

    @property
    def names(self):
        """Names of all series of bodies and pairs."""
        return [f"{group}/{of}/{key}" for group, each in (("body", self.bodies), ("contact", self.pairs)) for of in each for key in each[of]]

    def total(self, key):
        """Sum over all bodies."""
        return sum(body[key] for body in self.bodies.values())

    @property
    def energy(self):
        """Kinetic and potential energy of all bodies [J]."""
        return self.total("kinetic") + self.total("potential")

    @property
    def energy_error(self):
        """Change of the energy less the work of loads and of obstacles that move along themselves, with what damping, plastic flow and friction have taken,
        relative to the largest of kinetic energy, strain energy and work in the run."""
        return self.energy_change / (self.energy_scale or 1.0)

    def gap(self, pair):
        """Smallest gap [m]; not-a-number where nothing lies opposite."""
        gap = self.pairs[pair]["gap"]
        return np.where(np.abs(gap) < NO_GAP, gap, np.nan)

    def _beside(self, option, suffix):
        """Where an output of the run is: at the path that the run was given, from here or from the folder of the history."""
        given = self.options.get(option)
        places = [Path(given), self.path.parent / Path(given).name] if given else []
        return next((place for place in [*places, self.path.with_suffix(suffix)] if place.is_file() and place != self.path), None)

    @cached_property
    def summary(self):
        """Figures of the run, or None."""
        path = self.summary_path or self._beside("-output_summary", ".json")
        if path is None:
            return None
        try:
            return json.loads(Path(path).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise CannotRead(f"the summary {path} cannot be read: {error}") from error

    def figure(self, name):
        """A number of the summary by its path, such as contact/impulse, or None where it is null."""
        at = self.summary
        if at is None:
            raise CannotRead(f"{self.path}: there is no summary beside it; make the run with -output_summary")
        for key in name.split("/"):
            if not isinstance(at, dict) or key not in at:
                known = list(figures(self.summary))
                near = difflib.get_close_matches(name, known)
                raise CannotRead(f"{self.path}: its summary has no {name}; {'the nearest are' if near else 'it has'} {', '.join(near or known)}")
            at = at[key]
        if at is not None and (isinstance(at, bool) or not isinstance(at, (int, float))):
            raise CannotRead(f"{self.path}: {name} in its summary is not a number")
        return at

    @cached_property
    def fields(self):
        """Frames of the run, or None."""
        path = self.fields_path or self._beside("-output_fields", ".xdmf")
        return None if path is None else Fields(path)


def read(path, summary=None, fields=None):
    """The results of a run, from the path of its history or fields."""
    return Results(path, summary, fields)
