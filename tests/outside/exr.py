"""Reads the OpenEXR files that limn writes: one part of scan lines, without compression or with zip, channels of 16 or 32 bits."""
import struct
import zlib

import numpy as np

TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}
LINES = {0: 1, 2: 1, 3: 16}  # by compression: none, zip of one line, zip of sixteen


def text_at(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def header_of(data):
    """Attributes by name as bytes, and where they end."""
    magic, version = struct.unpack_from("<II", data)
    if magic != 20000630 or version & ~0x400 != 2:
        raise ValueError(f"no OpenEXR file of one part of scan lines (magic {magic}, version {version:#x})")
    at, attributes = 8, {}
    while data[at]:
        name, at = text_at(data, at)
        _, at = text_at(data, at)
        size, = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def channels_of(field):
    channels, at = [], 0
    while field[at]:
        name, at = text_at(field, at)
        channels.append((name, TYPES[struct.unpack_from("<i", field, at)[0]]))
        at += 16
    return channels


def unzipped(packed, size):
    """Zip comes with differences of neighbouring bytes, and with the even bytes before the odd ones."""
    if len(packed) == size:
        return packed
    bytes_ = np.frombuffer(zlib.decompress(packed), np.uint8).copy()
    bytes_[1:] += 128
    bytes_ = np.cumsum(bytes_, dtype=np.uint8)
    plain = np.empty(size, np.uint8)
    half = (size + 1) // 2
    plain[0::2], plain[1::2] = bytes_[:half], bytes_[half:]
    return plain.tobytes()


def read_exr(path, wanted):
    """Channel -> picture as float64 (rows, columns), of the channels wanted."""
    data = path.read_bytes()
    attributes, at = header_of(data)
    channels = channels_of(attributes["channels"])
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    lines, row_size = LINES[attributes["compression"][0]], width * sum(kind.itemsize for _, kind in channels)
    pictures = {name: np.empty((height, width)) for name in wanted}
    blocks = -(-height // lines)
    for start in struct.unpack_from(f"<{blocks}Q", data, at):
        y, size = struct.unpack_from("<ii", data, start)
        count = min(lines, bottom + 1 - y)
        block = np.frombuffer(unzipped(data[start + 8:start + 8 + size], count * row_size), np.uint8).reshape(count, row_size)
        offset = 0
        for name, kind in channels:
            after = offset + width * kind.itemsize
            if name in pictures:
                pictures[name][y - top:y - top + count] = block[:, offset:after].copy().view(kind)
            offset = after
    return pictures
