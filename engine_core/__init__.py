# SPDX-License-Identifier: GPL-3.0-or-later
"""Path tracing on numpy arrays, compiled by numba. Knows nothing of Blender."""

from . import jit

jit.use_cache()
