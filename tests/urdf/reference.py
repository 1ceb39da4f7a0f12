"""Motion of the robots in this folder, from their URDF alone, in 40 digits: writes ../reference/urdf.json.

pip install mpmath
python reference.py

Nothing is shared with the program: frames are products of matrices by Rodrigues' formula, M = sum of m Jv^T Jv + Jw^T I Jw with
geometric Jacobians of every centre of mass, forces by Newton's and Euler's equations of every link with the rates of these Jacobians,
mimicking joints by the matrix that maps free rates to all rates. Kinetic energies are compared with those of places and turns
differentiated numerically. `benchmarks/pinocchio_arm.py` compares arm6 with Pinocchio.
"""

import json
import pathlib
import xml.etree.ElementTree as tree

from mpmath import cos, matrix, mp, mpf, sin, sqrt

mp.dps = 40
HERE = pathlib.Path(__file__).parent
GRAVITY = mpf("9.81")


def vector(text):
    return matrix([mpf(word) for word in text.split()])


def cross(a, b):
    return matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def skew(a):
    return matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def about(axis, angle):
    k = skew(axis / sqrt(dot(axis, axis)))
    return mp.eye(3) + sin(angle) * k + (1 - cos(angle)) * k * k


def pose(element):
    origin = None if element is None else element.find("origin")
    get = lambda name: vector("0 0 0" if origin is None else origin.get(name, "0 0 0"))
    angles = get("rpy")
    x, y, z = [matrix([int(i == k) for i in range(3)]) for k in range(3)]
    return get("xyz"), about(z, angles[2]) * about(y, angles[1]) * about(x, angles[0])


def quaternion(w, x, y, z):
    q, n = matrix([x, y, z]), w * w + x * x + y * y + z * z
    return mp.eye(3) + 2 * (w * skew(q) + skew(q) * skew(q)) / n


class Robot:
    def __init__(self, name):
        root = tree.parse(HERE / f"{name}.urdf").getroot()
        self.links = {link.get("name"): link for link in root.findall("link")}
        self.joints = {joint.get("name"): joint for joint in root.findall("joint")}
        self.above = {joint.find("child").get("link"): joint for joint in self.joints.values()}

    def path(self, link):
        """Joints from the root to a link."""
        joints = []
        while link in self.above:
            joints.insert(0, self.above[link])
            link = joints[0].find("parent").get("link")
        return joints

    def value(self, name, q):
        mimic = self.joints[name].find("mimic")
        if mimic is None:
            return q[name]
        times, plus = mpf(mimic.get("multiplier", "1")), mpf(mimic.get("offset", "0"))
        return times * self.value(mimic.get("joint"), q) + plus

    def rate(self, name, v):
        mimic = self.joints[name].find("mimic")
        return v[name] if mimic is None else mpf(mimic.get("multiplier", "1")) * self.rate(mimic.get("joint"), v)

    def frames(self, link, q):
        """Of each joint on the way its axis and place in ground axes, and where the link is and how it is turned."""
        at, turn, seen = matrix([0, 0, 0]), mp.eye(3), []
        for joint in self.path(link):
            offset, turned = pose(joint)
            at, turn = at + turn * offset, turn * turned
            axis = joint.find("axis")
            axis = vector("1 0 0" if axis is None else axis.get("xyz"))
            axis = axis / sqrt(dot(axis, axis))
            kind, name = joint.get("type"), joint.get("name")
            if kind == "floating":
                x, attitude = q[name]
                seen.append((joint, turn.copy(), at))
                at, turn = at + turn * matrix(x), turn * quaternion(*attitude)
            elif kind == "planar":
                x, angle = q[name]
                seen.append((joint, turn.copy(), at))
                at, turn = at + turn * matrix([x[0], x[1], 0]), turn * about(axis, angle)
            elif kind in ("revolute", "continuous", "prismatic"):
                value = self.value(name, q)
                if kind == "prismatic":
                    at = at + turn * axis * value
                seen.append((joint, turn * axis, at))
                if kind != "prismatic":
                    turn = turn * about(axis, value)
        return seen, at, turn

    def masses(self, q):
        """Of each link with mass: name, mass, place of its centre, moments in ground axes, joints on the way."""
        for name, link in self.links.items():
            inertial = link.find("inertial")
            if inertial is None or name not in self.above:
                continue
            seen, at, turn = self.frames(name, q)
            offset, turned = pose(inertial)
            i = inertial.find("inertia")
            xx, yy, zz, xy, xz, yz = [mpf(i.get(k)) for k in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")]
            own = turn * turned
            moments = own * matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) * own.T
            yield name, mpf(inertial.find("mass").get("value")), at + turn * offset, moments, seen

    def potential(self, q):
        return sum(m * GRAVITY * at[2] for _, m, at, _, _ in self.masses(q))


