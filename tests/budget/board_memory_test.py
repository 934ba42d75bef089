#!/usr/bin/env python3
"""Fixed memory, proved: board_memory_test.py ROOMCAL ROOMCALD_GUARDED BUDGETS [BOARD ...]

Ten calibrations in a row on each board, with every heap call, mapping and break of the program counted from arming on:
none, no page fault of any thread, no arena that refused, peaks of arenas and stacks within the budget file.
"""

import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "flow"))
import device  # noqa: E402
from device import Roomcald, expect  # noqa: E402

CALIBRATIONS = 10
SCALE = {"stereo_rig": 0.5, "backpack": 0.2, "mobile_robot": 0.5, "sim": 0.5}


def guard_calls(board):
    board.process.send_signal(signal.SIGUSR2)
    time.sleep(0.3)
    told = re.findall(r"^guard: (\d+) calls", board.log.read_text(), re.MULTILINE)
    expect(told, "the guard does not answer")
    return int(told[-1])


def check_guard(guarded, folder, name):
    """Start-up uses the heap, as it may: a guard that sees none of it is blind."""
    done = subprocess.run([guarded, "--board", name, "--folder", str(folder), "--check"], capture_output=True, text=True,
                          env={**os.environ, "ROOMCAL_GUARD_FROM_START": "1"}, timeout=60)
    told = re.findall(r"^guard: (\d+) calls", done.stderr, re.MULTILINE)
    expect(done.returncode == 0 and told and int(told[-1]) > 10, f"the guard is blind: {done.stderr[-500:]}")


def check_budget(name, memory, budget):
    arenas, threads = memory["arenas"], memory["threads"]
    session = sum(arenas[a]["peak"] for a in ("permanent", "step", "scratch"))
    sensor_stack = max(t["stack_peak"] for n, t in threads.items() if n != "session")
    figures = {"session_arena": session, "session_stack": threads["session"]["stack_peak"], "sensor_stack": sensor_stack}
    for what, bytes_used in figures.items():
        expect(bytes_used <= budget[what], f"{name}: {what} {bytes_used} B, budget {budget[what]}")
    for arena, figures_of in arenas.items():
        expect(figures_of["refusals"] == 0, f"{name}: arena {arena} refused")
    for thread, t in threads.items():
        expect(t["stack_peak"] < t["stack_bytes"], f"{name}: the stack of {thread} is full")
        expect(not memory["locked"] or (t["minor_faults"], t["major_faults"]) == (0, 0),
               f"{name}: {thread} met {t['minor_faults']} + {t['major_faults']} page faults after arming")
    print(f"  {name}: {CALIBRATIONS} calibrations, 0 heap calls, 0 page faults; {memory['reserved_bytes'] / 2**20:.1f} MiB "
          f"in all, session {session / 2**20:.2f} MiB, stacks {figures['session_stack']} and {sensor_stack} B")


def run_board(roomcal, guarded, budgets, name, room):
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        (folder / "room").symlink_to(room / "room")
        (folder / "room.room").symlink_to(room / "room.room")
        device.make_device(roomcal, folder, name, scale=SCALE[name], shots=2, sweeps=5)
        check_guard(guarded, folder, name)
        with Roomcald(guarded, folder, name) as board:
            board.wait_armed()
            board.raise_rights()
            board.data("status")
            board.process.send_signal(signal.SIGUSR1)
            for _ in range(CALIBRATIONS):
                started = board.ask("calibrate")
                expect(started["ok"], f"{name}: {started}")
                result = board.event("result")
                expect(result["stored"], f"{name}: {result}")
            for command in ("status", "health", "sensors", "result", "history", "diff", "mem", "clock", "log"):
                board.data(command)
            board.data("export", "json")
            calls = guard_calls(board)
            expect(calls == 0, f"{name}: {calls} heap calls after arming\n{board.log.read_text()[-3000:]}")
            check_budget(name, board.data("mem"), budgets[name])
            expect(board.end() == 0, "an ordered end")


def test(roomcal, guarded, budget_file, *boards):
    budgets = json.loads(pathlib.Path(budget_file).read_text())
    with tempfile.TemporaryDirectory() as temporary:
        room = pathlib.Path(temporary)
        device.make_room(roomcal, room)
        for name in boards or ("stereo_rig", "backpack", "mobile_robot", "sim"):
            run_board(roomcal, guarded, budgets, name, room)


if __name__ == "__main__":
    sys.exit(device.main(test, sys.argv[1:]))
