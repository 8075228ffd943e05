#!/usr/bin/env python3
"""Twelve clients do whatever comes to their minds, right and wrong, for as long as asked. Nothing may answer 500, end the server or
hold memory afterwards. By hand: TRUESTEP_BINARY=... measure_chaos.py [SECONDS [SEED]]
"""
import collections
import json
import os
import pathlib
import random
import socket
import sys
import threading
import time

from harness import Service, Socket
from measure_fairness import ROPE

GALLERY = ["rope_catenary", "lorenz_butterfly", "newtons_cradle", "rigid_pyramid", "fountain", "hanging_cloth", "mixed_pile", "pyramid_2d", "ragdoll_stairs",
           "bouncing_ball_events", "robertson", "double_gyre", "rain_on_cloth", "tumbler_2d"]
HEAVY = {"time": {"dt": 0.02}, "systems": [{"type": "mass_spring", "id": "cloth", "stiffness": 1e4, "integrator": "implicit_euler",
                                             "cloth_grid": {"nx": 120, "ny": 120}}]}
HUGE = {"systems": [{"type": "mass_spring", "id": "cloth", "cloth_grid": {"nx": 20000, "ny": 20000}}]}
WRONG = [{}, [], {"systems": [{"type": "nothing"}]}, {"time": {"dt": -1}, "systems": []}, {"gallery": "none"}, {"systems": [{"type": "oscillator", "stiffness": "x"}]}, HUGE,
         {"schema_version": "1.0", "systems": [{"type": "mass_spring", "rope": {"links": 1e9}}]}]


class Client(threading.Thread):
    def __init__(self, service, seed, end):
        super().__init__(daemon=True)
        self.service, self.dice, self.end = service, random.Random(seed), end
        self.sessions, self.statuses, self.faults = [], collections.Counter(), []

    def ask(self, method, path, body=None, headers=None):
        try:
            answer = self.service.request(method, path, body, headers)
        except OSError as e:
            self.statuses[type(e).__name__] += 1
            if self.service.process.poll() is not None:
                raise
            return None
        self.statuses[answer.status] += 1
        if answer.status >= 500 and answer.status != 503:
            self.faults.append("%s %s %s: %d %s" % (method, path, str(body)[:200], answer.status, answer.body[:300]))
        return answer

    def session(self):
        return self.dice.choice(self.sessions) if self.sessions else "/v1/sessions/00000000-0000-4000-8000-000000000000"

    def create(self):
        scene = self.dice.choice([{"gallery": self.dice.choice(GALLERY)}, {**ROPE, "recording": {}}, ROPE, HEAVY, self.dice.choice(WRONG),
                                  {**ROPE, "accuracy": {"tolerance": 1e-4}}])
        answer = self.ask("POST", "/v1/sessions", scene)
        if answer and answer.status in (201, 202):
            self.sessions.append("/v1/sessions/" + json.loads(answer.body)["id"])
        while len(self.sessions) > 6:
            self.ask("DELETE", self.sessions.pop(self.dice.randrange(len(self.sessions))))

    def change(self):
        d, s = self.dice, self.session()
        path, body = d.choice([("/step", {"steps": d.choice([0, 1, 10, 1000, -1, 1e30, "x"])}), ("/step", {"seconds": d.choice([0.1, 1, 1e9])}), ("/play", {"speed": d.choice([1, 10, -1])}),
                               ("/pause", {}), ("/reset", {}), ("/seek", {"step": d.choice([0, 5, 100, 10**15])}), ("/snapshots", {}), ("/branch", {}),
                               ("/commands", {"type": d.choice(["impulse", "push", "spawn", "pin", "nothing"]), "system": d.choice(["rope", "x"]), "index": d.choice([0, 3, 10**9]),
                                              "impulse": [0, d.choice([1, 1e300]), 0]}),
                               ("/recording/finish", {}), ("/snapshots/step-0/restore", {}), ("/nothing", {})])
        if path == "/seek" and body["step"] > 1000 or path == "/step" and (body.get("steps") == 1e30 or body.get("seconds") == 1e9):
            return self.leave("POST", s + path, json.dumps(body))
        self.ask("POST", s + path, body)

    def look(self):
        s = self.session()
        self.ask("GET", self.dice.choice([s, s + "/frame", s + "/frame?step=3", s + "/frames?after=0", s + "/scene", s + "/journal", s + "/bundle", s + "/recording", s + "/picture.png?width=160&height=120",
                                          s + "/series", s + "/snapshots", s + "/frame?fields=nothing", "/v1/sessions?limit=3", "/v1/gallery", "/v1/systems", "/metrics", "/healthz", "/v1/operations",
                                          "/v1/%00", "/docs", "/openapi.json", s + "/frame?step=-1"]))

    def leave(self, method, path, body):
        """A request whose answer is not waited for."""
        with socket.create_connection(self.service.address, 20) as peer:
            peer.sendall(("%s %s HTTP/1.1\r\nHost: %s\r\nContent-Type: application/json\r\nContent-Length: %d\r\n\r\n" % (method, path, self.service.host, len(body))).encode() + body.encode())
            time.sleep(self.dice.uniform(0, 0.3))

    def stream(self):
        ws = Socket(self.service, self.session() + "/stream", self.dice.choice(["truestep.v1.json", "truestep.v1.proto"]))
        ws.socket.settimeout(2)
        if ws.status == 101:
            if self.dice.random() < 0.3:
                ws._frame(1, os.urandom(self.dice.randint(1, 200)))
            for _ in range(self.dice.randint(0, 20)):
                ws.receive()
        ws.socket.close()

    def study(self):
        answer = self.ask("POST", "/v1/studies", {"kind": self.dice.choice(["stability", "convergence", "nothing"]), "scene": self.dice.choice([ROPE, HEAVY, HUGE, {}]), "budget": 2})
        if answer and answer.status == 202 and self.dice.random() < 0.7:
            self.ask("DELETE", json.loads(answer.body)["links"]["self"])

    def garbage(self):
        with socket.create_connection(self.service.address, 20) as peer:
            peer.sendall(os.urandom(self.dice.randint(1, 2000)) if self.dice.random() < 0.5 else b"POST /v1/sessions HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n")
            peer.settimeout(1)
            try:
                peer.recv(1000)
            except OSError:
                pass

    def run(self):
        while time.monotonic() < self.end:
            what = self.dice.choices([self.create, self.change, self.look, self.stream, self.study, self.garbage], [2, 8, 8, 1, 0.3, 0.5])[0]
            try:
                what()
            except (OSError, ValueError) as e:
                self.statuses[type(e).__name__] += 1
                if self.service.process.poll() is not None:
                    self.faults.append("the server has ended: %s" % self.service.process.poll())
                    return
        for s in self.sessions:
            self.ask("DELETE", s)


