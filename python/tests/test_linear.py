import pathlib
import re

import control
import numpy as np
import pytest

import dalembert

README = pathlib.Path(__file__).parent.with_name("README.md").read_text(encoding="utf-8")
CART = re.search(r"`cart.yaml`:\n\n```yaml\n(.*?)```", README, re.DOTALL).group(1)
GAINS = ["kx", "k1", "k2", "kv", "kw1", "kw2"]


@pytest.fixture(scope="module")
def cart():
    return dalembert.load(CART)


@pytest.fixture(scope="module")
def linear(cart):
    return cart.linearise()


def test_matrices_have_names_and_units(linear):
    assert linear.coordinates == ["x", "theta1", "theta2"]
    assert linear.variables == ["x", "theta1", "theta2", "x'", "theta1'", "theta2'"]
    assert linear.units == ["m", "rad", "rad", "m/s", "rad/s", "rad/s"]
    assert (linear.inputs, linear.input_units) == (["push"], ["N"])
    assert linear.equilibrium == {"x": 0, "theta1": 0, "theta2": 0}
    assert np.array_equal(linear.F, [[1], [0], [0]])


def test_matrices_are_those_on_paper(linear):
    M, m, l, g = 1.0, 0.2, 0.5, 9.81
    assert np.allclose(
        linear.M, [[M + 2 * m, 2 * m * l, m * l], [2 * m * l, 2 * m * l**2, m * l**2], [m * l, m * l**2, m * l**2]], rtol=1e-14
    )
    assert np.allclose(linear.K, np.diag([0, -2 * m * g * l, -m * g * l]), rtol=1e-14)
    assert not linear.C.any()


def test_the_state_matrix_is_the_jacobian_of_the_rate(cart, linear):
    assert np.allclose(linear.A, cart.jacobian(0, np.zeros(6)), rtol=1e-12, atol=1e-12)
    assert np.allclose(linear.A[3:, :3], -np.linalg.solve(linear.M, linear.K), atol=1e-12)
    assert np.allclose(linear.B[3:], np.linalg.solve(linear.M, linear.F), atol=1e-13) and not linear.B[:3].any()


def test_modes_have_the_same_matrices(cart, linear):
    modes = cart.modes()
    assert np.array_equal(modes["M"], linear.M) and np.array_equal(modes["K"], linear.K)


def test_python_control_takes_systems_without_inputs():
    one = "{name: One, parameters: {T: 2 s}, states: {z: {unit: 1, rate: -z/T}}, scene: {start: {z: 1}, until: 1}}"
    system = dalembert.load(one).linearise().state_space()
    assert system.A.tolist() == [[-0.5]] and system.input_labels == ["none"] and not system.B.any()
    two = one.replace("z: {unit: 1, rate: -z/T}", "z: {unit: 1, rate: -z/T}, w: {unit: 1, rate: z/T - w/T}")
    assert dalembert.load(two).linearise().state_space().ninputs == 0
    system = dalembert.load(two).linearise(out="w").state_space()
    assert system.input_labels == ["none"] and system.C.tolist() == [[0, 1]]


def test_a_regulator_of_python_control_holds_our_simulation(cart, linear):
    system = linear.state_space()
    assert system.state_labels == linear.variables and system.input_labels == ["push"]
    gain, _, poles = control.lqr(system, np.diag([10, 100, 100, 1, 10, 10]), np.eye(1))
    gains = dict(zip(GAINS, gain[0]))
    closed = cart.linearise(set=gains)
    assert np.allclose(np.sort_complex(np.linalg.eigvals(closed.A)), np.sort_complex(poles), rtol=1e-6)
    motion = cart.simulate(set=gains)
    assert np.abs(motion.y[-1]).max() < 1e-2 and np.abs(motion["theta1"]).max() < 0.5
    fallen = cart.simulate()
    assert np.abs(fallen["theta1"]).max() > 1


def test_small_motions_of_the_closed_loop_are_those_of_control(cart, linear):
    gain, _, _ = control.lqr(linear.A, linear.B, np.eye(6), np.eye(1))
    start = {"theta1": 1e-5, "theta2": -2e-5}
    motion = cart.simulate(set=dict(zip(GAINS, gain[0])), start=start, tolerance=1e-11)
    closed = control.ss(linear.A - linear.B @ gain, linear.B, np.eye(6), 0)
    theirs = control.initial_response(closed, motion.t, [0, 1e-5, -2e-5, 0, 0, 0]).outputs
    assert np.allclose(motion.y, theirs.T, atol=1e-8)


