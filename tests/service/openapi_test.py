"""The running service against its own description: every answer is described, and Schemathesis finds nothing."""
import os
import pathlib
import re
import subprocess
import unittest

from cases import OSCILLATOR, Case
from harness import SOURCE
from patience import patience

HERE = pathlib.Path(__file__).resolve().parent
TOOL = SOURCE / "build" / "venv" / "bin" / "st"
SECONDS = 45


class Description(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.document = cls.service.get("/openapi.json").json()

    def operations(self):
        for path, methods in self.document["paths"].items():
            for method, operation in methods.items():
                yield "%s %s" % (method, path), operation

    def resolve(self, schema):
        while schema.get("$ref", "").startswith("#/"):
            node = self.document
            for part in schema["$ref"][2:].split("/"):
                node = node[part]
            schema = node
        return schema

    def test_every_operation_names_its_successes_and_the_problem(self):
        ids = [o["operationId"] for _, o in self.operations()]
        self.assertEqual(len(ids), len(set(ids)))
        for name, operation in self.operations():
            statuses = set(operation["responses"])
            self.assertTrue(any(s[0] in "12" for s in statuses), name)
            self.assertNotIn("2XX", statuses, name)
            self.assertIn("application/problem+json", operation["responses"]["default"]["content"], name)
            for status, answer in operation["responses"].items():
                json_answer = answer.get("content", {}).get("application/json")
                if json_answer is not None:
                    self.assertTrue(self.resolve(json_answer["schema"]).get("type"), (name, status))

    def test_get_and_delete_take_no_body_and_every_parameter_is_bounded(self):
        for name, operation in self.operations():
            if name.startswith(("get ", "delete ")):
                self.assertNotIn("requestBody", operation, name)
            for parameter in operation.get("parameters", []):
                schema = self.resolve(parameter["schema"])
                if schema.get("type") in ("integer", "number"):
                    self.assertTrue("minimum" in schema and "maximum" in schema, (name, parameter["name"]))
                if parameter["name"] == "id":
                    self.assertIn("pattern", schema)
        for path in ("/v1/sessions", "/v1/sessions/{id}/step"):
            names = [p["name"] for p in self.document["paths"][path]["post"]["parameters"]]
            self.assertIn("Idempotency-Key", names)

    def test_the_stream_says_how_long_a_message_may_be(self):
        said = self.document["paths"]["/v1/sessions/{id}/stream"]["get"]["description"]
        self.assertIn("1048576 bytes", said)


class Schemathesis(Case):
    # What a random scene asks for is refused early instead of filling the machine.
    options = ("--max-memory", "200", "--max-sessions", "300")

    def test_nothing_is_found(self):
        if not TOOL.exists():
            self.skipTest("Schemathesis is not installed: ./truestep test does that")
        session = self.service.create({"gallery": "rope_catenary"})["id"]
        study = self.service.post("/v1/studies", {"kind": "convergence", "scene": {**OSCILLATOR, "time": {"dt": 0.05, "duration": 1}}})
        environment = {**os.environ, "SCHEMATHESIS_HOOKS": "schemathesis_hooks", "PYTHONPATH": str(HERE),
                       "TRUESTEP_SESSION": session, "TRUESTEP_OPERATION": study.json()["id"]}
        done = subprocess.run([TOOL, "--config-file", HERE / "schemathesis.toml", "run", self.service.url + "/openapi.json",
                               "--max-time", str(SECONDS), "--request-timeout", str(patience(5))],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment, cwd=self.service.data,
                              timeout=patience(3 * SECONDS))
        self.assertEqual(done.returncode, 0, done.stdout[-6000:])
        generated = int(re.search(r"(\d+) generated, \1 passed", done.stdout)[1])
        # In the time given; fewer where the machine is slow.
        self.assertGreater(generated, 300 * 4 / patience(1))


if __name__ == "__main__":
    unittest.main()
