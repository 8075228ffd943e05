"""Elastic blocks and sheets of xpbd with substeps that the scene names: `validate` warns of too few, with the number that holds."""
import re
import unittest

from pressed_substeps_test import validate

SHAPES = {
    "block": {"block": {"origin": [0, 0, 0], "size": [0.3, 0.1, 0.15], "cells_x": 3, "cells_y": 2, "cells_z": 3}, "density": 100},
    "sheet": {"cloth_grid": {"origin": [0, 1, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1], "nx": 6, "ny": 6}, "mass": 0.01,
              "thickness": 0.01, "membrane": "neo_hookean"},
}


def warned(shape, youngs_modulus, **members):
    said = validate({"time": {"dt": 1 / 60, "duration": 1},
                     "systems": [{"type": "xpbd", "id": "a", "youngs_modulus": youngs_modulus, **SHAPES[shape], **members}]})
    return [w for w in said["warnings"] if w["code"] == "few_substeps"]


class ElasticSubsteps(unittest.TestCase):
    def test_too_few_are_warned_of_with_the_number_that_holds(self):
        for shape in SHAPES:
            for youngs_modulus in (1e5, 1e6):
                warning, = warned(shape, youngs_modulus, substeps=1)
                self.assertEqual(warning["pointer"], "/systems/0")
                enough = int(re.search(r"fewer than (\d+) substeps", warning["message"])[1])
                self.assertGreater(enough, 2, shape)
                self.assertEqual(warned(shape, youngs_modulus, substeps=enough), [], shape)
                self.assertEqual(len(warned(shape, youngs_modulus, substeps=enough - 1)), 1, shape)

    def test_what_is_soft_or_left_to_the_default_is_not(self):
        for shape in SHAPES:
            self.assertEqual(warned(shape, 1, substeps=1), [], shape)
            self.assertEqual(warned(shape, 1e5), [], shape)


if __name__ == "__main__":
    unittest.main()
