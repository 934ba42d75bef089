"""A LiDAR on the guest's network: the packets of a recording, at their own rate, for ever."""

import socket
import struct
import threading
import time


def payloads(pcap):
    """UDP payloads of a capture (pcap, Ethernet, IPv4 without fragments) with their seconds since the first."""
    data = pcap.read_bytes()
    magic = struct.unpack_from("<I", data)[0]
    scale = {0xA1B2C3D4: 1e-6, 0xA1B23C4D: 1e-9}[magic]
    at, first, found = 24, None, []
    while at + 16 <= len(data):
        seconds, fraction, length, _ = struct.unpack_from("<IIII", data, at)
        frame = data[at + 16:at + 16 + length]
        at += 16 + length
        if frame[12:14] != b"\x08\x00" or frame[23] != 17:
            continue
        begin = 14 + 4 * (frame[14] & 15) + 8
        stamp = seconds + fraction * scale
        first = stamp if first is None else first
        found.append((stamp - first, frame[begin:]))
    return found


class Lidar:
    def __init__(self, pcap, port):
        self.packets = payloads(pcap)
        self.period = self.packets[-1][0] * len(self.packets) / (len(self.packets) - 1)
        self.address = ("127.0.0.1", port)
        self.sent = 0
        self.stop = False
        self.thread = threading.Thread(target=self._send, daemon=True)
        self.thread.start()

    def _send(self):
        out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        begin = time.monotonic()
        while not self.stop:
            for offset, payload in self.packets:
                time.sleep(max(0.0, begin + offset - time.monotonic()))
                out.sendto(payload, self.address)
                self.sent += 1
                if self.stop:
                    return
            begin = max(begin + self.period, time.monotonic() - 0.1)

    def close(self):
        self.stop = True
        self.thread.join(1)
