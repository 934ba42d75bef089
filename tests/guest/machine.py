"""One virtual machine, driven from outside only: its lines, its button and lamp, its buses, its power.

QEMU's own processor emulation (never /dev/kvm: on build machines it is often there and does not work). The aarch64
machine has a PL061, whose lines become a real gpio-keys button and a real leds-gpio lamp by three nodes in the device
tree; the host moves and watches them through QEMU's qtest socket.
"""

import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import tempfile
import threading
import time

TOP = pathlib.Path(__file__).resolve().parents[2]
BUTTON, LAMP = 4, 5  # lines of the PL061
KEY_SETUP = 141


class Failed(Exception):
    """What a scenario found; its text is the report."""


def wait_for(what, condition, seconds):
    """The condition's value once it is true; Failed with `what` after so many seconds."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise Failed(f"{what}: not within {seconds:.0f} s")


class Line:
    """One socket of text that comes and goes, with its history."""

    def __init__(self, path, log):
        self.socket = socket.socket(socket.AF_UNIX)
        for _ in range(500):
            try:
                self.socket.connect(str(path))
                break
            except OSError:
                time.sleep(0.02)
        else:
            raise Failed(f"{path}: QEMU does not listen")
        self.log = open(log, "ab", buffering=0)
        self.text = ""
        self.lock = threading.Lock()
        self.arrivals = []
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        while True:
            try:
                data = self.socket.recv(65536)
            except OSError:
                return
            if not data:
                return
            self.log.write(data)
            with self.lock:
                self.arrivals.append((time.monotonic(), len(self.text)))
                self.text += data.decode("utf-8", "replace")

    def send(self, data):
        self.socket.sendall(data.encode() if isinstance(data, str) else data)

    def mark(self):
        return len(self.text)

    def wait(self, pattern, seconds, since=0):
        """The match of a pattern in what came since a mark."""
        try:
            return wait_for(f"`{pattern}`", lambda: re.search(pattern, self.text[since:]), seconds)
        except Failed as failed:
            raise Failed(f"{failed}; the last of the line: {self.text[since:][-400:]!r}") from None

    def close(self):
        self.socket.close()


class Console(Line):
    """The device's diagnostic console, asked by machine: one JSON object a line."""

    number = 0

    def ask(self, verb, *words, seconds=20):
        """The answer's data; Failed for a refusal or silence."""
        answer = self.answer(verb, *words, seconds=seconds)
        if not answer.get("ok"):
            raise Failed(f"console: {verb}: {answer}")
        return answer.get("data", {})

    def answer(self, verb, *words, seconds=20):
        Console.number += 1
        number = Console.number
        mark = self.mark()
        self.send(json.dumps({"cmd": verb, "args": list(words), "id": number}) + "\n")
        match = self.wait(r'(?m)^(\{"id":%d,[^\r\n]*)\r?\n' % number, seconds, mark)
        return json.loads(match.group(1))


class Lamp:
    """Every change of the lamp as (seconds, lit)."""

    def __init__(self):
        self.changes = []

    def changed(self, lit):
        self.changes.append((time.monotonic(), lit))

    def count(self, begin, end=None):
        return sum(1 for at, lit in self.changes if lit and at >= begin and (end is None or at < end))

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


class Gpio:
    """Button and lamp, through qtest: lines of text."""

    def __init__(self, path, chip):
        self.chip = chip
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.connect(str(path))
        self.lamp = Lamp()
        threading.Thread(target=self._read, daemon=True).start()
        self._send(f"irq_intercept_out {chip}")

    def _send(self, line):
        self.socket.sendall((line + "\n").encode())

    def _read(self):
        waiting = b""
        while True:
            try:
                data = self.socket.recv(4096)
            except OSError:
                return
            if not data:
                return
            waiting += data
            *lines, waiting = waiting.split(b"\n")
            for line in lines:
                match = re.match(rb"IRQ (raise|lower) (\d+)", line)
                if match and int(match.group(2)) == LAMP:
                    self.lamp.changed(match.group(1) == b"raise")

    def button(self, down):
        self._send(f"set_irq_in {self.chip} unnamed-gpio-in {BUTTON} {int(down)}")

    def press(self, seconds):
        self.button(True)
        time.sleep(seconds)
        self.button(False)


