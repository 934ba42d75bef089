"""Everything talks at once, nonsense above all: console bytes, datagrams, CAN frames, while calibrations run."""

import random
import socket
import threading
import time

from machine import Failed
from story import extrinsics, press, wait_well, worst_error


class Flood:
    def __init__(self, world):
        self.world, self.stop, self.sent = world, False, 0
        seed = world.options.seed
        self.threads = [threading.Thread(target=self._console, args=(random.Random(seed),), daemon=True),
                        threading.Thread(target=self._network, args=(random.Random(seed + 1),), daemon=True),
                        threading.Thread(target=self._bus, args=(random.Random(seed + 2),), daemon=True)]

    def __enter__(self):
        for thread in self.threads:
            thread.start()
        return self

    def __exit__(self, *_):
        self.stop = True
        for thread in self.threads:
            thread.join(2)

    def _console(self, random_):
        words = [b"calibrate", b"undo", b"reboot\r", b"{\"cmd\":", b"\x00\xff\xfe", b"\x1b[A", b"help\r", b"\t\t", b"}}}}\n"]
        while not self.stop:
            data = random_.choice(words) + bytes(random_.randrange(256) for _ in range(random_.randrange(40)))
            self.world.machine.console.send(data)
            self.sent += len(data)
            time.sleep(0.01)

    def _network(self, random_):
        out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        address = ("127.0.0.1", self.world.machine.lidar_port)
        genuine = self.world.lidar.packets
        while not self.stop:
            data = bytearray(random_.choice(genuine)[1] if random_.random() < 0.2 else random_.randbytes(1206))
            data[random_.randrange(len(data))] ^= 0xFF
            out.sendto(bytes(data[:random_.choice((1206, 1206, 7, 600))]), address)
            time.sleep(0.05)

    def _bus(self, random_):
        can = self.world.vehicle.can
        while not self.stop:
            number = random_.choice((0x690, 0x691, 0x692, random_.randrange(0x800)))
            try:
                self.world.vehicle.bus.send(can.Message(arbitration_id=number, is_extended_id=False,
                                                        data=random_.randbytes(random_.randrange(9))))
            except Exception:
                pass
            time.sleep(0.5)


def noise(world):
    machine = world.machine
    machine.wait_ready()
    world.vehicle.mood = "standing"
    wait_well(world)
    process = machine.run("pidof roomcald").strip()
    end = time.monotonic() + world.options.noise_s
    ended, refused = 0, 0
    while time.monotonic() < end:
        with Flood(world) as flood:
            begin = time.monotonic()
            machine.press()
            # On the bus: the console is drowned.
            told = world.vehicle.wait("CAL_RESULT", begin, 600)
        ended += 1
        refused += told["Verdict"] not in ("pass", "pass_advise")
        machine.console.send("\r\n\r\n")
        machine.pass_time(3)
    if machine.run("pidof roomcald").strip() != process:
        raise Failed("the program did not survive")
    world.figure(f"presses ended in {world.options.noise_s} s of noise; refused; noise bytes of the last",
                 [ended, refused, flood.sent])
    event, _, _ = press(world)
    if event.get("result") not in ("PASS", "PASS_ADVISE"):
        raise Failed(f"after the noise: {event}")
    errors = worst_error(extrinsics(world), world.truth())
    if errors["cam"][0] > 0.5e-3:
        raise Failed(f"after the noise the cameras are off by {errors['cam'][0] * 1e3:.3f} mm")
