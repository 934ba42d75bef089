#!/usr/bin/env python3
"""The whole story of a device, on board sim: sim_board_test.py ROOMCAL ROOMCALD

A person holds the button, watches progress and lamp, gets PASS, cuts the power, reads the record, compares, undoes,
exports, restores the factory record; presses during a run; floods the console; finds a device with trouble.
"""

import json
import os
import pathlib
import sys
import tempfile
import threading
import time

import device
from device import Roomcald, expect

POSITION_BAR_M = 0.001
LIDAR_BAR_M = 0.003
TEMPERATURE_C = 41.25


def truth_of(shot):
    extrinsics = json.loads((shot / "truth.json").read_text())["T_room_sensor"]
    return {name: entry["T"] for name, entry in extrinsics.items()}


def relative(T_room_a, T_room_b):
    """Translation of T_a_b."""
    d = [T_room_b[r][3] - T_room_a[r][3] for r in range(3)]
    return [sum(T_room_a[r][c] * d[r] for r in range(3)) for c in range(3)]


def check_against_truth(result, truth):
    for sensor in result["sensors"]:
        name = sensor["name"]
        expected = relative(truth["cam0"], truth[name])
        error = sum((sensor[axis] - e) ** 2 for axis, e in zip("xyz", expected)) ** 0.5
        bar = LIDAR_BAR_M if name.startswith("lidar") else POSITION_BAR_M
        expect(error < bar, f"{name}: {error * 1e3:.3f} mm from the truth")
        print(f"  {name}: {error * 1e3:.3f} mm from the truth, sigma {sensor['sigma_m'] * 1e3:.3f} mm")


class Lamp(threading.Thread):
    """Notes when the lamp changes."""

    def __init__(self, folder):
        super().__init__(daemon=True)
        self.file, self.changes, self.running = folder / "light" / "brightness", [], True
        self.start()

    def run(self):
        last = None
        while self.running:
            try:
                now = self.file.read_text().strip()
            except OSError:
                now = None
            if now in ("0", "1") or (now or "").isdigit():
                if now != last:
                    self.changes.append((time.monotonic(), now != "0"))
                    last = now
            time.sleep(0.01)


def calibrate_by_button(board, truth):
    lamp = Lamp(board.folder)
    pressing = threading.Thread(target=board.press, args=(3.3,))
    pressing.start()
    seen, percents = [], []
    while True:
        line = board.json_line()
        if line.get("ev") == "progress":
            seen.append(line["data"]["state"])
            percents.append(line["data"]["percent"])
        if line.get("ev") == "result":
            result = line["data"]
            break
    pressing.join()
    lamp.running = False
    expect(result["result"] == "PASS" and result["stored"], f"result {result}")
    expect(percents == sorted(percents), f"progress went back: {percents}")
    expect("GRAB" in seen, f"states {seen}")
    expect(len(lamp.changes) > 3, "the lamp did not tell")
    print(f"  progress: {', '.join(dict.fromkeys(seen))}; {result['total_ms']:.0f} ms from grab to store")
    check_against_truth(board.data("result"), truth)


def story(board, truth):
    board.wait_armed()
    expect(board.data("status")["store"] == "FACTORY", "a fresh device has its factory record")
    refused = board.ask("calibrate")
    expect(not refused["ok"] and "right" in refused["error"]["detail"], f"calibrate without rights: {refused}")
    calibrate_by_button(board, truth)

    before = board.data("history")["records"]
    board.cut_power()
    board.start()
    board.text = b""
    time.sleep(0.5)
    board.ask("status")
    board.wait_armed()
    expect(board.data("status")["store"] == "CALIBRATED", "the record survived the power cut")
    expect(board.data("history")["records"] == before, "the history survived the power cut")

    board.press(0.2)
    verified = board.event("result")
    expect(verified["kind"] == "verify" and verified["result"] == "PASS" and not verified["stored"], f"{verified}")
    expect(not board.data("result")["installed"]["moved"], "nothing has moved")
    difference = board.data("diff")
    expect(difference["from_generation"] == 0 and difference["to_generation"] == 1, f"{difference}")

    for form in ("json", "kalibr", "urdf", "tf", "autoware", "opencv"):
        expect(len(board.data("export", form)["document"]) > 200, f"export {form}")
    record = json.loads(board.data("export", "json")["document"])
    expect((record["temperature_c"], record["trigger"]) == (TEMPERATURE_C, "free"), f"circumstances: {record}")
    expect(not board.ask("export", "camera_info", "cam9")["ok"], "export of no camera")

    refused = board.ask("undo")
    expect(not refused["ok"], "undo wants service rights")
    board.press(10.5)  # the offer of the factory record, which then lapses or is taken
    undone = board.data("undo")
    expect(undone["store"] == "FACTORY" or undone["content_generation"] == 0, f"undo: {undone}")
    board.press(0.2)  # takes the offer
    records = wait_for(lambda: board.data("history")["records"], lambda r: r[0]["action"] == "factory-restored")
    expect(records[0]["action"] == "factory-restored", f"restored: {records[0]}")


