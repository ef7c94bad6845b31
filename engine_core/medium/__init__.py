# SPDX-License-Identifier: GPL-3.0-or-later
"""What light does inside of things: how far it goes, and where to when it is scattered."""
