"""One type, one name: no two headers define a type of the same qualified name, and none that a source file defines for itself
outside an anonymous namespace. Two definitions of one name are undefined behaviour that no linker reports.
"""
import collections
import re

from source import Finding

SILENT = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.S)
TOKEN = re.compile(
    r"(?P<space>\bnamespace\b\s*(?P<path>[\w:]*)\s*\{)"
    r"|(?P<type>\b(?:struct|class|union|enum(?:\s+class)?)\s+(?:alignas\([^)]*\)\s*)?(?P<name>\w+(?:::\w+)*)\s*(?P<special><[^;{}]*>)?"
    r"(?:\s+final)?\s*(?::[^;{}()]*)?\{)"
    r"|(?P<open>\{)|(?P<close>\})")


def blank(match):
    """As many lines as what is left out."""
    return "\n" * match[0].count("\n")


def types(text):
    """(qualified name, line) of every type that is defined in a namespace, specialisations left out."""
    text = SILENT.sub(blank, text)
    around = []  # (name, is a namespace) of every brace that is open
    for match in TOKEN.finditer(text):
        if match["space"]:
            around.append((match["path"] or "(anonymous)", True))
        elif match["type"]:
            if all(is_space for _, is_space in around) and not match["special"] and "::" not in match["name"]:
                names = [name for name, _ in around]
                if "(anonymous)" not in names:
                    yield "::".join([*names, match["name"]]), text.count("\n", 0, match.start()) + 1
            around.append((match["name"], False))
        elif match["open"]:
            around.append(("", False))
        elif around:
            around.pop()


def check(tree):
    places = collections.defaultdict(list)
    for path, lines in tree.code("engine", "server"):
        for name, line in types("\n".join(lines)):
            places[name].append((path, line))
    for name, where in sorted(places.items()):
        first = where[0][0]
        for path, line in where[1:]:
            if path != first:
                yield Finding(path, line, "names", f"{name} is defined in {first} too: a namespace per subject, or another name")
