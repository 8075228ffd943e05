#!/usr/bin/env python3
"""CPU time against error on the problems of ode/problems.cc: ours, Boost.odeint, CVODE, scipy and REBOUND in one run. Every
solver runs at tolerances from 1e-2 to as fine as it goes; in a turn each solver runs once at every tolerance, one after
the other, and a point is the median of its turns. Times at equal error are interpolated between neighbouring tolerances on
log-log axes; the best method of each side counts. Results go to build/bench/work_precision/ (points.csv, points.json, one
NAME.svg per problem, long_run.svg, long_run_solar.svg, measured.md). As a script of its own it takes --problem NAME, --turns
N, and --docs, which renews docs/work_precision/*.svg and the measured part of docs/work_precision.md."""
import os

os.environ |= {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}  # before numpy: CPU time is the thread's

import argparse
import csv
import datetime
import json
import math
import platform
import statistics
import subprocess
import sys
from pathlib import Path

import numpy
import rebound
import scipy

from ode import python_peers, report

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("TRUESTEP_BUILD", ROOT / "build/release"))
LEAST = 0.004  # s that a turn of one point lasts at least, in the C++ runner
LONG, VERY_LONG = 0.5, 8.0  # s: of runs this long two turns, one turn are enough


class Runner:
    """The C++ program that runs ours, odeint and CVODE."""

    def __init__(self):
        self.process = subprocess.Popen([str(BUILD / "bin/ode_runner")], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        text=True)

    def ask(self, **request):
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def solvers_of(runner, case):
    """Every solver of a problem, each with run(digits) -> {"seconds", "error", "evaluations"}."""
    name = case["name"]

    def in_runner(solver):
        return lambda digits: runner.ask(problem=name, solver=solver, digits=digits, least=LEAST)

    def in_python(run):
        def judged(digits):
            seconds, end, evaluations = run(digits)
            error = None if end is None else runner.ask(judge=name, end=end)["error"]
            return {"seconds": seconds, "error": error, "evaluations": evaluations}
        return judged

    native = [s | {"run": in_runner(s["name"])} for s in case["solvers"]]
    others = python_peers.scipy_solvers(case) + python_peers.rebound_solvers(case)
    return native + [s | {"run": in_python(s["run"])} for s in others]


def measure(solvers, turns):
    """{solver name: [point ...] from coarse to fine}; points that gave up are left out."""
    times, last = {}, {}
    for turn in range(turns):
        for digits in range(2, 16):
            for s in solvers:
                if not s["from"] <= digits <= s["to"]:
                    continue
                taken = times.setdefault((s["name"], digits), [])
                longest = max(taken, default=0)
                if turn > 0 and (longest > VERY_LONG or longest > LONG and turn > 1):
                    continue
                last[s["name"], digits] = s["run"](digits)
                taken.append(last[s["name"], digits]["seconds"])
    curves = {}
    for s in solvers:
        for digits in range(s["from"], s["to"] + 1):
            point = last[s["name"], digits]
            if point["error"] is None:
                continue
            taken = times[s["name"], digits]
            curves.setdefault(s["name"], []).append({
                "solver": s["name"], "side": s["side"], "tolerance": float(f"1e-{digits}"),
                "seconds": statistics.median(taken), "error": point["error"], "evaluations": point["evaluations"],
                "turns": len(taken)})
    return curves


def versions(runner):
    return runner.ask(versions=True) | {"scipy": scipy.__version__, "numpy": numpy.__version__,
                                        "REBOUND": rebound.__version__, "Python": platform.python_version()}


def machine():
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")),
                 platform.machine())
    return f"{os.cpu_count()} virtual cores, {model}"


def comparisons(problem, curves):
    """The lines of the benchmark: the best of ours against the best of each other side at each decade of error."""
    for digits in range(2, 13, 2):
        best = report.best_by_side(curves, 10.0 ** -digits)
        mine = best.pop("ours", None)
        for theirs in best.values() if mine else ():
            yield {"bench": "work_precision", "metric": f"{problem}: CPU s at error 1e-{digits}, {mine.solver}",
                   "ours": mine.seconds, "peer": theirs.seconds, "peer_name": theirs.solver,
                   "ratio": theirs.seconds / mine.seconds, "error_ours": 10.0 ** -digits,
                   "error_peer": 10.0 ** -digits, "threads": 1}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--problem", action="append", help="only this problem; may be repeated")
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--docs", action="store_true", help="renew the page and the pictures in docs/")
    options = parser.parse_args()
    # A part leaves the results of the whole alone.
    out = BUILD.parent / ("bench/work_precision_part" if options.problem else "bench/work_precision")
    out.mkdir(parents=True, exist_ok=True)
    runner = Runner()
    facts = {"date": datetime.date.today().isoformat(), "machine": machine(), "versions": versions(runner),
             "load_before": os.getloadavg()[0]}
    every = {}
    for case in runner.ask(list=True)["problems"]:
        if options.problem and case["name"] not in options.problem:
            continue
        print(f"work_precision: {case['name']}", file=sys.stderr)
        curves = every[case["name"]] = measure(solvers_of(runner, case), options.turns)
        (out / f"{case['name']}.svg").write_text(runner.ask(plot=report.plot(case["name"], curves))["svg"])
        for line in comparisons(case["name"], curves):
            print(json.dumps(line), flush=True)
    facts["load_after"] = os.getloadavg()[0]
    if not options.problem:
        for name, drawing in report.long_runs(BUILD).items():
            (out / f"{name}.svg").write_text(runner.ask(plot=drawing)["svg"])
    runner.close()
    rows = [{"problem": problem} | point for problem, curves in every.items() for curve in curves.values()
            for point in curve]
    (out / "points.json").write_text(json.dumps(facts | {"points": rows}, indent=1))
    with open(out / "points.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    (out / "measured.md").write_text(report.page(facts, every))
    if options.docs and not options.problem:
        report.renew_docs(ROOT / "docs", out)
    return 0 if all(math.isfinite(r["seconds"]) for r in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
