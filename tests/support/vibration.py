"""Free vibrations: the first mode of a cantilever, and frequencies from histories."""

import numpy as np

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
