#!/usr/bin/env python3
"""costs.py BUILD [--add]: writes costs.txt, the seconds of every test that ctest has run in this build folder and that took
half a second or more; --add keeps those of tests that have not run. Names with parameters that hold a bracket are left out."""
import sys
from pathlib import Path

LEAST = 0.5
FILE = Path(__file__).parent / "costs.txt"
HEAD = "# seconds test, longest first; written by costs.py\n"


def measured(build):
    """{test: mean seconds} of ctest's own record, whose lines are `name runs seconds` up to the failed tests."""
    text = (Path(build) / "Testing/Temporary/CTestCostData.txt").read_text()
    rows = (line.rsplit(" ", 2) for line in text.split("---")[0].splitlines())
    return {name: float(seconds) for name, runs, seconds in rows if int(runs) > 0}


def main():
    build = sys.argv[1]
    costs = {}
    if "--add" in sys.argv and FILE.exists():
        rows = (line.split(" ", 1) for line in FILE.read_text().splitlines() if not line.startswith("#"))
        costs = {name: float(seconds) for seconds, name in rows}
    costs |= measured(build)
    lines = [f"{seconds:.1f} {name}" for name, seconds in sorted(costs.items(), key=lambda c: (-c[1], c[0]))
             if seconds >= LEAST and "]" not in name]
    FILE.write_text(HEAD + "".join(f"{line}\n" for line in lines))


if __name__ == "__main__":
    main()
