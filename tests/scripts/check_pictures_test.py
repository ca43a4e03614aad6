#!/usr/bin/env python3
"""scripts/check_pictures.py in a small repository of its own."""

import pathlib
import struct
import subprocess
import tempfile
import unittest
import zlib

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/check_pictures.py"
DEBIAN = pathlib.Path("/usr/bin/python3")  # the one that has the packages
HAS_PACKAGES = DEBIAN.exists() and subprocess.run(
    [DEBIAN, "-c", "import numpy, PIL"], capture_output=True, check=False).returncode == 0


def png(changed=0, by=100, width=400):
    """A grey picture, of which so many pixels are brighter."""
    rows = b"".join(b"\0" + bytes(100 + (by if width * y + x < changed else 0)
                                  for x in range(width)) for y in range(300))

    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data
                + struct.pack(">I", zlib.crc32(kind + data)))
    header = struct.pack(">IIBBBBB", width, 300, 8, 0, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


@unittest.skipUnless(HAS_PACKAGES, "no numpy or Pillow")
class CheckPictures(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "docs/images").mkdir(parents=True)
        self.picture = self.root / "docs/images/a.png"
        self.picture.write_bytes(png())
        (self.root / "made.png").write_bytes(png())
        self.page(f"made by: cp {self.root}/made.png a.png")

    def page(self, comment):
        (self.root / "README.md").write_text(
            f"Text\n\n<!-- {comment} -->\n![A](docs/images/a.png)\n")

    def check(self, *options):
        done = subprocess.run([SCRIPT, f"--root={self.root}", *options],
                              capture_output=True, text=True, check=False)
        self.output = done.stdout + done.stderr
        return done.returncode == 0

    def test_a_picture_is_what_its_command_makes(self):
        self.assertTrue(self.check(), self.output)
        (self.root / "made.png").write_bytes(png(changed=1))  # an edge of a letter
        self.assertTrue(self.check(), self.output)
        (self.root / "made.png").write_bytes(png(changed=10000, by=10))  # rounding
        self.assertTrue(self.check(), self.output)
        (self.root / "made.png").write_bytes(png(changed=20))  # a digit
        self.assertFalse(self.check())
        self.assertIn("a.png is not what", self.output)
        (self.root / "made.png").write_bytes(png(width=401))
        self.assertFalse(self.check())
        self.assertIn("401 by 300 pixels instead of 400 by 300", self.output)

    def test_makes_it_again(self):
        (self.root / "made.png").write_bytes(png(changed=20))
        self.assertTrue(self.check("--make", "another.png"), self.output)
        self.assertFalse(self.check())
        self.assertTrue(self.check("--make", "a.png"), self.output)
        self.assertTrue(self.check(), self.output)

    def test_a_command_that_fails(self):
        for command in ("false", "true", f"cp {self.root}/made.png b.png"):
            self.page(f"made by: {command}")
            self.assertFalse(self.check())
            self.assertIn("makes no a.png", self.output)

    def test_what_takes_long_is_made_nightly(self):
        self.page("made nightly by: false")
        self.assertTrue(self.check("--quick"), self.output)
        self.assertFalse(self.check())

    def test_a_page_of_several_pictures(self):
        (self.root / "docs/images/b.png").write_bytes(png(changed=20))
        page = (self.root / "README.md").read_text()
        (self.root / "README.md").write_text(
            page + "\n" + page.replace("a.png", "b.png").replace("by: cp", "nightly by: cp"))
        self.assertTrue(self.check("--quick"), self.output)
        self.assertFalse(self.check())
        self.assertIn("b.png is not what", self.output)

    def test_a_command_of_several_pictures_runs_once(self):
        (self.root / "docs/images/b.png").write_bytes(png())
        (self.root / "make").write_text(
            f"echo run >> {self.root}/runs; cp {self.root}/made.png a.png; cp a.png b.png")
        self.page(f"made by: bash {self.root}/make")
        page = (self.root / "README.md").read_text()
        (self.root / "README.md").write_text(page + "\n" + page.replace("a.png", "b.png"))
        self.assertTrue(self.check(), self.output)
        self.assertEqual((self.root / "runs").read_text(), "run\n")

    def test_measured_files_come_from_a_folder(self):
        self.page("made by: cp steel.bsdf a.png")
        self.assertTrue(self.check())
        self.assertIn("not checked: a.png (steel.bsdf", self.output)
        (self.root / "data/rgl").mkdir(parents=True)
        (self.root / "data/rgl/steel.bsdf").write_bytes(png(changed=20))
        self.assertFalse(self.check(f"--data={self.root / 'data'}"))

    def test_each_picture_has_one_command_and_a_page(self):
        page = (self.root / "README.md").read_text()
        (self.root / "docs/other.md").write_text("![A](images/a.png)\n")
        self.assertTrue(self.check(), self.output)
        (self.root / "docs/other.md").write_text("<!-- made by: true -->\n![A](images/a.png)\n")
        self.assertFalse(self.check())
        self.assertIn("by different commands", self.output)
        (self.root / "docs/other.md").unlink()
        (self.root / "README.md").write_text("![A](docs/images/a.png)\n")
        self.assertFalse(self.check())
        self.assertIn("without the command", self.output)
        (self.root / "README.md").write_text(page)
        (self.root / "docs/images/b.png").write_bytes(png())
        self.assertFalse(self.check())
        self.assertIn("no page shows docs/images/b.png", self.output)


if __name__ == "__main__":
    unittest.main()
