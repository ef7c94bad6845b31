# SPDX-License-Identifier: GPL-3.0-or-later
"""Where radiance lands: the pixels, the filter that chooses where in a pixel, and the passes read from them."""
