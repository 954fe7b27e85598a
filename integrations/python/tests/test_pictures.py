# SPDX-License-Identifier: BSD-3-Clause
"""Every array gives the picture that its samples mean, whatever its type, its strides and its order."""
import subprocess

import numpy as np
import pytest

import exr
import hyperfocal

LENS = {"focus": 10, "f_number": 0.5, "focal_length": 100}


def expected(color, depth, **more):
    return hyperfocal.defocus(np.ascontiguousarray(color), np.ascontiguousarray(depth), **LENS, **more)


@pytest.mark.parametrize("opaque", [True, False])
def test_command_writes_the_same_bits(scene, command, tmp_path, opaque):
    color, depth = scene
    color[..., 3] = 1 if opaque else depth / 20
    before, after = tmp_path / "in.exr", tmp_path / "out.exr"
    exr.write(before, dict(zip("RGBA", np.moveaxis(color, 2, 0)), Z=depth))
    subprocess.run([command, before, "-o", after, "--focus", "10", "--fstop", "0.5", "--focal-length", "100"], check=True)
    written = exr.read(after)
    result = hyperfocal.defocus(color, depth, **LENS)
    for c, name in enumerate("RGBA"):
        assert np.array_equal(result[..., c], written[name])
    planes = hyperfocal.defocus(tuple(np.ascontiguousarray(color[..., c]) for c in range(4)), depth, **LENS)
    assert all(np.array_equal(planes[c], written[n]) for c, n in enumerate("RGBA"))
    assert not np.array_equal(result, color)


@pytest.mark.parametrize("quality", ["draft", "best"])
def test_command_and_quality(scene, command, tmp_path, quality):
    color, depth = scene
    before, after = tmp_path / "in.exr", tmp_path / "out.exr"
    exr.write(before, dict(zip("RGB", np.moveaxis(color[..., :3], 2, 0)), Z=depth))
    subprocess.run([command, before, "-o", after, "--focus", "10", "--range", "5", "--quality", quality], check=True)
    result = hyperfocal.defocus(color[..., :3], depth, focus=10, distance=5, quality=quality)
    assert np.array_equal(result, np.dstack([exr.read(after)[n] for n in "RGB"]))
    settings, cost = hyperfocal.choose_quality(48, quality=quality)
    assert np.array_equal(result, hyperfocal.defocus(color[..., :3], depth, focus=10, distance=5, **settings))
    assert cost["ms"] > 0 and 0 < cost["error"] < 1


@pytest.mark.parametrize("type", ["float32", "float16", "uint8", "uint16"])
@pytest.mark.parametrize("channels", [3, 4])
@pytest.mark.parametrize("how", ["C", "F", "planar", "step", "upside down", "mirrored", "foreign", "unaligned"])
def test_any_order(scene, type, channels, how):
    color, depth = scene
    color = color[..., :channels]
    plain = (color * 60).astype(type) if type.startswith("u") else color.astype(type)
    want = expected(plain, depth)
    if how == "C":
        given = plain.copy()
    elif how == "F":
        given = np.asfortranarray(plain)
    elif how == "planar":
        given = np.moveaxis(np.ascontiguousarray(np.moveaxis(plain, 2, 0)), 0, 2)
    elif how == "step":
        wide = np.zeros((96, 192, 5), type)
        given = wide[::2, ::3, 1:1 + channels]
        given[...] = plain
    elif how == "upside down":
        given = plain[::-1].copy()[::-1]
    elif how == "mirrored":
        given = plain[:, ::-1].copy()[:, ::-1]
    elif how == "foreign":
        given = plain.astype(plain.dtype.newbyteorder())
    else:
        given = np.frombuffer(b"x" + plain.tobytes(), plain.dtype, offset=1).reshape(plain.shape)
    before = given.copy()
    result = hyperfocal.defocus(given, depth, **LENS)
    assert result.dtype == given.dtype and result.shape == given.shape
    assert np.array_equal(result, want) and np.array_equal(given, before)
    out = np.zeros((50, 70, channels), type)[1:-1, 3:-3] if how != "foreign" else np.zeros_like(given)
    assert hyperfocal.defocus(given, depth, out=out, **LENS) is out
    assert np.array_equal(out, want)
    if given.flags.writeable:
        hyperfocal.defocus(given, depth, out=given, **LENS)
        assert np.array_equal(given, want)


