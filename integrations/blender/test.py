# SPDX-License-Identifier: BSD-3-Clause
"""The add-on against Cycles' own lens: blender -b --factory-startup --python test.py -- [NAME ...]

Each setting of the camera is rendered by Cycles with its lens, and sharp with the add-on's blur. A lamp's disc must have the same
extent in 36 directions within half a pixel, and a picture must be at least 30 dB from Cycles' own, at a number of samples at
which two of Cycles' pictures with different seeds are 36 dB apart. Names choose settings; `states` chooses the rest alone, and
`time` measures what turning the focus costs."""
import math
import os
import shutil
import sys
import tempfile
import time
import tomllib

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import hyperfocal_dof as addon  # noqa: E402
from hyperfocal_dof import exr, lens, render  # noqa: E402

WIDTH, HEIGHT = 320, 180
passed = failed = 0
folder = tempfile.mkdtemp()


def check(name, ok):
    global passed, failed
    passed, failed = passed + bool(ok), failed + (not ok)
    if not ok:
        print(f"FAILED: {name}", flush=True)


def material(name, color, glow=1.0):
    # It glows: all noise is then that of the lens.
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0, 0, 0, 1)
    shader.inputs["Specular"].default_value = 0
    shader.inputs["Emission"].default_value = (*color, 1)
    shader.inputs["Emission Strength"].default_value = glow
    return made


def thing(make, where, made, **more):
    make(location=where, **more)
    bpy.context.object.data.materials.append(made)
    return bpy.context.object


def scene_with_camera(lamp):
    """A camera at the origin that looks along +y, and either a lamp in the dark or a few bodies."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if not hasattr(bpy.types, "DATA_PT_hyperfocal"):
        addon.register()
    for name, handler in addon.HANDLERS.items():
        if handler not in getattr(bpy.app.handlers, name):
            getattr(bpy.app.handlers, name).append(handler)
    scene = bpy.context.scene
    data = bpy.data.cameras.new("camera")
    camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(camera)
    camera.rotation_euler = (math.pi / 2, 0, 0)
    scene.camera = camera
    data.dof.use_dof = True
    data.dof.focus_distance = 4
    data.dof.aperture_fstop = 0.15
    scene.render.engine = "CYCLES"
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.view_settings.view_transform = "Raw"
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    light = scene.world.node_tree.nodes["Background"].inputs
    light[0].default_value = (0, 0, 0, 1) if lamp else (0.3, 0.35, 0.4, 1)
    scene.cycles.max_bounces = 0
    if lamp:
        thing(bpy.ops.mesh.primitive_uv_sphere_add, (0.3, 12, 0.2), material("lamp", (1, 1, 1), 500.0), radius=0.1)
    else:
        # A wall of soft stripes and bodies whose edges cross it.
        for i in range(-12, 13):
            shade = 0.5 + 0.4 * math.sin(1.1 * i)
            thing(bpy.ops.mesh.primitive_cube_add, (i, 14, 0), material(f"stripe{i}", (shade, 0.8 - 0.5 * shade, 0.4)),
                  scale=(0.5, 0.5, 9))
        thing(bpy.ops.mesh.primitive_uv_sphere_add, (-0.6, 4, -0.2), material("ball", (0.8, 0.2, 0.1)), radius=0.5, segments=64,
              ring_count=32)
        thing(bpy.ops.mesh.primitive_cube_add, (1.2, 6.5, 0.3), material("box", (0.1, 0.3, 0.8)), scale=(0.4, 0.4, 0.4))
    empty = bpy.data.objects.new("target", None)
    empty.location = (0.7, 6, 0.5)
    scene.collection.objects.link(empty)
    return scene


def focus_object(scene):
    scene.camera.data.dof.focus_object = bpy.data.objects["target"]


def vertical_fit(scene):
    scene.camera.data.sensor_fit = "VERTICAL"
    scene.camera.data.sensor_height = 20


def small_scale(scene):
    scene.unit_settings.scale_length = 0.01
    scene.camera.scale = (0.01, 0.01, 0.01)


def shift(scene):
    scene.camera.data.shift_x, scene.camera.data.shift_y = 0.1, -0.05


def ratio(scene):
    scene.camera.data.dof.aperture_ratio = 2


def five_blades(scene):
    scene.camera.data.dof.aperture_blades = 5
    scene.camera.data.dof.aperture_rotation = math.radians(20)


def long_lens(scene):
    scene.camera.data.lens = 65


def f_stop(scene):
    scene.camera.data.dof.aperture_fstop = 0.3


def portrait(scene):
    scene.render.resolution_x, scene.render.resolution_y = HEIGHT, WIDTH


def wide_pixels(scene):
    scene.render.pixel_aspect_x = 1.5


def border(scene):
    scene.render.use_border = scene.render.use_crop_to_border = True
    scene.render.border_min_x, scene.render.border_max_x = 0.2, 0.9
    scene.render.border_min_y, scene.render.border_max_y = 0.1, 0.9


def six_blades_near(scene):
    scene.camera.data.dof.focus_distance = 30
    scene.camera.data.dof.aperture_blades = 6
    scene.camera.data.dof.aperture_rotation = math.radians(-35)


def five_blades_near(scene):
    scene.camera.data.dof.focus_distance = 30
    scene.camera.data.dof.aperture_blades = 5
    scene.camera.data.dof.aperture_rotation = math.radians(20)


SETTINGS = [focus_object, vertical_fit, small_scale, shift, ratio, five_blades, long_lens, f_stop, portrait, wide_pixels, border,
            six_blades_near, five_blades_near]


def render_color(scene, samples, seed, own):
    """Linear colour: own, by Cycles' lens; else sharp and blurred by the add-on."""
    scene.cycles.samples, scene.cycles.seed = samples, seed
    scene.camera.data.hyperfocal.use = not own
    scene.camera.data.dof.use_dof = True
    scene.view_layers[0].use_pass_z = True
    bpy.ops.render.render()
    check("the camera is as before", scene.camera.data.dof.use_dof)
    if not own:
        image = bpy.data.images[addon.IMAGE]
        color = np.empty(image.size[0] * image.size[1] * 4, np.float32)
        image.pixels.foreach_get(color)
        return color.reshape(image.size[1], image.size[0], 4)[::-1, :, :3]
    path = os.path.join(folder, "own.exr")
    addon.save_sharp(scene, path)
    return render.picture(path)[0][..., :3]


