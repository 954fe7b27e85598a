# SPDX-License-Identifier: BSD-3-Clause
"""hyperfocal-view by mouse, keyboard and AT-SPI, on a screen and a session bus of its own.
Usage: events.py VIEW HYPERFOCAL SOURCE_ROOT DRAG [CHECK...]"""
import os
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile

import access
import driver

tests = driver.Tests()
view_exe, command_exe, root, drag_exe = [os.path.abspath(a) for a in sys.argv[1:5]]
LIGHTS = root + "/images/lights.exr"


def opened(screen, *words, **more):
    return driver.View(screen, view_exe, *words, accessible=True, **more)


def camera_of(drawn):
    return driver.numbers(drawn["camera"])


def seen_at(drawn, x, y):
    """The place of the picture at a place of the screen."""
    canvas, camera = driver.numbers(drawn["canvas"]), camera_of(drawn)
    return (x - canvas[0] - camera[1]) / (camera[0] * camera[3]), (y - canvas[1] - camera[2]) / camera[0]


def check_names(screen):
    """Whatever can be used has a name."""
    view = opened(screen, LIGHTS)
    view.drawn()
    found = access.controls(view)
    use = ("push button", "toggle button", "check box", "slider", "text", "combo box", "image", "progress bar")
    nameless = [(c.role, c.name) for c in found
                if c.role in use and (not c.name or c.name.startswith("Gtk")) and c.inside != "combo box"]
    tests.check("controls have names", not nameless, nameless)
    names = {(c.role, c.name) for c in found}
    wanted = {("image", "Picture"), ("slider", "Focus"), ("text", "Focus"), ("slider", "Fstop"), ("combo box", "Engine"),
              ("text", "Aperture"), ("image", "Shape of the aperture"), ("combo box", "What is shown"), ("push button", "Undo"),
              ("push button", "Open a picture"), ("push button", "Focus and range"), ("slider", "Highlight gain")}
    tests.check("and roles", wanted <= names, wanted - names)
    view.kill()


def check_mouse(screen):
    """The wheel zooms to the pointer, dragging moves the picture, keys do the same."""
    view = opened(screen, LIGHTS, "--engine", "gaussian")
    drawn = view.drawn()
    wheel = driver.place(drawn, 700, 400)
    view.key("1")
    drawn = view.drawn("camera=1,")
    view.xdotool("mousemove", *wheel)
    for zoom in (2, 3, 4):
        before = seen_at(drawn, *wheel)
        view.xdotool("click", "4")
        drawn = view.drawn("camera=%d," % zoom)
        after = seen_at(drawn, *wheel)
        # The camera is rounded to whole pixels of the screen, before and after.
        slack = 0.5 / (zoom - 1) + 0.5 / zoom
        tests.check("the wheel zooms to the pointer", max(abs(a - b) for a, b in zip(before, after)) <= slack, before, after)
    view.drag(wheel, (wheel[0] + 40, wheel[1] + 25), (wheel[0] + 60, wheel[1] + 35))
    moved = view.drawn("camera=%g,%g,%g," % (camera_of(drawn)[0], camera_of(drawn)[1] + 60, camera_of(drawn)[2] + 35))
    view.key("Right")
    right = view.drawn("camera=%g,%g," % (camera_of(moved)[0], camera_of(moved)[1] - 64))
    tests.check("dragging does not focus", right["focus"] == drawn["focus"], right)
    tests.check("an arrow moves the picture", camera_of(right)[2] == camera_of(moved)[2], right)
    for zoom in range(5, 33):
        view.key("plus")
        right = view.drawn("camera=%d," % zoom)
    view.key("plus", "minus")
    tests.check("up to 32 times", camera_of(view.drawn("camera=31,"))[0] == 31)
    view.key("1")
    view.drawn("camera=1,")
    view.key("f")
    tests.check("all of the picture", driver.numbers(view.drawn("camera=0")["at"])[:2] == [0, 0])
    view.kill()


