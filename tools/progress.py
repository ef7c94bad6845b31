# SPDX-License-Identifier: GPL-3.0-or-later
"""How far something is, in the terminal."""

import shutil
import sys
import time

from .environment import say


class Progress:
    """One line that is written over on a terminal; elsewhere a line now and then."""

    def __init__(self):
        self.start = self.last = time.monotonic()
        self.is_terminal = sys.stdout.isatty()
        self.is_shown = False

    def elapsed(self):
        return time.monotonic() - self.start

    def show(self, fraction, text):
        now = time.monotonic()
        if now - self.last < (0.1 if self.is_terminal else 5.0):
            return
        self.last = now
        line = f"{100 * fraction:3.0f} %  {text}" if fraction is not None else f"       {text}"
        if not self.is_terminal:
            return say(line)
        width = shutil.get_terminal_size().columns - 1
        sys.stdout.write("\r" + line[:width].ljust(width))
        sys.stdout.flush()
        self.is_shown = True

    def clear(self):
        if self.is_shown:
            width = shutil.get_terminal_size().columns - 1
            sys.stdout.write("\r" + " " * width + "\r")
            self.is_shown = False
