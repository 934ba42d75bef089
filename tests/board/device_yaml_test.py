#!/usr/bin/env python3
"""Every board's device.yaml can be provisioned and fits its board: device_yaml_test.py ROOMCAL ROOMCALD BOARDS"""

import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "flow"))
import device  # noqa: E402
from device import expect  # noqa: E402


def test(roomcal, roomcald, boards):
    with tempfile.TemporaryDirectory() as temporary:
        room = pathlib.Path(temporary)
        device.make_room(roomcal, room)
        found = 0
        for description in sorted(pathlib.Path(boards).glob("*/device.yaml")):
            board, folder = description.parent.name, room / description.parent.name
            device.run(roomcal, "provision", description, "-o", folder)
            (folder / "room.room").symlink_to(room / "room.room")
            plan = device.run(roomcald, "--board", board, "--folder", folder, "--memory-plan")
            total, limit = (int(word) for word in (plan.split()[-3], plan.split()[-1]))
            expect(total <= limit, f"{board}: {total} of {limit} bytes")
            print(f"  {board}: {total / 2**20:.1f} of {limit / 2**20:.0f} MiB")
            found += 1
        expect(found == 4, f"{found} boards have a device.yaml")


if __name__ == "__main__":
    sys.exit(device.main(test, sys.argv[1:]))
