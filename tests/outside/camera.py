"""A pinhole camera: where world points appear in the picture. Pixel coordinates start at the top left corner; pixel centres lie at +0.5."""
import dataclasses

import numpy as np


@dataclasses.dataclass
class Camera:
    eye: tuple
    target: tuple
    fov: float  # degrees, vertical
    size: tuple  # pixels: width, height
    up: tuple = (0.0, 1.0, 0.0)

    def __post_init__(self):
        backward = np.subtract(self.eye, self.target)
        backward /= np.linalg.norm(backward)
        right = np.cross(self.up, backward)
        right /= np.linalg.norm(right)
        self.axes = np.stack([right, np.cross(backward, right), backward])  # rows: right, up, backward
        self.focal_px = 0.5 * self.size[1] / np.tan(0.5 * np.radians(self.fov))

    def project(self, points):
        seen = (points - np.asarray(self.eye)) @ self.axes.T
        scale = self.focal_px / -seen[..., 2:]
        return 0.5 * np.asarray(self.size, float) + scale * seen[..., :2] * (1.0, -1.0)

    def to_eye(self, points):
        """Unit vectors from the points towards the eye, and their distances."""
        ways = np.asarray(self.eye) - points
        distances = np.linalg.norm(ways, axis=-1)
        return ways / distances[..., None], distances

    def outward(self, normals):
        """Unit, px: the picture of the normals where a surface is seen edge-on."""
        flat = (normals @ self.axes.T)[..., :2] * (1.0, -1.0)
        return flat / np.linalg.norm(flat, axis=-1, keepdims=True)

    def toml(self):
        numbers = [", ".join(repr(float(x)) for x in v) for v in (self.eye, self.target, self.up)]
        return (f"[camera]\neye = [{numbers[0]}]\ntarget = [{numbers[1]}]\nup = [{numbers[2]}]\n"
                f"fov = {self.fov!r}\nsize = [{self.size[0]}, {self.size[1]}]\n")
