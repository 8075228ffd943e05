#!/usr/bin/env python3
"""Processor time against error beside REBOUND's IAS15 (Python package rebound, GPL, run as it is): Kepler's orbit of
eccentricity 0.6 over 100 periods and the Pleiades problem. Ours is bench_ode_nonstiff --points; both run in turns, each
side's median counts, and times at equal error are interpolated on log-log axes. IAS15's errors near 1e-12 are rounding
and differ from epsilon to epsilon, so the comparison is made where both sides get to."""
import json
import math
import os
import statistics
import subprocess
import sys
import time

import rebound

BUILD = os.environ.get("TRUESTEP_BUILD", "build/release")
ROUNDS = 3
EPSILONS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)
E = 0.6
PLEIADES_START = [3, 3, -1, -3, 2, -2, 2, 3, -3, 2, 0, 0, -4, 4, 0, 0, 0, 0, 0, 1.75, -1.5, 0, 0, 0, -1.25, 1, 0, 0]
PLEIADES_END = [0.3706139143970502, 3.237284092057233, -3.222559032418324, 0.6597091455775310, 0.3425581707156584,
                1.562172101400631, -0.7003092922212495, -3.943437585517392, -3.271380973972550, 5.225081843456543,
                -2.590612434977470, 1.198213693392275, -0.2429682344935824, 1.091449240428980, 3.417003806314313,
                1.354584501625501, -2.590065597810775, 2.025053734714242, -1.155815100160448, -0.8072988170223021,
                0.5952396354208710, -3.741244961234010, 0.3773459685750630, 0.9386858869551073, 0.3667922227200571,
                -0.3474046353808490, 2.344915448180937, -1.947020434263292]


def kepler(simulation):
    simulation.add(m=1)
    simulation.add(m=0, x=1 - E, vy=math.sqrt((1 + E) / (1 - E)))


def pleiades(simulation):
    y = PLEIADES_START
    for i in range(7):
        simulation.add(m=i + 1.0, x=y[i], y=y[7 + i], vx=y[14 + i], vy=y[21 + i])


def kepler_end(p):
    return [p[1].x - p[0].x, p[1].y - p[0].y, p[1].vx - p[0].vx, p[1].vy - p[0].vy]


def pleiades_end(p):
    return [getattr(q, name) for name in ("x", "y", "vx", "vy") for q in p]


PROBLEMS = {"kepler": (kepler, kepler_end, 200 * math.pi, [1 - E, 0, 0, math.sqrt((1 + E) / (1 - E))]),
            "pleiades": (pleiades, pleiades_end, 3.0, PLEIADES_END)}


def relative(y, reference):
    return math.sqrt(sum((a - b) ** 2 for a, b in zip(y, reference)) / sum(b * b for b in reference))


def run_ias15(problem, epsilon):
    """(CPU seconds, error) of one integration, the fastest of three."""
    setup, end, t_end, reference = PROBLEMS[problem]
    best = math.inf
    for _ in range(3):
        simulation = rebound.Simulation()
        simulation.integrator = "ias15"
        setup(simulation)
        settings = simulation.ri_ias15 if hasattr(simulation, "ri_ias15") else simulation.integrator
        settings.epsilon = epsilon
        start = time.process_time()
        simulation.integrate(t_end, exact_finish_time=1)
        best = min(best, time.process_time() - start)
    return best, relative(end(simulation.particles), reference)


def run_ours(problem):
    out = subprocess.run([BUILD + "/bin/bench_ode_nonstiff", "--points", "--problem", problem], check=True,
                         stdout=subprocess.PIPE, text=True).stdout
    curves = {}
    for row in map(json.loads, out.splitlines()):
        curves.setdefault(row["method"], []).append((row["seconds"], row["error"]))
    return curves


def time_at(curve, error):
    """Least time at which the curve reaches the error; it runs from coarse to fine."""
    best = math.inf
    for k, (seconds, e) in enumerate(curve):
        if e > error:
            continue
        if k and curve[k - 1][1] > error:
            s0, e0 = curve[k - 1]
            w = math.log(e0 / error) / math.log(e0 / max(e, 1e-300))
            seconds = math.exp((1 - w) * math.log(s0) + w * math.log(seconds))
        best = min(best, seconds)
    return best


def main():
    for problem in PROBLEMS:
        rounds = [(run_ours(problem), [run_ias15(problem, e) for e in EPSILONS]) for _ in range(ROUNDS)]
        peer = [(statistics.median(r[1][k][0] for r in rounds), rounds[0][1][k][1]) for k in range(len(EPSILONS))]
        for exponent in (4, 6, 8, 10, 11, 12):
            error = 10.0 ** -exponent
            theirs = time_at(peer, error)
            times = {m: statistics.median(time_at(r[0][m], error) for r in rounds) for m in rounds[0][0]}
            method = min(times, key=times.get)
            if math.inf in (theirs, times[method]):
                print(f"{problem} at {error:.0e}: ours {times[method]}, IAS15 {theirs}", file=sys.stderr)
                continue
            print(json.dumps({"bench": "ode_ias15", "metric": f"{problem}: CPU s at error 1e-{exponent}, {method}",
                              "ours": times[method], "peer": theirs, "peer_name": f"REBOUND {rebound.__version__} IAS15",
                              "ratio": theirs / times[method], "error_ours": error, "error_peer": error, "threads": 1}),
                  flush=True)


if __name__ == "__main__":
    main()
