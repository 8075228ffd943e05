#!/usr/bin/env python3
"""Which tests under sanitizers look at what the last commit (or the branch, `touched.py REVISION`) touches: the arguments of
`truestep sanitize`, one a line; nothing when no code that runs is touched. The server and what it calls of the engine:
tests of the service. Systems and what they share: the quickest scenes of the gallery with these systems."""
import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SERVED = re.compile(r"^(server|proto|tests/service)/|^engine/(session|scene|sinks|studies)/")
# Those that would take longest under sanitizers; all of them are in `truestep sanitize service`.
LONG = r"^service[.](recording_|data_folder|restart|starts|openapi|portable|control|Stud|.*(slow_consumer|conn_flood))"
SHARED = {"rigid": ("rigid2d", "rigid3d"), "collision": ("rigid2d", "rigid3d"), "contact": ("rigid2d", "rigid3d"),
          "joint": ("rigid2d", "rigid3d"), "mac": ("grid_fluid",), "springs": ("mass_spring",), "gravity": ("nbody",),
          "animation": ("skeleton", "ik", "blend_shapes", "keyframes"), "lattice": ("heat", "wave")}
MOST_SCENES, MOST_SECONDS = 10, 8.0  # in the optimised build


def changed(since):
    run = subprocess.run(["git", "diff", "--name-only", since], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    return run.stdout.split()


def scenes():
    """(seconds, name, kinds of systems), the quickest first."""
    lines = (ROOT / "tests/costs/costs.txt").read_text().splitlines()
    costs = {name: float(seconds) for seconds, name in (line.split(" ", 1) for line in lines if line[0] != "#")}
    for path in (ROOT / "scenes").glob("*.json"):
        kinds = {system["type"] for system in json.loads(path.read_text())["systems"]}
        yield costs.get(f"gallery.{path.stem}", 0.3), path.stem, kinds


def scenes_of(paths):
    """Names of scenes for the touched files of the engine: of each kind of system in turn, of all kinds where none is named."""
    every = sorted(scenes(), key=lambda row: row[:2])
    known = set().union(*(kinds for _, _, kinds in every))
    wanted = []
    for path in paths:
        parts = set(Path(path).parts)
        wanted += [k for k in sorted(known) if k in parts] + [k for part in sorted(parts) for k in SHARED.get(part, ())]
    wanted = list(dict.fromkeys(wanted)) or sorted(known)
    chosen, spent = [], 0.0
    for turn in range(MOST_SCENES):
        for kind in wanted:
            row = next((r for r in every if kind in r[2] and r[1] not in chosen), None)
            if row and len(chosen) < MOST_SCENES and (turn == 0 or spent + row[0] <= MOST_SECONDS):
                chosen.append(row[1])
                spent += row[0]
    return chosen


def arguments(paths):
    served = any(SERVED.search(path) for path in paths)
    physics = [path for path in paths if path.startswith("engine/") and path.endswith((".cc", ".h")) and not SERVED.search(path)]
    names = scenes_of(physics) if physics else []
    parts = ["service"] * served + ["gallery"] * bool(names)
    wanted = ["^service[.]"] * served + [f"^gallery[.]({'|'.join(names)})$"] * bool(names)
    return parts + ["-R", "|".join(wanted)] * bool(parts) + ["-E", LONG] * served


if __name__ == "__main__":
    found = arguments(changed(sys.argv[1] if len(sys.argv) > 1 else "HEAD~1"))
    if found:
        print("\n".join(found))
