"""Periodic motions by `orbit` and by SciPy's `solve_bvp`: time, and how far the period is off.

    cargo build --release --bin dalembert && python benchmarks/orbits.py target/release/dalembert

Both begin with the same guess.  `solve_bvp` (collocation of order 4 on a mesh that it refines, with its difference quotients) gets a closed curve of 40
points along a run from there, the period as a parameter and one condition on the phase; its least tolerance that ends is given too.  `orbit` finds by
itself how the motion closes, and tells multipliers as well.  Medians of five; the time of `orbit` is that of the whole program.
Periods are those of `tests/reference/orbits`.
"""

import json
import subprocess
import sys
import tempfile
import time
from statistics import median

import numpy as np
from scipy.integrate import solve_bvp, solve_ivp

OSCILLATOR = """name: VanDerPol
parameters: {mu: 1}
coordinates: {x: 1}
kinetic_energy: x'^2/2
potential_energy: x^2/2
generalized_forces: {x: mu*(1 - x^2)*x'}
scene: {start: {x: 2}, until: 40, tolerance: 1e-12}
"""

def pendulum(y):
    """The double pendulum of the library: two rods, m = l = 1, g = 10."""
    a, b, u, v = y
    c, s = np.cos(a - b) / 2, np.sin(a - b) / 2
    first, second = -15 * np.sin(a) - s * v**2, -5 * np.sin(b) + s * u**2
    det = 4 / 9 - c**2
    return np.array([u, v, (first / 3 - c * second) / det, (4 / 3 * second - c * first) / det])


def van_der_pol(mu):
    return lambda y: np.array([y[1], mu * (1 - y[0] ** 2) * y[1] - y[0]])


CASES = [
    ("van der Pol, mu = 1", van_der_pol(1), [2, 0], 6.6, "6.66328685932313018969968203", [OSCILLATOR, "--set", "mu=1"]),
    ("van der Pol, mu = 5", van_der_pol(5), [2, 0], 11.5, "11.6122306677195700345550662", [OSCILLATOR, "--set", "mu=5"]),
    (
        "double pendulum, mode 2, 2 J",
        pendulum,
        [-0.333009098977973, 0.700048337080748, 0, 0],
        1.15,
        "1.15443252373418824592483619",
        ["double_pendulum", "--from", "mode 2", "--energy", "2"],
    ),
]


def by_scipy(rate, start, guess, tolerance, free):
    count = [0]

    def scaled(s, y, p):
        count[0] += y.shape[1]
        slope = rate(y)
        if free:
            slope[len(y) // 2:] += p[1] * y[len(y) // 2:]
        return p[0] * slope

    s = np.linspace(0, 1, 41)
    run = solve_ivp(lambda t, y: rate(y), (0, guess), start, t_eval=guess * s, rtol=1e-8, atol=1e-8)
    curve = run.y.copy()
    curve[:, -1] = curve[:, 0]
    # The phase: the first coordinate turns at the start.  Of a family by energy the place is asked for, and a damping that comes out as 0 is unknown.
    if free:
        close = lambda a, b, p: np.concatenate([a - b, [a[len(a) // 2], a[0] - start[0]]])
    else:
        close = lambda a, b, p: np.append(a - b, a[len(a) // 2])
    began = time.perf_counter()
    found = solve_bvp(scaled, close, s, curve, p=[guess, 0] if free else [guess], tol=tolerance, max_nodes=200_000)
    return found, count[0], time.perf_counter() - began


def by_orbit(program, arguments):
    arguments = list(arguments)
    if "\n" in arguments[0]:
        with tempfile.NamedTemporaryFile("w", suffix=".yaml", delete=False) as file:
            file.write(arguments[0])
        arguments[0] = file.name
    began = time.perf_counter()
    done = subprocess.run([program, "orbit", *arguments, "--json"], capture_output=True, text=True, check=True)
    return json.loads(done.stdout), time.perf_counter() - began


def main():
    program = sys.argv[1]
    print("| motion | `solve_bvp`, tol | period off by | evaluations | nodes | ms | `orbit`: period off by | told | ms |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for name, rate, start, guess, period, arguments in CASES:
        exact = float(period)
        ours = [by_orbit(program, arguments) for _ in range(5)]
        found, ms = ours[0][0]["period"], 1e3 * median(seconds for _, seconds in ours)
        last = f"{abs(found['value'] - exact):.0e} | {found['error']:.0e} | {ms:.0f}"
        for tolerance in [1e-3, 1e-6, 1e-9, 1e-11]:
            theirs = [by_scipy(rate, start, guess, tolerance, rate is pendulum) for _ in range(3)]
            solution, count, _ = theirs[0]
            took = 1e3 * median(seconds for _, _, seconds in theirs)
            if solution.status == 0:
                told = f"{abs(solution.p[0] - exact):.0e} | {count} | {len(solution.x)} | {took:.0f}"
            else:
                told = f"({solution.message.strip().rstrip('.')[:40]}) | {count} | {len(solution.x)} | {took:.0f}"
            print(f"| {name} | {tolerance:.0e} | {told} | {last} |")
            name, last = "", " | | "


if __name__ == "__main__":
    main()
