# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what Blender writes as uncompressed OpenEXR: every channel of every layer, and the header."""

import struct

import numpy as np

DTYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}


def read_exr(path):
    """(channels, header): {channel name: float array (height, width), bottom row first}, {attribute name: value}.

    Names of channels are those of the file: "R", or "ViewLayer.Depth.Z". Attributes that are not text stay bytes.
    """
    data = path.read_bytes()
    magic, version = struct.unpack_from("<II", data)
    assert magic == 20000630, f"{path} is no OpenEXR file"
    assert not version & 0x1A00, f"{path} has tiles or several parts"
    header, position = {}, 8
    while data[position]:
        name, kind, value, position = _attribute(data, position)
        header[name] = value.decode("latin-1") if kind == "string" else value
    assert header["compression"] == b"\0", f"{path} is compressed"
    left, low, right, high = struct.unpack("<4i", header["dataWindow"])
    width, height = right - left + 1, high - low + 1
    layout = list(_channels(header["channels"]))
    offsets = np.frombuffer(data, "<u8", height, position + 1)
    channels = {name: np.empty((height, width), dtype) for name, dtype in layout}
    for offset in map(int, offsets):
        y = struct.unpack_from("<i", data, offset)[0] - low
        offset += 8  # after the row's number and size
        for name, dtype in layout:
            channels[name][height - 1 - y] = np.frombuffer(data, dtype, width, offset)
            offset += width * dtype.itemsize
    return channels, header


def read_rgba(path):
    """float32 (height, width, 3 or 4) of a file with one picture, bottom row first."""
    channels, _ = read_exr(path)
    ends = {name.rsplit(".", 1)[-1]: pixels for name, pixels in channels.items()}
    return np.stack([ends[c] for c in "RGBA" if c in ends], axis=-1).astype(np.float32)


def _text(data, position):
    end = data.index(b"\0", position)
    return data[position:end].decode(), end + 1


def _attribute(data, position):
    name, position = _text(data, position)
    kind, position = _text(data, position)
    (size,) = struct.unpack_from("<i", data, position)
    position += 4
    return name, kind, data[position : position + size], position + size


def _channels(data):
    position = 0
    while data[position]:
        name, position = _text(data, position)
        yield name, DTYPES[struct.unpack_from("<i", data, position)[0]]
        position += 16  # kind, linear flag, sampling in x and y
