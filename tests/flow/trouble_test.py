#!/usr/bin/env python3
"""A device in trouble: trouble_test.py ROOMCAL ROOMCALD

Each case ends in a clear word that names the thing and the remedy, on the console and in the log, and nothing that was
stored is lost.
"""

import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import device
from device import Roomcald, expect

SCALE = 0.5


class Bench:
    """One device, copied afresh for every case."""

    def __init__(self, roomcal, roomcald, folder):
        self.roomcal, self.roomcald, self.folder = roomcal, roomcald, folder
        self.master = folder / "master"
        self.master.mkdir()
        device.make_room(roomcal, self.master)
        first = device.make_device(roomcal, self.master, "sim", scale=SCALE, shots=1, sweeps=5)
        self.first = first.relative_to(self.master)
        self.count = 0

    def copy(self):
        self.count += 1
        target = self.folder / f"case{self.count}"
        shutil.copytree(self.master, target, copy_function=shutil.copy,
                        ignore=lambda _, names: {"button", "room"} & set(names))
        device.os.mkfifo(target / "button")
        return target

    def board(self, folder):
        return Roomcald(self.roomcald, folder, "sim")


def calibrate(board):
    board.raise_rights()
    started = board.ask("calibrate")
    expect(started["ok"], f"{started}")
    board.event("result")
    return board.data("result")


def calibrated(board):
    board.wait_armed()
    result = calibrate(board)
    expect(result["stored"], f"{result}")
    return board.data("history")["records"]


def wrong_map(bench):
    folder = bench.copy()
    with bench.board(folder) as board:
        records = calibrated(board)
        expect(board.end() == 0, "an ordered end")
    other = bench.folder / "other"
    other.mkdir()
    device.make_room(bench.roomcal, other, seed=7)
    shutil.copy(other / "room.room", folder / "room.room")
    with bench.board(folder) as board:
        board.wait_armed()
        result = calibrate(board)
        expect(result["result"].startswith("FAIL") and not result["stored"], f"in another room: {result}")
        expect(any("cam" in reason for reason in result["reasons"]), f"reasons {result['reasons']}")
        expect(board.data("history")["records"] == records, "what was stored is there")
    print(f"  wrong map: {result['result']}: {result['reasons'][0]}")


def camera_gone(bench):
    folder = bench.copy()
    (folder / bench.first / "cam2.pgm").unlink()
    with bench.board(folder) as board:
        board.wait_armed()
        complaints = board.data("health")["complaints"]
        expect(any(c.startswith("cam2: not found") for c in complaints), f"{complaints}")
        result = calibrate(board)
        expect(any(reason.startswith("cam2") for reason in result["reasons"]), f"{result['reasons']}")
        names = {sensor["name"] for sensor in result["sensors"]}
        expect(names == {"cam0", "cam1", "cam3", "lidar0"}, f"the others are solved: {names}")
    print(f"  a camera is gone: {result['result']}, {len(names)} sensors: {result['reasons'][0]}")


def dark_camera(bench):
    folder = bench.copy()
    picture = folder / bench.first / "cam1.pgm"
    data = picture.read_bytes()
    head = data.index(b"255\n") + 4
    picture.write_bytes(data[:head] + bytes(b // 16 for b in data[head:]))
    with bench.board(folder) as board:
        board.wait_armed()
        result = calibrate(board)
        expect(any("cam1" in r and "light" in r for r in result["reasons"]), f"{result['reasons']}")
        board.raise_rights()
        expect(board.ask("grab", "cam1")["ok"], "a look at it")
        sight = board.event("grab")
        expect("complaint" in sight and sight["level_high"] < 24, f"{sight}")
    print(f"  dark camera: {result['result']}: {sight['complaint']}")


def twins(bench):
    folder = bench.copy()
    text = (folder / "device.yaml").read_text()
    twice = text.replace("  - name: \"cam1\"\n", "  - name: \"cam1\"\n    serial: \"7\"\n").replace(
        "  - name: \"cam2\"\n", "  - name: \"cam2\"\n    serial: \"7\"\n")
    expect(twice != text, "names in device.yaml")
    (folder / "device.yaml").write_text(twice)
    told = device.run(bench.roomcal, "provision", folder / "device.yaml", "-o", folder, fails=True)
    expect("serial" in told and "cam" in told, told)
    print(f"  two of one serial: {told.strip()[-90:]}")


def full_disk(bench):
    folder = bench.copy()
    process = subprocess.run([bench.roomcald, "--board", "sim", "--folder", str(folder), "--check"],
                             capture_output=True, text=True, timeout=60,
                             preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536)))
    expect(process.returncode == 1 and "store" in process.stderr and "space" in process.stderr, process.stderr)
    expect(not (folder / "store").exists(), "no half of a store is left")
    print(f"  full disk: {process.stderr.strip().splitlines()[-1][-100:]}")


