# SPDX-License-Identifier: GPL-3.0-or-later
"""Making scenes: the builder, the materials it takes, checks of its input, and scene files."""
