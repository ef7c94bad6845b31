# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour of a glowing body."""

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import Vec3

# Piecewise fits of Planck's locus in linear Rec.709, luminance 1, as Cycles makes them: red and green are
# a / T + b T + c, blue is a cubic. Rows: temperatures from 800, 965, 1167, 1449, 1902, 3315 and 6365 K on.
RED = np.array(
    [
        (1.61919106e03, -2.05010916e-03, 5.02995757e00),
        (2.48845471e03, -1.11330907e-03, 3.22621544e00),
        (3.34143193e03, -4.86551192e-04, 1.76486769e00),
        (4.09461742e03, -1.27446582e-04, 7.25731635e-01),
        (4.67028036e03, 2.91258199e-05, 1.26703442e-01),
        (4.59509185e03, 2.87495649e-05, 1.50345020e-01),
        (3.78717450e03, 9.35907826e-06, 3.99075871e-01),
    ],
    np.float32,
)
GREEN = np.array(
    [
        (-4.88999748e02, 6.04330754e-04, -7.55807526e-02),
        (-7.55994277e02, 3.16730098e-04, 4.78306139e-01),
        (-1.02363977e03, 1.20223470e-04, 9.36662319e-01),
        (-1.26571316e03, 4.87340896e-06, 1.27054498e00),
        (-1.42529332e03, -4.01150431e-05, 1.43972784e00),
        (-1.17554822e03, -2.16378048e-05, 1.30408023e00),
        (-5.00799571e02, -4.59832026e-06, 1.09098763e00),
    ],
    np.float32,
)
BLUE = np.array(
    [
        (5.96945309e-11, -4.85742887e-08, -9.70622247e-05, -4.07936148e-03),
        (2.40430366e-11, 5.55021075e-08, -1.98503712e-04, 2.89312858e-02),
        (-1.40949732e-11, 1.89878968e-07, -3.56632824e-04, 9.10767778e-02),
        (-3.61460868e-11, 2.84822009e-07, -4.93211319e-04, 1.56723440e-01),
        (-1.97075738e-11, 1.75359352e-07, -2.50542825e-04, -2.22783266e-02),
        (-1.61997957e-13, -1.64216008e-08, 3.86216271e-04, -7.38077418e-01),
        (6.72650283e-13, -2.73078809e-08, 4.24098264e-04, -7.52335691e-01),
    ],
    np.float32,
)
HOTTEST, COLDEST = Vec3(0.82629548, 0.99450805, 1.5663077), Vec3(5.4132945, 0.0, 0.0)
ZERO = np.float32(0.0)


@kernel
def blackbody_color(t):
    """Linear Rec.709 colour at `t` kelvin; the same below 800 K and above 12,000 K."""
    if t >= 12000.0:
        return HOTTEST
    if t < 800.0:
        return COLDEST
    row = 0
    for knot in (965.0, 1167.0, 1449.0, 1902.0, 3315.0, 6365.0):
        row += t >= knot
    red = RED[row, 0] / t + RED[row, 1] * t + RED[row, 2]
    green = GREEN[row, 0] / t + GREEN[row, 1] * t + GREEN[row, 2]
    blue = ((BLUE[row, 0] * t + BLUE[row, 1]) * t + BLUE[row, 2]) * t + BLUE[row, 3]
    return Vec3(max(red, ZERO), max(green, ZERO), max(blue, ZERO))
