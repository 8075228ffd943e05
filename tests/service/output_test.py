"""What comes out of a session over HTTP: frames, observables, the plan, pictures, recordings."""
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
