#!/usr/bin/env python3
"""Rigid bodies in the plane beside Rapier2d, Box2D v3 and Box2D 2.4 on the five scenes of Box2D v3's own benchmark.

Rapier and Box2D v3 (crate boxdd-sys) are built on demand from their crates into the build folder, where there is
cargo; Box2D 2.4 is linked where its Debian package was there when the tree was configured. The comparisons themselves
are made by rigid2d_runner.
"""
import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


def peer(build, name, crate, flags=None):
    """NAME=PATH of a peer's library, or nothing where it does not build."""
    target = build / "bench" / crate
    environment = os.environ | {"CARGO_TARGET_DIR": str(target), "RUSTFLAGS": "-C target-cpu=native"} | (flags or {})
    source = target / "source"
    shutil.copytree(HERE / "peers" / crate, source, dirs_exist_ok=True)
    if subprocess.run(["cargo", "build", "--release", "--quiet"], cwd=source, env=environment,
                      stdout=sys.stderr).returncode:
        print(f"without {name}: its crate does not build here", file=sys.stderr)
        return []
    return [f"{name}={target}/release/lib{crate}_peer.so"]


def peers(build):
    if not shutil.which("cargo"):
        print("no cargo: without Rapier2d and Box2D v3", file=sys.stderr)
        return []
    # As Box2D's own release build: no assertions, optimised for this processor.
    release = {"CFLAGS": "-O3 -march=native -DNDEBUG"}
    return peer(build, "Rapier2d 0.36", "rapier2d") + peer(build, "Box2D v3.2", "box2d3", release)


def main():
    build = Path(os.environ["TRUESTEP_BUILD"])
    return subprocess.run([str(build / "bin/rigid2d_runner"), *peers(build)]).returncode


if __name__ == "__main__":
    sys.exit(main())
