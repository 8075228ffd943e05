#!/usr/bin/env python3
"""Runs the benchmarks of this folder: `./truestep bench [NAME...] [--json] [--list]`.

A benchmark is bench_NAME (built from NAME.cc) or NAME.py; it prints one JSON line per comparison (report.h says
which fields) and may print anything to stderr. Without --json the driver shows a table. Every run is added, with
time and commit, to build/bench/history.jsonl. Exit code 1 when a benchmark fails or prints a malformed line.
Scripts find the built program in TRUESTEP_BINARY and the build folder in TRUESTEP_BUILD.
"""
import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
NUMBERS = ("ours", "peer", "ratio")
FIELDS = ("bench", "metric", "ours", "peer", "peer_name", "ratio", "error_ours", "error_peer", "threads")
NOT_BENCHMARKS = {"report", "driver"}


def benchmarks(build):
    """{name: command} of everything that can be run."""
    programs = {p.stem: [str(build / "bin" / f"bench_{p.stem}")] for p in HERE.glob("*.cc")}
    scripts = {p.stem: [sys.executable, str(p)] for p in HERE.glob("*.py")}
    return {n: c for n, c in sorted((programs | scripts).items()) if n not in NOT_BENCHMARKS}


def parse(line):
    """The comparison of one line; ValueError says what is wrong with it."""
    row = json.loads(line)
    if missing := [f for f in FIELDS if f not in row]:
        raise ValueError(f"lacks {', '.join(missing)}")
    without_ratio = row["ratio"] is None  # of figures that may be 0
    numbers = [f for f in NUMBERS if not (without_ratio and f == "ratio")]
    least = 0 if without_ratio else sys.float_info.min
    if bad := [f for f in numbers if not isinstance(row[f], (int, float)) or not least <= row[f] < float("inf")]:
        raise ValueError(f"{', '.join(bad)}: not a positive number")
    return row


def run(name, command, build, show):
    """Runs one benchmark, gives its comparisons to `show` as they come, and returns whether all went well."""
    env = os.environ | {"TRUESTEP_BINARY": str(build / "bin/truestep"), "TRUESTEP_BUILD": str(build)}
    good = rows = 0
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=env) as process:
        for line in filter(str.strip, process.stdout):
            rows += 1
            try:
                show(parse(line))
                good += 1
            except ValueError as error:
                print(f"{name}: {error}: {line.strip()}", file=sys.stderr)
    if process.returncode or not rows:
        print(f"{name}: exit code {process.returncode} after {rows} comparisons", file=sys.stderr)
    return process.returncode == 0 and 0 < rows == good


def table_row(row):
    errors = "/".join("-" if row[k] is None else f"{row[k]:.1e}" for k in ("error_ours", "error_peer"))
    ratio = "-" if row["ratio"] is None else f"{row['ratio']:.2f}"
    return (f"{row['bench']:20} {row['metric']:44} {row['ours']:11.4g} {row['peer']:11.4g} {ratio:>7} "
            f"{errors:>17} {row['threads']:3}  {row['peer_name']}")


def main():
    parser = argparse.ArgumentParser(prog="truestep bench", description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--json", action="store_true", help="one JSON line per comparison")
    parser.add_argument("--list", action="store_true", help="names of the benchmarks")
    parser.add_argument("--build", type=Path, required=True, help=argparse.SUPPRESS)
    options = parser.parse_args()
    build = options.build.resolve()
    known = benchmarks(build)
    if options.list:
        print("\n".join(known))
        return 0
    if unknown := [n for n in options.names if n not in known]:
        parser.error(f"no benchmark {', '.join(unknown)}; there are: {', '.join(known)}")

    commit = subprocess.run(["git", "-C", HERE, "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    stamp = {"at": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()), "commit": commit}
    history = build.parent / "bench/history.jsonl"
    history.parent.mkdir(exist_ok=True)
    if not options.json:
        print(f"{'benchmark':20} {'metric':44} {'ours':>11} {'peer':>11} {'ratio':>7} {'error ours/peer':>17} thr  peer")

    def show(row):
        print(json.dumps(row) if options.json else table_row(row), flush=True)
        with open(history, "a") as file:
            file.write(json.dumps(stamp | row) + "\n")

    results = [run(name, known[name], build, show) for name in options.names or known]
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
