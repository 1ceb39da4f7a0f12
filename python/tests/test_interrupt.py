import signal
import subprocess
import sys
import textwrap
import threading
import time

import dalembert

LONG = "until=1e7, tolerance=1e-12, digits=False, every=1e6, max_steps=10**15"


def interrupted(work):
    """What a process prints that Ctrl-C reaches a second after it says that it begins, and how long it took from then on."""
    code = textwrap.dedent("""
        import signal
        import dalembert
        # A process that is started in the background ignores it.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        model = dalembert.load("double_pendulum")
        print("begins", flush=True)
        try:
            WORK
        except KeyboardInterrupt as error:
            motion = getattr(error, "motion", None)
            print(type(error).__name__, motion is not None and 0 < motion.t[-1] < 1e7)
            print(model.simulate(until=1).t[-1])
    """).replace("WORK", work)
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begins\n"
    time.sleep(1)
    process.send_signal(signal.SIGINT)
    began = time.monotonic()
    try:
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 0, err
    return out.splitlines(), time.monotonic() - began


def test_ctrl_c_ends_a_run_which_keeps_what_it_has():
    lines, seconds = interrupted(f"model.simulate({LONG})")
    assert lines == ["Interrupted True", "1.0"] and seconds < 20


def test_ctrl_c_ends_a_sweep():
    lines, seconds = interrupted(f"model.sweep({{'m': '1..2:100'}}, {LONG.replace('digits=False, ', '')})")
    assert lines == ["KeyboardInterrupt False", "1.0"] and seconds < 20


def test_ctrl_c_ends_a_search():
    lines, seconds = interrupted("model.solve({'theta1': 1}, such_that={'theta2': 0}, until=1e7, max_steps=10**15)")
    assert lines == ["KeyboardInterrupt False", "1.0"] and seconds < 20


def test_other_threads_go_on_during_a_run():
    model = dalembert.load("double_pendulum")
    done = threading.Event()
    counts = [0]

    def count():
        while not done.is_set():
            counts[0] += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    began = time.monotonic()
    model.simulate(until=400, tolerance=1e-12)
    seconds = time.monotonic() - began
    done.set()
    counter.join()
    # With the lock held there would be next to none.
    assert counts[0] > 20 * seconds


def test_runs_of_two_threads_do_not_disturb_each_other():
    model = dalembert.load("double_pendulum")
    found = {}

    def run(length):
        found[length] = model.simulate(set={"l": length}, digits=False).y[-1].tobytes()

    threads = [threading.Thread(target=run, args=(1 + k / 10,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(model.simulate(set={"l": length}, digits=False).y[-1].tobytes() == end for length, end in found.items())
