"""Studies over HTTP and on the command line: started, watched, cancelled, resumed; refused with reasons."""
import http.client
import json
import os
import pathlib
import subprocess
import tempfile
import time
import unittest
import xml.etree.ElementTree

from harness import BINARY, Service
from patience import patience

OSCILLATOR = {"schema_version": "1.0", "name": "oscillator", "time": {"dt": 0.01, "duration": 2},
              "systems": [{"type": "oscillator", "id": "o", "mass": 1, "stiffness": 100, "position": 1, "velocity": 0}]}
SLOW_SWEEP = {"kind": "sweep", "scene": {**OSCILLATOR, "time": {"dt": 1e-5, "duration": 3}},
              "axes": [{"pointer": "/systems/0/stiffness", "min": 1, "max": 100, "count": 40}],
              "measure": ["energy.total"]}


class Studies(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.service = Service()

    @classmethod
    def tearDownClass(cls):
        cls.service.stop()

    def wait(self, operation, until=("done", "failed", "cancelled")):
        until_when = time.monotonic() + patience(30)
        while time.monotonic() < until_when:
            state = self.service.get(operation).json()
            if state["status"] in until:
                return state
            time.sleep(0.05)
        self.fail(f"the operation did not end: {state}")

    def start(self, request):
        answer = self.service.post("/v1/studies", request)
        self.assertEqual(answer.status, 202, answer.body)
        self.assertEqual(answer.headers["Location"], answer.json()["links"]["self"])
        return answer.headers["Location"]

    def test_work_precision_gives_table_plot_and_summary(self):
        operation = self.start({"kind": "work_precision", "scene": OSCILLATOR, "integrators": ["rk4", "heun"], "budget": 3})
        state = self.wait(operation)
        self.assertEqual(state["status"], "done", state)
        result = self.service.get(operation + "/result").json()
        self.assertEqual({row["integrator"] for row in result["rows"]}, {"rk4", "heun"})
        lines = self.service.get(operation + "/result.csv").body.decode().split("\r\n")
        self.assertEqual(len(lines), len(result["rows"]) + 2)
        svg = xml.etree.ElementTree.fromstring(self.service.get(operation + "/result.svg").body)
        self.assertIn("heun", "".join(svg.itertext()))

    def test_convergence_in_space_over_http(self):
        rod = {"schema_version": "1.0", "name": "rod", "time": {"dt": 0.001, "duration": 0.05},
               "systems": [{"type": "heat", "id": "rod", "cells": [16], "side": {"kind": "dirichlet"},
                            "initial": "sin(pi*x)", "exact": "exp(-pi^2*t)*sin(pi*x)"}]}
        self.assertEqual(self.service.get("/v1/systems/heat").json()["resolution"], "cells")
        operation = self.start({"kind": "convergence", "scene": rod, "refine": "space", "budget": 20})
        state = self.wait(operation)
        self.assertEqual(state["status"], "done", state)
        summary = self.service.get(operation + "/result").json()["summary"]
        self.assertAlmostEqual(summary["observed_order"], 2, delta=0.05)
        self.assertEqual(summary["subject"], "rod.cells")
        # A scene that nothing can refine says what could be.
        state = self.wait(self.start({"kind": "convergence", "scene": OSCILLATOR, "refine": "both"}))
        self.assertEqual(state["status"], "failed")
        fault = state["error"]["errors"][0]
        self.assertEqual(fault["pointer"], "/refine")
        self.assertIn("heat (cells)", fault["allowed"])

    def test_cancelled_sweep_goes_on_where_it_was(self):
        first = self.start(SLOW_SWEEP)
        self.assertEqual(self.service.get(first + "/result").status, 409)
        until_when = time.monotonic() + patience(10)
        while self.service.get(first).json()["progress"] <= 0.1 and time.monotonic() < until_when:
            time.sleep(0.02)
        self.service.post(first + "/cancel")
        self.assertEqual(self.wait(first)["status"], "cancelled")
        self.assertEqual(self.service.get(first + "/result").status, 404)
        identifier = first.rsplit("/", 1)[1]
        second = self.start({**SLOW_SWEEP, "resume": identifier})
        summary = self.wait(second)["summary"]
        self.assertGreater(summary["reused"], 0)
        self.assertLess(summary["reused"], summary["cases"])
        other = self.service.post("/v1/studies", {**SLOW_SWEEP, "measure": ["energy.kinetic"], "resume": identifier})
        self.assertEqual(other.status, 409)

    def test_events_tell_progress_and_end(self):
        operation = self.start({"kind": "work_precision", "scene": OSCILLATOR, "integrators": ["rk4"], "budget": 2})
        connection = http.client.HTTPConnection(*self.service.address, timeout=patience(60))
        connection.request("GET", operation + "/events")
        response = connection.getresponse()
        self.assertEqual(response.headers["Content-Type"], "text/event-stream")
        events = [dict(line.split(": ", 1) for line in block.split("\n")) for block in
                  response.read().decode().strip().split("\n\n") if not block.startswith(":")]
        self.assertEqual(events[-1]["event"], "end")
        self.assertEqual(json.loads(events[-1]["data"])["status"], "done")
        for event in events[:-1]:
            self.assertEqual(event["event"], "progress")
        # The connection serves the next request: the stream ended where it said.
        connection.request("GET", operation)
        self.assertEqual(connection.getresponse().status, 200)
        connection.close()

    def test_faults_name_their_place(self):
        for request, pointer in [({"kind": "sweep"}, ""), ({"kind": "x", "scene": OSCILLATOR}, "/kind"),
                                 ({"kind": "convergence", "scene": {**OSCILLATOR, "seed": -1}}, "/scene/seed"),
                                 ({"kind": "convergence", "scene": OSCILLATOR, "halvings": "many"}, "/halvings")]:
            answer = self.service.post("/v1/studies", request)
            self.assertEqual(answer.status, 422, answer.body)
            self.assertIn(pointer, [e["pointer"] for e in answer.json()["errors"]], answer.body)
        self.assertEqual(self.service.get("/v1/operations/none").status, 404)

    def test_failed_study_says_why(self):
        operation = self.start({"kind": "work_precision", "scene": OSCILLATOR, "integrators": ["no_such"]})
        state = self.wait(operation)
        self.assertEqual(state["status"], "failed")
        self.assertEqual(state["error"]["errors"][0]["pointer"], "/integrators")
        self.assertEqual(self.service.get(operation + "/result").status, 422)

    def test_delete_forgets(self):
        operation = self.start(SLOW_SWEEP)
        self.assertEqual(self.service.request("DELETE", operation).status, 204)
        self.assertEqual(self.service.get(operation).status, 404)


class StudyCommand(unittest.TestCase):
    def run_study(self, *arguments):
        return subprocess.run([BINARY, "study", *arguments, "--progress", "none"], capture_output=True, text=True, timeout=patience(120))

    def test_writes_result_table_and_plot(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder, "scene.json")
            scene.write_text(json.dumps(OSCILLATOR))
            out = os.path.join(folder, "out")
            done = self.run_study("convergence", str(scene), "-o", out, "--set", "integrator=heun", "--set", "step=0.01", "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertAlmostEqual(json.loads(done.stdout)["summary"]["observed_order"], 2, delta=0.1)
            self.assertEqual(sorted(os.listdir(out)), ["request.json", "result.csv", "result.json", "result.svg"])

    def test_convergence_in_space(self):
        done = self.run_study("convergence", "wave_drum", "--refine", "space", "--set", "horizon=0.2", "--set", "budget=20", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        # Two standing waves at order 4 in space.
        self.assertAlmostEqual(json.loads(done.stdout)["summary"]["observed_order"], 4, delta=0.1)
        bad = self.run_study("convergence", "fountain", "--refine", "space")
        self.assertEqual(bad.returncode, 3)
        self.assertIn("wave (cells)", bad.stderr)

    def test_refuses_what_it_does_not_know(self):
        self.assertEqual(self.run_study("guess", "fountain").returncode, 2)
        bad = self.run_study("convergence", "fountain", "--set", "halvings=1")
        self.assertEqual(bad.returncode, 3)
        self.assertIn("/halvings", bad.stderr)


if __name__ == "__main__":
    unittest.main()
