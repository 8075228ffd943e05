#!/usr/bin/env python3
"""compare_hashes.py PROGRAM SCENES EXPECTED [--threads N] [--alter]: the hashes that a build's gallery_hashes prints are
the committed ones, line by line. After a change that is meant to move the physics, write them anew with
  build/release/bin/gallery_hashes scenes 0 > tests/determinism/gallery_hashes.txt
--alter is the control: with one digit of one hash changed the comparison must fail."""
import argparse
import subprocess
import sys
from pathlib import Path


def main():
    parser = argparse.ArgumentParser()
    for name in ("program", "scenes", "expected"):
        parser.add_argument(name)
    parser.add_argument("--threads", default="0")
    parser.add_argument("--alter", action="store_true")
    a = parser.parse_args()
    expected = Path(a.expected).read_text().splitlines()
    if a.alter:
        expected[-1] = expected[-1][:-1] + ("0" if expected[-1][-1] != "0" else "1")
    found = subprocess.run([a.program, a.scenes, a.threads], stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()
    wrong = sorted(set(expected) ^ set(found))
    print("\n".join(wrong) or f"{len(found)} scenes agree")
    return 1 if wrong or not found else 0


if __name__ == "__main__":
    sys.exit(main())