def serial(robot, free, q, v):
    """M, and the accelerations under gravity and damping, of a robot whose joints have one coordinate each."""
    n = len(free)
    mass, force = mp.zeros(n), mp.zeros(n, 1)
    unit = lambda k: {name: mpf(int(name == free[k])) for name in free}
    share = [[robot.rate(name, unit(k)) for k in range(n)] for name in robot.joints if robot.joints[name].get("type") != "fixed"]
    moving = [name for name in robot.joints if robot.joints[name].get("type") != "fixed"]
    for name, m, centre, moments, seen in robot.masses(q):
        linear, angular = mp.zeros(3, n), mp.zeros(3, n)
        spin, speed, spin_rate, acceleration = [matrix([0, 0, 0]) for _ in range(4)]
        for joint, axis, at in seen:
            rate = robot.rate(joint.get("name"), v)
            row = share[moving.index(joint.get("name"))]
            slides = joint.get("type") == "prismatic"
            one = axis if slides else cross(axis, centre - at)
            for k in range(n):
                linear[:, k] += one * row[k]
                angular[:, k] += (matrix([0, 0, 0]) if slides else axis) * row[k]
        # Accelerations with all second derivatives 0: the rate of J along the motion, by the joints' own motion.
        for position, (joint, axis, at) in enumerate(seen):
            rate = robot.rate(joint.get("name"), v)
            before = [matrix([0, 0, 0]), matrix([0, 0, 0])]
            for other, other_axis, other_at in seen[:position]:
                other_rate = robot.rate(other.get("name"), v)
                if other.get("type") == "prismatic":
                    before[1] += other_axis * other_rate
                else:
                    before[0] += other_axis * other_rate
                    before[1] += cross(other_axis, at - other_at) * other_rate
            turning = cross(before[0], axis)
            if joint.get("type") == "prismatic":
                # The place of a sliding joint moves with it.
                acceleration += turning * rate
            else:
                spin_rate += turning * rate
                acceleration += cross(turning, centre - at) * rate
        # d/dt of axis x (centre - at): the second factor moves with the centre and with the joint.
        for position, (joint, axis, at) in enumerate(seen):
            if joint.get("type") == "prismatic":
                continue
            rate = robot.rate(joint.get("name"), v)
            relative = matrix([0, 0, 0])
            for place, (other, other_axis, other_at) in enumerate(seen):
                other_rate = robot.rate(other.get("name"), v)
                if other.get("type") == "prismatic":
                    relative += other_axis * other_rate * int(place > position)
                else:
                    arm = centre - other_at if place >= position else centre - at
                    relative += cross(other_axis, arm) * other_rate
            acceleration += cross(axis, relative) * rate
        for joint, axis, _ in seen:
            if joint.get("type") != "prismatic":
                spin += axis * robot.rate(joint.get("name"), v)
        couple = moments * spin_rate + cross(spin, moments * spin)
        inertia = m * (acceleration + matrix([0, 0, GRAVITY]))
        mass += m * linear.T * linear + angular.T * moments * angular
        force -= linear.T * inertia + angular.T * couple
    for name in moving:
        dynamics = robot.joints[name].find("dynamics")
        damping = mpf("0" if dynamics is None else dynamics.get("damping", "0"))
        row = share[moving.index(name)]
        for k in range(n):
            force[k] -= damping * robot.rate(name, v) * row[k]
    return mass, mp.lu_solve(mass, force)


