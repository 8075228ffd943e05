#!/usr/bin/env python3
"""Does README.md work? Its ```sh blocks run one after another, in a folder of their own, as a reader
would type them; the first that fails is the error.

Three commands are run in a form that ends: `./truestep serve` serves on a free port until the last block is done
(and that port replaces 8080 everywhere), `./truestep test` lists the tests instead of running this one again.
"""
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from socket import socket

ROOT = Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^```sh\n(.*?)^```$", re.M | re.S)
PNG = b"\x89PNG\r\n\x1a\n"


def blocks(text):
    return BLOCK.findall(text)


def free_port():
    with socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Reader:
    """Types blocks into a folder and keeps the server that one of them starts."""

    def __init__(self, folder):
        self.folder, self.port, self.server = folder, free_port(), None

    def type(self, block):
        block = block.replace("127.0.0.1:8080", f"127.0.0.1:{self.port}")
        block = block.replace("./truestep", str(ROOT / "truestep"))
        if re.search(r"truestep serve\s*$", block):
            return self.serve(block.strip().split())
        block = re.sub(r"truestep test\s*$", "truestep test -N", block)
        return subprocess.run(["bash", "-euo", "pipefail", "-c", block], cwd=self.folder, timeout=120).returncode

    def serve(self, command):
        command += ["--port", str(self.port), "--data-dir", str(self.folder / "data")]
        self.server = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE, text=True)
        line = self.server.stdout.readline()
        return 0 if f"http://127.0.0.1:{self.port}" in line else 1

    def stop(self):
        """The server ends in order on SIGTERM: exit code 0 within 5 s."""
        self.server.send_signal(signal.SIGTERM)
        return self.server.wait(timeout=5)


def follow(text, folder):
    """None, or what went wrong."""
    reader = Reader(folder)
    try:
        for block in blocks(text):
            if code := reader.type(block):
                return f"exit code {code} of:\n{block}"
        if reader.server is None:
            return "no block starts the server"
        if code := reader.stop():
            return f"the server ended with {code}"
    finally:
        if reader.server and reader.server.poll() is None:
            reader.server.kill()
    return None


def main():
    text = (ROOT / "README.md").read_text()
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        if wrong := follow(text, Path(folder)):
            sys.exit(wrong)
        if not (Path(folder) / "rope.png").read_bytes().startswith(PNG):
            sys.exit("rope.png is no PNG")
        if not (Path(folder) / "rope.vtkhdf").stat().st_size:
            sys.exit("rope.vtkhdf is empty")
    # The control: one misspelt word in the scene must be noticed.
    with tempfile.TemporaryDirectory() as folder:
        if follow(text.replace('"stiffness"', '"stifness"'), Path(folder)) is None:
            sys.exit("a README with a wrong scene passed")
    print(f"{len(blocks(text))} blocks in {time.monotonic() - started:.1f} s")


if __name__ == "__main__":
    os.environ.setdefault("TRUESTEP_PRESET", "release")
    main()
