# SPDX-License-Identifier: GPL-3.0-or-later
"""The film on the host: making it, and reading pictures from its sums. Passes carry Cycles' names."""

import numpy as np

from ..film_tables import CONTROL, PIXEL, SHARE, Film
from ..guide_tables import LESSON
from .sharing import NEIGHBOURS, develop

NO_DEPTH = 1e10  # what the depth pass says where nothing was hit, as in Cycles


def make_film(width, height, lessons=None, shares_samples=False):
    """An empty film of `width` x `height` pixels. `lessons`: rows of LESSON, if paths leave any."""
    lessons = np.zeros(0, LESSON) if lessons is None else lessons
    try:
        shares = np.zeros(width * height * NEIGHBOURS if shares_samples else 0, SHARE)
        rows = np.zeros(width * height, PIXEL)
    except MemoryError as error:
        raise MemoryError(f"a picture of {width} x {height} pixels needs more memory than there is") from error
    film = Film(pixels=rows, shares=shares, control=np.zeros(1, CONTROL), lessons=lessons)
    film.width, film.height = width, height
    return film


def pixels(film, tile=None):
    """The pixels as a (height, width) recarray; of the `tile` (x, y, width, height) if given. Bottom row first."""
    grid = film.pixels.reshape(film.height, film.width)
    if tile is not None:
        x, y, width, height = tile
        grid = grid[y : y + height, x : x + width]
    return grid


def image(film, name, tile=None):
    """The pass `name` as float32 (height, width, channels), bottom row first.

    Colours are linear and premultiplied by alpha. Raises KeyError for a pass that there is not.
    """
    if name == "Combined" and len(film.shares) > 0:
        x, y, width, height = tile or (0, 0, film.width, film.height)
        picture = np.empty((height, width, 4), np.float32)
        develop(film, film.width, film.height, x, y, picture)
        return picture
    return PASSES[name][1](pixels(film, tile))


def _mean(field):
    def read(grid):
        return grid[field] / np.maximum(grid["samples"], 1)[..., None].astype(np.float32)

    return read


def _combined(grid):
    count = np.maximum(grid["samples"], 1)[..., None].astype(np.float32)
    return np.concatenate([grid["radiance"], grid["alpha"][..., None]], axis=-1) / count


def _direction(grid):
    n = _mean("normal")(grid)
    return n / np.maximum(np.linalg.norm(n, axis=-1, keepdims=True), 1e-12)


# name: (channels, how to read it)
PASSES = {
    "Combined": ("RGBA", _combined),
    "Depth": ("Z", lambda grid: np.ascontiguousarray(grid["depth"])[..., None]),
    "Position": ("XYZ", lambda grid: np.ascontiguousarray(grid["position"])),
    "Normal": ("XYZ", _direction),
    "Denoising Albedo": ("RGB", _mean("albedo")),
    "Denoising Normal": ("XYZ", _mean("normal")),
    "Debug Sample Count": ("X", lambda grid: grid["samples"][..., None].astype(np.float32)),
}
