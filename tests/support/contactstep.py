"""Bodies for tests of the contact step `-contact_type force`, and what must hold of any run with the rule `impulse`."""

import numpy as np
from cases import joined
from setups import box, material, plane, words

STEEL = (2e11, 0.3, 7800)
SI, MM_T_S = (1, 1), (1e3, 1e-3)


def model(name, of="linear_elastic", kept=True, units=SI):
    """Material and mass of a body of steel, whose contact nodes keep their mass; `of` may be j2, which flows at 300 MPa."""
    metre, kilogram = units
    e, nu, rho = STEEL
    flows = f"-{name}_yield_stress {3e8 * kilogram / metre:.17g} -{name}_hardening_modulus {1e9 * kilogram / metre:.17g}"
    return joined(
        f"-{name}_material_type {of} -{name}_mass_redistribute {str(not kept).lower()}",
        material(name, e * kilogram / metre, nu, rho * kilogram / metre**3),
        flows if of == "j2" else "",
    )


def integrator(name, step, substeps, kind, of="linear_elastic"):
    """kind I: implicit, with enhanced elements against locking in bending, unless the body flows; E: explicit."""
    how = "-{0}_ts_type centraldifference" if kind == "E" else "" if of == "j2" else "-{0}_element_formulation enhanced"
    return joined(how.format(name), f"-{name}_ts_time_step {step / substeps:.17g}")


def friction(mu):
    return f"-contact_law coulomb -contact_friction {mu}" if mu else ""


def turned(vector, degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s], [s, c]]) @ vector


def sheet_and_block(
    kinds="II",
    mu=0.2,
    step=1e-6,
    end=6e-4,
    substeps=(1, 1),
    pair="block:sheet",
    velocity=(2, -5),
    frame=(0, 0),
    turn=0,
    gap=1e-5,
    free=False,
    units=SI,
    of="linear_elastic",
    kept=(True, True),
    shift=0,
    more="",
):
    """The sheet and block of DESIGN.md, section 3: 0.2 m x 1 mm, one element thick, held at its ends, hit by a block of 20 mm. `frame`: a velocity that all
    has; `turn`: degrees by which all is turned; `free`: the sheet flies; `units`: how many of their units make a metre and a kilogram; `shift`: of the block along
    the sheet [m]."""
    metre = units[0]
    start = {"block": turned(velocity, turn) * metre + np.array(frame) * metre, "sheet": np.array(frame) * metre}
    boxes = {"block": ((8, 8), (shift - 0.01, gap), (shift + 0.01, 0.02 + gap)), "sheet": ((100, 1), (-0.1, -0.001), (0.1, 0))}
    led = ",".join(f"{v:.17g}*t" for v in start["sheet"])
    bodies = []
    for (name, (faces, low, high)), n, kind, keeps in zip(boxes.items(), substeps, kinds, kept, strict=True):
        bodies += [
            box(name, faces, [x * metre for x in low], [x * metre for x in high], f"-{name}_thickness {metre:.17g}"),
            model(name, of, keeps, units),
            f"-{name}_initial_velocity {words(start[name])}" if np.any(start[name]) else "",
            f"-{name}_rotate {turn}" if turn else "",
            integrator(name, step, n, kind, of),
        ]
    return joined(
        f"-bodies block,sheet -contact_type force -contact_pairs {pair} -time_step {step:.17g} -time_end {end:.17g}",
        *bodies,
        "" if free else f"-sheet_boundary_displacement xmin,xmax -sheet_boundary_displacement_xmin {led} -sheet_boundary_displacement_xmax {led}",
        "-units mm-t-s" if units == MM_T_S else "",
        friction(mu),
        more,
    )


def pressed_bars(kinds="II", mu=0, step=1e-6, end=1e-3, substeps=(1, 1), pair="a.xmax:b.xmin", at_rest=False, of="linear_elastic", kept=True, more=""):
    """Two bars, of 40 x 2 and 30 x 2 elements, held at their far ends and pressed on each other, so that they are shorter by 1e-4; through the first, unless all is
    `at_rest`, a pulse of 2 m/s comes that opens and closes the interface."""
    boxes = {"a": ((40, 2), (-0.1, 0), (0, 0.01)), "b": ((30, 2), (-2e-5, 0), (0.09998, 0.01))}
    strain = {"a": "-1e-4*(x+0.1),0", "b": "1e-4*(0.09998-x),0"}
    bodies = []
    for (name, (faces, low, high)), n, kind, held in zip(boxes.items(), substeps, kinds, ("xmin", "xmax"), strict=True):
        bodies += [
            box(name, faces, low, high),
            model(name, of, kept),
            f"-{name}_boundary_displacement {held} -{name}_boundary_displacement_{held} 0,0 -{name}_initial_displacement {strain[name]}",
            integrator(name, step, n, kind, of),
        ]
    pulse = "" if at_rest else "-a_initial_velocity 2*exp(-((x+0.05)/0.01)^2),0"
    return joined(f"-bodies a,b -contact_type force -contact_pairs {pair} -time_step {step:.17g} -time_end {end:.17g}", *bodies, pulse, friction(mu), more)


