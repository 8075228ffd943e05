"""The stream of a session as a WebSocket client sees it."""
import base64
import json
import struct
import time
import unittest

from cases import OSCILLATOR, Case
from harness import Socket


def differences(data, values):
    """Adds a Q16_DELTA block's packed differences to `values` (the layout is in stream.proto)."""
    groups = (len(values) + 255) // 256
    at = (groups + 3) // 4 * 4
    for group in range(groups):
        bits, first = data[group], 256 * group
        count = min(256, len(values) - first)
        size = 32 * ((bits * ((count + 15) // 16) + 15) // 16)
        words = struct.unpack_from("<%dH" % (size // 2), data, at)
        for lane in range(16):
            string = sum(word << 16 * n for n, word in enumerate(words[lane::16]))
            for entry, k in enumerate(range(first + lane, first + count, 16)):
                z = string >> bits * entry & (1 << bits) - 1
                values[k] = values[k] + (~(z >> 1) if z & 1 else z >> 1) & 0xFFFF
        at += size


class Stream(Case):
    def socket(self, *arguments):
        ws = Socket(self.service, *arguments)
        self.addCleanup(ws.close)
        return ws

    def open(self, scene=OSCILLATOR):
        self.session = self.service.create(scene)
        return self.socket(self.session["links"]["stream"], "truestep.v1.json")

    def test_hello_topology_playback_frame(self):
        ws = self.open()
        self.assertEqual(ws.status, 101)
        hello = ws.message("hello")
        self.assertEqual((hello["session"], hello["systems"][0]["id"]), (self.session["id"], "a"))
        self.assertEqual(ws.message("topology")["systems"][0]["system"], "a")
        self.assertFalse(ws.message("playback")["playing"])
        frame = ws.message("frame")
        self.assertEqual((frame["step"], frame["state_hash"]), ("0", "0"), "the hash of a state is for those who ask")

    def test_a_grid_is_a_part_with_its_lattice_and_streams_unasked(self):
        ws = self.open({"time": {"dt": 1e-4}, "systems": [{"type": "heat", "id": "plate", "cells": [4, 2], "initial": "x + 10*y"}]})
        (part,) = ws.message("hello")["parts"]
        self.assertEqual((part["id"], part["system"], part["kind"]), ("plate", "plate", "grid"))
        self.assertEqual(part["lattice"]["counts"], [5, 3, 1])
        self.assertEqual([f["name"] for f in part["fields"]], ["value"])
        (block,) = ws.message("frame")["blocks"]
        self.assertEqual((block["system"], block["field"], block["count"]), ("plate", "value", 15))
        values = struct.unpack("<15f", base64.b64decode(block["data"]))
        self.assertAlmostEqual(values[5 * 2 + 1], 0.25 + 10, 5)

    def test_parts_beside_the_main_one_are_asked_for_by_their_names(self):
        rope = {"type": "mass_spring", "id": "r", "rope": {"from": [0, 0, 0], "to": [1, 0, 0], "links": 3}}
        ws = self.open({"systems": [rope]})
        self.assertEqual([p["id"] for p in ws.message("hello")["parts"]], ["r", "r.springs"])
        self.assertEqual([b["system"] for b in ws.message("frame")["blocks"]], ["r"])
        ws.send({"request_id": "s", "subscribe": {"systems": ["r.springs"], "fields": ["strain"]}})
        frame = ws.message("frame")
        self.assertEqual([(b["system"], b["count"]) for b in frame["blocks"]], [("r.springs", 3)])
        ws.send({"request_id": "bad", "subscribe": {"systems": ["r.skin"]}})
        self.assertEqual(ws.message("problem")["code"], "unknown_system")

    def test_credit_bounds_the_frames_in_flight_and_gaps_are_counted(self):
        ws = self.open()
        ws.send({"request_id": "s", "subscribe": {"credit": 2, "encoding": "F64", "state_hash": True}})
        ws.message("reply")
        self.service.post(self.session["links"]["step"], {"steps": 50})
        time.sleep(0.2)
        ws.send({"credit": {"frames": 1}})
        last = ws.message("frame")
        while int(last["step"]) < 50:
            last = ws.message("frame")
        # One frame answered the subscription, one step used the second credit, the new credit brought the newest.
        self.assertGreaterEqual(int(last["dropped"]), 48)
        self.assertEqual(last["state_hash"], str(int(self.service.get(self.session["links"]["self"]).json()["state_hash"], 16)))

    def test_every_policy_leaves_no_gap(self):
        ws = self.open()
        ws.send({"request_id": "s", "subscribe": {"policy": "EVERY"}})
        ws.message("reply")
        self.service.post(self.session["links"]["step"], {"steps": 300})
        self.assertEqual([int(ws.message("frame")["step"]) for _ in range(300)], list(range(1, 301)))

    def test_differences_decode_to_the_positions_within_half_a_quantum(self):
        grain = {"arrangement": "random", "count": 300, "half_extents": [1, 1, 1], "speed_spread": 1}
        ws = self.open({"time": {"dt": 0.01}, "systems": [{"type": "particles", "id": "a", "fill": [grain]}]})
        self.assertIn("Q16_DELTA", ws.message("hello")["capabilities"])
        exact = self.socket(self.session["links"]["stream"], "truestep.v1.json")
        for client, encoding in ((ws, "Q16_DELTA"), (exact, "F32")):
            client.send({"subscribe": {"policy": "EVERY", "encoding": encoding}})
            while client.message("frame")["seq"] != "2":  # the first one came before the subscription
                pass
        ws.send({"request_keyframe": {}})
        self.assertTrue(ws.message("frame")["keyframe"])
        ws.send({"request_keyframe": {}})
        frame, small = ws.message("frame"), 0
        held = list(struct.unpack("<900H", base64.b64decode(frame["blocks"][0]["data"])))
        self.service.post(self.session["links"]["step"], {"steps": 60})
        for _ in range(60):
            base, frame, truth = frame["seq"], ws.message("frame"), exact.message("frame")
            self.assertEqual(frame["step"], truth["step"])
            block, data = frame["blocks"][0], base64.b64decode(frame["blocks"][0]["data"])
            if frame["keyframe"]:
                held = list(struct.unpack("<900H", data))
            else:
                self.assertEqual((frame["base_seq"], block["encoding"]), (base, "Q16_DELTA"))
                differences(data, held)
                small += len(data) < 0.8 * 1800
            floats = struct.unpack("<900f", base64.b64decode(truth["blocks"][0]["data"]))
            worst = max(abs(block["offset"][k % 3] + block["scale"][k % 3] * held[k] - x) / block["scale"][k % 3] for k, x in enumerate(floats))
            self.assertLess(worst, 0.5001)  # of a quantum; doubles here, 1e-4 is far above what they round
        self.assertGreater(small, 40)

    def test_commands_and_control_over_the_stream(self):
        ws = self.open()
        ws.send({"request_id": "c", "command": {"json": json.dumps({"type": "impulse", "system": "a", "index": 0, "impulse": [1, 0, 0]})}})
        self.assertEqual(ws.message("reply")["request_id"], "c")
        ws.send({"request_id": "x", "command": {"json": "{}"}})
        self.assertEqual(ws.message("problem")["code"], "bad_command")
        ws.send({"request_id": "p", "control": {"action": "play", "value": 2}})
        while not ws.message("playback")["playing"]:
            pass
        ws.send({"request_id": "q", "control": {"action": "pause"}})
        while ws.message("playback")["playing"]:
            pass

    def test_unknown_subprotocols_and_foreign_origins_are_refused(self):
        s = self.service.create(OSCILLATOR)
        self.assertEqual(self.socket(s["links"]["stream"], "chat").status, 400)
        self.assertEqual(self.socket(s["links"]["stream"], None, ["Origin: http://evil.example"]).status, 403)
        self.assertEqual(self.socket("/v1/sessions/nobody/stream").status, 404)


if __name__ == "__main__":
    unittest.main()