class Monitor:
    """QEMU's machine protocol."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.connect(str(path))
        self.file = self.socket.makefile("rw")
        self.events = []
        self.file.readline()
        self.call("qmp_capabilities")

    def call(self, command, **arguments):
        self.file.write(json.dumps({"execute": command, "arguments": arguments}) + "\n")
        self.file.flush()
        while True:
            answer = json.loads(self.file.readline())
            if "event" in answer:
                self.events.append(answer["event"])
            elif "error" in answer:
                raise Failed(f"qemu: {command}: {answer['error']['desc']}")
            else:
                return answer["return"]

    def human(self, line):
        return self.call("human-monitor-command", **{"command-line": line})


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


class Machine:
    """A guest with the firmware image of one processor.

    @param architecture  "aarch64" or "x86_64"
    @param disk  the device's disk; written to, survives kill()
    @param extra  further initrd whose files are laid over the firmware's: helpers, never changes of what is tested
    """

    def __init__(self, architecture, disk, folder, extra=None, append="", devices=()):
        self.architecture = architecture
        self.disk = pathlib.Path(disk)
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.extra = extra
        self.append = append
        self.devices = list(devices)
        self.sockets = pathlib.Path(tempfile.mkdtemp(prefix="roomcal-vm-"))  # a socket's path must be short
        self.process = None
        self.boots = 0

    def start(self):
        image = TOP / "build/image" / self.architecture
        self.boots += 1
        for old in self.sockets.glob("*"):
            old.unlink()
        initrd = image / "initrd.img"
        if self.extra:
            initrd = self.folder / "initrd.img"
            with open(initrd, "wb") as out:
                for part in (image / "initrd.img", self.extra):
                    out.write(part.read_bytes())
                    out.write(bytes(-out.tell() % 512))  # the kernel looks for the next archive at whole words
        self.can_port = free_port()
        self.lidar_port = free_port(socket.SOCK_DGRAM)
        command = self._command(image, initrd)
        if self.architecture == "aarch64":
            command += ["-dtb", str(self._device_tree(command))]
        self.started = time.monotonic()
        # Whatever ends this test ends its machine.
        self.process = subprocess.Popen(["setpriv", "--pdeathsig", "KILL", *command], stdin=subprocess.DEVNULL, stdout=open(self.folder / "qemu.log", "ab"),
                                        stderr=subprocess.STDOUT)
        self.kernel = Line(self.sockets / "kernel", self.folder / "kernel.log")
        self.console = Console(self.sockets / "console", self.folder / "console.log")
        self.shell = Line(self.sockets / "shell", self.folder / "shell.log")
        self.monitor = Monitor(self.sockets / "monitor")
        self.gpio = None
        if self.architecture == "aarch64":
            tree = self.monitor.human("info qom-tree")
            chip = re.search(r"/(device\[\d+\]) \(pl061\)", tree)
            self.gpio = Gpio(self.sockets / "qtest", f"/machine/unattached/{chip.group(1)}")
        return self

    def _command(self, image, initrd):
        unix = lambda name: f"socket,id={name},path={self.sockets / name},server=on,wait=off"  # noqa: E731
        consoles = {"aarch64": "ttyAMA0", "x86_64": "ttyS0"}
        machine = {"aarch64": ["qemu-system-aarch64", "-M", "virt", "-cpu", "cortex-a72"],
                   "x86_64": ["qemu-system-x86_64", "-M", "q35", "-cpu", "qemu64"]}[self.architecture]
        return machine + [
            "-accel", "tcg,thread=multi", "-smp", "2", "-m", "512", "-nodefaults", "-display", "none",
            "-kernel", str(image / "vmlinuz"), "-initrd", str(initrd),
            "-append", f"console={consoles[self.architecture]} panic=1 {self.append}",
            "-chardev", unix("kernel"), "-serial", "chardev:kernel",
            "-chardev", unix("console"), "-device", "pci-serial,chardev=console",
            "-chardev", f"socket,id=can,host=127.0.0.1,port={self.can_port},server=on,wait=off",
            "-device", "pci-serial,chardev=can",
            "-device", "virtio-serial-pci", "-chardev", unix("shell"), "-device", "virtconsole,chardev=shell",
            "-chardev", unix("monitor"), "-mon", "chardev=monitor,mode=control",
            "-qtest", f"unix:{self.sockets / 'qtest'},server=on,wait=off", "-qtest-log", "none",
            "-netdev", f"user,id=net,restrict=on,hostfwd=udp:127.0.0.1:{self.lidar_port}-10.0.2.15:2368",
            "-device", "virtio-net-pci,netdev=net,romfile=",
            "-drive", f"file={self.disk},if=none,id=disk,format=raw,cache=writeback",
            "-device", "virtio-blk-pci,drive=disk",
            "-device", "i6300esb", "-action", "watchdog=reset", *self.devices]

    def _device_tree(self, command):
        """What QEMU would give the kernel, with button and lamp."""
        dumped = self.sockets / "virt.dtb"
        words = [w.replace("virt", f"virt,dumpdtb={dumped}", 1) if w == "virt" else w for w in command]
        quiet = [w.replace("server=on,wait=off", "server=on,wait=off") for w in words]
        run(quiet)
        for old in self.sockets.glob("*"):
            if old != dumped:
                old.unlink()
        source = run(["dtc", "-q", "-I", "dtb", "-O", "dts", str(dumped)])
        end = source.rindex("};")
        tree = self.folder / "virt.dts"
        tree.write_text(source[:end] + DEVICE_TREE + source[end:])
        run(["dtc", "-q", "-I", "dts", "-O", "dtb", "-o", str(self.folder / "virt.dtb"), str(tree)])
        return self.folder / "virt.dtb"

    def run(self, line, seconds=30):
        """A command in the guest's shell, on a line of its own; its output. Failed if it does not end in order."""
        mark = self.shell.mark()
        self.shell.send(f"{line}\necho \"<$?>\"\n")
        match = self.shell.wait(r"(?s)(.*?)<(\d+)>\r?\n", seconds, mark)
        output = match.group(1).replace("\r", "")
        if match.group(2) != "0":
            raise Failed(f"guest: {line}: status {match.group(2)}: {output.strip()}")
        return output

    def wait_ready(self, seconds=120):
        """Until the console answers. @return seconds since the start."""
        def answers():
            try:
                return self.console.answer("status", seconds=2)
            except (Failed, OSError):
                return None
        wait_for("the console's first answer", answers, seconds)
        return time.monotonic() - self.started

    def alive(self):
        return self.process is not None and self.process.poll() is None

    def kill(self):
        """Takes the power away."""
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            for line in (self.kernel, self.console, self.shell):
                line.close()
            self.process = None

    def close(self):
        self.kill()
        shutil.rmtree(self.sockets, ignore_errors=True)


def free_port(kind=socket.SOCK_STREAM):
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def run(command, **options):
    """Standard output; Failed with what it said if it fails."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise Failed(f"{' '.join(str(w) for w in command[:4])} ...: status {done.returncode}: {done.stderr.strip()[-600:]}")
    return done.stdout


def environment(**more):
    return {**os.environ, **more}
