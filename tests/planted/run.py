#!/usr/bin/env python3
"""Plants faults one at a time, builds what they touch and says which tests find them: the proof that a tier is still sharp.
  python3 tests/planted/run.py --check            every fault still has its place in the code (seconds; part of ./truestep test)
  python3 tests/planted/run.py --list
  python3 tests/planted/run.py [--tier default] [--fault NAME ...]    plants, builds and tests
The expected tests run first. Where they miss a fault its tier runs until something fails, so that the table names what found it.
It runs ./truestep test, in a clone of its own (build/planted) at the last commit, or with --here in this one; a fault is taken
out again however a run ends. Ends with 1 where a fault was not found by its tier."""
import argparse
import signal
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
    """(who found it, or why nobody did; found; seconds of building and testing)"""
    with tree.planted(fault):
        outcome = tree.named(fault.tests)
        seconds = outcome.seconds
        if not outcome.trouble and not outcome.failed and whole_tier:
            outcome = tree.tier(fault.tier)
            seconds += outcome.seconds
            if outcome.failed:
                return f"{names(outcome)}, none of the expected tests", True, seconds
    if outcome.trouble:
        return outcome.trouble, False, seconds
    return (names(outcome), True, seconds) if outcome.failed else ("**nobody**", False, seconds)


def names(outcome):
    more = len(outcome.failed) - 2
    return ", ".join(outcome.failed[:2]) + (f" and {more} more" if more > 0 else "")


def run(faults, tree, whole_tier):
    count = 0
    print("| fault | layer | tier | found by | s |\n| --- | --- | --- | --- | --- |", flush=True)
    for f in faults:
        answer, found, seconds = trial(tree, f, whole_tier)
        count += found
        print(f"| {f.name} | {f.layer} | {f.tier} | {answer} | {seconds:.0f} |", flush=True)
    print(f"\n{count} of {len(faults)} found", flush=True)
    return count < len(faults)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="only: does every fault still have its place")
    parser.add_argument("--list", action="store_true", help="only: what there is")
    parser.add_argument("--fault", action="append", default=[], metavar="NAME", help="this one (repeatable); all of them otherwise")
    parser.add_argument("--tier", choices=TIERS, help="those that this tier must find: full includes default")
    parser.add_argument("--here", action="store_true", help="in this clone itself, not in one of its own")
    parser.add_argument("--expected-only", action="store_true", help="not the whole tier where the expected tests miss a fault")
    args = parser.parse_args()
    faults = all_faults()
    if unknown := set(args.fault) - {f.name for f in faults}:
        parser.error(f"no fault in {FOLDER.relative_to(ROOT)} is called {', '.join(sorted(unknown))}")
    if args.check:
        return check(faults)
    chosen = [f for f in faults if (not args.fault or f.name in args.fault) and (args.tier != "default" or f.tier == "default")]
    if args.list:
        return listed(chosen)
    # Asked to end, it leaves as an exception does: what was planted is taken out.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    return run(chosen, Tree(ROOT) if args.here else own_tree(), not args.expected_only)


if __name__ == "__main__":
    sys.exit(main())
