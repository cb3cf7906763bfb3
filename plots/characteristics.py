"""Impact of two elastic bars by the method of characteristics, as src/exact/characteristics.c has it, whose head says how.

A bar is a dict of `impedance` sqrt(E rho) A, `period` 2 L/c, and `velocity`, along the contact normal, which points from the first
bar to the second.
"""

from bisect import bisect_left

import numpy as np

ROUND_OFF = 1e-12


class Impact:
    """Contact force from `times` to the next of them, what goes out from the contact face of each bar, and its velocity."""

    def __init__(self, bars, gap, start, end):
        self.bars = bars
        self.times, self.forces = [start], []
        self.out, self.velocities = ([], []), ([], [])
        speed = max(abs(bar["velocity"]) for bar in bars)
        incoming, following = [bar["velocity"] / 2 for bar in bars], [0, 0]
        small, closed = ROUND_OFF * max(abs(start), end - start), gap <= ROUND_OFF
        while True:
            time = self.times[-1]
            closed = self._reflect(incoming, closed, ROUND_OFF * speed)
            rate = self.velocities[1][-1] - self.velocities[0][-1]
            arrivals = [self._arrival(side, following) for side in (0, 1)]
            closing = time + gap / -rate if not closed and rate < -ROUND_OFF * speed else np.inf
            now = min(closing, *arrivals)
            if now > end:
                break
            for side in (0, 1):
                if arrivals[side] <= now + small:
                    incoming[side] = self.out[side][following[side]]
                    following[side] += 1
            gap = 0 if closed else gap + rate * (now - time)
            closed = closed or closing <= now + small
            self.times.append(now)

    def _reflect(self, incoming, closed, small):
        """Force and outgoing waves of the newest event; whether the gap stays closed."""
        impedances = [bar["impedance"] for bar in self.bars]
        approach = 2 * (incoming[0] - incoming[1])
        force = approach / (1 / impedances[0] + 1 / impedances[1]) if closed and approach > small else 0
        self.forces.append(force)
        for side, sign in ((0, -1), (1, 1)):
            before = self.out[side][-1] if self.out[side] else self.bars[side]["velocity"] / 2
            out = incoming[side] + sign * force / impedances[side]
            self.out[side].append(before if abs(out - before) <= small else out)
            self.velocities[side].append(incoming[side] + self.out[side][-1])
        return closed and approach >= -small

    def _arrival(self, side, following):
        """When the next jump comes back from a free end."""
        out, k = self.out[side], following[side]
        while k < len(out) and out[k] == (out[k - 1] if k else self.bars[side]["velocity"] / 2):
            k += 1
        following[side] = k
        return self.times[k] + self.bars[side]["period"] if k < len(out) else np.inf

    def _at(self, values, times):
        """At a jump, the value before it."""
        span = max(abs(self.times[0]), times[-1] - self.times[0])
        return np.asarray(values)[np.maximum(np.searchsorted(self.times, times - ROUND_OFF * span) - 1, 0)]

    def force(self, times):
        return self._at(self.forces, times)

    def travelled(self, side, times):
        """How far the contact face has moved since the start."""
        way = np.concatenate([[0], np.cumsum(np.diff(self.times) * np.array(self.velocities[side][:-1]))])
        begin = np.searchsorted(self.times, times).clip(1) - 1
        return way[begin] + np.array(self.velocities[side])[begin] * (times - np.array(self.times)[begin])

    def velocity(self, side, times):
        """Of the contact face."""
        return self._at(self.velocities[side], times)

    def averages(self, side, times):
        """Kinetic energy, potential energy and mean velocity of a bar: a row for each. They are linear in time between the times at
        which a jump meets another one or an end of the bar."""
        period, events = self.bars[side]["period"], np.array(self.times)
        meetings = (events[:, None] + events[None, :] + period) / 2
        knots = np.unique([*events, *(events + period), *meetings.ravel(), times[0], times[-1]])
        knots = knots[(knots >= times[0]) & (knots <= times[-1])]
        values = np.array([self._averages(side, knot) for knot in knots]).T
        return np.array([np.interp(times, knots, each) for each in values])

    def _averages(self, side, time):
        period, impedance = self.bars[side]["period"], self.bars[side]["impedance"]
        jumps = [time - each for each in self.times] + [each - (time - period) for each in self.times]
        edges = np.unique([0, period / 2, *(jump for jump in jumps if 0 < jump < period / 2)])
        middles, widths = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
        out, coming = (np.array([self._sent(side, each) for each in sent]) for sent in (time - middles, time - period + middles))
        energies = [impedance / 2 * np.sum(widths * (out + sign * coming) ** 2) for sign in (1, -1)]
        return [*energies, np.sum(widths * (out + coming)) / (period / 2)]

    def _sent(self, side, time):
        k = bisect_left(self.times, time)
        return self.out[side][k - 1] if k else self.bars[side]["velocity"] / 2
