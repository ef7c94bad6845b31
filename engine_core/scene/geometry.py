# SPDX-License-Identifier: GPL-3.0-or-later
"""What meshes and analytic shapes have in common, plainly."""

from ..tables import TreeKind
from .shapes import Shapes


def kind_of(geometry):
    return TreeKind.SHAPES if isinstance(geometry, Shapes) else TreeKind.TRIANGLES


def size_of(geometry):
    """How many triangles or shapes it has."""
    return len(geometry.rows if isinstance(geometry, Shapes) else geometry.triangles)


def slots_of(geometry):
    """Material slot of each triangle, or None: all have the first."""
    return getattr(geometry, "slots", None)


def slot_count(geometry):
    slots = slots_of(geometry)
    return 1 if slots is None or not len(slots) else int(slots.max()) + 1
