# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks at the border: what a caller hands in is right, or refused with the culprit's name. Kernels trust it."""

import numpy as np

FLAT = 1e-9  # volume of what a transform makes of the unit cube, its edges made unit: below it, it has none
LARGEST = 1e15  # coordinates beyond this overflow float32 once squared


class SceneError(ValueError):
    """Input that cannot be rendered; the message names the object and what is wrong with it."""


def array(name, what, value, dtype, *shape):
    """`value` as a contiguous array of `dtype` and `shape` (None: any length), all numbers finite."""
    try:
        result = np.ascontiguousarray(value, dtype)
    except (TypeError, ValueError) as error:
        raise SceneError(f"{name}: {what} cannot be read as numbers ({error})") from None
    expected = tuple("n" if s is None else s for s in shape)
    if result.ndim != len(shape) or any(s not in (None, n) for s, n in zip(shape, result.shape, strict=True)):
        raise SceneError(f"{name}: {what}: the shape is {result.shape}, expected {expected}")
    if result.dtype.kind == "f" and not np.isfinite(result).all():
        count = int((~np.isfinite(result)).sum())
        raise SceneError(f"{name}: {what}: {count} of {result.size} numbers are not finite")
    return result


def positions(name, what, value):
    """Points, float32 (n, 3), that float32 arithmetic can carry."""
    result = array(name, what, value, np.float32, None, 3)
    if result.size and max(result.max(), -result.min()) > LARGEST:
        raise SceneError(f"{name}: {what}: beyond {LARGEST:g} m")
    return result


def indices(name, what, value, count, *shape):
    """int32 numbers from 0 to count - 1."""
    result = array(name, what, value, np.int32, *shape)
    if result.size and (result.min() < 0 or result.max() >= count):
        raise SceneError(f"{name}: {what}: from {result.min()} to {result.max()}, there are {count}")
    return result


def transform(name, value):
    """A 4 x 4 matrix as float64 (3, 4), and whether it can be inverted."""
    matrix = array(name, "transform", value, np.float64, 4, 4)[:3]
    if max(matrix.max(), -matrix.min()) > LARGEST:
        raise SceneError(f"{name}: transform: beyond {LARGEST:g} m")
    scale = np.linalg.norm(matrix[:, :3], axis=0)
    if not scale.all():
        return matrix, False
    # the volume of the unit cube with the axes' lengths taken out: 0 when the axes lie in a plane
    return matrix, abs(np.linalg.det(matrix[:, :3] / scale)) > FLAT


def transforms(names, values):
    """As `transform`, for all of a scene at a time: float64 (n, 3, 4), and which can be inverted, bool (n,)."""
    try:
        matrices = np.array(values, np.float64).reshape(len(values), 4, 4)[:, :3]
    except (TypeError, ValueError):
        matrices = None
    if matrices is None or not (np.abs(matrices) <= LARGEST).all():  # not by numbers that are none, either
        for name, value in zip(names, values, strict=True):
            transform(name, value)  # raises
    scale = np.linalg.norm(matrices[..., :3], axis=1)
    flat = ~scale.all(axis=1)
    scale[flat] = 1.0
    return matrices, ~flat & (np.abs(np.linalg.det(matrices[..., :3] / scale[:, None])) > FLAT)


def color(name, what, value):
    """Three finite, non-negative numbers as float64; negative ones are cut off at 0."""
    return np.maximum(array(name, what, value, np.float64, 3), 0.0)


def number(name, what, value, low=-np.inf, high=np.inf):
    """A finite number between `low` and `high`."""
    result = float(value)
    if not np.isfinite(result) or not low <= result <= high:
        raise SceneError(f"{name}: {what} is {result:g}, allowed is {low:g} to {high:g}")
    return result


def four_floats(name, key, values, *shape):
    """Values of up to four floats of each owner, `shape`, as float32 (*shape, 4): alpha is 1 where there is none."""
    values = np.asarray(values, np.float32)
    four = np.zeros((*shape, 4), np.float32)
    four[..., 3] = 1.0
    four[..., : values.shape[-1]] = array(name, key, values, np.float32, *shape, values.shape[-1])
    return four
