"""A running scene is steered over HTTP and the stream: motors of joints and velocities of bodies, by row and by id, in the
plane and in space; and queries tell of every plane once."""
import json
import math
import pathlib
import random
import subprocess
import tempfile
import unittest

from cases import Case
from harness import BINARY, Socket
from patience import patience

BALL = {"rigid2d": {"shapes": [{"type": "circle", "radius": 0.2}]}, "rigid3d": {"type": "sphere", "radius": 0.2}}
AXIS = {"rigid2d": {}, "rigid3d": {"axis": [0, 0, 1]}}


def driven(kind, drive, count=2):
    """Bodies a, b ... without gravity, two metres apart, each hinged to the world with the drive."""
    bodies = [{"id": chr(97 + k), "position": [2 * k, 0, 0], "mass": 1, **BALL[kind]} for k in range(count)]
    joints = [{"id": "hinge_" + chr(97 + k), "type": "revolute", "a": -1, "b": k, **({} if drive.get("type") == "motor" else {"anchor": [2 * k, 0, 0]}), **({} if "type" in drive else AXIS[kind]), **drive}
              for k in range(count)]
    return {"gravity": [0, 0, 0], "time": {"dt": 0.01},
            "systems": [{"type": kind, "id": "w", "precision": "f64", "bodies": bodies, "joints": joints}]}


