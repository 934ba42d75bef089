"""An EEPROM on an I2C bus of the guest: Linux' own at24 and i2c-tiny-usb, chip and adapter played on the host.

Neither of QEMU's machines has an I2C bus that a chip could be hung on, but both have USB, and a USB device may be
redirected to the host: QEMU speaks usbredir (gitlab.freedesktop.org/spice/usbredir, docs/usb-redirection-protocol.md)
with it. The adapter's requests: Linux, drivers/i2c/busses/i2c-tiny-usb.c.
"""

import socket
import struct
import threading

from machine import Failed
from medium import Medium, PowerGone, receive

SETUP = """
for module in xhci-pci i2c-tiny-usb at24; do modprobe $module || say "module $module cannot be loaded"; done
for i in $(seq 120); do
  bus=$(grep -l i2c-tiny-usb /sys/bus/i2c/devices/i2c-*/name 2>/dev/null) && break
  sleep 0.5
done
bus=${bus%/name}
echo 24c512 0x50 >$bus/new_device || say "no EEPROM at $bus"
ln -s /sys/bus/i2c/devices/${bus##*-}-0050/eeprom /dev/roomcal-eeprom
"""
SIZE, PAGE, ADDRESS = 65536, 128, 0x50  # of a 24C512

HELLO, CONNECT, INTERFACES, ENDPOINTS, SET_CONFIGURATION, GET_CONFIGURATION, CONFIGURATION_STATUS = 0, 1, 4, 5, 6, 7, 8
CONTROL = 100
SUCCESS, STALL = 0, 4
FULL_SPEED, VENDOR_CLASS, NO_ENDPOINT = 1, 0xFF, 255
CAPABILITIES = 1 << 4 | 1 << 5 | 1 << 6  # packet sizes, numbers of 64 bits, lengths of 32: QEMU's xHCI asks for them
VENDOR, PRODUCT = 0x0403, 0xC631

DEVICE = struct.pack("<BBHBBBBHHHBBBB", 18, 1, 0x0110, VENDOR_CLASS, 0, 0, 64, VENDOR, PRODUCT, 0x0205, 0, 0, 0, 1)
CONFIGURATION = struct.pack("<BBHBBBBB", 9, 2, 18, 1, 1, 0, 0x80, 50) + bytes([9, 4, 0, 0, 0, VENDOR_CLASS, 0, 0, 0])
GET_DESCRIPTOR = (0x80, 6)
GET_FUNCTIONS, SET_DELAY, GET_STATUS = 1, 2, 3
TRANSFERS = range(4, 8)  # of one I2C message, with or without start and stop
FUNCTIONS = 0x0EFF0009  # plain I2C and all of SMBus that can be made of it
MESSAGE_IS_READ = 1
ACKNOWLEDGED, NOT_ACKNOWLEDGED = 1, 2


class Eeprom(Medium):
    """64 KiB in pages of 128 bytes. A write that the power goes at leaves the rest of its page torn."""

    def __init__(self, seed):
        super().__init__(seed)
        self.cells = bytearray(b"\xff" * SIZE)
        self.at = 0
        self.status = 0
        self.socket = None

    def arguments(self, sockets):
        return ["-device", "qemu-xhci", "-chardev", f"socket,id=eeprom,path={sockets / 'eeprom'},server=on,wait=off",
                "-device", "usb-redir,chardev=eeprom"]

    def attach(self, sockets):
        self.close()
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.connect(str(sockets / "eeprom"))
        threading.Thread(target=self._talk, args=(self.socket,), daemon=True).start()

    def close(self):
        if self.socket is not None:
            self.socket.close()
            self.socket = None

    def _talk(self, connection):
        try:
            self._introduce(connection)
            while True:
                kind, length, number = struct.unpack("<IIQ", receive(connection, 16))
                answer = self._answer(kind, receive(connection, length))
                if answer is not None:
                    connection.sendall(struct.pack("<IIQ", answer[0], len(answer[1]), number) + answer[1])
        except PowerGone:
            pass
        except OSError:  # the machine was killed
            pass

    @staticmethod
    def _introduce(connection):
        def tell(kind, data):
            connection.sendall(struct.pack("<IIQ", kind, len(data), 0) + data)

        # The first message of both sides has a number of 32 bits: the other's capabilities are not known yet.
        hello = b"roomcal EEPROM".ljust(64, b"\0") + struct.pack("<I", CAPABILITIES)
        connection.sendall(struct.pack("<III", HELLO, len(hello), 0) + hello)
        _, length, _ = struct.unpack("<III", receive(connection, 12))
        receive(connection, length)
        none = bytes(32)
        tell(ENDPOINTS, bytes([NO_ENDPOINT]) * 32 + none + none + bytes(64))
        tell(INTERFACES, struct.pack("<I", 1) + none + bytes([VENDOR_CLASS]).ljust(32, b"\0") + none + none)
        tell(CONNECT, struct.pack("<BBBBHH", FULL_SPEED, VENDOR_CLASS, 0, 0, VENDOR, PRODUCT))

    def _answer(self, kind, data):
        if kind == SET_CONFIGURATION:
            return CONFIGURATION_STATUS, bytes([SUCCESS, data[0]])
        if kind == GET_CONFIGURATION:
            return CONFIGURATION_STATUS, bytes([SUCCESS, 1])
        if kind != CONTROL:
            return None
        endpoint, request, request_type, _, value, index, length = struct.unpack_from("<BBBBHHH", data)
        told = self._control(request_type, request, value, index, data[10:], length)
        status = STALL if told is None else SUCCESS
        told = (told or b"")[:length]
        length = len(told) if request_type & 0x80 else length
        return CONTROL, struct.pack("<BBBBHHH", endpoint, request, request_type, status, value, index, length) + told

    def _control(self, request_type, request, value, index, data, length):
        """What the device tells; None where it refuses."""
        if (request_type, request) == GET_DESCRIPTOR:
            return {1: DEVICE, 2: CONFIGURATION}.get(value >> 8)
        if request_type & 0x60 != 0x40:
            return b""
        if request == GET_FUNCTIONS:
            return struct.pack("<I", FUNCTIONS)
        if request == GET_STATUS:
            return bytes([self.status])
        if request in TRANSFERS:
            return self._message(index, value & MESSAGE_IS_READ, data, length)
        return b"" if request == SET_DELAY else None

    def _message(self, address, is_read, data, length):
        self.status = ACKNOWLEDGED if address == ADDRESS else NOT_ACKNOWLEDGED
        if address != ADDRESS:
            return bytes(length) if is_read else b""
        if self.gone.is_set():
            raise PowerGone
        return self._read(length) if is_read else self._write(data)

    def _read(self, length):
        told = bytes(self.cells[(self.at + i) % SIZE] for i in range(length))
        self.at = (self.at + length) % SIZE
        return told

    def _write(self, data):
        """Two bytes of address, then data, which wraps at the page's end."""
        if len(data) < 2:
            raise Failed(f"EEPROM: a message of {len(data)} bytes")
        self.at = int.from_bytes(data[:2], "big") % SIZE
        if len(data) == 2:
            return b""
        last = self.operation()
        page = self.at // PAGE * PAGE
        for i, byte in enumerate(data[2:]):
            self.cells[page + (self.at - page + i) % PAGE] = byte
        if last:
            self._tear(page)
            self.lose_power()
        return b""

    def _tear(self, page):
        """The chip erases and programs whole pages: from somewhere on, this one is erased or anything."""
        begin = page + self.random.randrange(PAGE)
        for at in range(begin, page + PAGE):
            self.cells[at] = self.random.choice((0xFF, self.random.randrange(256), self.cells[at]))
