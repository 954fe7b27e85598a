# SPDX-License-Identifier: BSD-3-Clause
"""Runs hyperfocal-view on a screen of its own (Xvfb) and waits for what it says on stdout: nothing here sleeps and guesses."""
import atexit
import os
import queue
import re
import shutil
import subprocess
import sys
import struct
import threading
import time

PATIENCE = 60  # seconds until a state that never comes is a failure


def missing():
    """A tool that is not installed, or None."""
    for tool in ("Xvfb", "xdotool", "dbus-run-session", "convert", "import"):
        if not shutil.which(tool):
            return tool
    return None


class Screen:
    def __init__(self, size="1280x800x24"):
        read, write = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", size, "-nolisten", "tcp"],
                                       pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as said:
            self.display = ":" + said.readline().strip()

    def close(self):
        self.server.terminate()
        self.server.wait()


def write_exr(path, width, height, channels, attributes=(), row=None):
    """A picture of floats without compression. channels: names; row(y, name): its bytes of a row; attributes: name, type, bytes."""
    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    box, names = struct.pack("<4i", 0, 0, width - 1, height - 1), sorted(channels)
    header = {"channels": ("chlist", b"".join(n.encode() + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for n in names) + b"\0"),
              "compression": ("compression", b"\0"), "dataWindow": ("box2i", box), "displayWindow": ("box2i", box),
              "lineOrder": ("lineOrder", b"\0"), "pixelAspectRatio": ("float", struct.pack("<f", 1)),
              "screenWindowCenter": ("v2f", struct.pack("<2f", 0, 0)), "screenWindowWidth": ("float", struct.pack("<f", 1))}
    header.update({name: (kind, value) for name, kind, value in attributes})
    begin = struct.pack("<ii", 20000630, 2) + b"".join(attribute(n, *v) for n, v in sorted(header.items())) + b"\0"
    size = 4 * width * len(names)
    with open(path, "wb") as file:
        file.write(begin)
        for y in range(height):
            file.write(struct.pack("<Q", len(begin) + 8 * height + y * (8 + size)))
        for y in range(height):
            file.write(struct.pack("<ii", y, size) + b"".join(row(y, n) for n in names))


def until(test, what):
    """Ask again until the answer is not empty; the answer."""
    end = time.monotonic() + PATIENCE
    while True:
        answer = test()
        if answer:
            return answer
        if time.monotonic() > end:
            raise AssertionError(what + " never came")
        time.sleep(0.02)


def reader(stream):
    """The lines of a stream, as a queue that ends with None."""
    lines = queue.Queue()

    def read():
        for line in stream:
            lines.put(line.rstrip("\n"))
        lines.put(None)
    threading.Thread(target=read, daemon=True).start()
    return lines


class View:
    """One run of the program. accessible: other programs see its controls."""

    def __init__(self, screen, program, *arguments, cwd=None, accessible=False, **environment):
        self.env = dict(os.environ, DISPLAY=screen.display, GDK_BACKEND="x11", GSK_RENDERER="cairo",
                        HYPERFOCAL_VIEW_SAY="1", GSETTINGS_BACKEND="memory", **environment)
        self.env.pop("WAYLAND_DISPLAY", None)
        if not accessible:
            self.env["GTK_A11Y"] = "none"
        self.said = []
        self.process = subprocess.Popen([program, *arguments], env=self.env, cwd=cwd, stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True)
        atexit.register(self.kill)  # also when a check has failed
        self.lines, self.errors = reader(self.process.stdout), []
        self._stderr = threading.Thread(target=self._read_errors, daemon=True)
        self._stderr.start()

    def _read_errors(self):
        self.errors += self.process.stderr

    def wait(self, pattern):
        """The next line that matches; its match."""
        while True:
            try:
                line = self.lines.get(timeout=PATIENCE)
            except queue.Empty:
                line = None
            if line is None:
                raise AssertionError("'%s' never came; the last lines were:\n  %s\n%s" % (
                    pattern, "\n  ".join(self.said[-5:]), "".join(self.errors[-5:])))
            self.said.append(line)
            found = re.search(pattern, line)
            if found:
                return found

    def drawn(self, pattern=""):
        """Wait until a final picture is on the screen whose line has the pattern too; its values by name."""
        line = self.wait("^drawn stage=final .*" + pattern).string
        return dict(word.split("=", 1) for word in line.split()[1:])

    def xdotool(self, *words):
        subprocess.run(["xdotool", *[str(w) for w in words]], env=self.env, check=True)

    def key(self, *keys):
        self.xdotool("key", "--clearmodifiers", *keys)

    def click(self, x, y, *more):
        self.xdotool("mousemove", x, y, "click", *(more or ("1",)))

    def drag(self, start, *places):
        """Press the button at the start, move, let go. On a busy machine the X server hands on what the button does
        before the moves around it; a pause, shorter than any hand's, keeps their order."""
        moves = [word for place in places for word in ("mousemove", *place)]
        self.xdotool("mousemove", *start, "sleep", 0.2, "mousedown", 1, "sleep", 0.2, *moves, "sleep", 0.2, "mouseup", 1)

    def pixels(self, x, y, width, height):
        """R, G, B of a part of the screen."""
        return subprocess.run(["import", "-window", "root", "-depth", "8", "-crop", "%dx%d+%d+%d" % (width, height, x, y),
                               "rgb:-"], env=self.env, check=True, stdout=subprocess.PIPE).stdout

    def close(self):
        self.key("ctrl+q")
        code = self.process.wait(PATIENCE)
        self._stderr.join(PATIENCE)
        return code

    def kill(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
            self._stderr.join(PATIENCE)


def numbers(text):
    return [float(n) for n in text.split(",")]


def place(drawn, x, y):
    """Where a pixel of the picture is on the screen."""
    canvas, camera = numbers(drawn["canvas"]), numbers(drawn["camera"])
    return int(canvas[0] + camera[1] + (x + 0.5) * camera[0] * camera[3]), int(canvas[1] + camera[2] + (y + 0.5) * camera[0])


class Tests:
    def __init__(self):
        self.passed = self.failed = 0

    def check(self, name, good, *what):
        self.passed += bool(good)
        self.failed += not good
        if not good:
            print("FAILED:", name, *what)

    def end(self):
        print("%d passed, %d failed" % (self.passed, self.failed))
        sys.exit(1 if self.failed or not self.passed else 0)
