"""Who watches the watchers: a thread that hangs restarts the machine, a program that crashes ends in safe mode."""

import time

from machine import Failed, wait_for
from story import wait_well


def hung_thread(world):
    """The session's thread is stopped by a debugger's means; the dog is no longer fed, the machine restarts by itself."""
    machine = world.machine
    machine.wait_ready()
    world.vehicle.mood = "standing"
    before = machine.console.ask("status").get("generation")
    thread = machine.run("for t in /proc/$(pidof roomcald)/task/*; do "
                         "[ \"$(cat $t/comm)\" = session ] && echo ${t##*/}; done").split()
    if len(thread) != 1:
        raise Failed(f"the session's thread was not found: {thread}")
    begin = time.monotonic()
    machine.run(f"freeze_thread {thread[0]} >/dev/kmsg 2>&1 &")
    mark = machine.kernel.mark()
    machine.kernel.wait(r"Linux version", 300, mark)
    world.figure("seconds from a hung thread to the restart", time.monotonic() - begin)
    machine.started = time.monotonic()
    world.rejoin()
    machine.wait_ready()
    if machine.console.ask("status").get("generation") != before:
        raise Failed("the record changed")


def starved(world):
    """The console's own test: with service rights it stops feeding."""
    machine = world.machine
    machine.wait_ready()
    machine.panel.hold_for_service(machine.console)
    mark = machine.kernel.mark()
    begin = time.monotonic()
    told = machine.console.ask("selftest", "watchdog")
    if "no longer fed" not in str(told):
        raise Failed(f"selftest watchdog says {told}")
    machine.kernel.wait(r"Linux version", 300, mark)
    world.figure("seconds from the last feeding to the restart", time.monotonic() - begin)
    machine.started = time.monotonic()
    world.rejoin()
    machine.wait_ready()


def crashes(world):
    """Three crashes in a row: safe mode, with the console alive; an ordered restart then arms again."""
    machine = world.machine
    machine.wait_ready()
    begin = machine.console.ask("status")
    if begin.get("mode") == "SAFE":
        raise Failed("safe mode before any crash")
    for _ in range(3):
        old = machine.run("pidof roomcald").strip()
        machine.run(f"kill -SEGV {old}")
        wait_for("the program's next start", lambda: machine.run("pidof roomcald || true").strip() not in ("", old), 120)
        machine.wait_ready()
    told = machine.console.ask("status")
    if told.get("mode") != "SAFE" or "safe mode" not in told.get("trouble", ""):
        raise Failed(f"after three crashes: {told}")
    since = time.monotonic()
    wait_for("safe mode's five flashes", lambda: machine.panel.lamp.count(since) >= 5, 60)
    machine.panel.hold_for_service(machine.console)
    old = machine.run("pidof roomcald").strip()
    machine.console.ask("reboot")
    wait_for("the ordered restart", lambda: machine.run("pidof roomcald || true").strip() not in ("", old), 120)
    machine.wait_ready()
    if machine.console.ask("status").get("mode") == "SAFE":
        raise Failed("still in safe mode after an ordered restart")
    world.vehicle.mood = "standing"
    wait_well(world)
