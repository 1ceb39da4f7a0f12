"""What was loaded stays what it is, whatever becomes of its files and wherever the process works."""

import pytest

import dalembert

ROAD = """
name: Car
parameters: {m: 1 kg, k: 100 N/m, c: 2 N*s/m, A: 1 m, T: 1 s}
coordinates: {y: m}
tables: {road: {file: road.csv}}
inputs: {base: "A*road(t/T)"}
bodies: {car: {mass: m, position: "[0, y]"}}
forces: {spring: {on: car, force: "[0, -k*(y - base) - c*y']"}}
scene: {start: {y: 0.1}, until: 0.5}
"""


@pytest.fixture()
def folders(tmp_path, monkeypatch):
    here, away = tmp_path / "here", tmp_path / "away"
    here.mkdir()
    away.mkdir()
    (here / "car.yaml").write_text(ROAD)
    (here / "road.csv").write_text("0,0\n1,0.1\n2,-0.1\n3,0\n")
    monkeypatch.chdir(here)
    return here, away


@pytest.mark.parametrize("gone", [False, True])
def test_a_table_is_that_of_the_time_of_loading(folders, monkeypatch, gone):
    here, away = folders
    car = dalembert.load("car.yaml")
    before = car.simulate(set={"k": "200 N/m"}).y.tobytes()
    monkeypatch.chdir(away)
    if gone:
        (here / "road.csv").unlink()
    assert car.simulate(set={"k": "200 N/m"}).y.tobytes() == before
    assert len(car.sweep({"k": "100 N/m..200 N/m:3"}).failed) == 0
    assert car.check().data["name"] == "car"
    assert car.modes().omega[0] == pytest.approx(10, rel=0.01)
    assert car.needs(all=True).data
