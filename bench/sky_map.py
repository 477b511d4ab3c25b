"""sky_map.py OUT.exr [OPTIONS]: a clear sky as an environment map, without its sun or with it.

Latitude-longitude, as tdpt-render reads it: centre of the picture -Z, three quarters of its width +X, top +Y.

The sky is CIE's standard clear sky (CIE S 011/ISO 15469, type 12, low illuminance turbidity): in the zenith angle Z of
a place and its angle s to the sun its luminance is in proportion to
  (1 - exp(-0.32 / cos Z)) (1 + 10 (exp(-3 s) - exp(-3 pi / 2)) + 0.45 cos^2 s),
scaled so that it brings a horizontal plane the irradiance pi, as a sky of radiance 1 all over would. The sun is a disc
of 0.53 degrees with ten times that irradiance across its rays (a clear day's diffuse light is about a tenth of the
direct, Meinel and Meinel 1976): a radiance of 4.7e5. A texel that it covers in part has the mean, so the map keeps its
irradiance whatever the size. The ground below the horizon is grey and reflects `--ground` of all that reaches it.
"""
import argparse
import sys

import numpy as np

import exr_file

SUN_ANGLE = 0.53  # degrees across
SUN_RATIO = 10.0  # irradiance across its rays to that of the sky on the ground
POINTS = 512  # along the radius of the sun's disc, and around it
# Linear Rec.709, luminance 1.
SKY_TINT, SUN_TINT = (np.array(c) / np.dot(c, (0.2126, 0.7152, 0.0722)) for c in ((0.6, 0.95, 1.7), (1.0, 0.93, 0.8)))


def towards(azimuth, altitude):
    """Unit vector; degrees, azimuth from -Z towards +X, clockwise seen from above."""
    a, h = np.radians(azimuth), np.radians(altitude)
    return np.array([np.sin(a) * np.cos(h), np.sin(h), -np.cos(a) * np.cos(h)])


def directions(column, row, width, height):
    """Of places in the picture, in texels from its upper left corner: ... x 3."""
    azimuth = 2 * np.pi * (np.asarray(column) / width - 0.5)
    polar = np.pi * np.asarray(row) / height
    return np.stack([np.sin(azimuth) * np.sin(polar), np.cos(polar), -np.cos(azimuth) * np.sin(polar)], -1)


def solid_angles(width, height):
    """Of the texels of each row [sr]."""
    return -np.diff(np.cos(np.pi * np.arange(height + 1) / height)) * 2 * np.pi / width


def middles(width, height):
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    return directions(x, y, width, height)


def irradiance(radiance, normal):
    """On a plane that nothing hides [W/m2]; of the texels as they are, seen at their middles."""
    height, width = radiance.shape[:2]
    cosine = np.maximum(middles(width, height) @ normal, 0)
    return np.einsum("yxc,yx,y->c", np.atleast_3d(radiance), cosine, solid_angles(width, height))


def clear_sky(width, height, sun):
    """Luminance, 0 below the horizon."""
    w = middles(width, height)
    to_sun = np.arccos(np.clip(w @ sun, -1, 1))
    above = w[..., 1] > 0
    gradation = 1 - np.exp(-0.32 / np.where(above, w[..., 1], 1))
    indicatrix = 1 + 10 * (np.exp(-3 * to_sun) - np.exp(-1.5 * np.pi)) + 0.45 * np.cos(to_sun) ** 2
    sky = np.where(above, gradation * indicatrix, 0)
    return sky * np.pi / irradiance(sky, np.array([0.0, 1.0, 0.0]))[0]


def raster(w, width, height):
    """Column and row of directions, in texels from the upper left corner."""
    column = width * (0.5 + np.arctan2(w[..., 0], -w[..., 2]) / (2 * np.pi))
    return column, height * np.arccos(np.clip(w[..., 1], -1, 1)) / np.pi


def on_sun(sun):
    """Directions evenly over its disc: POINTS^2 x 3."""
    half = np.radians(SUN_ANGLE) / 2
    steps = (np.arange(POINTS) + 0.5) / POINTS
    cosine, turn = np.meshgrid(1 - (1 - np.cos(half)) * steps, 2 * np.pi * steps)
    sine = np.sqrt(1 - cosine**2)
    side = np.cross(sun, (1.0, 0.0, 0.0) if abs(sun[0]) < 0.5 else (0.0, 1.0, 0.0))
    side /= np.linalg.norm(side)
    other = np.cross(sun, side)
    w = cosine[..., None] * sun + (sine * np.cos(turn))[..., None] * side + (sine * np.sin(turn))[..., None] * other
    return w.reshape(-1, 3)


def sun_share(width, height, sun):
    """Of the sun's solid angle the share that each texel holds."""
    x, y = (np.floor(c).astype(int) for c in raster(on_sun(sun), width, height))
    texels = np.minimum(y, height - 1) * width + x % width
    return np.bincount(texels, minlength=width * height).reshape(height, width) / texels.size


def sky_map(width, height, sun, with_sun, ground=0.2):
    """Radiance, height x width x 3."""
    radiance = clear_sky(width, height, sun)[..., None] * SKY_TINT
    reaches_ground = np.pi * SKY_TINT
    if with_sun:
        share = sun_share(width, height, sun) / solid_angles(width, height)[:, None]
        radiance += (SUN_RATIO * np.pi * share)[..., None] * SUN_TINT
        reaches_ground = reaches_ground + SUN_RATIO * np.pi * max(sun[1], 0) * SUN_TINT
    radiance[height // 2 :] = ground * reaches_ground / np.pi
    return radiance


def main():
    p = argparse.ArgumentParser(prog="sky_map.py", description="a clear sky as an environment map")
    p.add_argument("out")
    p.add_argument("--width", type=int, default=256, help="texels; the height is half of it")
    p.add_argument("--azimuth", type=float, default=0, help="of the sun, degrees from -Z towards +X")
    p.add_argument("--altitude", type=float, default=35, help="of the sun, degrees above the horizon")
    p.add_argument("--sun", action="store_true", help="with the sun itself")
    p.add_argument("--ground", type=float, default=0.2, help="albedo of the ground")
    a = p.parse_args()
    if a.width < 8 or a.width % 4:
        p.error("--width: expected a multiple of 4 from 8 on")
    if not 1 <= a.altitude <= 90:
        p.error("--altitude: expected 1 to 90 degrees")
    sun = towards(a.azimuth, a.altitude)
    words = " ".join(["sky_map.py", *sys.argv[2:]])
    exr_file.write(a.out, sky_map(a.width, a.width // 2, sun, a.sun, a.ground), f"made by {words}")


if __name__ == "__main__":
    main()
