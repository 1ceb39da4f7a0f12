"""What one run of many costs by heyoka's batch integrator: the scenes and starts of `ensembles`, one thread.

pip install heyoka; python heyoka_batch.py
"""

import statistics
import time

import heyoka as hy
import numpy as np

MEMBERS, ROUNDS, TOLERANCE = 256, 15, 1e-9


def double_pendulum():
    a, b, v, w = hy.make_vars("a", "b", "v", "w")
    c, s = hy.cos(a - b), hy.sin(a - b)
    m11, m12, m22 = 4 / 3, 0.5 * c, 1 / 3
    f = -0.5 * s * w * w - 15.0 * hy.sin(a)
    g = 0.5 * s * v * v - 5.0 * hy.sin(b)
    determinant = m11 * m22 - m12 * m12
    return [(a, v), (b, w), (v, (m22 * f - m12 * g) / determinant), (w, (m11 * g - m12 * f) / determinant)]


def kepler():
    x, y, u, v = hy.make_vars("x", "y", "u", "v")
    cube = (x * x + y * y) ** -1.5
    return [(x, u), (y, v), (u, -x * cube), (v, -y * cube)]


def figure_eight():
    names = ["x1", "x2", "x3", "y1", "y2", "y3"]
    q, v = hy.make_vars(*names), hy.make_vars(*["v" + name for name in names])
    a = [0.0] * 6
    for i, j in [(0, 1), (0, 2), (1, 2)]:
        dx, dy = q[j] - q[i], q[3 + j] - q[3 + i]
        factor = (dx * dx + dy * dy) ** -1.5
        a[i], a[j] = a[i] + factor * dx, a[j] - factor * dx
        a[3 + i], a[3 + j] = a[3 + i] + factor * dy, a[3 + j] - factor * dy
    return list(zip(q + v, v + a))


SCENES = [
    ("double pendulum, 3 s", double_pendulum(), [np.pi / 2, np.pi, 0, 0], 3.0),
    ("Kepler, 10 periods", kepler(), [1.6, 0, 0, 0.5], 62.8),
    (
        "figure eight, 10 s",
        figure_eight(),
        [0.97000436, -0.97000436, 0, -0.24308753, 0.24308753, 0]
        + [0.466203685, 0.466203685, -0.93240737, 0.43236573, 0.43236573, -0.86473146],
        10.0,
    ),
]

batch = hy.recommended_simd_size()
print(f"| scene | heyoka, batches of {batch}: µs a run | runs/s | error |")
print("| --- | ---: | ---: | ---: |")
for name, system, start, until in SCENES:
    states = np.tile(np.array(start, dtype=float)[:, None], MEMBERS)
    states[0] += 1e-3 * np.arange(MEMBERS) / MEMBERS
    integrator = hy.taylor_adaptive_batch(system, np.ascontiguousarray(states[:, :batch]), tol=TOLERANCE)
    times = []
    for _ in range(ROUNDS):
        began = time.perf_counter()
        for first in range(0, MEMBERS, batch):
            integrator.state[:] = states[:, first : first + batch]
            integrator.set_time(0.0)
            integrator.propagate_until(until)
        times.append(time.perf_counter() - began)
    exact = hy.taylor_adaptive(system, states[:, -1].copy(), tol=1e-15)
    exact.propagate_until(until)
    half = len(start) // 2
    error = np.abs(integrator.state[:half, -1] - exact.state[:half]).max()
    cost = 1e6 * statistics.median(times) / MEMBERS
    print(f"| {name} | {cost:.1f} | {1e6 / cost:.0f} | {error:.0e} |")
