#!/usr/bin/env python3
"""How long a scene's estimate says that a step takes, beside what a step takes, for every scene of the gallery and for
all of them ten times as large. One line a scene; `error_ours` is the distance of the ratio from 1 once the middle of
all scenes has said how fast the machine is. Whoever wants a verdict runs the program with `--judge time`."""
import json
import os
import subprocess

BUILD = os.environ.get("TRUESTEP_BUILD", "build/release")

for times in (1, 10):
    out = subprocess.run([f"{BUILD}/bin/estimates", "--times", str(times), "--seconds", "2"], check=True, text=True,
                         stdout=subprocess.PIPE).stdout
    for line in out.splitlines()[1:-1]:
        scene, _, _, _, _, estimated, taken, ratio, *_ = line.split()
        print(json.dumps({"bench": "estimates", "metric": f"{scene} x{times}, s a step", "ours": float(estimated),
                          "peer": float(taken), "peer_name": "measured", "ratio": max(float(ratio), 0.01),
                          "error_ours": abs(float(ratio) - 1), "error_peer": None, "threads": 1}), flush=True)
