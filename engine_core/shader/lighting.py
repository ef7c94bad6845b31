# SPDX-License-Identifier: GPL-3.0-or-later
"""Sky Texture and IES Texture: what the sky and luminaires send where."""

from ..jit import kernel
from ..texture import sky
from ..texture.ies import intensity
from .opcodes import Daylight, Op, SkyTable
from .operands import give_number, give_vector, number, vector


def run(scene, op, point, registers):
    """One step: see `opcodes.SIGNATURES`."""
    d = vector(op, registers, 0)
    if op.code == Op.IES:
        give_number(op, registers, intensity(scene, scene.images[op.data], d) * number(op, registers, 1))
    elif op.code == Op.SKY:
        give_vector(op, registers, sky_at(scene, op, registers, d))
    else:
        give_vector(op, registers, daylight(op, registers, d))


@kernel
def sky_at(scene, op, registers, d):
    sun = sky.Sun(
        number(op, registers, 1),
        number(op, registers, 2),
        number(op, registers, 3),
        number(op, registers, 4),
        number(op, registers, 5),
        vector(op, registers, 6),
        vector(op, registers, 7),
    )
    image = scene.images[op.data]
    if op.mode == SkyTable.UPPER_HALF:
        return sky.from_old_table(scene, image, sun, d)
    return sky.from_table(scene, image, sun, d)


@kernel
def daylight(op, registers, d):
    a, b, c = vector(op, registers, 1), vector(op, registers, 2), vector(op, registers, 3)
    e, f = vector(op, registers, 4), vector(op, registers, 5)
    radiance, sun = vector(op, registers, 10), vector(op, registers, 11)
    theta, gamma = sky.angles(d, sun.x, sun.y)
    if op.mode == Daylight.PREETHAM:
        return sky.preetham(a, b, c, e, f, radiance, theta, gamma)
    g, h, i, j = vector(op, registers, 6), vector(op, registers, 7), vector(op, registers, 8), vector(op, registers, 9)
    return sky.hosek_wilkie(a, b, c, e, f, g, h, i, j, radiance, theta, gamma)
