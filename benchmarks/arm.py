"""Accelerations of the robot's arm of tests/urdf in C, beside Pinocchio, MuJoCo and code that CasADi generates.

pip install pin mujoco casadi
cargo build --release -p dalembert-models --manifest-path ../Cargo.toml
python arm.py ../target/release/dalembert [ROUNDS]

Each becomes a library with one function (q, q') -> q'', compiled by `-O3 -march=native`; one process calls them in turns with the same states.
Pinocchio runs its articulated-body algorithm, MuJoCo `mj_forward` with contacts, limits and all else off, CasADi the code of the same algorithm,
written here from Pinocchio's own joints and inertias.  Prints a table: medians, and the largest difference from Pinocchio's accelerations.
"""

import ctypes
import pathlib
import statistics
import subprocess
import sys
import tempfile

import casadi
import mujoco
import numpy as np
import pinocchio as pin

URDF = pathlib.Path(__file__).resolve().parent / "../tests/urdf/arm6.urdf"
STATES, CALLS = 64, 20000
GRAVITY = 9.81

DALEMBERT = """
#include "arm6.h"
static double c[ARM6_CONSTANTS];
void start(const char *urdf) { arm6_parameters p; (void)urdf; arm6_defaults(&p); arm6_constants(&p, c); }
void accelerations(const double *q, const double *v, double *a) { arm6_accelerations(c, 0, 0, q, v, a, 0); }
"""

PINOCCHIO = """
#include <pinocchio/algorithm/aba.hpp>
static pinocchio::Model model;
static pinocchio::Data *data;
static Eigen::VectorXd q, v, tau;
extern "C" void start(const char *urdf) {
    (void)urdf;
%(joints)s
    model.gravity.linear() << 0, 0, -%(gravity)s;
    data = new pinocchio::Data(model);
    q.setZero(model.nq); v.setZero(model.nv); tau.setZero(model.nv);
}
extern "C" void accelerations(const double *places, const double *speeds, double *a) {
    for (int i = 0; i < model.nv; i++) { q[i] = places[i]; v[i] = speeds[i]; }
    pinocchio::aba(model, *data, q, v, tau);
    for (int i = 0; i < model.nv; i++) a[i] = data->ddq[i];
}
"""

MUJOCO = """
#include <mujoco/mujoco.h>
#include <string.h>
static mjModel *model;
static mjData *data;
void start(const char *urdf) {
    char error[1000];
    model = mj_loadXML(urdf, 0, error, sizeof error);
    model->opt.gravity[2] = -%(gravity)s;
    model->opt.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_CONTACT | mjDSBL_LIMIT | mjDSBL_SENSOR | mjDSBL_ACTUATION;
    data = mj_makeData(model);
}
void accelerations(const double *q, const double *v, double *a) {
    memcpy(data->qpos, q, model->nq * sizeof *q);
    memcpy(data->qvel, v, model->nv * sizeof *v);
    mj_forward(model, data);
    memcpy(a, data->qacc, model->nv * sizeof *a);
}
"""

CASADI = """
#include "aba.c"
void start(const char *urdf) { (void)urdf; }
void accelerations(const double *q, const double *v, double *a) {
    const double *in[2] = {q, v};
    double *out[1] = {a};
    static long long iw[%(integers)s + 1];
    static double w[%(reals)s + 1];
    aba(in, out, iw, w, 0);
}
"""

