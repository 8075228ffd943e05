#!/usr/bin/env python3
"""compare_hashes.py SCENES PROGRAM OTHER [--alter]: the gallery_hashes of two builds print the same for every scene. Of large
scenes they compute few steps, because one of the builds may be slow.
--alter is the control, on the first scenes: one digit of one hash is changed, and the comparison must name that line alone."""
import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

FIRST = 3  # scenes of the control


def hashes(program, scenes):
    run = subprocess.run([program, scenes], stdout=subprocess.PIPE, text=True, check=True)
    return run.stdout.splitlines()


def altered_line_is_named(program, other, scenes):
    with tempfile.TemporaryDirectory() as few:
        for scene in sorted(Path(scenes).glob("*.json"))[:FIRST]:
            shutil.copy(scene, few)
        expected, found = hashes(program, few), hashes(other, few)
    right = expected[-1]
    expected[-1] = right[:-1] + ("0" if right[-1] != "0" else "1")
    return set(expected) ^ set(found) == {right, expected[-1]}


def main():
    parser = argparse.ArgumentParser()
    for name in ("scenes", "program", "other"):
        parser.add_argument(name)
    parser.add_argument("--alter", action="store_true")
    a = parser.parse_args()
    if a.alter:
        return 0 if altered_line_is_named(a.program, a.other, a.scenes) else 1
    expected, found = hashes(a.program, a.scenes), hashes(a.other, a.scenes)
    wrong = sorted(set(expected) ^ set(found))
    print("\n".join(wrong) or f"{len(found)} scenes agree")
    return 1 if wrong or not found else 0


if __name__ == "__main__":
    sys.exit(main())