def resident(service):
    return int(pathlib.Path("/proc/%d/status" % service.process.pid).read_text().split("VmRSS:")[1].split()[0]) / 1024


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 30
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    service = Service("--max-memory", "2000")
    # What any use brings: the drawing library, tables, pools.
    s = service.create({"gallery": "rigid_pyramid"})
    for path in ("/picture.png", "/frame", "/bundle"):
        service.get(s["links"]["self"] + path)
    service.request("DELETE", s["links"]["self"])
    start = resident(service)
    clients = [Client(service, 1000 * seed + k, time.monotonic() + seconds) for k in range(12)]
    for c in clients:
        c.start()
    most = start
    while any(c.is_alive() for c in clients) and service.process.poll() is None:
        time.sleep(1)
        if service.process.poll() is None:
            most = max(most, resident(service))
    statuses, faults = sum((c.statuses for c in clients), collections.Counter()), [f for c in clients for f in c.faults]
    if service.process.poll() is None:
        while sessions := service.get("/v1/sessions?limit=100").json()["sessions"]:
            for s in sessions:
                service.request("DELETE", s["links"]["self"])
        for o in service.get("/v1/operations").json()["operations"]:
            service.request("DELETE", o["links"]["self"])
        time.sleep(40)  # memory is given back every half minute
        end = resident(service)
        print([l for l in service.get("/metrics").body.decode().splitlines() if l.startswith(("truestep_memory_leased", "truestep_sessions ", "truestep_state_bytes"))])
        print("RSS %.0f MB at the start, %.0f at most, %.0f at the end (%.2f times)" % (start, most, end, end / start))
        if end > 1.5 * start:
            faults.append("memory did not come back")
    print("answers:", dict(sorted(statuses.items(), key=str)))
    code = service.stop()
    print("exit code", code)
    print("%d faults" % len(faults))
    for f in faults[:20]:
        print(f)
    return 1 if faults or code != 0 else 0


if __name__ == "__main__":
    sys.exit(main())
