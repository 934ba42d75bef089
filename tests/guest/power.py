"""The power goes during commits: whatever moment it is, the store then holds the old record or the new one.

A press takes too long to be repeated fifty times under emulation, so the store's own verbs commit: undo and
restore-factory write a whole record each, by the same path as a press (store/store.h). The guest is killed at a random
moment after the verb was sent.
"""

import random
import time

from machine import Failed


def generation(machine):
    told = machine.console.ask("status")
    return told.get("store"), told.get("generation")


def raise_rights(world):
    """Service rights, by holding the button for ten seconds; the offer to restore is not taken."""
    world.machine.gpio.press(10.5)


def kills(world):
    machine = world.machine
    machine.wait_ready()
    seeds = random.Random(world.options.seed)
    outcomes = {"old": 0, "new": 0}
    known = generation(machine)[1]
    for number in range(world.options.kills):
        raise_rights(world)
        machine.console.ask("history")
        before = generation(machine)[1]
        if before < known:
            raise Failed(f"kill {number}: generation {before} in force, {known} was acknowledged")
        machine.console.send('{"cmd":"restore-factory","id":1}\n')
        time.sleep(seeds.uniform(0, world.options.commit_s))
        acknowledged = '"id":1,"cmd":"restore-factory","ok":true' in machine.console.text
        machine.kill()
        machine.start()
        world.rejoin()
        machine.wait_ready()
        state, after = generation(machine)
        if state == "UNCALIBRATED" or after is None:
            raise Failed(f"kill {number}: the store is {state}: {machine.console.ask('health')}")
        if after not in (before, before + 1) or (acknowledged and after != before + 1):
            raise Failed(f"kill {number}: generation {before} became {after}, acknowledged: {acknowledged}")
        outcomes["new" if after > before else "old"] += 1
        known = after
    world.figure(f"{world.options.kills} kills during commits, seed {world.options.seed}: records found", outcomes)
    if world.options.kills >= 20 and min(outcomes.values()) == 0:
        raise Failed(f"the moments of the kills do not straddle the commit: {outcomes}; change commit_s")
