#!/usr/bin/env python3
"""The running program: GET of a small frame beside a bare Beast server, 100,000 particles streamed to one client, a
client that reads one byte a second, 1,000 idle sessions, and the time from start to ready."""
import http.client
import json
import os
import re
import shutil
import socket
import statistics
import subprocess
import sys
import threading
import time

BUILD = os.environ.get("TRUESTEP_BUILD", "build/release")
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "service"))
os.environ.setdefault("TRUESTEP_BINARY", BUILD + "/bin/truestep")
from harness import BINARY, Service, Socket  # noqa: E402

SMALL = {"systems": [{"type": "oscillator", "id": "a", "position": 1}]}
CLOUD = {"time": {"dt": 1 / 120}, "systems": [{"type": "particles", "id": "cloud", "linear_drag": 0.1,
         "fill": [{"arrangement": "random", "count": 100000, "half_extents": [1, 1, 1]}]}]}


def report(metric, ours, peer, name, ratio):
    print(json.dumps({"bench": "service", "metric": metric, "ours": ours, "peer": peer, "peer_name": name, "ratio": ratio,
                      "error_ours": None, "error_peer": None, "threads": 1}), flush=True)


def resident(pid):
    with open("/proc/%d/status" % pid) as status:
        return int(re.search(r"VmRSS:\s+(\d+)", status.read()).group(1)) * 1024


def cpu_seconds(pid):
    with open("/proc/%d/stat" % pid) as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def wrk(url):
    out = subprocess.run(["wrk", "-t1", "-c32", "-d1s", url], stdout=subprocess.PIPE, text=True, check=True).stdout
    if "Non-2xx" in out or "Socket errors" in out:
        sys.exit("wrk saw errors:\n" + out)
    return float(re.search(r"Requests/sec:\s+([\d.]+)", out).group(1))


def small_frame(service):
    if not shutil.which("wrk"):
        sys.exit("wrk is missing: apt-get install wrk")
    frame = service.url + service.create(SMALL)["links"]["latest_frame"]
    peer = subprocess.Popen([BUILD + "/bin/beast_hello"], stdout=subprocess.PIPE, text=True)
    try:
        hello = peer.stdout.readline().split("listening on ", 1)[1].strip()
        rounds = [(wrk(frame), wrk(hello)) for _ in range(9)]
    finally:
        peer.terminate()
        peer.wait()
    ours, theirs = (statistics.median(r[k] for r in rounds) for k in (0, 1))
    report("requests/s, GET of a small frame", ours, theirs, "Beast 1.81 hello", ours / theirs)


def frames_per_second(service, path, seconds):
    """Frames of F32 positions that one greedy client receives, and their bytes."""
    ws = Socket(service, path)
    for _ in range(20):
        ws.receive()
    frames = size = 0
    start = time.monotonic()
    while time.monotonic() - start < seconds:
        opcode, payload = ws.receive()
        if opcode == 2 and len(payload) > 1000:
            frames, size = frames + 1, size + len(payload)
    elapsed = time.monotonic() - start
    ws.close()
    return frames / elapsed, size / elapsed


def dribble(service, path, stop):
    """Reads one byte a second."""
    ws = Socket(service, path)
    ws.socket.settimeout(2)
    while not stop.wait(1):
        ws.socket.recv(1)
    ws.close()


