#!/usr/bin/env python3
"""A dam break of 54,872 particles beside SPlisHSPlasH 2.19: CPU seconds a simulated second against mean compression.

A cube of 0.95 m in a corner of a tank of 3 x 2 x 1 m, kinematic viscosity 0.01, half a second of flow. Both sides say how much
the density of particles has over that at rest, on the mean and at most, as means over samples each 0.05 s. The peer
is installed from PyPI into the build folder; ours runs as a program, whose start is measured by a run of one step and
taken off. Neither side's clock counts what the samples cost: ours are taken in a run of their own, with the same bits.
One thread on both sides.
"""
import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
# A step is what particles at rest are allowed, so that it is not divided before they are fast.
SECONDS, SAMPLE, STEP, EDGE, SPACING = 0.5, 0.05, 0.05 / 12, 38, 0.025
# Our solver, density error and courant number, the peer's method.
CASES = (("dfsph", 2e-3, 0.8, 4), ("dfsph", 1e-3, 0.4, 4), ("dfsph", 1e-4, 0.4, 4), ("pbf", None, 0.36, 5))


def peer_python(build):
    """The Python that has pysplishsplash, what it needs in its environment, and its model of a unit box."""
    folder = build / "bench/pysplishsplash"
    python = folder / "bin/python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True, stdout=sys.stderr)
    if not list(folder.glob("lib/*/site-packages/pysplishsplash*.so")):
        subprocess.run([str(python), "-m", "pip", "install", "-q", "pysplishsplash==2.19.0", "numpy"], check=True, stdout=sys.stderr)
    env = os.environ | {"OMP_NUM_THREADS": "1"}
    # The package brings an old libGL that fails to load where the system has its own.
    system = sorted(Path("/usr/lib").glob("*/libGL.so.1"))
    if system:
        env["LD_PRELOAD"] = str(system[0])
    return str(python), env, str(next(folder.rglob("UnitBox.obj")))


def scene(solver, error, courant=0.4):
    half = EDGE * SPACING / 2
    water = {"type": "sph", "id": "water", "high": [3, 2, 1], "spacing": SPACING, "viscosity": 0.01, "xsph": 0, "solver": solver, "courant": courant,
             "bodies": [{"center": [half] * 3, "half_extents": [half] * 3}]}
    if error:
        water["density_error"] = error
    return {"schema_version": "1.0", "name": "bench", "gravity": [0, -9.81, 0], "time": {"dt": STEP, "duration": SECONDS}, "systems": [water]}


def ours(binary, solver, error, courant, threads):
    with tempfile.TemporaryDirectory() as folder:
        path, table = Path(folder) / "scene.json", Path(folder) / "out.csv"
        path.write_text(json.dumps(scene(solver, error, courant)))

        def run(seconds, *more):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            command = [binary, "run", str(path), "--seconds", str(seconds), "--threads", str(threads), *more]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

        start, spent = run(STEP), run(SECONDS)
        run(SECONDS, "--csv", str(table), "--observe", "water.compression.mean", "--observe", "water.compression.max")
        rows = [[float(x) for x in line.split(",")] for line in table.read_text().splitlines()[1:]]
        samples = [r for k, r in enumerate(rows) if k > 0 and k % round(SAMPLE / STEP) == 0]
        mean, most = (sum(r[i] for r in samples) / len(samples) for i in (-2, -1))
        return {"seconds": (spent - start) / (SECONDS - STEP), "mean": mean, "most": most}


def main():
    build, binary = Path(os.environ["TRUESTEP_BUILD"]), os.environ["TRUESTEP_BINARY"]
    python, env, model = peer_python(build)
    peers = {}
    for solver, error, courant, method in CASES:
        if method not in peers:
            command = [python, str(HERE / "sph/splishsplash_dam_break.py"), str(method), str(SPACING / 2), str(SECONDS), model]
            peers[method] = json.loads(subprocess.run(command, check=True, env=env, capture_output=True, text=True).stdout.splitlines()[-1])
        mine, peer = ours(binary, solver, error, courant, 1), peers[method]
        name = f"{solver}{f' to {error:g}' if error else ''}, courant {courant:g}"
        print(f"{name}: largest compression {mine['most']:.3g}, the peer's {peer['most']:.3g}", file=sys.stderr)
        print(json.dumps({"bench": "sph", "metric": f"dam break of {peer['particles']} particles, {name}, CPU s a simulated second",
                          "ours": mine["seconds"], "peer": peer["seconds"], "peer_name": "SPlisHSPlasH 2.19.0",
                          "ratio": peer["seconds"] / mine["seconds"], "error_ours": mine["mean"], "error_peer": peer["mean"],
                          "threads": 1}), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