class Steering(Case):
    def command(self, session, status=202, **members):
        answer = self.service.post("/v1/sessions/%s/commands" % session, {"system": "w", **members})
        self.assertEqual(answer.status, status, answer.body)
        return answer.json()

    def set(self, session, name, status=202, **members):
        return self.command(session, status, type="set_parameter", name=name, **members)

    def fault(self, session, name, **members):
        return self.set(session, name, 422, **members)["errors"][0]

    def step(self, session, steps):
        self.assertEqual(self.service.post("/v1/sessions/%s/step" % session, {"steps": steps}).status, 200)

    def observed(self, session, name):
        values = self.service.get("/v1/sessions/%s/observables?names=w" % session).json()["latest"]
        return next(v["value"] if isinstance(v, dict) else v for k, v in values.items() if k == "w." + name)

    def test_a_motors_speed_and_strength_by_row_and_by_id(self):
        for kind in BALL:
            s = self.service.create(driven(kind, {"motor_speed": 1}))["id"]
            self.step(s, 100)
            self.set(s, "motor_speed", index=0, value=-2)
            self.set(s, "motor_speed", index="hinge_b", value=3)
            self.step(s, 100)
            self.assertAlmostEqual(self.observed(s, "joint.hinge_a.angle"), -1, delta=0.05)
            self.assertAlmostEqual(self.observed(s, "joint.hinge_b.angle"), 4, delta=0.05)
            # A motor without strength lets its body turn on.
            self.set(s, "max_motor", index="hinge_b", value=0)
            self.set(s, "motor_speed", index="hinge_b", value=-50)
            self.step(s, 100)
            self.assertAlmostEqual(self.observed(s, "joint.hinge_b.angle"), 7, delta=0.05)

    def test_a_motors_target(self):
        for kind in BALL:
            s = self.service.create(driven(kind, {"motor_target": 0.5}))["id"]
            self.step(s, 300)
            self.set(s, "motor_target", index="hinge_a", value=-1)
            self.step(s, 300)
            self.assertAlmostEqual(self.observed(s, "joint.hinge_a.angle"), -1, delta=1e-3)
            self.assertAlmostEqual(self.observed(s, "joint.hinge_b.angle"), 0.5, delta=1e-3)
            # A hinge turns about one axis.
            told = self.fault(s, "motor_target", index="hinge_b", vector=[0, 0, 2])
            self.assertEqual((told["pointer"], told["code"]), ("/vector", "wrong_type"))

    def test_a_bodys_velocity_by_row_and_by_id(self):
        for kind in BALL:
            scene = driven(kind, {})
            scene["systems"][0]["joints"] = []
            s = self.service.create(scene)["id"]
            self.set(s, "velocity", index="b", vector=[1, 2, 0])
            self.set(s, "velocity", index=0, vector=[-1, 0, 0])
            self.step(s, 100)
            frame = self.service.get("/v1/sessions/%s/frames/latest?fields=position" % s).json()
            text = json.dumps(frame)
            for value in (-1.0, 3.0, 2.0):
                self.assertTrue(any(abs(x - value) < 1e-6 for x in numbers(frame)), (value, text[:400]))
            self.set(s, "angular_velocity", index="a", **({"value": 4} if kind == "rigid2d" else {"vector": [0, 0, 4]}))

    def test_over_the_stream(self):
        for kind in BALL:
            s = self.service.create(driven(kind, {"motor_speed": 0}))["id"]
            stream = Socket(self.service, "/v1/sessions/%s/stream" % s, "truestep.v1.json")
            stream.send({"requestId": "1", "command": {"json": json.dumps(
                {"type": "set_parameter", "system": "w", "name": "motor_speed", "index": "hinge_a", "value": 1})}})
            stream.message("reply")
            stream.send({"requestId": "2", "command": {"json": json.dumps(
                {"type": "set_parameter", "system": "w", "name": "motor_speed", "index": "hinge_x", "value": 1})}})
            self.assertIn("hinge_a", json.dumps(stream.message("problem")))
            stream.close()
            self.step(s, 100)
            self.assertAlmostEqual(self.observed(s, "joint.hinge_a.angle"), 1, delta=0.05)

    def test_a_joint_with_several_motors(self):
        scene = driven("rigid3d", {})
        scene["systems"][0]["joints"] = [{"id": "c", "type": "cylindrical", "a": -1, "b": 0, "axis": [1, 0, 0],
                                          "slide": {"motor_speed": 0}, "turn": {"motor_speed": 0}}]
        s = self.service.create(scene)["id"]
        self.assertEqual(self.fault(s, "motor_speed", index="c", value=1)["code"], "ambiguous")
        self.set(s, "slide.motor_speed", index="c", value=1)
        self.step(s, 100)
        self.assertAlmostEqual(self.observed(s, "joint.c.position"), 1, delta=0.05)
        self.assertAlmostEqual(self.observed(s, "joint.c.angle"), 0, delta=1e-6)

    def at(self, session, kind, body=0):
        """Position and angle about z of a body."""
        at = self.service.get("/v1/sessions/%s/frames/latest?fields=position,%s" % (session, "angle" if kind == "rigid2d" else "orientation")).json()
        by_name = {block["field"]: block["values"] for block in at["blocks"]}
        flat = list(numbers(by_name["position"]))[3 * body:3 * body + 3]
        turn = list(numbers(by_name["angle" if kind == "rigid2d" else "orientation"]))
        return flat, turn[body] if kind == "rigid2d" else 2 * math.atan2(*sorted(turn[4 * body:4 * body + 4], key=abs)[-2:])

    def test_a_joint_of_type_motor(self):
        for kind in BALL:
            scene = driven(kind, {}, 1)
            scene["gravity"] = [0, -10, 0]
            scene["systems"][0]["joints"] = [{"id": "m", "type": "motor", "a": -1, "b": 0, "max_force": 100, "max_torque": 100}]
            scene["systems"][0]["id"] = "w"
            s = self.service.create(scene)["id"]
            vector = {"value": 1} if kind == "rigid2d" else {"vector": [0, 0, 1]}
            # 100 N carry 1 kg, 4 N do not, and without force it falls freely.
            self.set(s, "motor_target", index="m", vector=[0.5, 0, 0])
            self.set(s, "turn.motor_target", index="m", **vector)
            self.step(s, 200)
            place, turn = self.at(s, kind)
            self.assertAlmostEqual(place[0], 0.5, delta=0.01)
            self.assertAlmostEqual(place[1], 0, delta=0.02)
            self.assertAlmostEqual(abs(turn), 1, delta=0.01)
            self.set(s, "max_force", index="m", value=4)
            self.set(s, "max_torque", index="m", value=0)
            self.set(s, "turn.motor_target", index="m", **({"value": -1} if kind == "rigid2d" else {"vector": [0, 0, -1]}))
            self.step(s, 100)
            place, turn = self.at(s, kind)
            self.assertAlmostEqual(place[1], -(10 - 4) / 2, delta=0.1)
            self.assertAlmostEqual(abs(turn), 1, delta=0.02)
            self.set(s, "max_torque", index="m", value=100)
            self.step(s, 300)
            self.assertLess(self.at(s, kind)[1], 0)
            for name, members in (("max_motor", {"value": 1}), ("motor_speed", {"vector": [1, 0, 0]}),
                                  ("max_force", {"value": -1}), ("turn.max_force", {"value": 1})):
                self.fault(s, name, index="m", **members)

    def test_velocities_of_a_joint_of_type_motor(self):
        for kind in BALL:
            spin = {"angular_velocity": 0 if kind == "rigid2d" else [0, 0, 0]}
            scene = driven(kind, {}, 1)
            scene["systems"][0]["joints"] = [{"id": "m", "type": "motor", "a": -1, "b": 0, "velocity": [0, 0, 0], **spin}]
            s = self.service.create(scene)["id"]
            self.step(s, 100)
            self.set(s, "motor_speed", index="m", vector=[1, 2, 0])
            self.set(s, "turn.motor_speed", index="m", **({"value": 0.5} if kind == "rigid2d" else {"vector": [0, 0, 0.5]}))
            self.step(s, 100)
            place, turn = self.at(s, kind)
            for found, right in zip((*place, abs(turn)), (1, 2, 0, 0.5)):
                self.assertAlmostEqual(found, right, delta=0.03)

    def test_a_mouse(self):
        scene = driven("rigid2d", {}, 1)
        scene["systems"][0]["joints"] = [{"id": "m", "type": "mouse", "b": 0, "target": [0, 0, 0], "max_force": 50}]
        s = self.service.create(scene)["id"]
        self.set(s, "motor_target", index="m", vector=[1, 1, 0])
        self.step(s, 300)
        for found, right in zip(self.at(s, "rigid2d")[0], (1, 1, 0)):
            self.assertAlmostEqual(found, right, delta=0.01)
        self.set(s, "max_force", index="m", value=0)
        self.set(s, "motor_target", index="m", vector=[5, 1, 0])
        self.step(s, 300)
        self.assertAlmostEqual(self.at(s, "rigid2d")[0][0], 1, delta=0.02)
        self.fault(s, "max_torque", index="m", value=1)

    def test_refusals_name_what_would_do(self):
        for kind in BALL:
            s = self.service.create(driven(kind, {"motor_speed": 1}))["id"]
            before = self.hash(s)
            for name, members, pointer, words in (
                    ("motor_speed", {"index": "hinge_c", "value": 1}, "/index", "hinge_a, hinge_b"),
                    ("motor_speed", {"index": "a", "value": 1}, "/index", "hinge_a"),
                    ("motor_speed", {"value": 1}, "/index", "row or id of a joint"),
                    ("motor_speed", {"index": 2, "value": 1}, "/index", "0 to 1"),
                    ("motor_speed", {"index": 0}, "/value", "value"),
                    ("motor_target", {"index": 0, "value": 1}, "/index", "motor_target"),
                    ("velocity", {"index": "hinge_a", "vector": [1, 0, 0]}, "/index", "a, b"),
                    ("velocity", {"index": "a", "value": 1}, "/value", "vector"),
                    ("velocity", {"index": "a"}, "/vector", "vector"),
                    ("velocity", {"vector": [1, 0, 0]}, "/index", "row or id of a body"),
                    ("gravity", {"value": 1}, "/value", "vector"),
                    ("gravity", {"vector": [0, 0, 0], "index": 0}, "/index", "absent"),
                    ("max_motor", {"index": 0, "value": -1}, "/value", "at least 0")):
                fault = self.fault(s, name, **members)
                self.assertEqual(fault["pointer"], pointer, (name, members, fault))
                self.assertIn(words, json.dumps(fault))
            self.assertEqual(self.hash(s), before)

    def test_every_command_takes_a_bodys_id(self):
        for kind in BALL:
            scene = driven(kind, {})
            scene["systems"][0]["joints"] = []
            s = self.service.create(scene)["id"]
            self.command(s, type="impulse", index="a", impulse=[0, 1, 0])
            self.command(s, type="push", index="b", force=[1, 0, 0], duration=0.1)
            self.command(s, type="drag", index="b", target=[1, 0, 0])
            self.command(s, type="release", index="b")
            self.command(s, type="remove", index="b")
            self.step(s, 10)

    def test_spawn_takes_the_name_of_an_entry(self):
        scene = driven("rigid3d", {})
        scene["systems"][0] |= {"joints": [], "bodies": [{"id": "small", "type": "sphere", "radius": 0.1, "position": [0, 0, 0]},
                                                         {"id": "large", "type": "box", "position": [5, 0, 0]}]}
        s = self.service.create(scene)["id"]
        self.command(s, type="spawn", position=[0, 3, 0], name="small")
        self.command(s, 422, type="spawn", position=[0, 6, 0], name="smal")
        hits = self.service.post("/v1/sessions/%s/queries" % s, {"type": "ray", "origin": [0, 10, 0], "direction": [0, -1, 0]}).json()
        self.assertAlmostEqual(hits["hits"][0]["distance"], 6.9, delta=1e-6)
        # A row that came later has the same id, which then says too little.
        self.assertEqual(self.fault(s, "velocity", index="small", vector=[0, 0, 0])["code"], "ambiguous")
        self.command(s, type="remove", index=0)
        self.set(s, "velocity", index="small", vector=[0, 0, 0])
        other = self.service.create({"systems": [{"type": "particles", "id": "w", "positions": [[0, 0, 0]], "max_particles": 4}]})["id"]
        self.command(other, 422, type="spawn", position=[0, 0, 0], name="small")

    def test_what_is_set_is_replayed(self):
        """Sequences of commands by rows and ids: the same session made again, a seek and a bundle end in the same state."""
        for seed in range(12):
            random.seed(seed)
            kind = random.choice(list(BALL))
            s = self.service.create(driven(kind, {"motor_speed": 0.5}, 3))["id"]
            for _ in range(8):
                k = random.randrange(3)
                name = random.choice(("motor_speed", "max_motor", "velocity"))
                row = random.choice((k, ("" if name == "velocity" else "hinge_") + "abc"[k]))
                value = {"vector": [random.uniform(-1, 1), random.uniform(-1, 1), 0]} if name == "velocity" else \
                        {"value": random.uniform(0, 3)}
                self.set(s, name, index=row, **value)
                self.step(s, random.randrange(1, 20))
            now = self.hash(s)
            self.assertEqual(self.service.post("/v1/sessions/%s/seek" % s, {"step": 5}).status, 200)
            self.assertEqual(self.service.post("/v1/sessions/%s/seek" % s, {"step": now[0]}).status, 200)
            self.assertEqual(self.hash(s), now)
            with tempfile.TemporaryDirectory() as folder:
                path = pathlib.Path(folder) / "bundle"
                path.write_bytes(self.service.get("/v1/sessions/%s/bundle" % s).body)
                done = subprocess.run([BINARY, "replay", path, "--json"], capture_output=True, text=True, timeout=patience(60))
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def hash(self, session):
        a = self.service.get("/v1/sessions/%s" % session).json()
        return a["step"], a["state_hash"]

    def test_all_that_is_listed_can_be_set(self):
        """Every row of `truestep systems rigid2d` and `rigid3d`, over HTTP."""
        for kind in BALL:
            listed = json.loads(subprocess.run([BINARY, "systems", kind, "--json"], capture_output=True, text=True).stdout)["settable"]
            self.assertEqual({p["name"] for p in listed},
                             {"gravity", "velocity", "angular_velocity", "motor_speed", "motor_target", "max_motor", "max_force", "max_torque"})
            for p in listed:
                drive = {"motor_target": 0} if p["name"] == "motor_target" else {"motor_speed": 0}
                scene = driven(kind, {"type": "motor"} if p["name"] in ("max_force", "max_torque") else drive)
                s = self.service.create(scene)["id"]
                row = {"body": {"index": "a"}, "joint": {"index": "hinge_a"}, "system": {}}[p["of"]]
                self.set(s, p["name"], **row, **({"vector": [0, 1, 0]} if p["takes"] == "vector" else {"value": 1}))

    # --- what there is, once
    def test_queries_tell_of_a_plane_once(self):
        scene = {"systems": [{"type": "rigid3d", "id": "w", "bodies": [
            {"id": "ground", "type": "plane", "motion": "fixed"}, {"id": "ball", "type": "sphere", "radius": 0.5, "position": [9, 2, 0]}]}]}
        s = self.service.create(scene)["id"]
        for query, key in (({"type": "ray", "origin": [0, 5, 0], "direction": [0, -1, 0]}, "hits"),
                           ({"type": "nearest", "point": [0, 1, 0], "within": 3}, "hits"),
                           ({"type": "overlap", "center": [0, 0, 0], "radius": 1}, "items")):
            found = self.service.post("/v1/sessions/%s/queries" % s, query).json()[key]
            self.assertEqual([(f["system"], f.get("index")) for f in found], [("w", 0)], query)

    def test_queries_tell_of_a_collider_once_in_every_system(self):
        block = {"origin": [-0.5, 3, -0.5], "size": [1, 1, 1], "cells_x": 2, "cells_y": 2, "cells_z": 2}
        box = {"low": [-2, -1, -2], "high": [2, 4, 2]}
        rope = {"rope": {"from": [0, 3, 0], "to": [1, 3, 0], "links": 4}, "mass": 1}
        for kind, own in (("particles", {"positions": [[0, 3, 0]], "radius": 0.1}), ("mass_spring", rope), ("xpbd", rope),
                          ("fem", {"block": block, "youngs_modulus": 1e4, "density": 1000}),
                          ("sph", {**box, "spacing": 0.2, "bodies": [{"center": [0, 3, 0], "half_extents": [0.4, 0.4, 0.4]}]}),
                          ("mpm", {**box, "cell": 0.2, "bodies": [{"shape": "ball", "center": [0, 3, 0], "radius": 0.4}]}),
                          ("flocking", {"positions": [[0, 3, 0], [1, 3, 0]], "velocities": [[1, 0, 0], [1, 0, 0]]})):
            scene = {"time": {"dt": 0.001}, "systems": [{"type": kind, "id": "w", "colliders": [{"type": "plane", "normal": [0, 1, 0]}], **own}]}
            s = self.service.create(scene)["id"]
            for query, key in (({"type": "ray", "origin": [1.5, 1, 0], "direction": [0, -1, 0]}, "hits"),
                               ({"type": "nearest", "point": [1.5, 0.5, 0], "within": 0.8}, "hits"),
                               ({"type": "overlap", "center": [1.5, 0, 0], "radius": 0.5}, "items")):
                found = self.service.post("/v1/sessions/%s/queries" % s, query).json()[key]
                self.assertEqual([f["part"] for f in found], ["plane0"], (kind, query))

    def test_no_body_is_spawned_in_the_plane(self):
        s = self.service.create(driven("rigid2d", {}))["id"]
        for name in ({}, {"name": "a"}):
            told = self.command(s, 422, type="spawn", position=[0, 3, 0], **name)["errors"][0]
            self.assertEqual((told["pointer"], told["code"]), ("/type", "unsupported_command"))
            self.assertNotIn("spawn", told["allowed"].split(", "))

    def test_the_refusal_of_accuracy_says_which_types_take_it(self):
        answer = self.service.post("/v1/scenes/validate", {**driven("rigid3d", {}), "accuracy": {"tolerance": 1e-4}}).json()
        fault = next(f for f in answer["errors"] if f["pointer"] == "/accuracy/system")
        for word in ("oscillator", "ode", "mass_spring"):
            self.assertIn(word, fault["message"])
        self.assertNotIn("rigid3d", fault["message"])


def numbers(value):
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return [x for v in value for x in numbers(v)]
    return [value] if isinstance(value, (int, float)) and not isinstance(value, bool) else []


if __name__ == "__main__":
    unittest.main()
