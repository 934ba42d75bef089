#!/usr/bin/env python3
"""Decodes what codec_print packed, by a decoder of its own: codec_test.py CODEC_PRINT DBC...

Nothing is shared with dbcgen.py or the C++ codec: the .dbc text is read here by splitting words, signals are picked bit by
bit, values are exact fractions, the checksum is a polynomial division.
"""

import fractions
import subprocess
import sys

POLYNOMIAL = 0x11D


def read_dbc(path):
    """{message: (number, length, {signal: (bits, signed, factor, offset, minimum, maximum)}, data id)}"""
    messages, numbers, name = {}, {}, None
    for line in open(path, encoding="utf-8"):
        words = line.split()
        if line.startswith("BO_ "):
            name = words[2].rstrip(":")
            messages[name] = [int(words[1]), int(words[3]), {}, 0]
            numbers[words[1]] = name
        elif line.startswith(" SG_ "):
            place, order = words[3].split("@")
            start, count = map(int, place.split("|"))
            assert order[0] == "1", "Intel order only"
            factor, offset = (fractions.Fraction(v) for v in words[4].strip("()").split(","))
            low, high = (fractions.Fraction(v) for v in words[5].strip("[]").split("|"))
            messages[name][2][words[1]] = (range(start, start + count), order[1] == "-", factor, offset, low, high)
        elif line.startswith('BA_ "DataId" BO_ '):
            messages[numbers[words[3]]][3] = int(words[4].rstrip(";"))
    return messages


def raw_of(data, bits, signed):
    """Sum of the bits' weights; the highest of a signed number weighs negative."""
    total = 0
    for weight, bit in enumerate(bits):
        if data[bit // 8] & (1 << bit % 8):
            total += -(1 << weight) if signed and weight == len(bits) - 1 else 1 << weight
    return total


def remainder(data):
    """Of the bits of data, followed by eight zeros, divided by the polynomial."""
    number = int.from_bytes(data, "big") << 8
    for bit in range(number.bit_length() - 1, 7, -1):
        if number & (1 << bit):
            number ^= POLYNOMIAL << (bit - 8)
    return number


def check_line(messages, line):
    kind, name, number, extended, text, *fields = line.split()
    wanted, length, signals, data_id = messages[name]
    assert int(number) | (int(extended) << 31) == wanted, f"{name} has identifier {number}"
    data = bytes.fromhex(text)
    assert len(data) == length, f"{name} has {len(data)} bytes"
    assert {field.split("=")[0] for field in fields} == set(signals), f"signals of {name}"
    for field in fields:
        signal, told = field.split("=")
        bits, signed, factor, offset, low, high = signals[signal]
        raw = raw_of(data, bits, signed)
        value = raw * factor + offset
        if kind == "unpack":
            told_raw, told_value = told.split(",")
            assert int(told_raw) == raw, f"{name}.{signal}: {told_raw} was read from {text}, it is {raw}"
            assert abs(float(told_value) - float(value)) <= 1e-12 * max(1.0, abs(float(value))), f"{line}: {signal}"
        elif kind == "pack" or signal not in ("Crc", "Counter"):
            assert low <= value <= high, f"{name}.{signal} is {float(value)}"
            step = abs(fractions.Fraction(told) - value) / abs(factor)
            assert step <= fractions.Fraction(1, 2) + fractions.Fraction(1, 10**6), f"{name}.{signal}: {told} became {value}"
    if kind == "protected":
        counter = raw_of(data, signals["Counter"][0], False)
        assert counter < 15, f"{name}: counter {counter}"
        assert remainder(data_id.to_bytes(2, "little") + data[1:]) == data[0], f"{name}: checksum of {text}"
    return kind, name


def main():
    assert remainder(b"123456789") == 0x37
    messages = {}
    for path in sys.argv[2:]:
        messages.update(read_dbc(path))
    lines = subprocess.run([sys.argv[1]], check=True, capture_output=True, text=True).stdout.splitlines()
    seen = [check_line(messages, line) for line in lines]
    for name, message in messages.items():
        packed = "protected" if message[3] else "pack"
        assert seen.count((packed, name)) == 202 and seen.count(("unpack", name)) == 200, f"{name} is not all there"
    signals = sum(len(message[2]) for message in messages.values())
    print(f"{len(lines)} messages of {len(messages)} kinds with {signals} signals decoded alike")


if __name__ == "__main__":
    main()
