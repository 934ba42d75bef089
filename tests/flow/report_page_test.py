#!/usr/bin/env python3
"""The page of `roomcal report` in a real browser: it draws, turns, zooms, sorts, loads nothing and says nothing wrong.

usage: report_page_test.py ROOMCAL [FOLDER FOR SCREENSHOTS]; exit status 77, the reason on stdout: no Chromium here
"""

import json
import re

from page_case import EVIL, PageCase, main, run_tool

SENSORS = ["cam0", "cam1", "cam2", "cam3", "lidar0"]
VIEWS = "[...document.querySelectorAll('.view canvas')]"


def make_pages(folder):
    """A simulated robot's shot, its result, and pages of it: whole, of the result alone, of a refusal."""
    room, shot, result = folder / "room", folder / "shot", folder / "result.json"
    run_tool("simulate", "room", "-o", room, "--seed", 1)
    run_tool("simulate", "shot", "--room", room, "--device", "mobile_robot", "-o", shot, "--scale", 0.4, "--sweeps", 1)
    run_tool("map", "import", room / "markers.csv", "-o", folder / "a.room", "--id", EVIL)
    run_tool("import", "kalibr", shot / "camchain.yaml", "--nominal", shot / "nominal.json", "-o", folder / "device.yaml")
    run_tool("calibrate", "--map", folder / "a.room", "--device", folder / "device.yaml", "--shot", shot, "--detail",
             "--json", result, "--record", folder / "a.record")
    given = ["--shot", shot, "--map", folder / "a.room"]
    run_tool("report", result, *given, "--truth", shot / "truth.json", "--installed", folder / "a.record", "-o", folder / "whole.html")
    run_tool("report", folder / "a.record", "-o", folder / "record.html")
    (shot / "cam1.png").unlink()
    run_tool("calibrate", "--map", folder / "a.room", "--device", folder / "device.yaml", "--shot", shot, "--detail",
             "--json", folder / "refused.json", expected=2)
    run_tool("report", folder / "refused.json", *given, "-o", folder / "refused.html")
    return json.loads(result.read_text())


