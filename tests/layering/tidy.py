#!/usr/bin/env python3
"""`./truestep tidy [FILE...]`: the checks of .clang-tidy over the named sources, or over those that differ from the
commit before the present one (`--since REVISION`), or over all (`--all`: half an hour on two cores); `--seconds N`
begins no further source after that time. Reads how files are compiled from the tree of the preset asan (clang).
Exit code 1 when something is found."""
import argparse
import concurrent.futures
import json
import os
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TREE = ROOT / "build/asan"


def compiled():
    """Sources of the engine and the server, with the joined ones in the place of their parts."""
    files = {entry["file"] for entry in json.loads((TREE / "compile_commands.json").read_text())}
    return sorted(f for f in files if f.endswith((".cc", ".cxx")) and ("/engine/" in f or "/server/" in f))


def parts(file):
    """What a joined source includes."""
    lines = Path(file).read_text().splitlines() if "/joined/" in file else []
    return [str(ROOT / line.split('"')[1]) for line in lines if line.startswith("#include")]


def changed(since):
    out = subprocess.run(["git", "diff", "--name-only", "--diff-filter=ACMR", since], cwd=ROOT, check=True, text=True,
                         stdout=subprocess.PIPE).stdout
    return {str(ROOT / name) for name in out.split()}


def look(file, last):
    """What is found in a source; None when it is later than `last`."""
    if time.monotonic() > last:
        return None
    done = subprocess.run(["clang-tidy-16", "-p", TREE, "--quiet", file], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL)
    return done.stdout.strip()


def main():
    parser = argparse.ArgumentParser(prog="truestep tidy", description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="*", metavar="FILE")
    parser.add_argument("--since", default="HEAD~1", metavar="REVISION")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--seconds", type=float, default=float("inf"), metavar="N")
    options = parser.parse_args()
    wanted = {str(Path(f).resolve()) for f in options.files} or changed(options.since)
    known = compiled()
    files = [f for f in known if options.all or f in wanted or wanted & set(parts(f))]
    last = time.monotonic() + options.seconds
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        seen = [text for text in pool.map(lambda f: look(f, last), files) if text is not None]
    found = sorted(set(seen) - {""})
    print(*found, sep="\n")
    print(f"{len(seen)} of {len(known)} sources looked at, {len(found)} with findings, {len(files) - len(seen)} left for want of time")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
