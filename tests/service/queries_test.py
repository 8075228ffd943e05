"""Queries over HTTP: what a solid meets on its way beside what geometry says, solids of any kind that overlap, rows that are
passed over, and many queries in one request, which give what each gives by itself."""
import json
import math
import random
import unittest

from cases import Case

SPHERE = {"type": "sphere", "radius": 0.25}
SCENE = {"gravity": [0, 0, 0], "time": {"dt": 0.01}, "systems": [{"type": "rigid3d", "id": "w", "precision": "f64", "bodies": [
    {"type": "plane", "motion": "fixed"}, {"type": "sphere", "id": "ball", "radius": 0.5, "position": [0, 2, 0]},
    {"type": "box", "id": "crate", "half_extents": [0.5, 0.5, 0.5], "position": [4, 1, 0]}]}]}
# Advances end when the gap is at most 1e-4 of the solid's size (2e-4 where it grazes).
TOUCH = 2e-4


class Queries(Case):
    def setUp(self):
        self.url = self.service.create(SCENE)["links"]["self"]

    def ask(self, query, status=200):
        answer = self.service.post(self.url + "/queries", query)
        self.assertEqual(answer.status, status, answer.body)
        return answer.json()

    def cast(self, shape, position, direction, **more):
        return self.ask({"type": "shape_cast", "shape": shape, "position": position, "direction": direction, **more})["hits"]

    def test_casts_beside_geometry(self):
        # A ball on a ball off its centre: they touch when their centres are the sum of the radii apart.
        for off in (0, 0.3, 0.6, 0.74):
            hit = self.cast(SPHERE, [off, 6, 0], [0, -2, 0], limit=1)[0]
            height = math.sqrt(0.75 ** 2 - off ** 2)
            self.assertEqual((hit["index"], hit["system"]), (1, "w"))
            self.assertAlmostEqual(hit["distance"], 4 - height, delta=TOUCH * 0.75 / height)
            for k, n in enumerate((off / 0.75, height / 0.75, 0)):
                self.assertAlmostEqual(hit["normal"][k], n, delta=1e-2)
                self.assertAlmostEqual(hit["point"][k], (0, 2, 0)[k] + 0.5 * n, delta=1e-2)
        # Past it: the plane alone.
        self.assertEqual([h["index"] for h in self.cast(SPHERE, [0.76, 6, 0], [0, -1, 0])], [0])
        # A turned box comes down on its edge, a capsule on its end, a cylinder on its flat side.
        box, quarter = {"type": "box", "half_extents": [0.2, 0.2, 0.2]}, [math.cos(math.pi / 8), 0, 0, math.sin(math.pi / 8)]
        for shape, lowest, more in ((box, 0.2, {}), (box, 0.2 * math.sqrt(2), {"orientation": quarter}),
                                    ({"type": "capsule", "radius": 0.1, "half_length": 0.3}, 0.4, {}),
                                    ({"type": "cylinder", "radius": 0.1, "half_length": 0.3}, 0.3, {}),
                                    ({"type": "capsule", "radius": 0.1, "half_length": 0.3}, 0.1, {"orientation": [math.sqrt(0.5), 0, 0, math.sqrt(0.5)]})):
            hits = self.cast(shape, [4, 5, 0], [0, -1, 0], **more)
            self.assertEqual([h["index"] for h in hits], [2, 0], "the crate, then the plane behind it")
            for hit, top in zip(hits, (1.5, 0)):
                self.assertAlmostEqual(hit["distance"], 5 - top - lowest, delta=TOUCH, msg=str((shape, more)))
        # No further than it goes; nothing behind it.
        self.assertEqual(self.cast(SPHERE, [0, 6, 0], [0, -1, 0], max_distance=3), [])
        self.assertEqual(self.cast(SPHERE, [0, 6, 0], [0, 1, 0]), [])
        # It starts inside of something.
        self.assertEqual(self.cast(SPHERE, [0, 2, 0], [1, 0, 0], limit=1)[0]["distance"], 0)

    def test_solids_that_overlap(self):
        def rows(**query):
            return [i["index"] for i in self.ask({"type": "overlap", **query})["items"]]
        capsule = {"type": "capsule", "radius": 0.1, "half_length": 2}
        self.assertEqual(rows(center=[0.55, 3, 0], shape=capsule), [1])
        self.assertEqual(rows(center=[0.65, 3.1, 0], shape=capsule), [])
        flat = [math.sqrt(0.5), 0, 0, math.sqrt(0.5)]
        self.assertEqual(rows(center=[2, 1.55, 0], shape=capsule, orientation=flat), [1, 2])
        self.assertEqual(rows(center=[4, 0, 0], half_extents=[1, 1, 1]), [0, 2])
        self.assertEqual(rows(center=[0, 2, 0], radius=1, systems=["w"]), [1])

    def test_rows_are_passed_over(self):
        down = {"type": "ray", "origin": [0, 6, 0], "direction": [0, -1, 0]}
        self.assertEqual([h["index"] for h in self.ask(down)["hits"]], [1, 0])
        self.assertEqual([h["index"] for h in self.ask({**down, "except": [{"system": "w", "index": 1}]})["hits"]], [0])
        near = {"type": "nearest", "point": [0, 2.6, 0], "limit": 1, "except": [{"system": "w", "index": 1}]}
        self.assertEqual(self.ask(near)["hits"][0]["index"], 0)

    def test_what_is_wrong_is_named(self):
        cast = {"type": "shape_cast", "shape": SPHERE, "position": [0, 6, 0], "direction": [0, -1, 0]}
        for change, pointer in (({"shape": None}, "/shape"), ({"shape": {"type": "ball"}}, "/shape/type"),
                                ({"shape": {**SPHERE, "radius": -1}}, "/shape/radius"), ({"direction": [0, 0, 0]}, "/direction"),
                                ({"orientation": [0, 0, 0, 0]}, "/orientation"), ({"orientation": [1, 0]}, "/orientation"),
                                ({"except": [{"system": "x", "index": 0}]}, "/except/0/system"), ({"systems": ["w", "x"]}, "/systems/1"),
                                ({"except": [{"system": "w"}]}, "/except/0/index")):
            query = {k: v for k, v in {**cast, **change}.items() if v is not None}
            answer = self.ask(query, 422)
            self.assertEqual((answer["code"], answer["errors"][0]["pointer"]), ("bad_query", pointer), answer)
            self.assertEqual(self.ask([cast, query], 422)["errors"][0]["pointer"], "/1" + pointer)

    def test_many_at_once_are_what_each_is(self):
        at = random.Random(5)
        place = lambda: [at.uniform(-3, 3) for _ in range(3)]
        bodies = [{"type": "plane", "motion": "fixed", "position": [0, -4, 0]}]
        for _ in range(200):
            kind = at.choice(["sphere", "box", "capsule"])
            size = {"half_extents": [at.uniform(0.05, 0.4) for _ in range(3)]} if kind == "box" else {"radius": at.uniform(0.05, 0.3)}
            bodies.append({"type": kind, "position": place(), "axis": [1, 2, 3], "angle": at.uniform(0, 3), **size})
        scene = {**SCENE, "systems": [{"type": "rigid3d", "id": "w", "bodies": bodies},
                                      {"type": "particles", "id": "p", "positions": [place() for _ in range(100)]}]}
        self.url = self.service.create(scene)["links"]["self"]
        shapes = [SPHERE, {"type": "box", "half_extents": [0.1, 0.2, 0.3]}, {"type": "capsule", "radius": 0.1, "half_length": 0.2}]
        queries = []
        for _ in range(40):
            queries += [{"type": "ray", "origin": place(), "direction": place()}, {"type": "nearest", "point": place(), "within": 0.5},
                        {"type": "overlap", "center": place(), "radius": 0.5, "except": [{"system": "w", "index": 3}]},
                        {"type": "overlap", "center": place(), "shape": at.choice(shapes), "orientation": [1, 0.3, 0.2, 0.1]},
                        {"type": "shape_cast", "shape": at.choice(shapes), "position": place(), "direction": place(), "max_distance": 2}]
        together = self.ask(queries)
        self.assertEqual(together, [self.ask(q) for q in queries])
        found = sum(len(a.get("hits", a.get("items"))) for a in together)
        self.assertGreater(found, 200, "the control: there is something to find")


if __name__ == "__main__":
    unittest.main()
