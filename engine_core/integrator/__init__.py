# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimating the light that reaches the camera: the one place where geometry, materials and lights meet."""
