"""The device in the guest: a mobile robot of the simulator, its room, shots, profile, disk, and the helpers beside it.

Cameras are vivid's, fed with the simulator's pictures through its output-to-capture loop (640 x 360 ones, with a grey bar
above and below: vivid has no timing of that size). The LiDAR's packets come from the host, through the network.
"""

import pathlib
import re
import shutil

import panel
from machine import CAN_SLOT, CONSOLE_SLOT, TOP, Failed, environment, run

MARKERS, SCALE, SHOTS = 160, 0.5, 2
WIDTH, HEIGHT, BAR = 640, 480, 60
CAMERAS = 4
HOST = TOP / "build/host-release"
_built = set()

SETUP = """
# A shell for the test, beside the device. Not through cat: its sendfile() keeps the pipe locked while it waits for a line.
modprobe virtio_console || say "module virtio_console cannot be loaded"
(while :; do (stty -echo; dd bs=4096 2>/dev/null) </dev/hvc0 | setsid sh >/dev/hvc0 2>&1; sleep 1; done) &
export PATH=$PATH:/opt/test/bin
for event in /sys/class/input/event*; do
  [ "$(cat $event/device/name)" = "@INPUT@" ] && ln -s /dev/input/${event##*/} /dev/button
done
ln -s /sys/class/leds/@LAMP@ /dev/lamp
serial() { ls /sys/bus/pci/devices/0000:00:$1.0/tty; }
ln -s $(serial @CONSOLE@) /dev/line-console
ln -s $(serial @CAN@) /dev/line-can
ip addr add 10.0.2.15/24 dev eth0
ip link set eth0 up
"""
SETUP_CAN = """
modprobe slcan || say "module slcan cannot be loaded"
slcand -o -s6 line-can can0 && ip link set can0 up
"""
SETUP_CAMERAS = """
modprobe vivid n_devs=4 node_types=0x101,0x101,0x101,0x101 num_inputs=1,1,1,1 input_types=3,3,3,3 \\
  num_outputs=1,1,1,1 output_types=1,1,1,1 || say "module vivid cannot be loaded"
for i in 0 1 2 3; do
  (while :; do
    vivid_play /dev/video$((2 * i)) /dev/video$((2 * i + 1)) 640x480 /boot/roomcal/shots/shot*/cam$i.grey 2>/dev/kmsg
    sleep 1
  done) &
done
"""

WIRING = """
grab: {patience_s: PATIENCE, image_wait_s: 30}
wiring:
  button: {kind: evdev, path: /dev/button, code: KEY_CODE}
  light: {kind: led, path: /dev/lamp}
  console: {path: /dev/line-console}
  can: {interface: can0, standstill: true}
  watchdog: {path: /dev/watchdog0, timeout_s: 10}
  store: {kind: partition, path: /dev/roomcal-store, size_bytes: 0}
"""


def host_program(name="roomcal"):
    """A program of the host's own build, brought up to date: roomcal makes room, shots and profile."""
    if name not in _built:
        if not (HOST / "CMakeCache.txt").exists():
            run([TOP / "tools/setup"])
            run(["cmake", "--preset", "host-release", "-DROOMCAL_TESTS=OFF"], cwd=TOP)
        run(["cmake", "--build", "--preset", "host-release", "--target", name], cwd=TOP)
        _built.add(name)
    return HOST / name


def pad(picture):
    """Grey bytes of a PGM of 640 x 360 in 640 x 480."""
    data = picture.read_bytes()
    head = re.match(rb"P5\s+(\d+)\s+(\d+)\s+255\s", data)
    width, height = int(head.group(1)), int(head.group(2))
    assert (width, height) == (WIDTH, HEIGHT - 2 * BAR), picture
    bar = bytes([128]) * (WIDTH * BAR)
    return bar + data[head.end():] + bar


