#!/usr/bin/env python3
"""A clamped beam of finite elements beside CalculiX: CPU time of the whole program against the error of the tip.

10 m x 1 m x 1 m, E = 1e6 Pa, nu = 0.3, 1 N/m^3 downwards, one end held; both programs get the same corners and cells from
files (ours an MSH file), a thread each, and are run three times in turn. The error is that of the middle of the free
end against -0.0150166 m (second-order hexahedra, 80 x 8 x 8 cells). So small a bend is the same for every law (their difference is
of the order of the strain, 1e-3), which Newton's method meets in more iterations than one; the peer stays linear. CalculiX is Debian's calculix-ccx: where there is no
`ccx` its packages are unpacked into the build folder.
"""
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

TIP = -0.0150166
PACKAGES = ("calculix-ccx", "libspooles2.2", "libarpack2", "libblas3", "liblapack3", "libgfortran5")
# Cells along the beam (a tenth of them across), our element, the peer's.
CASES = ((20, "hex27", "C3D20R"), (20, "hex27", "C3D20"), (20, "tet10", "C3D10"), (40, "hex27", "C3D20R"), (40, "tet10", "C3D10"), (20, "hex8", "C3D8I"), (20, "hex8+modes", "C3D8I"),
         (40, "hex8+modes", "C3D8I"))
LAWS = ("corotated", "st_venant_kirchhoff", "neo_hookean", "stable_neo_hookean", "mooney_rivlin")
# Of a box, alternating so that faces fit.
EVEN = ((0, 1, 2, 5), (0, 2, 3, 7), (0, 5, 7, 4), (2, 5, 6, 7), (0, 2, 7, 5))
ODD = ((1, 0, 4, 3), (1, 2, 3, 6), (1, 4, 5, 6), (3, 4, 6, 7), (1, 3, 4, 6))
# Edges in the order of CalculiX's further nodes.
EDGES = {8: ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
         4: ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))}


def find_ccx(build):
    """The command and its environment."""
    env = os.environ | {"OMP_NUM_THREADS": "1"}
    if found := shutil.which("ccx"):
        return found, env
    folder = build / "bench/ccx"
    if not (folder / "usr/bin/ccx").exists():
        folder.mkdir(parents=True, exist_ok=True)
        subprocess.run(["apt-get", "-qq", "-o", "DPkg::Lock::Timeout=600", "download", *PACKAGES], cwd=folder, check=True, stdout=sys.stderr)
        for package in folder.glob("*.deb"):
            subprocess.run(["dpkg", "-x", str(package), str(folder)], check=True)
    libraries = {str(p.parent) for p in folder.rglob("*.so*")}
    return str(folder / "usr/bin/ccx"), env | {"LD_LIBRARY_PATH": ":".join(sorted(libraries))}


def beam(n, simplex):
    """Corners and cells of n x n/10 x n/10 boxes."""
    m = n // 10
    index = lambda i, j, k: (k * (m + 1) + j) * (n + 1) + i
    corners = [(10 * i / n, j / m, k / m) for k in range(m + 1) for j in range(m + 1) for i in range(n + 1)]
    cells = []
    for k in range(m):
        for j in range(m):
            for i in range(n):
                box = [index(i + a, j + b, k + c) for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                split = (EVEN if (i + j + k) % 2 == 0 else ODD) if simplex else (range(8),)
                cells += [[box[c] for c in part] for part in split]
    if simplex:
        for cell in cells:
            a, b, c, d = (corners[p] for p in cell)
            u, v, w = ([q[r] - a[r] for r in range(3)] for q in (b, c, d))
            volume = sum(u[r] * (v[(r + 1) % 3] * w[(r + 2) % 3] - v[(r + 2) % 3] * w[(r + 1) % 3]) for r in range(3))
            if volume < 0:
                cell[2], cell[3] = cell[3], cell[2]
    return corners, cells


def write_ours(folder, corners, cells, element, law):
    kind = 4 if len(cells[0]) == 4 else 5
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(corners))]
    lines += [f"{k + 1} {x!r} {y!r} {z!r}" for k, (x, y, z) in enumerate(corners)]
    lines += ["$EndNodes", "$Elements", str(len(cells))]
    lines += [f"{k + 1} {kind} 0 " + " ".join(str(p + 1) for p in cell) for k, cell in enumerate(cells)] + ["$EndElements", ""]
    (folder / "beam.msh").write_text("\n".join(lines))
    element, modes = element.removesuffix("+modes"), "wilson" if element.endswith("+modes") else "none"
    system = {"type": "fem", "incompatible_modes": modes, "id": "beam", "mesh": {"path": "beam.msh"}, "element": element, "material": law, "youngs_modulus": 1e6,
              "poisson_ratio": 0.3, "density": 1, "motion": "quasi_static", "sets": [{"name": "foot", "high": [1e-9, 2, 2]}], "pinned": ["foot"]}
    probe = min(range(len(corners)), key=lambda p: sum((c - t) ** 2 for c, t in zip(corners[p], (10, 0.5, 0.5))))
    scene = {"schema_version": "1.0", "name": "beam", "time": {"dt": 1, "duration": 1}, "gravity": [0, -1, 0], "systems": [system],
             "probes": [{"id": "tip", "system": "beam", "index": probe, "fields": ["displacement"]}]}
    (folder / "beam.json").write_text(json.dumps(scene))


