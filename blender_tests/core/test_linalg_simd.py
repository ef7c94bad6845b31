# SPDX-License-Identifier: GPL-3.0-or-later
"""Lanes do to four and eight numbers what numpy does to an array."""

import numpy as np
import pytest

from engine_core.jit import kernel
from engine_core.linalg.records import Tables, scratch_record
from engine_core.linalg.simd import (
    bits,
    difference_of_products,
    key_number,
    lane,
    lanes4,
    load1,
    load4,
    load8,
    lowest_bit,
    make_key,
    maximum,
    minimum,
    splat4,
    splat8,
    store1,
    store4,
    store8,
    store_keys,
    without_lowest_bit,
    xyz,
)

ROW = np.dtype([("pad", "i4"), ("a", "f4", (2, 8)), ("b", "f4", (2, 8)), ("out", "f4", (8, 8)), ("bits", "i4", (8,))])
RANDOM = np.random.default_rng(5)


class Rows(Tables):
    rows = ROW


@kernel
def eight(rows):
    r = rows.rows[0]
    a, b = load8(r, "a", 1), load8(r, "b", 1)
    store8(r, "out", 0, a + b)
    store8(r, "out", 1, a - b)
    store8(r, "out", 2, a * b)
    store8(r, "out", 3, a / b)
    store8(r, "out", 4, minimum(a, b))
    store8(r, "out", 5, maximum(a, b))
    store8(r, "out", 6, splat8(lane(a, np.int32(5))))
    store8(r, "out", 7, difference_of_products(a, b, b, a))
    r.bits[0], r.bits[1], r.bits[2], r.bits[3] = bits(a < b), bits(a <= b), bits(a > b), bits(a >= b)
    r.bits[4], r.bits[5] = bits((a < b) & (a > splat8(np.float32(0)))), bits((a < b) | (a > splat8(np.float32(0))))


@kernel
def four(rows):
    r = rows.rows[0]
    a, b = load4(r, "a", 3), load4(r, "b", 3)  # the last four of row 1
    store4(r, "out", 0, a * b - a)
    store4(r, "out", 1, xyz(a))
    store4(r, "out", 2, lanes4(lane(a, np.int32(2)), lane(b, np.int32(1)), lane(a, np.int32(0))))
    store4(r, "out", 3, splat4(lane(b, np.int32(3))))
    r.bits[0] = bits(a < b)


@pytest.fixture
def rows():
    row = np.zeros(1, ROW)
    row["a"], row["b"] = RANDOM.normal(size=(2, 1, 2, 8))
    row["b"][0, 1, 3] = row["a"][0, 1, 3]
    return Rows(rows=row)


def test_eight_lanes(rows):
    eight(rows)
    r = rows.rows[0]
    a, b = r["a"][1], r["b"][1]
    expected = [a + b, a - b, a * b, a / b, np.minimum(a, b), np.maximum(a, b), np.full(8, a[5]), np.zeros(8)]
    np.testing.assert_allclose(r["out"], expected, rtol=1e-6)
    masks = [a < b, a <= b, a > b, a >= b, (a < b) & (a > 0), (a < b) | (a > 0)]
    assert list(r["bits"][:6]) == [sum(1 << i for i in np.flatnonzero(m)) for m in masks]


def test_four_lanes(rows):
    four(rows)
    r = rows.rows[0]
    a, b = r["a"][1, 4:], r["b"][1, 4:]
    out = r["out"].reshape(-1, 4)
    expected = [a * b - a, [*a[:3], 0], [a[2], b[1], a[0], 0], np.full(4, b[3])]
    np.testing.assert_allclose(out[:4], expected, rtol=1e-5)
    assert r["bits"][0] == sum(1 << i for i in np.flatnonzero(a < b))


def test_least_and_greatest_take_the_second_where_the_first_is_not_a_number(rows):
    """What traversal counts on for rays along the plane of a box."""
    rows.rows[0]["a"][1, 2] = np.nan
    eight(rows)
    b = rows.rows[0]["b"][1, 2]
    np.testing.assert_array_equal(rows.rows[0]["out"][4:6, 2], [b, b])
    assert all((mask >> 2) & 1 == 0 for mask in rows.rows[0]["bits"][:4])


@kernel
def products_differ(a, b, c, d):
    x = difference_of_products(splat4(a), splat4(b), splat4(c), splat4(d))
    y = difference_of_products(splat4(c), splat4(d), splat4(a), splat4(b))
    return lane(x, np.int32(0)), lane(y, np.int32(0))


def test_exchanged_products_differ_by_exactly_the_opposite():
    """With a fused multiply-add they would not: that rounds one product only."""
    for a, b, c in RANDOM.normal(size=(1000, 3)).astype(np.float32):
        d = np.float32(np.float64(a) * b / c)
        x, y = products_differ(a, b, c, d)
        assert x == -y


@kernel
def lowest_and_rest(x):
    return lowest_bit(np.int32(x)), without_lowest_bit(np.int32(x))


def test_lowest_bit():
    assert [lowest_and_rest(x) for x in (1, 2, 3, 12, 128)] == [(0, 0), (1, 0), (0, 2), (2, 8), (7, 0)]


KEYS = np.dtype(
    [("numbers", "i4", (8,)), ("t", "f4", (8,)), ("keys", "i8", (8,)), ("one", "i8", (1,)), ("back", "i4", (8,))]
)


class Keys(Tables):
    rows = KEYS


@kernel
def fill_keys(keys):
    r = keys.rows[0]
    store_keys(r, "keys", load8(r, "numbers", 0), load8(r, "t", 0))
    store1(r, "one", 0, make_key(load1(r, "numbers", 3), load1(r, "t", 3)))
    for i in range(8):
        store1(r, "back", i, key_number(load1(r, "keys", i)))


def test_keys_carry_their_number_and_sort_by_distance():
    row = np.zeros(1, KEYS)
    row["numbers"] = [5, -1, 2**31 - 1, -(2**31), 0, 7, -77, 1]
    row["t"] = [1.5, 0.0, np.inf, 1e-30, 3e38, 1.5000001, 2.0, 1e-45]
    keys = Keys(rows=row)
    fill_keys(keys)
    r = keys.rows[0]
    np.testing.assert_array_equal(np.argsort(r["keys"]), np.argsort(r["t"]))
    np.testing.assert_array_equal(r["back"], r["numbers"])
    assert r["one"][0] == r["keys"][3]


scratch = scratch_record(ROW)


@kernel
def on_the_stack(x):
    first, second = scratch(), scratch()
    first.bits[3], second.bits[3] = x, x + 1
    return first.bits[3] * 100 + second.bits[3]


def test_rows_on_the_stack_are_apart():
    assert on_the_stack(4) == 405
