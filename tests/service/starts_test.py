"""Scenes whose numbers are finite and whose start is not, and scenes of the gallery as sessions give them back."""
import copy
import unittest

from cases import Case



def rigid3d(**shape):
    return {"systems": [{"type": "rigid3d", "id": "a", "bodies": [{"type": "box", "position": [0, 1, 0], **shape}]}]}


def rigid2d(**shape):
    return {"systems": [{"type": "rigid2d", "id": "a", "bodies": [{"position": [0, 1, 0], "shapes": [{"type": "box", **shape}]}]}]}


class Starts(Case):
    def outcome(self, scene):
        """"refused" with a pointer, or "finite": created, stepped (or unstable, which says so) and drawn in finite numbers."""
        valid = self.service.post("/v1/scenes/validate", scene)
        made = self.service.post("/v1/sessions", scene)
        if made.status == 422:
            self.assertEqual(valid.status, 422, scene)
            self.assertTrue(all(e["pointer"].startswith("/systems/0") for e in made.json()["errors"]), made.body)
            return "refused"
        self.assertEqual((made.status, valid.status), (201, 200), made.body)
        links = made.json()["links"]
        self.assertIn(self.service.post(links["step"], {"steps": 3}).status, (200, 409))
        frame = self.service.get(links["latest_frame"]).json()
        values = [x for b in frame["blocks"] for row in b["values"] for x in row]
        self.assertTrue(values and all(x is not None for x in values))
        self.service.request("DELETE", links["self"])
        return "finite"

    def gallery(self, name):
        scene = self.service.get("/v1/gallery/" + name).json()["scene"]
        scene.pop("expect", None)
        return scene

    def test_ropes_whose_ends_are_too_far_apart(self):
        for name in ("rope_catenary", "stiff_rope_implicit"):
            for far in (1e300, -1e308):
                scene = self.gallery(name)
                self.assertEqual(self.outcome(scene), "finite", "the control")
                scene["systems"][0]["rope"]["to"][0] = far
                self.assertEqual(self.outcome(scene), "refused", (name, far))

    def test_bodies_of_impossible_sizes(self):
        for make, sides in ((rigid3d, 3), (rigid2d, 2)):
            self.assertEqual(self.outcome(make(half_extents=[0.5, 0.5, 0.5])), "finite", "the control")
            for size in (5e-324, 1e-310, 1e-200, 1e160, 1e300, 1e308):
                for place in range(sides):
                    half = [0.5, 0.5, 0.5]
                    half[place] = size
                    self.assertIn(self.outcome(make(half_extents=half)), ("refused", "finite"), (make.__name__, half))
                self.assertIn(self.outcome(make(half_extents=[size] * 3)), ("refused",) if make is rigid3d else ("refused", "finite"), size)

    def test_a_body_that_is_too_thin_in_a_pile(self):
        scene = self.gallery("card_house")
        scene["systems"][0]["bodies"][1]["half_extents"][0] = 5e-324
        self.assertEqual(self.outcome(scene), "refused")

    def test_fills_beyond_all_bounds(self):
        scene = {"systems": [{"type": "particles", "id": "a", "fill": [{"shape": "box", "center": [0, 1, 0], "half_extents": [1, 1, 1], "count": 50}]}]}
        self.assertEqual(self.outcome(scene), "finite", "the control")
        for key, value in (("half_extents", [1, 1e308, 1]), ("half_extents", [1e308] * 3), ("center", [0, 1e308, 0]), ("velocity", [1e300, 0, 0])):
            for arrangement in ("lattice", "random"):
                bad = copy.deepcopy(scene)
                bad["systems"][0]["fill"][0].update({key: value, "arrangement": arrangement})
                # A lattice of such a size has its points in the middle of every side but one.
                wanted = "finite" if arrangement == "lattice" and value == [1e308] * 3 else "refused"
                self.assertEqual(self.outcome(bad), wanted, (key, value, arrangement))

    def test_points_at_both_ends_of_all_numbers_are_searched(self):
        far = [[x, 1, z] for x in (-1e308, 1e308) for z in (-1e308, 0, 1e308)]
        cloth = self.gallery("rain_on_cloth")
        for system in cloth["systems"]:
            for fill in system.get("fill", []):
                fill["half_extents"][2] = 1e308
        for scene in (cloth, {"gravity": [0, 0, 0], "systems": [{"type": "particles", "id": "a", "positions": far,
                                                                 "pair_forces": [{"type": "soft_repulsion"}]}]}):
            self.assertEqual(self.outcome(scene), "finite")


class Gallery(Case):
    def test_what_a_session_gives_as_its_scene_makes_it_again_and_can_be_branched(self):
        names = [s["name"] for s in self.service.get("/v1/gallery").json()["scenes"]]
        self.assertGreater(len(names), 50)
        for name in names:
            made = self.service.create({"gallery": name})
            links = made["links"]
            scene = self.service.get(links["scene"]).json()
            again = self.service.post("/v1/sessions", scene)
            self.assertEqual(again.status, 201, (name, again.body))
            self.assertEqual(again.json()["state_hash"], made["state_hash"], name)
            self.assertEqual(self.service.get(again.json()["links"]["scene"]).json(), scene, name)
            branch = self.service.post(links["self"] + "/branch")
            self.assertEqual((branch.status, branch.json().get("state_hash")), (201, made["state_hash"]), name)
            for session in (made, again.json(), branch.json()):
                self.service.request("DELETE", session["links"]["self"])


if __name__ == "__main__":
    unittest.main()
