"""A planted fault: one small change to one file, as a person could make it by mistake, and the tests that must notice it.
Written as TOML in faults/NAME.toml, found by its text and not by its line, so that it survives work around it:
  file, find, replace   the change; `find` occurs exactly once in the file
  layer                 the folder or subject of DESIGN.md that it sits in
  sentence              what is wrong, in the words of whoever made the mistake
  tier                  default or full: the first tier that must find it
  tests                 names (regular expressions, as for ctest -R) of the tests that are expected to"""
import tomllib
from dataclasses import dataclass
from pathlib import Path

TIERS = ("default", "full")
FOLDER = Path(__file__).resolve().parent / "faults"
ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Fault:
    name: str
    file: str
    find: str
    replace: str
    layer: str
    sentence: str
    tier: str
    tests: tuple

    def altered(self, text):
        """The file's text with the fault in it."""
        return text.replace(self.find, self.replace)

    def complaint(self, tree):
        """Why this fault cannot be planted in a tree; empty when it can."""
        path = tree / self.file
        if not path.is_file():
            return f"{self.file} is not there"
        count = path.read_text().count(self.find)
        if count != 1:
            return f"its text occurs {count} times in {self.file}, not once"
        if self.find == self.replace:
            return "it changes nothing"
        if self.tier not in TIERS:
            return f"tier {self.tier!r} is none of {', '.join(TIERS)}"
        return "" if self.tests and self.sentence and self.layer else "tests, sentence and layer must not be empty"


def read(path):
    with open(path, "rb") as file:
        values = tomllib.load(file)
    values["tests"] = tuple(values["tests"])
    return Fault(name=path.stem, **values)


def all_faults():
    return [read(path) for path in sorted(FOLDER.glob("*.toml"))]
