// SPDX-License-Identifier: BSD-3-Clause
// EXR parts that the program itself cannot decode or encode, as DWA: their samples as they are, through OpenImageIO.
#include "tools/io/oiio/streams.hpp"

namespace
{

const TypeDesc exr_types[3] = {TypeDesc::UINT32, TypeDesc::HALF, TypeDesc::FLOAT};

size_t type_bytes(int type)
{
    return type == 1 ? 2 : 4;
}

template <size_t bytes> void copy_each(uint8_t *to, size_t to_step, const uint8_t *from, size_t from_step, int n)
{
    for (int i = 0; i < n; i++)
        memcpy(to + (size_t)i * to_step, from + (size_t)i * from_step, bytes);
}

// Between OpenEXR's rows of channels and OpenImageIO's pixels of channels: one channel of one row.
void copy_strided(uint8_t *to, size_t to_step, const uint8_t *from, size_t from_step, size_t bytes, int n)
{
    if (bytes == 2)
        copy_each<2>(to, to_step, from, from_step, n);
    else
        copy_each<4>(to, to_step, from, from_step, n);
}

// Memory for all pixels, which is not cleared.
std::unique_ptr<uint8_t[], decltype(&free)> pixels_of(size_t step, const hf_io_samples *s)
{
    auto *const pixels = (uint8_t *)hf_io_alloc(step * (size_t)s->width * (size_t)s->height + 1);
    if (!pixels)
        throw std::bad_alloc();
    return {pixels, free};
}

void set_threads(const hf_io_samples *s)
{
    OIIO::attribute("threads", s->threads);
    OIIO::attribute("exr_threads", s->threads > 1 ? s->threads : s->threads == 1 ? -1 : 0);
}

int read_samples(const char *path, int part, hf_io_samples *s, hf_io_error *err)
{
    set_threads(s);
    Input input;
    input.in = ImageInput::create("openexr");
    ImageSpec spec;
    if (!input.in || !input.in->open(name_of(path), spec) || !input.in->seek_subimage(part, 0))
        return input.fail(path, err);
    spec = input.in->spec();
    if (spec.width != s->width || spec.height != s->height || spec.deep)
        return hf_io_fail(err, "%s: truncated or corrupt: OpenImageIO finds %d x %d pixels in part %d, not %d x %d",
                          path, spec.width, spec.height, part, s->width, s->height);
    const size_t step = spec.pixel_bytes(true);
    const auto pixels = pixels_of(step, s);
    if (!input.in->read_image(part, 0, 0, spec.nchannels, TypeDesc::UNKNOWN, pixels.get()))
        return input.fail(path, err);
    size_t at = 0;
    for (int c = 0; c < s->channel_count; c++) {
        const int from = find_channel(spec, s->names[c]);
        const size_t bytes = type_bytes(s->types[c]);
        if (from < 0 || spec.channelformat(from) != exr_types[s->types[c]])
            return hf_io_fail(err, "%s: OpenImageIO does not give channel %s of part %d as it is", path, s->names[c],
                              part);
        const size_t offset = spec.pixel_bytes(0, from, true);
        for (int y = 0; y < s->height; y++)
            copy_strided(s->data + (size_t)y * s->row_bytes + at, bytes,
                         pixels.get() + (size_t)y * (size_t)s->width * step + offset, step, bytes, s->width);
        at += bytes * (size_t)s->width;
    }
    return 0;
}

ImageSpec samples_spec(const hf_io_samples *s, const char *compression, float level)
{
    ImageSpec spec(s->width, s->height, s->channel_count, exr_types[s->types[0]]);
    spec.x = spec.full_x = s->x;
    spec.y = spec.full_y = s->y;
    spec.channelnames.assign(s->names, s->names + s->channel_count);
    for (int c = 0; c < s->channel_count; c++)
        spec.channelformats.push_back(exr_types[s->types[c]]);
    spec.tile_width = s->tile_width;
    spec.tile_height = s->tile_height;
    spec.tile_depth = s->tile_width ? 1 : 0;
    spec.attribute("compression", level > 0 ? compression + (":" + std::to_string(level)) : std::string(compression));
    return spec;
}

int write_samples(hf_io_bytes *made, const char *path, const hf_io_samples *s, const char *compression, float level,
                  hf_io_error *err)
{
    set_threads(s);
    Output output(path, err, "openexr");
    const ImageSpec spec = samples_spec(s, compression, level);
    size_t step = 0, at = 0, offset = 0;
    for (int c = 0; c < s->channel_count; c++)
        step += type_bytes(s->types[c]);
    const auto pixels = pixels_of(step, s);
    for (int c = 0; c < s->channel_count; c++) {
        const size_t bytes = type_bytes(s->types[c]);
        for (int y = 0; y < s->height; y++)
            copy_strided(pixels.get() + (size_t)y * (size_t)s->width * step + offset, step,
                         s->data + (size_t)y * s->row_bytes + at, bytes, bytes, s->width);
        offset += bytes;
        at += bytes * (size_t)s->width;
    }
    return output.open(spec) ? -1 : output.write(TypeDesc::UNKNOWN, pixels.get(), made);
}

}  // namespace

int hf_oiio_read_samples(const char *path, int part, hf_io_samples *s, hf_io_error *err)
{
    return guarded(path, err, [&] { return read_samples(path, part, s, err); });
}

int hf_oiio_write_samples(hf_io_bytes *made, const char *path, const hf_io_samples *s, const char *compression,
                          float level, hf_io_error *err)
{
    return guarded(path, err, [&] { return write_samples(made, path, s, compression, level, err); });
}
