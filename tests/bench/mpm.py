#!/usr/bin/env python3
"""The material point method beside Taichi's: some 1e5 particles of a fluid fall in the plane (256 cells along the box) and in
space (64), f32, the same places and substeps, one thread. Particle substeps per second of CPU time, median of three runs in turn;
errors are those of the velocity of the fall (m/s). A step of ours that has one substep also puts particles in order and reads and writes the
state every time; one of twenty does so once. Other laws, and two threads beside one (of wall time), are ours alone.

The peer is installed from PyPI into the build folder. On a busy machine CPU times are too long on both sides.
"""
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ALONG = {2: (256, 316), 3: (64, 46)}  # cells along the box, particles along the cube
SUBSTEPS = 100


def python_with_peer(build):
    folder = build / "bench/taichi"
    python = folder / "bin/python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True, stdout=sys.stderr)
    if subprocess.run([str(python), "-c", "import taichi, numpy"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode:
        subprocess.run([str(python), "-m", "pip", "install", "-q", "taichi==1.7.4", "numpy"], check=True, stdout=sys.stderr)
    return str(python)


def last_line(command):
    text = subprocess.run(list(map(str, command)), check=True, capture_output=True, text=True).stdout
    return json.loads([line for line in text.splitlines() if line.startswith("{")][-1])


def rate(runs, clock="cpu"):
    return statistics.median(r["particles"] * r["substeps"] / r[clock] for r in runs)


def main():
    build = Path(os.environ["TRUESTEP_BUILD"])
    python = python_with_peer(build)
    if sys.argv[1:] != ["inside"]:  # once more, with numpy
        return subprocess.run([python, __file__, "inside"]).returncode
    import numpy
    runner = build / "bin/mpm_runner"

    def show(metric, ours, peer, name, errors=(None, None), threads=1):
        print(json.dumps({"bench": "mpm", "metric": metric, "ours": ours, "peer": peer, "peer_name": name, "ratio": ours / peer,
                          "error_ours": errors[0], "error_peer": errors[1], "threads": threads}), flush=True)

    with tempfile.TemporaryDirectory() as folder:
        for d, (cells, along) in ALONG.items():
            places = numpy.zeros((along**d, 3), numpy.float32)
            places[:, :d] = numpy.random.default_rng(1).random((along**d, d)) * 0.4 + 0.15
            file = Path(folder) / f"{d}"
            places.tofile(file)

            def ours(law, substeps, threads=1):
                return last_line([runner, file, d, cells, along, law, substeps, SUBSTEPS // substeps, threads])

            many, one, peer = [], [], []
            for _ in range(3):
                many.append(ours("fluid", 20))
                peer.append(last_line([python, HERE / "mpm/taichi_fluid.py", file, d, cells, SUBSTEPS, 1]))
                one.append(ours("fluid", 1))
            name, errors = f"Taichi {peer[0]['version']}", [max(abs(r["fall_error"]) for r in runs) for runs in (many, peer)]
            show(f"{d}-D, 20 substeps a step, particle substeps/s", rate(many), rate(peer), name, errors)
            show(f"{d}-D, 1 substep a step, particle substeps/s", rate(one), rate(peer), name, errors)
            show(f"{d}-D, memory of the process, MB", many[0]["megabytes"], peer[0]["megabytes"], name)
            for law in ("corotated", "neo_hookean", "snow", "sand", "foam"):
                show(f"{d}-D, {law}, particle substeps/s", rate([ours(law, 20) for _ in range(3)]), rate(peer), f"{name}, fluid")
            two = [ours("fluid", 20, 2) for _ in range(3)]
            if {r["hash"] for r in two} != {many[0]["hash"]}:
                raise SystemExit("two threads came to other bits than one")
            show(f"{d}-D, wall time, particle substeps/s", rate(two, "wall"), rate(many, "wall"), "one thread", threads=2)
    return 0


if __name__ == "__main__":
    sys.exit(main())
