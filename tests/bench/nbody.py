#!/usr/bin/env python3
"""Gravity of a Plummer sphere beside REBOUND: CPU time of one evaluation, tree built anew, against the root mean square error of the
accelerations of 500 bodies (relative, beside sums over all pairs). G = M = a = 1, softening 0.01, cut at 20 a; one thread on both sides.

The peer is installed from PyPI into the build folder. Bodies may have other rows after the peer sorted them: they are found by place.
"""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOFTENING = 0.01
ANGLES = {10_000: (0, 0.5, 0.7), 100_000: (0.5, 0.7)}  # 0: all pairs
OPENINGS = (1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 3e-2)


def python_with_peer(build):
    folder = build / "bench/rebound"
    python = folder / "bin/python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True, stdout=sys.stderr)
    if subprocess.run([str(python), "-c", "import rebound, numpy"], stderr=subprocess.DEVNULL).returncode:
        subprocess.run([str(python), "-m", "pip", "install", "-q", "rebound==5.2.2", "numpy"], check=True, stdout=sys.stderr)
    return str(python)


def lines_of(command):
    env = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    text = subprocess.run(command, check=True, capture_output=True, text=True, env=env).stdout
    return [json.loads(line) for line in text.splitlines() if line.startswith("{")]


def measure(n, runner, folder):
    import numpy
    random = numpy.random.default_rng(1)
    r = 1 / numpy.sqrt(random.uniform(0, (1 + 1 / 400) ** -1.5, n) ** (-2 / 3) - 1)
    z, phi = random.uniform(-1, 1, n), random.uniform(0, 2 * numpy.pi, n)
    s = numpy.sqrt(1 - z * z)
    x = r[:, None] * numpy.stack([s * numpy.cos(phi), s * numpy.sin(phi), z], 1)
    m = numpy.full(n, 1 / n)
    bodies = folder / f"{n}"
    numpy.column_stack([x, m]).tofile(bodies)
    some = numpy.arange(0, n, n // 500)[:500]
    exact = numpy.empty((500, 3))
    for k, i in enumerate(some):
        d = x - x[i]
        exact[k] = (m / ((d * d).sum(1) + SOFTENING**2) ** 1.5) @ d

    def rms(a):
        relative = numpy.linalg.norm(a - exact, axis=1) / numpy.linalg.norm(exact, axis=1)
        return float(numpy.sqrt((relative**2).mean()))

    def ours(*words):
        out = []
        for row in lines_of([str(runner), str(bodies), str(SOFTENING), *words]):
            out.append(row | {"error": rms(numpy.fromfile(row["file"]).reshape(n, 3)[some])})
        return out

    def peer(angle):
        row = lines_of([sys.executable, str(HERE / "nbody/rebound_gravity.py"), str(bodies), str(SOFTENING), str(angle)])[-1]
        table = numpy.fromfile(f"{bodies}.rebound").reshape(n, 6)
        place = {tuple(p): k for k, p in enumerate(numpy.round(table[:, 3:], 9))}
        rows = [place[tuple(p)] for p in numpy.round(x[some], 9)]
        return row | {"error": rms(table[rows, :3])}

    def compare(metric, mine, other):
        print(json.dumps({"bench": "nbody", "metric": metric, "ours": mine["seconds"], "peer": other["seconds"],
                          "peer_name": f"REBOUND {other['version']}", "ratio": other["seconds"] / mine["seconds"],
                          "error_ours": mine["error"], "error_peer": other["error"], "threads": 1}), flush=True)

    trees = ours("tree", *map(str, OPENINGS))
    print(json.dumps(trees), file=sys.stderr)
    for angle in ANGLES[n]:
        other = peer(angle)
        if angle == 0:
            compare(f"all pairs of {n}, CPU s", ours("direct")[0], other)
            compare(f"all pairs of {n}, most in floats, CPU s", ours("mixed")[0], other)
            continue
        # The coarsest of ours that errs no more than the peer.
        good = [t for t in trees if t["error"] <= other["error"]]
        compare(f"tree of {n}, angle {angle} beside opening {good[-1]['opening']:g}, CPU s", good[-1], other)


def main():
    build = Path(os.environ["TRUESTEP_BUILD"])
    python = python_with_peer(build)
    if sys.argv[1:] != ["inside"]:  # once more, with numpy
        return subprocess.run([python, __file__, "inside"]).returncode
    with tempfile.TemporaryDirectory() as folder:
        for n in ANGLES:
            measure(n, build / "bin/nbody_runner", Path(folder))
    return 0


if __name__ == "__main__":
    sys.exit(main())
