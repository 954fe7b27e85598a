# SPDX-License-Identifier: BSD-3-Clause
"""The controls of a window as a screen reader sees them, by AT-SPI. It needs a session bus (dbus-run-session).
libatspi can crash while a window changes, so that each look is a process of its own: `access.py PID` prints the controls."""
import json
import os
import subprocess
import sys
import warnings

import driver

SHADOW = 5  # pixels of the screen around what a window calls its own
TRIES = 20  # looks that may crash, one after the other


class Control:
    def __init__(self, role, name, inside, middle, shown):
        self.role, self.name, self.inside, self.middle, self.shown = role, name, inside, middle, shown


def missing():
    """What a look lacks, or None."""
    try:
        import gi
        gi.require_version("Atspi", "2.0")
    except (ImportError, ValueError) as reason:
        return str(reason)
    folders = os.environ.get("XDG_DATA_DIRS", "/usr/local/share:/usr/share").split(":")
    bus = "dbus-1/services/org.a11y.Bus.service"
    return None if any(os.path.exists(os.path.join(f, bus)) for f in folders) else "there is no " + bus


def controls(view):
    """All controls of the program."""
    for _ in range(TRIES):
        look = subprocess.run([sys.executable, __file__, str(view.process.pid)], env=view.env, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, timeout=driver.PATIENCE)
        if look.returncode == 0:
            return [Control(*c) for c in json.loads(look.stdout)]
    raise AssertionError("%d looks at the controls failed, the last with code %d" % (TRIES, look.returncode))


def find(view, role, name):
    """Wait until a control is there and shown."""
    def look():
        return [c for c in controls(view) if c.role == role and c.name == name and c.shown]
    return driver.until(look, "%s '%s'" % (role, name))[0]


def click(view, role, name, *more):
    """Click in the middle of a control."""
    view.click(*find(view, role, name).middle, *more)


def look(pid):
    """What AT-SPI says of a process."""
    import gi
    gi.require_version("Atspi", "2.0")
    from gi.repository import Atspi, GLib
    warnings.simplefilter("ignore", DeprecationWarning)

    def walk(node, inside, found):
        try:
            role, where = node.get_role_name(), node.get_component_iface()
            e = where.get_extents(Atspi.CoordType.WINDOW) if where else None
            middle = (e.x + e.width // 2 + SHADOW, e.y + e.height // 2 + SHADOW) if e else None
            found.append((role, node.get_name() or "", inside, middle,
                          node.get_state_set().contains(Atspi.StateType.VISIBLE)))
            for i in range(node.get_child_count()):
                child = node.get_child_at_index(i)
                if child:
                    walk(child, role if role in ("combo box", "page tab list") else inside, found)
        except GLib.Error:
            pass  # it has gone meanwhile
    desktop, found = Atspi.get_desktop(0), []
    for i in range(desktop.get_child_count()):
        application = desktop.get_child_at_index(i)
        if application and application.get_process_id() == pid:
            walk(application, None, found)
    return found


if __name__ == "__main__":
    print(json.dumps(look(int(sys.argv[1]))))
