#!/usr/bin/env python3
"""Prints how many times as long as on an idle machine things may take: 8, or eight times what a loop on every core at once
takes now beside its nominal time, because the machine may have more to do later. Only limits against hangs are multiplied
by it; no test measures time."""
import multiprocessing
import os
import time

NOMINAL = 0.25  # seconds of the loop below on one core of a virtual machine of 2025


def loop(_):
    begun = time.monotonic()
    x = 0
    for i in range(4_000_000):
        x = (x * 3 + i) & 0xFFFFFF
    return time.monotonic() - begun


def main():
    with multiprocessing.Pool(os.cpu_count()) as pool:
        slowest = max(pool.map(loop, range(2 * os.cpu_count()), chunksize=1))
    print(f"{min(100.0, 8 * max(1.0, slowest / NOMINAL)):.1f}")


if __name__ == "__main__":
    main()
