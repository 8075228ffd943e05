#!/usr/bin/env python3
"""Accuracy of rigid bodies against run time beside MuJoCo: a free asymmetric top and a chain of ten links, ten seconds each
(rigid_accuracy/runner.cc says how they are measured). MuJoCo comes from pip into build/bench/mujoco. Results go to
build/bench/rigid_accuracy/ (points.json, measured.md, top.svg, chain.svg); as a script of its own --docs renews
docs/rigid_accuracy/*.svg."""
import argparse
import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BUILD = Path(os.environ.get("TRUESTEP_BUILD", ROOT / "build/release"))
MUJOCO = "mujoco==4.0.0"
TITLES = {"top": "Free asymmetric top, 10 s", "chain": "Chain of ten links released level, 10 s"}
ERRORS = {"top": "angle by which the orientation is off at the end, rad",
          "chain": "energy error at the end over the range of the potential"}


def mujoco_python():
    """The interpreter of a venv that has MuJoCo, made on demand."""
    venv = BUILD / "bench/mujoco"
    python = venv / "bin/python"
    stamp = venv / "stamp"
    if not stamp.exists() or stamp.read_text() != MUJOCO:
        subprocess.run([sys.executable, "-m", "venv", str(venv)], check=True, stdout=sys.stderr)
        subprocess.run([str(python), "-m", "pip", "install", "-q", MUJOCO], check=True, stdout=sys.stderr)
        stamp.write_text(MUJOCO)
    return str(python)


def measure():
    ours = json.loads(subprocess.run([str(BUILD / "bin/rigid_accuracy_runner")], check=True, stdout=subprocess.PIPE).stdout)
    python = mujoco_python()
    # In a folder of its own, because MuJoCo writes its warnings to a file beside.
    peer = subprocess.run([python, str(HERE / "peers/mujoco_rk4.py")], check=True, text=True, cwd=BUILD / "bench/mujoco",
                          input=json.dumps(ours["truth"]), stdout=subprocess.PIPE)
    peer = json.loads(peer.stdout)
    for p in ours["points"] + peer["points"]:
        p["error"] = math.inf if p["error"] is None else abs(p["error"])
        p["milliseconds"] = 10 * p["hertz"] * p["microseconds"] * 1e-3
    return ours["points"], peer["points"], peer["version"]


def compare(ours, peers, version):
    """One line for every problem and rate: our best method of that rate beside MuJoCo's RK4."""
    for q in (p for p in peers if p["method"] == "MuJoCo RK4"):
        method = "rigid3d" if q["problem"] == "top" else "articulation rk4"
        p = next(p for p in ours if (p["problem"], p["method"], p["hertz"]) == (q["problem"], method, q["hertz"]))
        yield p, q
    # Where MuJoCo's RK4 is at its best, beside our method of order 8 that is at least as good.
    best = min((p for p in peers if p["problem"] == "chain"), key=lambda p: p["error"])
    good = [p for p in ours if p["problem"] == "chain" and p["error"] <= best["error"]]
    if good:
        yield min(good, key=lambda p: p["milliseconds"]), best


def report(pairs, version):
    for p, q in pairs:
        print(json.dumps({"bench": "rigid_accuracy",
                          "metric": f"{p['problem']}, CPU ms for 10 s: {p['method']} at {p['hertz']} Hz",
                          "ours": p["milliseconds"], "peer": q["milliseconds"],
                          "peer_name": f"{q['method']} {version} at {q['hertz']} Hz",
                          "ratio": q["milliseconds"] / p["milliseconds"], "error_ours": p["error"],
                          "error_peer": q["error"], "threads": 1}))


def table(points):
    lines = []
    for problem, title in TITLES.items():
        lines += [f"| {title} | steps/s | us/step | ms in all | error |", "| --- | --- | --- | --- | --- |"]
        for p in points:
            if p["problem"] == problem:
                error = f"{p['error']:.1e}" if math.isfinite(p["error"]) else "unstable"
                lines.append(f"| {p['method']} | {p['hertz']} | {p['microseconds']:.2f} | {p['milliseconds']:.2f} | {error} |")
        lines.append("")
    return "\n".join(lines)


def plot(problem, points):
    series = {}
    for p in points:
        if p["problem"] == problem and 0 < p["error"] < 10:
            name = p["method"].split(" to ")[0]
            name = name if name.startswith("MuJoCo") else "Truestep " + name.removeprefix("articulation ")
            series.setdefault(name, []).append((p["error"], p["milliseconds"]))
    drawn = [{"name": n, "style": "dashed" if n.startswith("MuJoCo") else "line", "x": [e for e, _ in sorted(c)],
              "y": [t for _, t in sorted(c)]} for n, c in series.items()]
    request = {"plot": {"title": TITLES[problem], "x_label": ERRORS[problem], "y_label": "CPU time of one thread in ms",
                        "series": drawn}}
    answer = subprocess.run([str(BUILD / "bin/ode_runner")], input=json.dumps(request) + "\n", text=True, check=True,
                            stdout=subprocess.PIPE)
    return json.loads(answer.stdout)["svg"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--docs", action="store_true")
    options = parser.parse_args()
    ours, peers, version = measure()
    report(compare(ours, peers, version), version)
    out = BUILD / "bench/rigid_accuracy"
    out.mkdir(parents=True, exist_ok=True)
    (out / "points.json").write_text(json.dumps(ours + peers, indent=1))
    (out / "measured.md").write_text(table(ours + peers))
    for problem in TITLES:
        (out / f"{problem}.svg").write_text(plot(problem, ours + peers))
    if options.docs:
        docs = ROOT / "docs/rigid_accuracy"
        docs.mkdir(exist_ok=True)
        for svg in out.glob("*.svg"):
            shutil.copy(svg, docs / svg.name)


if __name__ == "__main__":
    main()
