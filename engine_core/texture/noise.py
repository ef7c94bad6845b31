# SPDX-License-Identifier: GPL-3.0-or-later
"""The Noise texture: octaves of gradient noise, put together in one of five ways, in one to four dimensions.

    sample = noise(p, w, dimensions, kind, detail, roughness, lacunarity, offset, gain, distortion, normalize, colored)

What each parameter means is what Blender's node means by it. Musgrave's fractals (Ebert et al., "Texturing and
Modeling", chapter 16) share one loop, as they differ in what they do with an octave and not in how they come by it.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import BLACK, Vec3, lerp
from .perlin import perlin, perlin_in_space

ZERO, ONE = np.float32(0.0), np.float32(1.0)
FAINT = np.float32(0.001)  # a hybrid multifractal ends where its octaves would weigh less


class NoiseKind(IntEnum):
    """How octaves are put together; names and numbers are Blender's."""

    MULTIFRACTAL = 0  # multiplied
    FBM = 1  # added
    HYBRID_MULTIFRACTAL = 2  # added, the finer ones less where the coarser ones are low
    RIDGED_MULTIFRACTAL = 3  # as hybrid, with a sharp ridge where the noise is 0
    HETERO_TERRAIN = 4  # added, in proportion to the sum so far


class NoiseSample(NamedTuple):
    value: np.float32
    color: Vec3  # red is `value`; black if it was not asked for


# Where to look for noise that has nothing to do with the noise here: [seed, axis], the hash of both, 100 to 200.
# In one dimension the hash is of the seed alone.
OFFSETS = np.array(
    [
        (186.0312805, 114.9559555, 154.4475097, 142.5049133),
        (199.8399963, 162.2926025, 154.0482330, 142.2676086),
        (111.6338424, 157.3693847, 199.0881042, 178.4361267),
        (165.4452819, 162.7682189, 193.4084167, 145.2555084),
        (155.5809173, 177.1546325, 138.1400299, 180.1857299),
        (188.8537902, 132.6776885, 162.0521545, 185.2681579),
    ],
    np.float32,
)
OFFSETS_1D = np.array([158.2425842, 114.8360519, 188.4886932], np.float32)


@kernel
def noise(p, w, dimensions, kind, detail, roughness, lacunarity, offset, gain, distortion, normalize, colored):
    """The node, at a point that is scaled already. In one dimension `w` counts, in four p and `w`, else p.

    `kind` is a NoiseKind. `detail` is the number of octaves after the first, up to 15; a fraction of it fades the last
    one in. `normalize` maps fBM from -1 ... 1 to 0 ... 1. `colored`: three values instead of one, at thrice the cost.
    """
    # Integers of one size, so that nothing below is compiled for another one too.
    dimensions, kind, normalize = np.int64(dimensions), np.int64(kind), normalize != 0
    detail, roughness = min(max(detail, 0.0), 15.0), max(roughness, 0.0)
    if dimensions == 3 and kind == NoiseKind.FBM and distortion == 0.0 and not colored:
        return NoiseSample(fbm_in_space(p, detail, roughness, lacunarity, normalize), BLACK)
    if dimensions == 1:
        p, w = Vec3(w, ZERO, ZERO), ZERO
    elif dimensions == 2:
        p, w = Vec3(p.x, p.y, ZERO), ZERO
    elif dimensions == 3:
        w = ZERO
    if distortion != 0.0:
        push, push_w = BLACK, ZERO
        for axis in range(dimensions):
            t = perlin(p + _offset(axis, dimensions), w + _offset_w(axis, dimensions), dimensions) * distortion
            push = push + Vec3(t if axis == 0 else ZERO, t if axis == 1 else ZERO, t if axis == 2 else ZERO)
            push_w += t if axis == 3 else ZERO
        p, w = p + push, w + push_w
    value, color = ZERO, BLACK
    for channel in range(3 if colored else 1):
        q, q_w = p, w
        if channel > 0:
            seed = dimensions + channel - 1
            q, q_w = p + _offset(seed, dimensions), w + _offset_w(seed, dimensions)
        t = fractal(q, q_w, dimensions, kind, detail, roughness, lacunarity, offset, gain, normalize)
        if channel == 0:
            value = t
        if colored:
            color = color + Vec3(t if channel == 0 else ZERO, t if channel == 1 else ZERO, t if channel == 2 else ZERO)
    return NoiseSample(value, color)


