"""What `truestep validate` says of a scene is what `truestep run` does with it: examples of the catalogue with some of their members
changed at random, from the schema, to values of the right kind."""
import json
import random
import subprocess
import unittest

from harness import BINARY
from patience import patience

SCENES = 60
NUMBERS = (0, -1, 1e-6, 1e-3, 0.5, 1, 2, 10, 1e3, 1e6)
WORDS = ("a", "x", "1", "sin(t)", "x*y", "first")


def program(*arguments, text=None):
    return subprocess.run([BINARY, *arguments], input=text, capture_output=True, text=True, timeout=patience(60))


def within(form, v):
    return (form.get("minimum", v) <= v <= form.get("maximum", v) and not v <= form.get("exclusiveMinimum", v - 1)
            and not v >= form.get("exclusiveMaximum", v + 1))


def draw(form, r, depth=0):
    for several in ("anyOf", "oneOf"):
        if several in form:
            return draw(r.choice(form[several]), r, depth)
    if "const" in form or "enum" in form:
        return r.choice(form.get("enum", [form.get("const")]))
    kind = form.get("type")
    if kind in ("number", "integer"):
        v = r.choice([v for v in NUMBERS if within(form, v)] or [1])
        return v if kind == "number" else min(int(v), 50)
    if kind == "array":
        fewest = form.get("minItems", 0)
        return [draw(form.get("items", {}), r, depth + 1) for _ in range(r.randint(fewest, max(fewest, min(form.get("maxItems", 3), 3))))]
    if kind == "string":
        return r.choice(WORDS)
    if kind == "boolean":
        return r.random() < 0.5
    members = form.get("properties", {}) if depth < 4 else {}
    return {k: draw(m, r, depth + 1) for k, m in members.items() if k in form.get("required", []) or r.random() < 0.25}


def forms(schema, part):
    return {(k := row["properties"]["type"]).get("const") or k["enum"][0]: row for row in schema["properties"][part]["items"]["oneOf"]}


class Alike(unittest.TestCase):
    def altered(self, example, tables, r):
        scene = json.loads(json.dumps(example))
        for _ in range(r.choice((1, 1, 2, 3))):
            part = r.choice(scene["systems"] + 2 * scene.get("couplings", []))
            members = tables[part["type"]]["properties"]
            member = r.choice([k for k in members if k not in ("type", "id", "a", "b")])
            part[member] = draw(members[member], r)
        scene["time"]["duration"] = 2 * scene["time"]["dt"]
        return scene

    def test_what_is_valid_runs_and_what_is_not_does_not(self):
        schema = json.loads(program("schema").stdout)
        tables = {**forms(schema, "systems"), **forms(schema, "couplings")}
        examples = [json.loads(program("systems", name, "--example").stdout) for name in sorted(tables)]
        refused = 0
        for seed in range(SCENES):
            r = random.Random(seed)
            text = json.dumps(self.altered(r.choice(examples), tables, r))
            said, done = program("validate", "-", text=text).returncode, program("run", "-", text=text).returncode
            self.assertEqual(said, 3 if done == 3 else 0, (seed, done, text))
            refused += said == 3
        self.assertTrue(10 < refused < SCENES - 10, refused)

    def test_steps_much_shorter_than_the_grid_allows_are_valid(self):
        body = {"material": "corotated", "shape": "box", "center": [0.5, 0.5, 0], "half_extents": [0.2, 0.2, 0.1]}
        for dt in (1e-6, 1e-5, 1e-3, 1 / 60):
            scene = json.dumps({"time": {"dt": dt, "duration": 5 * dt}, "systems": [{"type": "mpm", "id": "m", "cell": 0.05, "bodies": [body]}]})
            for command in ("validate", "run"):
                done = program(command, "-", text=scene)
                self.assertEqual(done.returncode, 0, (command, dt, done.stdout[-300:]))


if __name__ == "__main__":
    unittest.main()
