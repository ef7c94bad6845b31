# SPDX-License-Identifier: GPL-3.0-or-later
"""Hairs as rows of SHAPE: curves through their keys, taken apart into pieces that are nearly straight."""

from dataclasses import dataclass

import numpy as np

from ..program_tables import STRAND
from ..tables import SHAPE, ShapeKind
from . import checks
from .shapes import Shapes

MOST_PIECES = 8  # between two keys
# How far a piece may be from the curve, as a share of its radius, and of its length, whichever is more
OFF_BY_RADIUS, OFF_BY_LENGTH = 0.25, 0.002


@dataclass
class Strands(Shapes):
    """Pieces of hairs in object space, and what programs ask of them."""

    strands: np.ndarray  # STRAND, row for row
    attributes: dict  # name: float32 (n, 3, 4), the first two at start and end of each piece
    has_generated: bool

    @property
    def texture_space(self):
        """Generated coordinates are each hair's own, or positions, as in Cycles."""
        return np.full(3, 0.0 if self.has_generated else 1.0), np.zeros(3)


def strands(name, keys, radii, counts, randoms=None, uvs=None, generated=None, attributes=None, is_smooth=True):
    """Curves through `keys`, (n, 3), as thick as `radii`, (n,); hair i has the next counts[i] keys.

    `randoms`, (m,): a number of each hair, 0 to 1. `uvs`, (m, 2), and `generated`, (m, 3): where it grows.
    `attributes`: {name: values at the keys, (n, up to 4)}, for shader programs. Curves of Catmull and Rom, or without
    `is_smooth` straight lines.
    """
    counts = np.asarray(counts, np.int64)
    keys = checks.positions(name, "keys of hairs", keys)
    radii = checks.array(name, "radii of hairs", radii, np.float32, len(keys))
    if counts.sum() != len(keys) or (counts < 0).any():
        raise checks.SceneError(f"{name}: hairs have {counts.sum()} keys, but there are {len(keys)}")
    curve = np.repeat(np.arange(len(counts)), counts)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    last = first + np.repeat(counts, counts) - 1
    start = np.flatnonzero(np.arange(len(keys)) < last)  # each span goes from this key to the next
    steps = np.zeros(len(keys))
    steps[start + 1] = np.linalg.norm(np.diff(keys.astype(np.float64), axis=0), axis=1)[start]
    walked = np.cumsum(steps)
    walked -= walked[first]
    length = walked[last]

    four = np.concatenate([keys, np.maximum(radii, 0.0)[:, None]], axis=1).astype(np.float64)
    p0, p1, p2, p3 = (
        four[np.maximum(start - 1, first[start])],
        four[start],
        four[start + 1],
        four[np.minimum(start + 2, last[start])],
    )
    if is_smooth:
        a, b, c = 0.5 * (p2 - p0), p0 - 2.5 * p1 + 2.0 * p2 - 0.5 * p3, 0.5 * (p3 - p0) + 1.5 * (p1 - p2)
    else:
        a, b, c = p2 - p1, np.zeros_like(p1), np.zeros_like(p1)
    pieces = _pieces(p1, p2, b, c)
    span = np.repeat(np.arange(len(start)), pieces)
    number = np.arange(len(span)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    ends = []
    for t in (number / pieces[span], (number + 1) / pieces[span]):
        t = t[:, None]
        place = p1[span] + t * (a[span] + t * (b[span] + t * c[span]))
        along = (a[span] + t * (2.0 * b[span] + 3.0 * t * c[span]))[:, :3]
        ends.append((place[:, :3], np.maximum(place[:, 3], 0.0), along, t[:, 0]))
    rows, told = np.zeros(len(span), SHAPE), np.zeros(len(span), STRAND)
    (p, r, v, t), (q, r_end, w, t_end) = ends
    rows["kind"], rows["instance"], rows["light"] = ShapeKind.STRAND, -1, -1
    rows["p"], rows["u"], rows["radius"], rows["radius_end"] = p, q - p, r, r_end
    if not is_smooth:  # cut halfway between both directions
        before, step, after = (_unit((end - one)[:, :3]) for one, end in ((p0, p1), (p1, p2), (p2, p3)))
        v, w = before + step, step + after
    rows["v"], rows["w"] = _unit(v, q - p), _unit(w, q - p)
    key = start[span]
    whole = np.maximum(length[key], 1e-30)
    for field, at in (("start", t), ("end", t_end)):
        told[field] = (walked[key] + at * (walked[key + 1] - walked[key])) / whole
    told["length"] = length[key]
    for field, what, values, size in (
        ("random", "random numbers", randoms, ()),
        ("uv", "UV coordinates", uvs, (2,)),
        ("generated", "generated coordinates", generated, (3,)),
    ):
        if values is not None:
            told[field] = checks.array(name, f"{what} of hairs", values, np.float32, len(counts), *size)[curve[key]]
    at_pieces = {}
    for kind, values in (attributes or {}).items():
        own = checks.four_floats(name, kind, values, len(keys))
        at_pieces[kind] = np.zeros((len(span), 3, 4), np.float32)
        for corner, at in enumerate((t, t_end)):
            at_pieces[kind][:, corner] = own[key] + at[:, None] * (own[key + 1] - own[key])
    seen = rows["u"].any(axis=1) & ((r > 0.0) | (r_end > 0.0))
    rows, told = rows[seen], told[seen]
    rows["strand"] = np.arange(len(rows))
    at_pieces = {kind: values[seen] for kind, values in at_pieces.items()}
    return Strands(name, rows, told, at_pieces, generated is not None)


def _pieces(p1, p2, b, c):
    """How many pieces each span needs: n of them are off by the second derivative / (8 n^2)."""
    bend = np.maximum(np.linalg.norm(2.0 * b[:, :3], axis=1), np.linalg.norm((2.0 * b + 6.0 * c)[:, :3], axis=1))
    chord = np.linalg.norm((p2 - p1)[:, :3], axis=1)
    bound = np.maximum(OFF_BY_RADIUS * np.maximum(p1[:, 3], p2[:, 3]), OFF_BY_LENGTH * chord)
    return np.clip(np.ceil(np.sqrt(bend / (8.0 * np.maximum(bound, 1e-30)))), 1, MOST_PIECES).astype(np.int64)


def _unit(along, otherwise=0.0):
    size = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.where(size > 0.0, along, otherwise)
    return along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-30)
