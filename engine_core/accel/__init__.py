# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees of boxes, eight children a node, and the questions that rays ask them."""
