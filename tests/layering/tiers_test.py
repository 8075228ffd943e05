#!/usr/bin/env python3
"""tiers_test.py BUILD: no test is in two tiers, none is built that was not asked for, and what a commit touches has tests under
sanitizers."""
import json
import subprocess
import sys
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TESTS))
import touched  # noqa: E402

BUILD = sys.argv.pop(1)


def targets(*options):
    run = subprocess.run([sys.executable, TESTS / "targets.py", BUILD, *options], stdout=subprocess.PIPE, text=True, check=True)
    return set(run.stdout.split())


class Tiers(unittest.TestCase):
    def test_a_test_is_in_one_tier(self):
        run = subprocess.run(["ctest", "--test-dir", BUILD, "--show-only=json-v1"], stdout=subprocess.PIPE,
                             stderr=subprocess.DEVNULL, text=True, check=True)
        tests = json.loads(run.stdout)["tests"]
        labels = {t["name"]: next((p["value"] for p in t["properties"] if p["name"] == "LABELS"), []) for t in tests}
        tiers = {name: {"default", "deep"} & set(values) for name, values in labels.items()}
        self.assertEqual([name for name, found in tiers.items() if len(found) > 1], [])
        for tier, one in (("default", "gallery.arch"), ("deep", "fuzz.obj")):
            self.assertEqual(tiers[one], {tier})
        self.assertEqual(tiers["browser.viewer"], set())

    def test_what_is_named_is_built_and_nothing_else(self):
        self.assertEqual(targets("-R", "stability.Campaign"), {"test_stability"})
        self.assertEqual(targets("-L", "^unit$"), {"test_unit"})
        self.assertEqual(targets("-R", "gallery[.]arch$"), {"gallery_pass"})
        self.assertEqual(targets("-R", "fuzz[.]obj"), {"fuzz_targets"})
        self.assertEqual(targets("-R", "service.memory"), {"truestep", "venv"})
        self.assertIn("tests_full", targets("-R", "no_test_has_this_name"))

    def test_what_is_touched_is_looked_at(self):
        self.assertEqual(touched.arguments(["docs/mpm.md", "web/src/main.ts"]), [])
        self.assertEqual(touched.arguments(["server/net/http/parser.cc"])[0], "service")
        words = touched.arguments(["engine/systems/mpm/mpm.cc"])
        self.assertEqual(words[:2], ["gallery", "-R"])
        self.assertIn("mpm_", words[2])
        self.assertNotIn("service", words[2])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
