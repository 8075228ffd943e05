"""Every route: unknown query parameters, the examples of /docs, queries, assets, runs, and what a picture is told."""
import hashlib
import html
import json
import re
import subprocess
import unittest

from cases import OSCILLATOR, Case
from harness import SOURCE, Service
from patience import patience

BALLS = {"gravity": [0, 0, 0], "systems": [{"type": "rigid3d", "id": "b", "bodies": [
    {"type": "sphere", "radius": 0.5, "mass": 1, "position": [2, 0, 0]}, {"type": "box", "half_extents": [1, 1, 1], "mass": 1, "position": [6, 0, 0]}]}]}


class Routes(Case):
    def issue(self, answer, status=400):
        self.assertEqual(answer.status, status, answer.body)
        return answer.json()["errors"][0]

    def test_unknown_query_parameters_are_errors_on_every_route(self):
        session = self.service.create(OSCILLATOR)["id"]
        document = self.service.get("/openapi.json").json()
        fill = {"id": session, "name": "rope_catenary", "type": "ode", "step": "latest", "sid": "step-1", "rid": session, "sha256": "0" * 64}
        for path, methods in document["paths"].items():
            for method in methods:
                if path in ("/", "/v1/sessions/{id}/stream"):
                    continue  # the viewer's own; a handshake
                at = re.sub(r"\{(\w+)\}", lambda m: fill[m[1]], path)
                fault = self.issue(self.service.request(method.upper(), at + "?nonsense=1"))
                self.assertEqual((fault["pointer"], fault["code"]), ("?nonsense", "unknown_parameter"), (method, path))
        self.assertEqual(self.service.get("/?session=" + session).status, 200)

    def test_it_names_what_is_allowed_and_the_nearest(self):
        s = self.service.create(OSCILLATOR)
        fault = self.issue(self.service.get(s["links"]["picture"] + "?colour_by=speed"))
        self.assertEqual(fault["did_you_mean"], "color_by")
        self.assertIn("camera", fault["allowed"])
        self.assertEqual(self.issue(self.service.get(s["links"]["frames"] + "?limit=1&limit=2"))["code"], "duplicate")

    def test_a_picture_is_drawn_as_told(self):
        s = self.service.create({"gallery": "rope_catenary"})
        self.service.post(s["links"]["step"], {"steps": 60})

        def picture(query):
            answer = self.service.get(s["links"]["picture"] + "?size=160x120" + query)
            self.assertEqual((answer.status, answer.headers["Content-Type"]), (200, "image/png"), answer.body[:300])
            return answer.body
        plain = picture("")
        self.assertEqual(plain, picture(""), "the same request gives the same picture")
        for query in ("&theme=dark", "&color_by=strain", "&color_by=speed", "&camera=top", "&camera=1,2,9,0,0,0"):
            self.assertNotEqual(picture(query), plain, query)
        fault = self.issue(self.service.get(s["links"]["picture"] + "?color_by=strian"))
        self.assertEqual(fault["did_you_mean"], "strain")
        self.assertEqual(self.issue(self.service.get(s["links"]["picture"] + "?theme=drak"))["did_you_mean"], "dark")
        self.assertEqual(self.issue(self.service.get(s["links"]["picture"] + "?camera=topp"))["did_you_mean"], "top")
        for bad in ("?size=8x8", "?size=100", "?show=nothing"):
            self.issue(self.service.get(s["links"]["picture"] + bad))
        self.issue(self.service.get(s["links"]["picture"] + "?size=100x100&width=100"), 422)

    def ask(self, s, query):
        answer = self.service.post(s["links"]["queries"], query)
        self.assertEqual(answer.status, 200, answer.body)
        return answer.json()

    def test_queries(self):
        s = self.service.create(BALLS)
        near, far = self.ask(s, {"type": "ray", "origin": [0, 0, 0], "direction": [3, 0, 0]})["hits"]
        self.assertEqual((near["system"], near["index"], far["index"]), ("b", 0, 1))
        self.assertAlmostEqual(near["distance"], 1.5, delta=1e-6)
        self.assertAlmostEqual(far["distance"], 5, delta=1e-6)
        self.assertAlmostEqual(far["normal"][0], -1, delta=1e-6)
        self.assertEqual(self.ask(s, {"type": "ray", "origin": [0, 0, 0], "direction": [0, 1, 0]})["hits"], [])
        (hit,) = self.ask(s, {"type": "nearest", "point": [2, 2, 0], "limit": 1})["hits"]
        self.assertAlmostEqual(hit["distance"], 1.5, delta=1e-6)
        items = self.ask(s, {"type": "overlap", "center": [4.6, 0, 0], "radius": 0.5})["items"]
        self.assertEqual([i["index"] for i in items], [1])
        self.assertEqual(self.ask(s, {"type": "overlap", "center": [4, 0, 0], "half_extents": [0.5, 1, 1]})["items"], [])
        self.assertEqual(self.ask(s, {"type": "contacts"})["contacts"], [])
        self.assertEqual(self.issue(self.service.post(s["links"]["queries"], {"type": "rai"}), 422)["did_you_mean"], "ray")
        self.issue(self.service.post(s["links"]["queries"], {"type": "overlap", "center": [0, 0, 0]}), 422)
        fault = self.issue(self.service.post(s["links"]["queries"], {"type": "ray", "origin": [0, 0, 0], "direction": [1, 0, 0], "systems": ["c"]}), 422)
        self.assertEqual(fault["allowed"], "b")

    def test_contacts_of_a_body_at_rest(self):
        s = self.service.create({"time": {"dt": 0.01}, "systems": [{"type": "rigid3d", "id": "b", "bodies": [
            {"type": "plane", "motion": "fixed"}, {"type": "box", "half_extents": [0.5, 0.5, 0.5], "mass": 2, "position": [0, 0.5, 0]}]}]})
        self.service.post(s["links"]["step"], {"steps": 50})
        contacts = self.ask(s, {"type": "contacts"})["contacts"]
        self.assertAlmostEqual(sum(c["force"] for c in contacts), 2 * 9.81, delta=0.05 * 2 * 9.81)

    def test_assets_stand_where_scenes_refer_to_them(self):
        text = json.dumps([[0, 0, 0], [1, 0, 0], [2, 1, 0]])
        name = hashlib.sha256(text.encode()).hexdigest()
        link, kind = "/v1/assets/" + name, {"Content-Type": "application/json"}
        scene = {"systems": [{"type": "particles", "id": "p", "positions": {"asset": name}}]}
        self.assertEqual(self.issue(self.service.post("/v1/sessions", scene), 422)["pointer"], "/systems/0/positions/asset")
        self.assertEqual(self.service.request("PUT", link, text + " ", kind).status, 422)
        self.assertEqual(self.service.request("PUT", link, text, kind).status, 201)
        self.assertEqual(self.service.request("PUT", link, text, kind).status, 200)
        self.assertEqual(self.service.get(link).body.decode(), text)
        s = self.service.create(scene)
        self.assertEqual(self.service.request("DELETE", link).status, 204)
        self.assertEqual(self.service.get(link).status, 404)
        (block,) = self.service.get(s["links"]["latest_frame"]).json()["blocks"]
        self.assertEqual(block["values"][2], [2, 1, 0])

    def test_mesh_files_stand_where_scenes_refer_to_them(self):
        text = "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
        name = hashlib.sha256(text.encode()).hexdigest()
        link, kind = "/v1/assets/" + name, {"Content-Type": "application/octet-stream"}
        self.assertEqual(self.service.request("PUT", link, text, kind).status, 201)
        back = self.service.get(link)
        self.assertEqual((back.body.decode(), back.headers["Content-Type"]), (text, "application/octet-stream"))
        cloth = lambda reference: {"systems": [{"type": "xpbd", "id": "c", "mesh": reference}]}
        s = self.service.create(cloth({"asset": name, "scale": 0.1}))
        scene = self.service.get(s["links"]["scene"]).json()
        self.assertEqual(scene["systems"][0]["mesh"]["triangles"][:3], [0, 2, 1])
        (block,) = self.service.get(s["links"]["latest_frame"]).json()["blocks"]
        self.assertEqual(block["values"][3], [0, 0, 1])
        bad = self.issue(self.service.post("/v1/sessions", cloth({"asset": name, "as": "solid"})), 422)
        self.assertEqual((bad["pointer"], bad["allowed"]), ("/systems/0/mesh/as", "surface, cells, vertices, triangles, text, lines, gltf"))
        bad = self.issue(self.service.post("/v1/sessions", cloth({"asset": name, "as": "cells"})), 422)
        self.assertEqual((bad["pointer"], bad["code"]), ("/systems/0/mesh/asset", "bad_file"))
        self.assertEqual(self.issue(self.service.post("/v1/sessions", cloth({"path": "a.obj"})), 422)["pointer"], "/systems/0/mesh/path")
        broken = text + "f 1 2 9\n"
        answer = self.service.request("PUT", "/v1/assets/" + hashlib.sha256(broken.encode()).hexdigest(), broken, kind)
        self.assertEqual(answer.status, 400, answer.body)
        self.assertIn("line 9: a face has vertex 9", answer.body.decode())

    def test_a_run_gives_observables_over_time(self):
        answer = self.service.post("/v1/runs", {"scene": OSCILLATOR, "duration": 0.5, "observables": ["energy"]})
        self.assertEqual(answer.status, 202, answer.body)
        link = answer.headers["Location"]
        self.service.get(link + "/events")  # to the end
        result = self.service.get(link + "/result").json()
        self.assertEqual((result["summary"]["kind"], result["summary"]["steps"]), ("run", 50))
        self.assertEqual(len(result["rows"]), 51)
        s = self.service.create(OSCILLATOR)
        self.assertEqual(self.service.post(s["links"]["step"], {"steps": 50}).json()["state_hash"], result["summary"]["state_hash"])
        series = self.service.get(s["links"]["observables"] + "?names=energy.total").json()["series"]["values"]["energy.total"]
        self.assertEqual([r["energy.total"] for r in result["rows"]], series)


