"""What goes to other processes, and what stays."""

import copy
import multiprocessing
import pickle

import numpy as np
import pytest

import dalembert
from test_files import folders  # noqa: F401


@pytest.fixture(scope="module")
def pendulum():
    return dalembert.load("double_pendulum")


def again(thing):
    return pickle.loads(pickle.dumps(thing))


def test_a_mechanism_is_derived_again_without_its_files(folders, monkeypatch):  # noqa: F811
    here, away = folders
    car = dalembert.load("car.yaml")
    before, told = car.simulate().y.tobytes(), pickle.dumps(car)
    monkeypatch.chdir(away)
    for file in here.iterdir():
        file.unlink()
    restored = pickle.loads(told)
    assert (restored.name, restored.source) == (car.name, car.source) and restored.simulate().y.tobytes() == before
    assert again(restored).needs(all=True).data == car.needs(all=True).data
    assert copy.deepcopy(car) is car and copy.copy(car) is car


def test_sizes_go_along():
    chain = dalembert.load("chain", sizes={"n": 4})
    assert again(chain).coordinates == chain.coordinates and len(chain.coordinates) == 4


def test_other_processes_run_a_mechanism_and_send_back_what_came_of_it(pendulum):
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        there = pool.apply(pendulum.simulate, kwds={"until": 1})
        with pytest.raises(dalembert.RunError) as raised:
            pool.apply(pendulum.simulate, kwds={"max_steps": 20})
    assert np.array_equal(there.y, pendulum.simulate(until=1).y)
    with pytest.raises(dalembert.RunError) as here:
        pendulum.simulate(max_steps=20)
    theirs, ours = raised.value, here.value
    assert (str(theirs), theirs.time, theirs.state) == (str(ours), ours.time, ours.state)
    assert np.array_equal(theirs.motion.y, ours.motion.y)


def test_of_a_motion_its_numbers_go(pendulum):
    motion = pendulum.simulate(until=1)
    for copied in (again(motion), copy.deepcopy(motion), again(again(motion))):
        assert list(copied) == list(motion) and all(np.array_equal(copied[name], motion[name]) for name in motion)
        assert (copied.json, copied.digits, copied.drift, copied.end) == (motion.json, motion.digits, motion.drift, motion.end)
        assert copied.unit("tip.x") == "m" and np.array_equal(copied.errors("theta1"), motion.errors("theta1"))
        assert copied.q.shape == motion.q.shape and copied.frame().equals(motion.frame())
        for ask in (copied.figure, copied.animation, lambda copied=copied: copied.at(0.5)):
            with pytest.raises(dalembert.UsageError, match="where it was computed"):
                ask()


def test_equations_and_modes_are_made_again(pendulum):
    equations = pendulum.equations(set={"l": "80 cm"})
    y = [0.1, 0.2, 0.3, 0.4]
    assert np.array_equal(again(equations).rhs(0, y), equations.rhs(0, y))
    modes = pendulum.modes()
    assert again(modes).shape_figure().svg == modes.shape_figure().svg


def test_compiled_equations_say_that_they_stay(pendulum):
    try:
        compiled = pendulum.compile()
    except dalembert.CompileError:
        pytest.skip("no C compiler")
    with pytest.raises(TypeError, match="compile it in the other one"):
        pickle.dumps(compiled)
