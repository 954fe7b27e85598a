# SPDX-License-Identifier: BSD-3-Clause
"""Depth of field for rendered pictures, on the CPU.

    import hyperfocal
    blurred = hyperfocal.defocus(color, depth, focus=5, f_number=0.8, focal_length=50)

color is a picture (height, width, 3 or 4), depth the distance of what each of its pixels shows, (height, width).
"""
import os as _os
import textwrap as _textwrap

from ._hyperfocal import Context, __version__, choose_quality, coc, depth_at, parameters

__all__ = ["Context", "choose_quality", "coc", "defocus", "depth_at", "parameters"]

# A context that the last call of defocus left: its threads and memory serve the next one.
_idle = []
_os.register_at_fork(after_in_child=_idle.clear)


def defocus(color, depth, *, out=None, **arguments):
    """Blur a picture as a lens would have taken it.

    color: an array (height, width, 3 or 4) of float32, float16, uint8 or uint16, or a tuple of 3 or 4 planes
        (height, width). Colours are linear and premultiplied by alpha; whole numbers are sRGB unless transfer='linear'.
        Any strides; the library reads it where it lies, except for three channels that are neither float32 nor planes,
        samples of a pixel that are not side by side, and bytes in foreign order, which are copied.
    depth: an array (height, width) of float32, float16, uint16 or uint32: by default the distance along the camera's axis,
        scene units. It is never written. NaN counts as a neighbour's depth.
    out: where the result goes: an array of color's height and width, also color itself. Default: a new array like color.

    Returns out. Raises ValueError or TypeError for a wrong argument, MemoryError, and RuntimeError if a thread cannot be started;
    warns with RuntimeWarning. Other Python threads run meanwhile. Threads and memory are kept for the next call; a Context gives
    them back when it is closed.

    Every other argument is a parameter of the library; None is as if not given, and 'derive' lets the library work it out:

"""
    try:
        context = _idle.pop()
    except IndexError:
        context = Context()
    try:
        return context.defocus(color, depth, out=out, **arguments)
    finally:
        if not _idle:
            _idle.append(context)


for _name, _words in parameters.items():
    defocus.__doc__ += _textwrap.fill(f"{_name}: {_words}", 110, initial_indent=" " * 4, subsequent_indent=" " * 8) + "\n"
