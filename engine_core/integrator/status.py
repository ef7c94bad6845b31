# SPDX-License-Identifier: GPL-3.0-or-later
"""What a render says about itself: a line while it runs, and what is written into the file of its picture."""

import math

from .. import __version__
from ..settings import IntegratorKind, SamplerKind


def text(render):
    """For example: Sample 64/128, noise 2.1 %"""
    return f"Sample {render.samples_done}/{render.settings.samples}{_noise(render, ', noise ')}"


def metadata(render):
    """{name: text}: how the picture was made, and how far it may be off."""
    settings = render.settings
    return {
        "engine": f"Lambent {__version__}",
        "integrator": IntegratorKind(settings.integrator).name.lower(),
        "sampler": SamplerKind(settings.sampler).name.lower(),
        "adaptive": "yes" if settings.adaptive else "no",
        "guided": "yes" if render.is_guided else "no",
        "seed": str(settings.seed),
        "samples": str(render.samples_done),
        "render_time": f"{render.elapsed_s:.3f} s",
        "estimated_error": _noise(render) or "unknown",
    }


def _noise(render, prefix=""):
    error = render.error_estimate
    return "" if math.isnan(error) else f"{prefix}{100.0 * error:.2g} %"
