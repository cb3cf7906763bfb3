"""One figure on 1, 2, 3 and 4 ranks: solids of every shape, static, implicit and explicit, linear and not, with all loads."""

import os

import numpy as np
import pytest
from cases import long
from solidmeshes import dim_of, write_box

MATERIAL = "-b_density 1000 -b_youngs_modulus 1e5 -b_poissons_ratio 0.3"
LOADS = {
    2: "-b_boundary_displacement xmin -b_boundary_displacement_xmin 0.02*sin(30*t),free -b_boundary_traction xmax,ymin -b_boundary_traction_xmax 2e3*t,1e3*t -b_boundary_traction_ymin 500*ny,0 -b_gravity 0,-9.81 -b_initial_velocity y,-x*x",
    3: "-b_boundary_displacement xmin -b_boundary_displacement_xmin 0.02*sin(30*t),free,0 -b_boundary_traction xmax,ymin -b_boundary_traction_xmax 2e3*t,1e3*t,-500*t -b_boundary_traction_ymin 500*ny,0,0 -b_gravity 0,-9.81,1 -b_initial_velocity y,-x*x,z*x",
}
HELD = "-b_boundary_displacement xmin,xmax -b_boundary_displacement_xmin 0,0{z} -b_boundary_displacement_xmax 0.2*t,0.1*t{z}"
CASES = {
    "tri3-implicit": ("tri3", "linear_elastic -b_ts_type alpha2"),
    "quad4-nonlinear": ("quad4", "neo_hookean -b_ts_type alpha2 -b_element_formulation reduced"),
    "quad4-explicit": ("quad4", "saint_venant_kirchhoff -b_ts_type centraldifference"),
    "tet4-implicit": ("tet4", "linear_elastic -b_ts_type alpha2"),
    "tet4-explicit": ("tet4", "neo_hookean -b_ts_type centraldifference -b_ts_time_step auto"),
    "hex8-implicit": ("hex8", "linear_elastic -b_ts_type alpha2 -b_mass_type consistent"),
    "hex8-nonlinear": ("hex8", "neo_hookean -b_ts_type alpha2 -b_ts_alpha_alpha_m 0.5 -b_ts_alpha_alpha_f 0.5 -b_element_formulation mean_dilatation"),
    "hex8-explicit": ("hex8", "linear_elastic -b_ts_type centraldifference"),
    "hex8-static": ("hex8", "neo_hookean -b_ts_type static -b_element_formulation enhanced"),
    "tri3-static": ("tri3", "linear_elastic -b_plane_stress -b_ts_type static"),
    "tri6-implicit": ("tri6", "neo_hookean -b_ts_type alpha2"),
    "tet10-explicit": ("tet10", "saint_venant_kirchhoff -b_ts_type centraldifference -b_ts_time_step auto"),
    "tet10-static": ("tet10", "neo_hookean -b_ts_type static"),
    "tet10-composite": ("tet4", "linear_elastic -b_ts_type alpha2 -b_mass_type consistent -b_element_formulation composite"),
}


def mesh_file(shape, base):
    """One for all processes of pytest, so that they share runs; whole from the moment it is there."""
    if "PYTEST_XDIST_WORKER" in os.environ:
        base = base.parent
    path = base / f"ranks-{shape}.msh"
    if not path.exists():
        own = path.with_suffix(f".{os.getpid()}")
        write_box(own, shape, (5, 3, 2)[: dim_of(shape)], (0.5, 0.3, 0.2), 0.2)
        own.replace(path)
    return path


def figures(run):
    body = run.history["body/b"]
    found = {name: body[name][:] for name in ("kinetic", "potential", "external_work", "momentum", "angular_momentum")}
    found["displacement_error"] = np.array([run.summary["bodies"]["b"]["displacement_error"]])
    found["substeps"] = np.array([run.summary["bodies"]["b"]["substeps"]])
    return found


QUICK = [("quad4-nonlinear", 3), ("tet4-explicit", 2), ("hex8-static", 2), ("tri6-implicit", 2), ("tet10-composite", 3)]
MORE = ["tri3-implicit", "tet4-implicit", "hex8-implicit", "hex8-nonlinear", "hex8-explicit", "tri3-static", "quad4-explicit", "tet10-explicit", "tet10-static"]


@pytest.mark.parametrize(("case", "ranks"), [*QUICK, *long(*((case, 2 + i % 3) for i, case in enumerate(MORE)))])
def test_ranks(case, ranks, shared_run, tmp_path_factory):
    """Energies, work and momenta at every step, and the distance of all displacements from an arbitrary function at the end. 2e-14
    measured at most."""
    shape, physics = CASES[case]
    dim = dim_of(shape)
    path = mesh_file(shape, tmp_path_factory.getbasetemp())
    loads = HELD.format(z=",0" * (dim - 2)) if "static" in case else LOADS[dim]
    distance = ",".join(["0.1*x*y+0.01", "0.05*y-0.02", "0.03*x"][:dim])
    options = f"-bodies b -b_dm_plex_filename {path} {MATERIAL} {loads} -b_exact_displacement {distance} -time_step 1e-3 -time_end 0.05 -b_material_type {physics}"
    if "static" in case:
        options = options.replace("-time_step 1e-3 -time_end 0.05", "-time_step 0.25 -time_end 1")
    alone, together = (figures(shared_run(options, n)) for n in (1, ranks))
    for name, expected in alone.items():
        scale = np.abs(expected).max()
        assert np.abs(together[name] - expected).max() <= 1e-11 * scale, name
    assert np.abs(alone["potential"]).max() > 0.01
