# SPDX-License-Identifier: GPL-3.0-or-later
"""Path tracing on numpy arrays, compiled by numba. Knows nothing of Blender."""

from . import jit

__version__ = "0.1.0"  # as in pyproject.toml

jit.use_cache()
