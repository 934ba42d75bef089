#!/usr/bin/env python3
"""dbcgen.py refuses what the codec cannot carry, by file, line and remedy: dbcgen_test.py DBCGEN ROOMCAL_DBC"""

import pathlib
import subprocess
import sys
import tempfile

DBCGEN, ROOMCAL = sys.argv[1:3]
GOOD = '''VERSION ""
BU_: A B
BO_ 100 M: 8 A
 SG_ X : 0|12@1- (0.5,0) [-1024|1023.5] "m" B
 SG_ Y : 12|8@1+ (1,0) [0|255] "" B
CM_ BO_ 100 "m";
CM_ SG_ 100 X "x";
CM_ SG_ 100 Y "y";
VAL_ 100 Y 0 "off" 1 "on" ;
'''
PROTECTED = GOOD + 'BA_ "DataId" BO_ 100 7;\n'

# what is replaced, by what, and a part of the line that the editor of the file then reads
BAD = [
    ("@1-", "@0-", "4: X is in Motorola byte order"),
    ("SG_ X :", "SG_ X m0 :", "4: X is multiplexed"),
    ("0|12@", "0|13@", "5: Y overlaps"),
    ("0|12@", "0|60@", "4: X: has 60 bits"),
    ("12|8@", "57|8@", "5: Y: does not fit into the 8 bytes of M"),
    ("(0.5,0)", "(0,0)", "4: X: a factor of 0"),
    ("[-1024|", "[-1025|", "4: X: 12 bits do not reach"),
    ("[0|255]", "[9|9]", "5: Y: its limits"),
    ("[0|255]", "[0|256]", "5: Y: 8 bits do not reach"),
    ("BO_ 100 M: 8", "BO_ 2048 M: 8", "there is no message 100"),
    ("BO_ 100 M: 8", "BO_ 100 M: 9", "3: M: 9 bytes is not a length"),
    ("BO_ 100 M: 8", "BO_ 100 M 8", "3: a message reads"),
    ('CM_ BO_ 100 "m";', "", "3: M: say what it is for"),
    ('CM_ SG_ 100 X "x";', "", "4: X: say what it means"),
    ('CM_ SG_ 100 X "x";', 'CM_ SG_ 100 Z "x";', "7: M has no signal Z"),
    ('"y"', '"y', "a text is not closed"),
    ('0 "off" 1 "on"', '0 "off" 0 "on"', "5: Y: its value table repeats"),
    ('0 "off"', '0 "Off state"', "lower case"),
    ('1 "on"', '256 "on"', "5: Y: value 256"),
    ('0 "off"', '0 off', "9: a value table reads"),
    ("SG_ Y :", "SG_ X :", "5: M has a signal X already"),
    (" [0|255]", "", "5: a signal reads"),
    ("VERSION", "RUBBISH", "1: not a statement"),
]


def run(text):
    with tempfile.TemporaryDirectory() as folder:
        source, target = pathlib.Path(folder, "x.dbc"), pathlib.Path(folder, "deep", "x.h")
        source.write_bytes(text if isinstance(text, bytes) else text.encode())
        result = subprocess.run([sys.executable, DBCGEN, source, target, "x"], capture_output=True, text=True)
        return result.returncode, result.stderr, target.read_text() if target.exists() else ""


def check_bad(text, part):
    code, said, header = run(text)
    assert code == 1 and part in said and said.count("\n") == 1 and not header, f"wanted {part!r}, got {code} {said!r}"


def main():
    code, said, header = run(GOOD)
    assert code == 0 and not said and "kOff = 0" in header, said
    assert header == run(GOOD)[2], "the same file gives the same header"
    assert run(GOOD.replace("\n", "\r\n"))[0] == 0, "Windows' line ends"
    for old, new, part in BAD:
        assert old in GOOD, old
        check_bad(GOOD.replace(old, new, 1), part)
    check_bad(PROTECTED, "M has a DataId, so E2E profile 11 wants Crc")
    check_bad("", "there is no message in it")
    check_bad(b"\xff\xfe", "cannot be read")
    text = pathlib.Path(ROOMCAL).read_text(encoding="utf-8")
    check_bad(text.replace('"DataId" BO_ 1681 29249', '"DataId" BO_ 1681 29248'), "two messages have one DataId")
    print(f"{len(BAD) + 4} files refused by file, line and remedy")


if __name__ == "__main__":
    main()
