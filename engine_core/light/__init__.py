# SPDX-License-Identifier: GPL-3.0-or-later
"""Where light comes from: one file a kind of emitter, each with `sample`, `emitted` and `pdf`.

`p` is the point that is lit, `wi` a unit direction from there. Densities are per solid angle at `p`.
"""
