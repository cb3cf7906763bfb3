"""The controller steps of runs that a test interrupts. With STEPS=10 in the environment each of them makes ten times as many over the same physical
time, and with STEPS=0.1 ten times fewer: what a machine that is so much slower or faster would do in the same time. Every test has to pass with both."""

import os

STEPS = float(os.environ.get("STEPS", "1"))


def paced(time_step):
    """The option that makes the controller step."""
    return f"-time_step {time_step / STEPS:.12g}"


def paced_steps(number):
    """How many steps become of so many."""
    return round(number * STEPS)
