# SPDX-License-Identifier: GPL-3.0-or-later
"""Hairs as rows of SHAPE: curves through their keys, taken apart into pieces that are nearly straight."""

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

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
    spans = _spans(keys, counts)
    points = np.concatenate([keys, np.maximum(radii, 0.0)[:, None]], axis=1).astype(np.float64)
    corners = [points[at] for at in (spans.before, spans.start, spans.end, spans.after)]
    coefficients = _catmull_rom(*corners) if is_smooth else _straight(*corners)
    pieces = _pieces(*coefficients)
    span = np.repeat(np.arange(len(pieces)), pieces)
    number = np.arange(len(span)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    t, t_end = number / pieces[span], (number + 1) / pieces[span]

    rows = _shapes([c[span] for c in coefficients], t, t_end)
    if not is_smooth:  # cut halfway between both directions
        before, step, after = (_unit((end - start)[span, :3]) for start, end in pairwise(corners))
        rows["v"], rows["w"] = _unit(before + step, rows["u"]), _unit(step + after, rows["u"])

    told = np.zeros(len(span), STRAND)
    whole = np.maximum(spans.length[span], 1e-30)
    for field, at in (("start", t), ("end", t_end)):
        told[field] = (spans.walked[span] + at * spans.step[span]) / whole
    told["length"] = spans.length[span]
    for field, what, values, size in (
        ("random", "random numbers", randoms, ()),
        ("uv", "UV coordinates", uvs, (2,)),
        ("generated", "generated coordinates", generated, (3,)),
    ):
        if values is not None:
            values = checks.array(name, f"{what} of hairs", values, np.float32, len(counts), *size)
            told[field] = values[spans.hair[span]]

    at_pieces = {}
    for kind, values in (attributes or {}).items():
        own = checks.four_floats(name, kind, values, len(keys))
        first, last = own[spans.start[span]], own[spans.end[span]]
        at_pieces[kind] = np.zeros((len(span), 3, 4), np.float32)
        for corner, at in enumerate((t, t_end)):
            at_pieces[kind][:, corner] = first + at[:, None] * (last - first)

    seen = rows["u"].any(axis=1) & ((rows["radius"] > 0.0) | (rows["radius_end"] > 0.0))
    rows["strand"][seen] = np.arange(seen.sum())
    at_pieces = {kind: values[seen] for kind, values in at_pieces.items()}
    return Strands(name, rows[seen], told[seen], at_pieces, generated is not None)


class _Spans(NamedTuple):
    """From each key of a hair to its next one: (s,) of each."""

    before: np.ndarray  # number of the key before; at the hair's root `start` itself
    start: np.ndarray
    end: np.ndarray
    after: np.ndarray  # at its tip `end` itself
    hair: np.ndarray
    walked: np.ndarray  # metres from the root to `start` ...
    step: np.ndarray  # ... and on to `end`, from key to key
    length: np.ndarray  # of the whole hair


def _spans(keys, counts):
    first = np.repeat(np.cumsum(counts) - counts, counts)
    last = first + np.repeat(counts, counts) - 1
    start = np.flatnonzero(np.arange(len(keys)) < last)
    steps = np.zeros(len(keys))
    steps[start + 1] = np.linalg.norm(np.diff(keys.astype(np.float64), axis=0), axis=1)[start]
    walked = np.cumsum(steps)
    walked -= walked[first]
    before, after = np.maximum(start - 1, first[start]), np.minimum(start + 2, last[start])
    hair = np.repeat(np.arange(len(counts)), counts)[start]
    return _Spans(before, start, start + 1, after, hair, walked[start], steps[start + 1], walked[last[start]])


def _catmull_rom(p0, p1, p2, p3):
    """The curve from p1 to p2 as coefficients of 1, t, t^2 and t^3."""
    return p1, 0.5 * (p2 - p0), p0 - 2.5 * p1 + 2.0 * p2 - 0.5 * p3, 0.5 * (p3 - p0) + 1.5 * (p1 - p2)


def _straight(p0, p1, p2, p3):
    return p1, p2 - p1, np.zeros_like(p1), np.zeros_like(p1)


def _shapes(coefficients, t, t_end):
    """Rows of SHAPE from `t` to `t_end` of curves of places and radii, by their coefficients."""
    a, b, c, d = coefficients
    ends = []
    for at in (t[:, None], t_end[:, None]):
        point, along = a + at * (b + at * (c + at * d)), b + at * (2.0 * c + 3.0 * at * d)
        ends.append((point[:, :3], np.maximum(point[:, 3], 0.0), along[:, :3]))
    (p, radius, v), (q, radius_end, w) = ends
    rows = np.zeros(len(t), SHAPE)
    rows["kind"], rows["instance"], rows["light"] = ShapeKind.STRAND, -1, -1
    rows["p"], rows["u"], rows["radius"], rows["radius_end"] = p, q - p, radius, radius_end
    rows["v"], rows["w"] = _unit(v, q - p), _unit(w, q - p)
    return rows


def _pieces(a, b, c, d):
    """How many pieces each curve needs: n of them are off by the second derivative / (8 n^2)."""
    bend = np.maximum(np.linalg.norm(2.0 * c[:, :3], axis=1), np.linalg.norm((2.0 * c + 6.0 * d)[:, :3], axis=1))
    end = a + b + c + d
    chord = np.linalg.norm((end - a)[:, :3], axis=1)
    bound = np.maximum(OFF_BY_RADIUS * np.maximum(a[:, 3], end[:, 3]), OFF_BY_LENGTH * chord)
    return np.clip(np.ceil(np.sqrt(bend / (8.0 * np.maximum(bound, 1e-30)))), 1, MOST_PIECES).astype(np.int64)


def _unit(along, otherwise=0.0):
    size = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.where(size > 0.0, along, otherwise)
    return along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-30)
