"""V4L2 on a real kernel: four vivid cameras through the real driver, then every fault that vivid can inject.

v4l2_probe runs the driver as roomcald does; each camera has one of its own. A fault hits camera 1: it must recover, or name
what is wrong, within five seconds after the fault is over, and the other three must not notice.
"""

import json

from machine import Failed, wait_for

PATIENCE_S = 5
SETUP = """
modprobe vivid n_devs=4 node_types=0x1,0x1,0x1,0x1 num_inputs=1,1,1,1 input_types=0,0,0,0
for i in 0 1 2 3; do vivid_play --set /dev/video$i timestamp_source=1; done
"""
# control, value, seconds it lasts (0: vivid takes it back by itself), what may be told of it
FAULTS = [
    ("disconnect", 1, 3, ("gone", "failed", "stall")),
    ("percentage_of_dropped_buffers", 50, 3, ("lost",)),
    ("inject_v4l2_buf_flag_error", 1, 0, ("damaged", "error")),
    ("inject_vidioc_qbuf_error", 1, 0, ()),
    ("inject_vidioc_streamon_error", 1, 0, ()),
    ("inject_fatal_streaming_error", 1, 0, ()),
    ("wrap_sequence_number", 1, 3, ()),
    ("wrap_timestamp", 1, 3, ()),
]


class Probe:
    """One camera's driver in the guest, writing its seconds into a file."""

    def __init__(self, machine, number, seconds, size="320x180", fps=10):
        self.machine, self.number = machine, number
        self.file = f"/tmp/probe{number}"
        machine.run(f"(v4l2_probe --key bus:platform:vivid-{number:03} --size {size} --format GREY --fps {fps} "
                    f"--seconds {seconds} >{self.file} 2>{self.file}.log; echo ended $? >>{self.file}.log) &")

    def seconds(self):
        text = self.machine.run(f"cat {self.file}")
        return [json.loads(line) for line in text.splitlines() if line.startswith("{")]

    def wait_end(self, seconds):
        wait_for(f"the end of camera {self.number}'s probe", lambda: "ended" in self.log(), seconds)

    def log(self):
        return self.machine.run(f"cat {self.file}.log")


def soak(world):
    """Rate and gaps of four cameras at once."""
    machine = world.machine
    seconds = world.options.soak_s
    probes = [Probe(machine, i, seconds, fps=world.options.fps) for i in range(4)]
    for probe in probes:
        probe.wait_end(seconds + 120)
    worst, total, unexplained = 0.0, 0, 0
    for probe in probes:
        told = probe.seconds()
        if len(told) < seconds:
            raise Failed(f"camera {probe.number} told {len(told)} of {seconds} seconds: {probe.log()[-300:]}")
        told = told[1:]  # the first second has the opening in it
        total += sum(s["images"] for s in told)
        worst = max([worst] + [s["longest_gap_ms"] for s in told])
        # A gap is explained by images that the kernel's own numbers say were lost, or by a restart that was told.
        unexplained += sum(1 for s in told if s["longest_gap_ms"] > 3 * 1000 / world.options.fps
                           and not s["lost"] and not s["interruptions"])
        if any(s["faults"] for s in told):
            raise Failed(f"camera {probe.number} had faults: {told[-1]}")
    world.figure(f"images of four cameras in {seconds} s; rate of each", [total, round(total / 4 / (seconds - 1), 1)])
    world.figure("longest gap, ms; gaps without a loss count", [worst, unexplained])
    if unexplained:
        raise Failed(f"{unexplained} seconds had gaps that nothing explains")


def injected(world):
    machine = world.machine
    length = 10 + sum(5 + max(lasts, 1) + PATIENCE_S for _, _, lasts, _ in FAULTS)
    probes = [Probe(machine, i, length) for i in range(4)]
    machine.pass_time(5)
    for control, value, lasts, words in FAULTS:
        before = [len(p.seconds()) for p in probes]
        logged = len(probes[1].log())
        machine.run(f"vivid_play --set /dev/video1 {control}={value}")
        if lasts:
            machine.pass_time(lasts)
            machine.run(f"vivid_play --set /dev/video1 {control}=0 || true")
        over = machine.uptime_s()
        healed = wait_for_images(probes[1], over)
        report = probes[1].log()[logged:].strip().replace("\n", "; ")
        world.figure(f"{control}: images again after, s", f"{healed:.1f}  {report}")
        for probe, since in zip(probes, before):
            if probe.number == 1:
                continue
            told = probe.seconds()[since:]
            if any(s["images"] == 0 for s in told[1:-1]):
                raise Failed(f"{control} on camera 1: camera {probe.number} stopped too")
        if words and not any(w in (report + json.dumps(probes[1].seconds()[-6:])).lower() for w in words):
            raise Failed(f"{control}: nothing named it: {report!r}, {probes[1].seconds()[-1]}")


def wait_for_images(probe, since):
    """The guest's seconds until then: the probe tells once a second, of the second before."""
    while (now := probe.machine.uptime_s()) < since + PATIENCE_S + 3:
        told = probe.seconds()
        if len(told) > 1 and told[-1]["images"] > 0 and told[-1]["state"] == "streaming":
            return now - since
    raise Failed(f"camera {probe.number} is not back: {probe.seconds()[-1]}; {probe.log()[-300:]}")
