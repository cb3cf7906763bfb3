"""Summary, history, monitors: what scripts and people rely on."""

import re

import h5py
import numpy as np
import pytest
from cases import DEFAULTS
from conftest import IMPAKT, ROOT
from held import held
from pace import STEPS, paced

THREE_BARS = "-options_file options/three-bars.opts"

CONTACT = {
    "first_contact_time": float,
    "release_time": float,
    "onset_time": float,
    "separation_time": float,
    "in_contact_at_end": bool,
    "onsets": int,
    "steps_in_contact": int,
    "force_mean": float,
    "force_std": float,
    "force_min": float,
    "force_peak": float,
    "force_final": float,
    "resultant_mean": float,
    "resultant_peak": float,
    "tension_max": float,
    "impulse": float,
    "max_penetration": float,
    "area_max": float,
    "active_max": int,
    "gap_min": float,
    "gap_final": float,
}
PAIR = {**CONTACT, "impulse_vector": list, "resultant": list}
SUMMARY = {
    "version": str,
    "units": str,
    "run": {"complete": bool, "controller_steps": int, "time": float},
    "contact": {"type": str, "overlap": {"bodies": list, "depth": float, "part": float, "time": type(None), "position": list}, **CONTACT},
    "pairs": {"left:right": PAIR},
    "schwarz": {
        "max": int,
        "mean_all_steps": float,
        "mean_contact_steps": float,
        "unconverged_steps": int,
        "set_changes": int,
        "set_cycles": int,
        "limited_steps": int,
        "unlimited_steps": int,
        "energy_attempts": int,
        "inner_iterations": int,
        "rebuilds": int,
    },
    "step_control": {"step_cuts": int, "steps_cut": int, "smallest_step": float, "lossy_steps": int},
    "bodies": {
        name: {
            "dofs": int,
            "mass": {"total": float, "factor_min": float, "factor_max": float, "centre_shift": list, "inertia_error": float},
            "kinetic": float,
            "potential": float,
            "peak_potential": float,
            "external_work": float,
            "damping_work": float,
            "hourglass_energy": float,
            "hourglass_energy_max": float,
            "rotation_max": float,
            "inverted_max": int,
            "total_energy_error_min": float,
            "total_energy_error_max": float,
            "substeps": int,
            "reactions": {},
        }
        for name in ("left", "right")
    },
    "obstacles": {},
    "system": {key: float for key in ("energy_scale", "energy_error_min", "energy_error_max", "energy_error_final", "momentum_error_max", "angular_momentum_error_max", "penalty_energy_max")},
    "errors": {
        **{
            key: float
            for key in ("contact_position", "contact_velocity", "contact_force", "kinetic", "potential", "mean_velocity", "peak_potential", "release_time")
        },
        "bodies": {name: {key: float for key in ("kinetic", "potential", "mean_velocity", "kinetic_max", "potential_max")} for name in ("left", "right")},
    },
    "warnings": list,
    "timing": {
        "wall": float,
        "cpu": float,
        "wall_setup": float,
        "per_phase": {"alpha2": {"seconds": float, "substeps": int}, "sweeps": {"seconds": float, "count": int}},
        "ranks": {
            "count": int,
            **{
                name: {"largest": float, "mean": float}
                for name in ("elements", "nodes", "halo", "facets", "rows", "neighbours", "peak_memory", "base_memory", "work")
            },
        },
    },
}

UNITS = {
    "time": "s",
    "schwarz/iterations": "1",
    "energy/change": "J",
    "energy/scale": "J",
    "contact/{}/force": "N",
    "contact/{}/gap": "m",
    "contact/{}/active": "1",
    "contact/{}/area": "m^2",
    "contact/{}/force_vector": "N",
    "contact/{}/moment": "N m",
    "contact/{}/impulse": "N s",
    "body/{}/kinetic": "J",
    "body/{}/potential": "J",
    "body/{}/contact_position": "m",
    "body/{}/contact_velocity": "m/s",
    "body/{}/mean_velocity": "m/s",
    "body/{}/external_work": "J",
    "body/{}/momentum": "kg m/s",
}


def check_shape(value, shape, where="summary"):
    if isinstance(shape, dict):
        assert isinstance(value, dict), where
        assert value.keys() == shape.keys(), where
        for key in shape:
            check_shape(value[key], shape[key], f"{where}.{key}")
    else:
        assert type(value) is shape, f"{where} is {value!r}"


def datasets(file):
    found = {}
    file.visititems(lambda name, item: found.update({name: item}) if isinstance(item, h5py.Dataset) else None)
    return found


