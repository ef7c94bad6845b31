# SPDX-License-Identifier: GPL-3.0-or-later
"""What a render is asked for: a NamedTuple of numbers in Python, a row of SETTINGS in kernels.

They get it as an argument, as a global of a module would be frozen when a kernel is compiled.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np

UNIFORM_SAMPLES = 16  # what each pixel gets before adaptive sampling begins


class IntegratorKind(IntEnum):
    BRUTE_FORCE = 0  # scatters by the material alone; finds lights by luck
    MIXTURE = 1  # one direction a bounce, by the material or towards chosen targets; finds lights by running into them
    PATH = 2  # light sampling and scattering, weighted by MIS


class SamplerKind(IntEnum):
    SOBOL = 0  # Owen-scrambled Sobol points, the error as blue noise over the pixels
    RANDOM = 1  # independent random numbers, to compare with


class FilterKind(IntEnum):
    BOX = 0
    GAUSSIAN = 1
    BLACKMAN_HARRIS = 2


class Settings(NamedTuple):
    """Defaults are those of Cycles where it has the same setting, so that pictures can be compared."""

    width: int = 512  # of the whole frame, in pixels
    height: int = 512
    crop_x: int = 0  # the part of the frame that is rendered: the film's lower left pixel and size
    crop_y: int = 0
    crop_width: int = 512
    crop_height: int = 512
    samples: int = 128  # of a pixel on average; of each pixel unless `adaptive`
    seed: int = 0
    sampler: int = SamplerKind.SOBOL
    adaptive: int = 1  # 1: more samples for pixels with more noise
    noise_target: float = 0.0  # 0: off; else the relative error of the picture at which it is good enough
    integrator: int = IntegratorKind.PATH
    guiding: int = 1  # 1: paths learn where light comes from, if that pays; PATH only
    max_bounces: int = 12
    diffuse_bounces: int = 4
    glossy_bounces: int = 4
    transmission_bounces: int = 12
    transparent_bounces: int = 8
    volume_bounces: int = 0
    min_bounces: int = 3  # before Russian roulette may end a path
    reflective_caustics: int = 1
    refractive_caustics: int = 1
    clamp_direct: float = 0.0  # 0: off; else the largest radiance that one sample may bring
    clamp_indirect: float = 0.0
    filter_kind: int = FilterKind.BLACKMAN_HARRIS
    filter_width: float = 1.5  # in pixels
    share_samples: int = 1  # 1: a sample counts for all pixels whose filter reaches it; 0: for one, as denoisers want
    transparent_background: int = 0  # 1: camera rays that miss leave alpha 0
    exposure: float = 1.0

    def row(self):
        """The same as a row of SETTINGS, for kernels: one pointer, where a tuple would be 29 arguments of each call.

        Of the seed the lower 32 bits count, so any integer will do.
        """
        return np.array([tuple(self._replace(seed=self.seed % 2**32))], SETTINGS)[0]


TYPES = {"seed": "u4", int: "i4", float: "f4"}
SETTINGS = np.dtype([(name, TYPES.get(name, TYPES[kind])) for name, kind in Settings.__annotations__.items()])