DRIVER = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include <time.h>
double timed(void *function, const double *states, double *a, int n, int count, int calls) {
    void (*accelerations)(const double *, const double *, double *) = (void (*)(const double *, const double *, double *))function;
    struct timespec from, to;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
    for (int k = 0; k < calls; k++) {
        const double *state = states + 2 * n * (k % count);
        accelerations(state, state + n, a);
    }
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
    return ((to.tv_sec - from.tv_sec) * 1e9 + (to.tv_nsec - from.tv_nsec)) / calls;
}
"""


def joints(model):
    """The joints and bodies of Pinocchio's model as text, since its wheel has no headers of the parser; hinges about z."""
    vector = lambda x: "(Eigen::VectorXd(%d) << %s).finished()" % (x.size, ", ".join(map(repr, x.ravel().tolist())))
    matrix = lambda x: f"Eigen::Matrix3d((Eigen::Matrix3d() << {', '.join(map(repr, x.ravel().tolist()))}).finished())"
    lines = []
    for i in range(1, model.njoints):
        assert model.joints[i].shortname() == "JointModelRZ", model.joints[i].shortname()
        placement, body = model.jointPlacements[i], model.inertias[i]
        place = f"pinocchio::SE3({matrix(placement.rotation)}, Eigen::Vector3d({vector(placement.translation)}))"
        lines.append(f'    model.addJoint({model.parents[i]}, pinocchio::JointModelRZ(), {place}, "j{i}");')
        inertia = f"pinocchio::Inertia({body.mass!r}, Eigen::Vector3d({vector(body.lever)}), {matrix(body.inertia)})"
        lines.append(f"    model.appendBodyToJoint({i}, {inertia}, pinocchio::SE3::Identity());")
    return "\n".join(lines)


def cross(v):
    x, y, z = v[0], v[1], v[2]
    return casadi.vertcat(casadi.horzcat(0, -z, y), casadi.horzcat(z, 0, -x), casadi.horzcat(-y, x, 0))