def write_peer(folder, corners, cells, element):
    nodes = list(corners)
    middles = {}
    rows = []
    for cell in cells:
        row = list(cell)
        for a, b in EDGES[len(cell)] if element not in ("C3D8", "C3D8I", "C3D4") else ():
            key = (min(cell[a], cell[b]), max(cell[a], cell[b]))
            if key not in middles:
                middles[key] = len(nodes)
                nodes.append(tuple((u + v) / 2 for u, v in zip(corners[key[0]], corners[key[1]])))
            row.append(middles[key])
        rows.append(row)
    tip = min(range(len(nodes)), key=lambda p: sum((c - t) ** 2 for c, t in zip(nodes[p], (10, 0.5, 0.5))))
    out = ["*NODE, NSET=NALL"] + [f"{k + 1}, {x!r}, {y!r}, {z!r}" for k, (x, y, z) in enumerate(nodes)]
    out.append(f"*ELEMENT, TYPE={element}, ELSET=EALL")
    for k, row in enumerate(rows):
        words = [str(k + 1)] + [str(p + 1) for p in row]
        out += [", ".join(words[s:s + 15]) + ("," if s + 15 < len(words) else "") for s in range(0, len(words), 15)]
    out.append("*NSET, NSET=FOOT")
    out += [f"{k + 1}," for k, p in enumerate(nodes) if p[0] < 1e-9]
    out += ["*NSET, NSET=TIP", f"{tip + 1},", "*BOUNDARY", "FOOT, 1, 3", "*MATERIAL, NAME=M", "*ELASTIC", "1e6, 0.3", "*DENSITY", "1.",
            "*SOLID SECTION, ELSET=EALL, MATERIAL=M", "*STEP", "*STATIC", "*DLOAD", "EALL, GRAV, 1., 0., -1., 0.", "*NODE PRINT, NSET=TIP", "U", "*END STEP", ""]
    (folder / "beam.inp").write_text("\n".join(out))


def cpu_of(command, **options):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    text = subprocess.run(command, check=True, capture_output=True, text=True, **options).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, text


def values(observables):
    """(name, value) of what a run reports."""
    for o in observables if isinstance(observables, list) else observables.items():
        yield (o["name"], o["value"]) if isinstance(o, dict) else o


def main():
    build = Path(os.environ["TRUESTEP_BUILD"])
    binary = os.environ["TRUESTEP_BINARY"]
    ccx, env = find_ccx(build)
    cases = [(*case, "linear") for case in CASES]
    cases += [(20, element, peer, law) for element, peer in (("hex27", "C3D20R"), ("tet10", "C3D10")) for law in LAWS]
    for n, element, peer, law in cases:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            corners, cells = beam(n, element.startswith("tet"))
            write_ours(folder, corners, cells, element, law)
            write_peer(folder, corners, cells, peer)
            ours, theirs = [], []
            for _ in range(3):
                spent, text = cpu_of([binary, "run", str(folder / "beam.json"), "--threads", "1", "--json"])
                ours.append(spent)
                theirs.append(cpu_of([ccx, "-i", "beam"], cwd=folder, env=env)[0])
            tip = next(v for k, v in values(json.loads(text)["observables"]) if k.endswith("tip.displacement.y"))
            peer_tip = float((folder / "beam.dat").read_text().split("\n\n")[-1].split()[2])
            a, b = min(ours), min(theirs)
            print(json.dumps({"bench": "fem_statics", "metric": f"beam of {n} x {n // 10} x {n // 10}, {element}, {law}, CPU s", "ours": a, "peer": b,
                              "peer_name": f"CalculiX {peer}", "ratio": b / a, "error_ours": abs(tip / TIP - 1), "error_peer": abs(peer_tip / TIP - 1),
                              "threads": 1}), flush=True)


if __name__ == "__main__":
    main()
