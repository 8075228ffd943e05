"""One request acts, steps and looks: POST step with commands before and observables, fields and queries after, over HTTP as
JSON and protobuf and over both forms of the stream; arrays of commands and of queries."""
import json
import struct
import unittest

from cases import Case
from harness import Socket

FLOOR = {"type": "plane", "motion": "fixed"}
BALLS = [{"type": "sphere", "id": name, "radius": 0.1, "position": [x, 1, 0]} for x, name in enumerate(("a", "b", "c"))]
SCENE = {"time": {"dt": 0.01}, "systems": [{"type": "rigid3d", "id": "w", "precision": "f64", "bodies": [FLOOR, *BALLS]}]}
PUSH = {"type": "impulse", "system": "w", "index": 1, "impulse": [0.5, 0, 0]}
DOWN = {"type": "ray", "origin": [0, 5, 0], "direction": [0, -1, 0], "limit": 1}


def fields_of(message):
    """{number: [values]} of the bytes of a protobuf message."""
    out, at = {}, 0

    def varint():
        nonlocal at
        value = shift = 0
        while True:
            byte = message[at]
            at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value
    while at < len(message):
        tag = varint()
        if tag & 7 == 2:
            size = varint()
            value, at = message[at:at + size], at + size
        elif tag & 7 == 1:
            value, at = message[at:at + 8], at + 8
        else:
            value = varint()
        out.setdefault(tag >> 3, []).append(value)
    return out


def field(number, payload):
    assert len(payload) < 1 << 14
    size = bytes([len(payload)]) if len(payload) < 128 else bytes([len(payload) & 127 | 128, len(payload) >> 7])
    return bytes([number << 3 | 2]) + size + payload


