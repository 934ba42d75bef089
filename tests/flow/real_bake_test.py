#!/usr/bin/env python3
"""Rooms baked from surveys that nobody here made, measured against truth and against the paper's own map.

usage: real_bake_test.py ROOMCAL DATA    (DATA: folder with room-a/ and anchor-room/; absent: skipped, exit 77)

Prints every figure beside its bar. Only the program's public door is used: command line in, JSON out.
"""

import json
import pathlib
import sys
import tempfile
import unittest

from real_data_test import DATA, SHOT_BARS, errors, inverse, matmul, roomcal


class BakedRooms(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        survey = DATA / "room-a/survey"
        roomcal("bake", survey, "--stereo", survey / "camchain.yaml", "-o", cls.folder / "baked.room", "--json",
                cls.folder / "baked.json", "--save-detections", cls.folder / "survey.json")

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def compare(self, truth, baked, expect=0):
        roomcal("map", "compare", truth, baked, "--json", self.folder / "compare.json", expect=expect)
        return json.loads((self.folder / "compare.json").read_text())

    def test_survey_gives_the_room(self):
        figures = self.compare(DATA / "room-a/room/markers.csv", self.folder / "baked.room")
        baked = json.loads((self.folder / "baked.json").read_text())
        plane_mm = max(p["rms_mm"] for p in baked["structure"]["planes"])
        size = (self.folder / "baked.room").stat().st_size
        print(f"baked room-a: {figures['matched']} of {figures['markers_a']} and {figures['markers_b']} markers, RMS "
              f"{figures['rms_mm']:.3f} mm (bar 0.5), planes {plane_mm:.3f} mm (bar 0.3), {size} bytes (bar 65536)")
        self.assertEqual((figures["matched"], figures["markers_b"]), (figures["markers_a"], figures["markers_a"]))
        self.assertLessEqual(figures["rms_mm"], 0.5)
        self.assertLessEqual(plane_mm, 0.3)
        self.assertLessEqual(size, 65536)
        self.assertFalse(baked["scale"]["off"])

    def test_wrong_calibration_is_mended_and_said(self):
        chain = (DATA / "room-a/survey/camchain.yaml").read_text().splitlines()
        for sign in (1, -1):
            wrong, row = [], 0
            for line in chain:
                if "intrinsics:" in line:
                    head, numbers = line.split("[")
                    k = [float(x) for x in numbers.rstrip("] ").split(",")]
                    line = f"{head}[{k[0] * (1 + 0.002 * sign)}, {k[1] * (1 + 0.002 * sign)}, {k[2]}, {k[3]}]"
                elif line.lstrip().startswith("- [") and row < 3:
                    head, numbers = line.split("[")
                    r = [float(x) for x in numbers.rstrip("] ").split(",")]
                    line = f"{head}[{r[0]}, {r[1]}, {r[2]}, {r[3] * (1 + sign * 0.3 / 106.925)}]"
                    row += 1
                wrong.append(line)
            (self.folder / "wrong.yaml").write_text("\n".join(wrong) + "\n")
            roomcal("bake", self.folder / "survey.json", "--stereo", self.folder / "wrong.yaml", "-o",
                    self.folder / "wrong.room", "--json", self.folder / "wrong.json")
            figures = self.compare(DATA / "room-a/room/markers.csv", self.folder / "wrong.room")
            print(f"baked with a wrong calibration: RMS {figures['rms_mm']:.3f} mm (bar 2)")
            self.assertLessEqual(figures["rms_mm"], 2)
            self.assertTrue(json.loads((self.folder / "wrong.json").read_text())["scale"]["off"])

    def test_shots_with_the_baked_map(self):
        for device in SHOT_BARS:
            source, config = DATA / "room-a" / device, self.folder / f"{device}.yaml"
            roomcal("import", "kalibr", source / "camchain.yaml", "--nominal", source / "nominal.json", "-o", config)
            report = self.folder / f"{device}.json"
            roomcal("calibrate", "--map", self.folder / "baked.room", "--device", config, "--shot", source, "--json", report)
            result, truth = json.loads(report.read_text()), json.loads((source / "truth.json").read_text())
            T_room = {name: truth["T_room_sensor"][name]["T"] for name in truth["cameras"]}
            T_rig_room = inverse(T_room[result["rig_frame"]])
            for name in sorted(T_room):
                mm, deg = errors(result["sensors"][name]["T_rig_sensor"], matmul(T_rig_room, T_room[name]))
                print(f"{device} {name}, baked map: {mm:.3f} mm (bar 1), {deg:.4f} deg (bar 0.03)")
                self.assertLessEqual(mm, 1)
                self.assertLessEqual(deg, 0.03)


ANCHOR_CHAIN = """cam0:
  camera_model: pinhole
  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]
  distortion_model: radtan
  intrinsics: [1746.22, 1746.13, 1315.96, 1042.71]
  resolution: [2448, 2048]
cam1:
  camera_model: pinhole
  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]
  distortion_model: radtan
  intrinsics: [1742.78, 1742.45, 1306.30, 1021.95]
  resolution: [2448, 2048]
  T_cn_cnm1:
  - [0.999876743176, -0.003201628995, -0.015370361967, -0.120865]
  - [0.003134090315, 0.999985337381, -0.004416163643, -0.000505]
  - [0.015384275515, 0.004367447218, 0.999872116559, -0.002080]
  - [0.0, 0.0, 0.0, 1.0]
"""


class AnchorRoom(unittest.TestCase):
    def test_papers_room_from_its_key_points(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            room = DATA / "anchor-room/map_2021-01.yaml"
            (folder / "chain.yaml").write_text(ANCHOR_CHAIN)
            roomcal("bake", room, "--stereo", folder / "chain.yaml", "-o", folder / "a.room", "--json", folder / "a.json")
            baked = json.loads((folder / "a.json").read_text())
            left_px, right_px = baked["reprojection"]["median_px"]
            roomcal("map", "compare", room, folder / "a.room", "--json", folder / "c.json")
            figures = json.loads((folder / "c.json").read_text())
            shots = json.loads(self.evaluate(room, folder))
        baseline_mm, std_mm = baked["stereo"]["used"]["baseline_mm"], shots["baseline_mm"]["std"]
        print(f"anchor room: {figures['matched']} of 335 markers (bar 330), {left_px:.3f} / {right_px:.3f} px (bar 0.27 / "
              f"0.26), RMS {figures['rms_mm']:.2f} mm (bar 5), baseline {baseline_mm:.2f} mm (bar 120.9 +- 0.3), single-shot "
              f"deviation {std_mm:.3f} mm (bar 0.45)")
        self.assertGreaterEqual(figures["matched"], 330)
        self.assertLessEqual(left_px, 0.27)
        self.assertLessEqual(right_px, 0.26)
        self.assertLessEqual(figures["rms_mm"], 5)
        self.assertAlmostEqual(baseline_mm, 120.9, delta=0.3)
        self.assertLess(std_mm, 0.45)

    def evaluate(self, room, folder):
        roomcal("evaluate", "anchor-room", room, "--map", folder / "a.room", "--json", folder / "e.json")
        return (folder / "e.json").read_text()


if __name__ == "__main__":
    if DATA is None or not (DATA / "room-a").is_dir() or not (DATA / "anchor-room").is_dir():
        print(f"skipped: no measured data at {DATA}; set ROOMCAL_DATA to its folder")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0]], verbosity=2)
