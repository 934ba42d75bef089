#!/usr/bin/env python3
"""Makes the C++ tables of a DBC file: dbcgen.py INPUT.dbc OUTPUT.h NAMESPACE

The DBC file is the only source: names, bits, units, limits, value tables and comments all come from it. Whatever our codec
cannot carry is refused with file, line and remedy: Motorola byte order, multiplexed signals, more than 52 bits (a double
holds every value of fewer), signals that overlap or leave their message, messages and signals without a comment.
"""

import dataclasses
import pathlib
import re
import sys

MAX_BITS = 52
LENGTHS = (*range(1, 9), 12, 16, 20, 24, 32, 48, 64)
EXTENDED = 1 << 31
NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
LABEL = re.compile(r"[a-z][a-z0-9_]*")
IGNORED = ("VERSION", "NS_", "BS_", "BU_", "BA_DEF_", "BA_DEF_DEF_")
# At the start of a line, signals one blank in: indented by a tab, the same words are the list of NS_.
STARTS = re.compile(r"^ ?(VERSION|NS_|BS_|BU_|BO_|SG_|CM_|VAL_|BA_DEF_DEF_|BA_DEF_|BA_)(?=[ :;]|$)")


class DbcError(Exception):
    """One line for the person who edits the file."""


@dataclasses.dataclass
class Signal:
    name: str
    line: int
    start: int
    bits: int
    signed: bool
    factor: float
    offset: float
    minimum: float
    maximum: float
    unit: str
    comment: str = ""
    labels: list = dataclasses.field(default_factory=list)

    def raw_limits(self):
        if self.signed:
            return -(1 << (self.bits - 1)), (1 << (self.bits - 1)) - 1
        return 0, (1 << self.bits) - 1


@dataclasses.dataclass
class Message:
    name: str
    line: int
    number: int
    length: int
    signals: list = dataclasses.field(default_factory=list)
    comment: str = ""
    cycle_ms: int = 0
    data_id: int = 0

    def signal(self, name: str, line: int):
        for signal in self.signals:
            if signal.name == name:
                return signal
        raise DbcError(f"{line}: {self.name} has no signal {name}")


def statements(text: str):
    """(line, statement) of everything that begins with a keyword; a statement runs until the next one, texts included."""
    current, started, in_text = "", 0, False
    for number, line in enumerate(text.splitlines(), 1):
        if not in_text and STARTS.match(line):
            if current:
                yield started, current.strip()
            current, started = "", number
        if not current.strip():
            current, started = "", number
        current += line + "\n"
        in_text ^= line.count('"') % 2 == 1
    if in_text:
        raise DbcError(f"{started}: a text is not closed; put a double quote at its end")
    if current.strip():
        yield started, current.strip()


