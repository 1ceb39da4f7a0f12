import json

import numpy as np
import pandas as pd
import pytest

import dalembert


@pytest.fixture(scope="module")
def pendulum():
    return dalembert.load("double_pendulum")


@pytest.fixture(scope="module")
def motion(pendulum):
    return pendulum.simulate()


def without_seconds(text):
    """What `--json` prints, as text: 17 digits tell every bit."""
    return "\n".join(part for part in text.replace(", ", "\n").replace(",", "\n").split("\n") if '"seconds"' not in part)


@pytest.mark.parametrize(
    "name, options, words",
    [
        ("double_pendulum", {}, []),
        ("double_pendulum", {"until": 3, "set": {"m": 0.3}}, ["--until=3", "--set=m=0.3"]),
        ("slider_crank", {"tolerance": 1e-8}, ["--tolerance=1e-8"]),
        ("bouncing_ball", {"scene": "lively"}, ["--scene=lively"]),
        ("motor", {}, []),
        ("double_pendulum", {"slopes": ["m", "theta1"], "until": 1}, ["--slopes=m,theta1", "--until=1"]),
        ("slider_crank", {"by": "two_moments", "until": 1}, ["--by=two_moments", "--until=1"]),
    ],
)
def test_numbers_have_the_bits_of_the_programs_json(program, name, options, words):
    ours = dalembert.load(name).simulate(**options).json
    theirs = program("simulate", name, "--json", *words)
    assert without_seconds(ours) == without_seconds(theirs)


def test_arrays_have_the_same_bits_as_the_json(motion):
    assert [motion["theta1"][-1], motion["theta2'"][-1]] == [motion.data["q"]["theta1"], motion.data["v"]["theta2"]]
    assert [motion["tip.x"][-1], motion["tip.y"][-1]] == motion.data["outputs"]["tip"]
    assert motion.t[-1] == motion.data["t"] == 10


def test_arrays_are_views_of_one_memory(motion):
    assert motion.t.shape == (501,) and motion.y.shape == (501, 4) and motion.outputs.shape == (501, 4)
    addresses = {motion.y.ctypes.data, motion.y.ctypes.data, motion.q.ctypes.data, motion["theta1"].ctypes.data}
    assert len(addresses) == 1
    assert not motion.y.flags.owndata and np.shares_memory(motion.v, motion["theta2'"])
    with pytest.raises(ValueError):
        motion.t[0] = 1.0


def test_arrays_live_longer_than_their_motion():
    y = dalembert.load("simple_pendulum").simulate().y
    copy = y.copy()
    dalembert.load("double_pendulum").simulate()
    assert np.array_equal(y, copy)


def test_a_frame_has_all_columns_over_time(motion):
    frame = motion.frame()
    assert isinstance(frame, pd.DataFrame) and frame.index.name == "t"
    assert list(frame) == ["theta1", "theta2", "theta1'", "theta2'", "tip.x", "tip.y", "hinge_force.x", "hinge_force.y"]
    assert frame["tip.x"].iloc[-1] == motion["tip.x"][-1] and frame.index[-1] == 10


def test_digits_drift_and_warnings_come_along(pendulum, motion):
    assert motion.digits["theta1"] >= 4 and motion.drift["energy"] < 1e-9 and motion.warnings == []
    assert 0 < motion.errors("theta1")[-1] < 1e-4
    plain = pendulum.simulate(digits=False)
    assert plain.digits is None and plain.errors("theta1") is None
    assert np.array_equal(plain.y, motion.y)
    assert motion.unit("theta1'") == "rad/s" and motion.method == motion.data["method"]


def test_states_of_first_order_are_columns():
    motion = dalembert.load("motor").simulate()
    assert all(not name.startswith("∫") for name in motion)
    state = next(iter(dalembert.load("motor").states))
    assert motion[state][-1] == motion.data["states"][state]


