# SPDX-License-Identifier: GPL-3.0-or-later
"""IES files (ANSI/IES LM-63): how brightly a luminaire shines in which direction."""

from pathlib import Path

import bpy
import numpy as np

LARGEST_FILE = 1 << 24  # bytes
MOST_ANGLES = 1 << 14
# Watts of a lamp that shines evenly with a candela: 4 pi over the efficacy of daylight, 177.83 lm / W (as in Cycles)
WATTS_PER_CANDELA = 0.0706650768394


class IesError(ValueError):
    """Why a file cannot be read."""


def text_of(node):
    """Text of an IES Texture node: packed in the file, or beside it."""
    if node.mode == "INTERNAL":
        if node.ies is None:
            raise IesError("no IES text is chosen")
        return node.ies.as_string()
    if not node.filepath:
        raise IesError("no IES file is chosen")
    path = Path(bpy.path.abspath(node.filepath, library=node.id_data.library))
    if not path.is_file() or path.stat().st_size > LARGEST_FILE:
        raise IesError(f"the IES file {path.name} cannot be read")
    return path.read_text(encoding="latin-1")


def table(text):
    """Rows for horizontal angles, columns for vertical ones; the first of each holds angles: float32.

    See `engine_core.texture.ies`. Intensities are in watts of a lamp that shines so everywhere.
    """
    numbers = _numbers(text)
    _, _, factor, columns, rows, kind = (next(numbers) for _ in range(6))
    columns, rows = int(columns), int(rows)
    if kind not in (1, 2):
        raise IesError("photometry of type A is not known")
    if not (1 <= columns <= MOST_ANGLES and 1 <= rows <= MOST_ANGLES):
        raise IesError("the IES file has no angles, or too many")
    for _ in range(4):
        next(numbers)  # unit and size of the luminaire
    factor *= next(numbers) * next(numbers)  # ballasts
    next(numbers)  # electric power
    vertical = np.array([next(numbers) for _ in range(columns)])
    horizontal = np.array([next(numbers) for _ in range(rows)])
    values = np.array([next(numbers) for _ in range(rows * columns)]).reshape(rows, columns)
    angles = _type_b(horizontal, vertical, values) if kind == 2 else _type_c(horizontal, vertical, values)
    horizontal, vertical, values = angles
    result = np.zeros((len(horizontal) + 1, len(vertical) + 1), np.float32)
    result[1:, 0], result[0, 1:] = np.radians(horizontal), np.radians(vertical)
    result[1:, 1:] = values * (factor * WATTS_PER_CANDELA)
    return result


def _numbers(text):
    """The numbers behind TILT, those of the tilt itself left out."""
    start = text.find("\nTILT=")
    if start < 0:
        raise IesError("this is no IES file: it has no line TILT=")
    includes, rest = text[start:].startswith("\nTILT=INCLUDE"), text[start + 1 :].partition("\n")[2]
    words = iter(rest.replace(",", " ").split())
    if includes:
        next(words, None)
        for _ in range(2 * int(float(next(words, "0")))):
            next(words, None)
    for word in words:
        try:
            yield float(word)
        except ValueError:
            break
    raise IesError("the IES file ends too early, or has words where numbers should be")


def _type_c(horizontal, vertical, values):
    """About the vertical axis. Quarters and halves of the full circle are mirrored, as far as they are symmetrical."""
    if horizontal[0] == 90.0:
        horizontal = horizontal - 90.0
    if len(horizontal) == 1:
        horizontal, values = np.append(horizontal, 360.0), values[[0, 0]]
    for end in (90.0, 180.0):
        if horizontal[-1] == end:
            horizontal = np.append(horizontal, 2.0 * end - horizontal[-2::-1])
            values = np.concatenate([values, values[-2::-1]])
    if horizontal[-1] != 360.0:  # some leave out what is the same as at 0 degrees
        gap = 360.0 - horizontal[-1]
        if gap not in (horizontal[-1] - horizontal[-2], horizontal[1] - horizontal[0]):
            raise IesError("the IES file does not go around")
        horizontal, values = np.append(horizontal, 360.0), np.concatenate([values, values[:1]])
    if horizontal[0] != 0.0 or not (vertical[0] == 0.0 or (vertical[0] == 90.0 and vertical[-1] == 180.0)):
        raise IesError("the angles of the IES file begin nowhere near 0 or 90 degrees")
    return horizontal, vertical, values


def _type_b(horizontal, vertical, values):
    """About a horizontal axis: what it calls vertical goes around."""
    horizontal, vertical, values = vertical, horizontal, values.T
    if horizontal[-1] != 90.0 or vertical[-1] != 90.0:
        raise IesError("the angles of the IES file do not end at 90 degrees")
    if horizontal[0] == 0.0:
        horizontal = np.concatenate([-horizontal[:0:-1], horizontal])
        values = np.concatenate([values[:0:-1], values])
    horizontal, values = np.append(horizontal + 90.0, 360.0), np.concatenate([values, values[:1]])
    if vertical[0] == 0.0:
        vertical = np.concatenate([-vertical[:0:-1], vertical])
        values = np.concatenate([values[:, :0:-1], values], axis=1)
    return horizontal, vertical + 90.0, values
