#!/usr/bin/env python3
"""Are the C++ files formatted as .clang-format says? format.py [FILE...] checks those, or all of the tree."""
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from source import Tree


def unformatted(root, path):
    """clang-format's first complaint about the file, empty when there is none."""
    run = subprocess.run(["clang-format", "--dry-run", "-Werror", path], cwd=root, capture_output=True, text=True)
    return "" if run.returncode == 0 else run.stderr.splitlines()[0]


def main():
    tree = Tree(Path(__file__).resolve().parents[2])
    paths = sys.argv[1:] or [path for path, _ in tree.code()]
    with ThreadPoolExecutor() as pool:
        complaints = [c for c in pool.map(lambda p: unformatted(tree.root, p), paths) if c]
    print("\n".join(complaints + [f"{len(complaints)} of {len(paths)} files need clang-format -i"]))
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