def streaming(service):
    session = service.create(CLOUD)
    path, pid = session["links"]["stream"], service.process.pid
    service.post(session["links"]["play"])
    rate, throughput = frames_per_second(service, path, 4)
    report("frames/s, 100,000 particles as F32 to one client (bar: 60)", rate, 60, "60 frames a second", rate / 60)
    print("streamed %.0f MB/s" % (throughput / 1e6), file=sys.stderr)

    # The ring of snapshots is full after this many steps: from here on only the client can add memory.
    service.post(session["links"]["pause"])
    service.post(session["links"]["step"], {"steps": 12000})
    service.post(session["links"]["play"])

    def watch(seconds=12):
        """Steps a second, and the bytes by which the service grew meanwhile."""
        first, bytes_first, start = service.get(session["links"]["self"]).json()["step"], resident(pid), time.monotonic()
        time.sleep(seconds)
        rate = (service.get(session["links"]["self"]).json()["step"] - first) / (time.monotonic() - start)
        return rate, max(resident(pid) - bytes_first, 0)

    alone, alone_growth = watch()
    stop = threading.Event()
    slow = threading.Thread(target=dribble, args=(service, path, stop))
    slow.start()
    time.sleep(1)
    beside, beside_growth = watch()
    stop.set()
    slow.join()
    report("steps/s beside a client that reads 1 byte/s", beside, alone, "without it", beside / alone)
    report("bytes of growth in 12 s beside that client", beside_growth, alone_growth, "without it", None)
    service.request("DELETE", session["links"]["self"])


def round_trips(service):
    """Command, step and observation of four bodies in one request, beside an empty step and beside three requests."""
    bodies = [{"type": "plane", "motion": "fixed"}, *({"type": "sphere", "radius": 0.1, "position": [x, 0.5, 0]} for x in range(4))]
    url = service.create({"time": {"dt": 0.01}, "systems": [{"type": "rigid3d", "id": "w", "bodies": bodies}]})["links"]["self"]
    push = {"type": "impulse", "system": "w", "index": 1, "impulse": [1e-6, 0, 0]}
    all_in_one = json.dumps({"commands": [push], "observe": ["w.energy"], "fields": ["position", "velocity"]})
    connection = http.client.HTTPConnection(*service.address)

    def ask(method, path, body=None):
        connection.request(method, url + path, body, {"Content-Type": "application/json"} if body else {})
        response = connection.getresponse()
        if response.status >= 300:
            sys.exit("%s %s: %s" % (method, path, response.read()))
        response.read()

    def one_by_one():
        ask("POST", "/commands", json.dumps(push))
        ask("POST", "/step", "{}")
        ask("GET", "/observables?names=w.energy")

    def seconds(f, times=300):
        start = time.perf_counter()
        for _ in range(times):
            f()
        return (time.perf_counter() - start) / times

    ways = (lambda: ask("POST", "/step", all_in_one), lambda: ask("POST", "/step", "{}"), one_by_one)
    rounds = [[seconds(f) for f in ways] for _ in range(9)]
    whole, empty, three = (statistics.median(r[k] for r in rounds) for k in range(3))
    connection.close()
    report("round trips/s, command + step + observation (bar: 3,000)", 1 / whole, 1 / three, "three requests", three / whole)
    report("s of that, beside an empty step (bar: 1.15 times)", whole, empty, "empty step", empty / whole)


def idle_sessions():
    service = Service()
    try:
        pid = service.process.pid
        service.create(SMALL)
        before = resident(pid)
        for _ in range(1000):
            service.create(SMALL)
        each = (resident(pid) - before) / 1000
        cpu, start = cpu_seconds(pid), time.monotonic()
        time.sleep(5)
        share = (cpu_seconds(pid) - cpu) / (time.monotonic() - start)
    finally:
        service.stop()
    report("bytes per idle session (bar: 100 kB)", each, 100e3, "100 kB", 100e3 / each)
    report("processor share of 1,000 idle sessions", share, 0, "none", None)


def start_to_ready():
    times = []
    for _ in range(7):
        with socket.socket() as s:
            s.bind(("127.0.0.1", 0))
            port = s.getsockname()[1]
        start = time.monotonic()
        server = subprocess.Popen([BINARY, "serve", "--port", str(port), "--data-dir", "/tmp/truestep-bench"], stdout=subprocess.PIPE, text=True)
        server.stdout.readline()
        times.append(time.monotonic() - start)
        server.terminate()
        server.wait()
    report("seconds from start to ready (bar: 0.3)", statistics.median(times), 0.3, "0.3 s", 0.3 / statistics.median(times))


def main():
    service = Service()
    try:
        small_frame(service)
        streaming(service)
        round_trips(service)
    finally:
        service.stop()
    idle_sessions()
    start_to_ready()


if __name__ == "__main__":
    main()
