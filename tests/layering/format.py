#!/usr/bin/env python3
"""Are the C++ files formatted as .clang-format says? format.py [FILE...] checks those, or all of the tree."""
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from source import Tree


BATCH = 40  # files a process: starting one takes as long as reading several


def unformatted(root, paths):
    """clang-format's first complaint about each of the files that it would change."""
    run = subprocess.run(["clang-format", "--dry-run", "-Werror", *paths], cwd=root, capture_output=True, text=True)
    first = {}
    for line in run.stderr.splitlines():
        if " error: " in line:
            first.setdefault(line.split(":")[0], line)
    if run.returncode != 0 and not first:
        first[paths[0]] = run.stderr.strip() or f"clang-format ended with {run.returncode}"
    return list(first.values())


def main():
    tree = Tree(Path(__file__).resolve().parents[2])
    paths = sys.argv[1:] or [path for path, _ in tree.code()]
    batches = [paths[i:i + BATCH] for i in range(0, len(paths), BATCH)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        complaints = [c for found in pool.map(lambda batch: unformatted(tree.root, batch), batches) for c in found]
    print("\n".join(complaints + [f"{len(complaints)} of {len(paths)} files need clang-format -i"]))
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
