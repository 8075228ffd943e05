#!/usr/bin/env python3
"""What stands, and how well: walls, pyramids, stacks, arches, houses of cards, towers and heaps, 120 s long at every
engine's defaults with sleep forbidden, and the time after which all sleep where they may.

Made by rigid2d_runner and rigid3d_runner beside Rapier, Box2D v3 and Bullet. Prints a comparison of every figure, and
to stderr (and build/bench/standing.md) the table of docs/rigid_bodies.md. Names of scenes in TRUESTEP_STANDING,
separated by commas, restrict it to these.
"""
import json
import os
import subprocess
import sys
from pathlib import Path

import rigid2d
import rigid3d

OURS = "Truestep"
FIGURES = {"drift": "drift, m", "sinking": "sinking, m", "kinetic": "kinetic energy, J"}


def measured(build):
    """Rows of both runners as they come."""
    wanted = [n for n in os.environ.get("TRUESTEP_STANDING", "").split(",") if n]
    peers = [p for p in rigid2d.peers(build)]
    commands = [[build / "bin/rigid2d_runner", "standing", *peers, *wanted],
                [build / "bin/rigid3d_runner", "standing", *(rigid3d.rapier(build) or [""]), *wanted]]
    for command in commands:
        with subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, text=True) as process:
            yield from map(json.loads, process.stdout)
        if process.returncode:
            sys.exit(process.returncode)


def comparison(metric, ours, peer, peer_name):
    return {"bench": "standing", "metric": metric, "ours": ours, "peer": peer, "peer_name": peer_name, "ratio": None,
            "error_ours": None, "error_peer": None, "threads": 1}


def key_of(row):
    return row["scene"], row.get("seconds", "sleeps")


def compare(row, ours):
    """Lines of a peer's row beside ours of the same scene and time."""
    scene, when = key_of(row)
    if when == "sleeps":
        # 0: not within the minute that it was given.
        yield comparison(f"{scene}, sleeps after s (0: never)", ours["sleeps"] or 0, row["sleeps"] or 0, row["engine"])
        return
    for figure, name in FIGURES.items():
        yield comparison(f"{scene}, {when} s, {name}", abs(ours[figure]), abs(row[figure]), row["engine"])


def length(x):
    for unit, per_metre, least in (("m", 1, 1), ("mm", 1e3, 1e-4), ("um", 1e6, 1e-8)):
        if x >= least:
            return f"{x * per_metre:.{0 if x * per_metre >= 10 else 1}f} {unit}"
    return "0"


def joules(x):
    return f"{x:.2g} J" if x >= 1e-12 else "0 J"


def cell(row):
    return f"{length(row['drift'])}, {length(row['sinking'])}, {joules(row['kinetic'])}"


def table(rows):
    """Markdown: a line for each scene and engine, a column for each time."""
    times = sorted({r["seconds"] for r in rows if "seconds" in r})
    lines = ["| scene | engine | " + " | ".join(f"{t} s" for t in times) + " | sleeps after |",
             "| --- " * (len(times) + 3) + "|"]
    seen = {}
    for r in rows:
        seen.setdefault((r["scene"], r["engine"]), {})[key_of(r)[1]] = r
    last = None
    for (scene, engine), of in seen.items():
        sleeps = of.get("sleeps", {}).get("sleeps")
        cells = [cell(of[t]) if t in of else "" for t in times] + ["never" if sleeps is None else f"{sleeps:.1f} s"]
        lines.append(f"| {scene if scene != last else ''} | {engine} | " + " | ".join(cells) + " |")
        last = scene
    return "\n".join(lines) + "\n"


def main():
    build = Path(os.environ["TRUESTEP_BUILD"])
    rows, ours = [], {}
    for row in measured(build):
        rows.append(row)
        if row["engine"] == OURS:
            ours[key_of(row)] = row
            continue
        for line in compare(row, ours[key_of(row)]):
            print(json.dumps(line), flush=True)
    text = table(rows)
    print(text, file=sys.stderr)
    (build.parent / "bench").mkdir(exist_ok=True)
    (build.parent / "bench/standing.md").write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
