#!/usr/bin/env python3
"""How long a small session waits while others work: two sessions of a million elements that play, six studies, and one client
that steps and creates small sessions. Prints percentiles. By hand: TRUESTEP_BINARY=... measure_fairness.py [SECONDS]
With --gallery instead: six gallery scenes that play and that nobody watches.
"""
import sys
import time

from harness import Service

LARGE = {"time": {"dt": 0.001}, "systems": [{"type": "mass_spring", "id": "cloth", "stiffness": 100, "mass": 0.01, "integrator": "velocity_verlet",
                                              "cloth_grid": {"nx": 380, "ny": 380}}]}
ROPE = {"time": {"dt": 0.004}, "systems": [{"type": "mass_spring", "id": "rope", "stiffness": 2000, "mass": 0.01, "pinned": ["first"],
                                             "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 40}}]}


def percentile(values, share):
    return 1000 * sorted(values)[min(len(values) - 1, int(share * len(values)))]


def watch(service, seconds):
    """ms that steps, reads and creates took."""
    s = service.create(ROPE)
    waits = {"step": [], "read": [], "create": []}
    end = time.monotonic() + seconds

    def timed(what, method, path, body=None):
        begin = time.monotonic()
        answer = service.request(method, path, body)
        waits[what].append(time.monotonic() - begin)
        assert answer.status < 300, answer.body
        return answer.json()

    while time.monotonic() < end:
        for _ in range(10):
            timed("step", "POST", s["links"]["step"], {"steps": 1})
            timed("read", "GET", s["links"]["self"])
            time.sleep(0.01)
        new = timed("create", "POST", "/v1/sessions", ROPE)
        service.request("DELETE", new["links"]["self"])
    return waits


def report(title, waits):
    for what, values in waits.items():
        print("%-28s %-7s n %5d  median %7.2f ms  p95 %7.2f ms  worst %8.2f ms" %
              (title, what, len(values), percentile(values, 0.5), percentile(values, 0.95), percentile(values, 1)))


def gallery(seconds):
    service = Service("--pause-unwatched", "forever")
    try:
        report("alone", watch(service, seconds / 4))
        names = ["hourglass", "mixed_pile", "avalanche_of_shapes", "fountain", "curtain_in_wind", "rag_doll_pile"]
        known = [g["name"] for g in service.get("/v1/gallery").json()["scenes"]]
        names = [n for n in names if n in known]
        names += [n for n in known if n not in names][:6 - len(names)]
        playing = [service.create({"gallery": n}) for n in names]
        for s in playing:
            service.post(s["links"]["play"])
        report("six of the gallery play", watch(service, seconds))
        for name, s in zip(names, playing):
            now = service.get(s["links"]["self"]).json()
            print("%-28s %s, speed %g, comes to %.3g" % (name, now["status"], now["speed"], now.get("achieved_speed", 0)))
    finally:
        service.stop()


def main():
    arguments = [a for a in sys.argv[1:] if a != "--gallery"]
    seconds = float(arguments[0]) if arguments else 20
    if "--gallery" in sys.argv:
        return gallery(seconds)
    service = Service("--max-memory", "12000")
    try:
        report("alone", watch(service, seconds / 4))
        large = [service.create(LARGE) for _ in range(2)]
        elements = service.get(large[0]["links"]["self"]).json().get("cost", {}).get("elements")
        for s in large:
            service.post(s["links"]["play"])
        report("two large (%s) play" % elements, watch(service, seconds / 2))
        for k in range(6):
            answer = service.post("/v1/studies", {"kind": "stability", "scene": {**ROPE, "time": {"dt": 0.001 + 1e-5 * k, "duration": 100}}, "budget": 100})
            assert answer.status == 202, answer.body
        report("and six studies", watch(service, seconds))
        steps = [service.get(s["links"]["self"]).json()["step"] for s in large]
        print("steps of the large ones:", steps)
    finally:
        service.stop()


if __name__ == "__main__":
    main()
