# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that a ray can hit: one file a shape, and where a ray met the scene."""
