# SPDX-License-Identifier: GPL-3.0-or-later
"""Where random numbers come from, and how they become directions and points."""