def wait_for(read, holds, timeout=device.PATIENCE_S):
    """What read() says once holds() is true of it, or at last."""
    end = time.monotonic() + timeout
    said = read()
    while not holds(said) and time.monotonic() < end:
        time.sleep(0.1)
        said = read()
    return said


def press_during_a_run(board):
    generation = board.data("history")["records"][0]["generation"]
    started = board.ask("calibrate")
    expect(started["ok"], f"{started}")
    board.press(0.1)
    aborted = board.event("result")
    expect(aborted["result"] == "ABORTED" and not aborted["stored"], f"{aborted}")
    expect(board.data("history")["records"][0]["generation"] == generation, "an abort writes nothing")


def flood(board, truth):
    """The console at full speed, with noise, while a shot is taken: same result, nothing starts, nothing stops."""
    noise = bytes(range(256)) * 8 + b"undo\xff\rcalibrate\x80\r{\"cmd\":\r" * 40
    stop = threading.Event()

    def pour():
        while not stop.is_set():
            board.write(noise)

    started = board.ask("calibrate")
    expect(started["ok"], f"{started}")
    pouring = threading.Thread(target=pour)
    pouring.start()
    end = time.monotonic() + 4
    while time.monotonic() < end:
        board.read_some(0.1)
    stop.set()
    pouring.join()
    board.write(b"\r\n")
    quiet = time.monotonic() + 2
    while time.monotonic() < quiet:  # a reader that does not read loses answers, as it should
        board.read_some(0.1)
    board.text = b""
    result = wait_for(lambda: board.data("result"), lambda r: r["kind"] == "calibrate")
    expect(result["kind"] == "calibrate" and result["stored"], f"during the flood: {result}")
    check_against_truth(result, truth)


def figures(board):
    memory = board.data("mem")
    faults = {name: (t["minor_faults"], t["major_faults"]) for name, t in memory["threads"].items()}
    # A sanitizer's shadow of the memory is not locked, and has faults of its own.
    watched = memory["locked"] and "ROOMCAL_SANITIZED" not in os.environ
    expect(all(f == (0, 0) for f in faults.values()) or not watched, f"page faults after arming: {faults}")
    expect(all(a["refusals"] == 0 for a in memory["arenas"].values()), "an arena refused")
    print(f"  {memory['reserved_bytes'] / 2**20:.1f} MiB in all, no page fault, no refusal")


def robot_plan(roomcal, roomcald, folder):
    """The real robot has no recordings, but more of everything else."""
    text = (folder / "device.yaml").read_text()
    for i in range(4):
        text = text.replace("    kind: camera\n", f"    driver: {{kind: v4l2, key: \"port:usb-{i}\"}}\n    kind:camera\n", 1)
    text = text.replace("kind:camera", "kind: camera").replace("    kind: lidar\n", "    driver: {kind: udp, sweeps: 4}\n    kind: lidar\n")
    text = text.replace("  replay: shots\n", "")
    robot = folder / "robot"
    robot.mkdir()
    (robot / "device.yaml").write_text(text)
    (robot / "room.room").symlink_to(folder / "room.room")
    device.run(roomcal, "provision", robot / "device.yaml", "-o", robot)
    plan = device.run(roomcald, "--board", "mobile_robot", "--folder", robot, "--memory-plan")
    total = int(plan.splitlines()[-1].split()[1])
    expect(total <= 24 * 2**20, f"mobile_robot takes {total} bytes")
    print(f"  mobile_robot at full size: {total / 2**20:.1f} MiB in all")


def test(roomcal, roomcald):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        device.make_room(roomcal, folder)
        shot = device.make_device(roomcal, folder, "sim", wiring="  thermometer: {path: temperature}\n")
        (folder / "temperature").write_text(f"{TEMPERATURE_C * 1e3:.0f}\n")  # as the kernel tells it
        truth = truth_of(shot)
        robot_plan(roomcal, roomcald, folder)
        with Roomcald(roomcald, folder, "sim") as board:
            story(board, truth)
            press_during_a_run(board)
            flood(board, truth)
            figures(board)
            expect(board.end() == 0, "an ordered end")


if __name__ == "__main__":
    sys.exit(device.main(test, sys.argv[1:3]))