def extents(color):
    """How far a disc reaches from its centre in 36 directions: where all but 1 % of the light lies behind, pixels."""
    light = color.mean(axis=2).astype(np.float64)
    y, x = np.indices(light.shape)
    cx, cy = (light * x).sum() / light.sum(), (light * y).sum() / light.sum()
    # A pixel's light lies all over it: 8 x 8 points each, of the pixels with light.
    seen = light > 1e-4 * light.max()
    steps = (np.arange(8) - 3.5) / 8
    sub_y, sub_x = (g.ravel() for g in np.meshgrid(steps, steps, indexing="ij"))
    x, y = (v[seen][:, None] + sub for v, sub in ((x, sub_x), (y, sub_y)))
    light = np.repeat(light[seen], 64)
    found = []
    for angle in np.arange(36) * math.pi / 18:
        along = ((x - cx) * math.cos(angle) + (y - cy) * math.sin(angle)).ravel()
        order = np.argsort(along)
        sums = np.cumsum(light[order]) / light.sum()
        found.append(np.interp(0.99, sums, along[order]))
    return np.array(found), cx, cy


def decibels(a, b):
    def display(c):
        c = np.clip(c, 0, 1)
        return np.where(c <= 0.0031308, 12.92 * c, 1.055 * np.maximum(c, 1e-9) ** (1 / 2.4) - 0.055)
    return -10 * math.log10(np.mean((display(a) - display(b)) ** 2) + 1e-12)


