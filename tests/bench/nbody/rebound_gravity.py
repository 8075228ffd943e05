"""REBOUND's side of nbody.py: rebound_gravity.py FILE SOFTENING ANGLE|0 prints CPU seconds of one evaluation of gravity with what its tree
needs for it, and writes the accelerations to FILE.rebound. A leapfrog step of no length is one such evaluation and little else."""
import json
import sys
import time

import numpy
import rebound


def main():
    name, softening, angle = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
    rows = numpy.fromfile(name).reshape(-1, 4)
    sim = rebound.Simulation()
    sim.G, sim.softening, sim.integrator, sim.dt = 1.0, softening, "leapfrog", 1e-12
    if angle > 0:
        sim.root_size = 2.2 * float(numpy.abs(rows[:, :3]).max())
        sim.gravity, sim.opening_angle2 = "tree", angle * angle
    for x, y, z, m in rows:
        sim.add(m=m, x=x, y=y, z=z)
    sim.steps(1)
    times = []
    for _ in range(3):
        start = time.process_time()
        sim.steps(1)
        times.append(time.process_time() - start)
    particles = sim.particles
    a = numpy.array([[particles[i].ax, particles[i].ay, particles[i].az, particles[i].x, particles[i].y, particles[i].z] for i in range(sim.N)])
    a.tofile(name + ".rebound")
    print(json.dumps({"seconds": sorted(times)[1], "version": rebound.__version__}))


if __name__ == "__main__":
    main()