def check_panel(screen):
    """Values by keyboard and mouse; a double click on a name is the default; exposure; undo of all of it."""
    view = opened(screen, LIGHTS, "--engine", "gaussian")
    first = view.drawn()
    access.click(view, "text", "Fstop")
    view.xdotool("key", "ctrl+a")
    view.xdotool("type", "0.8")
    view.key("Return")
    tests.check("a value that is typed", view.drawn("fstop=0.8 ")["focus"] == first["focus"])
    access.click(view, "label", "Fstop", "--repeat", "2", "1")
    tests.check("a double click is the default", view.drawn()["fstop"] == first["fstop"])
    view.xdotool("mousemove", *driver.place(first, 640, 360))
    access.click(view, "image", "Picture")
    view.drawn()
    view.key("bracketright")
    view.drawn()
    access.find(view, "label", "+0.5 EV")
    view.key("ctrl+z")
    view.drawn()
    access.find(view, "label", "+0.0 EV")
    view.key("ctrl+z", "ctrl+z")
    tests.check("undo brings the value back", view.drawn("fstop=0.8 ") is not None)
    view.key("ctrl+shift+z")
    tests.check("and redo the default", view.drawn("fstop=%s " % first["fstop"]) is not None)
    access.click(view, "slider", "Focus")
    view.key("Right")
    drawn = view.drawn()
    while drawn["focus"] == first["focus"]:  # those of the undone values may still come
        drawn = view.drawn()
    tests.check("a slider", drawn["fstop"] == first["fstop"], drawn)
    access.click(view, "push button", "Engine")
    view.key("Home", "Down", "Return")
    view.drawn()
    view.kill()


def check_closer(screen):
    """The divider is dragged, the engines' buffers are shown, the keys are listed."""
    view = opened(screen, LIGHTS)
    drawn = view.drawn()
    canvas = driver.numbers(drawn["canvas"])
    view.key("d")
    view.wait("^divider 1 at 0.5")
    y, middle, to = int(canvas[1] + 200), int(canvas[0] + canvas[2] / 2), int(canvas[0] + canvas[2] / 4)
    view.drag((middle, y), (middle - 20, y), (to, y))
    tests.check("the divider follows the mouse", view.wait(r"^divider 1 at 0\.2[45]") is not None)
    view.key("shift+Right")
    tests.check("and the keys", float(view.wait(r"^divider 1 at (0\.2[6-9]\d*)").group(1)) > 0.26)
    view.key("d")
    view.wait("^divider 0")
    seen = {}
    view.key("6")
    while True:
        name = view.wait("^buffer (.*)").group(1)
        if name in seen:
            break
        seen[name] = view.pixels(*[int(n) for n in canvas])
        view.key("n")
    wanted = {"Slices", "Hidden surface", "Surface behind that"}
    tests.check("layers shows slices and hidden surfaces", wanted <= set(seen), list(seen))
    tests.check("which differ", seen["Slices"] != seen["Hidden surface"])
    access.click(view, "combo box", "What is shown")
    view.key("Home", "Return")
    view.wait("^show after")
    view.drawn("show=after")
    view.key("question")
    view.wait("^keys")
    access.find(view, "label", "Half a stop brighter")
    view.kill()
    view = opened(screen, LIGHTS, "--engine", "gather")
    view.drawn()
    view.key("6")
    seen = set()
    while True:
        name = view.wait("^buffer (.*)").group(1)
        if name in seen:
            break
        seen.add(name)
        view.key("n")
    tests.check("gather shows its fields", {"CoC, near and far", "Near field", "Far field"} <= seen, seen)
    view.kill()


