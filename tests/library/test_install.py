"""What `make install` puts where, and what it keeps to itself."""

import re
import shutil
import sys

import pytest
from conftest import ROOT
from installed import environment, installed, make_install, pkg_config, run  # noqa: F401


def headers(prefix):
    return sorted(path.relative_to(prefix / "include") for path in (prefix / "include").rglob("*.h"))


def test_everything_is_there(installed):  # noqa: F811
    prefix, version = installed.prefix, pkg_config(installed.prefix, "--modversion")[0]
    interface = version.rsplit(".", 1)[0]
    assert (prefix / "bin/impakt").stat().st_mode & 0o111
    assert (prefix / "lib/libimpakt.so").resolve() == (prefix / f"lib/libimpakt.so.{version}").resolve()
    assert (prefix / f"lib/libimpakt.so.{interface}").resolve() == (prefix / f"lib/libimpakt.so.{version}").resolve()
    assert f"SONAME               libimpakt.so.{interface}\n" in run(["objdump", "-p", prefix / "lib/libimpakt.so"])
    source = ROOT / "include"
    assert headers(prefix) == sorted(path.relative_to(source) for path in source.rglob("*.h"))
    macros = dict(re.findall(r"#define IMPAKT_VERSION_(MAJOR|MINOR|SUBMINOR) +(\d+)", (prefix / "include/impakt/version.h").read_text()))
    assert version == ".".join(macros[name] for name in ("MAJOR", "MINOR", "SUBMINOR"))
    assert re.search(rf"^version: {re.escape(version)}$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE)


def test_the_program_runs_from_there(installed, launch, tmp_path):  # noqa: F811
    options = ROOT / "src/controller/tutorials/observer.opts"
    done = launch([installed.prefix / "bin/impakt", "-options_file", options, "-time_end", "1e-4"], cwd=tmp_path, env=environment)
    assert done.returncode == 0
    assert "energy and momentum" in done.stdout


def test_plots_and_options_are_there(installed, tmp_path):  # noqa: F811
    """The files of both folders themselves, and a study that runs and draws a case from there."""
    share = installed.prefix / "share/impakt"
    for folder, kind in (("plots", "*.py"), ("options", "*.opts")):
        there = {path.name: path.read_bytes() for path in (share / folder).iterdir()}
        assert there == {path.name: path.read_bytes() for path in (ROOT / folder).glob(kind)}
    words = [share / "options/rigid-mass.opts", tmp_path / "study.png", "--vary", "time_step=1e-6,2e-6", "--options", "-time_end 1e-5"]
    run([sys.executable, share / "plots/study.py", *words], cwd=share, env=environment)
    assert (tmp_path / "study.png").read_bytes()[:4] == b"\x89PNG"


# These want a shape's definitions before them, as src/element/hex8.h has them
TEMPLATES = ("solidaffine.h", "solidbatch.h", "solidloops.h", "solidops.h")


def check_syntax(words, text, installed, tmp_path):  # noqa: F811
    source = tmp_path / "header.c"
    source.write_text(text)
    flags = [word.replace("-I", "-isystem", 1) if not word.startswith(f"-I{installed.prefix}") else word for word in installed.cflags]
    run([*words, "-Wall", "-Wextra", "-Werror", "-fsyntax-only", *flags, str(source)])


@pytest.mark.long
def test_each_header_stands_alone(installed, tmp_path):  # noqa: F811
    """Public and private ones, with installed headers alone"""
    for header in headers(installed.prefix):
        if header.name not in TEMPLATES:
            check_syntax(["cc", "-std=c11", "-fopenmp-simd"], f"#include <{header}>\n#include <{header}>\n", installed, tmp_path)


def test_public_headers_are_good_in_another_language(installed, tmp_path):  # noqa: F811
    if not shutil.which("c++"):
        pytest.skip("there is no c++")
    text = "".join(f"#include <{header}>\n" for header in headers(installed.prefix) if "private" not in header.parts)
    check_syntax(["c++", "-std=c++17", "-x", "c++"], text, installed, tmp_path)


def test_a_shape_needs_installed_headers_alone(installed, tmp_path):  # noqa: F811
    """An element of the library itself, taken out of it: it compiles as one file"""
    folder = tmp_path / "element"
    folder.mkdir()
    for name in ("hex8.c", "hex8.h"):
        (folder / name).write_text((ROOT / "src/element" / name).read_text())
    source = folder / "hex8.c"
    run(["cc", "-std=c11", "-fopenmp-simd", "-fsyntax-only", *installed.cflags, f"-I{tmp_path}", str(source)])


def test_internal_functions_stay_inside(installed):  # noqa: F811
    """Exported is what installed headers declare as PETSC_EXTERN, and nothing that they declare as PETSC_INTERN"""
    listing = run(["nm", "-D", "--defined-only", installed.prefix / "lib/libimpakt.so"])
    exported = {line.split()[2] for line in listing.splitlines()}
    text = "\n".join(path.read_text() for path in (installed.prefix / "include").rglob("*.h"))
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    intern = {name for line in re.findall(r"PETSC_INTERN([^;]*);", text) for name in re.findall(r"(\w+)\(|\bList\b", line)} - {""}
    assert intern
    assert not intern & exported
    for name in ("BodyCreate", "MaterialRegister", "ElementRegister", "ContactRegister", "ContactIntegrateForces", "ElementCreate_Solid"):
        assert name in exported
    for name in ("NamesRead", "ImpaktCite", "MeshBuild", "HistoryCreate", "BodySetUpLayout", "SurfaceSetUpNodes"):
        assert name not in exported


def test_prefix_may_be_staged(installed, tmp_path):  # noqa: F811
    """With DESTDIR all goes below a stage, but impakt.pc names the place where it will be"""
    stage = tmp_path / "stage"
    make_install("PREFIX=/opt/impakt", f"DESTDIR={stage}")
    assert "prefix=/opt/impakt\n" in (stage / "opt/impakt/lib/pkgconfig/impakt.pc").read_text()
    assert (stage / "opt/impakt/bin/impakt").exists()
