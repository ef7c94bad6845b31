# SPDX-License-Identifier: GPL-3.0-or-later
"""Where there is no medium: what `media.py` has another answer to, in scenes that have one.

Integrators call these by name. They do nothing, so the compiler drops them, and scenes without media pay nothing.
"""

from ..jit import kernel
from ..linalg.vec3 import WHITE


@kernel
def clearness(walk, t):
    """The part of light that gets through `t` metres along the path's ray."""
    return WHITE


@kernel
def is_scattered(scene, settings, walk, sampler, hit):
    """Whether the path is scattered before it gets to what it hit."""
    return False


@kernel
def scatter_in_media(scene, settings, walk, sampler):
    """Go on from there; False if the path ends."""
    return False


@kernel
def is_no_surface(scene, walk, it):
    """Whether there is nothing at `it` but the boundary of a medium, and the path is through it."""
    return False


@kernel
def pass_surface(walk, it):
    """Let the path's ray go on behind the surface at `it`.

    It stays the same ray, and meets what lies beyond: all of several surfaces that lie in one place, but for those that
    it hits at the very same distance; as in Cycles.
    """
    walk.t_min = walk.t


@kernel
def go_through(scene, media, it, visibility):
    """Tell the media of a path that it goes through the surface at `it`."""
