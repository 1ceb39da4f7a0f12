import json

import numpy as np
import pandas as pd
import pytest

import dalembert


@pytest.fixture(scope="module")
def pendulum():
    return dalembert.load("double_pendulum")


def test_a_sweep_of_a_thousand_runs_is_a_frame(pendulum):
    lengths = np.linspace(0.5, 2.0, 1000)
    sweep = pendulum.sweep({"l": lengths}, until=1, tolerance=1e-8)
    frame = sweep.frame()
    assert isinstance(frame, pd.DataFrame) and len(frame) == 1000 and len(sweep.failed) == 0
    assert np.array_equal(frame["l"], lengths) and np.array_equal(frame["run"], np.arange(1000))
    one = pendulum.simulate(set={"l": lengths[437]}, until=1, tolerance=1e-8, digits=False)
    assert sweep["theta1"][437] == one["theta1"][-1]
    assert sweep.figure.svg.startswith("<svg")


def test_a_table_has_the_bits_of_the_programs(pendulum, program):
    ours = pendulum.sweep({"m": "1..2:3", "theta1": [0.1, 0.2]}, until=1)
    assert ours.text == program("sweep", "double_pendulum", "--vary=m=1..2:3", "--vary=theta1=0.1,0.2", "--until=1", "--csv=-", "-q")


def test_points_are_a_mapping_or_a_frame(pendulum):
    points = {"m": [1.0, 2.0], "theta1": [0.1, 0.3]}
    sweeps = [pendulum.sweep(points=given, until=1) for given in (points, pd.DataFrame(points))]
    assert sweeps[0].text == sweeps[1].text and list(sweeps[0]["m"]) == points["m"]


def test_columns_of_different_lengths_are_refused(pendulum):
    with pytest.raises(dalembert.UsageError, match="m has 3, theta1 has 1"):
        pendulum.sweep(points={"m": [1.0, 2.0, 3.0], "theta1": [0.1]}, until=1)


def test_runs_that_fail_are_rows(pendulum):
    sweep = pendulum.sweep({"l": [1.0, 2.0]}, max_steps=60)
    assert list(sweep.failed) == [0, 1] and "steps" in sweep["error"][0]
    with pytest.raises(dalembert.UsageError, match="did you mean"):
        pendulum.sweep({"theta": [1.0]})


@pytest.mark.parametrize(
    "name, options, words",
    [
        ("three_masses", {}, []),
        ("double_pendulum", {"at": {"theta2": 3}}, ["--at=theta2=3"]),
        ("four_bar", {}, []),
        ("motor", {}, []),
    ],
)
def test_modes_have_the_bits_of_the_program(program, name, options, words):
    modes = dalembert.load(name).modes(**options)
    assert modes.json == program("modes", name, "--json", *words)


def test_modes_are_arrays_and_pictures():
    modes = dalembert.load("three_masses").modes()
    count = len(modes.omega)
    assert np.allclose(modes.hz * 2 * np.pi, modes.omega) and modes.shapes.shape == (count, count)
    mass, stiffness = np.array(modes["M"]), np.array(modes["K"])
    for omega, shape in zip(modes.omega, modes.shapes.T):
        assert np.allclose(stiffness @ shape, omega**2 * mass @ shape)
    assert list(modes.frame().index) == list(range(1, count + 1))
    assert "<svg" in modes._repr_html_() and "<html" in modes.animation(1).html.lower()


def test_an_orbit_has_its_period_and_multipliers(pendulum, program):
    orbit = pendulum.orbit(motion="swing")
    assert orbit.json == program("orbit", "double_pendulum", "--motion=swing", "--json")
    assert orbit.period > 1 and len(orbit.multipliers) == len(orbit["multipliers"]) > 0
    assert orbit.figure.svg.startswith("<svg")


def test_solve_finds_what_is_unknown(program):
    words = ["--unknown=theta'=1.0", "--such-that=theta=0.5", "--start=theta=0", "--until=0.3", "--json"]
    model = dalembert.load("simple_pendulum")
    found = model.solve({"theta'": 1.0}, such_that={"theta": 0.5}, start={"theta": 0}, until=0.3)
    assert found.json == program("solve", "simple_pendulum", *words)


def test_solve_follows_a_record():
    model = dalembert.load("simple_pendulum")
    motion = model.simulate(set={"l": 1.3}, until=2, digits=False)
    found = model.solve({"l": 1.0}, fit=motion.frame()[["theta"]].reset_index(), until=2)
    assert found["values"]["l"]["value"] == pytest.approx(1.3, abs=1e-6)


def test_needs_tells_what_a_scene_does_without(program):
    needs = dalembert.load("coupled_oscillators").needs(within=0.01)
    assert needs.json == program("needs", "coupled_oscillators", "--within=0.01", "--json")
    assert needs.figure.svg.startswith("<svg")


def test_check_tells_what_was_tested(pendulum, program):
    report = pendulum.check()
    assert report.json == program("check", "double_pendulum", "--json")
    assert {name for claim in report["agreements"] for name in claim["between"]} >= {"Lagrange", "virtual power"}


def test_a_chart_measures_methods():
    chart = dalembert.load("simple_pendulum").chart(methods=["dop853", "dopri5"], until=2)
    assert isinstance(chart.frame(), pd.DataFrame) and len(chart.frame()) > 4
    assert "dop853" in chart.text and chart.figure.svg.startswith("<svg") and "/" not in chart.text.splitlines()[-1]


def test_a_chart_goes_round_a_motion_that_repeats():
    chart = dalembert.load("simple_pendulum").chart(returns=3, methods=["verlet", "dop853"])
    assert "3 periods" in chart.text and set(chart.frame()["method"]) == {"verlet", "dop853"}


def test_a_search_that_finds_nothing_is_a_run_error():
    with pytest.raises(dalembert.RunError) as raised:
        dalembert.load("cannon_ball").modes()
    assert raised.value.motion is None and str(raised.value)


def test_reports_are_mappings(pendulum):
    report = pendulum.check()
    assert dict(report) == json.loads(report.json) and "name" in repr(report)
