#!/usr/bin/env python3
"""Drawings of `limn contours` as other programs read them: SVG by librsvg (and Inkscape, where it is installed), PDF by poppler, DXF by ezdxf.

drawings.py LIMN FOLDER

What they show is compared with the strokes that this script reckons from the view graph's JSON: a pixel that is certainly inside a stroke has
its colour to 1/255, one outside all of them is white; what is between is edge. Layers, labels, counts and coordinates are compared one by one,
and closed silhouettes are filled: their areas are those of the chains.
"""
import collections
import json
import pathlib
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree

try:
    import ezdxf
    import ezdxf.path
    import numpy
except ImportError as fault:
    print(f"skipped: {fault}; the packages python3-numpy and python3-ezdxf bring it")
    sys.exit(77)
for program, package in (("rsvg-convert", "librsvg2-bin"), ("pdftoppm", "poppler-utils")):
    if shutil.which(program) is None:
        print(f"skipped: no {program}; the package {package} brings it")
        sys.exit(77)

from png import read_png, read_ppm

WIDTH, HEIGHT = 320, 180
STROKE = 6.0
EDGE = 0.75  # px on either side of a stroke's border, where anti-aliasing is each program's own
COLORS = {"contour": "#203040", "boundary": "#a02020", "crease": "#2060c0", "intersection": "#108040", "material": "#805010", "rim": "#909090",
          "suggestive": "#607080", "ridge": "#b06020", "valley": "#5060a0"}
ORDER = ("suggestive", "ridge", "valley", "crease", "intersection", "material", "rim", "boundary", "contour")  # as they are painted
CHORDS = 0.1  # px: poppler's curveMaxDelta (splash/Splash.cc)
SVG = "{http://www.w3.org/2000/svg}"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
CASES = (
    # scene, options, scale of the page's pixels
    ("teacup", (), 1.0),
    ("ellipsoid", (), 1.0),
    ("tilted_torus", ("--lines", "all"), 1.0),
    ("machined_part", ("--page", "254x142.875mm"), 3.0),
    ("machined_part", ("--hidden",), 1.0),
    ("machined_part", ("--curves", "arc"), 1.0),
    ("tilted_torus", ("--curves", "bezier"), 1.0),
)
FIT = 0.05 + 0.015 + 0.01  # px: the tolerance of fitted curves, what lies between the points where it is looked at, and chords of DXF
checks = collections.Counter()


def check(what, holds, where):
    checks[what] += 1
    if not holds:
        sys.exit(f"{what}: {where}")


def ask(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=300)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}: {done.stderr}")


class Chain:
    def __init__(self, graph, chain):
        self.kind = chain["class"]
        self.visible = chain["invisibility"] == 0
        self.layers, self.object, self.closed = chain["invisibility"], chain["object"], chain["closed"]
        points = []
        for link in chain["edges"]:
            own = graph["edges"][link["edge"]]["px"]
            own = own[::-1] if link["reversed"] else own
            points += own[1:] if points else own
        if self.closed and graph["edges"][chain["edges"][0]["edge"]]["begin"] >= 0:
            points = points[:-1]
        self.px = numpy.array(points)

    def outline(self):
        return numpy.vstack([self.px, self.px[:1]]) if self.closed else self.px

    def area(self):
        return shoelace(self.px)


def shoelace(px):
    x, y = px[:, 0], px[:, 1]
    return 0.5 * float(numpy.sum(x * numpy.roll(y, -1) - y * numpy.roll(x, -1)))


def distance_field(line, size, scale):
    """Of each pixel's centre to a polyline; infinite beyond a stroke's width."""
    width, height = size
    field = numpy.full((height, width), numpy.inf)
    reach = scale * STROKE
    for a, b in zip(scale * line[:-1], scale * line[1:]):
        low = numpy.maximum(numpy.floor(numpy.minimum(a, b) - reach).astype(int), 0)
        high = numpy.minimum(numpy.ceil(numpy.maximum(a, b) + reach).astype(int) + 1, (width, height))
        if (high <= low).any():
            continue
        x = numpy.arange(low[0], high[0])[None, :] + 0.5 - a[0]
        y = numpy.arange(low[1], high[1])[:, None] + 0.5 - a[1]
        d = b - a
        length = float(d @ d)
        t = numpy.clip((x * d[0] + y * d[1]) / length, 0.0, 1.0) if length > 0.0 else 0.0
        here = numpy.hypot(x - t * d[0], y - t * d[1])
        part = field[low[1]:high[1], low[0]:high[0]]
        numpy.minimum(part, here, out=part)
    return field


def expected_picture(chains, size, scale, edge=EDGE):
    """Colours, and which pixels are certain."""
    width, height = size
    picture = numpy.full((height, width, 3), 255.0)
    certain = numpy.ones((height, width), dtype=bool)
    for chain in sorted(chains, key=lambda one: ORDER.index(one.kind)):
        away = distance_field(chain.outline(), size, scale) - 0.5 * scale * STROKE
        color = [int(COLORS[chain.kind][k:k + 2], 16) for k in (1, 3, 5)]
        inside = away <= -edge
        picture[inside] = color
        certain[inside] = True
        certain[numpy.abs(away) < edge] = False
    return picture, certain


