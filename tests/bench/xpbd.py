#!/usr/bin/env python3
"""Cloth by position-based dynamics beside pypbd 2.2.2: CPU time of a step of 1/60 s against rms stretch.

A cloth of 1 m x 1 m, 0.2 kg/m^2, links and one diagonal a cell of 1e5 N/m, falls from level and hangs on one edge for
2 s. The links' own stretch under the weight is 2e-5 at most: what is more is what a method has left unsolved. pypbd takes
links one by one with one iteration a substep and is installed from PyPI into the build folder; ours runs as a program,
and what its start and its scene cost is measured by a run of one step and taken off. One thread on both sides.
"""
import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
STEPS = 120
# Points along a side, our substeps (none: the default), precision, the peer's substeps.
CASES = ((100, 10, "f64", 40), (100, 10, "f32", 40), (100, None, "f64", 80), (200, 20, "f64", 40), (200, None, "f64", 80))


def peer_python(build):
    """The Python that has pypbd."""
    folder = build / "bench/pypbd"
    python = folder / "bin/python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True, stdout=sys.stderr)
    if subprocess.run([str(python), "-c", "import pypbd"], stderr=subprocess.DEVNULL).returncode:
        subprocess.run([str(python), "-m", "pip", "install", "-q", "pypbd==2.2.2", "numpy"], check=True, stdout=sys.stderr)
    return str(python)


def scene(n, substeps, precision):
    cloth = {"type": "xpbd", "id": "cloth", "density": 0.2, "stiffness": 1e5, "shear_stiffness": 1e5, "pinned": ["edge_v0"],
             "cloth_grid": {"edge_u": [1, 0, 0], "edge_v": [0, 0, 1], "nx": n, "ny": n, "shear": "one"}, "precision": precision}
    if substeps:
        cloth["substeps"] = substeps
    return {"schema_version": "1.0", "name": "bench", "time": {"dt": 1 / 60, "duration": 2}, "systems": [cloth]}


def cpu_of(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime, text


def ours(binary, *case):
    with tempfile.TemporaryDirectory() as folder:
        path, table = Path(folder) / "scene.json", Path(folder) / "out.csv"
        path.write_text(json.dumps(scene(*case)))

        def run(steps):
            return cpu_of([binary, "run", str(path), "--seconds", str(steps / 60), "--observe", "cloth.strain.rms", "--csv", str(table)])[0]

        start = min(run(1) for _ in range(3))
        spent = min(run(STEPS) for _ in range(3)) - start
        return 1e3 * spent / (STEPS - 1), float(table.read_text().splitlines()[-1].split(",")[-1])


def main():
    build, binary = Path(os.environ["TRUESTEP_BUILD"]), os.environ["TRUESTEP_BINARY"]
    python, peers = peer_python(build), {}
    for n, substeps, precision, theirs in CASES:
        ms, rms = ours(binary, n, substeps, precision)
        if (n, theirs) not in peers:
            line = subprocess.run([python, str(HERE / "cloth/pypbd_cloth.py"), str(n), str(theirs), str(STEPS)], check=True,
                                  env=os.environ | {"OMP_NUM_THREADS": "1"}, capture_output=True,
                                  text=True).stdout.splitlines()[-1]
            peers[n, theirs] = json.loads(line)
        peer = peers[n, theirs]
        metric = f"{n} x {n}, {substeps or 'default'} substeps {precision} beside {theirs}, ms a step"
        print(json.dumps({"bench": "xpbd", "metric": metric, "ours": ms, "peer": peer["ms"], "peer_name": "pypbd 2.2.2",
                          "ratio": peer["ms"] / ms, "error_ours": rms, "error_peer": peer["rms"], "threads": 1}), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
