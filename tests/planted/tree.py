"""A clone of its own for planted faults: the last commit of the one it belongs to, tested by its own ./truestep, so that what
is asked is what a newcomer's command would find. Whatever happens, a fault is taken out again."""
import re
import subprocess
import time
from contextlib import contextmanager
from dataclasses import dataclass

from fault import ROOT

FOLDER = ROOT / "build/planted"
TIER_OPTIONS = {"default": [], "full": ["--full"]}
CTEST_FAILED = re.compile(r"^\s*\d+ - (\S+) \((?!Not Run|Disabled)", re.M)
GTEST_FAILED = re.compile(r"^(?:\d+: )?\[  FAILED  \] ([\w/]+\.[\w/]+)", re.M)


@dataclass
class Outcome:
    failed: list  # names of tests
    seconds: float
    trouble: str = ""  # why the tests did not run


class Tree:
    def __init__(self, root):
        self.root = root

    @contextmanager
    def planted(self, fault):
        if complaint := fault.complaint(self.root):
            raise SystemExit(f"{fault.name}: {complaint}")
        path = self.root / fault.file
        sound = path.read_bytes()
        path.write_bytes(fault.altered(sound.decode()).encode())
        try:
            yield
        finally:
            path.write_bytes(sound)

    def named(self, tests):
        return self.test("-R", "|".join(tests))

    def tier(self, tier):
        return self.test(*TIER_OPTIONS[tier])

    def test(self, *options):
        """./truestep test with these options, up to the first failure."""
        start = time.monotonic()
        done = subprocess.run(["./truestep", "test", *options, "--stop-on-failure"], cwd=self.root, capture_output=True, text=True,
                              check=False)
        seconds = time.monotonic() - start
        if done.returncode == 0:
            return Outcome([], seconds)
        if "No tests were found" in done.stdout + done.stderr:
            return Outcome([], seconds, f"no test is called {options[-1]}")
        # Executables run many tests each: theirs are named, else those of ctest.
        failed = GTEST_FAILED.findall(done.stdout) or CTEST_FAILED.findall(done.stdout)
        return Outcome(list(dict.fromkeys(failed)), seconds, "" if failed else "it does not build")


def own_tree():
    """Made once; later runs bring it to the clone's last commit, and its build folder saves most of their time."""
    def git(*words, at=ROOT):
        return subprocess.run(["git", *words], cwd=at, check=True, capture_output=True, text=True).stdout.strip()

    if not FOLDER.exists():
        git("worktree", "prune")
        git("worktree", "add", "--detach", str(FOLDER), "HEAD")
    git("checkout", "--quiet", "--force", "--detach", git("rev-parse", "HEAD"), at=FOLDER)
    return Tree(FOLDER)