def simulate(folder, seed=5, shots=SHOTS, sweeps=2):
    """room.room and shots/ in the folder, the same every time."""
    roomcal = host_program()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    run([roomcal, "simulate", "room", "-o", folder / "room", "--markers", MARKERS, "--seed", 3])
    run([roomcal, "map", "import", folder / "room/markers.csv", "-o", folder / "room.room"])
    run([roomcal, "simulate", "shot", "--room", folder / "room", "--device", "mobile_robot", "--scale", SCALE,
         "--format", "pgm", "--shots", shots, "--sweeps", sweeps, "--seed", seed, "-o", folder / "shots"])


def provision(architecture, simulated, folder, cameras="v4l2", wiring=WIRING,
              setup=SETUP + SETUP_CAN + SETUP_CAMERAS, patience_s=60):
    """A device's folder: profile, factory record, map, product, setup. cameras: "v4l2" or "replay"."""
    wired = panel.WIRING[architecture]
    wiring = wiring.replace("PATIENCE", str(patience_s)).replace("KEY_CODE", str(wired["code"]))
    for word, value in (("@INPUT@", wired["input"]), ("@LAMP@", wired["lamp"]),
                        ("@CONSOLE@", f"{CONSOLE_SLOT:02x}"), ("@CAN@", f"{CAN_SLOT:02x}")):
        setup = setup.replace(word, value)
    roomcal = host_program()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    chain = (simulated / "shots/shot000/camchain.yaml").read_text()
    if cameras == "v4l2":
        chain = re.sub(r"resolution: \[640, 360\]", f"resolution: [{WIDTH}, {HEIGHT}]", chain)
        chain = re.sub(r"intrinsics: \[([^,]+), ([^,]+), ([^,]+), ([^\]]+)\]",
                       lambda m: f"intrinsics: [{m[1]}, {m[2]}, {m[3]}, {float(m[4]) + BAR!r}]", chain)
    (folder / "camchain.yaml").write_text(chain)
    run([roomcal, "import", "kalibr", folder / "camchain.yaml", "--nominal",
         simulated / "shots/shot000/nominal.json", "-o", folder / "device.yaml"])
    text = (folder / "device.yaml").read_text()
    number = 0

    def wire(match):
        nonlocal number
        driver = "kind: replay"
        if cameras == "v4l2":
            driver = f'kind: v4l2, key: "bus:platform:vivid-{number:03}", formats: ["GREY"]'
        number += 1
        return match.group(0) + f"    driver: {{{driver}}}\n"

    text = re.sub(r'  - name: "cam\d"\n', wire, text)
    packets = "kind: udp, sweeps: 1" if cameras == "v4l2" else "kind: replay, sweeps: 1"
    text = text.replace('  - name: "lidar0"\n', f'  - name: "lidar0"\n    driver: {{{packets}}}\n')
    text = text.replace('name: "mobile_robot"', 'name: "mobile_robot"\nserial: "VM-0001"', 1)
    if cameras == "replay":
        wiring = wiring + "  replay: shots\n"
    (folder / "device.yaml").write_text(text + wiring)
    run([roomcal, "provision", folder / "device.yaml", "-o", folder])
    shutil.copy(simulated / "room.room", folder / "room.room")
    board = "mobile_robot" if cameras == "v4l2" else "sim"
    (folder / "roomcald").write_text(f"ROOMCAL_BOARD={board}\nROOMCAL_OPTIONS=\n")
    (folder / "setup").write_text(setup)
    for shot in sorted((simulated / "shots").iterdir()):
        target = folder / "shots" / shot.name
        target.mkdir(parents=True)
        for i in range(CAMERAS):
            if cameras == "v4l2":
                (target / f"cam{i}.grey").write_bytes(pad(shot / f"cam{i}.pgm"))
            else:
                shutil.copy(shot / f"cam{i}.pgm", target)
        if cameras == "replay":
            shutil.copy(shot / "lidar0.pcap", target)
    return folder


def make_disk(architecture, device, image):
    run([TOP / "toolchains/disk", architecture, device, image], env=environment(SOURCE_DATE_EPOCH="1"))
    return image


