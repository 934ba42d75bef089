"""The whole story: power on, wait, hold the button, PASS on console, lamp and bus, power off and on, read the record."""

import json
import math
import re
import time

from device import CAMERAS, HEIGHT, WIDTH
from machine import TOP, Failed, wait_for

ERROR_T_M, ERROR_R_RAD = 0.5e-3, 0.3e-3  # cameras of a quarter of the pixels, 160 markers
KERNEL_BUFFERS = 4  # of each camera, mapped into the program (profile::CameraWiring::buffers)
BESIDE_PROGRAM = 1024 * 1024  # what the start took from the heap, main's stack, pages of tables


def wait_well(world, seconds=240, but=()):
    """Until there is nothing to complain about; complaints that begin with one of `but` may stay."""
    def well():
        health = world.machine.console.ask("health")
        world.complaints = health.get("complaints", [])
        return all(complaint.startswith(tuple(but)) for complaint in world.complaints)
    try:
        wait_for("a healthy device", well, seconds)
    except Failed as failed:
        raise Failed(f"{failed}: {world.complaints}") from None


def result_event(machine, mark, seconds):
    """The console's own word about the press that ended after the mark."""
    match = machine.console.wait(r'(?m)^(\{"ev":"result"[^\r\n]*)\r?\n', seconds, mark)
    event = json.loads(match.group(1))
    return event.get("data", event)


def press(world, seconds=300):
    """Holds the button; what came of it, with the seconds that it took from letting go."""
    machine = world.machine
    machine.console.ask("status")  # JSON from here on
    mark = machine.console.mark()
    begin = time.monotonic()
    machine.press()
    released = time.monotonic()
    event = result_event(machine, mark, seconds)
    return event, begin, time.monotonic() - released


def extrinsics(world):
    """{sensor: 4x4 rows} of the record in force."""
    document = world.machine.console.ask("export", "json")["document"]
    return {name: sensor["T_rig_sensor"] for name, sensor in json.loads(document)["sensors"].items()}


def worst_error(found, truth):
    """Metres and radians between poses and truth.json's, of the cameras and of the LiDARs."""
    worst = {"cam": [0.0, 0.0], "lidar": [0.0, 0.0]}
    for name, wanted in truth.items():
        if name not in found:
            raise Failed(f"{name} is not in the record")
        a, b = found[name], wanted
        distance = math.dist([r[3] for r in a[:3]], [r[3] for r in b[:3]])
        trace = sum(a[i][k] * b[i][k] for i in range(3) for k in range(3))
        skew = [sum(a[k][i] * b[k][j] - a[k][j] * b[k][i] for k in range(3)) for i, j in ((0, 1), (0, 2), (1, 2))]
        angle = math.atan2(0.5 * math.hypot(*skew), (trace - 1) / 2)
        kind = "lidar" if name.startswith("lidar") else "cam"
        worst[kind] = [max(worst[kind][0], distance), max(worst[kind][1], angle)]
    return worst


def whole_story(world):
    machine, vehicle = world.machine, world.vehicle
    world.figure("seconds to the console's first answer", machine.wait_ready())
    vehicle.mood = "standing"
    wait_well(world)
    world.figure("seconds to healthy sensors", time.monotonic() - machine.started)

    event, begin, took = press(world)
    released = time.monotonic() - took
    if event.get("result") not in ("PASS", "PASS_ADVISE"):
        raise Failed(f"the press ended with {event}")
    world.figure("seconds from release to PASS", took)
    world.figure("compute, ms", machine.console.ask("result").get("timing_ms", {}).get("compute", 0))
    told = vehicle.wait("CAL_RESULT", begin, 60, Kind="calibrate")
    if told["Verdict"] not in ("pass", "pass_advise") or told["SensorsDone"] != 5 or told["Generation"] < 1:
        raise Failed(f"CAL_RESULT says {told}")
    progress = [s["Progress"] for _, s in vehicle.since(begin, "CAL_STATUS") if s["State"] == "calibrating"]
    if not progress or progress != sorted(progress):
        raise Failed(f"progress on the bus: {progress}")
    wait_for("PASS on the lamp: lit for 3 s", lambda: machine.panel.lamp.longest(released) > 2.5, 60)
    vehicle.wait("CAL_STATUS", time.monotonic(), 60, Store="calibrated", State="idle")

    found = extrinsics(world)
    errors = worst_error(found, world.truth())
    world.figure("cameras' worst error, um and urad", [round(v * 1e6, 1) for v in errors["cam"]])
    world.figure("LiDAR's error, um and urad", [round(v * 1e6, 1) for v in errors["lidar"]])
    if errors["cam"][0] > ERROR_T_M or errors["cam"][1] > ERROR_R_RAD:
        raise Failed(f"the cameras are off by {errors['cam'][0] * 1e3:.3f} mm, {errors['cam'][1]:.2e} rad")
    memory(world)

    generation = machine.console.ask("status").get("generation")
    machine.kill()
    machine.start()
    world.rejoin()
    machine.wait_ready()
    if machine.console.ask("status").get("generation") != generation or extrinsics(world) != found:
        raise Failed("after the power came back another record is in force")


def memory(world):
    """Resident memory against the plan, faults after arming."""
    machine = world.machine
    told = machine.console.ask("mem")
    process = machine.run("cat /proc/$(pidof roomcald)/status")
    peak = int(re.search(r"VmHWM:\s+(\d+) kB", process).group(1)) * 1024
    planned, kernels = told["reserved_bytes"], KERNEL_BUFFERS * CAMERAS * WIDTH * HEIGHT
    world.figure("VmHWM of roomcald; of it planned block, kernel's image buffers, program, bytes",
                 [peak, planned, kernels, peak - planned - kernels])
    program = BESIDE_PROGRAM + (TOP / "build" / world.architecture / "roomcald.stripped").stat().st_size
    if peak > planned + kernels + program:
        raise Failed(f"roomcald took {peak} bytes; planned are {planned}, {kernels} for the kernel's buffers, "
                     f"{program} for the program")
    faults = {name: thread["major_faults"] for name, thread in told["threads"].items() if thread["major_faults"]}
    if faults:
        raise Failed(f"major page faults after arming: {faults}")