def articulated(model):
    """The articulated-body algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, table 7.1), hinges about z, linear parts first."""
    n = model.nv
    q, v = casadi.SX.sym("q", n), casadi.SX.sym("v", n)
    motions, crossed, bias, inertias, velocities = [], [], [], [], []
    for i in range(n):
        placement = model.jointPlacements[i + 1]
        c, s = casadi.cos(q[i]), casadi.sin(q[i])
        rotation = casadi.blockcat([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        whole = casadi.mtimes(casadi.SX(np.round(placement.rotation, 12)), rotation)
        # Motions of the parent, along the joint's axes.
        at = cross(casadi.SX(placement.translation))
        motion = casadi.blockcat([[whole.T, -casadi.mtimes(whole.T, at)], [casadi.SX(3, 3), whole.T]])
        own = casadi.SX([0, 0, 0, 0, 0, 1])
        speed = own * v[i]
        velocity = speed if i == 0 else speed + casadi.mtimes(motion, velocities[-1])
        linear, angular = cross(velocity[:3]), cross(velocity[3:])
        inertia = casadi.SX(np.round(model.inertias[i + 1].matrix(), 14))
        carried = casadi.blockcat([[angular, linear], [casadi.SX(3, 3), angular]])
        force = casadi.blockcat([[angular, casadi.SX(3, 3)], [linear, angular]])
        motions.append(motion)
        crossed.append((casadi.mtimes(carried, speed), own))
        bias.append(casadi.mtimes(force, casadi.mtimes(inertia, velocity)))
        inertias.append(inertia)
        velocities.append(velocity)
    solved = [None] * n
    for i in reversed(range(n)):
        coriolis, own = crossed[i]
        u = casadi.mtimes(inertias[i], own)
        d = casadi.mtimes(own.T, u)
        left = -casadi.mtimes(own.T, bias[i])
        solved[i] = (u, d, left)
        if i > 0:
            inertia = inertias[i] - casadi.mtimes(u, u.T) / d
            force = bias[i] + casadi.mtimes(inertia, coriolis) + u * left / d
            inertias[i - 1] = inertias[i - 1] + casadi.mtimes([motions[i].T, inertia, motions[i]])
            bias[i - 1] = bias[i - 1] + casadi.mtimes(motions[i].T, force)
    acceleration = casadi.SX([0, 0, GRAVITY, 0, 0, 0])
    found = []
    for i in range(n):
        (coriolis, own), (u, d, left) = crossed[i], solved[i]
        acceleration = casadi.mtimes(motions[i], acceleration) + coriolis
        found.append((left - casadi.mtimes(u.T, acceleration)) / d)
        acceleration = acceleration + own * found[-1]
    return casadi.Function("aba", [q, v], [casadi.vertcat(*found)])


def main():
    program, rounds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 31
    folder = pathlib.Path(tempfile.mkdtemp())
    # A continuous joint as an angle, as for all others.
    urdf = folder / "arm6.urdf"
    urdf.write_text(URDF.read_text().replace('type="continuous"', 'type="revolute"').replace("<limit effort", "<limit lower=\"-9\" upper=\"9\" effort"))
    model = pin.buildModelFromUrdf(str(urdf))
    subprocess.run([program, "import", URDF, "-o", folder / "arm6.yaml"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([program, "export", folder / "arm6.yaml", "--c", folder], check=True, stdout=subprocess.DEVNULL)
    function = articulated(model)
    print(f"CasADi's function has {function.n_instructions()} instructions", file=sys.stderr)
    function.generate("aba.c", {"with_header": True})
    for name in ["aba.c", "aba.h"]:
        pathlib.Path(name).rename(folder / name)

    prefix = next(folder for folder in pathlib.Path(pin.__file__).parents if (folder / "include/pinocchio").exists())
    beside = pathlib.Path(mujoco.__file__).parent
    eigen = pathlib.Path(casadi.__file__).parent / "include/eigen3"
    library = next(beside.glob("libmujoco.so*"))
    flags = ["-O3", "-march=native", "-ffp-contract=fast", "-DNDEBUG", "-shared", "-fPIC"]
    c, cc = ["gcc", "-std=c11", *flags], ["g++", "-std=c++17", *flags]
    # Pinocchio has more kinds of joints than Boost's lists have places by themselves.
    variants = ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS"]
    numbers = {"gravity": GRAVITY, "joints": joints(model)}
    made = {
        "dalembert": ("c", DALEMBERT, [*c, folder / "arm6.c", folder / "dalembert_core.c", "-lm"]),
        "Pinocchio": ("cc", PINOCCHIO % numbers, [*cc, f"-I{prefix}/include", f"-I{eigen}", f"-L{prefix}/lib", f"-Wl,-rpath,{prefix}/lib", *variants, "-lpinocchio_default"]),
        "MuJoCo": ("c", MUJOCO % numbers, [*c, f"-I{beside}/include", library, f"-Wl,-rpath,{beside}"]),
        "CasADi": ("c", CASADI % {"integers": function.sz_iw(), "reals": function.sz_w()}, [*c, "-lm"]),
    }
    driver = folder / "driver.c"
    driver.write_text(DRIVER)
    subprocess.run([*c, driver, "-o", folder / "driver.so"], check=True)
    timed = ctypes.CDLL(str(folder / "driver.so")).timed
    timed.restype = ctypes.c_double
    functions = {}
    for name, (ending, text, command) in made.items():
        source = folder / f"{name}.{ending}"
        source.write_text(text)
        subprocess.run([*map(str, command[:1]), str(source), *map(str, command[1:]), f"-I{folder}", "-o", str(folder / f"{name}.so")], check=True)
        loaded = ctypes.CDLL(str(folder / f"{name}.so"))
        loaded.start(str(urdf).encode())
        functions[name] = loaded.accelerations

    n = model.nv
    states = np.random.default_rng(1).uniform(-2, 2, (STATES, 2, n))
    pointer = lambda array: array.ctypes.data_as(ctypes.c_void_p)
    times = {name: [] for name in functions}
    out = np.zeros(n)
    data = model.createData()
    errors = dict.fromkeys(functions, 0.0)
    for state in states:
        expected = pin.aba(model, data, state[0], state[1], np.zeros(n))
        for name, function in functions.items():
            function(pointer(np.ascontiguousarray(state[0])), pointer(np.ascontiguousarray(state[1])), pointer(out))
            errors[name] = max(errors[name], np.abs(out - expected).max() / np.abs(expected).max())
    for _ in range(rounds):
        for name, function in functions.items():
            address = ctypes.cast(function, ctypes.c_void_p)
            times[name].append(timed(address, pointer(states), pointer(out), n, STATES, CALLS))
    print("| | ns | difference |\n| --- | ---: | ---: |")
    for name in functions:
        print(f"| {name} | {statistics.median(times[name]):.0f} | {errors[name]:.0e} |")


if __name__ == "__main__":
    main()
