"""What sessions lease against what the process takes, and how long they take to make and to step against the estimate.

    python3 measure_admission.py SCENE[xCOPIES][*SESSIONS]... [--steps N]

A scene is a file's name in scenes/ without its ending; `anim_markersx64*29` is 29 sessions, each of a scene with 64 copies of
the systems of anim_markers. Taken is the growth of the process's resident memory after all sessions have been stepped.
"""
import argparse
import json
import pathlib
import re
import time

from harness import SOURCE, Service


def copies(scene, times):
    """The scene with its systems and couplings repeated, each with ids of its own."""
    if times == 1:
        return scene
    out = {k: v for k, v in scene.items() if k not in ("expect", "probes", "observables", "recording", "accuracy")}
    id_of = lambda s, i: s.get("id", "%s%d" % (s["type"], i))
    out["systems"] = [{**s, "id": "%s_%d" % (id_of(s, i), k)} for k in range(times) for i, s in enumerate(scene["systems"])]
    if "couplings" in scene:
        out["couplings"] = [{**c, **{end: "%s_%d" % (c[end], k) for end in "ab"}, **({"id": "%s_%d" % (c["id"], k)} if "id" in c else {})}
                            for k in range(times) for c in scene["couplings"]]
    return out


def status_of(service, key):
    text = pathlib.Path("/proc/%d/status" % service.process.pid).read_text()
    return 1024 * int(text.split(key + ":")[1].split()[0])


def cpu_of(service):
    fields = pathlib.Path("/proc/%d/stat" % service.process.pid).read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / 100


def leased(service):
    lines = service.get("/metrics").body.decode().splitlines()
    return float(next(l for l in lines if l.startswith("truestep_memory_leased_bytes ")).split()[1])


def measure(what, steps):
    name, times, sessions = re.fullmatch(r"(.+?)(?:x(\d+))?(?:\*(\d+))?", what).groups()
    times, sessions = int(times or 1), int(sessions or 1)
    scene = copies(json.loads((SOURCE / "scenes" / (name + ".json")).read_text()), times)
    service = Service("--max-memory", "6000")
    before = status_of(service, "VmRSS")
    begun, answered, links = time.monotonic(), 0, []
    for _ in range(sessions):
        one = time.monotonic()
        answer = service.post("/v1/sessions", scene)
        answered = max(answered, time.monotonic() - one)
        if answer.status not in (200, 201, 202):
            print("%s: refused %d after %.2f s: %s" % (what, answer.status, answered, answer.body[:300].decode()))
            break
        link = answer.json()["links"]["self"]
        while answer.status == 202 or answer.json().get("status") == "creating":
            time.sleep(0.02)
            answer = service.get(link)
            if answer.status >= 400:
                print("%s: refused later %d after %.2f s: %s" % (what, answer.status, time.monotonic() - one, answer.body[:300].decode()))
                link = None
                break
        if link:
            links.append(link)
    made = time.monotonic() - begun
    cpu = cpu_of(service)
    for link in links:
        for _ in range(steps):
            service.post(link + "/step", {"steps": 1})
    cpu = cpu_of(service) - cpu
    taken, lease = status_of(service, "VmRSS") - before, leased(service)
    if links:
        print("%s: %d made in %.2f s (longest answer %.2f s); leased %.0f MB, taken %.0f MB, ratio %.2f; %.3g CPU s a step" %
              (what, len(links), made, answered, lease / 1e6, taken / 1e6, taken / max(lease, 1), cpu / max(1, steps * len(links))))
    service.stop()


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("scenes", nargs="+")
    options.add_argument("--steps", type=int, default=3)
    given = options.parse_args()
    for each in given.scenes:
        measure(each, given.steps)
