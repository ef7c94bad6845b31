# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings for the artist, by the name of what they are about."""


class Report:
    """Collects what is rendered otherwise than asked. The same warning is kept once, however often it comes up."""

    def __init__(self):
        self.warnings = []
        self._seen = set()

    def warn(self, owner, text):
        """`owner`: name of the object, material, light or world; `text`: what is wrong and what is done instead."""
        message = f"{owner}: {text}"
        if message not in self._seen:
            self._seen.add(message)
            self.warnings.append(message)