class Helpers:
    """A second initrd: vivid, CAN over a serial line, probes; laid over the firmware, whose own files stay."""

    MODULES = ["vivid", "slcan", "vcan", "virtio_console", "xhci-pci", "i2c-tiny-usb", "at24"]
    PROGRAMS = ["vivid_play", "v4l2_probe", "can_probe", "freeze_thread"]
    # Debian's name, triple, where libc lies on the build machine and its loader in the guest.
    TARGETS = {
        "aarch64": ("arm64", "aarch64-linux-gnu", "/usr/aarch64-linux-gnu/lib", "lib/ld-linux-aarch64.so.1"),
        "x86_64": ("amd64", "x86_64-linux-gnu", "/lib/x86_64-linux-gnu", "lib64/ld-linux-x86-64.so.2"),
    }

    def __init__(self, architecture, folder):
        self.architecture, self.folder = architecture, folder
        self.debian, self.triple, self.libc, self.loader = self.TARGETS[architecture]

    def make(self):
        root = self.folder / "helpers"
        shutil.rmtree(root, ignore_errors=True)
        programs = root / "opt/test/bin"
        programs.mkdir(parents=True)
        built = TOP / "build" / self.architecture
        if not (built / "CMakeCache.txt").exists():
            raise Failed(f"{built} is missing: ./toolchains/build {self.architecture}")
        run(["cmake", "--build", built, "--target", *self.PROGRAMS])
        for name in self.PROGRAMS:
            run([f"{self.triple}-strip", "-o", programs / name, built / "tests/guest" / name])
        self._slcand(root, programs)
        self._modules(root)
        image = self.folder / "helpers.img"
        with open(image, "wb") as out:
            names = "\n".join(str(p.relative_to(root)) for p in sorted(root.rglob("*")))
            packed = run_bytes(["cpio", "-o", "-H", "newc", "--quiet", "--owner=0:0"], names.encode(), root)
            out.write(packed)
        return image

    def _slcand(self, root, programs):
        unpacked = self.folder / "can-utils"
        package = run([TOP / "toolchains/fetch", self.debian, "can-utils"]).strip()
        run(["dpkg-deb", "-x", package, unpacked])
        shutil.copy(unpacked / "usr/bin/slcand", programs)
        shutil.copy(unpacked / "usr/bin/candump", programs)
        # Its libc is the compiler's, of the same Debian.
        loader = root / self.loader
        loader.parent.mkdir(exist_ok=True)
        shutil.copy(pathlib.Path(self.libc) / loader.name, loader)
        (root / "lib").mkdir(exist_ok=True)
        shutil.copy(pathlib.Path(self.libc) / "libc.so.6", root / "lib")

    def _modules(self, root):
        kernel = next((TOP / "build/download" / self.debian).glob("linux-image-*/unpacked")).parent
        version = next((kernel / "lib/modules").iterdir()).name
        firmware = (TOP / "board/firmware/modules").read_text().splitlines()
        wanted = self.MODULES + [w.rstrip("?") for w in firmware if w and not w.startswith("#")]
        for module in wanted:
            try:
                listed = run(["modprobe", "-d", kernel, "-S", version, "--show-depends", module])
            except Failed:
                if module in self.MODULES:
                    raise Failed(f"the kernel {version} has no module {module}") from None
                continue
            for line in listed.splitlines():
                if not line.startswith("insmod"):
                    continue
                inside = line.split()[1].split(f"/lib/modules/{version}/", 1)[1]
                target = root / "lib/modules" / version / inside
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(kernel / "lib/modules" / version / inside, target)
        for table in ("modules.order", "modules.builtin", "modules.builtin.modinfo"):
            shutil.copy(kernel / "lib/modules" / version / table, root / "lib/modules" / version / table)
        run(["depmod", "-b", root, version])


def run_bytes(command, data, folder):
    import subprocess
    done = subprocess.run(command, input=data, capture_output=True, cwd=folder)
    if done.returncode != 0:
        raise Failed(f"{command[0]}: {done.stderr.decode()}")
    return done.stdout
