"""Rattleback and tippe top by Newton's and Euler's equations in vectors, in 34 digits: writes rattleback.json and tippe_top.json.

pip install mpmath
python tops.py

Axes of the body are nine numbers in ground axes, without angles; forces at the point of contact are eliminated by hand. Steps are
extrapolated (Gragg, Bulirsch, Stoer); a second run by steps of other lengths tells how many digits agree.
"""

import json
import pathlib

from mpmath import asin, atan2, cos, lu_solve, matrix, mp, mpf, nstr, pi, sin, sqrt

mp.dps = 34
G = mpf("9.81")
UP = [mpf(0), mpf(0), mpf(1)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def add(a, b, k=1):
    return [x + k * y for x, y in zip(a, b)]


def times(k, a):
    return [k * x for x in a]


def combined(weights, axes):
    return [sum(w * axis[k] for w, axis in zip(weights, axes)) for k in range(3)]


class Rattleback:
    """y = axes of the shape (9), angular velocity (3), place of the centre (2)."""

    m, axes2 = mpf(1), [mpf("0.2") ** 2, mpf("0.03") ** 2, mpf("0.02") ** 2]
    moments, delta = [mpf("2e-4"), mpf("1.6e-3"), mpf("1.7e-3")], mpf("-0.0143")
    outputs = ["yaw", "roll", "pitch", "yaw'", "x", "y"]

    def start(self, spin, pitch):
        c, s = cos(pitch), sin(pitch)
        # Turned about y, and then spun about the vertical: the rate of yaw is that of the whole.
        return [c, 0, -s, 0, 1, 0, s, 0, c] + times(spin, UP) + [mpf(0), mpf(0)]

    def inertia(self, axes, w):
        c, s = cos(self.delta), sin(self.delta)
        own = [add(times(c, axes[0]), axes[1], s), add(times(c, axes[1]), axes[0], -s), axes[2]]
        return combined([i * dot(p, w) for i, p in zip(self.moments, own)], own)

    def contact(self, axes, w):
        n = [axis[2] for axis in axes]
        rates = [cross(w, axis) for axis in axes]
        h = sqrt(sum(a * x * x for a, x in zip(self.axes2, n)))
        change = sum(a * x * rate[2] for a, x, rate in zip(self.axes2, n, rates)) / h
        weights = [-a * x / h for a, x in zip(self.axes2, n)]
        weight_rates = [-a * rate[2] / h + a * x * change / h**2 for a, x, rate in zip(self.axes2, n, rates)]
        return combined(weights, axes), add(combined(weight_rates, axes), combined(weights, rates)), rates

    def rate(self, y):
        axes, w = [y[0:3], y[3:6], y[6:9]], y[9:12]
        r, r_rate, rates = self.contact(axes, w)
        own = self.inertia(axes, w)
        # I w' + w x I w = r x m (a + g k), a = -w' x r - w x r'.
        right = add(times(-1, cross(w, own)), times(self.m, cross(r, add(times(G, UP), cross(w, r_rate), -1))))
        columns = []
        for k in range(3):
            unit = [mpf(int(i == k)) for i in range(3)]
            columns.append(add(self.inertia(axes, unit), times(self.m, cross(r, cross(unit, r)))))
        turn = lu_solve(matrix(3, 3) + matrix([[columns[j][i] for j in range(3)] for i in range(3)]), matrix(right))
        speed = cross(r, w)
        return sum(rates, []) + list(turn) + speed[:2]

    def observed(self, y):
        x, s, z, w = y[0:3], y[3:6], y[6:9], y[9:12]
        roll = asin(s[2])
        # Along the vertical, the line of nodes of roll, and the axis of pitch.
        yaw = atan2(-s[0], s[1])
        nodes = [cos(yaw), sin(yaw), 0]
        rates = lu_solve(matrix([[UP[i], nodes[i], s[i]] for i in range(3)]), matrix(w))
        return [yaw, roll, atan2(-x[2], z[2]), rates[0], y[12], y[13]]


class TippeTop:
    """y = axis of symmetry (3), angular momentum about the centre of mass (3), place (2) and speed (2) of that centre, along the ground."""

    m, radius, e, c = mpf("0.02"), mpf("0.02"), mpf("0.006"), mpf("0.05")
    outputs = ["theta", "spin", "centre.x", "centre.y", "normal"]

    def __init__(self):
        self.across = mpf(131) / 350 * self.m * self.radius**2
        self.along = mpf(2) / 5 * self.m * self.radius**2

    def start(self, theta, spin):
        s = [mpf(0), -sin(theta), cos(theta)]
        centre = times(-self.e, s)
        return s + times(self.along * spin, s) + centre[:2] + [mpf(0), mpf(0)]

    def turning(self, s, momentum):
        part = dot(momentum, s)
        return add(times(1 / self.across, momentum), s, part / self.along - part / self.across)

    def forces(self, y):
        s, momentum, v = y[0:3], y[3:6], y[8:10]
        w = self.turning(s, momentum)
        s_rate = cross(w, s)
        r = add(times(self.e, s), UP, -self.radius)
        material = add([v[0], v[1], -self.e * s_rate[2]], cross(w, r))
        drag = [-self.c * material[0], -self.c * material[1], mpf(0)]

        def height(normal):
            """m z'' - N + m g with this normal force; it is linear in it."""
            push = cross(r, add(drag, UP, normal))
            own = dot(momentum, s)
            own_rate = dot(push, s) + dot(momentum, s_rate)
            k = 1 / self.along - 1 / self.across
            w_rate = add(add(times(1 / self.across, push), s, own_rate * k), s_rate, own * k)
            s_second = add(cross(w_rate, s), cross(w, s_rate))
            return -self.m * self.e * s_second[2] - normal + self.m * G

        none = height(mpf(0))
        normal = none / (none - height(mpf(1)))
        return s_rate, cross(r, add(drag, UP, normal)), drag, normal, w

    def rate(self, y):
        s_rate, push, drag, _, _ = self.forces(y)
        return s_rate + push + y[8:10] + [drag[0] / self.m, drag[1] / self.m]

    def observed(self, y):
        _, _, _, normal, w = self.forces(y)
        return [atan2(sqrt(y[0] ** 2 + y[1] ** 2), y[2]), w[2], y[6], y[7], normal]


ROWS = 10


def step(rate, y, h):
    """Gragg's midpoint rule with 2, 4, ... substeps, extrapolated in the square of their length (Hairer, Norsett, Wanner, II.9)."""
    table = []
    for row in range(1, ROWS + 1):
        n = 2 * row
        d = h / n
        before, now = y, add(y, rate(y), d)
        for _ in range(n - 1):
            before, now = now, add(before, rate(now), 2 * d)
        line = [times(mpf("0.5"), add(add(before, now), rate(now), d))]
        for k in range(1, row):
            factor = (mpf(row) / (row - k)) ** 2 - 1
            line.append(add(line[k - 1], add(line[k - 1], table[-1][k - 1], -1), 1 / factor))
        table.append(line)
    return table[-1][-1]


def run(body, start, until, parts, steps):
    y, states = [mpf(x) for x in start], []
    for _ in range(parts):
        for _ in range(steps):
            y = step(body.rate, y, mpf(until) / parts / steps)
        states.append(body.observed(y))
        if len(states) > 1 and "yaw" in body.outputs:
            # The heading goes on beyond a half turn.
            states[-1][0] += 2 * pi * mp.nint((states[-2][0] - states[-1][0]) / (2 * pi))
    return states


def write(name, body, start, until, parts, steps, about):
    first, second = [run(body, start, until, parts, count) for count in steps]
    agreement = max(abs(a - b) for one, other in zip(first, second) for a, b in zip(one, other))
    states = [
        {"t": nstr(mpf(until) * (k + 1) / parts, 6), **{key: nstr(x, 24) for key, x in zip(body.outputs, state)}}
        for k, state in enumerate(second)
    ]
    how = f"tests/reference/space/tops.py: {about}; extrapolation, {steps[0]} and {steps[1]} steps between reports, 34 digits"
    content = {"model": name, "how": how, "agreement_abs": nstr(agreement, 3), "reference": states}
    (pathlib.Path(__file__).parent / f"{name}.json").write_text(json.dumps(content, indent=1) + "\n")
    print(name, nstr(agreement, 3), nstr(first[-1][0], 12))


if __name__ == "__main__":
    top = TippeTop()
    write("tippe_top", top, top.start(mpf("0.1"), mpf(155)), "0.5", 5, (30, 40), "angular momentum about the centre of mass")
    stone = Rattleback()
    write("rattleback", stone, stone.start(mpf(5), mpf("0.01")), 1, 5, (48, 64), "angular velocity, reaction of the table eliminated")
