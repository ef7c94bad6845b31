# SPDX-License-Identifier: GPL-3.0-or-later
"""How the shadow on the far side of a smooth mesh is kept from showing its faces: see `integrator/terminator.py`."""

from typing import NamedTuple


class Terminator(NamedTuple):
    """In the words of Blender's objects. By default faces are what they are."""

    geometry_offset: float = 0.0  # cosine: light that grazes more is seen from the smooth surface; 0: from the faces
    shading_offset: float = 0.0  # 0 to 1: how far the shadow is drawn over them


def tell_terminators(objects, placements, geometries, world):
    """Fill in the rows of OBJECT of placements, and what the row of WORLD says of them all."""
    told = objects[: len(placements)]
    smooth = [getattr(geometry, "normals", None) is not None for geometry in geometries]
    told["lift_below"] = [p.terminator.geometry_offset if smooth[p.geometry] else 0.0 for p in placements]
    told["shadow_stretch"] = [1.0 / (1.0 - 0.5 * p.terminator.shading_offset) for p in placements]
    world["lift_below"] = told["lift_below"].max(initial=0.0)
    world["stretches_shadows"] = int((told["shadow_stretch"] > 1.0).any())
