# SPDX-License-Identifier: BSD-3-Clause
"""hyperfocal-view by real events on a screen in memory. Usage: view.py VIEW HYPERFOCAL SOURCE_ROOT NO_MEMORY"""
import os
import shlex
import shutil
import subprocess
import sys
import tempfile

import driver

tests = driver.Tests()
view_exe, command_exe, root, no_memory = [os.path.abspath(a) for a in sys.argv[1:5]]
PHOTO = [root + "/images/lights-before.png", "--depth-file", root + "/images/lights-depth.png", "--depth-type", "inverse",
         "--near", "1.5", "--far", "60", "--fstop", "0.37", "--focal-length", "50"]


def rgb_of(path, x, y, width, height):
    return subprocess.run(["convert", path, "-crop", "%dx%d+%d+%d" % (width, height, x, y), "-depth", "8", "rgb:-"], check=True,
                          stdout=subprocess.PIPE).stdout


def check_turning(screen):
    """A click focuses and the f-number's slider opens the lens."""
    view = driver.View(screen, view_exe, root + "/images/lights.exr")
    first = view.drawn()
    tests.check("the header's focus", first["focus"] == "5", first)
    view.click(*driver.place(first, 60, 300))
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
    at = driver.place(drawn, part[0], part[1])
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


def check_keys(screen, folder):
    """A focus pull by two keys: what is saved is read by the command, and the rendered shot is the command's."""
    for i in range(1, 4):
        shutil.copy(root + "/images/lights.exr", os.path.join(folder, "shot.%04d.exr" % i))
    shot, out = os.path.join(folder, "shot.####.exr"), os.path.join(folder, "dof.####.exr")
    keys = os.path.join(folder, "keys.csv")
    with open(keys, "w") as file:
        file.write("frame,focus\n1,4\n")
    view = driver.View(screen, view_exe, shot, "-o", out, "--keys", keys, "--engine", "gaussian",
                       XDG_STATE_HOME=os.path.join(folder, "state"))
    first = view.drawn("focus=4 ")
    view.key("period")
    view.wait("^frame 2")
    view.key("period")
    view.wait("^frame 3")
    view.drawn("focus=4 ")
    view.click(*driver.place(first, 60, 300))
    last = view.drawn("focus=1")
    view.key("ctrl+q")
    view.wait("^ask unsaved keys")
    view.key("Escape")
    view.key("ctrl+k")
    view.wait("^keys saved")
    with open(keys) as file:
        rows = file.read().split()
    tests.check("the keys are saved as the command reads them", rows[:2] == ["frame,focus", "1,4"] and
                abs(float(rows[2].split(",")[1]) - float(last["focus"])) < 1e-4, rows)
    view.key("comma")
    view.wait("^frame 2")
    between = view.drawn()
    middle = (4 + float(last["focus"])) / 2
    tests.check("the frame between lies between", abs(float(between["focus"]) - middle) < 1e-3, between)
    view.key("ctrl+r")
    view.wait("^job done")
    line = shlex.split((view.key("ctrl+shift+c"), view.wait("^copied (.*)").group(1))[1])
    line[0], line[line.index("-o") + 1] = command_exe, os.path.join(folder, "again.####.exr")
    subprocess.run(line, check=True, stderr=subprocess.DEVNULL)
    same = [open(os.path.join(folder, "dof.%04d.exr" % i), "rb").read() ==
            open(os.path.join(folder, "again.%04d.exr" % i), "rb").read() for i in range(1, 4)]
    tests.check("the rendered shot is the copied command's", all(same), same)
    view.key("space")
    view.wait("^playing")
    view.wait("^frame 3")
    view.wait("^frame 1")
    view.key("space")
    view.wait("^paused")
    tests.check("the program ends without asking", view.close() == 0)