def kinetic(robot, q, qdot):
    """Kinetic energy by the change of all places and turns along q + h q', by Richardson's extrapolation."""

    def at(h):
        moved = {}
        for name, value in q.items():
            shift = lambda a, b: [shift(x, y) for x, y in zip(a, b)] if isinstance(a, (list, tuple)) else a + h * b
            moved[name] = shift(value, qdot[name])
        return {name: (m, centre, self_turn(robot, name, moved)) for name, m, centre, _, _ in robot.masses(moved)}

    h = mpf(10) ** -9
    before, after = at(-h), at(h)
    energy = mpf(0)
    for name, m, _, moments, _ in robot.masses(q):
        velocity = (after[name][1] - before[name][1]) / (2 * h)
        turn = self_turn(robot, name, q)
        rate = (after[name][2] - before[name][2]) / (2 * h) * turn.T
        omega = matrix([rate[2, 1] - rate[1, 2], rate[0, 2] - rate[2, 0], rate[1, 0] - rate[0, 1]]) / 2
        energy += m * dot(velocity, velocity) / 2 + dot(omega, moments * omega) / 2
    return energy


def self_turn(robot, name, q):
    return robot.frames(name, q)[2]


def text(x):
    return mp.nstr(x, 20)


def one(name, free, states):
    robot = Robot(name)
    entries = []
    for q, v in states:
        q, v = [{joint: mpf(value) for joint, value in zip(free, numbers)} for numbers in (q, v)]
        mass, accelerations = serial(robot, free, q, v)
        rates = matrix([v[joint] for joint in free])
        kinetic_energy = (rates.T * mass * rates)[0] / 2
        check = kinetic(robot, q, v)
        assert abs(check - kinetic_energy) < mpf(10) ** -14 * kinetic_energy, (check, kinetic_energy)
        entries.append(
            {
                "q": [text(q[joint]) for joint in free],
                "v": [text(v[joint]) for joint in free],
                "mass_matrix": [[text(mass[i, j]) for j in range(len(free))] for i in range(len(free))],
                "accelerations": [text(x) for x in accelerations],
                "kinetic_energy": text(kinetic_energy),
                "potential_energy": text(robot.potential(q)),
            }
        )
    return {"joints": free, "states": entries}


def main():
    arm = one(
        "arm6",
        ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"],
        [
            (["0.3", "-0.7", "1.1", "-0.4", "0.9", "2.5"], ["0.5", "-1.2", "0.8", "1.5", "-0.6", "2"]),
            (["-2", "0.4", "-1.6", "2.2", "-1.3", "0.1"], ["1", "0.3", "-2.1", "0.2", "1.7", "-3"]),
        ],
    )
    crane = one(
        "crane",
        ["rail", "boom", "swing x", "swing y", "left"],
        [
            (["2.5", "0.4", "-0.3", "0.8", "0.02"], ["0.7", "-0.5", "1.1", "0.6", "0.05"]),
            (["1.2", "-0.9", "2.1", "-1.4", "0.035"], ["-1.3", "0.4", "-0.8", "2.2", "-0.1"]),
        ],
    )
    raft = Robot("buoys")
    numbers = lambda *words: [mpf(word) for word in words]
    q = {"afloat": [numbers("0.3", "-0.2", "0.5"), numbers("0.8", "0.3", "-0.4", "0.2")], "deck": [numbers("0.2", "-0.1"), mpf("0.7")]}
    v = {"afloat": [numbers("1", "0.4", "-0.6"), numbers("0.1", "0.5", "-0.2", "0.3")], "deck": [numbers("0.5", "0.9"), mpf("-1.1")]}
    # The length of the quaternion does not change: its rate is across it.
    attitude, rate = q["afloat"][1], v["afloat"][1]
    along = dot(attitude, rate) / dot(attitude, attitude)
    v["afloat"][1] = [b - along * a for a, b in zip(attitude, rate)]
    flat = lambda s: [text(x) for x in s["afloat"][0] + s["afloat"][1] + s["deck"][0] + [s["deck"][1]]]
    buoys = {"q": flat(q), "v": flat(v), "kinetic_energy": text(kinetic(raft, q, v)), "potential_energy": text(raft.potential(q))}
    how = "tests/urdf/reference.py: geometric Jacobians, Newton's and Euler's equations from the URDF alone, 40 digits; gravity 9.81"
    content = {"how": how, "arm6": arm, "crane": crane, "buoys": buoys}
    (HERE / "../reference/urdf.json").write_text(json.dumps(content, indent=1) + "\n")


if __name__ == "__main__":
    main()
