#!/usr/bin/env python3
"""Shots of the paper's four devices, simulated by the program's own door, calibrated by it and measured against truth.

usage: simulated_devices_test.py ROOMCAL

Cameras are rendered at a fraction of their resolution: the field of view and everything about the LiDARs stay.
"""

import json
import pathlib
import tempfile
import unittest

from real_data_test import LIDAR_BAR, SHOT_BARS, errors, inverse, matmul, observed_errors, roomcal, weak_axes

# device -> scale of its cameras, bar of its cameras
DEVICES = {
    "stereo_rig": (0.5, SHOT_BARS["stereo"]),
    "mobile_robot": (0.5, SHOT_BARS["robot"]),
    "backpack": (0.2, SHOT_BARS["backpack"]),
    "tls": (0.15, SHOT_BARS["tls"]),
}


# An L with its ceiling.
L_ROOM = """
walls:
  - {name: floor, corner: [0, 0, 0], right: [1, 0, 0], up: [0, 1, 0], size: [3, 4]}
  - {name: floor arm, corner: [3, 0, 0], right: [1, 0, 0], up: [0, 1, 0], size: [2, 2]}
  - {name: south, corner: [5, 0, 0], right: [-1, 0, 0], size: [5, 2.6], keep_out: [[1, 0, 2, 2]]}
  - {name: west, corner: [0, 0, 0], right: [0, 1, 0], size: [4, 2.6]}
  - {name: north, corner: [0, 4, 0], right: [1, 0, 0], size: [3, 2.6]}
  - {name: inner east, corner: [3, 4, 0], right: [0, -1, 0], size: [2, 2.6]}
  - {name: inner north, corner: [3, 2, 0], right: [1, 0, 0], size: [2, 2.6]}
  - {name: east, corner: [5, 2, 0], right: [0, -1, 0], size: [2, 2.6]}
  - {name: ceiling, corner: [3, 0, 2.6], right: [-1, 0, 0], up: [0, 1, 0], size: [3, 4]}
  - {name: ceiling arm, corner: [5, 0, 2.6], right: [-1, 0, 0], up: [0, 1, 0], size: [2, 2]}
"""


class SimulatedDevices(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.room, cls.map = cls.folder / "room", cls.folder / "room.room"
        roomcal("simulate", "room", "-o", cls.room, "--seed", 5, "--pillar")
        roomcal("map", "import", cls.room / "markers.csv", "-o", cls.map)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def simulate(self, device, name, *more, room=None):
        roomcal("simulate", "shot", "--room", room or self.room, "--device", device, "-o", self.folder / name, "--scale",
                DEVICES[device][0], *more)
        return self.folder / name

    def calibrate(self, shot, *more, room_map=None):
        config, report = self.folder / "device.yaml", self.folder / "result.json"
        roomcal("import", "kalibr", shot / "camchain.yaml", "--nominal", shot / "nominal.json", "-o", config)
        roomcal("calibrate", "--map", room_map or self.map, "--device", config, "--shot", shot, "--json", report, *more)
        return json.loads(report.read_text()), json.loads((shot / "truth.json").read_text())

    def check(self, what, result, truth, bar):
        T_true = {name: pose["T"] for name, pose in truth["T_room_sensor"].items()}
        self.assertEqual(sorted(T_true), sorted(result["sensors"]))
        for pair in result["pairs"]:
            a, b = pair["a"], pair["b"]
            if a > b:  # the other way around it is the same
                continue
            T_a_b = matmul(inverse(T_true[a]), T_true[b])
            if a.startswith("cam") and b.startswith("cam"):
                limit, (mm, deg) = bar, errors(pair["T_a_b"], T_a_b)
            else:
                limit, (mm, deg) = LIDAR_BAR, observed_errors(pair["T_a_b"], T_a_b, weak_axes(result, {a, b}, b))
            print(f"{what} {a}-{b}: {mm:.3f} mm (bar {limit[0]}), {deg:.4f} deg (bar {limit[1]})")
            self.assertLessEqual(mm, limit[0])
            self.assertLessEqual(deg, limit[1])

    def check_device(self, device):
        shot = self.simulate(device, device, "--sweeps", 3)
        for sweeps in ("1", "0"):
            result, truth = self.calibrate(shot, "--sweeps", sweeps)
            self.check(device, result, truth, DEVICES[device][1])

    def test_many_shots_have_one_truth_and_other_noise(self):
        self.simulate("mobile_robot", "many", "--shots", 2, "--format", "pgm", "--sweeps", 1)
        shots = [self.folder / "many" / name for name in ("shot000", "shot001")]
        truths = []
        for shot in shots:
            result, truth = self.calibrate(shot)
            self.check(shot.name, result, truth, DEVICES["mobile_robot"][1])
            truths.append(truth)
        self.assertEqual(truths[0]["T_room_sensor"], truths[1]["T_room_sensor"])
        for file in ("cam0.pgm", "cam3.pgm", "lidar0.pcap"):
            first, second = ((shot / file).read_bytes() for shot in shots)
            self.assertEqual(len(first), len(second))
            self.assertNotEqual(first, second)
        self.assertTrue((shots[0] / "cam0.pgm").read_bytes().startswith(b"P5\n640 360\n255\n"))

    def test_every_lidar_unit_meets_truth(self):
        for unit in ("vlp32c", "xt32", "os0-32", "os1-64"):
            shot = self.simulate("mobile_robot", unit, "--lidar", unit, "--sweeps", 1)
            result, truth = self.calibrate(shot)
            self.check(unit, result, truth, DEVICES["mobile_robot"][1])

    def test_room_of_other_layout_with_furniture_meets_truth(self):
        walls, room, room_map = self.folder / "l.yaml", self.folder / "l", self.folder / "l.room"
        walls.write_text(L_ROOM)
        roomcal("simulate", "room", "--walls", walls, "--furniture", 4, "--markers", 400, "--seed", 2, "-o", room)
        roomcal("map", "import", room / "markers.csv", "-o", room_map)
        result, truth = self.calibrate(self.simulate("mobile_robot", "in_l", "--sweeps", 1, room=room), room_map=room_map)
        self.check("in an L", result, truth, DEVICES["mobile_robot"][1])

    def test_same_seed_gives_the_same_files(self):
        first, second = (self.simulate("tls", name, "--tls-step", 2, "--seed", 3) for name in ("a", "b"))
        for file in ("cam0.png", "cam1.png", "lidar0.pcd", "truth.json", "nominal.json", "camchain.yaml"):
            self.assertEqual((first / file).read_bytes(), (second / file).read_bytes(), file)


for one in DEVICES:
    setattr(SimulatedDevices, f"test_{one}_meets_truth", lambda self, d=one: self.check_device(d))

if __name__ == "__main__":
    unittest.main(argv=["simulated_devices_test"], verbosity=2)
