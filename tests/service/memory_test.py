"""One budget of memory: whatever takes much asks it first, and what it grants is what the process takes."""
import pathlib
import resource
import time
import unittest

from harness import Service
from patience import patience

MB = 1e6


def cloth(points, integrator="velocity_verlet", dt=0.001, long=None):
    return {"time": {"dt": dt}, "systems": [{"type": "mass_spring", "id": "cloth", "stiffness": 100, "mass": 0.01, "integrator": integrator,
                                            "cloth_grid": {"nx": points, "ny": long or points}}]}


class Memory(unittest.TestCase):
    def serve(self, megabytes):
        service = Service("--max-memory", str(megabytes))
        self.addCleanup(service.stop)
        return service

    def resident(self, service):
        status = pathlib.Path("/proc/%d/status" % service.process.pid).read_text()
        return 1024 * int(status.split("VmRSS:")[1].split()[0])

    def leased(self, service):
        lines = service.get("/metrics").body.decode().splitlines()
        return float(next(l for l in lines if l.startswith("truestep_memory_leased_bytes ")).split()[1])

    def test_the_past_is_as_long_as_there_is_room(self):
        # 22,500 points are 1.1 MB of state; a history on its own takes 32 MB.
        service = self.serve(150)
        start = self.resident(service)
        sessions = [service.create(cloth(150)) for _ in range(3)]
        alone = self.leased(service)
        for s in sessions:
            service.post(s["links"]["step"], {"steps": 600})
        with_past = self.leased(service)
        # A state of each at least: how many more depends on how long their steps take.
        self.assertGreater(with_past, alone + 3 * MB, "the control: pasts are kept and counted")
        self.assertLessEqual(with_past, 150 * MB)
        self.assertLess(self.resident(service) - start, 1.1 * 150 * MB)
        # However few snapshots are left, every step of the past can be gone back to.
        first = sessions[0]
        end = service.get(first["links"]["self"]).json()["state_hash"]
        self.assertEqual(service.post(first["links"]["self"] + "/seek", {"step": 300}).json()["step"], 300)
        self.assertEqual(service.post(first["links"]["self"] + "/seek", {"step": 600}).json()["state_hash"], end)
        for s in sessions:
            service.request("DELETE", s["links"]["self"])
        # What still works on a session that is gone returns its memory when it notices.
        end = time.monotonic() + patience(10)
        while self.leased(service) >= 1 * MB and time.monotonic() < end:
            time.sleep(0.05)
        self.assertLess(self.leased(service), 1 * MB)

    def test_snapshots_are_counted(self):
        # Room for some twenty of them, fewer than a session may have.
        service = self.serve(80)
        s = service.create(cloth(150))
        statuses = []
        while len(statuses) < 60 and (not statuses or statuses[-1] == 201):
            service.post(s["links"]["step"], {"steps": 1})
            statuses.append(service.post(s["links"]["self"] + "/snapshots").status)
        self.assertEqual(statuses[-1], 429)
        self.assertGreater(len(statuses), 5)
        self.assertEqual(service.post(s["links"]["step"], {"steps": 1}).status, 200)

    def test_a_study_of_a_scene_that_is_too_large(self):
        service = self.serve(500)
        large = cloth(1500, "implicit_euler", 0.02)
        self.assertEqual(service.post("/v1/sessions", large).status, 413)
        self.assertEqual(service.post("/v1/studies", {"kind": "stability", "scene": large}).status, 413)

    def test_variants_of_a_study_are_admitted_one_by_one(self):
        service = self.serve(500)
        sweep = {"kind": "sweep", "scene": cloth(10, long=1000), "axes": [{"pointer": "/systems/0/cloth_grid/nx", "values": [10, 1000]}],
                 "horizon": 0.002, "measure": ["energy.total"]}
        operation = service.post("/v1/studies", sweep)
        self.assertEqual(operation.status, 202, operation.body)
        link = operation.json()["links"]["self"]
        end = time.monotonic() + patience(30)
        while (state := service.get(link).json())["status"] in ("waiting", "running"):
            self.assertLess(time.monotonic(), end)
            time.sleep(0.05)
        rows = service.get(link + "/result.csv").body.decode()
        self.assertEqual(rows.count(",ok"), 1, rows)
        self.assertIn("memory", rows)

    def test_a_machine_that_gives_no_more_memory_is_an_answer_not_an_end(self):
        service = self.serve(8000)

        def leave(more):
            used = int(pathlib.Path("/proc/%d/statm" % service.process.pid).read_text().split()[0]) * resource.getpagesize()
            resource.prlimit(service.process.pid, resource.RLIMIT_AS, (used + more, resource.RLIM_INFINITY))

        leave(900_000_000)
        gas = {"systems": [{"type": "particles", "id": "gas", "fill": [{"count": 300_000, "speed_spread": 2}],
                            "colliders": [{"type": "plane", "point": [0, -1, 0]}]}]}
        statuses = []
        while len(statuses) < 60 and (not statuses or statuses[-1] == 201):
            answer = service.made(gas)
            statuses.append(answer.status)
            if answer.status == 201:
                service.post(answer.json()["links"]["step"], {"steps": 2})
        self.assertEqual(statuses[-1], 503, "the control: memory ends before the budget does")
        self.assertGreater(len(statuses), 1)
        self.assertEqual(service.get("/healthz").status, 200)
        # The end finds none at all: what cannot be saved is in its log.
        resource.prlimit(service.process.pid, resource.RLIMIT_AS, (1 << 20, resource.RLIM_INFINITY))
        self.assertEqual(service.stop(), 0)

    def test_memory_comes_back_after_load(self):
        service = self.serve(2000)
        for _ in range(3):
            s = service.create(cloth(20))
            service.request("DELETE", s["links"]["self"])
        start = self.resident(service)
        for _ in range(2):
            sessions = [service.create(cloth(200)) for _ in range(4)]
            for s in sessions:
                service.post(s["links"]["step"], {"steps": 20})
            loaded = self.resident(service)
            for s in sessions:
                service.request("DELETE", s["links"]["self"])
        self.assertGreater(loaded, 2 * start, "the control: there was a load")
        end = time.monotonic() + patience(10)
        while self.resident(service) > 1.5 * start:
            self.assertLess(time.monotonic(), end, "%.0f MB of %.0f MB" % (self.resident(service) / MB, start / MB))
            time.sleep(0.1)


if __name__ == "__main__":
    unittest.main()
