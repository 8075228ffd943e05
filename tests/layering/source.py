"""Files of the tree as the rules see them: path from the root, text, lines, and what a finding is.

Tracked and not-ignored files when the root is a git checkout, all files outside build folders otherwise
(a Docker build has no .git).
"""
import os
import subprocess
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

IGNORED = {".git", "build", "node_modules", "dist", "__pycache__", ".venv"}
CODE = {".cc", ".h"}


@dataclass(frozen=True)
class Finding:
    """One broken rule at one place; a warning is printed but does not fail the check."""
    path: str
    line: int
    rule: str
    message: str
    warning: bool = False

    def __str__(self):
        return f"{self.path}:{self.line}: {'warning: ' if self.warning else ''}{self.message} [{self.rule}]"


@dataclass
class Tree:
    """The source tree at `root`; `build` is a build folder or None."""
    root: Path
    build: Path | None = None
    texts: dict = field(default_factory=dict)

    @cached_property
    def paths(self):
        """Sorted paths of all files, relative to the root, with forward slashes."""
        listed = subprocess.run(["git", "-C", self.root, "ls-files", "-co", "--exclude-standard", "-z"],
                                capture_output=True, text=True)
        if listed.returncode == 0 and (self.root / ".git").exists():
            return sorted({p for p in listed.stdout.split("\0") if p and (self.root / p).is_file()})
        found = []
        for folder, folders, names in os.walk(self.root):
            folders[:] = [f for f in folders if f not in IGNORED]
            found += [(Path(folder) / n).relative_to(self.root).as_posix() for n in names]
        return sorted(found)

    def text(self, path):
        """The file's text; None when it is binary."""
        if path not in self.texts:
            data = (self.root / path).read_bytes()
            self.texts[path] = None if b"\0" in data[:8192] else data.decode("utf-8", "replace")
        return self.texts[path]

    def code(self, *folders):
        """(path, lines) of the C++ files below the folders (all of them when none is given)."""
        for path in self.paths:
            if Path(path).suffix in CODE and (not folders or path.split("/")[0] in folders):
                yield path, (self.text(path) or "").splitlines()