def check_looking(screen):
    """False colours, the input by a held key, the divider, the profiler."""
    view = driver.View(screen, view_exe, root + "/images/lights.exr", "--engine", "gather")
    drawn = view.drawn()
    canvas = [int(n) for n in driver.numbers(drawn["canvas"])]
    seen = {"result": view.pixels(*canvas)}
    for key, name in (("2", "depth"), ("3", "radius"), ("4", "peaking"), ("5", "tiles")):
        view.key(key)
        view.wait("^show " + name)
        view.drawn("show=" + name)
        seen[name] = view.pixels(*canvas)
    view.key("5")
    view.wait("^show after")
    view.drawn("show=after")
    tests.check("the result is as it was", view.pixels(*canvas) == seen["result"])
    view.xdotool("keydown", "b")
    view.wait("^before 1")
    seen["before"] = view.pixels(*canvas)
    view.xdotool("keyup", "b")
    view.wait("^before 0")
    view.key("d")
    view.wait("^divider 1")
    divided = view.pixels(*canvas)
    half = [divided[(canvas[3] // 2 * canvas[2] + x) * 3:][:3 * 200] for x in (0, canvas[2] - 200)]
    inputs = [seen[name][(canvas[3] // 2 * canvas[2] + x) * 3:][:3 * 200] for name, x in
              (("before", 0), ("result", canvas[2] - 200))]
    tests.check("left of the divider is the input, right of it the result", half == inputs)
    tests.check("all of them differ", len(set(seen.values())) == len(seen), list(seen))
    view.key("6")
    view.wait("^show buffer")
    view.drawn("show=buffer")
    view.key("p")
    view.wait("^profiler 1")
    view.key("question")
    view.wait("^keys")
    driver.until(lambda: subprocess.run(["xdotool", "search", "--onlyvisible", "--name", "^Keys$"], env=view.env,
                                        stdout=subprocess.PIPE).stdout, "the list of keys")
    view.kill()
    tests.check("without a warning", not view.errors, *view.errors)


def check_demo(screen, folder):
    profile = os.path.join(folder, "profile.txt")
    view = driver.View(screen, view_exe, "--demo", "--frames", "110", "--profile", profile)
    view.wait("^demo 100")
    tests.check("the demo ends by itself", view.process.wait(driver.PATIENCE) == 0)
    with open(profile) as file:
        text = file.read()
    tests.check("the profile has blocks of 100 frames", "frames 1 to 100:" in text and "frames 101 to 110:" in text and
                text.count("All") == 2, text)


def check_errors(screen, folder):
    """Each of them is a sentence: in the window, or on the terminal."""
    broken = os.path.join(folder, "broken.exr")
    with open(root + "/images/lights.exr", "rb") as whole, open(broken, "wb") as part:
        part.write(whole.read(100000))
    view = driver.View(screen, view_exe, broken)
    tests.check("a broken file is named", "broken.exr" in view.wait("^notice (.*)").group(1))
    view.kill()
    moved = os.path.join(folder, "folder")
    os.mkdir(moved)
    shown = os.path.join(moved, "shown.exr")
    shutil.copy(root + "/images/lights.exr", shown)
    view = driver.View(screen, view_exe, shown)
    view.drawn()
    shutil.copy(root + "/images/foliage.exr", shown + ".new")
    os.rename(shown + ".new", shown)
    tests.check("a replaced file is read again", "replaced" in view.wait("^notice (.*)").group(1))
    view.drawn()
    shutil.rmtree(moved)
    tests.check("one that is gone is said to be", "gone" in view.wait("^notice (.*)").group(1))
    view.kill()
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    alone = subprocess.run([view_exe], env=environment, capture_output=True, text=True)
    tests.check("without a display there is one sentence", alone.returncode == 1 and alone.stderr ==
                "hyperfocal-view: there is no display to open a window on\n", alone.stderr)
    for words, begin in (("--help", "hyperfocal-view "), ("--help=man", ".TH hyperfocal-view 1")):
        told = subprocess.run([view_exe, words], env=environment, capture_output=True, text=True)
        tests.check(words, told.returncode == 0 and told.stdout.startswith(begin) and "--demo" in told.stdout.replace("\\", ""), told.stdout[:80])
    wrong = subprocess.run([view_exe, "--fstop", "0"], env=environment, capture_output=True, text=True)
    tests.check("a wrong option too", wrong.returncode == 1 and wrong.stderr.count("\n") == 1, wrong.stderr)


def check_memory(screen):
    """Planes that find no memory, and a canvas that finds none: a sentence each, and the window lives."""
    with open(view_exe, "rb") as program:
        if b"__asan_init" in program.read():  # a sanitizer has a malloc of its own
            return
    view = driver.View(screen, view_exe, root + "/images/lights.exr")
    canvas = driver.numbers(view.drawn()["canvas"])
    view.kill()
    for size, said in ((1280 * 720 * 4, "out of memory"), (int(canvas[2]) * int(canvas[3]) * 4, "not enough memory")):
        view = driver.View(screen, view_exe, root + "/images/lights.exr", LD_PRELOAD=no_memory, HF_NO_MEMORY=str(size))
        tests.check("no memory is a sentence", said in view.wait("^notice (.*)").group(1), view.said)
        tests.check("and the window lives", view.close() == 0 and not view.errors, view.errors)


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
            check_keys(screen, folder)
            check_looking(screen)
            check_demo(screen, folder)
            check_errors(screen, folder)
            check_memory(screen)
    finally:
        screen.close()
    tests.end()


main()