def test_coordinates_and_rates_have_a_column_each_and_no_hidden_ones():
    model = dalembert.load(
        "{name: Lag, parameters: {m: 1 kg, k: 4 N/m, T: 1 s}, coordinates: {x: m}, states: {z: {unit: m, rate: (x - z)/T}}, "
        "bodies: {b: {mass: m, position: '[x, 0]'}}, springs: {s: {stretch: x - z, stiffness: k, along: ground.x, on: b}}, "
        "scene: {start: {x: 1, z: 0.5}, until: 1}}"
    )
    motion = model.simulate()
    assert motion.q.shape == motion.v.shape == (len(motion.t), 1) and motion.y.shape == (len(motion.t), 4)
    assert np.array_equal(motion.q[:, 0], motion["x"]) and np.array_equal(motion.v[:, 0], motion["x'"])
    assert not motion.q.flags.owndata and not motion.v.flags.writeable
    assert model.equations().names == ["x", "∫z", "x'", "z"] and np.array_equal(motion.y[0], model.equations().y0)


def test_dense_output_is_known_between_reported_times(pendulum, motion):
    states = motion.at([0.0, 3.14159, 10.0])
    assert np.array_equal(states[[0, 2]], motion.y[[0, -1]])
    finer = pendulum.simulate(until=3.14159, digits=False)
    assert np.allclose(states[1], finer.y[-1], atol=1e-7)
    with pytest.raises(ValueError, match="not a time"):
        motion.at(10.5)


def test_a_run_that_fails_comes_with_all_that_was_computed(pendulum):
    with pytest.raises(dalembert.RunError, match="steps") as raised:
        pendulum.simulate(max_steps=40)
    error = raised.value
    assert 0 < error.time < 10 and error.time == error.motion.t[-1]
    assert error.state["theta1"] == error.motion["theta1"][-1]
    whole = pendulum.simulate(digits=False)
    assert np.allclose(error.motion.at(error.time / 2), whole.at(error.time / 2), atol=1e-12)


def test_what_is_unknown_is_a_usage_error(pendulum):
    for options in ({"method": "dop854"}, {"tolerance": -1}, {"set": {"q": 1}}, {"until": "5 kg"}, {"by": "nobody"}):
        with pytest.raises(dalembert.UsageError):
            pendulum.simulate(**options)


def test_values_may_have_units(pendulum):
    motion = pendulum.simulate(start={"theta1": "30 deg", "theta1'": np.float64(0.25)}, until=np.int64(1))
    assert motion["theta1"][0] == pytest.approx(np.pi / 6, rel=1e-15) and motion["theta1'"][0] == 0.25


def test_pictures_are_shown_in_notebooks(motion):
    figure = motion.figure("theta1,theta2", "theta1:theta1'")
    assert figure._repr_html_().startswith("<svg") and "theta1&apos;" in figure.svg.replace("'", "&apos;")
    assert figure.svg != motion.figure().svg
    page = motion.animation("theta1")
    assert page.html.lstrip().lower().startswith("<!doctype html")
    assert page._repr_html_().startswith("<iframe srcdoc=") and "<script" not in page._repr_html_()
    assert "<svg" in motion._repr_html_()
    with pytest.raises(dalembert.UsageError):
        motion.figure("theta3")
    with pytest.raises(dalembert.UsageError):
        motion.animation("theta3")
    assert "drawOver" not in page.html and '"names":["hinge_force"]' in motion.animation(arrows="hinge_force").html
    assert '"names":["hinge_force","elbow_force"]' in motion.animation(arrows=True).html
    with pytest.raises(dalembert.UsageError, match="hinge_force"):
        motion.animation(arrows=["hinge_forse"])
    with pytest.raises(dalembert.UsageError, match="has no events"):
        motion.animation(mark_events=True)


def test_a_picture_is_that_of_the_program(program, motion, tmp_path):
    path = tmp_path / "run.svg"
    program("simulate", "double_pendulum", "--quiet", f"--plot={path}", "--show=theta1,theta2")
    motion.figure("theta1,theta2").save(tmp_path / "ours.svg")
    assert (tmp_path / "ours.svg").read_text() == path.read_text()


def test_json_is_what_data_was_read_from(motion):
    assert json.loads(motion.json) == motion.data


def test_columns_that_there_are_not_have_no_units_and_no_errors(motion):
    assert motion.unit("t") == "s" and motion.unit("tip.x") == "m" and motion.errors("theta1").shape == motion.t.shape
    for ask in (motion.unit, motion.errors, motion.__getitem__):
        with pytest.raises(KeyError, match="theta3"):
            ask("theta3")