def try_setting(change):
    name = change.__name__
    scene = scene_with_camera(lamp=True)
    change(scene)
    (own, ox, oy), (ours, x, y) = (extents(c) for c in (render_color(scene, 256, 1, True), render_color(scene, 16, 2, False)))
    off = abs(own - ours).max()
    print(f"{name}: disc of {own.min():.2f} to {own.max():.2f} pixels, ours {ours.min():.2f} to {ours.max():.2f}, "
          f"largest difference {off:.2f}, centre {math.hypot(ox - x, oy - y):.2f}", flush=True)
    check(f"{name}: the disc is {off:.2f} pixels off", off <= 0.5 and math.hypot(ox - x, oy - y) <= 0.5 and own.min() > 2)
    scene = scene_with_camera(lamp=False)
    change(scene)
    samples = 16
    first, second = (render_color(scene, samples, seed, True) for seed in (1, 2))
    apart = decibels(first, second)
    ours = decibels(first, render_color(scene, samples, 3, False))
    print(f"{name}: Cycles' own {apart:.1f} dB apart, ours {ours:.1f} dB from it", flush=True)
    check(f"{name}: Cycles' pictures are {apart:.1f} dB apart, too noisy to judge", apart >= 36)
    check(f"{name}: {ours:.1f} dB from Cycles' picture", ours >= 30)


def try_animation():
    """Four frames are rendered and written, defocused; the sharp EXR stays beside each."""
    scene = scene_with_camera(lamp=False)
    scene.cycles.samples = 4
    scene.frame_start, scene.frame_end = 1, 4
    scene.camera.data.hyperfocal.use = True
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = os.path.join(folder, "shot_")
    bpy.ops.render.render(animation=True)
    names = sorted(n for n in os.listdir(folder) if n.startswith("shot_"))
    want = sorted(f"shot_{i:04d}{end}" for i in range(1, 5) for end in (".png", ".sharp.exr"))
    check(f"four frames and their EXRs: {names}", names == want)
    check("nothing else", not [n for n in os.listdir(folder) if n.startswith(".")])
    check("the format is as before", scene.render.image_settings.file_format == "PNG")
    image = bpy.data.images.load(os.path.join(folder, "shot_0004.png"))
    pixels = np.array(image.pixels[:]).reshape(HEIGHT, WIDTH, 4)[::-1, :, :3]
    sharp, depth = render.picture(os.path.join(folder, "shot_0004.sharp.exr"))
    blurred = render.defocus((sharp, depth), lens.parameters(scene, scene.camera))[..., :3]
    # The file has 8 bits a channel, dithered by one step.
    check("the frame is the defocused picture", np.abs(pixels - np.clip(blurred, 0, 1)).max() < 2.5 / 255)
    check("which differs from the sharp one", np.abs(blurred - sharp[..., :3]).max() > 0.1)


def try_stereo():
    """Each view is blurred and written; the other has another picture."""
    scene = scene_with_camera(lamp=False)
    scene.cycles.samples = 4
    scene.camera.data.hyperfocal.use = scene.render.use_multiview = True
    scene.camera.data.stereo.interocular_distance = 0.5
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.filepath = os.path.join(folder, "both")
    bpy.ops.render.render(write_still=True)
    names = sorted(n for n in os.listdir(folder) if n.startswith("both"))
    want = sorted(f"both_{side}{end}" for side in "LR" for end in (".exr", ".sharp.exr"))
    check(f"two views and their EXRs: {names}", names == want)
    check(f"without a word: {scene.camera.data.hyperfocal.error}", not scene.camera.data.hyperfocal.error)
    written = []
    for side in "LR":
        planes = exr.read(os.path.join(folder, f"both_{side}.exr"), lambda name: name in "RGB")
        sharp = render.picture(os.path.join(folder, f"both_{side}.sharp.exr"))
        blurred = render.defocus(sharp, lens.parameters(scene, scene.camera))[..., :3]
        written.append(np.dstack([planes[c] for c in "RGB"]))
        # The file has halves: one rounding to 11 bits.
        check(f"view {side} is the defocused picture", np.allclose(written[-1], blurred, rtol=2.0**-10, atol=2.0**-20))
        check(f"view {side} is not the sharp one", np.abs(blurred - sharp[0][..., :3]).max() > 0.1)
    check("the views differ", np.abs(written[0] - written[1]).max() > 0.1)


