"""MuJoCo's side of rigid_accuracy.py: RK4 and Euler on the free top and on the chain as a tree of ball joints. Takes the
top's true orientation (w x y z) as a JSON list on stdin, writes points as rigid_accuracy_runner does."""
import json
import math
import sys
import time

import mujoco
import numpy

SECONDS, LINKS, G = 10, 10, 9.81


def model(body, integrator, hertz, gravity):
    return mujoco.MjModel.from_xml_string(f"""<mujoco><option timestep="{1 / hertz!r}" integrator="{integrator}"
      gravity="0 {gravity} 0"><flag contact="disable"/></option>
      <worldbody>{body}</worldbody></mujoco>""")


def energy(m, d):
    mujoco.mj_forward(m, d)
    mujoco.mj_energyPos(m, d)
    mujoco.mj_energyVel(m, d)
    return d.energy.sum()


def run(m, start, turns):
    """Best microseconds of a step, the data at the end, and the change of energy: not a number where it blew up, after
    which MuJoCo goes on from the start."""
    best, steps = math.inf, round(SECONDS / m.opt.timestep)
    for _ in range(turns):
        d = mujoco.MjData(m)
        start(d)
        before, t = energy(m, d), time.thread_time()
        mujoco.mj_step(m, d, steps)
        best = min(best, 1e6 * (time.thread_time() - t) / steps)
    return best, d, math.nan if any(w.number for w in d.warning) else energy(m, d) - before


def top(integrator, hertz, truth):
    m = model('<body><freejoint/><geom type="box" size="1.5 1 0.5"/></body>', integrator, hertz, 0)

    def start(d):
        d.qvel[3:6] = 1, 2, 3

    microseconds, d, _ = run(m, start, 5)
    inverse, difference = numpy.zeros(4), numpy.zeros(4)
    mujoco.mju_negQuat(inverse, numpy.array(truth))
    mujoco.mju_mulQuat(difference, d.qpos[3:7].copy(), inverse)
    return microseconds, 2 * math.atan2(float(numpy.linalg.norm(difference[1:])), abs(difference[0]))


def chain(integrator, hertz):
    body = ""
    for i in reversed(range(LINKS)):
        body = f"""<body pos="{0 if i == 0 else 1} 0 0"><joint type="ball"/>
          <geom type="box" size="0.5 0.05 0.05" pos="0.5 0 0" mass="1"/>{body}</body>"""
    microseconds, _, change = run(model(body, integrator, hertz, -G), lambda d: None, 2)
    return microseconds, change / sum(G * (i + 0.5) for i in range(LINKS))


def main():
    truth = json.load(sys.stdin)
    points = []
    for integrator in ("RK4", "Euler"):
        for hertz in (60, 240, 960):
            for problem, (microseconds, error) in (("top", top(integrator, hertz, truth)),
                                                   ("chain", chain(integrator, hertz))):
                points.append({"problem": problem, "method": f"MuJoCo {integrator}", "hertz": hertz,
                               "microseconds": microseconds, "error": error if math.isfinite(error) else None})
    print(json.dumps({"version": mujoco.__version__, "points": points}))


main()
