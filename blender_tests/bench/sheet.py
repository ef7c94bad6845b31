# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures side by side with their labels, and maps of how two pictures differ."""

from typing import NamedTuple

import flip_evaluator
import numpy as np
from PIL import Image, ImageDraw, ImageFont

REC709 = (0.2126, 0.7152, 0.0722)
PAPER, INK, GREY = (250, 250, 248), (20, 20, 20), (110, 110, 110)
NARROWEST, WIDEST = 360, 960  # of a panel, in pixels
BRIGHTER, DARKER = (0.80, 0.11, 0.09), (0.09, 0.28, 0.76)  # red and blue, as the eye orders them
STEPS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)  # where the colours of a difference may end


class Panel(NamedTuple):
    picture: np.ndarray  # 0 to 1 as shown, (h, w, 3), top row first
    title: str
    lines: tuple = ()  # of small print


def sheet(rows, title="", scale=None):
    """Panels in rows, all of one size: a PIL image. `scale`: of the panels; None: so that labels can be read."""
    height, width = rows[0][0].picture.shape[:2]
    if scale is None:
        scale = max(1, -(-NARROWEST // width)) if width < NARROWEST else min(1.0, WIDEST / width)
    width, height = round(width * scale), round(height * scale)
    gap, line, head = 12, 18, 34 if title else 0
    columns = max(len(row) for row in rows)
    label = 26 + line * max(len(panel.lines) for row in rows for panel in row)
    page = Image.new("RGB", (gap + columns * (width + gap), head + gap + len(rows) * (height + label + gap)), PAPER)
    draw, large, small = ImageDraw.Draw(page), ImageFont.load_default(17), ImageFont.load_default(13)
    if title:
        draw.text((gap, 12), title, INK, large)
    for i, row in enumerate(rows):
        y = head + gap + i * (height + label + gap)
        for j, panel in enumerate(row):
            x = gap + j * (width + gap)
            draw.text((x, y), panel.title, INK, ImageFont.load_default(15))
            for k, text in enumerate(panel.lines):
                draw.text((x, y + 22 + k * line), text, GREY, small)
            pixels = Image.fromarray((np.clip(panel.picture, 0, 1) * 255 + 0.5).astype(np.uint8))
            resample = Image.Resampling.NEAREST if scale >= 1 else Image.Resampling.BOX
            page.paste(pixels.resize((width, height), resample), (x, y + label))
    return page


def shown(path):
    """A saved picture as numbers from 0 to 1, (h, w, 3), top row first."""
    return np.asarray(Image.open(path).convert("RGB"), np.float32) / 255.0


def standard_view(picture):
    """Scene-linear radiance, bottom row first, as Blender's view transform Standard shows it, top row first."""
    x = np.clip(picture[::-1, :, :3], 0.0, 1.0)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-8) ** (1 / 2.4) - 0.055)  # IEC 61966-2-1


def difference_map(a, b):
    """(picture, scale): relative difference of luminance between scene-linear pictures, red where `a` is brighter.

    The full colour stands for `scale`. Where both are nearly black nothing is said.
    """
    x, y = (image[::-1, :, :3].astype(float) @ REC709 for image in (a, b))
    relative = (x - y) / np.maximum((x + y) / 2.0, 0.02 * y.mean() + 1e-9)
    wanted = np.quantile(np.abs(relative), 0.95)
    scale = next((step for step in STEPS if step >= wanted), STEPS[-1])
    strength = np.clip(relative / scale, -1.0, 1.0)[..., None]
    towards = np.where(strength > 0, BRIGHTER, DARKER)
    return 1.0 + np.abs(strength) * (towards - 1.0), scale


def flip(reference, test):
    """(map as a picture, mean): how different two shown pictures look at a usual distance, 0 to 1.

    Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images".
    """
    colored, mean, _ = flip_evaluator.evaluate(
        np.ascontiguousarray(reference, np.float32), np.ascontiguousarray(test, np.float32), "LDR"
    )
    return colored, float(mean)