class ReportPage(PageCase):
    unchanged = None

    @classmethod
    def make_pages(cls):
        cls.result = make_pages(cls.folder)

    def open(self, name="whole.html", theme="light", width=1280, to_change=False):
        """Opens a page, or stays on it where nobody has changed it since."""
        page = (name, theme, width)
        if page == ReportPage.unchanged and not to_change:
            return
        ReportPage.unchanged = None if to_change else page
        self.browser.call("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
        self.show(name, theme)
        self.browser.wait("roomcal.pictureViews.every((view) => !view.image || view.ready)")
        self.browser.settle()

    def picture(self, selector):
        return self.browser.run(f"document.querySelector('{selector}').toDataURL()")

    def different_colours(self, selector):
        """How many colours a canvas shows: a blank one has one."""
        return self.browser.run(
            f"(() => {{ const c = document.querySelector('{selector}'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data,"
            " s = new Set(); for (let i = 0; i < d.length; i += 4) s.add(d[i] << 16 | d[i + 1] << 8 | d[i + 2]); return s.size; })()")

    def heading(self, text):
        return self.browser.run(f"[...document.querySelectorAll('h2')].some((h) => h.textContent === '{text}')")

    def test_it_is_one_page_below_ten_megabytes_and_loads_nothing(self):
        self.open(to_change=True)
        self.assertLess((self.folder / "whole.html").stat().st_size, 10_000_000)
        requests = self.browser.requests()
        self.assertEqual([url for url in requests if not url.startswith(("file:", "data:"))], [])
        self.assertEqual(len([url for url in requests if url.startswith("file:")]), 1)

    def test_verdict_and_numbers_are_the_results(self):
        self.open()
        self.assertEqual(self.browser.run("document.querySelector('.verdict .word').textContent"), "✓PASS")
        rows = self.browser.run("[...roomcal.table.body.rows].map((r) => [...r.cells].map((c) => c.textContent.replaceAll('−', '-')))")
        self.assertEqual([row[0] for row in rows], SENSORS)
        heads = self.browser.run("roomcal.table.heads.map((h) => h.textContent)")
        for row in rows:
            told = self.result["sensors"][row[0]]
            for k, axis in enumerate("xyz"):
                self.assertAlmostEqual(float(row[heads.index(f"{axis} mm")]), 1e3 * told["T_rig_sensor"][k][3], delta=0.0051)
        self.assertEqual(self.browser.run("document.querySelectorAll('h1 b, header p b').length"), 0)  # a name is text
        self.assertIn(EVIL, self.browser.run("document.querySelector('header p').textContent"))

    def test_every_part_is_there(self):
        self.open()
        for title in ("In the room", "Images", "Residuals", "Sensors", "Beside the truth", "Installed against this shot",
                      "Pairs", "Covariance", "Beam offsets", "Time"):
            self.assertTrue(self.heading(title), title)

    def test_the_room_shows_markers_sensors_and_sweep(self):
        self.open()
        kinds = self.browser.run("roomcal.scene.things.map((t) => t.kind)")
        self.assertEqual(kinds.count("disc"), 340)
        self.assertEqual(kinds.count("cloud"), 1)
        self.assertEqual(kinds.count("label"), len(SENSORS))
        self.assertGreater(self.different_colours(".view canvas"), 20)

    def test_the_device_shows_how_far_each_sensor_may_be_off(self):
        self.open(to_change=True)
        groups = self.browser.run("roomcal.scenes[1].things.filter((t) => t.layer === 'ellipsoids').length")
        self.assertEqual(groups, len(SENSORS) - 1)  # the reference is where it is by definition
        self.assertGreater(self.different_colours(".view.device canvas"), 20)
        before = self.picture(".view.device canvas")
        self.browser.run("document.querySelector('.view.device input').click()")
        self.browser.settle()
        self.assertNotEqual(self.picture(".view.device canvas"), before)

    def test_an_ellipsoid_has_the_axes_of_its_covariance(self):
        self.open()
        for name in SENSORS[1:]:
            axes = self.browser.run(f"positionAxes(sensorOf.get('{name}')).map((a) => [a.sigma, ...a.vector])")
            told = self.result["sensors"][name]
            turn = [row[:3] for row in told["T_room_sensor"][:3]]
            for j in range(3):
                for k in range(3):
                    built = sum(a[0] ** 2 * a[1 + j] * a[1 + k] for a in axes)
                    expected = sum(turn[j][m] * told["covariance"][m][n] * turn[k][n] for m in range(3) for n in range(3))
                    self.assertAlmostEqual(built / axes[0][0] ** 2, expected / axes[0][0] ** 2, places=6)

    def test_a_picture_shows_image_rings_and_residuals(self):
        self.open(to_change=True)
        self.assertGreater(self.different_colours(".picture canvas"), 100)
        for name in ("Rings", "Residuals", "LiDAR points", "Marker ids"):
            before = self.picture(".picture canvas")
            self.browser.run(f"[...document.querySelectorAll('.bar-tools label')].find((l) => l.textContent === '{name}').click()")
            self.browser.settle()
            self.assertNotEqual(self.picture(".picture canvas"), before, name)

    def test_a_picture_opens_zooms_and_closes(self):
        self.open(to_change=True)
        self.browser.run("document.querySelector('.picture').click()")
        self.browser.settle()
        view = "roomcal.pictureViews[roomcal.pictureViews.length - 1]"
        self.browser.mouse("mouseWheel", 640, 450, deltaX=0, deltaY=-120)
        self.browser.settle()
        self.assertGreater(self.browser.run(f"{view}.zoom"), 1.2)
        self.browser.run("document.querySelector('.lightbox .close').click()")
        self.browser.wait("document.querySelector('dialog') === null")
        self.assertEqual(self.browser.run("roomcal.pictureViews.length"), 4)

    def test_drag_turns_the_room_and_wheel_zooms(self):
        self.open(to_change=True)
        box = self.browser.run("(() => { const b = document.querySelector('.view canvas').getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; })()")
        camera = "(({ yaw, pitch, distance }) => ({ yaw, pitch, distance }))(roomcal.scene.camera)"
        before, picture = self.browser.run(camera), self.picture(".view canvas")
        self.browser.drag(box, (box[0] + 120, box[1] + 40))
        after = self.browser.run(camera)
        self.assertGreater(abs(after["yaw"] - before["yaw"]), 0.3)
        self.assertNotEqual(self.picture(".view canvas"), picture)
        self.browser.mouse("mouseWheel", *box, deltaX=0, deltaY=-120)
        self.browser.settle()
        self.assertLess(self.browser.run(camera)["distance"], after["distance"])

    def test_the_table_sorts_and_choosing_a_sensor_shows_it(self):
        self.open(to_change=True)
        sigma = self.browser.run("roomcal.table.heads.map((h) => h.textContent)").index("σ mm")
        for sign in (1, -1):
            self.browser.run(f"roomcal.table.heads[{sigma}].firstChild.click()")
            values = self.browser.run(f"[...roomcal.table.body.rows].map((r) => Number(r.cells[{sigma}].textContent)).filter((v) => v > 0)")
            self.assertEqual(values, sorted(values, key=lambda v: sign * v))
        picture = self.picture(".view canvas")
        self.browser.run("roomcal.table.lines.get('cam2').click()")
        self.browser.settle()
        self.assertEqual(self.browser.run("document.querySelector('.chips [aria-pressed=true]').textContent"), "cam2")
        self.assertNotEqual(self.picture(".view canvas"), picture)

    def test_both_themes_and_a_telephone_are_legible(self):
        backgrounds = set()
        for theme, width in (("light", 1280), ("dark", 1280), ("light", 390), ("dark", 390)):
            self.open(theme=theme, width=width)
            self.assertLessEqual(self.browser.run("document.documentElement.scrollWidth"), width)
            backgrounds.add(self.browser.run("getComputedStyle(document.documentElement).backgroundColor"))
            self.assertGreater(self.different_colours(".view canvas"), 20)
            self.keep(f"{theme}_{width}.png")
        self.assertEqual(len(backgrounds), 2)

    def test_a_record_alone_makes_a_page_that_says_what_is_missing(self):
        self.open("record.html")
        self.assertEqual(self.browser.run("roomcal.table.body.rows.length"), len(SENSORS))
        self.assertIn("`--shot` brings them", self.browser.run("document.querySelector('footer').textContent"))
        self.assertTrue(self.heading("Sensors"))

    def test_a_refusal_says_why(self):
        self.open("refused.html")
        self.assertRegex(self.browser.run("document.querySelector('.verdict .word').textContent"), "FAIL")
        reasons = json.loads((self.folder / "refused.json").read_text())["reasons"]
        self.assertEqual(self.browser.run("[...document.querySelectorAll('.verdict li')].map((l) => l.textContent)"), reasons)
        self.assertTrue(any(re.search("cam1", reason) for reason in reasons))


if __name__ == "__main__":
    main()
