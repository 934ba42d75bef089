#!/usr/bin/env python3
"""Bad input of every kind at the program's public door: a clear line and exit 1, or a FAIL verdict and exit 2.

usage: bad_input_test.py ROOMCAL
"""

import json
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

ROOMCAL = pathlib.Path(sys.argv[1])
CAMCHAIN = """cam0:
  camera_model: pinhole
  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]
  distortion_model: radtan
  intrinsics: [300.0, 300.0, 159.5, 119.5]
  resolution: [320, 240]
"""


def png(path, width=320, height=240, level=128):
    """A flat grey PNG."""

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    rows = b"".join(b"\0" + bytes([level]) * width for _ in range(height))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


class BadInput(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.map, self.device, self.shot = (self.folder / n for n in ("m.room", "d.yaml", "shot"))
        self.shot.mkdir()
        png(self.shot / "cam0.png")
        markers = self.folder / "m.csv"
        markers.write_text("id,x,y,z,nx,ny,nz,radius\n" + "".join(
            f"{i},{0.31 * (i % 5) + 0.01 * i},{0.29 * (i // 5)},0,0,0,1,0.085\n" for i in range(20)))
        chain = self.folder / "chain.yaml"
        chain.write_text(CAMCHAIN)
        self.run_tool(0, "map", "import", markers, "-o", self.map)
        self.run_tool(0, "import", "kalibr", chain, "-o", self.device)

    def tearDown(self):
        self.temporary.cleanup()

    def run_tool(self, exit_code, *arguments, words=()):
        done = subprocess.run([str(ROOMCAL), *map(str, arguments)], capture_output=True, text=True, timeout=120, check=False)
        said = done.stdout + done.stderr
        self.assertEqual(done.returncode, exit_code, f"{arguments}: {said}")
        for word in words:
            self.assertIn(word, said)
        return said

    def calibrate(self, exit_code, *words, **changed):
        inputs = {"--map": self.map, "--device": self.device, "--shot": self.shot, **changed}
        report = self.folder / "r.json"
        self.run_tool(exit_code, "calibrate", *(x for pair in inputs.items() for x in pair), "--json", report, words=words)
        return json.loads(report.read_text()) if report.exists() else None

    def test_shot_without_markers_is_a_fail_verdict(self):
        result = self.calibrate(2, "FAIL_RETRY", "cam0")
        self.assertNotIn("T_room_sensor", result["sensors"]["cam0"])

    def test_black_and_white_images_are_fail_verdicts(self):
        for level, word in ((0, "light on"), (255, "overexposed")):
            png(self.shot / "cam0.png", level=level)
            self.calibrate(2, "FAIL_RETRY", word)

    def test_image_of_other_size_is_a_fail_verdict(self):
        png(self.shot / "cam0.png", width=100, height=80)
        self.calibrate(2, "100x80", "320x240")

    def test_damaged_images_are_named(self):
        for body in (b"", b"no image at all", (self.shot / "cam0.png").read_bytes()[:60]):
            (self.shot / "cam0.png").write_bytes(body)
            self.calibrate(2, "cam0.png", "FAIL_RETRY")
            self.run_tool(1, "detect", self.shot / "cam0.png", words=["cam0.png"])

    def test_empty_or_missing_shot_folder_is_named(self):
        self.calibrate(1, "no such folder", **{"--shot": self.folder / "nowhere"})
        empty = self.folder / "empty"
        empty.mkdir()
        self.calibrate(1, "holds no image", **{"--shot": empty})

    def test_damaged_map_is_refused(self):
        whole = self.map.read_bytes()
        flipped = bytearray(whole)
        flipped[len(whole) // 2] ^= 4
        for body in (b"", whole[:40], whole[:-1], bytes(flipped), b"x" * 1000):
            self.map.write_bytes(body)
            self.calibrate(1, "m.room")

    def test_nan_in_device_is_named(self):
        self.device.write_text(self.device.read_text().replace("300", ".nan", 1))
        self.calibrate(1, "d.yaml")

    def test_numbers_beyond_any_device_are_named(self):
        text = self.device.read_text()
        for old, new in (("[320, 240]", "[1000000000, 1000000000]"), ("[300, 300", "[1e300, 300")):
            self.assertIn(old, text)
            self.device.write_text(text.replace(old, new, 1))
            self.calibrate(1, "d.yaml: cam0")

    def test_nan_is_no_option(self):
        for arguments in (("map", "compare", self.map, self.map, "--gate"),
                          ("simulate", "shot", "--room", "r", "--device", "tls", "-o", "o", "--blur"),
                          ("evaluate", "anchor-room", "f.yaml", "--map-sigma"),
                          ("map", "noise", self.map, "-o", self.map, "--sigma")):
            said = self.run_tool(105, *arguments, "nan")
            self.assertIn("nan is not a number from", said)

    def test_binary_noise_says_that_not_all_is_listed(self):
        picture = self.folder / "noise.pgm"
        picture.write_bytes(b"P5\n640 480\n255\n" + bytes(255 * (b & 1) for b in random.Random(1).randbytes(640 * 480)))
        report = self.folder / "noise.json"
        self.run_tool(2, "detect", picture, "--json", report, words=["noise.pgm", "left out"])
        self.assertFalse(any(m["status"] == "ok" for m in json.loads(report.read_text())["images"][0]["markers"]))

    def test_output_that_cannot_be_written_is_named(self):
        self.run_tool(1, "detect", self.shot / "cam0.png", "--draw", self.device, words=["d.yaml", "folder"])
        self.run_tool(1, "calibrate", "--map", "/dev/null", "--device", self.device, "--shot", self.shot,
                      words=["/dev/null", "name a file"])
        self.run_tool(1, "detect", self.shot / "cam0.png", "--json", "/proc/nothing/here.json", words=["/proc/nothing"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
