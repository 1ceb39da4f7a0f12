"""The arm of tests/urdf by Pinocchio, beside tests/reference/urdf.json, which the imported model is held to.

pip install pin
python pinocchio_arm.py

Prints the largest differences of mass matrices and of accelerations.
"""

import json
import pathlib

import numpy as np
import pinocchio as pin

TESTS = pathlib.Path(__file__).parent / "../tests"


def main():
    reference = json.loads((TESTS / "reference/urdf.json").read_text())["arm6"]
    model = pin.buildModelFromUrdf(str(TESTS / "urdf/arm6.urdf"))
    model.gravity.linear = np.array([0, 0, -9.81])
    data = model.createData()
    numbers = lambda texts: np.array([float(text) for text in texts])
    for state in reference["states"]:
        q, v = numbers(state["q"]), numbers(state["v"])
        # A continuous joint is kept as cosine and sine.
        kept = []
        for joint, angle in zip(reference["joints"], q):
            continuous = model.joints[model.getJointId(joint)].nq == 2
            kept += [np.cos(angle), np.sin(angle)] if continuous else [angle]
        upper = np.triu(pin.crba(model, data, np.array(kept)))
        mass = upper + np.triu(upper, 1).T
        expected = np.array([numbers(row) for row in state["mass_matrix"]])
        accelerations = pin.aba(model, data, np.array(kept), v, np.zeros(model.nv))
        off = np.abs(accelerations - numbers(state["accelerations"])).max() / np.abs(accelerations).max()
        print(f"mass matrix {np.abs(mass - expected).max():.1e} kg m^2, accelerations {off:.1e} of the largest")


if __name__ == "__main__":
    main()
