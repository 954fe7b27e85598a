# SPDX-License-Identifier: BSD-3-Clause
"""Hundreds of events in hyperfocal-view, the same ones each time; nothing may be said on the terminal, by a sanitizer or by GTK.
Usage: session.py VIEW SOURCE_ROOT [EVENTS]"""
import os
import random
import shutil
import sys
import tempfile

import driver

tests = driver.Tests()
KEYS = ("period comma 1 f plus minus bracketleft bracketright backslash d 2 3 4 5 6 n p space k e Left Right Up Down Return "
        "shift+Left shift+Right ctrl+z ctrl+shift+z ctrl+shift+c Escape").split()


def event(chance, canvas):
    """What xdotool is told: most of the time a key."""
    def place():
        return [int(canvas[i] + chance.random() * canvas[i + 2]) for i in (0, 1)]
    return chance.choice([
        lambda: ["key", chance.choice(KEYS)], lambda: ["key", chance.choice(KEYS)], lambda: ["key", chance.choice(KEYS)],
        lambda: ["mousemove", *place(), "click", 1],
        lambda: ["mousemove", *place(), "click", "--repeat", chance.randint(1, 5), chance.choice((4, 5))],
        lambda: ["mousemove", *place(), "mousedown", 1, "mousemove", *place(), "mousemove", *place(), "mouseup", 1],
        lambda: ["keydown", "b", "mousemove", *place(), "keyup", "b"]])()


def session(screen, program, root, folder, count):
    for i in range(1, 4):
        shutil.copy(root + "/images/lights.exr", os.path.join(folder, "shot.%04d.exr" % i))
    keys, chance = os.path.join(folder, "keys.csv"), random.Random(1)
    with open(keys, "w") as file:
        file.write("frame,focus\n1,4\n3,2\n")
    view = driver.View(screen, program, os.path.join(folder, "shot.####.exr"), "--keys", keys, "--engine", "gather",
                       XDG_STATE_HOME=os.path.join(folder, "state"))
    canvas = driver.numbers(view.drawn()["canvas"])
    for i in range(count):
        view.xdotool(*event(chance, canvas))
        if i % 20 == 19:  # what follows a rest is another way than what follows an event
            view.wait("^drawn")
    view.key("ctrl+k")  # nothing is asked for then
    view.wait("^keys saved")
    tests.check("the program ends well", view.close() == 0)
    tests.check("nothing is said on the terminal", not view.errors, "".join(view.errors))


def main():
    lacks = driver.missing()
    if lacks:
        print("skipped: %s is not installed, which this test needs\n0 passed, 0 failed" % lacks)
        sys.exit(77)
    screen = driver.Screen()
    try:
        with tempfile.TemporaryDirectory() as folder:
            session(screen, *[os.path.abspath(a) for a in sys.argv[1:3]], folder, int((sys.argv[3:] or ["200"])[0]))
    finally:
        screen.close()
    tests.end()


main()
