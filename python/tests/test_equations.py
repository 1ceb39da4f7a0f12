import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import approx_fprime

import dalembert


def test_scipy_integrates_the_equations_to_our_motion():
    model = dalembert.load("double_pendulum")
    equations = model.equations(set={"l": 0.7})
    assert equations.names == ["theta1", "theta2", "theta1'", "theta2'"] and equations.t_span == (0.0, 10.0)
    theirs = solve_ivp(equations.rhs, (0, 2), equations.y0, "DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    ours = model.simulate(set={"l": 0.7}, until=2, digits=False).y[-1]
    assert np.allclose(theirs, ours, atol=1e-9)


@pytest.mark.parametrize("name", ["double_pendulum", "slider_crank", "motor", "double_pendulum_space"])
def test_slopes_are_those_of_the_rate(name):
    equations = dalembert.load(name).equations()
    y = dalembert.load(name).simulate(until=0.1, digits=False).y[-1]
    exact = equations.jacobian(0.1, y)
    assert exact.shape == (len(y), len(y))
    near = approx_fprime(y, lambda y: equations.rhs(0.1, y), 1e-7)
    assert np.allclose(exact, near, rtol=2e-5, atol=2e-5 * np.abs(exact).max())


def test_stiff_methods_take_the_jacobian():
    model = dalembert.load("double_pendulum")
    found = solve_ivp(model.rhs, (0, 1), [0.3, 0.2, 0, 0], "Radau", jac=model.jacobian, rtol=1e-9, atol=1e-9)
    ours = model.simulate(start={"theta1": 0.3, "theta2": 0.2}, until=1, digits=False)
    assert found.njev > 0 and np.allclose(found.y[:, -1], ours.y[-1], atol=1e-6)


def test_the_mass_matrix_is_that_of_the_kinetic_energy():
    model = dalembert.load("double_pendulum")
    y = np.array([0.4, 1.1, 0.7, -0.3])
    kinetic, potential = model.equations().energy(0.0, y)
    mass = model.mass_matrix(0.0, y)
    assert np.array_equal(mass, mass.T) and 0.5 * y[2:] @ mass @ y[2:] == pytest.approx(kinetic, rel=1e-14)
    rate = model.rhs(0.0, y)
    assert np.allclose(mass @ rate[2:] + model.equations().bias(0.0, y), 0, atol=1e-12)
    assert potential == pytest.approx(-10 * (1.5 * np.cos(0.4) + 0.5 * np.cos(1.1)), rel=1e-12)


def test_constraints_hold_with_their_multipliers():
    model = dalembert.load("slider_crank")
    equations = model.equations()
    y = model.simulate(until=1, digits=False).y[-1]
    a, J = equations.rhs(1.0, y)[3:], equations.constraint_matrix(1.0, y)
    assert np.allclose(equations.constraints(1.0, y), 0, atol=1e-10)
    force = equations.mass_matrix(1.0, y) @ a + equations.bias(1.0, y)
    assert np.allclose(force, J.T @ equations.multipliers(1.0, y), atol=1e-9)
    assert model.constraints == ["pin.x", "pin.y"]


def test_event_functions_end_a_flight():
    model = dalembert.load("bouncing_ball")
    equations = model.equations()
    bounce = equations.events()[0]
    assert (bounce.__name__, bounce.terminal, bounce.direction) == ("bounce", True, -1)
    found = solve_ivp(equations.rhs, (0, 1), equations.y0, events=equations.events(), rtol=1e-10, atol=1e-12)
    assert found.t_events[0][0] == pytest.approx(np.sqrt(2 / 9.81), rel=1e-9)
    assert model.simulate().events[0]["t"] == pytest.approx(found.t_events[0][0], rel=1e-9)


def test_discontinuities_are_on_the_side_of_the_state():
    text = "{name: Slide, parameters: {m: 1 kg, f: 2 N}, coordinates: {x: m}, kinetic_energy: m*x'^2/2, generalized_forces: {x: -f*sign(x')}, scene: {start: {x': 1}, until: 0.1}}"
    equations = dalembert.load(text).equations()
    assert [equations.rhs(0, [0, v])[1] for v in (1.0, -1.0, 3.0)] == [-2, 2, -2]


def test_outputs_are_those_of_a_run():
    model = dalembert.load("double_pendulum")
    motion = model.simulate(until=1, digits=False)
    assert np.array_equal(model.equations().outputs(1.0, motion.y[-1]), motion.outputs[-1])


def test_the_start_is_that_of_the_parameters():
    text = "{name: D, parameters: {m: 1 kg, L: 2 m, v: 1 m/s, T: L/v}, coordinates: {x: m}, kinetic_energy: m*x'^2/2, scene: {start: {x: L/4}, until: 3*T}}"
    model = dalembert.load(text)
    for L in (2, 4):
        equations = model.equations(set={"L": L})
        assert equations.y0[0] == L / 4 and equations.t_span == (0.0, 3 * L)
        assert np.array_equal(equations.y0, model.simulate(set={"L": L}, digits=False).y[0])


@pytest.mark.parametrize("name", ["slider_crank", "pendulum_cartesian", "stick_slip"])
def test_the_start_is_on_the_constraints(name):
    model = dalembert.load(name)
    equations = model.equations()
    assert np.allclose(equations.y0, model.simulate(digits=False).y[0], atol=1e-12)
    # A state of one's own wants no start.
    assert np.isfinite(equations.rhs(0.0, equations.y0 + 0.01)).all()


def test_a_state_that_is_no_number_is_called_that():
    with pytest.raises(dalembert.EvaluationError, match="not all finite"):
        dalembert.load("double_pendulum").rhs(0, [np.nan, 0, 0, 0])


def test_states_of_another_size_are_refused():
    with pytest.raises(ValueError, match="a state has 4 numbers, not 3"):
        dalembert.load("double_pendulum").rhs(0, [1, 2, 3])


def test_a_singular_mass_matrix_is_an_error():
    text = "{name: S, parameters: {m: 1 kg}, coordinates: {x: m}, kinetic_energy: m*x^2*x'^2/2/1 m^2, scene: {start: {x: 1}, until: 1}}"
    with pytest.raises(dalembert.EvaluationError):
        dalembert.load(text.replace("/1 m^2", "").replace("m: 1 kg", "m: 1 kg/m^2")).rhs(0, [0, 1])


SLIDE = """
name: Slide
parameters: {m: 1 kg, F: 3 N}
coordinates: {x: m}
bodies: {b: {mass: m, position: "[x, 0]"}}
friction: {rub: {rate: x', on: b, along: ground.x, limit: F}}
scene: {start: {x': -2 m/s}, until: 0.1}
"""
FLOOR = """
name: Floor
parameters: {m: 1 kg, g: 9.81 m/s^2, mu: 0.3}
coordinates: {x: m, y: m}
bodies: {b: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
contacts: {floor: {gap: y, on: b, normal: "[0, 1]", friction: mu}}
scenes:
  back: {start: {x': -2 m/s, y: 0}, until: 0.1}
  ahead: {start: {x': 2 m/s, y: 0}, until: 0.1}
  above: {start: {y: 1 m}, until: 0.1}
  below: {start: {y: -1 m}, until: 0.1}
"""


def test_friction_and_contacts_are_in_the_phase_of_the_start():
    slide = dalembert.load(SLIDE)
    equations = slide.equations()
    assert list(equations.rhs(0, equations.y0)) == [-2, 3] == list(slide.rhs(0, [0, -2]))
    assert slide.phases[equations.phase] == "rub slips backwards"
    end = solve_ivp(equations.rhs, (0, 0.1), equations.y0, rtol=1e-10, atol=1e-12).y[:, -1]
    assert np.allclose(end, slide.simulate(digits=False).y[-1], atol=1e-9)
    floor = dalembert.load(FLOOR)
    accelerations = {"back": [0.3 * 9.81, 0], "ahead": [-0.3 * 9.81, 0], "above": [0, -9.81]}
    for scene, expected in accelerations.items():
        equations = floor.equations(scene)
        assert np.allclose(equations.rhs(0, equations.y0)[2:], expected, atol=1e-12), scene
    # Without friction at 0 the start is the same, the phase of other parameters theirs.
    assert np.allclose(floor.equations("back", set={"mu": 0.5}).rhs(0, [0, 0, -2, 0])[2:], [0.5 * 9.81, 0], atol=1e-12)
    assert np.allclose(floor.equations("back", phase="floor open").rhs(0, [0, 0, -2, 0])[2:], [0, -9.81])


def test_a_start_that_decides_no_phase_is_an_error_unless_one_is_named():
    floor = dalembert.load(FLOOR)
    with pytest.raises(dalembert.EvaluationError, match="begins in no phase.*floor"):
        floor.equations("below")
    assert floor.equations("below", phase="floor open").rhs(0, [0, 1, 0, 0])[3] == -9.81


@pytest.mark.parametrize("name", ["ladder", "rocking_block", "two_blocks", "stick_slip", "eccentric_cylinder"])
def test_accelerations_at_the_start_are_those_of_the_run(name):
    model = dalembert.load(name)
    equations = model.equations()
    motion = model.simulate(until=1e-6, digits=False)
    rate = (motion.y[-1] - motion.y[0]) / motion.t[-1]
    assert np.allclose(equations.rhs(0, equations.y0), rate, atol=1e-3)


def test_events_are_those_of_the_phase_where_their_condition_holds():
    model = dalembert.load("eccentric_cylinder")
    equations = model.equations()
    found = solve_ivp(equations.rhs, equations.t_span, equations.y0, events=equations.events(), rtol=1e-9, atol=1e-9)
    names = [event.__name__ for event, times in zip(equations.events(), found.t_events) if len(times)]
    first = model.simulate(digits=False).events[0]
    assert names == [first["name"]] == ["unloaded"] and found.t[-1] == pytest.approx(first["t"], rel=1e-6)


FALL = """
name: Fall
parameters: {m: 1 kg, g: 10 m/s^2, h: 0.5 m, v: 1 m/s}
coordinates: {x: m, y: m}
bodies: {b: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
events:
  half: {when: y - h, direction: falling, if: x' - v, then: stop}
  land: {when: y, direction: falling, then: stop}
scene: {start: {y: 1, x': 0.5}, until: 1}
"""


@pytest.mark.parametrize(("speed", "event"), [(0.5, "land"), (2, "half")])
def test_events_do_not_happen_where_their_condition_does_not_hold(speed, event):
    model = dalembert.load(FALL)
    equations = model.equations()
    y0 = [0, 1, speed, 0]
    found = solve_ivp(equations.rhs, (0, 1), y0, events=equations.events(), max_step=0.01, rtol=1e-9, atol=1e-9)
    run = model.simulate(start={"x'": speed}, digits=False).events[0]
    names = [event.__name__ for event, times in zip(equations.events(), found.t_events) if len(times)]
    assert names == [run["name"]] == [event] and found.t[-1] == pytest.approx(run["t"], rel=1e-6)
