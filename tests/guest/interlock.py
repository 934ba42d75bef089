"""A vehicle that is not known to stand still is not calibrated on: every doubt is motion."""

from machine import Failed, wait_for
from story import press, result_event, wait_well


def interlock(world):
    machine, vehicle = world.machine, world.vehicle
    machine.wait_ready()
    vehicle.mood = "standing"
    wait_well(world)
    before = machine.console.ask("status").get("generation")
    for mood in ("silent", "repeating", "damaged", "moving"):
        vehicle.mood = mood
        wait_for(f"{mood}: doubt that the vehicle stands", lambda: not machine.console.ask("status").get("still"), 30)
        event, _, _ = press(world)
        if event.get("result") not in ("FAIL_RETRY", "ABORTED") or event.get("stored"):
            raise Failed(f"{mood}: the press ended with {event}")
        world.figure(f"{mood}: refused", event.get("reason", event.get("result")))
    vehicle.mood = "standing"
    wait_well(world)
    if machine.console.ask("status").get("generation") != before:
        raise Failed("something was stored")
    # A doubt in the middle of a press stops it as well.
    machine.console.ask("status")
    mark = machine.console.mark()
    machine.press()
    vehicle.mood = "moving"
    event = result_event(machine, mark, 300)
    if event.get("stored"):
        raise Failed(f"moved off during the grab, and yet: {event}")
    vehicle.mood = "standing"
