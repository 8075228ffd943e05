#!/usr/bin/env python3
"""Is the JSON of README.md and docs/*.md what the service takes? Every block, fenced as json or indented, and every `inline`
piece with a key is put into the scene that the comment before its paragraph or block gives, and that scene is validated:

    <!-- json
    {"systems": [{"type": "rigid3d", "$": 0}]}        the members of the first piece take the place of "$"
    {"systems": "$"}                                  the value of the second one does
    same                                              the third one goes where the second went
    answer: of POST /v1/sessions                      the fourth one is no part of a scene, and says what it is
    -->

A line for every piece, in their order; a block that is a whole scene needs none. `...` in a piece stands for what is left out.
"""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from documented_files import write_files

ROOT = Path(__file__).resolve().parents[2]
TRUESTEP = os.environ.get("TRUESTEP_BINARY", str(ROOT / "build/release/bin/truestep"))
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
NO_SCENE = re.compile(r"(answer|request|command|study|test|fragment): \S")
DEFAULTS = {"schema_version": "1.0", "time": {"dt": 0.01, "duration": 0.02}}


def parts_of(text):
    """(line, text) of everything between blank lines; a fenced block and an indented one are one part each."""
    parts, lines, fence = [], [], False
    for number, line in enumerate(text.splitlines() + [""], 1):
        inside = fence
        if line.startswith("```"):
            fence = not fence
        opening = fence and not inside
        if lines and (opening or (not inside and not line.strip())):
            parts.append((number - len(lines), "\n".join(lines)))
            lines = []
        if inside or fence or line.strip():
            lines.append(line)
    return parts


def pieces_of(part):
    """The JSON of a part of a page, and whether it is a block."""
    fenced = re.fullmatch(r"```(\w*)\n(.*?)\n```", part, re.S)
    if fenced:
        like = fenced[1] == "json" or (not fenced[1] and fenced[2].lstrip()[:1] in ("{", "["))
        return ([fenced[2]] if like else []), True
    if all(line.startswith("    ") for line in part.splitlines()):
        return ([part] if part.lstrip()[:1] in '{["' else []), True
    # As commands of a shell have it, other tests run it.
    return [re.sub(r"^\w+ \S* *(?={)", "", re.sub(r"\s+", " ", p)) for p in re.findall(r"`([^`]*\": ?[^`]*)`", part)], False


def values_of(piece):
    """The JSON values of a piece; bare members make an object."""
    text = re.sub(r",\s*\.\.\.|\.\.\.", "", piece).strip()
    if text.startswith('"'):
        try:
            return [json.loads("{" + text + "}")]
        except json.JSONDecodeError:
            return [json.loads("{" + line + "}") for line in text.splitlines()]
    values, at = [], 0
    while at < len(text):
        value, end = json.JSONDecoder().raw_decode(text, at)
        values.append(value)
        at = end + len(text[end:]) - len(text[end:].lstrip())
    return values


def filled(template, values):
    """The template with values in the place of "$": spliced into an array, merged into an object."""
    if isinstance(template, list):
        return [x for t in template for x in (values if t == "$" else [filled(t, values)])]
    if isinstance(template, dict):
        out = {k: filled(v, values) for k, v in template.items() if k != "$"}
        return {**out, **values[0]} if "$" in template else out
    return values[0] if template == "$" else template


def scenes_of(page):
    """(line, scene) of every piece; raises ValueError for a piece that says nothing of itself."""
    contexts = []
    for line, part in parts_of(page.read_text()):
        where = f"{page.name}:{line}"
        comment = re.search(r"<!-- json\s(.*?)-->\n?", part, re.S)
        if comment:
            contexts = [c.strip() for c in comment[1].strip().splitlines()]
            part = part[:comment.start()] + part[comment.end():]
            line += comment[0].count("\n")
            if not part.strip():
                continue
        pieces, block = pieces_of(part)
        if block and pieces and not contexts and "systems" in (whole := values_of(pieces[0])[0]):
            yield line, whole
            continue
        if len(pieces) != len(contexts):
            raise ValueError(f"{where}: {len(pieces)} pieces of JSON and {len(contexts)} contexts (<!-- json -->) before them: {pieces}")
        template = None
        for piece, context in zip(pieces, contexts):
            template = template if context == "same" else context
            if NO_SCENE.match(template):
                continue
            try:
                values = values_of(piece)
                for each in ([values] if '"$"' in template and not re.search(r'"\$": ', template) else [[v] for v in values]):
                    yield line, {**DEFAULTS, **filled(json.loads(template), each)}
            except json.JSONDecodeError as e:
                raise ValueError(f"{where}: {e} in {piece} with {template}") from e
        contexts = []


def refusal(scene, folder):
    """What validate says against it; empty: nothing."""
    path = Path(folder) / "documented.json"
    path.write_text(json.dumps(scene))
    run = subprocess.run([TRUESTEP, "validate", path], capture_output=True, text=True, timeout=300)
    return "" if run.returncode == 0 else run.stdout + run.stderr


class DocumentedJson(unittest.TestCase):
    def test_every_piece_is_taken(self):
        count = 0
        with tempfile.TemporaryDirectory() as folder:
            write_files(TRUESTEP, Path(folder))
            for page in PAGES:
                for line, scene in scenes_of(page):
                    count += 1
                    with self.subTest(where=f"{page.name}:{line}"):
                        said = refusal(scene, folder)
                        self.assertFalse(said, f"{said}{json.dumps(scene)}")
        self.assertGreater(count, 40)

    def test_a_key_that_is_none_is_found(self):
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "page.md"
            text = '<!-- json {"systems": [{"type": "motion_capture", "motion": {"gltf": "$"}}]} -->\nTake `{"file": "walk.glb"}`.\n'
            page.write_text(text)
            write_files(TRUESTEP, Path(folder))
            [(line, scene)] = scenes_of(page)
            self.assertEqual(line, 2)
            self.assertIn("/systems/0/motion/gltf", refusal(scene, folder))
            page.write_text(text.replace("file", "path"))
            [(_, scene)] = scenes_of(page)
            self.assertEqual(refusal(scene, folder), "")

    def test_a_piece_without_a_context_is_found(self):
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "page.md"
            for text in ('Give `"mass": 3`.\n', '```json\n{"mass": 3}\n```\n', '    {"mass": 3}\n', '<!-- json answer: x -->\nNothing.\n'):
                page.write_text(text)
                with self.assertRaises(ValueError):
                    list(scenes_of(page))


if __name__ == "__main__":
    unittest.main()