def block_on_plane(kind="I", mu=0.3, step=1e-6, end=6e-5, substeps=1, velocity=(2, -5), turn=0, gap=1e-5, of="linear_elastic", kept=True):
    """The block of sheet_and_block() hits an obstacle through the origin."""
    return joined(
        f"-bodies block -obstacles t -contact_type force -contact_pairs block:t -time_step {step:.17g} -time_end {end:.17g}",
        plane("t", (0, 0), turned((0, 1), turn)),
        box("block", (8, 8), (-0.01, gap), (0.01, 0.02 + gap)),
        model("block", of, kept),
        f"-block_initial_velocity {words(turned(velocity, turn))}",
        f"-block_rotate {turn}" if turn else "",
        integrator("block", step, substeps, kind, of),
        friction(mu),
    )


def cube_and_plate(kinds="II", mu=0.3, step=2e-6, end=2e-4, substeps=(1, 1), velocity=(1, 0.5, -5), pair="k:p", faces=(4, 20), kept=(True, True)):
    """A plate of 100 mm x 2 mm, one element thick, held at two sides, hit obliquely by a cube of 20 mm; `faces`: elements along an edge of the cube, and of the plate."""
    cube, plate = faces
    bodies = {"k": ((cube,) * 3, (-0.01, -0.01, 1e-5), (0.01, 0.01, 0.02001)), "p": ((plate, plate, 1), (-0.05, -0.05, -0.002), (0.05, 0.05, 0))}
    options = [joined(box(name, *of), model(name, kept=keeps), integrator(name, step, n, kind)) for (name, of), n, kind, keeps in zip(bodies.items(), substeps, kinds, kept, strict=True)]
    return joined(
        f"-bodies k,p -contact_type force -contact_pairs {pair} -time_step {step:.17g} -time_end {end:.17g}",
        *options,
        f"-k_initial_velocity {words(velocity)} -p_boundary_displacement xmin,xmax -p_boundary_displacement_xmin 0,0,0 -p_boundary_displacement_xmax 0,0,0",
        friction(mu),
    )


def energy(run):
    """Change of the system's energy, with what friction has taken, by the energy that is exchanged; from the first step on, as the acceleration of an explicit
    body that is pressed at the start has no contact force before, which makes its energy there too low."""
    change = run.history["energy/change"][()] / run.history["energy/scale"][()].max()
    return change[1:] - max(change[1], 0)


def pair_of(run):
    (pair,) = run.history["contact"]
    return pair


def impulse(run):
    """Of all contact forces on the first body of the pair [N s]."""
    return run.history[f"contact/{pair_of(run)}/impulse"][-1]


def momentum_error(run, name, load=0):
    """Change of a free body's momentum less the impulse of contact, and of a constant load on it [N], by the largest momentum: largest at any time."""
    momentum = run.history[f"body/{name}/momentum"][()]
    pushed = np.outer(run.history["time"][()], load * np.ones(momentum.shape[1]))
    change = momentum - momentum[0] - pushed
    of_contact = run.history[f"contact/{pair_of(run)}/impulse"][()][:, : momentum.shape[1]]
    sign = 1 if pair_of(run).startswith(name) else -1
    return min(np.abs(change - side * of_contact).max() for side in (sign, -sign)) / max(np.abs(momentum).max(), np.abs(pushed).max())


def kept_error(run, what, bodies, least=0):
    """Change of the sum over all bodies of `momentum` or `angular_momentum`, by the largest of one, or `least`: largest at any time."""
    of = [run.history[f"body/{body}/{what}"][()] for body in bodies]
    return np.abs(sum(of) - sum(of)[0]).max() / max(np.abs(of).max(), least)


def sweeps(run):
    """Of steps in contact: mean and largest number."""
    return run.summary["schwarz"]["mean_contact_steps"], run.summary["schwarz"]["max"]
