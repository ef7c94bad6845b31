# SPDX-License-Identifier: GPL-3.0-or-later
"""What build.py needs: the environment, the extension package, and the script that renders inside Blender.

These files run before anything is installed, on whatever Python a machine has: standard library alone, 3.8 and later.
"""
