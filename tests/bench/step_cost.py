#!/usr/bin/env python3
"""The cost of a step without sinks and of a frame: CPU time and, where valgrind is installed, instructions, which no
other program disturbs.

step_cost_runner takes each scene's steps in the system's own loop, in a session without sinks, in one whose sink is
never due, and in one that builds a frame after every step. Prints a comparison of each with the loop alone.
"""
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

WAYS = ("session", "idle_sink", "frames")
SCENES = {"two_points": "two points on a spring", "cloth": "cloth of some 10,000 springs", "boxes": "fifty resting boxes"}
STEPS = 64


def instructions(runner, way, scene):
    """Instructions of a step, start and end of the program left out."""
    run = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null",
                          "--toggle-collect=*counted_steps*", runner, way, scene, str(STEPS)],
                         capture_output=True, text=True, check=True)
    return int(re.search(r"Collected : (\d+)", run.stderr).group(1)) / STEPS


def main():
    runner = Path(os.environ["TRUESTEP_BUILD"]) / "bin/step_cost_runner"
    timed = subprocess.run([runner], stdout=subprocess.PIPE, text=True, check=True)
    print(timed.stdout, end="", flush=True)
    if not shutil.which("valgrind"):
        print("step_cost: instructions are counted where valgrind is installed", file=sys.stderr)
        return
    for scene, what in SCENES.items():
        bare = instructions(runner, "bare", scene)
        for way in WAYS:
            ours = instructions(runner, way, scene)
            print(json.dumps({"bench": f"step_cost.{way}", "metric": f"instructions per step, {what}", "ours": ours,
                              "peer": bare, "peer_name": "the system's loop alone", "ratio": bare / ours,
                              "error_ours": None, "error_peer": None, "threads": 1}), flush=True)


if __name__ == "__main__":
    main()
