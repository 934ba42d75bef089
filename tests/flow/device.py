"""A device without hardware for tests: a folder as `roomcal provision` makes it, roomcald on a pseudo-terminal, a button.

Everything is the real program; only the ends are replayed: images and packets from the simulator, a pipe as the button,
plain files as lamp and store.
"""

import json
import os
import pathlib
import pty
import select
import signal
import subprocess
import sys
import time
import tty

PRESS = pathlib.Path(__file__).resolve().parents[2] / "board" / "sim" / "press"
PATIENCE_S = 120  # for anything that is sure to come: a loaded machine with sanitizers needs tens of seconds
SIMULATED = {"sim": "mobile_robot", "mobile_robot": "mobile_robot", "backpack": "backpack", "stereo_rig": "stereo_rig",
             "tls": "tls"}


class Failure(Exception):
    pass


def expect(condition, what):
    if not condition:
        raise Failure(what)


def run(*command, fails=False):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=600)
    if fails != (done.returncode != 0):
        raise Failure(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def make_room(roomcal, folder, seed=1, markers=340):
    run(roomcal, "simulate", "room", "-o", folder / "room", "--seed", seed, "--markers", markers)
    run(roomcal, "map", "import", folder / "room" / "markers.csv", "-o", folder / "room.room")


def make_device(roomcal, folder, board, scale=1.0, shots=2, sweeps=4, seed=1, wiring=""):
    """`folder` becomes a device of this board with `shots` shots of one stand; make_room() was there before."""
    run(roomcal, "simulate", "shot", "--room", folder / "room", "--device", SIMULATED[board], "-o", folder / "shots",
        "--seed", seed, "--format", "pgm", "--shots", shots, "--scale", scale, "--sweeps", sweeps)
    first = folder / "shots" / "shot000" if (folder / "shots" / "shot000").is_dir() else folder / "shots"
    run(roomcal, "import", "kalibr", first / "camchain.yaml", "--nominal", first / "nominal.json", "-o",
        folder / "device.yaml")
    text = (folder / "device.yaml").read_text()
    text = text.replace("\nrig_frame", "\nserial: RB-0042\nrig_frame", 1)
    text += ("wiring:\n  button: {kind: evdev, path: button, code: 141}\n  light: {kind: led, path: light}\n"
             "  store: {kind: file, path: store}\n  replay: shots\n" + wiring)
    (folder / "device.yaml").write_text(text)
    run(roomcal, "provision", folder / "device.yaml", "-o", folder)
    (folder / "light").mkdir(exist_ok=True)
    if not (folder / "button").exists():
        os.mkfifo(folder / "button")
    return first


class Roomcald:
    """The program on a pseudo-terminal. Kills it at the end whatever happens."""

    def __init__(self, program, folder, board, options=(), obey_modes=False):
        self.program, self.folder, self.board, self.options = str(program), folder, board, list(options)
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        # For the superuser no file is read-only, unless that right is taken away.
        self.wrapper = ["setpriv", "--bounding-set=-dac_override"] if obey_modes and os.geteuid() == 0 else []
        self.text = b""
        self.log = folder / "roomcald.log"
        self.process = None
        self.next_id = 0
        self.start()

    def start(self):
        with open(self.log, "ab") as log:
            self.process = subprocess.Popen(
                [*self.wrapper, self.program, "--board", self.board, "--folder", str(self.folder), "--console",
                 os.ttyname(self.slave), *self.options], stderr=log, stdin=subprocess.DEVNULL)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        os.close(self.master)
        os.close(self.slave)

    def cut_power(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def end(self, timeout=PATIENCE_S):
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(timeout)

    def read_some(self, wait_s):
        ready, _, _ = select.select([self.master], [], [], wait_s)
        if ready:
            self.text += os.read(self.master, 65536)

    def write(self, data):
        sent = 0
        while sent < len(data):
            _, ready, _ = select.select([], [self.master], [], 5)
            expect(ready, "the console takes no more bytes")
            sent += os.write(self.master, data[sent:sent + 512])

    def line(self, timeout=PATIENCE_S):
        """The next whole line of output."""
        end = time.monotonic() + timeout
        while b"\n" not in self.text:
            expect(time.monotonic() < end, f"no line came; so far {self.text!r}; log: {self.log.read_text()[-800:]}")
            expect(self.process.poll() is None, f"roomcald ended: {self.log.read_text()[-2000:]}")
            self.read_some(0.1)
        first, self.text = self.text.split(b"\n", 1)
        return first.decode(errors="replace").strip("\r")

    def ask(self, command, *arguments, timeout=PATIENCE_S):
        """One JSON request to its answer; events on the way are dropped."""
        self.next_id += 1
        request = {"cmd": command, "id": self.next_id}
        if arguments:
            request["args"] = list(arguments)
        self.write(json.dumps(request).encode() + b"\n")
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            answer = self.json_line(end - time.monotonic())
            if answer.get("id") == self.next_id:
                return answer
        raise Failure(f"{command}: no answer")

    def json_line(self, timeout=PATIENCE_S):
        end = time.monotonic() + timeout
        while True:
            text = self.line(max(0.1, end - time.monotonic()))
            start = text.find("{")
            if start < 0:
                continue
            try:
                return json.loads(text[start:])
            except json.JSONDecodeError:
                continue

    def data(self, command, *arguments):
        answer = self.ask(command, *arguments)
        expect(answer.get("ok"), f"{command}: {answer}")
        return answer["data"]

    def event(self, name, timeout=PATIENCE_S):
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            line = self.json_line(end - time.monotonic())
            if line.get("ev") == name:
                return line["data"]
        raise Failure(f"no event {name}")

    def wait_armed(self, timeout=PATIENCE_S):
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            if "armed" in self.log.read_text() and self.ask("status")["ok"]:
                return
            time.sleep(0.05)
        raise Failure(f"not armed: {self.log.read_text()[-2000:]}")

    def press(self, seconds):
        run(sys.executable, PRESS, self.folder / "button", seconds)

    def raise_rights(self):
        """To operate: hold the button for longer than a second and let go before it means to calibrate."""
        self.press(1.5)


def main(test, arguments):
    """test(*arguments) with the usual ends: 0 passed, 1 failed with the reason."""
    try:
        test(*arguments)
    except Failure as failure:
        print(f"FAILED: {failure}")
        return 1
    print("passed")
    return 0