def test_constraints_leave_independent_coordinates():
    linear = dalembert.load("four_bar").linearise()
    assert len(linear.coordinates) == 1 and linear.A.shape == (2, 2)
    modes = dalembert.load("four_bar").modes()
    assert np.array_equal(linear.K, modes["K"])


def test_models_with_states_of_first_order_have_a_and_b():
    model = dalembert.load("motor")
    linear, modes = model.linearise(), model.modes()
    assert np.array_equal(linear.A, modes["A"]) and np.array_equal(linear.B, modes["B"])
    assert linear.variables == modes["variables"] and linear.inputs == ["u"]
    with pytest.raises(AttributeError, match="states of first order"):
        linear.M


def test_rates_of_inputs_that_act_are_inputs_of_the_state():
    linear = dalembert.load("base_excitation").linearise()
    assert linear.inputs == ["force", "C", "D"] and linear["F_rates"] == [[0, 0, 1]]
    assert linear.state_inputs == ["force", "C", "D", "D'"]
    columns = np.hstack([linear.F, linear["F_rates"]])[:, [0, 1, 2, 5]]
    assert np.allclose(linear.B[1:], np.linalg.solve(linear.M, columns), atol=1e-13) and not linear.B[:1].any()


def test_a_model_without_inputs_has_an_empty_b():
    linear = dalembert.load("double_pendulum").linearise()
    assert linear.B.shape == (4, 0) and linear.F.shape == (2, 0)


def test_outputs_have_matrices(cart, tmp_path):
    linear = cart.linearise(out="tip,force,theta1'", in_="push,x")
    assert linear.outputs == ["tip.x", "tip.y", "force", "theta1'"] and linear.output_units == ["m", "m", "N", "rad/s"]
    assert linear.state_inputs[0] == "push" and linear.feedthrough.shape == (4, len(linear.state_inputs))
    assert np.allclose(linear.output_matrix[0], [1, 0.5, 0.5, 0, 0, 0]) and np.array_equal(linear.output_matrix[3], np.eye(6)[4])
    system = linear.state_space()
    assert system.output_labels == ["tip_x", "tip_y", "force", "theta1'"] and np.array_equal(system.C, linear.output_matrix)
    # The program writes the same.
    file = tmp_path / "cart.npz"
    cart._answer("modes", [f"--state-space={file}", "--in=push,x", "--out=tip,force,theta1'", "--json"])
    written = np.load(file)
    for name, ours in {"A": linear.A, "B": linear.B, "C": linear.output_matrix, "D": linear.feedthrough}.items():
        assert np.array_equal(written[name], ours), name
    assert list(written["inputs"]) == linear.state_inputs


def test_inputs_in_outputs_are_fed_through():
    spring = dalembert.load(
        "{name: Spring, parameters: {m: 2 kg, k: 8 N/m}, coordinates: {x: m}, inputs: {push: 0 N}, "
        "bodies: {block: {mass: m, position: '[x, 0]'}}, springs: {spring: {stretch: x, stiffness: k, along: ground.x, on: block}}, "
        "forces: {motor: {on: block, force: '[push, 0]'}}, outputs: {left: push - k*x}}"
    )
    linear = spring.linearise(out="left")
    assert np.allclose(linear.output_matrix, [[-8, 0]]) and np.allclose(linear.feedthrough, [[1]])


def test_outputs_are_the_state_where_none_are_named(linear):
    assert linear.outputs == linear.variables and np.array_equal(linear.output_matrix, np.eye(6))
    assert not linear.feedthrough.any() and linear.output_units == linear.units and linear.time is None


