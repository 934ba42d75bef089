"""One virtual machine, driven from outside only: its lines, its button and lamp (panel.py), its buses, its power.

QEMU's own processor emulation (never /dev/kvm: on build machines it is often there and does not work), with the guest's
time bound to its instructions, a nanosecond each: on a loaded host the guest is slower, not starved. Bound to the host's
time, its real-time threads take all that there is as soon as they get less than they need, and the console is not served.
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

import panel
from waiting import Failed, wait_for

TOP = pathlib.Path(__file__).resolve().parents[2]
MACHINES = {
    "aarch64": ["qemu-system-aarch64", "-M", "virt", "-cpu", "cortex-a72"],
    "x86_64": ["qemu-system-x86_64", "-M", "q35", "-cpu", "max"],
}
HOLD_S = 3.6
KERNEL_LINES = {"aarch64": "ttyAMA0", "x86_64": "ttyS0"}
CONSOLE_SLOT, CAN_SLOT = 0x10, 0x11  # of the PCI bus: by these the guest finds its serial lines


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

    def ask(self, verb, *words, seconds=60):
        """The answer's data; Failed for a refusal or silence."""
        answer = self.answer(verb, *words, seconds=seconds)
        if not answer.get("ok"):
            raise Failed(f"console: {verb}: {answer}")
        return answer.get("data", {})

    def answer(self, verb, *words, seconds=60):
        Console.number += 1
        number = Console.number
        mark = self.mark()
        self.send(json.dumps({"cmd": verb, "args": list(words), "id": number}) + "\n")
        match = self.wait(r'(?m)^(\{"id":%d,[^\r\n]*)\r?\n' % number, seconds, mark)
        return json.loads(match.group(1))


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