def refused(board, records, word):
    """A calibration that cannot be stored: said so by name, and what was stored is in force."""
    result = calibrate(board)
    expect(result["result"] == "FAIL_SERVICE" and not result["stored"], f"{result}")
    expect(any(r.startswith("store: ") and word in r for r in result["reasons"]), f"{result['reasons']}")
    expect(board.data("history")["records"] == records, "what was stored is there")
    expect(board.data("status")["store"] == "CALIBRATED", "and in force")
    return result["reasons"][-1]


def medium_that_takes_nothing(bench):
    """The disk fills up, then has space again; the next start finds the store read-only."""
    folder = bench.copy()
    with bench.board(folder) as board:
        records = calibrated(board)
        pid, limits = board.process.pid, resource.prlimit(board.process.pid, resource.RLIMIT_FSIZE)
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (0, limits[1]))  # stands in for a disk without space
        full = refused(board, records, "space")
        resource.prlimit(pid, resource.RLIMIT_FSIZE, limits)
        expect(calibrate(board)["stored"], "with space again it is stored")
        records = board.data("history")["records"]
        expect(board.end() == 0, "an ordered end")
    (folder / "store").chmod(0o444)
    with Roomcald(bench.roomcald, folder, "sim", obey_modes=True) as board:
        board.wait_armed()
        read_only = refused(board, records, "read-only")
        expect(len(board.data("export", "json")["document"]) > 200, "it is read as before")
        expect(board.end() == 0, "an ordered end")
    print(f"  a disk without space: {full}; a read-only one: {read_only}")


def damaged_store(bench):
    folder = bench.copy()
    with bench.board(folder) as board:
        calibrated(board)
        expect(board.end() == 0, "an ordered end")
    store = folder / "store"
    good = store.read_bytes()
    half = bytearray(good)
    slot = len(half) // 12
    half[slot + 300] ^= 1  # in the first of the two alternating slots
    store.write_bytes(half)
    with bench.board(folder) as board:
        board.wait_armed()
        status, health = board.data("status"), board.data("health")
        print(f"  one bit of the store: {status['store']}, {[c for c in health['complaints'] if 'slot' in c or 'store' in c]}")
        expect(status["store"] in ("FACTORY", "CALIBRATED"), f"{status}")
        expect(board.end() == 0, "an ordered end")
    store.write_bytes(b"\x5a" * len(good))
    with bench.board(folder) as board:
        board.wait_armed()
        expect(board.data("status")["store"] == "UNCALIBRATED", "nothing valid is a state")
        refused = board.ask("export", "json")
        expect(not refused["ok"] and "UNCALIBRATED" in refused["error"]["detail"], f"{refused}")
        expect(calibrate(board)["stored"], "a calibration mends it")


def damaged_profile(bench):
    folder = bench.copy()
    profile = folder / "device.profile"
    data = bytearray(profile.read_bytes())
    data[len(data) // 2] ^= 0x10
    profile.write_bytes(data)
    with bench.board(folder) as board:
        time.sleep(0.5)
        status = board.data("status")
        expect("device.profile" in status["trouble"] and "copy it" in status["trouble"], f"{status}")
        expect(not board.ask("sensors")["data"].get("cam0"), "no sensor without a profile")
        expect(not board.ask("result")["ok"], "no result without a store")
        expect(board.end() == 0, "an ordered end")
    print(f"  damaged profile: {status['trouble'][-80:]}")


def crashes(bench):
    folder = bench.copy()
    for _ in range(3):
        with bench.board(folder) as board:
            board.wait_armed()
            board.process.send_signal(signal.SIGSEGV)
            board.process.wait(device.PATIENCE_S)
            (folder / "roomcald.log").unlink()
    with bench.board(folder) as board:
        time.sleep(0.5)
        status = board.data("status")
        expect(status.get("mode") == "SAFE" and "safe mode" in status["trouble"], f"{status}")
        expect(not board.ask("calibrate")["ok"], "nothing but the console")
        expect(len(board.data("log")["lines"]) > 0, "the log can be read")
        expect(board.end() == 0, "an ordered end")
    (folder / "roomcald.log").unlink()
    with bench.board(folder) as board:
        board.wait_armed()
        expect("mode" not in board.data("status"), "an ordered end ends safe mode")
    print("  three crashes: safe mode, console alive, back after an ordered end")


def test(roomcal, roomcald):
    with tempfile.TemporaryDirectory() as temporary:
        bench = Bench(roomcal, roomcald, pathlib.Path(temporary))
        for case in (wrong_map, camera_gone, dark_camera, twins, full_disk, medium_that_takes_nothing,
                     damaged_store, damaged_profile, crashes):
            try:
                case(bench)
            except device.Failure as failure:
                raise device.Failure(f"{case.__name__}: {failure}") from failure


if __name__ == "__main__":
    sys.exit(device.main(test, sys.argv[1:3]))