class Parser:
    """Statement by statement into messages, in the order of the file."""

    def __init__(self):
        self.messages = {}
        self.last = None

    def parse(self, text: str):
        for line, statement in statements(text):
            keyword = STARTS.match(statement)
            if not keyword:
                raise DbcError(f"{line}: not a statement of a DBC file: {statement.splitlines()[0][:60]!r}")
            handler = getattr(self, "take_" + keyword.group(1).lower().strip("_"), None)
            if handler:
                handler(line, statement)
            elif keyword.group(1) not in IGNORED:
                raise DbcError(f"{line}: {keyword.group(1)} is not understood")
        return list(self.messages.values())

    def take_bo(self, line, statement):
        match = re.fullmatch(r"BO_ (\d+) (\w+) *: *(\d+) \w+", statement)
        if not match:
            raise DbcError(f"{line}: a message reads BO_ NUMBER NAME: LENGTH SENDER")
        message = Message(match.group(2), line, int(match.group(1)), int(match.group(3)))
        if message.number in self.messages:
            raise DbcError(f"{line}: message {message.number} is there twice")
        if message.name in {other.name for other in self.messages.values()}:
            raise DbcError(f"{line}: a message {message.name} is there already")
        self.messages[message.number] = self.last = message

    def take_sg(self, line, statement):
        number = r"([-+0-9.eE]+)"
        match = re.fullmatch(rf"SG_ (\w+)( \w+)? : (\d+)\|(\d+)@([01])([-+]) \({number},{number}\) "
                             rf'\[{number}\|{number}\] "([^"]*)" [\w,]+', statement)
        if not match or self.last is None:
            raise DbcError(f"{line}: a signal reads  SG_ NAME : START|BITS@1+ (FACTOR,OFFSET) [MIN|MAX] \"UNIT\" RECEIVERS, "
                           "below its message")
        if match.group(2):
            raise DbcError(f"{line}: {match.group(1)} is multiplexed, which we do not carry; make two messages")
        if match.group(5) != "1":
            raise DbcError(f"{line}: {match.group(1)} is in Motorola byte order (@0); write it in Intel order (@1)")
        if any(signal.name == match.group(1) for signal in self.last.signals):
            raise DbcError(f"{line}: {self.last.name} has a signal {match.group(1)} already")
        values = [float(match.group(i)) for i in (7, 8, 9, 10)]
        self.last.signals.append(Signal(match.group(1), line, int(match.group(3)), int(match.group(4)),
                                        match.group(6) == "-", *values, match.group(11)))

    def take_cm(self, line, statement):
        match = re.fullmatch(r'CM_ (?:(BO_|SG_) (\d+) (\w+)?\s*|BU_ \w+ )?"([^"]*)"\s*;', statement)
        if not match:
            raise DbcError(f'{line}: a comment reads CM_ BO_ NUMBER "TEXT"; or CM_ SG_ NUMBER NAME "TEXT";')
        text = " ".join(match.group(4).split())
        if match.group(1) == "BO_":
            self.message(match.group(2), line).comment = text
        elif match.group(1) == "SG_":
            self.message(match.group(2), line).signal(match.group(3), line).comment = text

    def take_val(self, line, statement):
        match = re.fullmatch(r'VAL_ (\d+) (\w+)((?: -?\d+ "[^"]*")+) ?;', statement)
        if not match:
            raise DbcError(f'{line}: a value table reads VAL_ NUMBER NAME 0 "label" 1 "label" ;')
        signal = self.message(match.group(1), line).signal(match.group(2), line)
        signal.labels = [(int(raw), label) for raw, label in re.findall(r'(-?\d+) "([^"]*)"', match.group(3))]

    def take_ba(self, line, statement):
        match = re.fullmatch(r'BA_ "(\w+)" BO_ (\d+) (\d+) ?;', statement)
        if not match:
            return  # of the network or of nodes: nothing that the tables hold
        message = self.message(match.group(2), line)
        if match.group(1) == "GenMsgCycleTime":
            message.cycle_ms = int(match.group(3))
        elif match.group(1) == "DataId":
            message.data_id = int(match.group(3))

    def message(self, number, line):
        if int(number) not in self.messages:
            raise DbcError(f"{line}: there is no message {number}")
        return self.messages[int(number)]


def check(messages):
    if not messages:
        raise DbcError("1: there is no message in it")
    for message in messages:
        check_message(message)
    ids = [message.data_id for message in messages if message.data_id]
    if len(ids) != len(set(ids)):
        raise DbcError("1: two messages have one DataId; a checksum would not tell them apart")


def check_message(message):
    where = f"{message.line}: {message.name}"
    number = message.number & ~EXTENDED
    if number >= (1 << 29 if message.number & EXTENDED else 1 << 11):
        raise DbcError(f"{where}: {number} is no identifier; 29 bits need bit 31 set")
    if message.length not in LENGTHS:
        raise DbcError(f"{where}: {message.length} bytes is not a length of CAN or CAN FD")
    if not message.comment:
        raise DbcError(f"{where}: say what it is for, with CM_ BO_")
    taken = 0
    for signal in message.signals:
        check_signal(message, signal)
        bits = ((1 << signal.bits) - 1) << signal.start
        if taken & bits:
            raise DbcError(f"{signal.line}: {signal.name} overlaps another signal of {message.name}")
        taken |= bits
    if message.data_id:
        check_protection(message)


def check_signal(message, signal):
    where = f"{signal.line}: {signal.name}"
    if not 1 <= signal.bits <= MAX_BITS:
        raise DbcError(f"{where}: has {signal.bits} bits; 1 to {MAX_BITS} are carried")
    if signal.start + signal.bits > 8 * message.length:
        raise DbcError(f"{where}: does not fit into the {message.length} bytes of {message.name}")
    if signal.factor == 0:
        raise DbcError(f"{where}: a factor of 0 carries nothing")
    if signal.minimum >= signal.maximum:
        raise DbcError(f"{where}: its limits [{signal.minimum}|{signal.maximum}] leave no room")
    raw = sorted(round((value - signal.offset) / signal.factor) for value in (signal.minimum, signal.maximum))
    low, high = signal.raw_limits()
    if raw[0] < low or raw[1] > high:
        raise DbcError(f"{where}: {signal.bits} bits do not reach its limits [{signal.minimum}|{signal.maximum}]")
    if not signal.comment and signal.name not in ("Crc", "Counter"):
        raise DbcError(f"{where}: say what it means, with CM_ SG_")
    for value, label in signal.labels:
        if not low <= value <= high:
            raise DbcError(f"{where}: value {value} of its table is beyond its bits")
        if not LABEL.fullmatch(label):
            raise DbcError(f"{where}: label {label!r} must be lower case, digits and _")
    if len({label for _, label in signal.labels}) != len(signal.labels) or len(dict(signal.labels)) != len(signal.labels):
        raise DbcError(f"{where}: its value table repeats a value or a label")


