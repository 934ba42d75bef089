"""What the tests of pages share: the program that makes them, a browser, and a place to keep pictures of them."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

from browser import Browser, find_chromium

ROOMCAL = pathlib.Path(sys.argv[1])
PICTURES = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
EVIL = "lab </script><b>x</b> {{data}}"  # a name that breaks a page which does not escape it


def run_tool(*arguments, expected=0):
    done = subprocess.run([str(ROOMCAL), *map(str, arguments)], capture_output=True, text=True, timeout=300, check=False)
    if done.returncode != expected:
        raise AssertionError(f"{arguments}: exit {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout + done.stderr


class PageCase(unittest.TestCase):
    """One folder and one browser for all tests of a class; a page that complains fails its test."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.make_pages()
        cls.browser = Browser()

    @classmethod
    def make_pages(cls):
        raise NotImplementedError

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        cls.temporary.cleanup()

    def tearDown(self):
        self.assertEqual(self.browser.complaints(), [])

    def show(self, name, theme):
        self.browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])
        self.browser.open((self.folder / name).as_uri())
        self.browser.wait("window.roomcal !== undefined")

    def keep(self, name):
        if PICTURES:
            PICTURES.mkdir(parents=True, exist_ok=True)
            (PICTURES / name).write_bytes(self.browser.screenshot())


def main():
    if find_chromium() is None:
        print("skipped: no Chromium; install it with tools/setup --tests")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0]], verbosity=2)
