"""PNG files of eight bits a channel without interlacing, as numpy arrays (W3C, "Portable Network Graphics", second edition)."""
import struct
import zlib

import numpy

CHANNELS = {0: 1, 2: 3, 4: 2, 6: 4}


def read_png(path):
    """Height x width x 3 from 0 to 255, over white."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", path
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, color, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            assert depth == 8 and color in CHANNELS and interlaced == 0, (path, depth, color, interlaced)
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    channels = CHANNELS[color]
    rows = unfiltered(zlib.decompress(packed), height, width * channels, channels).reshape(height, width, channels).astype(float)
    if channels < 3:
        rows = numpy.concatenate([numpy.repeat(rows[:, :, :1], 3, axis=2), rows[:, :, 1:]], axis=2)
    if rows.shape[2] == 3:
        return rows
    alpha = rows[:, :, 3:] / 255.0
    return rows[:, :, :3] * alpha + 255.0 * (1.0 - alpha)


def unfiltered(raw, height, row_bytes, step):
    out = numpy.zeros((height, row_bytes), dtype=numpy.uint8)
    above = bytearray(row_bytes)
    for y in range(height):
        start = y * (row_bytes + 1)
        kind, row = raw[start], bytearray(raw[start + 1:start + 1 + row_bytes])
        for x in range(row_bytes) if kind else ():
            left = row[x - step] if x >= step else 0
            corner = above[x - step] if x >= step else 0
            if kind == 1:
                guess = left
            elif kind == 2:
                guess = above[x]
            elif kind == 3:
                guess = (left + above[x]) // 2
            else:
                p = left + above[x] - corner
                distances = abs(p - left), abs(p - above[x]), abs(p - corner)
                guess = (left, above[x], corner)[distances.index(min(distances))]
            row[x] = (row[x] + guess) & 255
        out[y] = numpy.frombuffer(bytes(row), dtype=numpy.uint8)
        above = row
    return out


def read_ppm(path):
    data = path.read_bytes()
    fields = data.split(maxsplit=4)[:4]
    assert fields[0] == b"P6" and fields[3] == b"255", path
    width, height = int(fields[1]), int(fields[2])
    return numpy.frombuffer(data[-3 * width * height:], dtype=numpy.uint8).reshape(height, width, 3).astype(float)
