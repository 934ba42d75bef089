"""Reads CAN messages by drivers/can/roomcal.dbc, independently of the program: the file's text and python3-can only.

The decoder is the one that holds the C++ codec to its word (tests/drivers/can/codec_test.py).
"""

import pathlib
import sys

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "tests/drivers/can"))
import codec_test  # noqa: E402


class Dbc:
    def __init__(self, path=TOP / "drivers/can/roomcal.dbc"):
        self.messages = codec_test.read_dbc(path)
        self.names = {number: name for name, (number, *_rest) in self.messages.items()}
        self.labels = {}
        for line in open(path, encoding="utf-8"):
            words = line.split(None, 3)
            if line.startswith("VAL_ "):
                pairs = words[3].rstrip().rstrip(";").split('"')
                table = {int(number): label for number, label in zip(pairs[0::2], pairs[1::2]) if number.strip()}
                self.labels[(self.names[int(words[1])], words[2])] = table

    def decode(self, number, data):
        """(message, {signal: label or value}); None for a message of somebody else. A bad checksum is an error."""
        name = self.names.get(number)
        if name is None:
            return None
        _, length, signals, data_id = self.messages[name]
        assert len(data) == length, f"{name} of {len(data)} bytes"
        wanted = codec_test.remainder(data_id.to_bytes(2, "little") + bytes(data[1:]))
        assert wanted == data[0], f"{name}: checksum of {data.hex()}"
        values = {}
        for signal, (bits, signed, factor, offset, _low, _high) in signals.items():
            raw = codec_test.raw_of(data, bits, signed)
            values[signal] = self.labels.get((name, signal), {}).get(raw, float(raw * factor + offset))
        return name, values

    def encode(self, name, counter, spoil=0, **raws):
        """(number, bytes) with these raw values, counter and checksum in place; spoil is mixed into the checksum."""
        number, length, signals, data_id = self.messages[name]
        word = 0
        for signal, raw in {**raws, "Counter": counter}.items():
            bits = signals[signal][0]
            word |= (raw & ((1 << len(bits)) - 1)) << bits[0]
        data = bytearray(word.to_bytes(length, "little"))
        data[0] = codec_test.remainder(data_id.to_bytes(2, "little") + bytes(data[1:])) ^ spoil
        return number, bytes(data)
