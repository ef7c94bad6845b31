# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lines of log out of the way of ours, a progress bar, and an end that does not hang."""

import contextlib
import os
import sys
import tempfile
import traceback

from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn


class QuietBlender:
    """`terminal` is a file that still goes where stdout went."""

    def __init__(self, terminal, log):
        self.terminal, self._log = terminal, log

    def warnings(self):
        """What the engines warned of, each line once."""
        sys.stdout.flush()
        self._log.seek(0)
        lines = [line.strip() for line in self._log.read().decode(errors="replace").splitlines()]
        return list(dict.fromkeys(line for line in lines if line.startswith("Warning: ")))


@contextlib.contextmanager
def quiet_blender():
    """Catch what this process writes to stdout, in Python and in C, while the body runs. Gives a QuietBlender."""
    sys.stdout.flush()
    original = os.dup(1)
    with tempfile.TemporaryFile() as log, open(os.dup(original), "w", encoding="utf-8") as terminal:
        os.dup2(log.fileno(), 1)
        try:
            yield QuietBlender(terminal, log)
        finally:
            sys.stdout.flush()
            terminal.flush()
            os.dup2(original, 1)
            os.close(original)


@contextlib.contextmanager
def progress_bar(console):
    """Gives a function of a fraction and a text."""
    columns = (TextColumn("{task.description:32}"), BarColumn(), TextColumn("{task.percentage:3.0f} %"))
    # drawn when told to, not by a thread: a render may keep the GIL for seconds
    with Progress(*columns, TimeElapsedColumn(), console=console, auto_refresh=False, transient=True) as progress:
        task = progress.add_task("", total=1.0)
        yield lambda fraction, text: progress.update(task, completed=fraction, description=text, refresh=True)


def leave(main):
    """Run a command's `main`, and end the process with what it returns, or 1 after a failure.

    Not by sys.exit: Blender 4.5 as a module can hang when a process ends.
    """
    code = 1
    try:
        code = main() or 0
    except SystemExit as stop:
        code = stop.code
    except KeyboardInterrupt:
        pass
    except Exception:
        traceback.print_exc()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
