"""sky_map.py against closed forms, and the files of exr_file.py against a reader that shares no code with it."""
import os
import shutil
import struct
import subprocess
import tempfile
import unittest
import zlib

import numpy as np

import exr_file
import sky_map

UP = np.array([0.0, 1.0, 0.0])


def read_back(content):
    """Pixels of an OpenEXR file, rows from the top: what the format's description says of ZIP scanlines."""
    at, kinds, window = 8, None, None
    assert content[:8] == bytes([0x76, 0x2F, 0x31, 0x01, 2, 0, 0, 0])
    while content[at]:
        name, kind, rest = content[at:].split(b"\0", 2)
        (size,) = struct.unpack("<i", rest[:4])
        value = rest[4 : 4 + size]
        at += len(name) + len(kind) + 6 + size
        if name == b"channels":
            kinds = value
        if name == b"dataWindow":
            window = struct.unpack("<4i", value)
    width, height = window[2] + 1, window[3] + 1
    assert [kinds[18 * i : 18 * i + 1] for i in range(3)] == [b"B", b"G", b"R"]
    size = {1: 2, 2: 4}[kinds[2]]
    picture = np.zeros((height, width, 3))
    for (place,) in struct.iter_unpack("<Q", content[at + 1 : at + 1 + 8 * ((height + 15) // 16)]):
        y, length = struct.unpack("<2i", content[place : place + 8])
        raw = content[place + 8 : place + 8 + length]
        lines = min(16, height - y)
        if length < lines * width * 3 * size:
            steps = zlib.decompress(raw)
            total, parted = 128, bytearray()
            for step in steps:
                total = (total + step - 128) % 256
                parted.append(total)
            half = (len(parted) + 1) // 2
            whole = bytearray(len(parted))
            whole[::2], whole[1::2] = parted[:half], parted[half:]
            raw = bytes(whole)
        block = np.frombuffer(raw, "<f2" if size == 2 else "<f4").reshape(lines, 3, width)
        picture[y : y + lines] = block.transpose(0, 2, 1)[:, :, ::-1]
    return picture, size


class Files(unittest.TestCase):
    def test_read_back_as_they_were(self):
        rng = np.random.default_rng(5)
        for shape in ((1, 1, 3), (16, 8, 3), (37, 20, 3)):
            smooth = np.linspace(0, 900, np.prod(shape)).reshape(shape)
            noise = rng.uniform(0, 60000, shape)
            for rgb in (smooth, noise, np.zeros(shape)):
                picture, size = read_back(exr_file.content(rgb, "words"))
                np.testing.assert_array_equal(picture, rgb.astype(np.float16).astype(float))
                self.assertEqual(size, 2)

    def test_are_read_as_the_other_reader_does(self):
        rng = np.random.default_rng(6)
        for peak in (0.01, 900, 467000):
            for shape in ((1, 1, 3), (37, 20, 3)):
                content = exr_file.content(rng.uniform(0, peak, shape) ** 2 / peak, "more\nwords")
                picture, strings = exr_file.parse(content)
                np.testing.assert_array_equal(picture, read_back(content)[0])
                self.assertEqual(strings, {"comments": "more\nwords"})
        with self.assertRaisesRegex(ValueError, "expected channels B G R"):
            exr_file.parse(content.replace(b"R\0", b"S\0", 1))

    def test_are_float_beyond_the_range_of_half(self):
        rgb = np.full((20, 10, 3), 0.1)
        rgb[3, 4] = 467000.25, 65504, 65505
        picture, size = read_back(exr_file.content(rgb))
        self.assertEqual(size, 4)
        np.testing.assert_array_equal(picture[3, 4], [467000.25, 65504, 65505])
        np.testing.assert_array_equal(picture[0, 0], np.float16(0.1))

    def test_are_read_by_openexr(self):
        if not shutil.which("exrmaketiled"):
            self.skipTest("no exrmaketiled here (Debian: openexr)")
        with tempfile.TemporaryDirectory() as folder:
            for name, peak in (("half", 1.0), ("float", 1e6)):
                rgb = np.random.default_rng(3).uniform(0, peak, (40, 30, 3))
                exr_file.write(f"{folder}/{name}.exr", rgb, "words")
                subprocess.run(["exrmaketiled", f"{folder}/{name}.exr", f"{folder}/tiled.exr"], check=True)


class Directions(unittest.TestCase):
    def test_are_those_of_tdpt_render(self):
        width, height = 64, 32
        for place, w in (((32, 16), (0, 0, -1)), ((48, 16), (1, 0, 0)), ((16, 16), (-1, 0, 0)), ((0, 16), (0, 0, 1)),
                         ((5, 0), (0, 1, 0))):
            np.testing.assert_allclose(sky_map.directions(*place, width, height), w, atol=1e-12)
        np.testing.assert_allclose(sky_map.towards(90, 0), (1, 0, 0), atol=1e-12)
        np.testing.assert_allclose(sky_map.towards(0, 0), (0, 0, -1), atol=1e-12)

    def test_and_places_belong_together(self):
        x, y = np.meshgrid(np.arange(16) + 0.5, np.arange(8) + 0.25)
        column, row = sky_map.raster(sky_map.directions(x, y, 16, 8), 16, 8)
        np.testing.assert_allclose(column, x, atol=1e-9)
        np.testing.assert_allclose(row, y, atol=1e-9)

    def test_solid_angles_fill_the_sphere(self):
        self.assertAlmostEqual(64 * sky_map.solid_angles(64, 32).sum(), 4 * np.pi)


class Skies(unittest.TestCase):
    def setUp(self):
        self.sun = sky_map.towards(45, 34)

    def test_sky_lights_the_ground_as_radiance_1_does(self):
        sky = sky_map.sky_map(128, 64, self.sun, False, ground=0)
        self.assertAlmostEqual((sky_map.irradiance(sky, UP) @ (0.2126, 0.7152, 0.0722)) / np.pi, 1)

    def test_luminances_are_those_of_the_standard(self):
        # ISO 15469: luminance over that of the zenith, sun 60 degrees from it; type 12. By hand.
        sky = sky_map.clear_sky(1024, 512, sky_map.towards(0, 30))

        def at(azimuth, altitude):
            column, row = sky_map.raster(sky_map.towards(azimuth, altitude), 1024, 512)
            return sky[int(row), int(column) % 1024]

        zenith = sky[0].mean()
        f = lambda s: 1 + 10 * (np.exp(-3 * s) - np.exp(-1.5 * np.pi)) + 0.45 * np.cos(s) ** 2
        for azimuth, altitude, from_sun in ((0, 60, 30), (180, 60, 90), (180, 30, 120)):
            gradation = (1 - np.exp(-0.32 / np.sin(np.radians(altitude)))) / (1 - np.exp(-0.32))
            expected = gradation * f(np.radians(from_sun)) / f(np.radians(60))
            self.assertAlmostEqual(at(azimuth, altitude) / zenith / expected, 1, delta=0.01)

    def test_sun_keeps_its_irradiance_at_every_size(self):
        for width in (8, 64, 256, 1024):
            size = (width, width // 2)
            both = [sky_map.sky_map(*size, self.sun, with_sun, ground=0) for with_sun in (True, False)]
            flux = np.einsum("yxc,y->c", both[0] - both[1], sky_map.solid_angles(*size))
            np.testing.assert_allclose(flux, 10 * np.pi * sky_map.SUN_TINT)

    def test_sun_is_a_disc_of_its_radiance_where_texels_are_fine(self):
        size = (8192, 4096)
        share = sky_map.sun_share(*size, self.sun)
        radiance = 10 * np.pi * share / sky_map.solid_angles(*size)[:, None]
        disc = 10 * np.pi / (2 * np.pi * (1 - np.cos(np.radians(0.265))))
        self.assertGreater(disc, 4e5)
        within = radiance[radiance > 0.9 * disc]
        self.assertAlmostEqual(np.median(within) / disc, 1, delta=0.02)
        where = np.argwhere(share > 0) + 0.5
        w = sky_map.directions(where[:, 1], where[:, 0], *size)
        self.assertGreater((w @ self.sun).min(), np.cos(np.radians(0.33)))

    def test_ground_reflects_what_reaches_it(self):
        for with_sun in (False, True):
            sky = sky_map.sky_map(256, 128, self.sun, with_sun, ground=0.3)
            reaches = sky_map.irradiance(sky, UP)
            # The sun stands up to half a texel from where it should.
            np.testing.assert_allclose(np.pi * sky[-1, 0] / 0.3, reaches, rtol=0.02)

    def test_those_of_testdata_are_these(self):
        folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "testdata", "environments")
        for name, with_sun in (("clear", False), ("clear-sun", True)):
            with open(os.path.join(folder, name + ".exr"), "rb") as file:
                content = file.read()
            self.assertLess(len(content), 100000)
            picture, size = read_back(content)
            self.assertEqual(size, 4 if with_sun else 2)
            expected = sky_map.sky_map(256, 128, sky_map.towards(45.7, 34.45), with_sun)
            np.testing.assert_allclose(picture, expected, rtol=1e-3)


if __name__ == "__main__":
    unittest.main()
