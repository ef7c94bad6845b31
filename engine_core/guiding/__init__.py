# SPDX-License-Identifier: GPL-3.0-or-later
"""Path guiding: directions that have brought light to a place are chosen more often by later paths."""
