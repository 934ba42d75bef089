"""What a scenario runs in: the machine, its vehicle and LiDAR, the figures that the report prints."""

import json
import shutil

import device
from eeprom import Eeprom
from lidar import Lidar
from machine import TOP, Machine
from medium import Disk, PlainDisk
from vehicle import Vehicle


class World:
    def __init__(self, architecture, options):
        self.architecture, self.options = architecture, options
        self.work = TOP / "build/vm" / architecture
        self.work.mkdir(parents=True, exist_ok=True)
        self.figures = []
        self.machine = self.vehicle = self.lidar = self.store = None
        self.simulated = self.work / "simulated"
        self._prepared = {}

    def figure(self, name, value):
        text = f"{value:.1f}" if isinstance(value, float) else str(value)
        self.figures.append((name, text))
        print(f"     {name}: {text}", flush=True)

    def prepare(self):
        """Everything that scenarios share, once: simulation, helpers."""
        stamp = self.work / "simulated.stamp"
        recipe = f"{device.MARKERS} {device.SCALE} {device.SHOTS}"
        if not stamp.exists() or stamp.read_text() != recipe:
            device.simulate(self.simulated)
            stamp.write_text(recipe)
        self.helpers = device.Helpers(self.architecture, self.work).make()

    def disk(self, **how):
        """A fresh disk of a device that was provisioned this way."""
        key = json.dumps(how, sort_keys=True)
        if key not in self._prepared:
            name = f"device{len(self._prepared)}"
            folder = device.provision(self.architecture, self.simulated, self.work / name, **how)
            self._prepared[key] = device.make_disk(self.architecture, folder, self.work / f"{name}.img")
        fresh = self.work / "disk.img"
        shutil.copyfile(self._prepared[key], fresh)
        return fresh

    def boot(self, name, append="", store=None, **how):
        """A fresh machine. @param store  "disk" or "eeprom": where the store lies on a medium that can lose its power"""
        self.close()
        folder = self.work / "log" / name
        shutil.rmtree(folder, ignore_errors=True)
        image, seed = self.disk(**how), self.options.seed
        self.store = Disk(image, seed) if store == "disk" else Eeprom(seed) if store == "eeprom" else None
        media = [self.store] if store == "disk" else [PlainDisk(image)] + ([self.store] if self.store else [])
        self.machine = Machine(self.architecture, media, folder, self.helpers, append).start()
        self.rejoin()
        return self.machine

    def rejoin(self):
        """Vehicle and LiDAR of a machine that was started anew."""
        mood = self.vehicle.mood if self.vehicle else "silent"
        self._part()
        self.vehicle = Vehicle(self.machine.can_port)
        self.vehicle.mood = mood
        self.lidar = Lidar(self.simulated / "shots/shot000/lidar0.pcap", self.machine.lidar_port)

    def truth(self):
        """{sensor: 4x4} of the simulated device, in the reference's frame."""
        truth = json.loads((self.simulated / "shots/shot000/truth.json").read_text())
        return {pair["from"]: pair["T"] for pair in truth["extrinsics"] if pair["to"] == "cam0"}

    def _part(self):
        for part in (self.vehicle, self.lidar):
            if part is not None:
                part.close()
        self.vehicle = self.lidar = None

    def close(self):
        self._part()
        if self.machine is not None:
            self.machine.close()
            self.machine = None