def compare_picture(program, picture, expected, certain, where):
    check(f"{program}: size", picture.shape == expected.shape, f"{where}: {picture.shape} instead of {expected.shape}")
    off = numpy.abs(picture - expected).max(axis=2)
    inside = certain & (expected.min(axis=2) < 255)
    check(f"{program}: something is drawn", int(inside.sum()) > 300, where)
    worst = float(off[certain].max())
    check(f"{program}: same picture within 1/255 but for edges", worst <= 1.0, f"{where}: {worst} at {numpy.argwhere(certain & (off > 1))[:3]}")
    return worst, float(certain.mean())


def path_points(d):
    """Corners of a path of straight lines."""
    check("paths are made of lines", re.fullmatch(r"M[-\d.e ]+(L[-\d.e ]+)*Z?", d) is not None, d[:80])
    return numpy.array([[float(x) for x in part.split()] for part in re.split("[ML]", d.rstrip("Z"))[1:]])


def check_svg(path, chains, where):
    root = xml.etree.ElementTree.parse(path).getroot()
    groups = [group for group in root.iter(SVG + "g") if group.get(INKSCAPE + "groupmode") == "layer"]
    wanted = collections.defaultdict(list)
    for chain in chains:
        wanted[(chain.kind, "visible" if chain.visible else "hidden")].append(chain)
    order = sorted(wanted, key=lambda key: (key[1] == "visible", ORDER.index(key[0])))
    labels = [group.get(INKSCAPE + "label") for group in groups]
    check("layers are numbered and named, hidden ones first", labels == [f"{n} {a} {b}" for n, (a, b) in enumerate(order, 1)], f"{where}: {labels}")
    for group, key in zip(groups, order):
        paths = list(group.iter(SVG + "path"))
        check("a path a chain", len(paths) == len(wanted[key]), f"{where}: {key}")
        for one, chain in zip(paths, wanted[key]):
            check("data-qi and data-object", (int(one.get("data-qi")), int(one.get("data-object"))) == (chain.layers, chain.object), where)
            check("closed chains are closed paths", one.get("d").endswith("Z") == chain.closed, where)
            points = path_points(one.get("d"))
            if chain.closed and len(points) == len(chain.px) + 1:
                points = points[:-1]
            check("paths run where chains run", points.shape == chain.px.shape and numpy.abs(points - chain.px).max() <= 5.1e-5, where)
            if chain.closed:
                check("areas of closed paths, with their signs", abs(shoelace(points) - chain.area()) <= 1e-4 * len(points), where)


def check_fill(folder, path, chains, where):
    """Closed visible chains by themselves, filled: what librsvg paints is as large as the chain's signed area says."""
    root = xml.etree.ElementTree.parse(path).getroot()
    closed = [chain for chain in chains if chain.closed and chain.visible]
    paths = [one.get("d") for one in root.iter(SVG + "path") if one.get("d").endswith("Z") and one.get("data-qi") == "0"]
    check("closed visible chains are closed paths", len(paths) == len(closed), where)
    for k, (d, chain) in enumerate(zip(paths, sorted(closed, key=lambda one: ORDER.index(one.kind)))):
        file = folder / f"fill{k}.svg"
        file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}"><path fill="#000" d="{d}"/></svg>')
        ask("rsvg-convert", "-o", folder / "fill.png", "--background-color", "white", file)
        covered = float((1.0 - read_png(folder / "fill.png")[:, :, 0] / 255.0).sum())
        # Anti-aliasing rounds each pixel of the border by up to a level of librsvg's 15 x 17 samples.
        length = float(numpy.hypot(*numpy.diff(chain.outline(), axis=0).T).sum())
        check("closed silhouettes fill their area", abs(covered - abs(chain.area())) <= 0.01 * length + 0.5,
              f"{where}: {covered} instead of {chain.area()}")
    return len(closed)


def check_dxf(path, chains, page_scale, where):
    drawing = ezdxf.readfile(path)
    check("ezdxf's audit finds nothing", not drawing.audit().errors, where)
    entities = list(drawing.modelspace())
    check("an entity a chain", len(entities) == len(chains), f"{where}: {len(entities)} instead of {len(chains)}")
    wanted = collections.Counter(f"{chain.kind}_{'visible' if chain.visible else 'hidden'}".upper() for chain in chains)
    check("layers of DXF", collections.Counter(entity.dxf.layer for entity in entities) == wanted, where)
    names = {layer.dxf.name for layer in drawing.layers}
    check("layers are in the table", set(wanted) <= names, f"{where}: {names}")
    if "--curves" in where:
        check_fitted(entities, chains, page_scale, where)
        return
    left = [chain for chain in chains]
    for entity in entities:
        check("entities are polylines", entity.dxftype() == "POLYLINE", where)
        points = numpy.array([[v.dxf.location.x, v.dxf.location.y] for v in entity.vertices]) / page_scale
        points[:, 1] = HEIGHT - points[:, 1]
        match = [chain for chain in left if chain.px.shape == points.shape and chain.closed == bool(entity.is_closed) and
                 numpy.abs(chain.px - points).max() <= 1e-5]
        check("coordinates of DXF are the graph's", len(match) >= 1, f"{where}: {entity.dxf.layer}")
        check("on the layer of their class", entity.dxf.layer.startswith(match[0].kind.upper()), where)
        left.remove(match[0])


