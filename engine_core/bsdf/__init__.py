# SPDX-License-Identifier: GPL-3.0-or-later
"""How light scatters at a point: one file a model, and `dispatch`, which knows which is which.

A model is a lobe (`tables.LOBE`) in its local frame: z is the shading normal, on the side of wo, x the tangent. It has

    evaluate_and_pdf(lobe, wo, wi)        -> LobeValue   f |cos|, and the density with which `sample` chooses wi
    sample(lobe, wo, u_choice, u0, u1)    -> LobeSample
    albedo(lobe, wo)                      -> Vec3        the share of light from everywhere that leaves towards wo

all without the lobe's own `weight`. `dispatch` mixes the lobes of a point and turns directions of the world.
"""
