# SPDX-License-Identifier: GPL-3.0-or-later
"""Random numbers that belong to names and numbers: those that Cycles gives them."""


def hash_of_name(name):
    """32 bits from a name, by a polynomial of its bytes."""
    polynomial = 0
    for byte in name.encode():
        polynomial = (polynomial * 37 + byte) & 0xFFFFFFFF
    return hash_of_number(polynomial)


def hash_of_number(number):
    """32 bits from 32 bits, by Jenkins' lookup3 (2006) of the number and a 0."""
    a = b = c = 0xDEADBEEF + 8 + 13
    a = (a + number) & 0xFFFFFFFF
    c = _mixed(c, b, 14)
    a = _mixed(a, c, 11)
    b = _mixed(b, a, 25)
    c = _mixed(c, b, 16)
    a = _mixed(a, c, 4)
    b = _mixed(b, a, 14)
    return _mixed(c, b, 24)


def _mixed(x, y, bits):
    """(x ^ y) - (y rotated left)"""
    return ((x ^ y) - (y << bits | y >> (32 - bits))) & 0xFFFFFFFF


def unit(bits):
    """32 bits as a number from 0 to 1, both included."""
    return (bits & 0xFFFFFFFF) / 0xFFFFFFFF
