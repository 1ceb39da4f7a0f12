"""Three-link arm by Newton's and Euler's equations from the turret outwards and back, in 34 digits: writes three_link_arm.json and
three_link_arm_limp.json.

pip install mpmath
python arm.py

Each link is a body in vectors: accelerations outwards, forces and moments inwards; the columns of the mass matrix are the moments of unit
accelerations.  Steps and their extrapolation are those of tops.py.
"""

import json
import pathlib

from mpmath import cos, lu_solve, matrix, mp, mpf, nstr, pi, sin

from tops import G, UP, add, combined, cross, dot, run, times

mp.dps = 34
NONE = [mpf(0)] * 3


class Arm:
    """y = angles (3), rates (3)."""

    lengths = [mpf("0.4"), mpf("0.5"), mpf("0.4")]
    masses = [mpf(10), mpf(6), mpf(4)]
    moments = [["0.2", "0.2", "0.1"], ["0.13", "0.14", "0.02"], ["0.06", "0.06", "0.01"]]
    load = mpf(2)
    outputs = ["yaw", "shoulder", "elbow", "yaw'", "shoulder'", "elbow'", "hand.x", "hand.y", "hand.z"]

    def __init__(self, stiffness, damping):
        self.stiffness = [mpf(stiffness), mpf(stiffness), mpf(stiffness) / 4]
        self.damping = [mpf(damping), mpf(damping), mpf(damping) / 4]
        self.targets = [mpf("1.5"), mpf("0.4"), mpf("0.9")]

    def axes(self, q):
        """Of each link: x, y, z in ground axes."""
        x, y = [cos(q[0]), sin(q[0]), mpf(0)], [-sin(q[0]), cos(q[0]), mpf(0)]
        links = [[x, y, UP]]
        for angle in [q[1], q[1] + q[2]]:
            links.append([add(times(cos(angle), x), UP, -sin(angle)), y, add(times(sin(angle), x), UP, cos(angle))])
        return links

    def needed(self, q, v, a, weight):
        """The moments about the three hinges that give these accelerations."""
        links = self.axes(q)
        hinges = [UP, links[0][1], links[0][1]]
        w, turn, at = NONE, NONE, times(weight, UP)
        outwards = []
        for axes, hinge, rate, second, length in zip(links, hinges, v, a, self.lengths):
            turn = add(add(turn, cross(w, hinge), rate), hinge, second)
            w = add(w, hinge, rate)
            along = times(length, axes[2])
            there = add(add(at, cross(turn, along)), cross(w, cross(w, along)))
            outwards.append((w, turn, times(mpf("0.5"), add(at, there)), along))
            at = there
        force, moment = times(self.load, at), NONE
        found = []
        for k in (2, 1, 0):
            w, turn, centre, along = outwards[k]
            own = [mpf(i) for i in self.moments[k]]
            spin = combined([i * dot(p, w) for i, p in zip(own, links[k])], links[k])
            change = add(combined([i * dot(p, turn) for i, p in zip(own, links[k])], links[k]), cross(w, spin))
            push = times(self.masses[k], centre)
            moment = add(add(add(moment, cross(along, force)), change), cross(times(mpf("0.5"), along), push))
            force = add(force, push)
            found.append(dot(moment, hinges[k]))
        return found[::-1]

    def rate(self, y):
        q, v = y[:3], y[3:]
        drives = [k * (to - x) - c * r for k, c, to, x, r in zip(self.stiffness, self.damping, self.targets, q, v)]
        at_rest = self.needed(q, v, NONE, G)
        columns = [self.needed(q, NONE, [mpf(int(i == k)) for i in range(3)], mpf(0)) for k in range(3)]
        mass = matrix([[columns[j][i] for j in range(3)] for i in range(3)])
        return v + list(lu_solve(mass, matrix([d - r for d, r in zip(drives, at_rest)])))

    def observed(self, y):
        hand = NONE
        for axes, length in zip(self.axes(y[:3]), self.lengths):
            hand = add(hand, axes[2], length)
        return y + hand


def write(name, arm, start, until):
    first, second = [run(arm, start, until, 4, steps) for steps in (16, 22)]
    agreement = max(abs(a - b) for one, other in zip(first, second) for a, b in zip(one, other))
    states = [
        {"t": nstr(mpf(until) * (k + 1) / 4, 6), **{key: nstr(x, 16) for key, x in zip(arm.outputs, state)}}
        for k, state in enumerate(second)
    ]
    print(nstr(agreement, 3), states[-1])
    how = "tests/reference/space/arm.py: Newton and Euler from link to link; extrapolation, 16 and 22 steps between reports, 34 digits"
    content = {"model": "three_link_arm", "how": how, "agreement_abs": nstr(agreement, 3), "reference": states}
    (pathlib.Path(__file__).parent / f"{name}.json").write_text(json.dumps(content, indent=1) + "\n")
    print(name, nstr(agreement, 3), states[-1])


if __name__ == "__main__":
    write("three_link_arm", Arm(400, 40), [0, mpf("1.2"), mpf("1.6"), 0, 0, 0], 2)
    write("three_link_arm_limp", Arm(0, 0), [0, pi / 2, 0, 2, 0, 0], 2)
