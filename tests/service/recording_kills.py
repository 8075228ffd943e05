#!/usr/bin/env python3
"""kill -9 while a recording is being finalised: after the server's repair every frame is there, and the file is one
that VTK may open. Then the same with a repair that is itself killed. usage: recording_kills.py RECORD_LOOP RECORD_READ"""
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from patience import patience

loop, read = map(os.path.abspath, sys.argv[1:3])
POINTS, FRAMES, TRIALS = 20, 5000, 60


def readable(path, *recover):
    out = subprocess.run([read, path, *recover], capture_output=True, text=True, timeout=patience(60))
    return int(out.stdout.split()[0])


def start_finalizing(path):
    process = subprocess.Popen([loop, path, str(POINTS), str(FRAMES)], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stderr.readline() == b"finalizing\n"
    return process


def finalize_seconds(folder):
    began = time.monotonic()
    process = start_finalizing(Path(folder) / "whole")
    began = time.monotonic()
    process.communicate()
    return time.monotonic() - began


def main():
    random.seed(11)
    hit = 0
    with tempfile.TemporaryDirectory() as folder:
        span = finalize_seconds(folder)
        for k in range(TRIALS):
            path = Path(folder) / f"r{k}"
            process = start_finalizing(path)
            time.sleep(random.random() * span)
            os.kill(process.pid, signal.SIGKILL)
            out, _ = process.communicate()
            hit += process.returncode == -signal.SIGKILL
            acknowledged = int(out[:out.rfind(b"\n")].split()[-1])
            if k % 3 == 0:  # the server dies while it repairs, and starts again
                repair = subprocess.Popen([read, path, "recover"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                time.sleep(random.random() * span)
                repair.kill()
                repair.wait()
            frames = readable(path, "recover")
            assert frames >= acknowledged, f"trial {k}: {acknowledged} acknowledged, {frames} readable"
            assert readable(path) == frames, f"trial {k}: the repaired file differs"
            path.unlink()
    assert hit > TRIALS // 4, f"only {hit} kills met a finalisation"
    print(f"{hit} of {TRIALS} kills met a finalisation of {span * 1e3:.0f} ms; no acknowledged frame lost")


main()
