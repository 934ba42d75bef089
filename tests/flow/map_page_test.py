#!/usr/bin/env python3
"""The page of `roomcal map info --report` in a real browser: it draws, turns, zooms, sorts, and says nothing wrong.

usage: map_page_test.py ROOMCAL [FOLDER FOR SCREENSHOTS]; exit status 77, the reason on stdout: no Chromium here
"""

import json

from page_case import EVIL, PageCase, main, run_tool

COUNT = 60


def markers_csv():
    """Floor and two walls of a 3 x 3 x 3 m room; an irregular pattern without chance."""
    lines = ["id,x,y,z,nx,ny,nz,radius"]
    for i in range(COUNT):
        u, v = 0.3 + 2.4 * (i * 0.618 % 1), 0.3 + 2.4 * (i * 0.377 % 1)
        place, normal = ([(u, v, 0), (0, u, v), (u, 0, v)][i % 3], [(0, 0, 1), (1, 0, 0), (0, 1, 0)][i % 3])
        lines.append(",".join(map(str, (i, *place, *normal, 0.085))))
    return "\n".join(lines) + "\n"


def bake_json():
    """What a bake says beside the map; marker 17 is the worst."""
    return {"marker": [{"id": i, "expected_mm": 1 + i / 100, "held_out_mm": 9.0 if i == 17 else 1 + (i * 7 % COUNT) / 100,
                        "rms_px": 0.1, "sightings": 10 + i % 5, "views": 5} for i in range(COUNT)],
            "path": [{"name": f"frame{i}", "at": [1 + 0.1 * i, 1, 1.5]} for i in range(10)],
            "structure": {"lines": [{"from": [0, 0, 0], "to": [0, 0, 3]}], "corners": [{"at": [0, 0, 0]}]},
            "error_mm": {"expected_rms": 1.0, "held_out_rms": 1.2}, "reprojection": {"median_px": [0.1, 0.12]}}