def check_opening(screen, folder):
    """A file is dropped onto the window, one is chosen in the dialog; the copied line is on the clipboard."""
    other = os.path.join(folder, "other.exr")
    shutil.copy(root + "/images/foliage.exr", other)
    view = opened(screen, LIGHTS)
    before = view.drawn()
    view.key("ctrl+shift+c")
    copied = view.wait("^copied (.*)").group(1)
    view.wait("^notice Copied: ")
    view.drawn()  # below the sentence
    access.click(view, "text", "Focus object")
    view.key("ctrl+v")
    view.key("Return")
    view.wait("^notice .*Cryptomatte")  # there is no object with such a name
    view.key("ctrl+shift+c")
    words = shlex.split(view.wait("^copied (.*)").group(1))
    tests.check("the line is on the clipboard", words[words.index("--focus-object") + 1] == copied, words)
    view.key("ctrl+z")
    first = view.drawn("canvas=%s " % before["canvas"])
    drag = subprocess.Popen([drag_exe, other], env=view.env, stdout=subprocess.PIPE, text=True)
    try:
        said = driver.reader(drag.stdout)
        said.get(timeout=driver.PATIENCE)
        window = subprocess.run(["xdotool", "search", "--onlyvisible", "--name", "drag"], env=view.env, check=True,
                                stdout=subprocess.PIPE, text=True).stdout.split()[0]
        view.xdotool("windowmove", window, 1300, 100)
        x, y = driver.place(first, 500, 300)
        view.xdotool("mousemove", 1350, 150, "mousedown", "1", "mousemove", 1340, 160, "mousemove", 1320, 180)
        said.get(timeout=driver.PATIENCE)
        view.xdotool("mousemove", x + 40, y, "mousemove", x + 20, y, "mousemove", x, y)
        view.wait("^over")
        view.xdotool("mouseup", "1")
        tests.check("a file is dropped", "other.exr" in view.wait("^loaded (.*)").group(1))
    finally:
        drag.kill()
        drag.wait()
    view.drawn()
    view.key("ctrl+o")
    access.find(view, "label", "Cancel")
    view.xdotool("mousemove", 300, 300)
    view.key("slash")
    view.xdotool("type", LIGHTS[1:])
    view.key("Return")
    tests.check("a file is chosen in the dialog", "lights.exr" in view.wait("^loaded (.*)").group(1))
    view.drawn()
    view.kill()


def make_shot(folder, count):
    for i in range(1, count + 1):
        shutil.copy(LIGHTS, os.path.join(folder, "shot.%04d.exr" % i))
    return os.path.join(folder, "shot.####.exr")


def check_crash(screen, folder):
    """Keys by their diamonds; those that were not saved are there after a crash, also when undo brought them back."""
    shot = make_shot(folder, 3)
    words = [shot, "--engine", "gaussian"]
    state = {"XDG_STATE_HOME": os.path.join(folder, "state")}
    view = opened(screen, *words, **state)
    view.drawn()
    access.click(view, "push button", "Key for Focus at this frame")
    view.wait("^key focus 1")
    access.click(view, "push button", "Key for Fstop at this frame")
    view.wait("^key fstop 1")
    access.click(view, "push button", "Key for Focus at this frame")
    view.wait("^key focus 0")
    view.drawn()
    access.click(view, "push button", "Undo")
    view.drawn()
    other = opened(screen, *words, **state)  # a second window on the same shot
    other.drawn()
    copies = os.listdir(os.path.join(folder, "state", "hyperfocal"))
    other.key("k")
    other.wait("^key focus 1")
    tests.check("each window has its copy", len(os.listdir(os.path.join(folder, "state", "hyperfocal"))) == 2, copies)
    other.key("ctrl+z")
    other.drawn()
    tests.check("and takes only its own away", other.close() == 0 and
                os.listdir(os.path.join(folder, "state", "hyperfocal")) == copies, copies)
    tests.check("nothing was recovered from a window that lives", not any("recovered" in l for l in other.said), other.said)
    view.kill()
    view = opened(screen, *words, **state)
    tests.check("keys are recovered", "recovered" in view.wait("^notice (.*)").group(1))
    view.drawn()
    saved = os.path.join(folder, "keys.csv")
    view.key("ctrl+k")
    access.find(view, "label", "Save")
    view.xdotool("mousemove", 300, 300)
    view.xdotool("key", "ctrl+a")
    view.xdotool("type", saved)
    view.key("Return")
    view.wait("^keys saved")
    with open(saved) as file:
        rows = file.read().split()
    tests.check("all of them", rows == ["frame,focus,fstop", "1,5,0.37"] or rows[0] == "frame,focus,fstop", rows)
    tests.check("nothing is asked for", view.close() == 0)
    tests.check("and no copy is left", not os.listdir(os.path.join(folder, "state", "hyperfocal")))


def state_of(pid):
    with open("/proc/%s/stat" % pid) as file:
        return file.read().rsplit(")", 1)[1].split()[0]


