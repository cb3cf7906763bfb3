"""Lowest eigenfrequencies by free vibration: Lame's mode of a cube, bending of a cantilever."""

import numpy as np
import pytest
from cases import long
from solidmeshes import dim_of, made_by_options

PI = repr(np.pi)
NU = 0.3
LENGTH, HEIGHT = 1.0, 0.05
BETA = 1.8751040687119611  # cos cosh = -1
CANTILEVER = BETA**2 * np.sqrt(HEIGHT**2 / 12)  # Euler-Bernoulli, E = rho = 1: omega = beta^2 sqrt(E I / rho A) / L^2


def first_mode():
    """The velocity of the plane cantilever's first mode [m/s], 1e-4 times Euler and Bernoulli's shape; sections stay normal to the axis."""
    s = float((np.cos(BETA) + np.cosh(BETA)) / (np.sin(BETA) + np.sinh(BETA)))
    shape = f"cosh({BETA}*x)-cos({BETA}*x)-({s!r})*(sinh({BETA}*x)-sin({BETA}*x))"
    slope = f"{BETA}*(sinh({BETA}*x)+sin({BETA}*x)-({s!r})*(cosh({BETA}*x)-cos({BETA}*x)))"
    return f"-1e-4*(y-{HEIGHT / 2})*({slope}),1e-4*({shape})"


def measured(impakt, options):
    """Angular frequency of the mode that carries most of the energy: half that of the peak in the spectrum of the kinetic energy, which is
    sin^2(omega t) of it. Hann's window; a parabola through the logarithms about the peak; 20 periods give it to 1e-4."""
    run = impakt(options)
    time, kinetic = run.history["time"][:], run.history["body/b/kinetic"][:].ravel()
    spectrum = np.log(np.abs(np.fft.rfft((kinetic - kinetic.mean()) * np.hanning(len(kinetic)), 16 * len(kinetic))))
    k = 32 + spectrum[32:].argmax()
    assert k > 20 * 16  # 20 periods of the energy at least: off what the window leaves of the mean
    left, middle, right = spectrum[k - 1 : k + 2]
    k += 0.5 * (left - right) / (left - 2 * middle + right)
    return np.pi * k / (16 * len(kinetic) * (time[1] - time[0]))


IMPLICIT = "alpha2 -b_mass_type averaged"
LAME = np.pi * np.sqrt(2) * np.sqrt(1 / (2 * (1 + NU)))  # E = rho = edge = 1


@pytest.mark.parametrize(
    ("shape", "ts"),
    [("quad4", IMPLICIT), ("hex8", "centraldifference"), ("tet4", "centraldifference"), ("tri6", IMPLICIT), *long(("tri3", "centraldifference"), ("hex8", IMPLICIT), ("tet4", IMPLICIT))],
)
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


@pytest.mark.parametrize(("shape", "dim"), [("quad4", 2), *long(("hex8", 3))])
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