def check_fitted(entities, chains, page_scale, where):
    """Polylines with bulges, and circles: each runs along a chain of its layer, and the chain along it."""
    left = list(chains)
    for entity in entities:
        points = numpy.array([[p.x, p.y] for p in ezdxf.path.make_path(entity).flattening(0.001)]) / page_scale
        points[:, 1] = HEIGHT - points[:, 1]
        match = [chain for chain in left if entity.dxf.layer.startswith(chain.kind.upper()) and
                 farthest(points, chain.outline()) <= FIT and farthest(chain.px, points) <= FIT]
        check("fitted curves of DXF run along the graph's", len(match) >= 1, f"{where}: {entity.dxf.layer} from {points[0]}")
        left.remove(match[0])


def farthest(points, line):
    """How far points lie from a polyline: the worst."""
    a, d = line[:-1], numpy.diff(line, axis=0)
    t = numpy.einsum("pki,ki->pk", points[:, None, :] - a[None, :, :], d) / numpy.maximum((d * d).sum(axis=1), 1e-300)
    nearest = a[None, :, :] + numpy.clip(t, 0.0, 1.0)[:, :, None] * d[None, :, :]
    return float(numpy.linalg.norm(points[:, None, :] - nearest, axis=2).min(axis=1).max())


def style_sheet(folder):
    file = folder / "style.css"
    file.write_text("".join(f".{kind} {{ stroke: {color}; stroke-width: {STROKE:g}; stroke-dasharray: none; }}\n" for kind, color in COLORS.items()))
    return file


def run(limn, folder):
    folder.mkdir(parents=True, exist_ok=True)
    inkscape = shutil.which("inkscape")
    for number, (scene, options, scale) in enumerate(CASES):
        where = " ".join((scene, *options))
        files = [folder / f"{number}{ending}" for ending in (".svg", ".pdf", ".dxf", ".json")]
        ask(limn, "contours", scene, "--size", f"{WIDTH}x{HEIGHT}", "--style", style_sheet(folder), *options, "-q",
            *[part for file in files for part in ("-o", file)])
        graph = json.loads(files[3].read_text())
        chains = [Chain(graph, one) for one in graph["chains"]]
        if "--hidden" not in options:
            chains = [chain for chain in chains if chain.visible]
        if "--curves" not in options:
            check_svg(files[0], chains, where)
        page = 254.0 / WIDTH if "--page" in options else 1.0
        check_dxf(files[2], chains, page, where)
        closed = check_fill(folder, files[0], chains, where) if scale == 1.0 and "--curves" not in options else 0
        # Hidden lines have the same style here, and are painted first.
        ordered = [chain for chain in chains if not chain.visible] + [chain for chain in chains if chain.visible]
        size = (round(scale * WIDTH), round(scale * HEIGHT))
        # Fitted curves may lie off the chain by their tolerance, and poppler draws them as chords.
        edge = EDGE + FIT + CHORDS if "--curves" in options else EDGE
        picture, certain = expected_picture(ordered, size, scale, edge) if "--hidden" not in options else hidden_first(chains, size, scale)
        shown = {}
        ask("rsvg-convert", "-d", "96", "-p", "96", "-o", folder / "rsvg.png", "--background-color", "white", files[0])
        shown["rsvg"] = read_png(folder / "rsvg.png")
        ask("pdftoppm", "-r", "96", "-singlefile", files[1], folder / "poppler")
        shown["poppler"] = read_ppm(folder / "poppler.ppm")
        if inkscape:
            ask(inkscape, "--export-type=png", "--export-dpi=96", "--export-background=white", "--export-background-opacity=1",
                f"--export-filename={folder / 'inkscape.png'}", files[0])
            shown["inkscape"] = read_png(folder / "inkscape.png")
        told = [f"{program} {compare_picture(program, one, picture, certain, where)[0]:g}/255" for program, one in shown.items()]
        edges = float(numpy.abs(shown["rsvg"] - shown["poppler"]).max())
        print(f"{where}: {len(chains)} chains, {closed} closed and filled; {', '.join(told)} off in {certain.mean():.1%} of the pixels; "
              f"at edges rsvg and poppler differ by up to {edges:g}/255")
    if not inkscape:
        print("no inkscape: that comparison was skipped")
    for what, count in checks.items():
        print(f"{count:6} {what}")


def hidden_first(chains, size, scale):
    """Pictures with both kinds of lines: hidden ones of all classes lie below."""
    below, sure_below = expected_picture([chain for chain in chains if not chain.visible], size, scale)
    above, sure_above = expected_picture([chain for chain in chains if chain.visible], size, scale)
    drawn = above.min(axis=2) < 255
    below[drawn] = above[drawn]
    return below, sure_above & (sure_below | drawn)


if __name__ == "__main__":
    run(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]))