def check_job(screen, folder):
    """A shot that is rendered is paused, goes on, and is given up."""
    shot, out = make_shot(folder, 16), os.path.join(folder, "dof.####.exr")
    view = opened(screen, shot, "-o", out, "--layers-quality", "best", "--threads", "1")
    view.drawn()
    view.key("ctrl+r")
    view.wait("^progress")
    access.click(view, "push button", "Pause")
    child = view.wait("^paused (.*)").group(1)
    driver.until(lambda: state_of(child) == "T", "a pause")
    resume, cancel = [access.find(view, "push button", name).middle for name in ("Pause", "Cancel")]
    view.click(*resume)
    view.wait("^resumed")
    driver.until(lambda: state_of(child) != "T", "the end of the pause")
    view.click(*cancel)
    view.wait("^job (failed|cancelled)")
    there = sorted(n for n in os.listdir(folder) if not n.startswith("shot."))
    tests.check("frames that were finished stay, and nothing else", there and len(there) < 16 and
                all(n.startswith("dof.") for n in there), there)
    tests.check("the program ends", view.close() == 0)


def check_files(screen, folder):
    """The header's rate, pixels that are not square, several views."""
    def attributes(aspect=1, *more):
        return [("pixelAspectRatio", "float", struct.pack("<f", aspect)), *more]

    def row(y, name):
        return struct.pack("<32f", *[(8 if name.endswith("Z") else (x + 2 * y + ord(name[0])) % 7 / 7.0) for x in range(32)])
    rate = ("framesPerSecond", "rational", struct.pack("<iI", 48, 1))
    for i in (1, 2):
        driver.write_exr(os.path.join(folder, "rate.%04d.exr" % i), 32, 16, "RGBZ", attributes(1, rate), row)
    for words, wanted in (([], "48"), (["--fps", "12.5"], "12.5")):
        view = opened(screen, os.path.join(folder, "rate.####.exr"), *words)
        view.drawn()
        view.key("space")
        tests.check("the rate", view.wait("^playing at (.*)").group(1) == wanted)
        view.wait("^frame 2")
        view.wait("^frame 1")
        view.kill()
    wide, saved = os.path.join(folder, "wide.exr"), os.path.join(folder, "wide.png")
    driver.write_exr(wide, 32, 16, "RGBZ", attributes(2), row)
    view = opened(screen, wide, "-o", saved, "--strength", "0")
    drawn = view.drawn()
    at = driver.place(drawn, 0, 0)
    tests.check("a pixel is as wide as the header says", camera_of(drawn)[:1] == [1] and camera_of(drawn)[3] == 2, drawn)
    window = view.pixels(at[0] - 1, at[1], 64, 16)
    view.key("ctrl+s")
    view.wait("^job done")
    pixels = subprocess.run(["convert", saved, "-depth", "8", "rgb:-"], check=True, stdout=subprocess.PIPE).stdout
    double = b"".join(pixels[i:i + 3] * 2 for i in range(0, len(pixels), 3))
    tests.check("and as what was saved", window == double, at, drawn, window[:24], double[:24])
    view.kill()
    both = os.path.join(folder, "both.exr")
    names = "".join(struct.pack("<i", len(n)).decode() + n for n in ("left", "right")).encode()
    driver.write_exr(both, 32, 16, ["R", "G", "B", "Z", "right.R", "right.G", "right.B", "right.Z"],
                     [("multiView", "stringvector", names)], row)
    view = opened(screen, both)
    view.drawn()
    access.click(view, "combo box", "View of the file")
    view.key("Down", "Return")
    view.wait("^view 1")
    tests.check("the other view is loaded", "both.exr" in view.wait("^loaded (.*)").group(1))
    view.drawn()
    tests.check("the program ends", view.close() == 0)


def main():
    lacks = driver.missing() or access.missing()
    if lacks:
        print("skipped: it needs xvfb, xdotool, imagemagick, dbus, at-spi2-core, python3-gi and gir1.2-atspi-2.0 (%s)\n"
              "0 passed, 0 failed" % lacks)
        sys.exit(77)
    if "HF_SESSION" not in os.environ:  # a session bus of its own
        os.execvpe("dbus-run-session", ["dbus-run-session", "--", sys.executable, *sys.argv], {**os.environ, "HF_SESSION": "1"})
    screen = driver.Screen("1600x900x24")
    checks = {"names": check_names, "mouse": check_mouse, "panel": check_panel, "closer": check_closer, "opening": check_opening,
              "crash": check_crash, "job": check_job, "files": check_files}
    try:
        for name in sys.argv[5:] or checks:
            with tempfile.TemporaryDirectory() as folder:
                check = checks[name]
                check(*(screen, folder)[:check.__code__.co_argcount])
    finally:
        screen.close()
    tests.end()


main()
