#!/usr/bin/env python3
"""Plants faults one at a time, builds what they touch and says which tests find them: the proof that a tier is still sharp.
  python3 tests/planted/run.py --check            every fault still has its place in the code (seconds; part of ./truestep test)
  python3 tests/planted/run.py --list
  python3 tests/planted/run.py [--tier default] [--fault NAME ...]    plants, builds and tests
The expected tests run first. Where they miss a fault its tier runs until something fails, so that the table names what found it.
Works in a tree of its own (build/planted) at the clone's last commit, or with --here in the clone and its build folder; a fault
is taken out again however a run ends. Ends with 1 where a fault was not found by its tier."""
import argparse
import sys
from pathlib import Path

from fault import FOLDER, ROOT, TIERS, all_faults
from tree import Tree, own_tree


def check(faults):
    problems = [f"{f.name}: {complaint}" for f in faults if (complaint := f.complaint(ROOT))]
    print("\n".join(problems) or f"{len(faults)} faults have their places")
    return bool(problems)


def listed(faults):
    for f in faults:
        print(f"{f.name:34} {f.layer:14} {f.tier:8} {f.file}: {f.sentence}")


def trial(tree, fault, whole_tier):
    """Who found the fault (names of failed tests), by what, and the seconds of building and testing."""
    with tree.planted(fault):
        built = tree.build(fault)
        if not built.good:
            return "the fault does not compile", "nothing", built.seconds, 0
        named = tree.test(fault.tests)
        if named.failed or not whole_tier:
            return ", ".join(named.failed[:3]), "expected test" if named.failed else "nothing", built.seconds, named.seconds
        rest = tree.tier(fault.tier)
        return ", ".join(rest.failed[:3]), "its tier" if rest.failed else "nothing", built.seconds, named.seconds + rest.seconds


def run(faults, tree, whole_tier):
    missed = 0
    print("| fault | layer | tier | found by | build s | tests s |\n| --- | --- | --- | --- | --- | --- |", flush=True)
    for f in faults:
        found, by, build_seconds, test_seconds = trial(tree, f, whole_tier)
        missed += by == "nothing"
        answer = f"{found} ({by})" if by == "its tier" else found if by != "nothing" else f"**not found** {found}".strip()
        print(f"| {f.name} | {f.layer} | {f.tier} | {answer} | {build_seconds:.0f} | {test_seconds:.0f} |", flush=True)
    print(f"\n{len(faults) - missed} of {len(faults)} found", flush=True)
    return missed > 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="only: does every fault still have its place")
    parser.add_argument("--list", action="store_true", help="only: what there is")
    parser.add_argument("--fault", action="append", default=[], metavar="NAME", help="this one (repeatable); all of them otherwise")
    parser.add_argument("--tier", choices=TIERS, help="those that this tier must find: full includes default")
    parser.add_argument("--here", action="store_true", help="in this clone and its build/release, which must be built")
    parser.add_argument("--expected-only", action="store_true", help="not the whole tier where the expected tests miss a fault")
    parser.add_argument("-j", type=int, default=2, help="jobs of builds and tests")
    args = parser.parse_args()
    faults = all_faults()
    if unknown := set(args.fault) - {f.name for f in faults}:
        parser.error(f"no fault in {FOLDER.relative_to(ROOT)} is called {', '.join(sorted(unknown))}")
    if args.check:
        return check(faults)
    chosen = [f for f in faults if (not args.fault or f.name in args.fault) and (args.tier != "default" or f.tier == "default")]
    if args.list:
        return listed(chosen)
    tree = Tree(ROOT, ROOT / "build/release", args.j) if args.here else own_tree(args.j)
    return run(chosen, tree, not args.expected_only)


if __name__ == "__main__":
    sys.exit(main())
