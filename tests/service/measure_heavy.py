"""How long others wait while four clients send requests that take long to read: a scene that names one asset of 300,000
positions ten times, a scene with 200,000 unknown keys, and studies of both.

    python3 measure_heavy.py [SECONDS]

Prints the median, the 99th percentile and the longest time of GET of a session, of /healthz and of a step of one mass. The bars:
99 of 100 GET within 50 ms and steps within 100 ms on a machine with a core to spare.
"""
import hashlib
import json
import sys
import threading
import time

from cases import OSCILLATOR
from harness import Service


def scene_of_assets(service, positions=300_000, times=10):
    asset = json.dumps([[k % 97, k % 89, k % 83] for k in range(positions)])
    sha = hashlib.sha256(asset.encode()).hexdigest()
    assert service.request("PUT", "/v1/assets/" + sha, asset, {"Content-Type": "application/json"}).status in (200, 201)
    return json.dumps({"systems": [{"type": "particles", "id": "s%d" % k, "positions": {"asset": sha}, "max_particles": positions}
                                   for k in range(times)]})


def scene_of_unknown_keys(count=200_000):
    return json.dumps({"systems": [{"type": "particles", "positions": [[0, 0, 0]], **{"key_%d" % k: k for k in range(count)}}]})


def send(service, path, body):
    """The status; 0 when no answer came."""
    try:
        return service.request("POST", path, body, {"Content-Type": "application/json"}).status
    except OSError:
        return 0


def measure(kind, request, seconds):
    service = Service()
    path, body = request(service)
    session = service.create(OSCILLATOR)["id"]
    end, times, answers = time.monotonic() + seconds, {}, []

    def load():
        while time.monotonic() < end:
            answers.append(send(service, path, body))

    def probe(name, ask):
        took = times.setdefault(name, [])
        while time.monotonic() < end:
            begun = time.monotonic()
            ask()
            took.append(time.monotonic() - begun)
            time.sleep(0.02)

    threads = [threading.Thread(target=load) for _ in range(4)]
    for name, ask in (("GET session", lambda: service.get("/v1/sessions/" + session)), ("GET healthz", lambda: service.get("/healthz")),
                      ("step", lambda: service.post("/v1/sessions/%s/step" % session, {"steps": 1}))):
        threads.append(threading.Thread(target=probe, args=(name, ask)))
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    print("%s: %d heavy requests answered, statuses %s" % (kind, len(answers), sorted(set(answers))))
    for name, took in times.items():
        took.sort()
        print("  %-12s %5d requests: median %7.1f ms, p99 %7.1f ms, longest %8.1f ms" %
              (name, len(took), *(1e3 * took[int(q * (len(took) - 1))] for q in (0.5, 0.99, 1))))
    service.stop()


def main(seconds):
    for path in ("/v1/sessions", "/v1/runs"):
        whole = '{"scene": %s}' if path == "/v1/runs" else "%s"
        measure(path + " of assets", lambda service: (path, whole % scene_of_assets(service)), seconds)
        measure(path + " of unknown keys", lambda service: (path, whole % scene_of_unknown_keys()), seconds)


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 15)
