"""SPlisHSPlasH's side of sph.py: a dam break by DFSPH (method 4) or PBF (method 5), one JSON line.

splishsplash_dam_break.py METHOD RADIUS SECONDS MODEL: a cube of 38 particles along each edge in a corner of a tank of
3 x 2 x 1 m; MODEL is the unit box as a file. CPU seconds a simulated second, without what the samples of the density
cost and without the first step, in which maps and boundary particles are made; mean and largest compression are means
over samples each 0.05 s. Walls are volume maps whose cells are the kernel's radius, as in the peer's own DamBreakModel;
with PBF they are particles: with maps it bursts within 0.05 s, whatever the maps' cells, with shorter steps too."""
import json
import sys
import tempfile
import time

import numpy
import pysplishsplash as sph

METHOD, RADIUS, SECONDS, MODEL = int(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3]), sys.argv[4]
EDGE, SAMPLE = 38, 0.05


def scene():
    solver = {4: {"DFSPH": {"minIterations": 2, "maxIterations": 100, "maxError": 0.05, "maxIterationsV": 100, "maxErrorV": 0.1,
                            "enableDivergenceSolver": True}},
              5: {"PBF": {"minIterations": 2, "maxIterations": 100, "maxError": 1.0}}}[METHOD]
    longest, walls = (0.005, 2) if METHOD == 4 else (0.002, 0)
    return {"Configuration": {"particleRadius": RADIUS, "simulationMethod": METHOD, "gravitation": [0, -9.81, 0], "timeStepSize": 0.001,
                              "cflMethod": 1, "cflFactor": 1, "cflMaxTimeStepSize": longest, "boundaryHandlingMethod": walls, "stopAt": SECONDS} | solver,
            "Materials": [{"id": "Fluid", "density0": 1000, "viscosityMethod": 1, "Standard viscosity": {"viscosity": 0.01}}],
            "RigidBodies": [{"geometryFile": MODEL, "translation": [1.5, 1, 0.5], "rotationAxis": [1, 0, 0], "rotationAngle": 0,
                             "scale": [3, 2, 1], "isDynamic": False, "isWall": True, "mapInvert": True, "mapThickness": 0.0,
                             "mapResolution": [round(edge / (4 * RADIUS)) for edge in (3, 2, 1)]}],
            "FluidBlocks": [{"denseMode": 0, "start": [0, 0, 0], "end": [2 * RADIUS * (EDGE + 1)] * 3, "translation": [0, 0, 0],
                             "scale": [1, 1, 1]}]}


def main():
    with tempfile.TemporaryDirectory() as folder:
        path = folder + "/scene.json"
        with open(path, "w", encoding="utf-8") as file:
            json.dump(scene(), file)
        base = sph.Exec.SimulatorBase()
        base.init(useGui=False, sceneFile=path, outputDir=folder)
        base.initSimulation()
        fluid = sph.Simulation.getCurrent().getFluidModel(0)
        n = fluid.numActiveParticles()
        manager, samples, aside, due = sph.TimeManager.getCurrent(), [], 0.0, SAMPLE
        started = None

        def look():
            nonlocal aside, due, started
            if started is None:
                started = manager.getTime(), time.process_time()
            if manager.getTime() < due:
                return
            before = time.process_time()
            compression = numpy.maximum(numpy.array([fluid.getDensity(i) for i in range(n)]) / 1000 - 1, 0)
            samples.append((float(compression.mean()), float(compression.max())))
            due += SAMPLE
            aside += time.process_time() - before

        base.setTimeStepCB(look)
        base.runSimulation()
        seconds, spent = manager.getTime() - started[0], time.process_time() - started[1] - aside
        front = max(fluid.getPosition(i)[0] for i in range(n))
        base.cleanup()
    mean, most = (sum(c) / len(samples) for c in zip(*samples))
    print(json.dumps({"particles": n, "seconds": spent / seconds, "mean": mean, "most": most, "front": float(front)}))


main()