@pytest.mark.parametrize("type", ["float32", "float16", ">f4", "<f2"])
def test_depth_types(scene, type):
    color, depth = scene
    want = hyperfocal.defocus(color, depth.astype(type).astype("float32"), **LENS)
    assert np.array_equal(want, hyperfocal.defocus(color, depth.astype(type), **LENS))
    assert np.array_equal(want, hyperfocal.defocus(color, np.asfortranarray(depth.astype(type)), **LENS))
    assert np.array_equal(want, hyperfocal.defocus(color, depth.astype(type)[..., None], **LENS))


@pytest.mark.parametrize("type", ["uint16", "uint32"])
def test_whole_depth(scene, type):
    color, depth = scene
    largest = np.iinfo(type).max
    stored = (1 / depth * largest).astype(type)
    result = hyperfocal.defocus(color, stored, depth_type="inverse", **LENS)
    near = hyperfocal.defocus(color, (stored / largest).astype("float32"), depth_type="inverse", **LENS)
    # Both are the nearest float of a quotient: the same depth.
    assert np.array_equal(result, near)


def test_read_only_and_kept(scene):
    color, depth = scene
    color.flags.writeable = depth.flags.writeable = False
    result = hyperfocal.defocus(color, depth, **LENS)
    assert result.flags.writeable
    with pytest.raises(ValueError, match="out is read-only"):
        hyperfocal.defocus(color, depth, out=color, **LENS)


def test_out_beside_color(scene):
    color, depth = scene
    want = expected(color, depth)
    wide = np.zeros((49, 64, 4), np.float32)
    wide[1:] = color
    hyperfocal.defocus(wide[1:], depth, out=wide[:-1], **LENS)
    assert np.array_equal(wide[:-1], want)
    strange = np.zeros((48, 64, 1), np.float32).repeat(4, 2)
    strange[..., 0] = depth
    hyperfocal.defocus(color, strange[..., 0], out=strange, **LENS)
    assert np.array_equal(strange, want)


def test_formats_may_differ(scene):
    color, depth = scene
    half = np.zeros((48, 64, 3), np.float16)
    hyperfocal.defocus(color, depth, out=half, **LENS)
    # One rounding to 11 bits.
    assert np.allclose(half, expected(color, depth)[..., :3], rtol=2.0**-11, atol=2.0**-24)


def test_without_numpy(scene):
    color, depth = scene
    want = expected(color, depth)
    view = memoryview(bytearray(color.tobytes())).cast("B").cast("f", [48, 64, 4])
    result = hyperfocal.defocus(view, memoryview(depth.tobytes()).cast("f", [48, 64]), **LENS)
    assert isinstance(result, memoryview) and np.array_equal(np.asarray(result), want)


def test_radii_are_those_of_the_report(scene):
    color, depth = scene
    with hyperfocal.Context(threads=1) as context:
        for settings in (LENS, {"focus": 10, "distance": 4}):
            context.defocus(color, depth, **settings)
            radii = hyperfocal.coc(depth, **settings)
            assert radii.dtype == np.float32 and radii.shape == depth.shape
            # The library's plan finds the radii from the same formula with one more rounding.
            assert -radii.min() == pytest.approx(context.report["near_radius"], rel=1e-6)
            assert radii.max() == pytest.approx(context.report["far_radius"], rel=1e-6)
            assert np.all(radii[36:] == 0)
    coc = hyperfocal.coc(depth - 10, depth_type="coc")
    assert np.array_equal(coc, depth - 10)


def test_aperture(scene):
    color, depth = scene
    disc = np.ones((32, 32, 3), np.float32)
    square = hyperfocal.defocus(color, depth, aperture=disc, **LENS)
    assert not np.array_equal(square, expected(color, depth))
    assert np.array_equal(square, hyperfocal.defocus(color, depth, aperture=disc[::-1, ::-1], **LENS))
