"""FMUs of models in importers other than FMPy: `python importers.py PROGRAM`, after `pip install ecospy libcosimpy tbb`.

Ecos (its fmi4c reads FMI 2 and 3) and the Open Simulation Platform's libcosim (Modelon's FMI Library reads FMI 2) run each FMU as a
Co-Simulation slave in a hundred equal steps.  What is printed is by how much coordinates, speeds and states at the end differ from those
of `simulate`, in parts of the largest value that each has on the way.
"""

import csv
import json
import multiprocessing
import os
import subprocess
import sys
import tempfile

# Name, end of the run in s, scene: the models of runtime/tests/fmu.rs.
MODELS = [
    ("double_pendulum", 2, None),
    ("triple_pendulum", 3, None),
    ("base_excitation", 5, None),
    ("shaken_pendulum", 5, None),
    ("slider_crank", 2, None),
    ("chaplygin_sleigh", 5, None),
    ("rolling_disc", 2, None),
    ("stick_slip", 5, None),
    ("eccentric_cylinder", 1, "real"),
    ("bouncing_ball", 2, None),
    ("counter", 8, None),
    ("sampled_robot", 1, None),
    ("thermostat", 50, None),
    ("engine_map", 10, None),
    ("braking_car", 1, None),
    ("cannon_ball", 1, None),
    ("cannon_ball_quadratic", 1, None),
    ("bead_parabola", 1, None),
    ("damped_chain", 5, None),
    ("exponential_growth", 2, None),
]
STEPS = 100


def reference(program, name, until, scene, folder):
    """Columns of a run: name to (value at the end, largest size)."""
    table = os.path.join(folder, "run.csv")
    command = [program, "simulate", name, "--until", str(until), "--every", str(until / STEPS), "--csv", table]
    command += ["--tolerance", "1e-10", "--no-digits"] + (["--scene", scene] if scene else [])
    subprocess.run(command, check=True, capture_output=True)
    with open(table) as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    names = [title.split(" ")[0] for title in rows[0]]
    columns = {}
    for name, *values in zip(names, *rows[1:]):
        numbers = [float(value) for value in values if value not in ("", "?")]
        if len(numbers) == len(values):
            columns[name] = numbers[-1], max(map(abs, numbers))
    return columns


def by_ecos(fmu, until, names):
    from ecospy import EcosSimulation, EcosSimulationStructure

    structure = EcosSimulationStructure()
    structure.add_model("m", fmu)
    with EcosSimulation(structure=structure, step_size=until / STEPS) as simulation:
        simulation.init()
        simulation.step(STEPS)
        return {name: simulation.get_real("m::" + name) for name in names}


def by_libcosim(fmu, until, names):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    execution = CosimExecution.from_step_size(step_size=round(1e9 * until / STEPS))
    index = execution.add_local_slave(CosimLocalSlave(fmu_path=fmu, instance_name="m"))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    execution.step(STEPS)
    references = {variable.name.decode(): variable.reference for variable in execution.slave_variables(index)}
    values = observer.last_real_values(index, [references[name] for name in names])
    return dict(zip(names, values))


def run(answers, importer, *arguments):
    try:
        answers.put(importer(*arguments))
    except Exception as error:
        answers.put(repr(error))


def difference(importer, fmu, until, columns):
    """In a process of its own: what an importer prints, or ends by, concerns no other."""
    answers = multiprocessing.Queue()
    process = multiprocessing.Process(target=run, args=(answers, importer, fmu, until, list(columns)))
    process.start()
    process.join(120)
    if process.is_alive():
        process.kill()
        return "120 s"
    if answers.empty():
        return f"status {process.exitcode}"
    values = answers.get()
    if isinstance(values, str):
        return values
    worst = max(abs(values[name] - end) / size for name, (end, size) in columns.items() if size > 0)
    return f"{worst:.0e}"


def main():
    program = os.path.abspath(sys.argv[1])
    print("| model | s | Ecos, FMI 2 | Ecos, FMI 3 | libcosim, FMI 2 |\n| --- | ---: | ---: | ---: | ---: |")
    with tempfile.TemporaryDirectory() as folder:
        for name, until, scene in MODELS:
            scenes = ["--scene", scene] if scene else []
            told = subprocess.run([program, "simulate", name, "--json", "--no-digits"] + scenes, check=True, capture_output=True)
            described = json.loads(told.stdout)
            coordinates = list(described["q"])
            wanted = coordinates + [coordinate + "'" for coordinate in coordinates] + list(described["states"])
            columns = reference(program, name, until, scene, folder)
            columns = {column: columns[column] for column in wanted if column in columns}
            cells = []
            for importer, version in ((by_ecos, "2"), (by_ecos, "3"), (by_libcosim, "2")):
                fmu = os.path.join(folder, f"{name}{version}.fmu")
                if not os.path.exists(fmu):
                    subprocess.run([program, "export", name, "--fmi", version, "--fmu", fmu] + scenes, check=True, capture_output=True)
                cells.append(difference(importer, fmu, until, columns))
            print(f"| {name} | {until} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
