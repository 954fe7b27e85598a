# SPDX-License-Identifier: BSD-3-Clause
"""Render once, refocus for ever: depth of field after the render, from the scene's camera."""
import os
import shutil
import tempfile
import time

import bpy
import numpy as np
from bpy.app.handlers import persistent

from . import exr, lens, render

bl_info = {
    "name": "hyperfocal",
    "author": "the hyperfocal authors",
    "version": (0, 9, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Camera > Depth of Field > hyperfocal",
    "description": "Render once, refocus for ever: depth of field after the render",
    "category": "Render",
}

IMAGE = "hyperfocal"
# A picture that took longer than this comes after a draft, when nothing has changed for REST. Seconds.
PROMPT, REST = 0.15, 0.25
# What the render changed: functions that put it back. The last picture, and what it was defocused with.
_undo = []
_last = {}
_rendering = []  # the scene, while it is rendered


class HyperfocalSettings(bpy.types.PropertyGroup):
    use: bpy.props.BoolProperty(
        name="hyperfocal", default=False,
        description="Render sharp, and blur the picture by the camera's depth of field afterwards")
    quality: bpy.props.EnumProperty(
        name="Quality", default="STANDARD", description="How accurate the blur is, and how slow",
        items=[("DRAFT", "Draft", "The fastest"), ("STANDARD", "Standard", "Close to the best"),
               ("BEST", "Best", "The most accurate")])
    error: bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"})


def active(scene):
    camera = scene.camera
    return camera is not None and camera.type == "CAMERA" and camera.data.hyperfocal.use


def say(scene, sentence):
    if scene.camera and scene.camera.type == "CAMERA":
        scene.camera.data.hyperfocal.error = sentence
    if sentence:
        print(f"hyperfocal: {sentence}", flush=True)


def change(owner, name, value):
    """Set owner.name, and remember to put it back."""
    before = getattr(owner, name)
    if before != value:
        _undo.append(lambda: setattr(owner, name, before))
        setattr(owner, name, value)


def put_back():
    while _undo:
        undo = _undo.pop()
        try:
            undo()
        except ReferenceError:
            pass  # what was changed is deleted


@persistent
def begin(scene, *_):
    end()
    # The clock of files ticks more coarsely than this one.
    _last["begun"] = time.time() - 1
    if not active(scene):
        return
    refused = lens.refusal(scene.camera) or (render.INSTALL if not render.backend() else None)
    say(scene, refused or "")
    if not refused:
        _rendering.append(scene)
        sharpen(scene)


def sharpen(scene):
    # Several cameras may be used in a shot, by markers.
    for camera in {m.camera for m in scene.timeline_markers if m.camera} | {scene.camera}:
        change(camera.data.dof, "use_dof", False)
    for layer in scene.view_layers:
        change(layer, "use_pass_z", True)


def views(scene):
    """The names of the views and the ends of their files' names; one without either where the render is not stereo."""
    if not scene.render.use_multiview:
        return {"": ""}
    names = ("left", "right") if scene.render.views_format == "STEREO_3D" else [v.name for v in scene.render.views]
    return {v.name: v.file_suffix for v in scene.render.views if v.use and v.name in names}


def save_sharp(scene, path):
    """The render with its passes, whatever format the scene's output has: a file for each view."""
    settings, before = scene.render.image_settings, {}
    wanted = {"file_format": "OPEN_EXR_MULTILAYER", "color_depth": "32", "exr_codec": "ZIP"}
    order = ["file_format", "color_mode", "color_depth", "exr_codec"]
    several = scene.render.use_multiview
    if several:
        wanted["views_format"] = "INDIVIDUAL"
        order.append("views_format")
    for name in order:
        before[name] = getattr(settings, name)
    try:
        for name, value in wanted.items():
            setattr(settings, name, value)
        bpy.data.images["Render Result"].save_render(path, scene=scene)
    except RuntimeError:
        # Of several views Blender misses the file without a view's name.
        if not several or not all(os.path.exists(with_suffix(path, end)) for end in views(scene).values()):
            raise
    finally:
        for name in order:
            try:
                setattr(settings, name, before[name])
            except TypeError:
                pass  # a value that this file format does not have was not in use


def with_suffix(path, suffix):
    return suffix.join(os.path.splitext(path)) if suffix else path


def sharp_path():
    """The sharp EXR of the last render. Beside a frame that is written there will be a copy of it."""
    return os.path.join(bpy.app.tempdir, "hyperfocal.exr")


def show(color, suffix=""):
    """The picture in the image 'hyperfocal', for the Image Editor; a view's has the end of its file's name."""
    name = IMAGE + suffix
    height, width = color.shape[:2]
    image = bpy.data.images.get(name)
    if image and tuple(image.size) != (width, height):
        bpy.data.images.remove(image)
        image = None
    image = image or bpy.data.images.new(name, width, height, alpha=True, float_buffer=True)
    image.alpha_mode = "PREMUL"
    # Blender's rows begin at the bottom.
    image.pixels.foreach_set(np.ascontiguousarray(color[::-1], np.float32).ravel())
    image.update()
    return image


def refocus(scene, quick=False):
    """Blur the last render anew by the camera as it is now, all its views. quick: as a draft."""
    given = lens.parameters(scene, scene.camera)
    begun = time.perf_counter()
    for suffix, picture in _last["pictures"].items():
        show(render.defocus(picture, lens.drafted(given) if quick else given, _last["part"]), suffix)
    _last["given"] = given
    if not quick:
        _last["seconds"] = time.perf_counter() - begun


@persistent
def rendered(scene, *_):
    """A frame is rendered (render_post), or rendered and written (render_write, which comes later)."""
    if not active(scene) or lens.refusal(scene.camera) or not render.backend():
        return
    try:
        path = sharp_path()
        for end in views(scene).values():
            old = with_suffix(path, end)
            if os.path.exists(old):
                os.remove(old)
        save_sharp(scene, path)
        _last["part"] = lens.border(scene)
        _last["pictures"] = {end: render.picture(with_suffix(path, end)) for end in views(scene).values()}
        # The camera's own switch is off for the render: what counts is here.
        refocus(scene)
    except (ValueError, OSError, RuntimeError, MemoryError) as error:
        say(scene, str(error))


def written_path(scene, view, suffix):
    """The file that this render wrote, None if there is none: a still has no number in its name, a frame of a shot has."""
    still = bpy.path.abspath(scene.render.filepath) + suffix
    if scene.render.use_file_extension and not still.endswith(scene.render.file_extension):
        still += scene.render.file_extension
    paths = [p for p in (scene.render.frame_path(frame=scene.frame_current, view=view), still)
             if os.path.isfile(p) and os.path.getmtime(p) >= _last.get("begun", 0)]
    return max(paths, key=os.path.getmtime, default=None)


@persistent
def written(scene, *_):
    """Replace the sharp frame, which Blender has just written, at once by the defocused one; that of each view."""
    if not active(scene) or "pictures" not in _last:
        return
    images = {view: bpy.data.images.get(IMAGE + suffix) for view, suffix in views(scene).items()}
    if not all(images.values()):
        return
    if scene.render.use_multiview and scene.render.image_settings.views_format != "INDIVIDUAL":
        path = written_path(scene, "", "")
        if path:
            replace(scene, path, list(views(scene).values()), lambda new: save_together(scene, images, new))
        return
    for view, suffix in views(scene).items():
        path = written_path(scene, view, suffix)
        if path:
            replace(scene, path, [suffix], lambda new, image=images[view]: image.save_render(new, scene=scene))


def replace(scene, path, suffixes, save):
    """Replace a file by what save(path) writes, and keep the sharp pictures beside it."""
    folder, name = os.path.split(path)
    new, alone = os.path.join(folder, ".hyperfocal-" + name), len(suffixes) == 1
    kept = {suffix: os.path.splitext(path)[0] + ("" if alone else suffix) + ".sharp.exr" for suffix in suffixes}
    try:
        for suffix, keep in kept.items():
            shutil.copyfile(with_suffix(sharp_path(), suffix), keep + ".new")
            os.replace(keep + ".new", keep)
        save(new)
        os.replace(new, path)
    except (OSError, RuntimeError) as error:
        say(scene, f"{path}: {error}")
    finally:
        for left in (new, *(keep + ".new" for keep in kept.values())):
            if os.path.exists(left):
                os.remove(left)


def save_together(scene, images, path):
    """All views in one file: the views of an EXR, or Stereo 3D as the output's settings say."""
    if scene.render.image_settings.views_format == "MULTIVIEW":
        render.write_views(path, {view: pixels_of(image) for view, image in images.items()})
        return
    # Blender puts the halves together when the image has both views, and these only a file can give it.
    with tempfile.TemporaryDirectory() as folder:
        for side, image in zip("LR", images.values()):
            exr.write(os.path.join(folder, f"both_{side}.exr"), dict(zip("RGBA", np.moveaxis(pixels_of(image), 2, 0))))
        both = bpy.data.images.load(os.path.join(folder, "both_L.exr"))
        try:
            both.use_multiview, both.views_format = True, "INDIVIDUAL"
            both.filepath = os.path.join(folder, "both.exr")
            both.reload()
            both.save_render(path, scene=scene)
        finally:
            bpy.data.images.remove(both)


def pixels_of(image):
    """(height, width, 4), the top row first."""
    pixels = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(image.size[1], image.size[0], 4)[::-1]


@persistent
def end(*_):
    _rendering.clear()
    put_back()


@persistent
def before_saving(*_):
    """A file that is saved during a render holds the user's camera."""
    put_back()


@persistent
def after_saving(*_):
    for scene in _rendering:
        sharpen(scene)


@persistent
def changed(scene, *_):
    """The camera was turned after a render: refocus."""
    if not _rendering and "pictures" in _last and active(scene) and not lens.refusal(scene.camera):
        if lens.parameters(scene, scene.camera) != _last.get("given") and not bpy.app.timers.is_registered(catch_up):
            bpy.app.timers.register(catch_up, first_interval=0.02)


def catch_up():
    """Follow the camera. Where this machine needs too long, a draft comes first, and the picture when the camera rests."""
    if bpy.app.timers.is_registered(settle):
        bpy.app.timers.unregister(settle)
    slow = _last.get("seconds", 0) > PROMPT
    try_refocus(quick=slow)
    if slow:
        bpy.app.timers.register(settle, first_interval=REST)


def settle():
    try_refocus(quick=False)


def try_refocus(quick):
    scene = bpy.context.scene
    try:
        if active(scene) and "pictures" in _last:
            refocus(scene, quick)
    except (ValueError, RuntimeError) as error:
        say(scene, str(error))


class HYPERFOCAL_OT_refocus(bpy.types.Operator):
    """Blur the last render anew by the camera as it is now"""
    bl_idname = "hyperfocal.refocus"
    bl_label = "Refocus the last render"

    @classmethod
    def poll(cls, context):
        return "pictures" in _last and active(context.scene)

    def execute(self, context):
        refused = lens.refusal(context.scene.camera)
        if refused:
            self.report({"ERROR"}, refused)
            return {"CANCELLED"}
        try:
            refocus(context.scene)
        except (ValueError, RuntimeError, MemoryError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class DATA_PT_hyperfocal(bpy.types.Panel):
    bl_label = "hyperfocal"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "data"
    bl_parent_id = "DATA_PT_camera_dof"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.camera is not None

    def draw_header(self, context):
        self.layout.prop(context.camera.hyperfocal, "use", text="")

    def draw(self, context):
        settings, layout = context.camera.hyperfocal, self.layout
        layout.use_property_split = True
        layout.active = settings.use
        layout.prop(settings, "quality")
        layout.operator(HYPERFOCAL_OT_refocus.bl_idname)
        if not render.backend():
            layout.label(text=render.INSTALL, icon="ERROR")
        elif settings.error:
            layout.label(text=settings.error, icon="ERROR")


CLASSES = (HyperfocalSettings, HYPERFOCAL_OT_refocus, DATA_PT_hyperfocal)
HANDLERS = {"render_init": begin, "render_post": rendered, "render_write": written, "render_complete": end,
            "render_cancel": end, "load_pre": end, "save_pre": before_saving, "save_post": after_saving,
             "depsgraph_update_post": changed}


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Camera.hyperfocal = bpy.props.PointerProperty(type=HyperfocalSettings)
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    put_back()
    for timer in (catch_up, settle):
        if bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(handler)
    del bpy.types.Camera.hyperfocal
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
