#!/usr/bin/env python3
"""Faults of the disk, call by call: a server whose n-th write, fsync, rename, open, mkdir ... below its data folder fails
(fixtures/faults.c) while sessions are created, stepped, recorded, commanded, kept and removed. Every request is answered, by
what was asked for or by a refusal that says why; the server goes on; and after kill -9 a server on a sound disk has everything
that was acknowledged.

usage: faults.py LIBRARY [--every K] [--offset J] [--call NAME] [--error NAME] [--number N] [--show]
"""
import hashlib
import http.client
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from harness import BINARY, Service
from patience import patience

ROPE = {"time": {"dt": 0.004, "duration": 4}, "systems": [
    {"type": "mass_spring", "id": "body", "stiffness": 500, "mass": 0.01, "damping": 0.05, "pinned": ["first"],
     "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 20}}]}
PUSH = {"type": "impulse", "system": "body", "index": 5, "impulse": [0, 0, 0.01]}
CALLS = ("open", "write", "fsync", "rename", "mkdir", "truncate", "unlink")
ERRORS = ("EIO", "ENOSPC", "short")
REFUSALS = {"disk_full": 507, "folder_io": 503, "recording_io": 503, "not_ready": 503, "quota_exceeded": 429}


class Lost(Exception):
    """A request without an answer, or one that must not be."""


class Disturbed:
    """A server with the library, and what it acknowledged."""

    def __init__(self, library, data, call, error, number, last=0, counts=None):
        self.data = data
        environment = dict(os.environ, LD_PRELOAD=library, FAULT_FOLDER=data, FAULT_CALL=call, FAULT_ERROR=error,
                           FAULT_NUMBER=str(number), FAULT_LAST=str(last))
        if counts:
            environment["FAULT_COUNTS"] = counts
        self.output = tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen([BINARY, "serve", "--port", "0", "--data-dir", data, "--log-level", "warn"],
                                        stdout=self.output, stderr=subprocess.STDOUT, text=True, env=environment)
        end = time.monotonic() + patience(20)
        while "listening on " not in self.said() and self.process.poll() is None and time.monotonic() < end:
            time.sleep(0.005)
        line = next((line for line in self.said().splitlines() if "listening on " in line), "")
        self.port = int(line.rsplit(":", 1)[1]) if line else 0
        self.refused = []  # (request, status, code)
        self.log = []

    def said(self):
        return os.pread(self.output.fileno(), 1 << 20, 0).decode()

    def ask(self, method, path, body=None, headers=None, good=(200, 201, 202, 204)):
        """The JSON of the answer, None when the disk's fault is why it was refused."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=patience(30))
        raw = isinstance(body, bytes)
        headers = dict(headers or {})
        if body is not None and not raw:
            headers["Content-Type"] = "application/json"
        try:
            connection.request(method, path, body if raw or body is None else json.dumps(body), headers)
            response = connection.getresponse()
            data = response.read()
        except (OSError, http.client.HTTPException) as e:
            raise Lost("%s %s: no answer (%r), exit code %s\n%s" % (method, path, e, self.process.poll(), self.said())) from e
        finally:
            connection.close()
        what = "%s %s" % (method, path.replace("/v1/sessions", ""))
        self.log.append("%s -> %d" % (what, response.status))
        is_json = "json" in response.headers.get("Content-Type", "")
        answer = json.loads(data) if data and is_json else data
        if response.status in good:
            return answer if data else {}
        code = answer.get("code") if is_json else None
        if REFUSALS.get(code) == response.status:
            self.refused.append((what, response.status, code))
            return None
        raise Lost("%s: %d %s\n%s" % (what, response.status, data[:600], self.said()))


class Course:
    """What one client does; `held` is what must be there afterwards."""

    def __init__(self, server, name):
        self.server, self.name, self.held, self.assets, self.recorded = server, name, {}, set(), {}

    def create(self, scene):
        made = self.server.ask("POST", "/v1/sessions", scene)
        if made:
            self.note(made["id"])
        return made and made["id"]

    def note(self, session):
        """The session as it is, held if the server says that it is kept."""
        now = self.server.ask("GET", "/v1/sessions/" + session)
        while now and now["status"] in ("creating", "restoring"):
            time.sleep(0.01)
            now = self.server.ask("GET", "/v1/sessions/" + session)
        if now is None:
            return
        if now.get("kept"):
            self.held[session] = (now["step"], now["state_hash"])
        else:
            # It says why, or the server did when it started without a folder.
            said = self.server.said()
            if not now.get("not_kept_because") and "are not kept" not in said and "no session outlives" not in said:
                raise Lost("session %s is not kept, and nobody says why" % session)
            self.held.pop(session, None)

    def step(self, session, n):
        self.server.ask("POST", "/v1/sessions/%s/step" % session, {"steps": n})
        self.note(session)

    def run(self):
        ask = self.server.ask
        ask("GET", "/readyz", good=(200, 503))
        first = self.create(dict(ROPE, recording={}))
        second = self.create(ROPE)
        for session in filter(None, (first, second)):
            path = "/v1/sessions/" + session
            self.step(session, 7)
            ask("POST", path + "/commands", PUSH)
            self.step(session, 30)
            snapshot = ask("POST", path + "/snapshots", {})
            self.step(session, 3)
            if snapshot:
                ask("GET", path + "/snapshots/" + snapshot["id"])
                ask("POST", "%s/snapshots/%s/restore" % (path, snapshot["id"]), {})
                self.note(session)
            ask("POST", path + "/seek", {"step": 37})
            self.note(session)
            ask("POST", path + "/commands", PUSH)
            self.step(session, 5)
            ask("GET", path + "/bundle")
            branch = ask("POST", path + "/branch", {})
            if branch:
                self.note(branch["id"])
                self.step(branch["id"], 4)
            ask("POST", path + "/play", {"speed": 1})
            time.sleep(0.03)
            ask("POST", path + "/pause", {})
            self.note(session)
        text = json.dumps([1, 2, self.name]).encode()
        digest = hashlib.sha256(text).hexdigest()
        if ask("PUT", "/v1/assets/" + digest, text, {"Content-Type": "application/json"}) is not None:
            self.assets.add(digest)
            ask("GET", "/v1/assets/" + digest)
        if first:
            ask("POST", "/v1/sessions/%s/recording/finish" % first, {}, good=(200, 404))
            ask("GET", "/v1/sessions/%s/recording" % first, good=(200, 404))
        page = ask("GET", "/v1/recordings")
        for r in page["recordings"] if page else ():
            self.recorded[r["id"]] = r["frames"]
        if second:
            if ask("DELETE", "/v1/sessions/" + second) is not None:
                self.held.pop(second, None)
        self.create(ROPE)
        assert ask("GET", "/healthz") is not None
        ask("GET", "/v1/sessions")


def hash_at(service, session, step):
    answer = service.post("/v1/sessions/%s/seek" % session, {"step": step})
    return answer.status == 200 and answer.json()["state_hash"]


def trial(library, call, error, number, last=0):
    """What went wrong, and what was refused."""
    data = os.path.realpath(tempfile.mkdtemp(prefix="truestep"))
    server = None
    try:
        server = Disturbed(library, data, call, error, number, last)
        if not server.port:
            code = server.process.wait(patience(20))
            # A start that is refused says why and ends in order.
            return (None if code in (2, 5) and server.said() else "start ended with %s\n%s" % (code, server.said())), ["start"]
        course = Course(server, "asset")
        try:
            course.run()
        except Lost as e:
            return str(e), server.refused
        if server.process.poll() is not None:
            return "the server ended with %s" % server.process.returncode, server.refused
        server.process.kill()
        server.process.wait()
        sound = Service(data=data)
        try:
            end = time.monotonic() + patience(20)
            while sound.get("/readyz").status != 200 and time.monotonic() < end:
                time.sleep(0.01)
            for session, (step, state) in course.held.items():
                answer = sound.get("/v1/sessions/" + session)
                if answer.status != 200:
                    return "session %s is lost: %d %s" % (session, answer.status, answer.body[:300]), server.refused
                now = answer.json()
                if now["step"] < step or not now["restored"]["complete"]:
                    return "session %s was at step %d and is at %s" % (session, step, now["restored"]), server.refused
                if now["step"] == step and now["state_hash"] != state:
                    return "session %s has another hash at step %d" % (session, step), server.refused
            for digest in course.assets:
                if sound.get("/v1/assets/" + digest).status != 200:
                    return "an asset is lost", server.refused
            there = {r["id"]: r["frames"] for r in sound.get("/v1/recordings").json()["recordings"]}
            for name, frames in course.recorded.items():
                if there.get(name, 0) < frames:
                    return "recording %s had %d frames and has %s" % (name, frames, there.get(name)), server.refused
        finally:
            sound.process.kill()
            sound.process.wait()
        return None, server.refused
    finally:
        if server and server.process.poll() is None:
            server.process.kill()
            server.process.wait()
        shutil.rmtree(data, ignore_errors=True)


def counts(library):
    """How many calls of each kind an undisturbed course makes."""
    data = os.path.realpath(tempfile.mkdtemp(prefix="truestep"))
    with tempfile.NamedTemporaryFile("r") as out:
        server = Disturbed(library, data, "", "EIO", 0, counts=out.name)
        Course(server, "asset").run()
        server.process.send_signal(signal.SIGTERM)
        server.process.wait(patience(20))
        found = dict(line.split() for line in pathlib.Path(out.name).read_text().splitlines())
    shutil.rmtree(data, ignore_errors=True)
    return {name: int(n) for name, n in found.items()}


def option(name, default):
    return type(default)(sys.argv[sys.argv.index(name) + 1]) if name in sys.argv else default


def main():
    library = sys.argv[1]
    every, offset, call, error, number = option("--every", 1), option("--offset", 0), option("--call", ""), option("--error", ""), option("--number", 0)
    there = counts(library)
    print("calls of an undisturbed course:", there, flush=True)
    assert all(there[c] > 0 for c in CALLS if c != "truncate"), there
    trials = []
    for c in CALLS:
        for e in ERRORS if c == "write" else ERRORS[:2]:
            # One that fails, and from one on all: a disk that is full.
            trials += [(c, e, n, last) for n in range(1, there[c] + 1) for last in ((0,) if e != "ENOSPC" else (0, 1 << 30))]
    trials = [t for t in trials if (not call or t[0] == call) and (not error or t[1] == error) and (not number or t[2] == number)]
    chosen = trials[offset::every]
    failed = refused = 0
    for c, e, n, last in chosen:
        why, refusals = trial(library, c, e, n, last)
        refused += bool(refusals)
        if "--show" in sys.argv:
            print(c, e, n, last, refusals, flush=True)
        if why:
            failed += 1
            print("%s number %d%s fails with %s: %s" % (c, n, " and all later" if last else "", e, why), flush=True)
    print("%d faults of %d: %d led to a refusal, %d to something wrong" % (len(chosen), len(trials), refused, failed))
    # The control: faults that nobody notices would test nothing.
    sys.exit(1 if failed or not refused else 0)


if __name__ == "__main__":
    main()