def try_together():
    """All views in one file, in each way that Blender has: its own file with the sharp views says what belongs where."""
    ways = [("OPEN_EXR", "MULTIVIEW", ""), ("OPEN_EXR", "STEREO_3D", "SIDEBYSIDE"), ("OPEN_EXR", "STEREO_3D", "TOPBOTTOM"),
            ("OPEN_EXR", "STEREO_3D", "ANAGLYPH"), ("OPEN_EXR", "STEREO_3D", "INTERLACE")]
    for kind, way, mode in ways:
        scene = scene_with_camera(lamp=False)
        scene.cycles.samples = 4
        scene.render.use_multiview = True
        scene.camera.data.hyperfocal.use = True
        scene.camera.data.stereo.interocular_distance = 0.5
        settings = scene.render.image_settings
        settings.file_format, settings.color_depth = kind, "32"
        settings.views_format = way
        if mode:
            settings.stereo_3d_format.display_mode = mode
        scene.render.filepath = os.path.join(folder, f"one{way}{mode}")
        bpy.ops.render.render(write_still=True)
        path = f"{scene.render.filepath}.exr"
        sides = [os.path.join(folder, f"one{way}{mode}_{side}.sharp.exr") for side in "LR"]
        check(f"{way} {mode}: {scene.camera.data.hyperfocal.error}", not scene.camera.data.hyperfocal.error)
        check(f"{way} {mode}: both sharp views are kept", all(os.path.exists(s) for s in sides))
        given = lens.parameters(scene, scene.camera)
        left, right = (render.defocus(render.picture(s), given) for s in sides)
        made = exr.read(path)
        want = {"SIDEBYSIDE": lambda i: np.hstack([left[..., i], right[..., i]]),
                "TOPBOTTOM": lambda i: np.vstack([left[..., i], right[..., i]]),
                "ANAGLYPH": lambda i: (right if i else left)[..., i]}.get(mode)
        if way == "MULTIVIEW":
            same = all(np.array_equal(made[c], left[..., i]) and np.array_equal(made[f"right.{c}"], right[..., i])
                       for i, c in enumerate("RGBA"))
        elif want:
            same = all(made[c].shape == want(i).shape and np.array_equal(made[c], want(i)) for i, c in enumerate("RGB"))
        else:  # every other row is of one view
            even, odd = made["G"][0::2], made["G"][1::2]
            same = any(np.array_equal(even, a[0::2, :, 1]) and np.array_equal(odd, b[1::2, :, 1])
                       for a, b in ((left, right), (right, left)))
        check(f"{way} {mode}: the file has both defocused views", same)
        check(f"{way} {mode}: the views differ", np.abs(left - right).max() > 0.1)
        check(f"{way} {mode}: no other image stays", [i.name for i in bpy.data.images if i.name.startswith("both")] == [])


