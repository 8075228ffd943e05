"""A source tree with its build folder, into which one fault at a time is planted: built as far as the tests in question need it,
and tested. Nothing here knows a fault's subject."""
import re
import subprocess
import time
from contextlib import contextmanager
from dataclasses import dataclass, field

from fault import ROOT

# What one of a tier's tests is called, by its first word; --full has both lists.
TIER_LABELS = {"default": "layering|unit|determinism|convergence|gallery|scenes|readme",
               "full": "validation|stability|crosscheck|service|browser"}
# Tests that are executables of their own; all others start the program.
EXECUTABLES = {"unit", "convergence", "validation", "stability", "determinism", "crosscheck", "service"}
SCRIPTS = re.compile(r"(gallery|scene|readme|estimates|restart|refus|stream|routes|sessions|recording|data_folder|command_line|Studies|Catalogue|Sessions)")


@dataclass
class Outcome:
    good: bool
    seconds: float
    failed: list = field(default_factory=list)


class Tree:
    def __init__(self, root, build, jobs):
        self.root, self.build_folder, self.jobs = root, build, jobs

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

    def build(self, fault):
        """Only what the expected tests start; `all` is left to the tier."""
        start = time.monotonic()
        good = True
        if fault.file.startswith("web/"):
            good = self.run("npm", "run", "client", cwd=self.root / "web").returncode == 0
        targets = sorted({target for test in fault.tests for target in targets_of(test)})
        if good and targets:
            good = self.run("cmake", "--build", self.build_folder, f"-j{self.jobs}", "--target", *targets).returncode == 0
        return Outcome(good, time.monotonic() - start)

    def test(self, names):
        return self.ctest("-R", "|".join(names))

    def tier(self, tier):
        if self.run("cmake", "--build", self.build_folder, f"-j{self.jobs}").returncode != 0:
            return Outcome(False, 0, ["the whole does not build"])
        labels = TIER_LABELS["default"] + ("|" + TIER_LABELS["full"] if tier == "full" else "")
        return self.ctest("-L", f"^({labels})$")

    def ctest(self, *options):
        start = time.monotonic()
        done = self.run("ctest", "--test-dir", self.build_folder, "--stop-on-failure", "--no-tests=error", "--timeout", "600",
                        "-j", str(self.jobs), *options)
        if "No tests were found" in done.stdout + done.stderr:
            raise SystemExit(f"no test is called {options[-1]}")
        failed = re.findall(r"^\s*\d+ - (\S+) \((?:Failed|Timeout|SEGFAULT|Subprocess aborted|ILLEGAL|NUMERICAL|BUS|SIG\w+)", done.stdout, re.M)
        return Outcome(not failed, time.monotonic() - start, failed)

    def run(self, *command, cwd=None):
        return subprocess.run([str(word) for word in command], cwd=cwd or self.root, capture_output=True, text=True, check=False)


def targets_of(test):
    """Of a test's name (a regular expression): what must be built before it runs."""
    kind = re.match(r"\^?\(?(\w+)", test)[1]
    if kind == "layering" or test.endswith("browser.client$"):
        return []
    if kind == "determinism" and "gallery" in test:
        return ["gallery_hashes"]
    return ["truestep"] if kind not in EXECUTABLES or SCRIPTS.search(test) else [f"test_{kind}"]


def own_tree(jobs):
    """The clone's last commit in build/planted, with a build folder of its own; made once, brought up to date otherwise."""
    root = ROOT / "build/planted"
    if not root.exists():
        subprocess.run(["git", "worktree", "prune"], cwd=ROOT, check=True)
        subprocess.run(["git", "worktree", "add", "--detach", root, "HEAD"], cwd=ROOT, check=True, capture_output=True)
    head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()
    subprocess.run(["git", "checkout", "--quiet", "--force", "--detach", head], cwd=root, check=True)
    for command in (["./truestep", "build", "--target", "truestep"], ["cmake", "--build", "build/release", f"-j{jobs}"]):
        subprocess.run(command, cwd=root, check=True, capture_output=True)
    return Tree(root, root / "build/release", jobs)
