"""The power goes during commits: whatever operation it is, the store then holds the old record or the new one.

Each round is a whole calibration by the button. The store lies on a medium of the test's own (medium.py), which stops at
an operation drawn at random from those that a commit takes, in the middle of it; then the guest is killed, and what the
medium had not promised to keep is lost by chance.
"""

import random
import time

import device
from machine import Failed, wait_for
from story import extrinsics, result_event, wait_well

STORES = {
    "disk": "  store: {kind: partition, path: /dev/roomcal-store, size_bytes: 0}\n",
    "eeprom": "  store: {kind: nvmem, path: /dev/roomcal-eeprom, size_bytes: 0, page_bytes: 128}\n",
}
PATIENCE_S = 240  # for a press on a machine that has much else to do


def wiring(store):
    """A device that stands alone: no vehicle whose word it needs."""
    lines = [line for line in device.WIRING.splitlines(keepends=True) if not line.startswith(("  can:", "  store:"))]
    return "".join(lines) + STORES[store]


def begin_press(world):
    """Holds the button. @return the console's mark from before"""
    machine = world.machine
    machine.console.ask("status")  # JSON from here on
    mark = machine.console.mark()
    machine.press()
    return mark


def operations_of_a_commit(world):
    """A calibration that nothing disturbs, twice: the second has a record to archive."""
    for _ in range(2):
        before = world.store.operations
        event = result_event(world.machine, begin_press(world), PATIENCE_S)
        if not event.get("stored"):
            raise Failed(f"a press that nothing disturbed: {event}")
    return world.store.operations - before


def result_if_any(machine, mark):
    try:
        return result_event(machine, mark, 0.05)
    except Failed:
        return None


def cut(world, moment):
    """One press whose commit's so-manieth operation is the last. @return whether the console told of success"""
    machine, store = world.machine, world.store
    store.cut_after(moment)
    mark = begin_press(world)
    wait_for("the commit's end or the power's", lambda: store.gone.is_set() or result_if_any(machine, mark), PATIENCE_S)
    ended_by_itself = not store.gone.is_set()
    store.gone.set()
    machine.kill()
    event = result_if_any(machine, mark)
    if ended_by_itself and not event.get("stored"):
        raise Failed(f"the press ended by itself: {event}")
    return event is not None and bool(event.get("stored"))


def told(world):
    status = world.machine.console.ask("status")
    return status.get("store"), status.get("generation")


def kills(world):
    machine = world.machine
    machine.wait_ready()
    wait_well(world)
    seeds = random.Random(world.options.seed)
    operations = operations_of_a_commit(world)
    known, record = told(world)[1], extrinsics(world)
    outcomes = {"old": 0, "new": 0}
    begin = time.monotonic()
    for number in range(world.options.kills):
        moment = seeds.randint(1, operations + 1)  # the last: just after success was told
        acknowledged = cut(world, moment)
        machine.start()
        world.rejoin()
        machine.wait_ready()
        where = f"kill {number} at operation {moment} of {operations}"
        state, after = told(world)
        if state != "CALIBRATED" or after is None:
            raise Failed(f"{where}: the store is {state}: {machine.console.ask('health')}")
        if after not in (known, known + 1) or (acknowledged and after != known + 1):
            raise Failed(f"{where}: generation {known} became {after}, acknowledged: {acknowledged}")
        if after == known and extrinsics(world) != record:
            raise Failed(f"{where}: generation {known} is not what it was")
        outcomes["new" if after > known else "old"] += 1
        known, record = after, extrinsics(world)
        wait_well(world, but=["slot "])  # a torn slot is told of until it is written again
    world.figure(f"{world.options.kills} kills during commits of {operations} operations, seed {world.options.seed}; "
                 "records found", outcomes)
    world.figure("seconds for each kill", (time.monotonic() - begin) / max(1, world.options.kills))
    if world.options.kills >= 20 and min(outcomes.values()) == 0:
        raise Failed(f"the moments of the kills do not straddle the commit: {outcomes}")