def check_protection(message):
    places = {signal.name: (signal.start, signal.bits) for signal in message.signals}
    if places.get("Crc") != (0, 8) or places.get("Counter") != (8, 4):
        raise DbcError(f"{message.line}: {message.name} has a DataId, so E2E profile 11 wants Crc : 0|8 and Counter : 8|4")


def camel(label):
    return "k" + "".join(part.capitalize() for part in label.split("_"))


def real(value):
    return repr(int(value)) if value == int(value) and abs(value) < 1 << 53 else repr(value)


def wrapped(text, indent):
    lines, line = [], indent + "///"
    for word in text.split():
        if len(line) + 1 + len(word) > 120:
            lines.append(line)
            line = indent + "///"
        line += " " + word
    return lines + [line]


def emit_signal(signal, index):
    lines = wrapped(f"{signal.comment or 'of the protection'} [{signal.unit}]" if signal.unit else
                    signal.comment or "Of the protection.", "")
    lines.append(f"inline constexpr const Signal& k{signal.name} = kSignals[{index}];")
    if signal.labels:
        kind = "int64_t" if signal.raw_limits()[0] < 0 else "uint32_t" if signal.bits > 8 else "uint8_t"
        lines.append(f"enum class {signal.name} : {kind} {{")
        lines += [f"  {camel(label)} = {value}," for value, label in signal.labels]
        lines.append("};")
    return lines


def emit_message(message):
    lines = ["", *wrapped(message.comment, ""), f"namespace {message.name.lower()} {{"]
    for signal in message.signals:
        if signal.labels:
            entries = ", ".join(f'{{{value}, "{label}"}}' for value, label in signal.labels)
            lines.append(f"inline constexpr std::array<Label, {len(signal.labels)}> k{signal.name}Labels{{{{{entries}}}}};")
    lines.append(f"inline constexpr std::array<Signal, {len(message.signals)}> kSignals{{{{")
    for signal in message.signals:
        labels = f"k{signal.name}Labels" if signal.labels else "{}"
        numbers = ", ".join(real(v) for v in (signal.factor, signal.offset, signal.minimum, signal.maximum))
        lines.append(f'    {{"{signal.name}", {signal.start}, {signal.bits}, {str(signal.signed).lower()}, {numbers}, '
                     f'"{signal.unit}", {labels}}},')
    lines.append("}};")
    extended = bool(message.number & EXTENDED)
    lines.append(f'inline constexpr MessageLayout kLayout{{"{message.name}", {message.number & ~EXTENDED:#x}, '
                 f"{str(extended).lower()}, {message.length}, {message.data_id:#x}, {message.cycle_ms}, kSignals}};")
    for index, signal in enumerate(message.signals):
        lines += emit_signal(signal, index)
    lines.append(f"}}  // namespace {message.name.lower()}")
    return lines


def emit(messages, namespace, source):
    lines = [f"// Made from {source} by dbcgen.py; edit that file.", "#pragma once", "", "#include <array>",
             "#include <cstdint>", "", '#include "drivers/can/signal.h"', "",
             f"namespace roomcal::drivers::{namespace} {{"]
    for message in messages:
        lines += emit_message(message)
    lines += ["", f"inline constexpr std::array<const MessageLayout*, {len(messages)}> kMessages{{"]
    lines += [f"    &{message.name.lower()}::kLayout," for message in messages]
    lines += ["};", "", f"}}  // namespace roomcal::drivers::{namespace}", ""]
    return "\n".join(lines)


def main(arguments):
    if len(arguments) != 3 or not NAME.fullmatch(arguments[2]):
        print("usage: dbcgen.py INPUT.dbc OUTPUT.h NAMESPACE", file=sys.stderr)
        return 1
    source, target, namespace = pathlib.Path(arguments[0]), pathlib.Path(arguments[1]), arguments[2]
    try:
        messages = Parser().parse(source.read_text(encoding="utf-8"))
        check(messages)
    except DbcError as error:
        print(f"{source}:{error}", file=sys.stderr)
        return 1
    except (OSError, UnicodeDecodeError) as error:
        print(f"{source}: cannot be read: {error}", file=sys.stderr)
        return 1
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(emit(messages, namespace, source.name), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