def test_departures_from_a_motion(cart):
    gains = {"k1": -60.0, "k2": 50.0}
    motion = cart.simulate(set=gains, tolerance=1e-12, until=0.4)
    linear = cart.linearise(set=gains, at_time=0.4, out="x,tip")
    assert linear.time == 0.4 and linear.place["theta1"] == pytest.approx(motion["theta1"][-1], abs=1e-9)
    state = [linear.place[name] for name in linear.variables]
    jacobian = cart.equations(set=gains).jacobian(0.4, state)
    assert np.allclose(linear.A, jacobian, rtol=1e-9, atol=1e-9)
    assert linear.outputs == ["x", "tip.x", "tip.y"] and np.array_equal(linear.output_matrix[0], np.eye(6)[0])
    modes = cart.modes(set=gains, at_time="400 ms")
    assert np.array_equal(modes["A"], linear.A)
    assert np.allclose(np.sort_complex(modes.eigenvalues), np.sort_complex(np.linalg.eigvals(linear.A)))
    for missing in [lambda: linear.M, lambda: linear.equilibrium, lambda: modes.omega, lambda: modes.frame()]:
        with pytest.raises(AttributeError):
            missing()
    with pytest.raises(dalembert.UsageError, match="about a rest"):
        cart.linearise(at_time=1, steady=True)


SHAKEN = """
name: Shaken
parameters: {m: 2 kg, k: 50 N/m, c: 3 N*s/m, A: 0.2 m, w: 3 rad/s}
coordinates: {x: m}
inputs: {base: 0 m, push: 0 N}
bodies: {b: {mass: m, position: "[x + base, 0]"}}
springs: {s: {stretch: x, stiffness: k, along: ground.x, on: b}}
forces: {air: {on: b, force: "[push - c*(x' + base'), 0]"}}
scene: {start: {x: 0.1}, until: 1}
"""


def test_rates_and_accelerations_of_inputs_are_forces():
    # m (x'' + base'') + c (x' + base') + k x = push.
    linear = dalembert.load(SHAKEN).linearise()
    assert linear.inputs == ["base", "push"] and (linear.M, linear.C, linear.K) == ([[2]], [[3]], [[50]])
    assert linear.F.tolist() == [[0, 1]] and linear.F_rates.tolist() == [[-3, 0]] and linear.F_accelerations.tolist() == [[-2, 0]]
    assert linear.state_inputs == ["base", "base'", "base''", "push"] and np.allclose(linear.B, [[0] * 4, [0, -1.5, -1, 0.5]])


def test_a_moved_base_moves_the_linear_model_as_scipy_moves_it():
    from scipy.integrate import solve_ivp

    model = dalembert.load(SHAKEN)
    linear, omega = model.linearise(), 3.0
    motion = model.simulate(input={"base": "A*sin(w*t)"}, tolerance=1e-11)

    def rate(t, y):
        base = 0.2 * np.array([np.sin(omega * t), omega * np.cos(omega * t), -(omega**2) * np.sin(omega * t)])
        u = [np.array([value, 0.0]) for value in base]
        forces = linear.F @ u[0] + linear.F_rates @ u[1] + linear.F_accelerations @ u[2]
        return np.concatenate([y[1:], np.linalg.solve(linear.M, forces - linear.C @ y[1:] - linear.K @ y[:1])])

    found = solve_ivp(rate, (0, 1), motion.y[0], rtol=1e-10, atol=1e-12, t_eval=motion.t)
    assert np.abs(found.y.T - motion.y).max() < 1e-7


@pytest.mark.parametrize("name", ["push", "base", "x"])
def test_inputs_are_those_that_were_asked_for(name):
    linear = dalembert.load(SHAKEN).linearise(in_=name)
    assert linear.inputs == [linear.state_inputs[0]] and linear.F.shape == (1, 1) and len(linear.input_units) == 1
    stacked = {f"{linear.inputs[0]}{prime}": F for prime, F in zip(["", "'", "''"], [linear.F, linear.F_rates, linear.F_accelerations])}
    acting = np.hstack([stacked[state_input] for state_input in linear.state_inputs])
    assert np.allclose(linear.B[1:], np.linalg.solve(linear.M, acting))


def test_models_of_first_order_and_motions_name_what_was_asked_for():
    motor = dalembert.load("motor")
    assert motor.linearise(in_="u").inputs == motor.linearise(in_="u").state_inputs == ["u"]
    shaken = dalembert.load(SHAKEN)
    assert shaken.linearise(at_time=0.5, in_="push").inputs == ["push"] and shaken.linearise(at_time=0.5).inputs == ["base", "push"]
