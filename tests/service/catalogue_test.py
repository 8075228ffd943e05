"""What the service says about itself, and how it refuses what it cannot take."""
import subprocess
import unittest

from cases import OSCILLATOR, Case
from harness import BINARY


class Catalogue(Case):
    def test_every_system_is_described(self):
        systems = self.service.get("/v1/systems").json()["systems"]
        self.assertGreaterEqual(len(systems), 4)
        for s in systems:
            d = self.service.get("/v1/systems/" + s["type"]).json()
            self.assertTrue(d["parameters"] and d["guarantees"])
            self.assertTrue(d["rows"] and d["fields"] and d["observables"])

    def test_every_gallery_scene_is_valid_and_says_what_it_teaches(self):
        scenes = self.service.get("/v1/gallery").json()["scenes"]
        self.assertGreaterEqual(len(scenes), 10)
        for entry in scenes:
            scene = self.service.get("/v1/gallery/" + entry["name"]).json()
            self.assertTrue(scene["teaches"] and scene["expect"], entry["name"])
            self.assertTrue(all(e.get("source") for e in scene["expect"]), entry["name"])
            report = self.service.post("/v1/scenes/validate", scene["scene"])
            self.assertEqual((report.status, report.json()["errors"]), (200, []), entry["name"])

    def test_all_faults_of_a_scene_at_once(self):
        bad = {"time": {"dt": -1}, "gravty": [0, 0, 0], "systems": [{"type": "oscilator"}, {"type": "oscillator", "mass": "5 cm", "stiffness": "1 kN/m"}]}
        answer = self.service.post("/v1/sessions", bad)
        self.assertEqual((answer.status, answer.headers["Content-Type"]), (422, "application/problem+json"))
        errors = {e["pointer"]: e for e in answer.json()["errors"]}
        self.assertEqual(set(errors), {"/time/dt", "/gravty", "/systems/0/type", "/systems/1/mass"})
        self.assertEqual(errors["/gravty"]["did_you_mean"], "gravity")
        self.assertEqual(errors["/systems/0/type"]["did_you_mean"], "oscillator")
        self.assertEqual(errors["/systems/1/mass"]["unit"], "kg")

    def test_unknown_keys_hide_no_names_that_nobody_knows(self):
        bad = {"gravty": [0, 0, 0], "systems": [{"type": "oscillator", "id": "a"}], "observables": ["enrgy"], "expect": [{"quantity": "a.energi.total", "min": 0}],
               "probes": [{"id": "p", "system": "a", "fields": ["postion"]}, {"id": "p", "system": "a", "index": 1}]}
        answer = self.service.post("/v1/sessions", bad)
        self.assertEqual(answer.status, 422)
        errors = {e["pointer"]: e for e in answer.json()["errors"]}
        self.assertEqual(set(errors), {"/gravty", "/observables/0", "/expect/0/quantity", "/probes/0/fields/0", "/probes/1/id", "/probes/1/index"})
        self.assertEqual(errors["/observables/0"]["did_you_mean"], "energy")
        self.assertEqual(errors["/probes/0/fields/0"]["did_you_mean"], "position")

    def test_units_are_echoed_in_si(self):
        scene = {"systems": [{"type": "oscillator", "id": "a", "mass": "250 g", "stiffness": "1 kN/m", "position": "5 cm"}]}
        echoed = self.service.post("/v1/scenes/validate", scene).json()["scene"]["systems"][0]
        self.assertEqual((echoed["mass"], echoed["stiffness"], echoed["position"]), (0.25, 1000.0, 0.05))

    def test_descriptions(self):
        api = self.service.get("/openapi.json").json()
        self.assertEqual(api["openapi"], "3.1.0")
        for path in ("/v1/sessions", "/v1/sessions/{id}/step", "/v1/sessions/{id}/stream", "/v1/gallery"):
            self.assertIn(path, api["paths"])
        schema = self.service.get("/v1/schemas/scene-1.json").json()
        self.assertEqual(schema["$schema"], "https://json-schema.org/draft/2020-12/schema")
        self.assertIn(b"/v1/sessions", self.service.get("/docs").body)
        self.assertIn(b"<html", self.service.get("/").body.lower())

    def test_health_and_metrics(self):
        self.assertEqual(self.service.get("/healthz").status, 200)
        self.assertEqual(self.service.get("/readyz").status, 200)
        self.assertIn("version", self.service.get("/version").json())
        self.assertIn(b"truestep_sessions ", self.service.get("/metrics").body)
        self.assertEqual(subprocess.run([BINARY, "health", self.service.url], capture_output=True).returncode, 0)

    def test_bad_requests(self):
        s = self.service.create(OSCILLATOR)
        for path, body, status in (("/step", {"steps": -1}, 400), ("/step", {"stepz": 1}, 400), ("/step", {"steps": 1, "seconds": 1}, 400),
                                   ("/play", {"speed": 0}, 400), ("/seek", {}, 400), ("/commands", {"type": "kick"}, 422),
                                   ("/commands", {"type": "impulse", "system": "a", "index": 7, "impulse": [0, 0, 0]}, 422),
                                   ("/commands", {"type": "impulse", "system": "b", "index": 0, "impulse": [0, 0, 0]}, 422)):
            answer = self.service.post(s["links"]["self"] + path, body)
            self.assertEqual(answer.status, status, (path, body, answer.body))
            self.assertEqual(answer.headers["Content-Type"], "application/problem+json")
        self.assertEqual(self.service.request("POST", "/v1/sessions", "x", {"Content-Type": "text/plain"}).status, 415)
        self.assertEqual(self.service.request("PATCH", "/v1/sessions").status, 405)
        self.assertEqual(self.service.get("/nothing").status, 404)


if __name__ == "__main__":
    unittest.main()
