"""The vehicle around the device, on its CAN bus, by python3-can: says whether it stands, hears what the device says.

The bus reaches the host as a serial line that speaks slcan (guest: Linux' slcan driver, host: python3-can).
"""

import threading
import time

from dbc import Dbc
from machine import Failed, wait_for

PERIOD_S = 0.02


class Vehicle:
    """Sends VEH_MOTION fifty times a second, well or badly, and keeps what the device sent."""

    def __init__(self, port):
        try:
            import can
        except ImportError:
            raise Failed("python3-can is missing: ./tools/setup --only python3-can python3-serial") from None
        self.can = can
        self.dbc = Dbc()
        self.mood = "silent"  # standing, moving, repeating, damaged, silent
        self.heard = []  # (seconds, message, signals)
        self.complaints = []
        self.stop = False
        self.bus = can.interface.Bus(bustype="slcan", channel=f"socket://127.0.0.1:{port}", sleep_after_open=0.1)
        self.threads = [threading.Thread(target=self._send, daemon=True), threading.Thread(target=self._hear, daemon=True)]
        for thread in self.threads:
            thread.start()

    def _send(self):
        counter = 0
        while not self.stop:
            time.sleep(PERIOD_S)
            if self.mood == "silent":
                continue
            counter = counter if self.mood == "repeating" else (counter + 1) % 15
            moving = self.mood == "moving"
            number, data = self.dbc.encode("VEH_MOTION", counter, spoil=0x5A if self.mood == "damaged" else 0,
                                           Standstill=0 if moving else 1, ParkBrake=0 if moving else 1,
                                           Speed=200 if moving else 0, YawRate=0)
            try:
                self.bus.send(self.can.Message(arbitration_id=number, data=data, is_extended_id=False))
            except Exception:  # the guest's end comes and goes
                time.sleep(0.1)

    def _hear(self):
        while not self.stop:
            try:
                message = self.bus.recv(0.2)
                if message is None:
                    continue
                decoded = self.dbc.decode(message.arbitration_id, bytes(message.data))
            except AssertionError as wrong:
                self.complaints.append(str(wrong))
                continue
            except Exception:
                time.sleep(0.1)
                continue
            if decoded and decoded[0] != "VEH_MOTION":
                self.heard.append((time.monotonic(), *decoded))

    def since(self, begin, message):
        return [(at, signals) for at, name, signals in list(self.heard) if name == message and at >= begin]

    def wait(self, message, begin, seconds, **wanted):
        """The signals of the first such message since then."""
        def find():
            for _, signals in self.since(begin, message):
                if all(signals.get(k) == v for k, v in wanted.items()):
                    return signals
            return None
        return wait_for(f"CAN: {message} with {wanted}", find, seconds)

    def close(self):
        self.stop = True
        for thread in self.threads:
            thread.join(1)
        try:
            self.bus.shutdown()
        except Exception:
            pass
