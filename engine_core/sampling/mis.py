# SPDX-License-Identifier: GPL-3.0-or-later
"""Multiple importance sampling: how two ways of finding the same light share it (Veach 1997, chapter 9)."""

from ..jit import kernel


@kernel
def power_heuristic(pdf_a, pdf_b):
    """Weight of a sample that technique `a` drew, beta = 2 (Veach 1997, section 9.2.4).

    Both densities in the same measure. Taken by the ratio, so that the squares of large densities do not overflow.
    """
    if pdf_a == 0.0:
        return pdf_a
    ratio = pdf_b / pdf_a
    return 1.0 / (1.0 + ratio * ratio)
