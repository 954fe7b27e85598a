# SPDX-License-Identifier: BSD-3-Clause
"""The scene's camera as hyperfocal's parameters: the lens that Cycles has."""
import math

import numpy as np


def refusal(camera):
    """Why this camera cannot be used, as one sentence; None if it can."""
    if camera is None:
        return "The scene has no camera."
    if camera.type != "CAMERA" or camera.data.type != "PERSP":
        kind = camera.data.type.lower() if camera.type == "CAMERA" else camera.type.lower()
        return f"hyperfocal needs a perspective camera; {camera.name} is of type {kind}."
    return None


def focus(camera):
    """The distance in focus along the camera's axis, scene units."""
    dof = camera.data.dof
    if not dof.focus_object:
        return dof.focus_distance
    target = dof.focus_object.matrix_world
    bone = dof.focus_object.pose.bones.get(dof.focus_subtarget) if dof.focus_object.pose and dof.focus_subtarget else None
    if bone:
        target = target @ bone.matrix
    axis = camera.matrix_world.to_3x3().normalized().col[2]
    return abs(axis.dot(target.translation - camera.matrix_world.translation))


def size(scene):
    """Width and height of the whole picture in pixels, a border's too."""
    render = scene.render
    return (int(render.resolution_x * render.resolution_percentage / 100),
            int(render.resolution_y * render.resolution_percentage / 100))


def border(scene):
    """The rows and columns of the picture that are rendered, counted from the top left; None: all that the picture has."""
    render = scene.render
    if not render.use_border or render.use_crop_to_border:
        return None
    width, height = size(scene)

    def pixel(part, pixels):
        return int(np.float32(part) * np.float32(pixels))  # as Blender rounds

    return (slice(height - pixel(render.border_max_y, height), height - pixel(render.border_min_y, height)),
            slice(pixel(render.border_min_x, width), pixel(render.border_max_x, width)))


def sensor_width(scene, data):
    """Of the part of the sensor that the whole picture's width shows, mm."""
    width, height = size(scene)
    wide, high = width * scene.render.pixel_aspect_x, height * scene.render.pixel_aspect_y
    if data.sensor_fit == "VERTICAL":
        return data.sensor_height * wide / high
    if data.sensor_fit == "AUTO" and wide < high:
        return data.sensor_width * wide / high
    return data.sensor_width


def parameters(scene, camera):
    """Keyword arguments of hyperfocal.defocus for a picture of this camera."""
    data, dof = camera.data, camera.data.dof
    width, height = size(scene)
    blades = dof.aperture_blades if dof.aperture_blades >= 3 else 0
    given = {
        "focus": max(focus(camera), 1e-5),
        "f_number": max(dof.aperture_fstop, 1e-5),
        "focal_length": data.lens,
        "sensor_width": sensor_width(scene, data),
        "pixel_aspect": scene.render.pixel_aspect_x / scene.render.pixel_aspect_y,
        "display_width": width,
        "display_height": height,
        # Cycles turns the aperture as seen from behind the camera, y upwards.
        "blades": min(blades, 16),
        "rotation": -math.degrees(dof.aperture_rotation) if blades else 0.0,
        "squeeze": min(max(dof.aperture_ratio, 0.25), 4),
    }
    if data.hyperfocal.quality == "BEST":
        given["quality"] = "best"
    return drafted(given) if data.hyperfocal.quality == "DRAFT" else given


def drafted(given):
    """The same parameters for the fastest picture."""
    kept = {name: value for name, value in given.items() if name not in ("quality", "engine")}
    return dict(kept, **({"engine": "gather"} if given["squeeze"] == 1 else {"quality": "draft"}))


OPTIONS = {"focus": "focus", "f_number": "fstop", "focal_length": "focal-length", "sensor_width": "sensor-width",
           "quality": "quality", "engine": "engine", "squeeze": "squeeze"}


def options(given):
    """The same for the command. The picture's own size and aspect are in its header, except a border's."""
    words = []
    for name, option in OPTIONS.items():
        if name in given and not (name == "squeeze" and given[name] == 1):
            words += [f"--{option}", str(given[name])]
    if given["blades"]:
        words += ["--aperture", f"ngon:{given['blades']}:0:{given['rotation']}"]
    return words