class RoundTrip(Case):
    def setUp(self):
        self.url = self.service.create(SCENE)["links"]["self"]

    def step(self, body, status=200, **headers):
        answer = self.service.post(self.url + "/step", body, **headers)
        self.assertEqual(answer.status, status, answer.body)
        return answer

    def get(self, path):
        return self.service.get(self.url + path).json()

    def test_it_is_what_the_requests_one_by_one_give(self):
        other = self.service.create(SCENE)["links"]["self"]
        for command in (PUSH, {**PUSH, "index": "b"}):
            self.service.post(other + "/commands", command)
        self.service.post(other + "/step", {"steps": 20})
        wanted = {"observables": self.service.get(other + "/observables").json()["latest"],
                  "frame": self.service.get(other + "/frames/latest?fields=position,velocity").json(),
                  "queries": [self.service.post(other + "/queries", q).json() for q in (DOWN, {"type": "contacts"})]}
        got = self.step({"commands": [PUSH, {**PUSH, "index": "b"}], "steps": 20, "observe": [], "fields": ["position", "velocity"],
                         "queries": [DOWN, {"type": "contacts"}]}).json()
        self.assertEqual(got["step"], 20)
        self.assertEqual(len(got["commands"]), 2)
        self.assertEqual(got["state_hash"], wanted["frame"]["state_hash"])
        for part, value in wanted.items():
            self.assertEqual(got[part], value, part)
        self.assertGreater(got["frame"]["blocks"][0]["values"][1][0], 0.01, "the push had an effect")
        # Nothing that was not asked for is in the answer.
        self.assertEqual(set(self.step({}).json()), {"id", "step", "time", "status", "speed", "state_hash"})

    def test_names_choose(self):
        got = self.step({"observe": ["w.energy"], "fields": [], "systems": ["w"]}).json()
        self.assertTrue(got["observables"])
        self.assertTrue(all(name.startswith("w.energy") for name in got["observables"]), got["observables"])
        self.assertEqual([b["field"] for b in got["frame"]["blocks"]], ["position"])
        self.assertEqual(self.step({"steps": 0, "queries": []}).json()["queries"], [])

    def test_what_is_wrong_anywhere_changes_nothing(self):
        before = self.get("")["state_hash"]
        for body, pointer in (
                ({"commands": [PUSH, {"type": "impulse", "system": "w", "index": "nobody", "impulse": [1, 0, 0]}]}, "/commands/1/index"),
                ({"commands": [PUSH, {"type": "fly"}]}, "/commands/1/type"),
                ({"commands": [PUSH, {**PUSH, "index": 99}]}, "/commands/1/index"),
                ({"commands": [PUSH], "observe": ["w.height"]}, "/observe/0"), ({"commands": [PUSH], "fields": [], "systems": ["x"]}, "/system"),
                ({"commands": [PUSH], "fields": ["speed"]}, "/fields/0"),
                ({"commands": [PUSH], "queries": [DOWN, {"type": "ray"}]}, "/queries/1/origin"),
                ({"commands": [PUSH], "queries": [{**DOWN, "systems": ["x"]}]}, "/queries/0/systems/0"),
                ({"commands": [PUSH], "systems": ["w"]}, "/systems"),
                ({"commands": PUSH}, "/commands"), ({"observe": "w"}, "/observe"), ({"observe": [1]}, "/observe/0"),
                ({"queries": DOWN}, "/queries"), ({"command": [PUSH]}, "/command"), ({"commands": [PUSH] * 1001}, "/commands"),
                ({"commands": [PUSH], "from_step": 3}, "/from_step")):
            answer = self.service.post(self.url + "/step", body)
            self.assertIn(answer.status, (400, 409, 413, 422), (body, answer.body))
            if answer.status != 413:  # too long a body
                self.assertEqual(answer.json()["errors"][0]["pointer"], pointer, answer.body)
            self.assertEqual(self.get("")["state_hash"], before, body)
            self.assertEqual(self.get("")["step"], 0)

    def test_a_command_may_name_what_the_one_before_made(self):
        spawn = {"type": "spawn", "system": "w", "name": "a", "position": [5, 1, 0]}
        answer = self.service.post(self.url + "/commands", [spawn, {**PUSH, "index": 4}])
        self.assertEqual(answer.status, 202, answer.body)
        self.assertEqual([a["step"] for a in answer.json()], [0, 0])
        got = self.step({"steps": 10, "fields": ["velocity"]}).json()
        self.assertGreater(got["frame"]["blocks"][0]["values"][4][0], 0.01)
        # All or none: the second has no such body.
        before = self.get("")["state_hash"]
        answer = self.service.post(self.url + "/commands", [spawn, {**PUSH, "index": 40}])
        self.assertEqual((answer.status, answer.json()["errors"][0]["pointer"]), (422, "/1/index"), answer.body)
        self.assertEqual(self.get("")["state_hash"], before)
        # One alone is placed as well; a thousand and one are too many.
        for commands, pointer in (([{**PUSH, "index": 40}], "/0/index"), ([PUSH] * 1001, "")):
            answer = self.service.post(self.url + "/commands", commands)
            self.assertEqual((answer.status, answer.json()["errors"][0]["pointer"]), (422, pointer), answer.body)
            self.assertEqual(self.get("")["state_hash"], before)

    def test_arrays_of_queries(self):
        answer = self.service.post(self.url + "/queries", [DOWN, {**DOWN, "origin": [1, 5, 0]}])
        self.assertEqual([a["hits"][0]["index"] for a in answer.json()], [1, 2], answer.body)
        answer = self.service.post(self.url + "/queries", [DOWN, {}])
        self.assertEqual((answer.status, answer.json()["errors"][0]["pointer"]), (422, "/1/type"), answer.body)

    def test_protobuf(self):
        answer = self.step({"steps": 3, "observe": [], "fields": ["position"]}, headers={"Accept": "application/x-protobuf"})
        message = fields_of(answer.body)
        told = json.loads(message[2][0])
        self.assertEqual(told["step"], 3)
        self.assertNotIn("frame", told)
        self.assertTrue(told["observables"])
        frame = fields_of(message[3][0])
        self.assertEqual(frame[2], [3])
        block = fields_of(frame[9][0])
        self.assertEqual((block[1], block[2]), ([b"w"], [b"position"]))
        positions = struct.unpack("<%df" % (len(block[8][0]) // 4), block[8][0])
        self.assertAlmostEqual(positions[3 * 2], 1, delta=1e-6)

    def test_a_repeated_request_is_carried_out_once(self):
        headers = {"Accept": "application/x-protobuf", "Idempotency-Key": "again"}
        body = {"commands": [PUSH], "fields": ["position"]}
        first, second = (self.step(body, headers=headers) for _ in range(2))
        self.assertEqual(first.body, second.body)
        self.assertEqual(second.headers["content-type"], "application/x-protobuf")
        self.assertEqual(self.get("")["step"], 1)

    def test_a_run_that_fails_says_so(self):
        scene = {"time": {"dt": 0.5}, "systems": [{"type": "oscillator", "id": "a", "stiffness": 1e6, "position": 1,
                                                    "integrator": "euler"}]}
        self.url = self.service.create(scene)["links"]["self"]
        answer = self.service.post(self.url + "/step", {"steps": 1000, "observe": []})
        self.assertEqual((answer.status, answer.json()["code"]), (409, "instability"), answer.body)

    def test_over_the_stream_as_json(self):
        socket = Socket(self.service, self.url + "/stream", "truestep.v1.json")
        body = {"commands": [PUSH], "steps": 4, "observe": ["w.energy"], "fields": ["velocity"], "queries": [DOWN]}
        socket.send({"request_id": "one", "step": {"json": json.dumps(body)}})
        answer = socket.message("answer")
        told = json.loads(answer["json"])
        self.assertEqual((answer["request_id"], told["step"]), ("one", 4))
        self.assertEqual(told["frame"], self.get("/frames/latest?fields=velocity"))
        self.assertEqual(told["queries"][0]["hits"][0]["index"], 1)
        socket.send({"request_id": "two", "step": {"json": json.dumps({"commands": [PUSH, {}]})}})
        problem = socket.message("problem")
        self.assertEqual((problem["request_id"], problem["pointer"]), ("two", "/commands/1/type"), problem)
        self.assertEqual(self.get("")["step"], 4)
        for wrong in ("[]", "{", "3"):
            socket.send({"request_id": wrong, "step": {"json": wrong}})
            self.assertEqual(socket.message("problem")["request_id"], wrong)
        socket.send({"request_id": "three", "command": {"json": json.dumps([PUSH, {**PUSH, "index": 2}])}})
        self.assertEqual(socket.message("reply")["request_id"], "three")
        socket.close()

    def test_over_the_stream_as_protobuf(self):
        socket = Socket(self.service, self.url + "/stream", "truestep.v1.proto")
        step = field(1, json.dumps({"steps": 2, "fields": ["position"]}).encode())
        socket._frame(2, field(1, b"one") + field(7, step))
        while True:
            message = fields_of(socket.receive()[1])
            if 12 in message:
                break
        answer = fields_of(message[12][0])
        told = json.loads(answer[2][0])
        self.assertEqual((answer[1], told["step"], told["state_hash"]), ([b"one"], 2, self.get("")["state_hash"]))
        self.assertEqual(fields_of(answer[3][0])[2], [2])
        socket.close()


if __name__ == "__main__":
    unittest.main()
