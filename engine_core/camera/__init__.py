# SPDX-License-Identifier: GPL-3.0-or-later
"""From a place in the picture to a ray into the scene: one file a kind of camera, and the lens that they share."""
