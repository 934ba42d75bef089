#!/usr/bin/env python3
"""What others build and install roomcald by agrees with what it is: packages_test.py SOURCE ROOMCALD

Buildroot's and Yocto's recipes name CMake options, the service names options of the program, boards and paths; scripts
parse; systemd accepts the unit, and finds it well locked up.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

TOP, PROGRAM = pathlib.Path(sys.argv[1]), sys.argv[2]
EXPOSURE_BAR = 3.0  # of systemd-analyze security: 0 is locked up, 10 open; hardware access and capabilities cost


def run(*command):
    done = subprocess.run([str(w) for w in command], capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def cmake_options():
    names = {"ROOMCAL_SYSROOT"}  # toolchains/common.cmake reads it
    for file in [TOP / "CMakeLists.txt", *TOP.glob("toolchains/*.cmake"), *TOP.glob("drivers/**/CMakeLists.txt"),
                 *TOP.glob("board/CMakeLists.txt")]:
        names |= set(re.findall(r"(?:option|set)\((ROOMCAL_[A-Z0-9_]+) ", file.read_text()))
    return names


def test_recipes_name_real_options():
    known = cmake_options()
    for file in (TOP / "board/buildroot/package/roomcal/roomcal.mk",
                 next((TOP / "board/yocto").glob("recipes-*/roomcal/*.bb")), TOP / "CMakePresets.json"):
        used = set(re.findall(r'(?:-D|")(ROOMCAL_[A-Z0-9_]+)(?:=|":)', file.read_text()))
        assert used and used <= known, f"{file}: {used - known} are no options"


def test_versions_agree():
    version = re.search(r"project\(roomcal VERSION ([0-9.]+)", (TOP / "CMakeLists.txt").read_text()).group(1)
    assert f"ROOMCAL_VERSION = {version}\n" in (TOP / "board/buildroot/package/roomcal/roomcal.mk").read_text()
    assert (TOP / f"board/yocto/recipes-roomcal/roomcal/roomcal_{version}.bb").exists(), f"no recipe of {version}"


def test_yocto_license_sum():
    import hashlib
    wanted = hashlib.md5((TOP / "LICENSE").read_bytes()).hexdigest()
    assert wanted in next((TOP / "board/yocto").glob("recipes-*/roomcal/*.bb")).read_text(), wanted


def test_service_calls_the_program_right():
    unit = (TOP / "board/service/roomcald.service").read_text()
    script = (TOP / "board/service/roomcald.init").read_text()
    _, text = run(PROGRAM, "--help")
    options = set(re.findall(r"^  (--[a-z-]+)", text, re.M))
    for caller in (re.search(r"^ExecStart=(.*)$", unit, re.M).group(1), re.search(r"^ +\$program (.*)$", script, re.M).group(1)):
        assert set(re.findall(r"--[a-z-]+", caller)) <= options, caller
    board = re.search(r"^ROOMCAL_BOARD=(\w+)$", (TOP / "board/service/roomcald.default").read_text(), re.M).group(1)
    assert re.search(rf"^ +{board}: ", text, re.M), f"{board} is no product"


def test_scripts_parse():
    for script in (*TOP.glob("board/package/p*"), TOP / "board/service/roomcald.init", TOP / "board/firmware/rcS"):
        status, text = run("sh", "-n", script)
        assert status == 0, text


def test_systemd_accepts_the_unit():
    analyze = shutil.which("systemd-analyze")
    assert analyze, "systemd-analyze is missing (package systemd)"
    with tempfile.TemporaryDirectory() as folder:
        unit = pathlib.Path(folder) / "roomcald.service"
        text = (TOP / "board/service/roomcald.service").read_text()
        unit.write_text(text.replace("/usr/sbin/roomcald", PROGRAM))
        _, told = run(analyze, "verify", "--man=no", unit)
        ours = [line for line in told.splitlines() if "roomcald.service" in line]
        assert not ours, ours
        _, told = run(analyze, "security", "--offline=true", "--no-pager", unit)
        exposure = float(re.search(r"Overall exposure level for \S+: ([0-9.]+)", told).group(1))
        print(f"exposure {exposure} of 10, bar {EXPOSURE_BAR}")
        assert exposure <= EXPOSURE_BAR, told


def test_conffiles_are_installed():
    rules = (TOP / "board/package/install.cmake").read_text()
    for line in (TOP / "board/package/conffiles").read_text().split():
        path = pathlib.PurePath(line)
        assert f"DESTINATION {path.parent} RENAME {path.name}" in rules, f"{line} is installed by no rule"


if __name__ == "__main__":
    tests = [(name, test) for name, test in sorted(globals().items()) if name.startswith("test_")]
    for name, test in tests:
        test()
        print(f"{name}: ok")
