#!/usr/bin/env python3
"""compare_hashes.py PROGRAM SCENES EXPECTED [--threads N] [--short-too FILE | --alter | --resume | --short]: the hashes that a build's
gallery_hashes prints are the committed ones, line by line. After a change that is meant to move the physics, write them anew with
  build/release/bin/gallery_hashes scenes 0 > tests/determinism/gallery_hashes.txt
  build/release/bin/gallery_hashes scenes 0 short > tests/determinism/gallery_hashes_short.txt
--alter is the control, on the first scenes: with one digit of one hash changed the comparison must fail, and name that line only.
--resume runs the second half of every scene in another process, from the states that the first one saved. --short: fewer
steps of large scenes, for builds that are slow. --short-too: the run also tells their hashes on the way, which FILE holds."""
import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

FIRST = 3  # scenes of the control


def main():
    parser = argparse.ArgumentParser()
    for name in ("program", "scenes", "expected"):
        parser.add_argument(name)
    parser.add_argument("--threads", default="0")
    parser.add_argument("--short-too")
    parser.add_argument("--alter", action="store_true")
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--short", action="store_true")
    a = parser.parse_args()
    expected = Path(a.expected).read_text().splitlines()

    def hashes(*more, scenes=a.scenes):
        run = subprocess.run([a.program, scenes, a.threads, *more], stdout=subprocess.PIPE, text=True, check=True)
        return run.stdout.splitlines()

    if a.alter:
        expected = expected[:FIRST]
        with tempfile.TemporaryDirectory() as few:
            for line in expected:
                shutil.copy(Path(a.scenes) / f"{line.split()[0]}.json", few)
            found = hashes(scenes=few)
        right = expected[-1]
        expected[-1] = right[:-1] + ("0" if right[-1] != "0" else "1")
        if set(expected) ^ set(found) != {right, expected[-1]}:
            print("the comparison does not name the altered line alone")
            return 0
    elif a.resume:
        with tempfile.TemporaryDirectory() as states:
            hashes("save", states)
            found = hashes("resume", states)
    elif a.short_too:
        found = hashes("both")
        expected += [f"short {line}" for line in Path(a.short_too).read_text().splitlines()]
    else:
        found = hashes(*(["short"] if a.short else []))
    wrong = sorted(set(expected) ^ set(found))
    print("\n".join(wrong) or f"{len(found)} scenes agree")
    return 1 if wrong or not found else 0


if __name__ == "__main__":
    sys.exit(main())