@kernel
def _offset(seed, dimensions):
    if dimensions == 1:
        return Vec3(OFFSETS_1D[seed], ZERO, ZERO)
    return Vec3(OFFSETS[seed, 0], OFFSETS[seed, 1], OFFSETS[seed, 2] if dimensions > 2 else ZERO)


@kernel
def _offset_w(seed, dimensions):
    return OFFSETS[seed, 3] if dimensions == 4 else ZERO


@kernel
def fbm_in_space(p, detail, roughness, lacunarity, normalize):
    """What `fractal` gives of fBM in three dimensions, sooner: nearly all noise is such."""
    octaves, last = int(detail) + 1, detail - np.floor(detail)
    value, total, amplitude, scale, octave = ZERO, ZERO, ONE, ONE, 0
    while True:
        t = amplitude * perlin_in_space(p * scale)
        if octave == octaves:
            break
        value, total = value + t, total + amplitude
        octave += 1
        if octave == octaves and last == 0.0:
            return 0.5 * value / total + 0.5 if normalize else value
        amplitude, scale = amplitude * roughness, scale * lacunarity
    if normalize:
        return lerp(0.5 * value / total + 0.5, 0.5 * (value + t) / (total + amplitude) + 0.5, last)
    return value + last * t


@kernel
def fractal(p, w, dimensions, kind, detail, roughness, lacunarity, offset, gain, normalize):
    """Octaves of `perlin` at a point (see there) as a NoiseKind wants them."""
    octaves = int(detail) + 1
    last = detail - np.floor(detail)  # the share of one octave more
    value = ONE if kind == NoiseKind.MULTIFRACTAL else ZERO
    amplitude, total, scale, weight = ONE, ZERO, ONE, ONE
    q, q_w = p, w
    for octave in range(octaves + (1 if last > 0.0 and kind != NoiseKind.RIDGED_MULTIFRACTAL else 0)):
        share = ONE if octave < octaves else last
        t = perlin(q, q_w, dimensions)
        if kind == NoiseKind.FBM:
            added = value + amplitude * t
            if octave == octaves and normalize:  # both sums, each over its own range
                return lerp(0.5 * value / total + 0.5, 0.5 * added / (total + amplitude) + 0.5, share)
            value = value + share * (added - value)
            total += amplitude
        elif kind == NoiseKind.MULTIFRACTAL:
            value *= share * amplitude * t + 1.0
        elif kind == NoiseKind.HETERO_TERRAIN:
            t += offset
            value += share * t * amplitude * value if octave > 0 else t
        elif kind == NoiseKind.HYBRID_MULTIFRACTAL:
            if weight <= FAINT:
                break
            weight = min(weight, 1.0)
            signal = (t + offset) * amplitude
            value += share * weight * signal
            weight *= gain * signal
        else:
            ridge = offset - abs(t)
            signal = ridge * ridge * weight
            value += signal * amplitude
            weight = min(max(signal * gain, 0.0), 1.0)
        amplitude *= roughness
        scale *= lacunarity
        # The same but for rounding, which thousands of cells away is a noise of its own.
        if kind == NoiseKind.FBM:
            q, q_w = p * scale, w * scale
        else:
            q, q_w = q * lacunarity, q_w * lacunarity
    if kind == NoiseKind.FBM and normalize:
        return 0.5 * value / total + 0.5
    return value


@kernel
def turbulence(p, octaves):
    """Perlin's turbulence, 0 to about 1: the sum of |noise| over octaves, each twice as fine and half as strong."""
    value, amplitude = ZERO, ONE
    for _ in range(octaves):
        value += amplitude * abs(perlin(p, ZERO, 3))
        p, amplitude = p * 2.0, 0.5 * amplitude
    return value
