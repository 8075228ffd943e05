#!/usr/bin/env python3
"""Does README.md work? Its commands run in their order in an empty folder, as a reader would type them: ```sh blocks,
and indented lines that begin with ./truestep. The ```json block is scene.json. The first failure is the error.

Commands that do not end, or would run this test again, take a form that ends: `serve` serves on a free port until
the last command is done (that port replaces 8080 everywhere), `test` and `bench` list what they would run.
`./truestep a | b` stands for two commands.
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

from patience import patience

ROOT = Path(__file__).resolve().parents[2]
STEP = re.compile(r"^```(?P<kind>sh|json)\n(?P<block>.*?)^```$|^    (?P<line>\./truestep [^\n]*)$", re.M | re.S)
ENDING_FORM = {"test": "test -N", "bench": "bench --list"}


def steps(text):
    """(kind, text) of everything that a reader does: "sh", "json" or "command"."""
    for match in STEP.finditer(text):
        if match["kind"]:
            yield match["kind"], match["block"]
        else:
            words = match["line"].split("#")[0].strip()
            for part in words.removeprefix("./truestep ").split(" | "):
                yield "command", f"./truestep {part.strip()}"


class Reader:
    """Follows the README in a folder and keeps the server that it starts."""

    def __init__(self, folder):
        self.folder, self.server = folder, None
        with socket() as s:
            s.bind(("127.0.0.1", 0))
            self.port = s.getsockname()[1]

    def do(self, kind, text):
        """Exit code of one step."""
        if kind == "json":
            (self.folder / "scene.json").write_text(text)
            return 0
        if text == "./truestep serve":
            return self.serve()
        if kind == "command":
            name = text.split()[1]
            text = f"./truestep {ENDING_FORM[name]}" if name in ENDING_FORM else text
        text = text.replace("127.0.0.1:8080", f"127.0.0.1:{self.port}").replace("./truestep", str(ROOT / "truestep"))
        # curl fails on an HTTP error, which a reader would see in its answer.
        text = re.sub(r"\bcurl\b", "curl --fail-with-body", text)
        return subprocess.run(["bash", "-eu", "-c", text], cwd=self.folder, timeout=patience(200),
                              stdout=subprocess.DEVNULL).returncode

    def serve(self):
        command = [ROOT / "truestep", "serve", "--port", str(self.port), "--data-dir", self.folder / "data"]
        self.server = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE, text=True)
        return 0 if f"http://127.0.0.1:{self.port}" in self.server.stdout.readline() else 1

    def stop(self):
        """SIGTERM ends the server in order: exit code 0, and soon."""
        self.server.send_signal(signal.SIGTERM)
        return self.server.wait(timeout=patience(5))


def follow(text, folder):
    """None, or what went wrong."""
    reader = Reader(folder)
    try:
        for kind, what in steps(text):
            if code := reader.do(kind, what):
                return f"exit code {code} of: {what}"
        if reader.server is None:
            return "nothing starts the server"
        if code := reader.stop():
            return f"the server ended with {code}"
    finally:
        if reader.server and reader.server.poll() is None:
            reader.server.kill()
    return None


def main():
    text, started = (ROOT / "README.md").read_text(), time.monotonic()
    if not {"sh", "json", "command"} <= {kind for kind, _ in steps(text)}:
        sys.exit("README.md has no requests, no scene or no commands")
    with tempfile.TemporaryDirectory() as folder:
        if wrong := follow(text, Path(folder)):
            sys.exit(wrong)
        written = {p.suffix: p.stat().st_size for p in Path(folder).iterdir() if p.is_file()}
        if min(written.get(".png", 0), written.get(".vtkhdf", 0)) < 1000:
            sys.exit(f"no picture or no recording: {written}")
    # The control: a misspelt parameter in the README's scene must be noticed.
    with tempfile.TemporaryDirectory() as folder:
        if follow(text.replace('"links"', '"lincs"'), Path(folder)) is None:
            sys.exit("a README with a wrong scene passed")
    print(f"{len(list(steps(text)))} steps in {time.monotonic() - started:.1f} s")


if __name__ == "__main__":
    os.environ.setdefault("TRUESTEP_PRESET", "release")
    main()
