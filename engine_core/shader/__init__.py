# SPDX-License-Identifier: GPL-3.0-or-later
"""From a material and a point of a surface to the lobes that scatter there."""
