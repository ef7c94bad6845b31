# SPDX-License-Identifier: GPL-3.0-or-later
"""Vectors, frames, transforms, SIMD lanes, and the scene as kernels see it."""
