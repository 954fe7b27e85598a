# SPDX-License-Identifier: BSD-3-Clause
"""Makes the pictures of docs/view.md, on a screen in memory: python3 docs/view.py BUILD [NAME...]. It needs what tests/view needs."""
import os
import shutil
import subprocess
import sys
import tempfile

root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(root, "tests", "view"))
import driver  # noqa: E402

build = os.path.abspath(sys.argv[1])
folder = os.path.join(root, "images", "view")


def take(view, name):
    path = os.path.join(folder, name + ".jpg")
    subprocess.run(["import", "-window", "root", "-quality", "88", path], env=view.env, check=True)
    print(path)


def fill(view, width, height):
    window = subprocess.run(["xdotool", "search", "--onlyvisible", "--class", "hyperfocal"], env=view.env, check=True,
                            stdout=subprocess.PIPE, text=True).stdout.split()[-1]
    view.xdotool("windowmove", window, 0, 0, "windowsize", window, width, height)
    view.wait("^drawn stage=final .*show=")


def still(size, name, *options, **environment):
    """A picture with the lens open, focused by a click."""
    width, height = (int(n) for n in size.split("x"))
    screen = driver.Screen(size + "x24")
    view = driver.View(screen, build + "/src/tools/view/hyperfocal-view", root + "/images/lights.exr", *options, **environment)
    try:
        view.drawn()
        if (width, height) != (1280, 800) and not environment:
            fill(view, width, height)
        if "-parts" in name:
            view.key("3")
            view.drawn("show=radius")
            view.key("d")
            view.wait("^divider 1")
            view.key("p")
            view.wait("^profiler 1")
            view.drawn("show=radius")
        take(view, name)
    finally:
        view.kill()
        screen.close()


def shot(name):
    with tempfile.TemporaryDirectory() as place:
        for i in range(1, 9):
            shutil.copy(root + "/images/lights.exr", os.path.join(place, "shot.%04d.exr" % i))
        with open(os.path.join(place, "keys.csv"), "w") as file:
            file.write("frame,focus,fstop\n1,5,0.37\n4,,0.5\n6,1.6,\n8,1.5,0.37\n")
        screen = driver.Screen("1280x800x24")
        view = driver.View(screen, build + "/src/tools/view/hyperfocal-view", "shot.####.exr", "--keys", "keys.csv",
                           "--keys-blend", "smooth", cwd=place)
        try:
            view.drawn()
            view.key("period")
            view.wait("^frame 2")
            view.key("period")
            view.wait("^frame 3")
            view.drawn()
            take(view, name)
        finally:
            view.kill()
            screen.close()


os.makedirs(folder, exist_ok=True)
pictures = {
    "light": lambda name: still("1280x800", name),
    "dark-parts": lambda name: still("1280x800", name, "--dark", "--engine", "gather"),
    "large": lambda name: still("2560x1440", name, "--dark", "--highlight-gain", "4", "--aperture", "ngon:6:0.3:15"),
    "large-2x-parts": lambda name: still("2560x1600", name, "--engine", "gather", GDK_SCALE="2"),
    "shot": shot,
}
for wanted in sys.argv[2:] or pictures:
    pictures[wanted](wanted)
