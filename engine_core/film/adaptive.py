# SPDX-License-Identifier: GPL-3.0-or-later
"""How many samples each pixel gets: more where they matter.

With a given number of samples the sum of variance / n over pixels is least when n is proportional to the standard
deviation (Neyman 1934). Of that one has only an estimate, which is too low where light is rare and was missed so far,
and too high where it was met; so n follows a smaller power of it. And n is the next power of two, as Sobol points are
spread best then; that costs 2 %.
"""

import numpy as np

TRUST = 0.6  # the power: measured best in scenes from smooth to caustics, of 0.4, 0.6 and 1
GOLDEN = 0.6180339887498949


def distribute(importance, samples, budget, most):
    """int32 (height, width): samples that each pixel shall have, a power of two up to `most` or as many as it has.

    Parameters
    ----------
    importance : (height, width), standard deviation of a sample
    samples : (height, width), what pixels have already: nothing is taken away
    budget : samples of a pixel on average, which is not exceeded
    """
    # pixels of equal importance shall not all take the step at once
    tie_breaker = 1e-3 * (np.arange(importance.size) * GOLDEN % 1.0).reshape(importance.shape)
    level = TRUST * np.log2(np.maximum(importance, 1e-12)) + tie_breaker

    def targets(shift):
        return np.maximum(np.exp2(np.clip(np.round(level + shift), 0.0, np.log2(most))), samples)

    low, high = -64.0, 64.0
    for _ in range(24):
        shift = 0.5 * (low + high)
        if targets(shift).mean() > budget:
            high = shift
        else:
            low = shift
    return targets(low).astype(np.int32)
