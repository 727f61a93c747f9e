#!/usr/bin/env python3
"""This project's own renderer, in the place of yours: draws the outlines of shape.toml's balls as SVG.

draw.py FILE [--regression]: with it the large ball comes out 1 % too small and the small one is forgotten.
"""
import sys

WIDTH, HEIGHT, PIXELS_PER_UNIT = 320, 240, 240 / 3.0
BALLS = ((0.0, 0.0, 1.0), (1.35, 0.6, 0.25))


def main():
    broken = "--regression" in sys.argv
    balls = [(0.0, 0.0, 0.99)] if broken else BALLS
    with open(sys.argv[1], "w") as svg:
        svg.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}">\n')
        for x, y, radius in balls:
            svg.write(f'<circle cx="{WIDTH / 2 + x * PIXELS_PER_UNIT}" cy="{HEIGHT / 2 - y * PIXELS_PER_UNIT}" r="{radius * PIXELS_PER_UNIT}" '
                      'fill="none" stroke="black"/>\n')
        svg.write("</svg>\n")


if __name__ == "__main__":
    main()
