"""Waiting for events, never for time."""

import time

GRACE = 5  # limits are told for an idle machine; a loaded one gets so many times as much, which costs nothing where it is not


class Failed(Exception):
    """What a scenario found; its text is the report."""


def wait_for(what, condition, seconds, grace=GRACE):
    """The condition's value once it is true; Failed with `what` after so many seconds, times the grace."""
    end = time.monotonic() + seconds * grace
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise Failed(f"{what}: not within {seconds * grace:.0f} s")
