# SPDX-License-Identifier: GPL-3.0-or-later
"""Scattering that is guided: a direction by the material, or by what earlier paths have learned about the place."""

import numpy as np

from ..bsdf import dispatch as bsdf_dispatch
from ..bsdf.dispatch import BsdfSample
from ..bsdf.lobe import ZERO, is_matt
from ..guiding import histogram
from ..guiding.cells import cell_at
from ..guiding.trail import remember
from ..jit import kernel
from ..linalg.vec3 import BLACK, average, load3

BELOW_ONE = np.float32(1.0 - 2.0**-24)


@kernel
def set_guide(scene, it, bsdf):
    """Give the BSDF its guide: as often as a matt lobe would scatter, some of its directions come from the cell."""
    if scene.guide[0].on == 0:
        return
    matt = ZERO
    for i in range(bsdf.count):
        if is_matt(bsdf.lobes[i].kind):
            matt += bsdf.lobes[i].pmf
    if matt > 0.0:
        bsdf.cell = cell_at(scene, load3(it, "p"), load3(it, "ng"))
        bsdf.guided = matt * scene.guide_cells[bsdf.cell].guided


@kernel
def sample_guided(scene, bsdf, wo, u_lobe, u0, u1):
    """As `bsdf.dispatch.sample`, from the mixture of the material's density and the guide's.

    Deltas scatter by themselves. u0 makes the choice, too: the points (u0, u1) on either side of it, stretched, are as
    well spread as all of them.
    """
    aim = bsdf.guided
    if u0 < aim:
        wi, density = histogram.sample(scene.guide_cells[bsdf.cell], min(u0 / aim, BELOW_ONE), u1)
        f, pdf_bsdf = bsdf_dispatch.evaluate_and_pdf(bsdf, wo, wi)
        density = (1.0 - aim) * pdf_bsdf + aim * density
        if not density > 0.0:
            return BsdfSample(BLACK, BLACK, ZERO, np.int32(0), False, False)
        kind = bsdf_dispatch.kind_of_lobe(bsdf, wo, wi, u_lobe)
        return BsdfSample(wi, f * (1.0 / density), density, kind, False, bsdf_dispatch.is_behind(bsdf, wi))

    lobes = 1.0 - aim
    s = bsdf_dispatch.sample(bsdf, wo, u_lobe, min((u0 - aim) / lobes, BELOW_ONE), u1)
    if s.pdf <= 0.0 or aim == 0.0:
        return s
    if s.is_delta:
        return BsdfSample(s.wi, s.weight * (1.0 / lobes), s.pdf * lobes, s.kind, True, s.is_transmission)
    density = guided_pdf(scene, bsdf, s.wi, s.pdf)
    return BsdfSample(s.wi, s.weight * (s.pdf / density), density, s.kind, False, s.is_transmission)


@kernel
def guided_pdf(scene, bsdf, wi, pdf_bsdf):
    """Density per solid angle with which `sample_guided` chooses `wi`, which the material chooses with `pdf_bsdf`."""
    if bsdf.guided == 0.0:
        return pdf_bsdf
    return (1.0 - bsdf.guided) * pdf_bsdf + bsdf.guided * histogram.pdf(scene.guide_cells[bsdf.cell], wi)


@kernel
def leave_trail(scene, trail, walk, bsdf, s):
    """Remember the BsdfSample `s`, if its cell shall learn what it brings."""
    if bsdf.cell >= 0 and scene.guide[0].learns != 0 and s.pdf > 0.0 and not s.is_delta:
        if trail.count == 0:
            walk.direct = average(load3(walk, "L"))
        remember(trail, bsdf.cell, s.wi, load3(walk, "beta"), load3(walk, "L"))
