# SPDX-License-Identifier: BSD-3-Clause
"""Runs hyperfocal-view on a screen of its own (Xvfb) and waits for what it says on stdout: nothing here sleeps and guesses."""
import os
import queue
import re
import shutil
import subprocess
import sys
import threading

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


class View:
    """One run of the program."""

    def __init__(self, screen, program, *arguments, cwd=None, **environment):
        self.env = dict(os.environ, DISPLAY=screen.display, GDK_BACKEND="x11", GSK_RENDERER="cairo", GTK_A11Y="none",
                        HYPERFOCAL_VIEW_SAY="1", GSETTINGS_BACKEND="memory", **environment)
        self.env.pop("WAYLAND_DISPLAY", None)
        self.lines, self.said = queue.Queue(), []
        self.process = subprocess.Popen([program, *arguments], env=self.env, cwd=cwd, stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True)
        self.errors = []
        threading.Thread(target=self._read, daemon=True).start()
        self._stderr = threading.Thread(target=self._read_errors, daemon=True)
        self._stderr.start()

    def _read(self):
        for line in self.process.stdout:
            self.lines.put(line.rstrip("\n"))
        self.lines.put(None)

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


def numbers(text):
    return [float(n) for n in text.split(",")]


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
