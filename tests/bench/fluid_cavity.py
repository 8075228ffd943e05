#!/usr/bin/env python3
"""The steady lid-driven cavity at a Reynolds number of 1000 on 128 x 128 cells: processor time until it no longer changes, and the root
mean square of the error at the thirty points of the spectral columns (tests/support/fluids/cavity.h), by differences of second and of fourth
order, beside OpenFOAM's simpleFoam (SIMPLEC, central differences, GAMG, residuals to 1e-7), one thread each.

The peer is Debian's package openfoam; without it on the PATH the bench says so and ends.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

CELLS = 128
HEAD = "FoamFile { version 2.0; format ascii; class %s; object %s; }\n"


def columns():
    """{component: [(place, value)]} of the published columns."""
    text = (Path(__file__).resolve().parent.parent / "support/cavity.h").read_text()
    found = {}
    for name in "UV":
        block = re.search(rf"kCavity{name}\[\] = (.*?);", text, re.S).group(1)
        found[name] = [(float(a), float(b)) for a, b in re.findall(r"\{([-\d.]+), ([-\d.]+)\}", block)]
    return found


def ours(order):
    runner = Path(os.environ["TRUESTEP_BUILD"]) / "bin/cavity_runner"
    seconds, error = map(float, subprocess.run([str(runner), str(CELLS), order], check=True, capture_output=True, text=True).stdout.split()[:2])
    return seconds, error


def write_case(folder, places):
    def points(pairs):
        return " ".join(f"({x} {y} 0.05)" for x, y in pairs)

    files = {
        "system/blockMeshDict": ("dictionary", f"""scale 1;
vertices ((0 0 0) (1 0 0) (1 1 0) (0 1 0) (0 0 0.1) (1 0 0.1) (1 1 0.1) (0 1 0.1));
blocks (hex (0 1 2 3 4 5 6 7) ({CELLS} {CELLS} 1) simpleGrading (1 1 1));
boundary (lid {{ type wall; faces ((3 7 6 2)); }} walls {{ type wall; faces ((0 4 7 3) (2 6 5 1) (1 5 4 0)); }}
  front {{ type empty; faces ((0 3 2 1) (4 5 6 7)); }});"""),
        "system/controlDict": ("dictionary", f"""application simpleFoam; startFrom startTime; startTime 0; stopAt endTime; endTime 5000;
deltaT 1; writeControl timeStep; writeInterval 100000; writeFormat ascii; writePrecision 10;
functions {{ lines {{ type sets; libs (sampling); writeControl onEnd; setFormat raw; interpolationScheme cellPoint; fields (U);
  sets ( u {{ type cloud; axis xyz; points ({points((0.5, y) for y, _ in places["U"])}); }}
         v {{ type cloud; axis xyz; points ({points((x, 0.5) for x, _ in places["V"])}); }} ); }} }}"""),
        "system/fvSchemes": ("dictionary", """ddtSchemes { default steadyState; } gradSchemes { default Gauss linear; }
divSchemes { default none; div(phi,U) Gauss linear; div((nuEff*dev2(T(grad(U))))) Gauss linear; }
laplacianSchemes { default Gauss linear corrected; } interpolationSchemes { default linear; } snGradSchemes { default corrected; }"""),
        "system/fvSolution": ("dictionary", """solvers { p { solver GAMG; smoother GaussSeidel; tolerance 1e-10; relTol 0.1; }
  U { solver smoothSolver; smoother symGaussSeidel; tolerance 1e-10; relTol 0.1; } }
SIMPLE { nNonOrthogonalCorrectors 0; consistent yes; pRefCell 0; pRefValue 0; residualControl { p 1e-7; U 1e-7; } }
relaxationFactors { equations { U 0.9; } }"""),
        "constant/transportProperties": ("dictionary", "transportModel Newtonian; nu 0.001;"),
        "constant/turbulenceProperties": ("dictionary", "simulationType laminar;"),
        "0/U": ("volVectorField", """dimensions [0 1 -1 0 0 0 0]; internalField uniform (0 0 0);
boundaryField { lid { type fixedValue; value uniform (1 0 0); } walls { type noSlip; } front { type empty; } }"""),
        "0/p": ("volScalarField", """dimensions [0 2 -2 0 0 0 0]; internalField uniform 0;
boundaryField { lid { type zeroGradient; } walls { type zeroGradient; } front { type empty; } }"""),
    }
    for name, (kind, body) in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(HEAD % (kind, path.name) + body + "\n")


def theirs():
    places = columns()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_case(folder, places)
        subprocess.run(["blockMesh"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        before = os.times().children_user
        log = subprocess.run(["simpleFoam"], cwd=folder, check=True, capture_output=True, text=True).stdout
        seconds = os.times().children_user - before
        print(re.findall(r"SIMPLE solution converged.*", log), file=sys.stderr)
        squares = []
        for key, column, component in (("u", "U", 3), ("v", "V", 4)):
            (path,) = folder.glob(f"postProcessing/lines/*/{key}_U.xy")
            rows = [list(map(float, line.split())) for line in path.read_text().splitlines() if not line.startswith("#")]
            squares += [(row[component] - value) ** 2 for row, (_, value) in zip(rows, places[column], strict=True)]
        return seconds, (sum(squares) / len(squares)) ** 0.5


def main():
    if not shutil.which("simpleFoam"):
        print("fluid_cavity: simpleFoam is not on the PATH: install openfoam", file=sys.stderr)
        return 1
    peer, peer_error = theirs()
    for order in ("second", "fourth"):
        seconds, error = ours(order)
        print(json.dumps({"bench": "fluid_cavity", "metric": f"cavity Re 1000, 128 x 128, {order} order [s]", "ours": seconds,
                          "peer": peer, "peer_name": "OpenFOAM 1912 simpleFoam", "ratio": peer / seconds, "error_ours": error,
                          "error_peer": peer_error, "threads": 1}), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
