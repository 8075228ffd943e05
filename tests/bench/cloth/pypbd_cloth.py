"""A cloth of N x N points, 1 m x 1 m, that falls from level and hangs on one edge, by pypbd 2.2.2 (XPBD, links of 1e5 N/m).

pypbd_cloth.py N SUBSTEPS STEPS   prints one JSON line: CPU milliseconds a step of 1/60 s, rms stretch of the links along
rows and columns at the end.
"""
import json
import sys
import time

import numpy as np
import pypbd as pbd

XPBD_DISTANCE = 4


def main():
    n, substeps, steps = map(int, sys.argv[1:])
    simulation = pbd.Simulation.getCurrent()
    simulation.initDefault()
    model = simulation.getModel()
    level = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    model.addRegularTriangleModel(n, n, np.zeros(3), level, np.ones(2), testMesh=False)
    cloth, points = model.getTriangleModels()[0], model.getParticles()
    first = cloth.getIndexOffset()
    for i in range(n * n):
        points.setMass(first + i, 0.0 if i < n else 0.2 / (n * n))
    model.addClothConstraints(cloth, XPBD_DISTANCE, 1e5, 1.0, 1.0, 1.0, 0.3, 0.3, False, False)

    def lengths():
        x = np.array([points.getPosition(first + i) for i in range(n * n)]).reshape(n, n, 3)
        return np.concatenate([np.linalg.norm(np.diff(x, axis=k), axis=2).ravel() for k in (0, 1)])

    rest = lengths()
    pbd.TimeManager.getCurrent().setTimeStepSize(1 / 60)
    stepper = simulation.getTimeStep()
    stepper.setValueUInt(pbd.TimeStepController.NUM_SUB_STEPS, substeps)
    stepper.setValueUInt(pbd.TimeStepController.MAX_ITERATIONS, 1)
    start = time.process_time()
    for _ in range(steps):
        stepper.step(model)
    spent = time.process_time() - start
    stretch = lengths() / rest - 1
    print(json.dumps({"ms": 1e3 * spent / steps, "rms": float(np.sqrt((stretch * stretch).mean()))}))


if __name__ == "__main__":
    main()
