"""The guest's button and lamp, as real drivers of its kernel see them, moved and watched from the host.

aarch64: the machine's PL061, whose lines become a gpio-keys button and a leds-gpio lamp by nodes in the device tree; the
host reaches them through QEMU's qtest socket. x86-64 has no GPIO chip: the button is a key of the machine's keyboard, the
lamp that keyboard's scroll lock light, whose changes QEMU traces.
"""

import pathlib
import re
import socket
import threading
import time

BUTTON, LAMP = 4, 5  # lines of the PL061
KEY_SETUP, KEY_F12 = 141, 88  # linux/input-event-codes.h
SCROLL_LOCK = 1  # bit of a PS/2 keyboard's lights

# What a device of this kind is wired to: the button's input device by name and key, the lamp's folder.
WIRING = {
    "aarch64": {"input": "roomcal-keys", "code": KEY_SETUP, "lamp": "calibration"},
    "x86_64": {"input": "AT Translated Set 2 keyboard", "code": KEY_F12, "lamp": "input*::scrolllock"},
}

DEVICE_TREE = """
    roomcal-keys {
        compatible = "gpio-keys";
        button {
            label = "calibrate";
            linux,code = <%(code)d>;
            gpios = <&{/pl061@9030000} %(button)d 0>;
            debounce-interval = <10>;
        };
    };
    roomcal-lamp {
        compatible = "gpio-leds";
        lamp {
            label = "calibration";
            gpios = <&{/pl061@9030000} %(lamp)d 0>;
        };
    };
""" % {"code": KEY_SETUP, "button": BUTTON, "lamp": LAMP}


class Lamp:
    """Every change of the lamp as (seconds, lit)."""

    def __init__(self):
        self.changes = []

    def changed(self, lit):
        self.changes.append((time.monotonic(), lit))

    def count(self, begin, end=None):
        return sum(1 for at, lit in self.changes if lit and at >= begin and (end is None or at < end))

    def lit(self):
        return bool(self.changes) and self.changes[-1][1]

    def longest(self, begin):
        """Seconds of the longest light since then."""
        longest, since = 0.0, None
        for at, lit in self.changes:
            if at < begin:
                continue
            if lit:
                since = at
            elif since is not None:
                longest, since = max(longest, at - since), None
        return longest


class Panel:
    """A button to press, a lamp to watch."""

    def __init__(self):
        self.lamp = Lamp()

    def button(self, down):
        raise NotImplementedError

    def hold_for_service(self, console):
        """Holds it until the console, which speaks JSON, tells of service rights; the offer to restore is not taken."""
        mark = console.mark()
        self.button(True)
        console.wait('"ev":"rights".*"service"', 90, mark)
        self.button(False)

    def close(self):
        pass


class GpioPanel(Panel):
    """Lines of a chip through qtest: lines of text."""

    def __init__(self, path, chip):
        super().__init__()
        self.chip = chip
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.connect(str(path))
        threading.Thread(target=self._read, daemon=True).start()
        self._send(f"irq_intercept_out {chip}")

    def _send(self, line):
        self.socket.sendall((line + "\n").encode())

    def _read(self):
        try:
            for line in self.socket.makefile("rb"):
                match = re.match(rb"IRQ (raise|lower) (\d+)", line)
                if match and int(match.group(2)) == LAMP:
                    self.lamp.changed(match.group(1) == b"raise")
        except OSError:  # the machine was killed
            pass

    def button(self, down):
        self._send(f"set_irq_in {self.chip} unnamed-gpio-in {BUTTON} {int(down)}")

    def close(self):
        self.socket.close()


class KeyboardPanel(Panel):
    """A key through QEMU's monitor, a light through its trace file."""

    TRACE = "ps2_set_ledstate"

    def __init__(self, monitor, trace):
        super().__init__()
        self.monitor, self.trace = monitor, pathlib.Path(trace)
        self.stop = False
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        lit = False
        with open(self.trace, encoding="utf-8", errors="replace") as lines:
            waiting = ""
            while not self.stop:
                waiting += lines.readline()
                if not waiting.endswith("\n"):
                    time.sleep(0.005)
                    continue
                match = re.search(self.TRACE + r" .*ledstate (\d+)", waiting)
                waiting = ""
                if match and (int(match.group(1)) & SCROLL_LOCK != 0) != lit:
                    lit = not lit
                    self.lamp.changed(lit)

    def button(self, down):
        key = {"type": "qcode", "data": "f12"}
        self.monitor.call("input-send-event", events=[{"type": "key", "data": {"down": down, "key": key}}])

    def close(self):
        self.stop = True