def try_film():
    """Film transparent, a border, a border that crops, two view layers: the picture is that of the sharp one's colour and depth."""
    def transparent(scene):
        scene.render.film_transparent = True
        for stripe in [o for o in scene.objects if o.dimensions.z > 10]:
            bpy.data.objects.remove(stripe)

    def border(scene):
        scene.render.use_border = True
        scene.render.border_min_x, scene.render.border_max_x = 0.25, 0.75
        scene.render.border_min_y, scene.render.border_max_y = 0.2, 0.9

    def crop(scene):
        border(scene)
        scene.render.use_crop_to_border = True

    def two_layers(scene):
        scene.view_layers.new("Second")

    for change in (transparent, border, crop, two_layers):
        scene = scene_with_camera(lamp=False)
        change(scene)
        scene.cycles.samples = 4
        scene.camera.data.hyperfocal.use = True
        scene.render.image_settings.file_format = "OPEN_EXR"
        scene.render.image_settings.color_mode = "RGBA"
        scene.render.image_settings.color_depth = "32"
        scene.render.filepath = os.path.join(folder, change.__name__)
        bpy.ops.render.render(write_still=True)
        name = change.__name__
        check(f"{name}: {scene.camera.data.hyperfocal.error}", not scene.camera.data.hyperfocal.error)
        made = exr.read(f"{scene.render.filepath}.exr", lambda n: n in "RGBA")
        sharp, depth = render.picture(f"{scene.render.filepath}.sharp.exr")
        part = np.s_[18:144, 80:240] if change is border else np.s_[:, :]
        blurred = sharp.copy()
        blurred[part] = render.defocus((sharp[part], depth[part]), lens.parameters(scene, scene.camera))
        print(f"{name}: {sharp.shape}, alpha {sharp[..., 3].min():.3g} to {sharp[..., 3].max():.3g}, depth {depth.min():.4g} to "
              f"{depth.max():.4g}, blurred by up to {np.abs(blurred - sharp).max():.3g}", flush=True)
        check(f"{name}: the file has the defocused picture", all(np.array_equal(made[c], blurred[..., i]) for i, c in enumerate("RGBA")))
        check(f"{name}: it is not the sharp one", np.abs(blurred - sharp).max() > 0.1)
        check(f"{name}: all is finite", np.isfinite(blurred).all())
        if change is border:
            sharp[part] = 0
            check("border: nothing is rendered beyond it, and nothing blurred", not sharp.any())
        if change is transparent:
            check("transparent: alpha is blurred", ((blurred[..., 3] > 0.01) & (blurred[..., 3] < 0.99)).sum() > 500)


def try_refocus():
    scene = scene_with_camera(lamp=False)
    render_color(scene, 4, 1, False)
    def shown():
        return np.array(bpy.data.images[addon.IMAGE].pixels[:])

    before = shown()
    scene.camera.data.dof.focus_distance = 12
    bpy.context.view_layer.update()
    addon._last["seconds"] = 0
    addon.catch_up()
    after = shown()
    check("turning the focus changes the picture without a render", not np.array_equal(before, after))
    check("and is done", not bpy.app.timers.is_registered(addon.settle))
    # On a slow machine a draft comes first.
    scene.camera.data.dof.focus_distance = 11
    bpy.context.view_layer.update()
    addon._last["seconds"] = 2 * addon.PROMPT
    addon.catch_up()
    draft = shown()
    check("a draft of a slow picture comes first", not np.array_equal(draft, after) and bpy.app.timers.is_registered(addon.settle))
    addon.catch_up()
    addon.settle()
    bpy.app.timers.unregister(addon.settle)
    settled = shown()
    given = lens.parameters(scene, scene.camera)
    check("the picture follows", np.array_equal(settled, render.defocus(addon._last["pictures"][""], given)[::-1].ravel()))
    check("and is another than the draft", not np.array_equal(settled, draft))


def try_manifest():
    """What Blender 4.2 and later ask of an extension's manifest, as their manual lists it."""
    path = os.path.join(os.path.dirname(addon.__file__), "blender_manifest.toml")
    with open(path, "rb") as file:
        manifest = tomllib.load(file)
    wanted = {"schema_version", "id", "version", "name", "tagline", "maintainer", "type", "blender_version_min", "license"}
    check(f"the manifest lacks {wanted - set(manifest)}", wanted <= set(manifest))
    sentences = [manifest["tagline"], *manifest["permissions"].values()]
    check("sentences of at most 64 characters without a full stop", all(0 < len(s) <= 64 and s[-1].isalnum() for s in sentences))
    check("known permissions", set(manifest["permissions"]) <= {"files", "network", "clipboard", "camera", "microphone"})
    check("known kind, tags and licence", manifest["type"] == "add-on" and set(manifest["tags"]) <= {"Render", "Camera"} and
          all(word.startswith("SPDX:") for word in manifest["license"]))
    check("the add-on's version", tuple(int(n) for n in manifest["version"].split(".")) == addon.bl_info["version"])
    check("4.2 or later", tuple(int(n) for n in manifest["blender_version_min"].split(".")) >= (4, 2, 0))