def expected_units(bodies, pairs):
    names = {"body": bodies, "contact": pairs}
    return {key.format(name): unit for key, unit in UNITS.items() for name in names.get(key.split("/")[0], [""])}


def test_summary(shared_run):
    check_shape(shared_run(DEFAULTS).summary, SUMMARY)


def test_summary_without_exact(shared_run):
    summary = shared_run(f"{DEFAULTS} -exact none -time_end -1.9e-4").summary
    assert "errors" not in summary
    # what does not exist is null
    for key in ("first_contact_time", "release_time", "force_mean", "force_std", "force_min"):
        assert summary["contact"][key] is None, key
    assert summary["contact"]["onsets"] == summary["contact"]["steps_in_contact"] == 0
    assert summary["schwarz"]["max"] == 0


def test_summary_of_three(shared_run):
    """There is one object for each pair, beside that for all."""
    summary = shared_run(THREE_BARS).summary
    assert summary.keys() == SUMMARY.keys() - {"errors"}
    check_shape(summary["pairs"], {"a:b": PAIR, "b:c": PAIR})
    check_shape(summary["contact"], SUMMARY["contact"])
    assert list(summary["bodies"]) == ["a", "b", "c"]


@pytest.mark.parametrize(("options", "bodies", "pairs"), [(DEFAULTS, ["left", "right"], ["left:right"]), (THREE_BARS, ["a", "b", "c"], ["a:b", "b:c"])], ids=["two", "three"])
def test_history(options, bodies, pairs, shared_run):
    history = shared_run(options).history
    found = datasets(history)
    assert {name: data.attrs.get("units") for name, data in found.items()} == expected_units(bodies, pairs)
    for name, data in found.items():
        assert data.shape == ((10001, 3) if name.rpartition("/")[2] in ("force_vector", "moment", "impulse") else (10001,)), name
        assert data.dtype.kind == ("i" if name.endswith(("iterations", "active")) else "f"), name
        assert np.isfinite(data[()]).all(), name
    start, end = (-2e-4, 8e-4) if bodies[0] == "left" else (0, 1e-3)
    np.testing.assert_allclose(history["time"][()], np.linspace(start, end, 10001), rtol=0, atol=1e-15)


def test_root_attributes(shared_run):
    """All options of the run, from files and command line, so that a result tells how it was made."""
    run = shared_run(f"{DEFAULTS} -exact none -time_end -1.9e-4")
    attributes = dict(run.history.attrs)
    assert attributes["version"] == run.summary["version"]
    wanted = {
        "-bodies": "left,right",
        "-exact": "none",
        "-time_end": "-1.9e-4",
        "-time_step": "1e-7",
        "-contact_type": "schwarz",
        "-left_density": "1000",
        "-right_initial_velocity": "-100",
        "-left_mass_redistribute": "true",
    }
    assert {name: attributes.get(name) for name in wanted} == wanted


def test_history_and_summary_agree(shared_run):
    run = shared_run(DEFAULTS)
    history, summary = run.history, run.summary
    time = history["time"][()]
    force, gap, active = (history[f"contact/left:right/{key}"][()] for key in ("force", "gap", "active"))
    contact, schwarz = summary["contact"], summary["schwarz"]
    assert contact["steps_in_contact"] == (active > 0).sum()
    assert contact["first_contact_time"] == pytest.approx(time[active > 0][0], abs=1e-15)
    assert contact["release_time"] == pytest.approx(time[active > 0][-1], abs=1e-15)
    assert contact["force_peak"] == force.max()
    assert contact["impulse"] == pytest.approx(np.trapezoid(force, time), rel=1e-12)
    assert contact["max_penetration"] == max(0, -gap[1:].min())
    pair, more = summary["pairs"]["left:right"], history["contact/left:right"]
    assert {key: pair[key] for key in CONTACT} == {key: contact[key] for key in CONTACT}
    assert pair["impulse_vector"] == list(more["impulse"][-1])
    assert pair["impulse_vector"][0] == pytest.approx(contact["impulse"], rel=1e-12)
    assert pair["area_max"] == more["area"][()].max() == 1e-6  # -cross_section
    assert pair["active_max"] == active.max() == 1
    np.testing.assert_array_equal(more["force_vector"][()], np.outer(force, (1, 0, 0)))
    np.testing.assert_array_equal(more["moment"][()], 0)
    steps = np.concatenate(([0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(time))))
    np.testing.assert_allclose(more["impulse"][:, 0], steps, rtol=0, atol=1e-12 * steps[-1])
    duration = contact["release_time"] - contact["first_contact_time"]
    middle = np.abs(time - contact["first_contact_time"] - 0.5 * duration) <= 0.3 * duration * (1 + 1e-9)
    assert contact["force_mean"] == pytest.approx(force[middle].mean(), rel=1e-12)
    assert contact["force_std"] == pytest.approx(force[middle].std(), rel=1e-6)
    sweeps = history["schwarz/iterations"][()][1:]
    assert schwarz["max"] == sweeps.max()
    assert schwarz["mean_all_steps"] == pytest.approx(sweeps.mean(), rel=1e-12)
    assert schwarz["mean_contact_steps"] == pytest.approx(sweeps[active[1:] > 0].mean(), rel=1e-12)
    total = sum(history[f"body/{name}/{key}"][()] for name in ("left", "right") for key in ("kinetic", "potential"))
    error = total / total[0] - 1
    # differences of sums in another order: to round-off of the energy
    assert summary["system"]["energy_error_max"] == pytest.approx(error.max(), abs=1e-14)
    assert summary["system"]["energy_error_final"] == pytest.approx(error[-1], abs=1e-14)
    for name, body in summary["bodies"].items():
        assert body["kinetic"] == history[f"body/{name}/kinetic"][-1]
        assert body["peak_potential"] == history[f"body/{name}/potential"][()].max()
        np.testing.assert_allclose(2.5e-4 * 100**2 / 2, history[f"body/{name}/kinetic"][0], rtol=1e-12)


