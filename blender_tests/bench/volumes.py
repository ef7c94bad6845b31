# SPDX-License-Identifier: GPL-3.0-or-later
"""Noise against time where light is scattered and absorbed between surfaces, Lambent beside Cycles: as `noise.py`.

Light is scattered in volumes as often as the file says, in both engines alike.

    python3 build.py bench volumes
"""

from . import noise

SCENES = ("cornell_smoke", "next_week", "foggy_room", "cloud", "colored_glass")


def run(quick=False, scenes=(), progress=None):
    """As `noise.run`."""
    return noise.run(quick, scenes or SCENES, progress)


if __name__ == "__main__":
    import json

    print(json.dumps(run(), indent=2))
