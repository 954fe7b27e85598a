# SPDX-License-Identifier: BSD-3-Clause
"""hyperfocal-view by real events on a screen in memory. Usage: view.py VIEW HYPERFOCAL SOURCE_ROOT"""
import os
import shlex
import subprocess
import sys
import tempfile

import driver

tests = driver.Tests()
view_exe, command_exe, root = [os.path.abspath(a) for a in sys.argv[1:4]]
PHOTO = [root + "/images/lights-before.png", "--depth-file", root + "/images/lights-depth.png", "--depth-type", "inverse",
         "--near", "1.5", "--far", "60", "--fstop", "0.37", "--focal-length", "50"]


def rgb_of(path, x, y, width, height):
    return subprocess.run(["convert", path, "-crop", "%dx%d+%d+%d" % (width, height, x, y), "-depth", "8", "rgb:-"], check=True,
                          stdout=subprocess.PIPE).stdout


def place(drawn, x, y):
    """Where a pixel of the picture is on the screen."""
    canvas, camera = driver.numbers(drawn["canvas"]), driver.numbers(drawn["camera"])
    return int(canvas[0] + camera[1] + (x + 0.5) * camera[0]), int(canvas[1] + camera[2] + (y + 0.5) * camera[0])


def check_turning(screen):
    """A click focuses and the f-number's slider opens the lens."""
    view = driver.View(screen, view_exe, root + "/images/lights.exr")
    first = view.drawn()
    tests.check("the header's focus", first["focus"] == "5", first)
    view.click(*place(first, 60, 300))
    near = view.drawn("focus=1")
    tests.check("the click moved the focus", float(near["focus"]) < 4, near)
    view.key("ctrl+z")
    back = view.drawn()
    tests.check("undo goes back to the header's focus", back["focus"] == "5", back)
    view.key("ctrl+shift+z")
    again = view.drawn()
    tests.check("redo focuses again", again["focus"] == near["focus"], again)
    tests.check("the program ends well", view.close() == 0)
    tests.check("and says nothing on the terminal", not view.errors, *view.errors)


def check_pixels(screen, folder):
    """The window's pixels at 1:1, the saved picture's and those of the copied command are equal."""
    saved = os.path.join(folder, "saved.png")
    view = driver.View(screen, view_exe, *PHOTO, "--focus", "5", "-o", saved)
    view.drawn()
    view.key("1")
    drawn = view.drawn("camera=1,")
    canvas, camera = driver.numbers(drawn["canvas"]), driver.numbers(drawn["camera"])
    part = [int(-camera[1]) if camera[1] < 0 else 0, int(-camera[2]) if camera[2] < 0 else 0, 600, 300]
    at = place(drawn, part[0], part[1])
    window = view.pixels(at[0], at[1], part[2], part[3])
    view.key("ctrl+s")
    view.wait("^job done")
    tests.check("the window shows what was saved", window == rgb_of(saved, *part), canvas, camera)
    view.key("ctrl+shift+c")
    line = shlex.split(view.wait("^copied (.*)").group(1))
    tests.check("the copied line is the command's", line[0] == "hyperfocal" and "--focus" in line, line)
    line[0], copied = command_exe, os.path.join(folder, "copied.png")
    line[line.index("-o") + 1] = copied
    subprocess.run(line, check=True, stderr=subprocess.DEVNULL)
    with open(saved, "rb") as a, open(copied, "rb") as b:
        tests.check("the copied command writes the saved picture", a.read() == b.read())
    tests.check("the program ends well", view.close() == 0)


def main():
    tool = driver.missing()
    if tool:
        print("skipped: %s is not installed, which this test needs\n0 passed, 0 failed" % tool)
        sys.exit(77)
    screen = driver.Screen()
    try:
        with tempfile.TemporaryDirectory() as folder:
            check_turning(screen)
            check_pixels(screen, folder)
    finally:
        screen.close()
    tests.end()


main()
