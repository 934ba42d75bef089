"""What keeps a device's store, outside of the guest, so that its power can go at any single operation."""

import pathlib
import random
import shutil
import socket
import struct
import tempfile
import threading


class PlainDisk:
    """A disk in a file: what the guest's kernel gave to it is kept."""

    def __init__(self, image):
        self.image = image

    def arguments(self, sockets):
        return ["-drive", f"file={self.image},if=none,id=disk,format=raw,cache=writeback"]

    def attach(self, sockets):
        pass

    def power_on(self):
        pass

    def close(self):
        pass


class PowerGone(Exception):
    """The medium has stopped in the middle; nothing that is asked of it is answered any more."""


class Medium:
    """Counts operations that change the store and, when told to, stands still at one of them.

    A guest that waits for a medium without power cannot tell anybody that its record is stored, so it matters neither
    how soon the machine is killed then nor how loaded the host is. The bytes survive kill() of the machine.
    """

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.operations = 0
        self.limit = None
        self.gone = threading.Event()

    def cut_after(self, operations):
        """The power goes at so many operations from now, in the middle of the last one."""
        self.limit = self.operations + operations

    def operation(self):
        """One operation begins. @return whether it is the one that the power goes at"""
        if self.gone.is_set():
            raise PowerGone
        self.operations += 1
        return self.limit is not None and self.operations >= self.limit

    def lose_power(self):
        self.gone.set()
        raise PowerGone

    def arguments(self, sockets):
        """QEMU's options that make the guest see it."""
        raise NotImplementedError

    def attach(self, sockets):
        """QEMU runs."""

    def power_on(self):
        self.limit = None
        self.gone.clear()

    def close(self):
        pass


def receive(connection, count):
    data = bytearray()
    while len(data) < count:
        part = connection.recv(count - len(data))
        if not part:
            raise ConnectionError
        data += part
    return bytes(data)


SECTOR = 512
# The protocol: github.com/NetworkBlockDevice/nbd, doc/proto.md, fixed newstyle negotiation, simple replies.
NBD_MAGIC, NBD_OPTION, NBD_OPTION_REPLY = 0x4E42444D41474943, 0x49484156454F5054, 0x3E889045565A9
NBD_REQUEST, NBD_REPLY = 0x25609513, 0x67446698
OPT_ABORT, OPT_GO, REP_ACK, REP_INFO, REP_UNSUPPORTED = 2, 7, 1, 3, 0x80000001
HAS_FLAGS, SEND_FLUSH, SEND_FUA = 1, 4, 8
READ, WRITE, DISCONNECT, FLUSH = 0, 1, 2, 3


class Disk(Medium):
    """A disk with a write cache that is lost: of what the guest wrote since its last flush each sector is kept or not.

    Served by NBD. What is counted are writes to the store's partition, the second one, and flushes with such writes
    before them.
    """

    def __init__(self, image, seed):
        super().__init__(seed)
        self.kept = bytearray(pathlib.Path(image).read_bytes())
        self.cache = {}  # sector's offset: its bytes
        begin, count = struct.unpack_from("<II", self.kept, 446 + 16 + 8)  # of the MBR's second entry
        self.store = range(begin * SECTOR, (begin + count) * SECTOR)
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="roomcal-disk-"))
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(str(self.folder / "nbd"))
        self.listener.listen()
        threading.Thread(target=self._serve, daemon=True).start()

    def arguments(self, sockets):
        return ["-drive", f"file=nbd+unix:///?socket={self.folder / 'nbd'},if=none,id=disk,format=raw,cache=writeback"]

    def power_on(self):
        for offset, data in self.cache.items():
            if self.random.random() < 0.5:
                self.kept[offset:offset + SECTOR] = data
        self.cache.clear()
        super().power_on()

    def close(self):
        self.listener.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def _serve(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self._talk, args=(connection,), daemon=True).start()

    def _talk(self, connection):
        try:
            with connection:
                if self._negotiate(connection):
                    while self._answer(connection):
                        pass
        except PowerGone:
            pass
        except OSError:  # the machine was killed
            pass

    def _negotiate(self, connection):
        connection.sendall(struct.pack(">QQH", NBD_MAGIC, NBD_OPTION, 3))
        receive(connection, 4)
        while True:
            _, option, length = struct.unpack(">QII", receive(connection, 16))
            receive(connection, length)
            tell = lambda kind, data=b"": connection.sendall(  # noqa: E731
                struct.pack(">QIII", NBD_OPTION_REPLY, option, kind, len(data)) + data)
            if option == OPT_GO:
                tell(REP_INFO, struct.pack(">HQH", 0, len(self.kept), HAS_FLAGS | SEND_FLUSH | SEND_FUA))
                tell(REP_ACK)
                return True
            tell(REP_ACK if option == OPT_ABORT else REP_UNSUPPORTED)
            if option == OPT_ABORT:
                return False

    def _answer(self, connection):
        _, flags, kind, handle, offset, length = struct.unpack(">IHHQQI", receive(connection, 28))
        if self.gone.is_set():
            raise PowerGone
        answer = b""
        if kind == READ:
            answer = self._read(offset, length)
        elif kind == WRITE:
            self._write(offset, receive(connection, length))
        if kind == FLUSH or kind == WRITE and flags & 1:
            self._flush()
        if kind == DISCONNECT:
            return False
        connection.sendall(struct.pack(">IIQ", NBD_REPLY, 0, handle) + answer)
        return True

    def _read(self, offset, length):
        data = bytearray(self.kept[offset:offset + length])
        if self.cache:
            for at in range(offset, offset + length, SECTOR):
                if at in self.cache:
                    data[at - offset:at - offset + SECTOR] = self.cache[at]
        return bytes(data)

    def _write(self, offset, data):
        for at in range(0, len(data), SECTOR):
            self.cache[offset + at] = data[at:at + SECTOR]
        if offset in self.store and self.operation():
            self.lose_power()

    def _flush(self):
        if any(offset in self.store for offset in self.cache) and self.operation():
            self.lose_power()
        for offset, data in self.cache.items():
            self.kept[offset:offset + SECTOR] = data
        self.cache.clear()
