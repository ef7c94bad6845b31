# SPDX-License-Identifier: GPL-3.0-or-later
"""Random shader programs, one after the other: `python3 build.py fuzz [--minutes N] [--seed S]`.

In turn: a graph of random operations is assembled, verified and rendered; files with such programs are damaged, and
have to be refused or rendered without harm; node trees of Blender are exported and rendered.

A process does so, and tells the seeds as it goes. If it dies, or one takes too long, the last seed says which it was,
and another process goes on behind it. `--only SEED` runs one again.
"""

import argparse
import os
import queue
import subprocess
import sys
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PATIENCE_S, FIRST_PATIENCE_S = 900.0, 1800.0  # with one program; the first waits for compilation, a rare one for some
OUTPUT = 2000  # characters of what a process said before it died


def main():
    options = parse()
    if options.child is not None:
        return work_from(options.child)
    if options.only is not None:
        faults = faults_of(options.only)
        print("\n".join(faults) or "nothing is wrong", flush=True)
        os._exit(bool(faults))  # some of Blender's modules hang where a process ends as usual
    end, seed, failed = time.monotonic() + 60.0 * options.minutes, options.seed, {}
    while time.monotonic() < end:
        seed = watch(seed, end, failed) + 1
    print(f"{seed - options.seed} programs, seeds {options.seed} to {seed - 1}; {len(failed)} failed")
    return bool(failed)


def parse():
    parser = argparse.ArgumentParser(prog="python3 build.py fuzz", description=__doc__)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", type=int)
    parser.add_argument("--child", type=int)
    return parser.parse_args()


def watch(seed, end, failed):
    """Run a process from `seed` until it fails or time is over; the last seed that it began. Adds to `failed`."""
    process = subprocess.Popen(
        [sys.executable, "-X", "faulthandler", "-m", "blender_tests.fuzz", "--child", str(seed)],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    lines, said, first = read_as_they_come(process), "", seed
    try:
        while (left := end - time.monotonic()) > 0.0:
            patience = PATIENCE_S if seed > first else FIRST_PATIENCE_S
            try:
                line = lines.get(timeout=min(patience, left))
            except queue.Empty:
                if patience < left:
                    tell(failed, seed, f"still runs after {patience:.0f} s")
                break
            if line is None:
                tell(failed, seed, f"ended with exit code {process.wait()}: {said[-OUTPUT:]}")
                break
            word, _, rest = line.partition(" ")
            if word == "seed":
                seed, said = int(rest), ""
            elif word == "fault":
                tell(failed, seed, rest.strip())
            else:
                said += line
    finally:
        process.kill()
        process.wait()
    return seed


def read_as_they_come(process):
    """A queue of the lines of a process; None: it has ended."""
    lines = queue.Queue()

    def read():
        for line in process.stdout:
            lines.put(line)
        lines.put(None)

    threading.Thread(target=read, daemon=True).start()
    return lines


def tell(failed, seed, text):
    failed[seed] = text
    print(f"seed {seed}: {text}", flush=True)


def faults_of(seed):
    """What is wrong with what a seed stands for, as texts."""
    import bpy  # noqa: F401  before anything of ours

    from blender_tests.helpers import programs, random_trees

    kinds = (programs.faults_of, programs.faults_of_damage, random_trees.faults_of_tree)
    return kinds[seed % 3](seed, size=20 + seed // 3 % 60)


def work_from(seed):
    """One program after the other, until somebody ends the process."""
    while True:
        print(f"seed {seed}", flush=True)
        try:
            faults = faults_of(seed)
        except Exception as error:
            faults = [f"{type(error).__name__}: {error}"]
        for fault in faults:
            print(f"fault {fault!r}", flush=True)
        seed += 1


if __name__ == "__main__":
    sys.exit(main())