def words(folder, *more):
    (folder / "options").symlink_to(ROOT / "options")
    return [str(word) for word in (IMPAKT, "-options_file", "options/impact-high-speed.opts", *more)]


def check_whole(path):
    """Opens a history, however it came about, and returns the number of its records."""
    with h5py.File(path, "r") as file:
        found = datasets(file)
        assert found.keys() == expected_units(["left", "right"], ["left:right"]).keys()
        lengths = {len(data) for data in found.values()}
        assert len(lengths) == 1
        length = lengths.pop()
        np.testing.assert_allclose(file["time"][()], -2e-4 + 1e-7 / STEPS * np.arange(length), rtol=0, atol=1e-15)
        assert np.isfinite(file["body/left/kinetic"][()]).all()
        return length


def test_kill(tmp_path):
    """Readable whenever one looks, and after SIGKILL; it has what was there at the last flush: here at every third step, when a checkpoint is written. That
    it is flushed every two seconds as well is tested in history_flush.c."""
    path = tmp_path / "history.h5"
    flushes = ["-checkpoint", tmp_path / "c.h5", "-checkpoint_interval", "3"]
    with held(words(tmp_path, *paced(1e-7).split(), "-output_history", path, "-output_summary", tmp_path / "summary.json", *flushes), tmp_path) as run:
        run.until(1)  # what the line before tells of has been written
        lengths = []
        while len(set(lengths)) < 5:  # it has been flushed on the way
            run.print_lines(run.lines + 1)
            lengths.append(check_whole(path))
        run.kill()
    assert lengths == sorted(lengths)
    assert check_whole(path) >= lengths[-1]
    assert not (tmp_path / "summary.json").exists()


def test_monitor_lines(launch, tmp_path):
    run = launch(words(tmp_path, "-time_step", "1e-7", "-monitor_interval", "1000"), cwd=tmp_path)
    assert run.returncode == 0
    lines = [line for line in run.stdout.splitlines() if re.match(r"step +\d+ ", line)]
    found = [re.match(r"step +(\d+) +time +(\S+) s .*energy error +(\S+) .*gap +(\S+) m .*active (\d+) .*force +(\S+) N .*sweeps (\d+)", line) for line in lines]
    assert all(found), lines
    assert [int(line[1]) for line in found] == list(range(0, 10001, 1000))
    np.testing.assert_allclose([float(line[2]) for line in found], np.linspace(-2e-4, 8e-4, 11), atol=1e-12)
    assert [int(line[5]) for line in found] == [0, 0, 0, 1, 1, 1, 1, 1, 0, 0, 0]  # from 0 to 5.009e-4 s
    np.testing.assert_allclose([float(line[6]) for line in found[3:7]], 100, rtol=1e-4)  # measured: 1.1e-5
    assert not run.stderr


def test_no_monitor_lines_unasked(launch, tmp_path):
    run = launch(words(tmp_path, "-time_step", "1e-7", "-time_end", "-1.9e-4"), cwd=tmp_path)
    assert run.returncode == 0
    assert not re.search(r"^step ", run.stdout, re.MULTILINE)