class Machine:
    """A guest with the firmware image of one processor.

    @param architecture  "aarch64" or "x86_64"
    @param media  what keeps bytes without power (medium.py): a disk, perhaps an EEPROM; they survive kill()
    @param extra  further initrd whose files are laid over the firmware's: helpers, never changes of what is tested
    """

    def __init__(self, architecture, media, folder, extra=None, append=""):
        self.architecture = architecture
        self.media = list(media)
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.extra = extra
        self.append = append
        self.sockets = pathlib.Path(tempfile.mkdtemp(prefix="roomcal-vm-"))  # a socket's path must be short
        self.process = None

    def start(self):
        image = TOP / "build/image" / self.architecture
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
        for medium in self.media:
            medium.power_on()
        command = self._command(image, initrd)
        if self.architecture == "aarch64":
            command += ["-dtb", str(self._device_tree(command))]
        else:
            (self.sockets / "trace").touch()
            command += ["-trace", panel.KeyboardPanel.TRACE, "-D", str(self.sockets / "trace")]
        self.started = time.monotonic()
        # Whatever ends this test ends its machine.
        with open(self.folder / "qemu.log", "ab") as log:
            self.process = subprocess.Popen(["setpriv", "--pdeathsig", "KILL", *command], stdin=subprocess.DEVNULL,
                                            stdout=log, stderr=subprocess.STDOUT)
        self.kernel = Line(self.sockets / "kernel", self.folder / "kernel.log")
        self.console = Console(self.sockets / "console", self.folder / "console.log")
        self.shell = Line(self.sockets / "shell", self.folder / "shell.log")
        self.monitor = Monitor(self.sockets / "monitor")
        self.panel = self._panel()
        for medium in self.media:
            medium.attach(self.sockets)
        return self

    def _panel(self):
        if self.architecture == "x86_64":
            return panel.KeyboardPanel(self.monitor, self.sockets / "trace")
        chip = re.search(r"/(device\[\d+\]) \(pl061\)", self.monitor.human("info qom-tree"))
        return panel.GpioPanel(self.sockets / "qtest", f"/machine/unattached/{chip.group(1)}")

    def _command(self, image, initrd):
        unix = lambda name: f"socket,id={name},path={self.sockets / name},server=on,wait=off"  # noqa: E731
        return MACHINES[self.architecture] + [
            "-accel", "tcg,thread=single", "-icount", "shift=0,sleep=on", "-smp", "1", "-m", "512",
            "-nodefaults", "-display", "none",
            "-kernel", str(image / "vmlinuz"), "-initrd", str(initrd),
            "-append", f"console={KERNEL_LINES[self.architecture]} panic=1 {self.append}",
            "-chardev", unix("kernel"), "-serial", "chardev:kernel",
            "-chardev", unix("console"), "-device", f"pci-serial,chardev=console,addr={CONSOLE_SLOT:#x}",
            "-chardev", f"socket,id=can,host=127.0.0.1,port={self.can_port},server=on,wait=off",
            "-device", f"pci-serial,chardev=can,addr={CAN_SLOT:#x}",
            "-device", "virtio-serial-pci", "-chardev", unix("shell"), "-device", "virtconsole,chardev=shell",
            "-chardev", unix("monitor"), "-mon", "chardev=monitor,mode=control",
            "-qtest", f"unix:{self.sockets / 'qtest'},server=on,wait=off", "-qtest-log", "none",
            "-netdev", f"user,id=net,restrict=on,hostfwd=udp:127.0.0.1:{self.lidar_port}-10.0.2.15:2368",
            "-device", "virtio-net-pci,netdev=net,romfile=",
            *(word for medium in self.media for word in medium.arguments(self.sockets)),
            "-device", "virtio-blk-pci,drive=disk",
            "-device", "i6300esb", "-action", "watchdog=reset"]

    def _device_tree(self, command):
        """What QEMU would give the kernel, with button and lamp."""
        dumped = self.sockets / "virt.dtb"
        words = [w.replace("virt", f"virt,dumpdtb={dumped}", 1) if w == "virt" else w for w in command]
        run(words)
        for old in self.sockets.glob("*"):
            if old != dumped:
                old.unlink()
        source = run(["dtc", "-q", "-I", "dtb", "-O", "dts", str(dumped)])
        end = source.rindex("};")
        tree = self.folder / "virt.dts"
        tree.write_text(source[:end] + panel.DEVICE_TREE + source[end:])
        run(["dtc", "-q", "-I", "dts", "-O", "dtb", "-o", str(self.folder / "virt.dtb"), str(tree)])
        return self.folder / "virt.dtb"

    def run(self, line, seconds=120):
        """A command in the guest's shell, on a line of its own; its output. Failed if it does not end in order."""
        mark = self.shell.mark()
        self.shell.send(f"{line}\necho \"<$?>\"\n")
        match = self.shell.wait(r"(?s)(.*?)<(\d+)>\r?\n", seconds, mark)
        output = match.group(1).replace("\r", "")
        if match.group(2) != "0":
            raise Failed(f"guest: {line}: status {match.group(2)}: {output.strip()}")
        return output

    def wait_ready(self, seconds=300):
        """Until the console answers. @return seconds since the start."""
        mark = self.console.mark()

        def answers():
            """Asked anew every now and then: what comes before the program does is lost. An answer may take longer."""
            try:
                return self.console.answer("status", seconds=5)
            except (Failed, OSError):
                return re.search(r'"cmd":"status","ok":true', self.console.text[mark:])
        wait_for("the console's first answer", answers, seconds)
        return time.monotonic() - self.started

    def uptime_s(self):
        """The guest's own time, which is never faster than the host's."""
        return float(self.run("cut -d' ' -f1 /proc/uptime"))

    def pass_time(self, seconds):
        """Waits for so many seconds of the guest."""
        end = self.uptime_s() + seconds
        wait_for(f"{seconds} seconds of the guest", lambda: self.uptime_s() > end, 60 + 10 * seconds)

    def press(self):
        """Holds the button for a calibration: the guest's three seconds, and the lamp then says "let go"."""
        self.panel.button(True)
        self.pass_time(HOLD_S)
        lit = self.panel.lamp.lit()
        self.panel.button(False)
        if not lit:
            raise Failed("the button was held for three seconds and the lamp does not say that it may be let go")

    def alive(self):
        return self.process is not None and self.process.poll() is None

    def kill(self):
        """Takes the power away."""
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            for line in (self.kernel, self.console, self.shell, self.panel):
                line.close()
            self.process = None

    def close(self):
        self.kill()
        for medium in self.media:
            medium.close()
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
