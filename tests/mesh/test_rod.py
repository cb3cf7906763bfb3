"""Bodies that are rods have the mass of rods, whatever part of one they are, and surfaces to hold them by."""

import numpy as np
import pytest

ROD = (
    "-bodies a -a_dm_plex_shape rod -a_dm_plex_dim 3 -a_rod_radius 0.2 -a_rod_length 1.5 -a_density 1000 -a_youngs_modulus 1e9 "
    "-a_initial_velocity 0,0,1 -time_step 1e-6 -time_end 1e-6 "
)

CURVED = "-a_dm_plex_simplex true -a_element_formulation composite"


@pytest.mark.parametrize(
    ("more", "part"),
    [
        ("", 1),
        ("-a_rod_divisions 2 -a_rod_layers 3 -a_rod_elements 3", 1),
        ("-a_rod_part half", 0.5),
        (CURVED, 1),
        (f"{CURVED} -a_rod_part half -a_rod_divisions 2 -a_rod_layers 3", 0.5),
        ("-a_rod_part quarter -a_boundary_displacement cut_x,cut_y -a_boundary_displacement_cut_x 0,free,free -a_boundary_displacement_cut_y free,0,free", 0.25),
    ],
)
def test_mass(more, part, impakt):
    """To round-off, by the integration of the elements themselves. Measured: 3e-15."""
    run = impakt(ROD + more, ranks=2 if part == 0.25 else 1)
    assert run.history["body"]["a"]["momentum"][0, 2] == pytest.approx(1000 * np.pi * 0.2**2 * 1.5 * part, rel=1e-12)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ("-a_rod_radius 0", "-a_rod_radius 0.: must be positive"),
        ("-a_rod_length -1", "-a_rod_length -1.: must be positive"),
        ("-a_rod_elements 0", "-a_rod_elements 0: there must be at least 1"),
        ("-a_rod_part half -a_rod_divisions 3", "-a_rod_divisions 3: must be even"),
        (f"{CURVED} -a_rod_elements 2000000000", "-a_rod_elements 2000000000 are too many: take fewer"),
        ("-a_rod_elements 80000000", "4 divisions, 2 layers and 80000000 elements along it are too many: take fewer"),
        ("-a_dm_plex_dim 2 -a_initial_velocity 0,0", "-dm_plex_shape rod has 3 dimensions"),
    ],
)
def test_wrong_rods(more, says, impakt):
    assert says.replace("-dm", "-a_dm") in impakt(ROD + more, expect_failure=True).stderr
