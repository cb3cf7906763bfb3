"""Lowest eigenfrequencies by free vibration: Lame's mode of a cube, bending of a cantilever."""

import numpy as np
import pytest
from solidmeshes import dim_of, made_by_options
from vibration import CANTILEVER, HEIGHT, LENGTH, first_mode, measured

PI = repr(np.pi)
NU = 0.3
LAME = np.pi * np.sqrt(2) * np.sqrt(1 / (2 * (1 + NU)))  # E = rho = edge = 1


@pytest.mark.parametrize("ts", ["alpha2 -b_mass_type averaged", "centraldifference"])
@pytest.mark.parametrize("shape", ["quad4", "hex8", "tri3", "tet4", "tri6"])
def test_lame_mode(impakt, shape, ts):
    """u = (cos(pi x) sin(pi y), -sin(pi x) cos(pi y), 0) sin(omega t) in the free unit cube. Its divergence is zero, so div sigma =
    mu lap u = -2 pi^2 mu u, and omega = pi sqrt(2) c_s. Stresses: xx = -yy = -2 mu pi sin(pi x) sin(pi y), xy = mu pi (cos cos - cos cos) = 0,
    zz = 0: none on any face, for every Poisson's ratio (Lame 1852; Graff, Wave Motion in Elastic Solids, section 8.3).
    Measured with 8 and 16 elements along an edge: 1.6 % and 0.6 % at most. The step alone adds up to 0.04 %, (omega dt)^2 / 12."""
    dim = dim_of(shape)
    velocity = f"0.001*cos({PI}*x)*sin({PI}*y),-0.001*sin({PI}*x)*cos({PI}*y)" + ",0" * (dim - 2)
    common = f"-bodies b -b_dm_plex_dim {dim} {made_by_options(shape)} -b_density 1 -b_youngs_modulus 1 -b_poissons_ratio {NU} -b_initial_velocity {velocity} -b_ts_type {ts}"
    errors = []
    for n in (8, 16):
        faces = f"{n},{n}" + (f",{n // 8}" if dim == 3 else "")  # nothing varies along z
        omega = measured(impakt, f"{common} -b_dm_plex_box_faces {faces} -time_step 0.025 -time_end 25")
        errors.append(omega / LAME - 1)
    assert abs(errors[1]) <= 0.01
    assert abs(errors[1]) <= max(0.6 * abs(errors[0]), 1e-3)  # converging, down to what step and spectrum leave


@pytest.mark.parametrize(("shape", "dim"), [("quad4", 2), ("hex8", 3)])
def test_cantilever(impakt, shape, dim):
    """A slender beam, 20 times as long as high, Poisson's ratio 0. Full integration stiffens bending by the shear of elements that cannot curve: by
    (h / H)^2 / 2 for elements of length h through the height H, half of that in the frequency: 6 %, 1.6 %, 0.4 %. Shear and rotatory inertia, which
    the theory lacks, lower it by 0.3 % (Timoshenko 1921)."""
    velocity = first_mode() + ",0" * (dim - 2)
    material = "-b_density 1 -b_youngs_modulus 1" + (" -b_plane_stress" if dim == 2 else "")
    held = f"-b_boundary_displacement xmin -b_boundary_displacement_xmin {','.join('0' * dim)}"
    errors = []
    for n in (40, 80, 160):
        box = f"-b_dm_plex_dim {dim} -b_dm_plex_box_faces {n},1{',1' * (dim - 2)} -b_dm_plex_box_upper {LENGTH},{HEIGHT}{',0.05' * (dim - 2)}"
        omega = measured(impakt, f"-bodies b {box} {material} {held} -b_initial_velocity {velocity} -time_step 2 -time_end 1300")
        errors.append(omega / CANTILEVER - 1)
    assert errors[0] == pytest.approx(0.0574, abs=0.002)
    assert errors[1] == pytest.approx(0.0125, abs=0.002)
    assert abs(errors[2]) <= 0.0025
