#!/usr/bin/env python3
"""kill -9 of a server whose sessions are stepped, played, sought and commanded, some of them recording; and again. After every
restart each session must be at a step no earlier than the last that was acknowledged, with the hash that a session on a
server that nobody kills has there; at the end every frame must be in the recordings, once.

usage: restart_kills.py [--kills 200] [--sessions 20] [--seed 1]
"""
import http.client
import json
import random
import shutil
import subprocess
import sys
import tempfile
import threading
import time

from harness import Service, Socket
from patience import patience


def option(name, default):
    return type(default)(sys.argv[sys.argv.index(name) + 1]) if name in sys.argv else default


KILLS, SESSIONS, SEED = option("--kills", 200), option("--sessions", 20), option("--seed", 1)
ROPE = {"time": {"dt": 0.004, "duration": 100000}, "systems": [
    {"type": "mass_spring", "id": "body", "stiffness": 500, "mass": 0.01, "damping": 0.05, "pinned": ["first"],
     "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 30}}]}
PILE = {"time": {"dt": 0.005, "duration": 100000}, "systems": [
    {"type": "rigid2d", "id": "body", "bodies": [{"motion": "fixed", "shapes": [{"type": "box", "half_extents": [9, 0.1, 0]}]}] + [
        {"position": [0.3 * (k % 5), 0.5 + 0.5 * k, 0], "shapes": [{"type": "box", "half_extents": [0.2, 0.2, 0]}]} for k in range(12)]}]}


class Killed(Exception):
    pass


class Client:
    def __init__(self, service):
        self.connection = http.client.HTTPConnection(*service.address, timeout=patience(60))

    def ask(self, method, path, body=None):
        try:
            self.connection.request(method, path, None if body is None else json.dumps(body), {"Content-Type": "application/json"} if body is not None else {})
            response = self.connection.getresponse()
            data = response.read()
        except (OSError, http.client.HTTPException) as e:
            raise Killed from e
        return response.status, json.loads(data) if data else None


class Course:
    """One session, its twin on the server that is never killed, and what was acknowledged."""

    def __init__(self, number, service, twin_service):
        self.number, self.rng = number, random.Random(SEED * 1000 + number)
        scene = dict((ROPE, PILE)[number % 2], name="session %d" % number)
        self.recording, self.playing, self.watching = number % 4 == 1, number % 5 == 2, number % 10 == 7
        if self.recording:
            scene["recording"] = {}
        self.twin_service = twin_service
        status, made = Client(service).ask("POST", "/v1/sessions", scene)
        assert status == 201, made
        scene.pop("recording", None)
        status, twin = Client(twin_service).ask("POST", "/v1/sessions", scene)
        assert status == 201, twin
        self.path, self.id, self.twin = made["links"]["self"], made["id"], twin["links"]["self"]
        self.done = []  # acknowledged since the twin was brought up: ("command", step, command), ("seek", step)
        self.step, self.flight, self.frames = 0, None, 0
        self.commands = self.steps = 0

    def command(self):
        impulse = [self.rng.uniform(-0.01, 0.01), self.rng.uniform(-0.01, 0.01), 0]
        return {"type": "impulse", "system": "body", "index": self.rng.randrange(1, 12), "impulse": impulse}

    def frame(self, service):
        """The step of the next frame of a stream."""
        try:
            if self.stream is None:
                self.stream = Socket(service, self.path + "/stream", "truestep.v1.json")
            self.stream.socket.settimeout(0.2)
            return max(self.step, int(self.stream.message("frame").get("step", 0)))
        except TimeoutError:
            # It may have cut a message in two.
            self.stream.close()
            self.stream = None
            return self.step
        except (OSError, ValueError, IndexError) as e:
            raise Killed from e

    def work(self, service):
        """Until the server dies."""
        client, self.stream = Client(service), None
        try:
            while True:
                dice = self.rng.random()
                if dice < 0.2:
                    command = self.command()
                    self.flight = ("command", command)
                    status, answer = client.ask("POST", self.path + "/commands", command)
                    assert status == 202, (status, answer)
                    self.done.append(("command", answer["step"], command))
                    self.step = answer["step"]
                    self.commands += 1
                elif self.playing and dice < 0.3:
                    status, answer = client.ask("POST", self.path + "/play", {"speed": 3})
                    assert status == 200, (status, answer)
                    self.step = answer["step"]
                elif self.playing and self.watching:
                    self.step = self.frame(service)
                elif self.playing:
                    time.sleep(0.01)
                    status, answer = client.ask("GET", self.path)
                    assert status == 200, (status, answer)
                    self.step = answer["step"]
                elif dice < 0.25 and not self.recording:
                    status, answer = client.ask("GET", self.path)
                    first = answer["first_step"]
                    to = self.rng.randrange(first, self.step + 5) if self.step >= first else first
                    self.flight = ("seek", to)
                    status, answer = client.ask("POST", self.path + "/seek", {"step": to})
                    assert status == 200 and answer["step"] == to, (status, answer)
                    self.done.append(("seek", to))
                    self.step = to
                else:
                    n = self.rng.choice((1, 1, 3, 40))
                    self.flight = ("step", n)
                    status, answer = client.ask("POST", self.path + "/step", {"steps": n})
                    assert status == 200, (status, answer)
                    self.step = answer["step"]
                    self.steps += n
                self.flight = None
                if self.recording and dice > 0.9:
                    status, answer = client.ask("GET", "/v1/recordings/" + self.newest)
                    if status == 200:
                        self.durable[self.newest] = answer["frames"]
        except Killed:
            pass

    newest, durable = "", {}

    # --- the twin

    def at(self, client, step):
        """The twin's hash there."""
        status, answer = client.ask("POST", self.twin + "/seek", {"step": step})
        assert status == 200, answer
        return answer["state_hash"]

    def follow(self, client):
        for what, value, *command in self.done:
            self.at(client, value)
            if what == "command":
                status, answer = client.ask("POST", self.twin + "/commands", command[0])
                assert status == 202, answer
        self.done = []

    def check(self, service):
        status, now = Client(service).ask("GET", self.path)
        while status == 200 and now["status"] == "restoring":  # for more than five seconds, beside others
            time.sleep(0.1)
            status, now = Client(service).ask("GET", self.path)
        assert status == 200 and "restored" in now, (self.number, status, now)
        assert now["restored"]["complete"] and now["status"] == "paused", now
        step, found = now["step"], now["state_hash"]
        client = Client(self.twin_service)
        self.follow(client)
        kind, value = self.flight or ("none", None)
        # What was acknowledged last, unless what was asked for last has gone back from there.
        back = kind == "seek" and step == value
        assert step >= self.step or back, (self.number, "acknowledged", self.step, "found", step, self.flight)
        same = self.at(client, step) == found
        if not same and kind == "command":
            # It may have been carried out before anybody could say so, at any step since the last word.
            k = next((k for k in range(self.step, step + 1) if self.branched(client, k, value, step) == found), None)
            same = k is not None
            if same:
                self.done.append(("command", k, value))
                self.follow(client)
        assert same, (self.number, "the hash at step", step, "is another", self.flight, now["restored"])
        self.step, self.flight = step, None
        return now["restored"]["step"] - now["restored"]["from_step"]

    def branched(self, client, at, command, step):
        """The hash at `step` of a session that is commanded at a step of the twin's past."""
        self.at(client, at)
        status, branch = client.ask("POST", self.twin + "/branch", {})
        assert status == 201, branch
        path = branch["links"]["self"]
        client.ask("POST", path + "/commands", command)
        status, answer = client.ask("POST", path + "/step", {"steps": step - at})
        client.ask("DELETE", path)
        return answer["state_hash"]


def recordings(service):
    page, token = {}, ""
    while token is not None:
        _, answer = Client(service).ask("GET", "/v1/recordings?limit=1000&page_token=" + token)
        page.update({r["id"]: r for r in answer["recordings"]})
        token = answer.get("next_page_token")
    return page


def main():
    random.seed(SEED)
    data = tempfile.mkdtemp(prefix="truestep")
    twin_service = Service("--keep-sessions", "0")
    service = Service(data=data)
    kills = 0
    restored, ready = [], []
    try:
        courses = [Course(k, service, twin_service) for k in range(SESSIONS)]
        for c in courses:
            c.newest, c.durable = c.id, {}
        while kills < KILLS:
            threads = [threading.Thread(target=c.work, args=(service,)) for c in courses]
            for t in threads:
                t.start()
            time.sleep(random.uniform(0.05, 0.6))
            service.process.kill()
            service.process.wait()
            service.process.stdout.close()
            for t in threads:
                t.join()
            kills += 1
            begun = time.monotonic()
            service = Service(data=data)
            while Client(service).ask("GET", "/readyz")[0] != 200:
                time.sleep(0.01)
            ready.append(time.monotonic() - begun)
            for c in courses:
                restored.append(c.check(service))
            page = recordings(service)
            for c in courses:
                for name, frames in c.durable.items():
                    there = page.get(name, {"frames": 0})
                    assert there["frames"] >= frames, (name, "had", frames, "durable frames", there)
                mine = [r["id"] for r in page.values() if r["session"] == c.id]
                c.newest = "%s.%d" % (c.id, len(mine) + 1) if mine else c.id
        frames = 0
        for c in courses:
            if c.recording:
                client = Client(service)
                status, answer = client.ask("POST", c.path + "/recording/finish", {})
                assert status == 200, answer
                mine = sum(r["frames"] for r in recordings(service).values() if r["session"] == c.id)
                _, now = client.ask("GET", c.path)
                assert mine == now["step"] + 1, (c.number, "frames", mine, "of", now["step"] + 1)
                frames += mine
    finally:
        service.stop()
        twin_service.stop()
        shutil.rmtree(data, ignore_errors=True)
    restored.sort()
    print("%d kills, %d sessions: %d restored at the uninterrupted hash, %d commands and %d steps acknowledged; repeated steps median %d, most %d; "
          "%d frames recorded, none missing, none twice; ready again in %.2f s at most"
          % (kills, SESSIONS, len(restored), sum(c.commands for c in courses), sum(c.steps for c in courses), restored[len(restored) // 2], restored[-1],
             frames, max(ready)))


if __name__ == "__main__":
    main()
