#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The page of hyperfocal-bench tradeoff in a real browser: at desktop and phone width, light and dark, nothing overlaps
or sticks out, nothing is fetched, and the console stays empty. Usage: page.py PROGRAM, which writes the page to its
argument. Skipped without Debian's chromium and chromedriver."""
import json
import os
import shutil
import struct
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request

passed = failed = 0


def check(ok, what):
    global passed, failed
    if ok:
        passed += 1
    else:
        failed += 1
        print("FAILED:", what, file=sys.stderr)


class Browser:
    def __init__(self, width, height, scheme, folder):
        with socket.socket() as s:
            s.bind(("127.0.0.1", 0))
            self.port = s.getsockname()[1]
        self.driver = subprocess.Popen(["chromedriver", "--port=%d" % self.port], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
        for _ in range(300):
            try:
                self.call("GET", "/status")
                break
            except OSError:
                time.sleep(0.1)
        arguments = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                     "--disable-background-networking", "--disable-component-update", "--disable-sync",
                     "--user-data-dir=" + folder]
        options = {"args": arguments, "mobileEmulation": {"deviceMetrics": {"width": width, "height": height,
                                                                            "pixelRatio": 1, "touch": False}}}
        wanted = {"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        session = self.call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})
        self.session = "/session/" + session["sessionId"]
        self.devtools("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})

    def call(self, method, path, body=None):
        data = json.dumps(body).encode() if body is not None else None
        request = urllib.request.Request("http://127.0.0.1:%d%s" % (self.port, path), data, method=method,
                                         headers={"Content-Type": "application/json"})
        with urllib.request.urlopen(request, timeout=120) as answer:
            return json.load(answer)["value"]

    def devtools(self, command, parameters):
        return self.call("POST", self.session + "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def run(self, script):
        return self.call("POST", self.session + "/execute/sync", {"script": script, "args": []})

    def close(self):
        try:
            self.call("DELETE", self.session)
        except OSError:
            pass
        self.driver.terminate()
        self.driver.wait()


# Texts of the visible chart that overlap each other or stick out of the chart.
OVERLAPS = """
const svg = [...document.querySelectorAll('.view.shown svg')].find((s) => s.getClientRects().length);
const edge = svg.getBoundingClientRect(), out = [];
const texts = [...svg.querySelectorAll('text')].map((t) => [t.textContent, t.getBoundingClientRect()]);
texts.forEach(([a, p], i) => {
  if (p.left < edge.left - 1 || p.right > edge.right + 1 || p.top < edge.top - 1 || p.bottom > edge.bottom + 1)
    out.push(a + ' sticks out');
  texts.slice(0, i).forEach(([b, q]) => {
    if (p.left < q.right - 1 && q.left < p.right - 1 && p.top < q.bottom - 1 && q.top < p.bottom - 1)
      out.push(a + ' / ' + b);
  });
});
return out;
"""

# Blocks of the page that overlap.
BLOCKS = """
const blocks = [...document.querySelectorAll('header, .tabs, .stage > *, h2, .scroll, .detail > *')]
    .map((e) => [e, e.getBoundingClientRect()]);
const out = [];
blocks.forEach(([a, p], i) => blocks.slice(0, i).forEach(([b, q]) => {
  if (!a.contains(b) && !b.contains(a) && p.left < q.right - 1 && q.left < p.right - 1 && p.top < q.bottom - 1 &&
      q.top < p.bottom - 1)
    out.push(a.tagName + '.' + a.className + ' / ' + b.tagName + '.' + b.className);
}));
return out;
"""

# The centre and the name of a point: the n-th from the end of those that no other point covers.
POINT = """
const free = [...document.querySelectorAll('.view.shown svg .pt[data-i] .hit')].filter((hit) => {
  if (!hit.getClientRects().length) return false;
  hit.scrollIntoView({block: 'center'});
  const r = hit.getBoundingClientRect();
  return document.elementFromPoint(r.left + r.width / 2, r.top + r.height / 2) === hit;
});
const hit = free[free.length - %d];
hit.scrollIntoView({block: 'center'});
const r = hit.getBoundingClientRect();
return [r.left + r.width / 2, r.top + r.height / 2, hit.parentNode.getAttribute('aria-label')];
"""
HEADING = "return document.querySelector('#detail h3').textContent"


def look(url, width, height, scheme):
    where = "%d x %d, %s: " % (width, height, scheme)
    folder = tempfile.mkdtemp()
    browser = Browser(width, height, scheme, folder)
    try:
        browser.call("POST", browser.session + "/url", {"url": url})
        check(browser.run("return innerWidth") == width, where + "the window is not as wide as asked for")
        check(browser.run("return document.documentElement.scrollWidth") <= width, where + "the page is too wide")
        dark = browser.run("return getComputedStyle(document.body).backgroundColor") == "rgb(23, 24, 26)"
        check(dark == (scheme == "dark"), where + "the colours are not those of the scheme")
        blocks = browser.run(BLOCKS)
        check(not blocks, where + "blocks overlap: " + ", ".join(blocks))
        tabs = browser.run("return document.querySelectorAll('.tabs button').length")
        check(tabs >= 10, where + "only %d tabs" % tabs)
        for i in range(tabs):
            name = browser.run("const b = document.querySelectorAll('.tabs button')[%d]; b.click();"
                               "return b.textContent" % i)
            check(browser.run("return document.querySelectorAll('.view.shown').length") == 1, where + name + " not shown")
            texts = browser.run(OVERLAPS)
            check(not texts, where + name + ": texts overlap: " + ", ".join(texts))
        browser.run("document.querySelector('.tabs button').click()")
        count = browser.run("return [...document.querySelectorAll('.view.shown svg .pt[data-i]')]"
                            ".filter((e) => e.getClientRects().length).length")
        check(count == 60, where + "%d points in place of 60" % count)
        for i in (1, 5):
            x, y, name = browser.run(POINT % i)
            browser.devtools("Input.dispatchMouseEvent", {"type": "mouseMoved", "x": x, "y": y})
            check(browser.run(HEADING) == name, where + "pointing at %s shows %s" % (name, browser.run(HEADING)))
        name = browser.run("const p = [...document.querySelectorAll('.view.shown svg .pt[tabindex=\"0\"]')]"
                           ".filter((e) => e.getClientRects().length)[0]; p.focus();"
                           "return p.getAttribute('aria-label')")
        check(browser.run(HEADING) == name, where + "focus on %s shows %s" % (name, browser.run(HEADING)))
        key = {"type": "keyDown", "key": "ArrowRight", "code": "ArrowRight"}
        browser.devtools("Input.dispatchKeyEvent", key)
        check(browser.run(HEADING) != name, where + "the arrow key does not go on")
        pictures = browser.run("return [...document.querySelectorAll('.crops img')].map((i) => i.naturalWidth)")
        check(all(pictures), where + "pictures are missing")
        fetched = browser.run("return performance.getEntriesByType('resource').map((e) => e.name)"
                              ".filter((n) => !n.startsWith('data:'))")
        check(not fetched, where + "fetched " + ", ".join(fetched))
        log = browser.call("POST", browser.session + "/se/log", {"type": "browser"})
        check(not log, where + "console: " + str(log))
    finally:
        browser.close()
        shutil.rmtree(folder, ignore_errors=True)


def main():
    if not shutil.which("chromedriver") or not shutil.which("chromium"):
        print("chromium and chromedriver are not installed")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        page = os.path.join(folder, "page.html")
        picture = os.path.join(folder, "chart.png")
        drawn = [picture] if shutil.which("rsvg-convert") else []
        subprocess.run([sys.argv[1], page] + drawn, check=True)
        if drawn:
            with open(picture, "rb") as f:
                head = f.read(24)
            size = struct.unpack(">II", head[16:]) if head[:8] == b"\x89PNG\r\n\x1a\n" else None
            check(size == (1720, 1120), "the chart as a picture: %s" % (size,))
        for width, height in ((1280, 900), (390, 844)):
            for scheme in ("light", "dark"):
                look("file://" + page, width, height, scheme)
    print("%d passed, %d failed" % (passed, failed))
    return 1 if failed or not passed else 0


sys.exit(main())
