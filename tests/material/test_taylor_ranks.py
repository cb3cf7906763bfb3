"""A copper rod that hits an elastic body of 100 times its impedance, on 1 to 4 ranks: plastic flow and contact are the same."""

import numpy as np
import pytest
from cases import long

ROD = (
    "-rod_dm_plex_dim 3 -rod_dm_plex_shape rod -rod_rod_radius 3.2e-3 -rod_rod_length 32.4e-3 -rod_rod_divisions 4 -rod_rod_elements 16 -rod_rod_part quarter -rod_density 8930 -rod_youngs_modulus 117e9 "
    "-rod_poissons_ratio 0.35 -rod_yield_stress 400e6 -rod_hardening_modulus 100e6 -rod_initial_velocity 0,0,-227 -rod_mass_type lumped -rod_mass_redistribute false"
)
ANVIL = (
    "-anvil_dm_plex_dim 3 -anvil_dm_plex_shape rod -anvil_rod_radius 6.4e-3 -anvil_rod_length 10e-3 -anvil_rod_divisions 4 -anvil_rod_elements 4 -anvil_rod_part quarter -anvil_translate 0,0,-10e-3 "
    "-anvil_density 893000 -anvil_youngs_modulus 117e11 -anvil_poissons_ratio 0.3 -anvil_mass_type lumped"
)
CUTS = " ".join(f"-{b}_boundary_displacement cut_x,cut_y -{b}_boundary_displacement_cut_x 0,free,free -{b}_boundary_displacement_cut_y free,0,free" for b in ("rod", "anvil"))
# small explicit bodies would be whole on one rank each
CASE = f"-rod_mesh_division graph -anvil_mesh_division graph -bodies rod,anvil -contact_pairs rod.zmin:anvil.zmax {ROD} {ANVIL} {CUTS}"
RUNS = {
    "explicit": "-rod_material_type j2 -rod_ts_type centraldifference -anvil_ts_type centraldifference -time_step 4e-8 -time_end 4e-6",
    "implicit": "-rod_material_type j2 -time_step 2e-7 -time_end 2e-6",
    "johnson-cook": "-rod_material_type johnson_cook -rod_hardening_exponent 0.31 -rod_rate_coefficient 0.025 -rod_softening_exponent 1.09 -rod_melting_temperature 1356 -rod_specific_heat 383 "
    "-rod_ts_type centraldifference -anvil_ts_type centraldifference -time_step 4e-8 -time_end 2e-6",
    "enhanced": "-rod_material_type j2 -rod_element_formulation enhanced -rod_ts_type centraldifference -anvil_ts_type centraldifference -time_step 4e-8 -time_end 1e-6",
    "composite": "-rod_material_type j2 -rod_dm_plex_simplex -rod_element_formulation composite -rod_ts_type centraldifference -anvil_ts_type centraldifference -time_step 2e-8 -time_end 1e-6",
}


def series(run):
    """What is to be the same at every step, and what it is measured by."""
    pair = next(iter(run.history["contact"].values()))
    found = {name: pair[name][()] for name in ("force", "active")}
    for b in ("rod", "anvil"):
        found |= {f"{b}.{name}": run.history[f"body/{b}/{name}"][()] for name in ("kinetic", "potential", "momentum")}
    found["plastic_work"] = run.history["body/rod/plastic_work"][()]
    return found


@pytest.mark.parametrize(("name", "ranks"), [("explicit", 3), *long(("implicit", 2), ("johnson-cook", 4), ("enhanced", 3), ("composite", 3))])
def test_ranks(name, ranks, shared_run):
    """At every step to 1e-10 of the largest value. Measured: 8e-15."""
    one, several = (series(shared_run(f"{CASE} {RUNS[name]}", n)) for n in (1, ranks))
    assert one["plastic_work"][-1] > 0.01 * one["rod.kinetic"][0]
    assert one["active"].max() > 4
    np.testing.assert_array_equal(several["active"], one["active"])
    for key, values in one.items():
        scale = np.abs(values).max()
        np.testing.assert_allclose(several[key], values, rtol=0, atol=1e-10 * scale, err_msg=key)
