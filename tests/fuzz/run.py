#!/usr/bin/env python3
"""Runs a fuzz target: run.py NAME | run.py control.

NAME runs fuzz_NAME on its kept seeds (corpus/NAME), then for TRUESTEP_FUZZ_SECONDS (5) on mutations of them
and of what earlier runs found (build/asan/found/NAME). A crash, a sanitizer report, a leak, 12 s for one input (more on a
busy machine: TRUESTEP_SLOWDOWN) or 2 GiB of memory fail the run; the input stays in build/asan/artifacts. control expects
that of a target with a planted fault.
"""
import os
import re
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BUILD = ROOT / "build/asan"


def slowdown():
    return max(4.0, float(os.environ.get("TRUESTEP_SLOWDOWN", "4")))


def fuzz(name, seconds):
    """libFuzzer's exit code and the number of inputs tried."""
    found, artifacts = BUILD / "found" / name, BUILD / "artifacts"
    for folder in (found, artifacts):
        folder.mkdir(parents=True, exist_ok=True)
    seeds = HERE / "corpus" / name
    if not any(seeds.iterdir()):
        sys.exit(f"{seeds} holds no seed")
    command = [BUILD / "bin" / f"fuzz_{name}", f"-max_total_time={seconds}", f"-timeout={round(3 * slowdown())}", "-rss_limit_mb=2048",
               "-print_final_stats=1", f"-artifact_prefix={artifacts}/{name}-", found, seeds]
    run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    tried = re.search(r"number_of_executed_units: (\d+)", run.stdout)
    print("\n".join(run.stdout.splitlines()[-40:]))
    return run.returncode, int(tried[1]) if tried else 0


def main():
    what = sys.argv[1]
    if not (BUILD / "bin" / f"fuzz_{what}").exists():
        sys.exit("the fuzz targets are not built: ./truestep test builds them, or cmake --preset asan and cmake --build --preset asan --target fuzz_targets")
    seconds = os.environ.get("TRUESTEP_FUZZ_SECONDS", "5")
    code, tried = fuzz(what, int(seconds))
    if what == "control":
        return 0 if code else 1
    return code or (0 if tried else 1)


if __name__ == "__main__":
    sys.exit(main())