class MapPage(PageCase):
    @classmethod
    def make_pages(cls):
        csv, room, bake = (cls.folder / n for n in ("m.csv", "m.room", "bake.json"))
        csv.write_text(markers_csv())
        bake.write_text(json.dumps(bake_json()))
        run_tool("map", "import", csv, "-o", room, "--sigma", "0.002", "--id", EVIL)
        run_tool("map", "info", room, "--report", cls.folder / "map.html")
        run_tool("map", "info", room, "--report", cls.folder / "bake.html", "--bake-json", bake)

    def open(self, name="bake.html"):
        self.show(name, "light")
        self.browser.settle()
        box = self.browser.run("(() => { const b = document.querySelector('canvas').getBoundingClientRect();"
                               " return [b.x, b.y, b.width, b.height]; })()")
        self.middle = (box[0] + box[2] / 2, box[1] + box[3] / 2)

    def camera(self):
        return self.browser.run("(({ yaw, pitch, distance, centre }) => ({ yaw, pitch, distance, centre }))(roomcal.scene.camera)")

    def picture(self):
        return self.browser.run("document.querySelector('canvas').toDataURL()")

    def column(self, index):
        return self.browser.run(f"[...roomcal.table.body.rows].map((r) => Number(r.cells[{index}].textContent))")

    def test_it_is_one_small_page_and_loads_nothing(self):
        self.open()
        self.assertLess((self.folder / "bake.html").stat().st_size, 2_000_000)
        self.assertEqual([url for url in self.browser.requests() if not url.startswith(("file:", "data:"))], [])
        self.assertEqual(len([url for url in self.browser.requests() if url.startswith("file:")]), 1)

    def test_names_are_shown_as_text(self):
        self.open()
        self.assertEqual(self.browser.run("document.querySelector('h1').textContent"), f"Room map {EVIL}")
        self.assertEqual(self.browser.run("document.title"), f"Room map {EVIL}")
        self.assertEqual(self.browser.run("document.querySelectorAll('h1 b').length"), 0)

    def test_every_marker_is_drawn_and_listed(self):
        for name in ("map.html", "bake.html"):
            self.open(name)
            self.assertEqual(self.browser.run("roomcal.scene.things.filter((t) => t.kind === 'disc').length"), COUNT)
            self.assertEqual(self.browser.run("roomcal.table.body.rows.length"), COUNT)
            self.assertGreater(self.browser.run("roomcal.scene.targets.length"), COUNT / 2)

    def test_drag_turns_and_the_picture_follows(self):
        self.open()
        camera, picture = self.camera(), self.picture()
        x, y = self.middle
        self.browser.drag((x, y), (x + 120, y + 40))
        after = self.camera()
        self.assertGreater(abs(after["yaw"] - camera["yaw"]), 0.3)
        self.assertGreater(abs(after["pitch"] - camera["pitch"]), 0.1)
        self.assertEqual(after["distance"], camera["distance"])
        self.assertNotEqual(self.picture(), picture)

    def test_shift_drag_moves_and_the_button_brings_back(self):
        self.open()
        camera, picture, (x, y) = self.camera(), self.picture(), self.middle
        self.browser.drag((x, y), (x + 80, y), modifiers=8)
        self.assertEqual(self.camera()["yaw"], camera["yaw"])
        self.assertNotEqual(self.camera()["centre"], camera["centre"])
        self.browser.run("[...document.querySelectorAll('.tools button')].find((b) => b.textContent === 'Whole room').click()")
        self.browser.settle()
        self.assertEqual(self.camera(), camera)
        self.browser.mouse("mouseMoved", 5, 5)
        self.assertEqual(self.picture(), picture)

    def test_wheel_keys_and_fingers(self):
        self.open()
        camera, (x, y) = self.camera(), self.middle
        self.browser.mouse("mouseWheel", x, y, deltaX=0, deltaY=-120)
        self.browser.settle()
        self.assertLess(self.camera()["distance"], camera["distance"])
        self.browser.run("document.querySelector('canvas').focus()")
        self.browser.key("ArrowLeft")
        self.assertLess(self.camera()["yaw"], camera["yaw"])
        self.browser.key("Home")
        self.assertEqual(self.camera(), camera)
        self.browser.touch("touchStart", [(x - 40, y), (x + 40, y)])
        for spread in (60, 80, 100):
            self.browser.touch("touchMove", [(x - spread, y), (x + spread, y)])
        self.browser.touch("touchEnd", [])
        self.browser.settle()
        self.assertLess(self.camera()["distance"], 0.8 * camera["distance"])

    def test_layers_can_be_hidden(self):
        self.open()
        for name in ("Planes", "Normals", "Survey path", "Edges, corners", "Sample looks", "1 m grid"):
            before = self.picture()
            self.browser.run(f"[...document.querySelectorAll('.tools label')].find((l) => l.textContent === '{name}').click()")
            self.browser.settle()
            self.assertNotEqual(self.picture(), before, name)

    def test_table_sorts_both_ways(self):
        self.open()
        self.assertEqual(self.column(0), list(range(COUNT)))
        heads = self.browser.run("roomcal.table.heads.map((h) => h.textContent)")
        held_out = heads.index("held out mm")
        self.browser.run(f"roomcal.table.heads[{held_out}].firstChild.click()")
        values = self.column(held_out)
        self.assertEqual(values, sorted(values))
        self.browser.run(f"roomcal.table.heads[{held_out}].firstChild.click()")
        self.assertEqual(self.column(held_out), values[::-1])
        self.assertEqual(self.column(0)[0], 17)
        self.assertEqual(self.browser.run(f"roomcal.table.heads[{held_out}].getAttribute('aria-sort')"), "descending")

    def test_a_click_on_a_marker_finds_its_line_and_back(self):
        self.open()
        target = self.browser.run("(() => { const t = [...roomcal.scene.targets].filter((t) => t.thing.key !== undefined)"
                                  ".sort((a, b) => a.depth - b.depth)[0], b = document.querySelector('canvas').getBoundingClientRect();"
                                  " return [t.x + b.x, t.y + b.y, t.thing.key]; })()")
        self.browser.click(*target[:2])
        self.assertEqual(self.browser.run("roomcal.scene.chosen"), target[2])
        self.assertEqual(self.browser.run("Number(document.querySelector('tr.chosen').cells[0].textContent)"), target[2])
        self.browser.run("roomcal.table.lines.get(3).click()")
        self.assertEqual(self.browser.run("roomcal.scene.chosen"), 3)

    def test_colours_follow_the_choice_and_the_theme(self):
        self.open()
        light, background = self.picture(), self.browser.run("getComputedStyle(document.documentElement).backgroundColor")
        self.keep("light.png")
        names = self.browser.run("[...document.getElementById('scale').options].map((o) => o.textContent)")
        self.assertEqual(names, [f"Colour: {n}" for n in ("uncertainty", "held-out error", "residual", "sightings", "plane")])
        self.assertIn("9.00 mm", self.browser.run("document.querySelector('.legend').textContent"))  # sigma is one for all
        self.browser.run("(() => { const s = document.getElementById('scale'); s.value = 4; s.dispatchEvent(new Event('change')); })()")
        self.browser.settle()
        self.assertIn("plane 2: 20 markers", self.browser.run("document.querySelector('.legend').textContent"))
        self.assertNotEqual(self.picture(), light)
        self.browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
        self.browser.settle()
        self.keep("dark.png")
        self.assertNotEqual(self.browser.run("getComputedStyle(document.documentElement).backgroundColor"), background)

    def test_the_button_changes_the_theme_and_the_canvas(self):
        self.open()
        background = "getComputedStyle(document.documentElement).backgroundColor"
        light, picture = self.browser.run(background), self.picture()
        self.browser.run("document.querySelector('.theme').click()")
        self.browser.settle()
        self.assertNotEqual(self.browser.run(background), light)
        self.assertNotEqual(self.picture(), picture)
        self.assertEqual(self.browser.run("document.querySelector('.theme').textContent"), "Light")
        self.browser.run("document.querySelector('.theme').click()")
        self.assertEqual(self.browser.run(background), light)

    def test_bake_json_of_another_map_is_refused(self):
        other = self.folder / "other.json"
        for text, word in ((json.dumps({"marker": [{"id": 900}]}), "not those of the map"), ("{}", "no list `marker`"), ("{", "not JSON")):
            other.write_text(text)
            said = run_tool("map", "info", self.folder / "m.room", "--report", self.folder / "no.html", "--bake-json", other, expected=1)
            self.assertIn(word, said)
        self.assertFalse((self.folder / "no.html").exists())

    def test_report_that_cannot_be_written_is_named(self):
        said = run_tool("map", "info", self.folder / "m.room", "--report", "/proc/nowhere/x.html", expected=1)
        self.assertIn("/proc/nowhere/x.html", said)


if __name__ == "__main__":
    main()
