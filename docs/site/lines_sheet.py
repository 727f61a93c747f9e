#!/usr/bin/env python3
"""Twelve drawings of `limn contours`, each beside raster methods of the same view, on one sheet: samples/pictures/lines.png.

    python3 docs/site/lines_sheet.py build/release/limn samples/pictures/lines.png

Needs rsvg-convert (librsvg2-bin). Pictures of raster methods have the size in which the sheet shows them, with four samples a pixel.
"""

import base64
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import zlib

WIDTH, HEIGHT, GAP, LABEL, MARGIN = 256, 192, 10, 22, 20
RASTER = ["sobel", "normal4"]
COLUMNS = 2

STYLES = {
    "pen": ".contour { stroke: #101010; stroke-width: 1.7; taper: ends; } "
           ".crease { stroke: #101010; stroke-width: 0.8; taper: ends; } "
           ".intersection { stroke: #101010; stroke-width: 1; } "
           ".suggestive { stroke: #101010; stroke-width: 0.7; taper: ends; } "
           ".ridge, .valley { stroke: #101010; stroke-width: 0.7; taper: ends; }",
    "hidden": ".contour { stroke: #101010; stroke-width: 1.6; } .crease { stroke: #101010; stroke-width: 0.8; } "
              ".intersection { stroke: #101010; stroke-width: 1; } "
              ".hidden { stroke: #8a8a8a; stroke-width: 0.5; stroke-dasharray: 3 2; }",
}

# Scene, style, options of the drawing, and the view.
DRAWINGS = [
    ("teacup", "pen", ["--lines", "contour,crease,boundary,intersection,suggestive"], []),
    ("rook", "pen", ["--lines", "contour,crease,ridge,valley"], ["--elevation", "28"]),
    ("machined_part", "pen", ["--lines", "contour,crease,ridge,valley"], []),
    ("gyroid", "pen", [], []),
    ("pipe_junction", "pen", ["--lines", "contour,crease,ridge,valley", "--ridge-strength", "9"], []),
    ("bracket", "pen", ["--lines", "contour,crease,ridge,valley"], []),
    ("fused_spheres", "pen", [], []),
    ("honeycomb", "pen", [], []),
    ("passing_tori", "hidden", ["--hidden"], ["--azimuth", "30", "--elevation", "40"]),
    ("superellipsoid", "pen", ["--lines", "contour,crease,ridge", "--ridge-strength", "2"], []),
    ("tilted_torus", "pen", ["--lines", "contour,suggestive"], []),
    ("cylinder_end", "hidden", ["--hidden"], ["--azimuth", "35", "--elevation", "25"]),
]


def run(*arguments):
    subprocess.run([str(argument) for argument in arguments], check=True)


def grey_png(path):
    """Rewrites a PNG of 8 bits a channel as grey levels over white, compressed as far as zlib goes."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", body[:10])
        packed += body if kind == b"IDAT" else b""
        at += 12 + size
    channels = {2: 3, 6: 4}[color]
    assert depth == 8
    raw, stride, above, rows = zlib.decompress(packed), width * channels, bytearray(width * channels), []
    for y in range(height):
        start = y * (stride + 1)
        line, method = bytearray(raw[start + 1:start + 1 + stride]), raw[start]
        for i in range(stride):
            left = line[i - channels] if i >= channels else 0
            corner = above[i - channels] if i >= channels else 0
            if method == 4:
                guess = left + above[i] - corner
                near = min((abs(guess - left), 0, left), (abs(guess - above[i]), 1, above[i]), (abs(guess - corner), 2, corner))
                line[i] = (line[i] + near[2]) & 255
            else:
                line[i] = (line[i] + (0, left, above[i], (left + above[i]) // 2)[method]) & 255
        rows.append(b"\0" + bytes(line[1::channels]))
        above = line
    chunk = lambda kind, body: struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) +
                     chunk(b"IDAT", zlib.compress(b"".join(rows), 9)) + chunk(b"IEND", b""))


def main(limn, output):
    cell_width, cell_height = (1 + len(RASTER)) * (WIDTH + GAP) + 2 * MARGIN, HEIGHT + LABEL + GAP
    width, height = COLUMNS * cell_width, -(-len(DRAWINGS) // COLUMNS) * cell_height + 2 * MARGIN
    parts = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for style, text in STYLES.items():
            (folder / f"{style}.css").write_text(text)
        for index, (scene, style, options, view) in enumerate(DRAWINGS):
            x, y = index % COLUMNS * cell_width + MARGIN, index // COLUMNS * cell_height + MARGIN
            size = ["--size", f"{WIDTH}x{HEIGHT}", *view]
            run(limn, "contours", scene, "-q", "--style", folder / f"{style}.css", *options, *size, "-o", folder / "drawing.svg")
            drawing = re.sub(r"^<\?xml.*?\?>", "", (folder / "drawing.svg").read_text(), flags=re.S)
            shown = [f'<g transform="translate({x},{y + LABEL})">{drawing}</g>']
            labels = [scene.replace("_", " ")]
            for number, method in enumerate(RASTER, start=1):
                picture = folder / "picture.png"
                run(limn, "render", scene, "-q", "--method", method, "--shading", "none", "--background", "white", "--samples", "4", *size,
                    "-o", picture)
                encoded = base64.b64encode(picture.read_bytes()).decode()
                shown.append(f'<image x="{x + number * (WIDTH + GAP)}" y="{y + LABEL}" width="{WIDTH}" height="{HEIGHT}" '
                             f'href="data:image/png;base64,{encoded}"/>')
                labels.append(method)
            for number, label in enumerate(labels):
                shown.append(f'<text x="{x + number * (WIDTH + GAP)}" y="{y + 14}" font-family="sans-serif" font-size="12" '
                             f'fill="{"#101010" if number == 0 else "#777777"}">{label}</text>')
            parts += shown
        sheet = folder / "sheet.svg"
        sheet.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">'
                         f'<rect width="{width}" height="{height}" fill="white"/>{"".join(parts)}</svg>')
        run("rsvg-convert", "--unlimited", "-o", output, sheet)
    grey_png(pathlib.Path(output))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
