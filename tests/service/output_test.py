"""What comes out of a session over HTTP: frames, observables, the plan, pictures, recordings."""
import json
import math
import struct
import time
import unittest

from cases import OSCILLATOR, Case


class Output(Case):
    def test_poll_and_long_poll(self):
        s = self.service.create(OSCILLATOR)
        frames = s["links"]["frames"]
        self.assertEqual(self.service.get(frames).json()["last_step"], 0)
        self.assertEqual(self.service.get(frames + "?after=0").status, 204)
        self.service.post(s["links"]["step"], {"steps": 10})
        page = self.service.get(frames + "?after=0&limit=100").json()
        self.assertEqual([f["step"] for f in page["frames"]], list(range(1, 11)))
        start = time.monotonic()
        self.assertEqual(self.service.get(frames + "?after=10&wait=0.3").status, 204)
        self.assertGreaterEqual(time.monotonic() - start, 0.3)
        self.service.post(s["links"]["play"])
        self.assertGreater(self.service.get(frames + "?after=10&wait=20").json()["last_step"], 10)

    def test_frames_nobody_asked_for_are_not_built(self):
        s = self.service.create(OSCILLATOR)
        self.service.post(s["links"]["step"], {"steps": 100})
        self.assertEqual(self.service.get(s["links"]["self"]).json()["frames_built"], 0)

    def test_protobuf_frame(self):
        s = self.service.create(OSCILLATOR)
        answer = self.service.get(s["links"]["latest_frame"], {"Accept": "application/x-protobuf"})
        self.assertEqual(answer.headers["Content-Type"], "application/x-protobuf")
        # The position 1 as little-endian float lies in the block's bytes.
        self.assertIn(struct.pack("<f", 1.0), answer.body)

    def test_earlier_frames_are_exact(self):
        s = self.service.create(OSCILLATOR)
        hashes = [self.service.post(s["links"]["step"], {"steps": 1}).json()["state_hash"] for _ in range(5)]
        for step, value in enumerate(hashes, 1):
            self.assertEqual(self.service.get(s["links"]["frames"] + "/%d" % step).json()["state_hash"], value)
        self.assertEqual(self.service.get(s["links"]["frames"] + "/6").status, 404)

    def test_observables_as_json_and_csv(self):
        s = self.service.create(OSCILLATOR)
        self.service.post(s["links"]["step"], {"steps": 50})
        o = self.service.get(s["links"]["observables"] + "?names=energy.total").json()
        self.assertEqual(len(o["series"]["step"]), 51)
        energy = o["series"]["values"]["energy.total"]
        self.assertAlmostEqual(energy[0], 50, delta=1e-12)  # k x^2 / 2
        self.assertLess(energy[-1], energy[0])
        csv = self.service.get(s["links"]["observables"] + "?names=energy.total&max_points=10", {"Accept": "text/csv"}).body.decode().splitlines()
        self.assertEqual(csv[0], "step,time,energy.total")
        self.assertLessEqual(len(csv) - 1, 10)

    def test_plan_names_passes_and_what_was_skipped(self):
        s = self.service.create(OSCILLATOR)
        # Who asks for the first time starts the clocks: nobody else pays for them.
        self.assertFalse(any("share" in p for p in self.service.get(s["links"]["plan"]).json()["passes"]))
        self.service.post(s["links"]["step"], {"steps": 10})
        passes = self.service.get(s["links"]["plan"]).json()["passes"]
        self.assertTrue(any(p["pass"] == "integrate" and p["runs"] and p["share"] > 0 for p in passes))
        self.assertTrue(all(p["reason"] for p in passes))

    def test_motion_of_a_skeleton_as_bvh_and_gltf(self):
        # A turn of 90 degrees a second about z, and what a command has changed of it half a second later.
        s = self.service.create({"name": "arm", "time": {"dt": 0.01, "duration": 2}, "systems": [
            {"type": "skeleton", "id": "arm", "controls": [{"name": "bend", "value": "0.5"}], "joints": [
                {"id": "a", "rotation": ["0", "0", "1.5707963267948966*t"]},
                {"id": "b", "parent": "a", "offset": [0.5, 0, 0], "type": "revolute", "axis": [1, 0, 0], "value": "bend", "end": [0.3, 0, 0]}]}]})
        motion = s["links"]["self"] + "/motion"
        self.service.post(s["links"]["step"], {"steps": 50})
        self.service.post(s["links"]["commands"], {"type": "set_parameter", "system": "arm", "name": "bend", "value": 1.0})
        self.service.post(s["links"]["step"], {"steps": 50})
        answer = self.service.get(motion + ".bvh?rate=10")
        self.assertEqual((answer.status, answer.headers["Content-Type"]), (200, "text/plain; charset=utf-8"))
        lines = answer.body.decode().splitlines()
        self.assertEqual(lines[0], "HIERARCHY")
        frames = [[float(x) for x in line.split()] for line in lines[lines.index("MOTION") + 3:]]
        self.assertEqual(len(frames), 11)  # 0 to 1 s, both
        for k, f in enumerate(frames):
            # Root: x y z, then turns about z, x, y in degrees; then those of the other joint.
            self.assertAlmostEqual(f[3], 9 * k, delta=1e-9)
            # Step 50's state is from before the command, whose value the next step has.
            self.assertAlmostEqual(f[7], math.degrees(0.5 if k <= 5 else 1.0), delta=1e-9)
        last = self.service.get(motion + ".bvh?rate=10&seconds=0.3&system=arm").body.decode().splitlines()
        self.assertEqual(last[-4:], lines[-4:])
        self.assertEqual(last[last.index("MOTION") + 1].split()[-1], "4")
        glb, gltf = self.service.get(motion + ".glb"), self.service.get(motion + ".gltf")
        self.assertEqual((glb.headers["Content-Type"], glb.body[:4]), ("model/gltf-binary", b"glTF"))
        self.assertEqual(struct.unpack("<I", glb.body[8:12])[0], len(glb.body))
        document = json.loads(glb.body[20:20 + struct.unpack("<I", glb.body[12:16])[0]])
        self.assertEqual(len(gltf.json()["nodes"]), len(document["nodes"]))
        for query, pointer in (("system=leg", "?system"), ("rate=0", "?rate"), ("rate=9999999", "?rate"), ("rate=x", "?rate")):
            refused = self.service.get(motion + ".bvh?" + query)
            self.assertIn(refused.status, (400, 422))
            self.assertEqual(refused.json()["errors"][0]["pointer"], pointer)
        other = self.service.create(OSCILLATOR)
        self.assertEqual(self.service.get(other["links"]["self"] + "/motion.glb").json()["code"], "unknown_system")

    def test_picture_is_a_png_of_the_wanted_size(self):
        s = self.service.create(OSCILLATOR)
        answer = self.service.get(s["links"]["picture"] + "?width=320&height=200")
        self.assertEqual((answer.status, answer.headers["Content-Type"]), (200, "image/png"))
        self.assertEqual(answer.body[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(struct.unpack(">II", answer.body[16:24]), (320, 200))
        self.assertEqual(self.service.get(s["links"]["picture"] + "?width=8").status, 400)
        self.assertEqual(self.service.get(s["links"]["picture"] + "?camera=1,2").status, 400)

    def test_recording_is_refused_while_written_and_served_afterwards(self):
        s = self.service.create({**OSCILLATOR, "recording": {"every": 2}})
        self.service.post(s["links"]["step"], {"steps": 10})
        busy = self.service.get(s["links"]["recording"])
        self.assertEqual(busy.status, 409)
        done = self.service.post(busy.json()["finish"]).json()
        self.assertEqual(done["frames"], 6)  # steps 0, 2 ... 10
        answer = self.service.get(done["recording"])
        self.assertEqual(answer.body[:8], b"\x89HDF\r\n\x1a\n")
        part = self.service.get(done["recording"], {"Range": "bytes=0-7"})
        self.assertEqual((part.status, part.body), (206, answer.body[:8]))
        self.assertEqual(self.service.get(done["recording"], {"If-None-Match": answer.headers["ETag"]}).status, 304)

    def test_recording_ends_by_itself_at_the_scenes_duration(self):
        s = self.service.create({**OSCILLATOR, "recording": {}})
        self.service.post(s["links"]["step"], {"seconds": 1})
        self.assertEqual(self.service.get(s["links"]["recording"]).status, 200)


if __name__ == "__main__":
    unittest.main()