class Docs(unittest.TestCase):
    def test_every_request_has_an_example_that_runs(self):
        service = Service()
        self.addCleanup(service.stop)
        page = service.get("/docs").body.decode()
        sections = re.findall(r"<h3><code>(\w+) ([^<]+)</code></h3>(.*?)(?=<h3>|<h2)", page, re.S)
        script = ["set -euo pipefail", "base=" + service.url]
        for method, path, text in sections:
            example = re.search(r"<pre class=example>(.*?)</pre>", text, re.S)
            if method == "WS":
                continue
            self.assertTrue(example, (method, path))
            script.append(html.unescape(example[1]) + " > last || { echo failed: '%s %s'; exit 1; }" % (method, path))
        described = sum(len(m) for m in service.get("/openapi.json").json()["paths"].values())
        self.assertEqual(len(sections), described, "every route has a section")
        done = subprocess.run(["bash", "-c", "\n".join(script)], cwd=service.data, text=True, capture_output=True, timeout=patience(60))
        self.assertEqual(done.returncode, 0, (done.stdout + done.stderr)[-1500:])

    def test_the_protocol_is_served(self):
        service = Service()
        self.addCleanup(service.stop)
        text = service.get("/v1/schemas/stream.proto").body.decode()
        self.assertEqual(text, (SOURCE / "proto/truestep/v1/stream.proto").read_text())
        page = service.get("/docs").body.decode()
        for word in ("Hello", "Subscribe", "Credit", "4408", "4410", "achieved_speed"):
            self.assertIn(word, page[page.index("id=stream"):])

    def test_the_streams_example_runs(self):
        modules = SOURCE / "web" / "node_modules" / "ws"
        if not modules.exists():
            self.skipTest("the viewer's packages are not installed")
        service = Service()
        self.addCleanup(service.stop)
        page = service.get("/docs").body.decode()
        example = html.unescape(re.search(r"given <code>base</code> and <code>id</code>:<pre>(.*?)</pre>", page, re.S)[1])
        session = service.create({"gallery": "rope_catenary"})["id"]
        script = "const WebSocket = require(%s); const base = %s, id = %s;\n%s" % (*map(json.dumps, (str(modules), service.url, session)), example)
        done = subprocess.run(["node", "-e", script], text=True, capture_output=True, timeout=patience(20))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(len(re.findall(r"^step \d+ first row at Float32Array", done.stdout, re.M)), 1, done.stdout)


if __name__ == "__main__":
    unittest.main()