def try_refused():
    scene = scene_with_camera(lamp=False)
    for kind in ("ORTHO", "PANO"):
        scene.camera.data.type = kind
        scene.camera.data.hyperfocal.use = True
        scene.cycles.samples = 1
        bpy.ops.render.render()
        said = scene.camera.data.hyperfocal.error
        check(f"{kind}: {said}", said.count(".") == 1 and kind.lower() in said and scene.camera.data.dof.use_dof)


def state(scene):
    dof = scene.camera.data.dof
    settings = scene.render.image_settings
    return (dof.use_dof, dof.focus_distance, dof.aperture_fstop, scene.view_layers[0].use_pass_z, settings.file_format,
            settings.color_depth, settings.color_mode, scene.render.filepath)


def try_interruptions():
    """A render that ends at ten places: by an error in what the add-on calls, before, within and after it."""
    places = [(render, "picture"), (render, "defocus"), (exr, "read"), (addon, "save_sharp"), (addon, "show"),
              (addon, "refocus"), (lens, "parameters"), (addon, "sharp_path"), (shutil, "copyfile"), (os, "replace")]
    for owner, name in places:
        scene = scene_with_camera(lamp=False)
        scene.cycles.samples = 1
        scene.camera.data.hyperfocal.use = True
        scene.render.filepath = os.path.join(folder, "stopped")
        scene.render.image_settings.file_format = "PNG"
        before, files = state(scene), set(os.listdir(folder))
        whole = getattr(owner, name)

        def stop(*_, **__):
            raise OSError(f"stopped in {name}")

        setattr(owner, name, stop)
        try:
            bpy.ops.render.render(write_still=True)
        except RuntimeError:
            pass
        finally:
            setattr(owner, name, whole)
        check(f"stopped in {name}: {before} became {state(scene)}", before == state(scene))
        check(f"stopped in {name}: it says so", f"stopped in {name}" in scene.camera.data.hyperfocal.error)
        left = {n for n in set(os.listdir(folder)) - files if n not in ("stopped.png", "stopped.sharp.exr")}
        check(f"stopped in {name}: {left} is left", not left)


def time_refocus():
    """No test: what turning the focus costs at 1920 x 1080, on an idle machine."""
    scene = scene_with_camera(lamp=False)
    scene.render.resolution_x, scene.render.resolution_y = 1920, 1080
    render_color(scene, 1, 1, False)
    spent = {"all": [], "defocus": [], "show": []}
    for i in range(11):
        scene.camera.data.dof.focus_distance = 4 + 0.1 * i
        at = [time.perf_counter()]
        given = lens.parameters(scene, scene.camera)
        color = render.defocus(addon._last["pictures"][""], given)
        at.append(time.perf_counter())
        addon.show(color)
        at.append(time.perf_counter())
        for name, seconds in zip(spent, (at[2] - at[0], at[1] - at[0], at[2] - at[1])):
            spent[name].append(1000 * seconds)
    print("refocus, 1920 x 1080:", ", ".join(f"{n} {np.median(v):.1f} ms" for n, v in spent.items()), flush=True)


names = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
try:
    print(f"hyperfocal by its {render.backend()}, Blender {bpy.app.version_string}", flush=True)
    for setting in SETTINGS:
        if not names or setting.__name__ in names:
            try_setting(setting)
    if "time" in names:
        time_refocus()
    if not names or "states" in names:
        for rest in (try_animation, try_stereo, try_together, try_film, try_refocus, try_manifest, try_refused, try_interruptions):
            rest()
except Exception as error:  # Blender would go on without a word
    import traceback
    traceback.print_exc()
    check(f"an exception: {error}", False)
shutil.rmtree(folder)
print(f"{passed} passed, {failed} failed", flush=True)
os._exit(failed > 0 or not passed)
