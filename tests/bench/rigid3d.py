#!/usr/bin/env python3
"""Rigid bodies in space beside Rapier3d and Bullet 3.24: pyramid, pile, wall, joint grid, stacks, a free top.

Rapier is built on demand from its crate into the build folder, where there is cargo; Bullet is linked where its
Debian package was there when the tree was configured. The comparisons themselves are made by rigid3d_runner.
"""
import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


def rapier(build):
    """Path of the peer's library, or nothing without cargo."""
    if not shutil.which("cargo"):
        print("no cargo: without Rapier3d", file=sys.stderr)
        return []
    target = build / "bench/rapier3d"
    environment = os.environ | {"CARGO_TARGET_DIR": str(target), "RUSTFLAGS": "-C target-cpu=native"}
    source = target / "source"
    shutil.copytree(HERE / "peers/rapier3d", source, dirs_exist_ok=True)
    subprocess.run(["cargo", "build", "--release", "--quiet"], cwd=source, env=environment, check=True,
                   stdout=sys.stderr)
    return [str(target / "release/librapier3d_peer.so")]


def main():
    build = Path(os.environ["TRUESTEP_BUILD"])
    return subprocess.run([str(build / "bin/rigid3d_runner"), *rapier(build)]).returncode


if __name__ == "__main__":
    sys.exit(main())
