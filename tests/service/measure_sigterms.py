#!/usr/bin/env python3
"""Ends a loaded server N times with SIGTERM: streams, playing sessions, recordings, steps, seeks, studies and creations in flight, at
a random moment. Every end must come with exit code 0 within five seconds and leave every recording finished. By hand:
TRUESTEP_BINARY=... measure_sigterms.py [N [SEED]]
"""
import collections
import pathlib
import random
import socket
import subprocess
import sys
import time

from harness import BINARY, Service, Socket
from measure_fairness import ROPE

CLOTH = {"time": {"dt": 0.01}, "systems": [{"type": "mass_spring", "id": "cloth", "stiffness": 1e4, "integrator": "implicit_euler",
                                             "cloth_grid": {"nx": 100, "ny": 100}}]}


def ask(service, method, path, body):
    """A request whose answer nobody waits for."""
    peer = socket.create_connection(service.address, 20)
    head = "%s %s HTTP/1.1\r\nHost: %s\r\nContent-Type: application/json\r\nContent-Length: %d\r\n\r\n" % (method, path, service.host, len(body))
    peer.sendall(head.encode() + body.encode())
    return peer


def load(service, dice):
    kept = []
    # A busy machine may answer 202: such a session is in the making when the end comes.
    answers = [service.post("/v1/sessions", {**ROPE, "recording": {}}) for _ in range(dice.randint(1, 3))]
    sessions = [a.json() for a in answers if a.status == 201]
    for s in sessions:
        for _ in range(dice.randint(0, 3)):
            kept.append(Socket(service, s["links"]["stream"], dice.choice(["truestep.v1.json", "truestep.v1.proto"])))
        what = dice.choice(["play", "step", "seek", "nothing"])
        if what == "play":
            service.post(s["links"]["play"], {"speed": dice.choice([1, 10, 1000])})
        elif what == "step":
            kept.append(ask(service, "POST", s["links"]["step"], '{"steps": 100000000}'))
        elif what == "seek":
            kept.append(ask(service, "POST", s["links"]["self"] + "/seek", '{"step": 100000000}'))
    if dice.random() < 0.3:
        kept.append(ask(service, "POST", "/v1/sessions", str(CLOTH).replace("'", '"')))
    if dice.random() < 0.3:
        service.post("/v1/studies", {"kind": "stability", "scene": ROPE})
    return kept


def unfinished(data):
    """Recordings that `truestep info` does not call finished."""
    wrong = []
    for path in pathlib.Path(data).rglob("*.vtkhdf"):
        told = subprocess.run([BINARY, "info", path], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if told.returncode != 0:
            wrong.append(path.name + ": " + told.stdout.strip()[:200])
    return wrong


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    dice = random.Random(int(sys.argv[2]) if len(sys.argv) > 2 else 1)
    codes, slowest, recordings, faults = collections.Counter(), 0.0, 0, []
    for k in range(count):
        service = Service()
        while service.get("/readyz").status != 200:
            time.sleep(0.01)
        kept = load(service, dice)
        time.sleep(dice.uniform(0, 0.15))
        begin = time.monotonic()
        service.process.terminate()
        try:
            code = service.process.wait(30)
        except subprocess.TimeoutExpired:
            code = "hangs"
        took = time.monotonic() - begin
        slowest = max(slowest, took)
        codes[code] += 1
        if k % 10 == 0:
            faults += unfinished(service.data)
        recordings += len(list(pathlib.Path(service.data).rglob("*.vtkhdf")))
        if code != 0 or took > 5:
            faults.append("%d: exit %s after %.1f s" % (k, code, took))
            print(faults[-1], flush=True)
        del kept
        service.stop()
    print("%d ends: exit codes %s, slowest %.2f s, %d recordings, %d faults" % (count, dict(codes), slowest, recordings, len(faults)))
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
