# SPDX-License-Identifier: GPL-3.0-or-later
"""The measured spectra of the box at Cornell University, and the colours in linear sRGB that they come to.

Data: Cornell University Program of Computer Graphics, www.graphics.cornell.edu/online/box/data.html.

A renderer of three colours cannot carry a spectrum. What it can do is to get light right that the lamp throws onto a
surface and the surface into the eye, which is most of the light in the picture: the lamp gets the colour of its own
spectrum S, and a surface that reflects R the ratio, in each of the three, of the colour of R S to that of S.
Light that goes from wall to wall is then off by as much as the products of colours are from the colour of the product.
"""

import numpy as np

WAVELENGTHS = np.arange(400, 701, 4)  # nanometres
REFLECTANCES = {  # in thousandths, at each of them
    "white": (
        "343 445 551 624 665 687 708 723 715 710 745 758 739 767 777 765 751 745 748 729 745 757 753 750 746 "
        "747 735 732 739 734 725 721 733 725 732 743 744 748 728 716 733 726 713 740 754 764 752 736 734 741 "
        "740 732 745 755 751 744 731 733 744 731 712 708 729 730 727 707 703 729 750 760 751 739 724 730 740 "
        "737"
    ),
    "green": (
        "92 96 98 97 98 95 95 97 95 94 97 98 96 101 103 104 107 109 112 115 125 140 160 187 229 285 343 390 "
        "435 464 472 476 481 462 447 441 426 406 373 347 337 314 285 277 266 250 230 207 186 171 160 148 141 "
        "136 130 126 123 121 122 119 114 115 117 117 118 120 122 128 132 139 144 146 150 152 157 159"
    ),
    "red": (
        "40 46 48 53 49 50 53 55 57 56 59 57 61 61 60 62 62 62 61 62 60 59 57 58 58 58 56 55 56 59 57 55 59 "
        "59 58 59 61 61 63 63 67 68 72 80 90 99 124 154 192 255 287 349 402 443 487 513 558 584 620 606 609 "
        "651 612 610 650 638 627 620 630 628 642 639 657 639 635 642"
    ),
}
LAMP = ((400, 500, 600, 700), (0.0, 8.0, 15.6, 18.4))  # wavelengths and radiances, in units of its own
LAMP_REFLECTANCE = 0.78  # of its glass
SRGB_OF_XYZ = np.array(  # IEC 61966-2-1
    [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
)


def reflectance(name):
    """Linear sRGB of a surface in the light of the lamp, (3,)."""
    measured = np.array(REFLECTANCES[name].split(), float) / 1000.0
    return srgb(measured * lamp()) / srgb(lamp())


def lamp_color():
    """Linear sRGB of the lamp, (3,), of luminance 1."""
    color = srgb(lamp())
    return color / (color @ (0.2126, 0.7152, 0.0722))


def lamp():
    """Its spectrum, at WAVELENGTHS."""
    return np.interp(WAVELENGTHS, *LAMP)


def srgb(spectrum):
    """Linear sRGB, in units of its own, of values at WAVELENGTHS: a sum over them, weighted by how the eye responds."""
    return SRGB_OF_XYZ @ (color_matching(WAVELENGTHS) @ spectrum)


def color_matching(wavelength):
    """The eye's response x, y, z (CIE 1931) by nanometres, (3, n); the fit of Wyman, Sloan and Shirley 2013, "Simple
    Analytic Approximations to the CIE XYZ Color Matching Functions", their section 2.2."""

    def lobe(height, centre, below, above):
        width = np.where(wavelength < centre, below, above)
        return height * np.exp(-0.5 * ((wavelength - centre) / width) ** 2)

    x = lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2)
    y = lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1)
    z = lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8)
    return np.array([x, y, z])
