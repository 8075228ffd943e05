"""Scene tests show that they can fail: each has a control, or refuses scenes beside one that is accepted."""
import json
import posixpath

from source import Finding

FOLDER = "tests/scenes/"


def merged(below, patch):
    """RFC 7396."""
    if not isinstance(patch, dict):
        return patch
    out = dict(below) if isinstance(below, dict) else {}
    for key, value in patch.items():
        if value is None:
            out.pop(key, None)
        else:
            out[key] = merged(out.get(key), value)
    return out


def test_of(tree, path):
    """The key "test" of a scene file, with what it takes from another."""
    scene = json.loads(tree.text(path))
    base = scene.pop("scene", None)
    if base and (below := posixpath.normpath(posixpath.join(posixpath.dirname(path), base))) in tree.paths:
        return merged(test_of(tree, below), scene.get("test", {}))
    return scene.get("test", {})


def check(tree):
    for path in tree.paths:
        if not path.startswith(FOLDER) or not path.endswith(".json"):
            continue
        test = test_of(tree, path)
        cases = test.get("cases", [])
        refused = [bool(case.get("refused") or case.get("faults")) for case in cases]
        if not test.get("control") and not (any(refused) and not all(refused)):
            yield Finding(path, 1, "controls", "nothing shows that this test can fail: give it a control (docs/testing_scenes.md)")
