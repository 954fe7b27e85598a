// SPDX-License-Identifier: BSD-3-Clause
// Pictures through OpenImageIO, behind a C interface that no exception leaves. Part of the helper program.
#include "tools/io/oiio/icc.h"
#include "tools/io/oiio/streams.hpp"

#include <algorithm>
#include <cmath>

#include <strings.h>

struct hf_oiio {
    const char *path;
    ImageSpec spec;
    int colour[4];  // channel indices; -1
    int depth;
    std::unique_ptr<hf_icc> profile;  // of the colours, if it is not sRGB's and can be used
};

namespace
{

int open_input(Input &input, const char *path, hf_io_error *err)
{
    // Alpha as the file has it: what is not premultiplied must be multiplied in linear light, which is our business.
    ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    input.in = ImageInput::open(name_of(path), &config);
    if (!input.in)
        return input.fail(path, err);
    // No pictures, or read by code that writes past its buffers.
    static const char *const refused[] = {"ico", "null", "ffmpeg", "openvdb", "dicom"};
    for (const char *name : refused)
        if (!strcmp(input.in->format_name(), name))
            return hf_io_fail(err, "%s: files of this kind (%s) are not supported", path, name);
    return 0;
}

// The given channel; or Z, depth.Z, any single channel with "depth" in its name. -1: none.
int find_depth(const ImageSpec &spec, const char *given)
{
    if (given)
        return find_channel(spec, given);
    int c = find_channel(spec, "Z"), hits = 0;
    if (c < 0)
        c = find_channel(spec, "depth.Z");
    for (int i = 0, last = -1; i < spec.nchannels && c < 0; i++) {
        if (strcasestr(std::string(spec.channel_name(i)).c_str(), "depth")) {
            hits++;
            last = i;
        }
        if (i == spec.nchannels - 1 && hits == 1)
            return last;
    }
    return c;
}

void find_colour(const ImageSpec &spec, int colour[4])
{
    static const char *const names[4] = {"R", "G", "B", "A"};
    for (int k = 0; k < 4; k++)
        colour[k] = find_channel(spec, names[k]);
    if (colour[0] >= 0 && colour[1] >= 0 && colour[2] >= 0)
        return;
    const int y = find_channel(spec, "Y");
    for (int k = 0; k < 3; k++)
        colour[k] = y >= 0 ? y : spec.nchannels == 1 && spec.z_channel != 0 ? 0 : -1;
    // Formats without channel names number them.
    if (colour[0] < 0 && spec.nchannels >= 3 && spec.channel_name(0).find("channel") == 0)
        for (int k = 0; k < 3; k++)
            colour[k] = k;
}

bool is_integer(TypeDesc t)
{
    return t.basetype >= TypeDesc::UINT8 && t.basetype <= TypeDesc::INT64;
}

double from_srgb(double v)
{
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

float to_srgb(float v)
{
    v = std::isnan(v) ? 0.0f : std::min(std::max(v, 0.0f), 1.0f);
    return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
}

int check_spec(const ImageSpec &spec, const char *path, hf_io_error *err)
{
    const hf_io_box window = {spec.x, spec.y, (int)std::min<int64_t>((int64_t)spec.x + spec.width, INT32_MAX),
                              (int)std::min<int64_t>((int64_t)spec.y + spec.height, INT32_MAX)};
    struct stat st;
    if (spec.deep || spec.depth > 1)
        return hf_io_fail(err, "%s: deep pictures and volumes are not supported", path);
    if (hf_io_check_window(path, "picture", window, err))
        return -1;
    if (spec.nchannels < 1 || spec.nchannels > 1024)
        return hf_io_fail(err, "%s: %d channels are not supported", path, spec.nchannels);
    // Some formats pack a plain colour very well, but nothing justifies gigabytes for a few bytes.
    const uint64_t samples = (uint64_t)spec.width * (uint64_t)spec.height * (uint64_t)spec.nchannels;
    if (fstat(source, &st) == 0 && samples > 1 << 25 && samples / 4096 > (uint64_t)st.st_size)
        return hf_io_fail(err, "%s: truncated or corrupt: %lld bytes cannot hold %d x %d pixels", path,
                          (long long)st.st_size, spec.width, spec.height);
    return 0;
}

bool has_profile(const ImageSpec &spec)
{
    return spec.find_attribute("ICCProfile") &&
           spec.get_string_attribute("ICCProfile:profile_description").find("sRGB") == std::string::npos;
}

// The profile of colours stored as integers, if it is made of curves and a matrix; else none: the colours count as sRGB.
std::unique_ptr<hf_icc> read_profile(const ImageSpec &spec, const int colour[3])
{
    const OIIO::ParamValue *p =
        has_profile(spec) && is_integer(spec.format) ? spec.find_attribute("ICCProfile") : nullptr;
    std::unique_ptr<hf_icc> icc;
    if (!p || colour[0] == colour[1])
        return icc;
    icc.reset(new hf_icc);
    if (hf_icc_read(icc.get(), static_cast<const uint8_t *>(p->data()), (size_t)p->datasize()))
        icc.reset();
    return icc;
}

// The lens of a photograph. The 35 mm equivalent compares diagonals (CIPA DCG-001), so the picture's shape says how wide
// the sensor is.
void fill_exif(struct hf_io_view *v, const ImageSpec &spec)
{
    const float unknown = NAN, focal = spec.get_float_attribute("Exif:FocalLength", unknown);
    const float equivalent = (float)spec.get_int_attribute("Exif:FocalLengthIn35mmFilm");
    const float apex = spec.get_float_attribute("Exif:ApertureValue", unknown);
    const float width = (float)spec.width, height = (float)spec.height;
    v->camera.exif = focal > 0;
    v->camera.focal_length_mm = focal;
    v->camera.f_number =
        spec.get_float_attribute("FNumber", spec.get_float_attribute("Exif:FNumber", std::exp2(apex / 2)));
    if (focal > 0 && equivalent > 0)
        v->camera.sensor_width_mm = std::hypot(36.0f, 24.0f) * focal / equivalent * width / std::hypot(width, height);
}

void fill_view(struct hf_io_view *v, const hf_oiio *o)
{
    const ImageSpec &spec = o->spec;
    const float unknown = NAN;
    v->depth_part = o->depth >= 0 ? 0 : -1;
    for (int k = 0; k < 4; k++)
        if (o->colour[k] >= 0)
            snprintf(v->colour[k], sizeof(v->colour[k]), "%s", spec.channelnames[(size_t)o->colour[k]].c_str());
    if (o->depth >= 0)
        snprintf(v->depth, sizeof(v->depth), "%s", spec.channelnames[(size_t)o->depth].c_str());
    v->width = spec.width;
    v->height = spec.height;
    v->data_window = {spec.x, spec.y, spec.x + spec.width, spec.y + spec.height};
    v->display_window = {spec.full_x, spec.full_y, spec.full_x + spec.full_width, spec.full_y + spec.full_height};
    if (hf_io_check_window("", "", v->display_window, nullptr))
        v->display_window = v->data_window;
    v->pixel_aspect = spec.get_float_attribute("PixelAspectRatio", 1.0f);
    v->screen_width = 1;
    v->camera = {unknown, unknown, unknown, unknown, unknown, {unknown, unknown, unknown, unknown}, false};
    fill_exif(v, spec);
    v->orientation = spec.get_int_attribute("Orientation");
    v->profile = has_profile(spec) && !o->profile;
}

// Channel c of all pixels as floats: integers become 0 .. 1.
int read_channel(Input &input, const hf_oiio *o, int c, float *plane, hf_io_error *err)
{
    if (!input.in->read_image(0, 0, c, c + 1, TypeDesc::FLOAT, plane))
        return input.fail(o->path, err);
    // Half a picture counts as read for some readers (JPEG, TIFF, IFF), who only leave a message.
    const std::string message = input.in->geterror();
    return message.empty() ? 0 : hf_io_fail(err, "%s: truncated or corrupt: %s", o->path, why(message).c_str());
}

void premultiply(float *plane, const float *alpha, size_t n)
{
    for (size_t i = 0; i < n; i++)
        plane[i] *= alpha[i];
}

int read_colour(const hf_oiio *o, float *const planes[4], hf_io_error *err)
{
    const size_t n = (size_t)o->spec.width * (size_t)o->spec.height;
    const bool curve = is_integer(o->spec.format);
    const bool profiled = curve && o->profile && planes[0] && planes[1] && planes[2];
    const bool straight = o->colour[3] >= 0 && o->spec.get_int_attribute("oiio:UnassociatedAlpha") != 0;
    std::vector<float> alpha;
    Input input;
    if (open_input(input, o->path, err))
        return -1;
    if (o->colour[3] >= 0 && (straight || planes[3])) {
        alpha.resize(n);
        if (read_channel(input, o, o->colour[3], alpha.data(), err))
            return -1;
        if (planes[3])
            std::copy(alpha.begin(), alpha.end(), planes[3]);
    }
    for (int k = 0; k < 3; k++) {
        if (!planes[k])
            continue;
        if (k && o->colour[k] == o->colour[0] && planes[0]) {
            std::copy(planes[0], planes[0] + n, planes[k]);
            continue;
        }
        if (read_channel(input, o, o->colour[k], planes[k], err))
            return -1;
        if (curve && !profiled)
            for (size_t i = 0; i < n; i++)
                planes[k][i] = (float)from_srgb(planes[k][i]);
    }
    for (size_t i = 0; i < n && profiled; i++) {
        float rgb[3] = {planes[0][i], planes[1][i], planes[2][i]};
        hf_icc_to_light(o->profile.get(), rgb);
        for (int k = 0; k < 3; k++)
            planes[k][i] = rgb[k];
    }
    for (int k = 0; k < 3 && straight; k++)
        if (planes[k])
            premultiply(planes[k], alpha.data(), n);
    return 0;
}

// The pixel type to ask a format for. Those that hold floats get them, unless the source itself had integers.
TypeDesc output_type(const char *path, int bits)
{
    const char *ext = hf_io_extension(path);
    if (!strcasecmp(ext, "hdr") || !strcasecmp(ext, "rgbe") || !strcasecmp(ext, "pfm") || !strcasecmp(ext, "exr"))
        return TypeDesc::FLOAT;
    if (!strcasecmp(ext, "tif") || !strcasecmp(ext, "tiff"))
        return bits == 8 ? TypeDesc::UINT8 : bits == 16 ? TypeDesc::UINT16 : TypeDesc::FLOAT;
    return bits == 16 ? TypeDesc::UINT16 : TypeDesc::UINT8;
}

// Interleave the planes as the format wants them: for integers with straight alpha, and with the curve of sRGB or as the
// profile says that goes along.
std::vector<float> interleave(const struct hf_io_view *v, const float *const planes[4], const ImageSpec &spec,
                              bool alpha, const hf_icc *profile)
{
    const size_t n = (size_t)v->width * (size_t)v->height, channels = (size_t)spec.nchannels;
    const size_t colours = channels - (alpha ? 1 : 0);
    const bool curve = is_integer(spec.format);
    std::vector<float> pixels(n * channels);
    for (size_t c = 0; c < colours; c++) {
        for (size_t i = 0; i < n; i++) {
            float f = planes[c][i];
            if (curve && alpha && planes[3][i] > 0)
                f /= planes[3][i];
            pixels[i * channels + c] = profile || std::isnan(f) ? (std::isnan(f) ? 0.0f : f) : curve ? to_srgb(f) : f;
        }
    }
    for (size_t i = 0; i < n && profile; i++)
        hf_icc_to_code(profile, &pixels[i * channels]);
    for (size_t i = 0; i < n && alpha; i++)
        pixels[i * channels + colours] = planes[3][i];
    return pixels;
}

// Can the format that path's extension says hold a picture?
int check_format(ImageOutput *out, const char *path, hf_io_error *err)
{
    static const char *const trusted[] = {"bmp",     "dpx", "fits", "gif", "hdr", "heif",  "iff",  "jpeg", "jpeg2000",
                                          "openexr", "png", "pnm",  "rla", "sgi", "targa", "tiff", "webp"};
    OIIO::geterror();
    if (!out && !hf_io_extension(path)[0])
        return hf_io_fail(err, "%s: cannot write: nothing in the name says the format, such as .exr or .png", path);
    if (!out)
        return hf_io_fail(err, "%s: cannot write: OpenImageIO does not know the format \"%s\"", path,
                          hf_io_extension(path));
    for (const char *name : trusted)
        if (!strcmp(name, out->format_name()))
            return 0;
    return hf_io_fail(err, "%s: cannot write: the format \"%s\" holds no whole picture", path, hf_io_extension(path));
}

// What a photograph says of itself goes along: camera, place, time, texts, orientation, colour profile. What says how the
// source's samples are stored does not, nor a small picture of it, which would show what is no longer there.
void take_along(ImageSpec &spec, const char *source, const char *format)
{
    static const char *const stay[] = {"oiio:",         "compression",
                                       "planarconfig",  "thumbnail",
                                       "tiff:",         "png:",
                                       "jpeg:",         "pnm:",
                                       "dpx:",          "ICCProfile:",
                                       "textureformat", "PixelAspectRatio",
                                       "openexr:",      "Exif:ColorSpace",
                                       "Exif:Pixel"};
    // In TIFF they make an EXIF directory, which OpenImageIO 2.4 then links in place of the picture's.
    static const char *const not_in_tiff[] = {"Exif:", "GPS:"};
    const auto begins = [](const std::string &name, const char *with) {
        return !strncasecmp(name.c_str(), with, strlen(with));
    };
    Input input;
    hf_io_error ignored;  // the pixels are at hand: that the source has gone since costs no more than its texts
    if (open_input(input, source, &ignored))
        return;
    for (const OIIO::ParamValue &p : input.in->spec().extra_attribs) {
        const std::string name = p.name().string();
        bool keep = name != "ICCProfile" || is_integer(spec.format);
        for (const char *with : stay)
            keep = keep && !begins(name, with);
        for (const char *with : not_in_tiff)
            keep = keep && !(begins(name, with) && !strcmp(format, "tiff"));
        if (keep)
            spec.extra_attribs.add_or_replace(p);
    }
}

int write_picture(hf_io_bytes *made, const hf_oiio_picture *picture, hf_io_error *err)
{
    const char *path = picture->path;
    const hf_io_view *v = picture->view;
    const float *const *planes = picture->planes;
    Output output(path, err, path);
    if (check_format(output.out.get(), path, err))
        return -1;
    const bool grey = !strcmp(v->colour[0], v->colour[1]);
    const bool alpha = planes[3] && output.out->supports("alpha");
    ImageSpec spec(v->width, v->height, (grey ? 1 : 3) + (alpha ? 1 : 0), output_type(path, picture->bits));
    spec.channelnames.clear();
    for (int c = 0; c < (grey ? 1 : 3); c++)
        spec.channelnames.push_back(grey ? "Y" : std::string(1, "RGB"[c]));
    if (alpha)
        spec.channelnames.push_back("A");
    spec.alpha_channel = alpha ? spec.nchannels - 1 : -1;
    if (picture->source)
        take_along(spec, picture->source, output.out->format_name());
    spec.attribute("PixelAspectRatio", v->pixel_aspect);
    if (alpha && is_integer(spec.format))
        spec.attribute("oiio:UnassociatedAlpha", 1);
    // Not in TIFF: there it makes an EXIF directory, which OpenImageIO 2.4 then links in place of the picture's.
    if (is_integer(spec.format) && strcmp(output.out->format_name(), "tiff"))
        spec.attribute("oiio:ColorSpace", "sRGB");
    if (picture->compression)
        spec.attribute("compression", picture->compression);
    if (hf_io_is_exr_name(path)) {
        spec.x = v->data_window.x0;
        spec.y = v->data_window.y0;
        spec.full_x = v->display_window.x0;
        spec.full_y = v->display_window.y0;
        spec.full_width = v->display_window.x1 - v->display_window.x0;
        spec.full_height = v->display_window.y1 - v->display_window.y0;
    }
    if (output.open(spec))
        return -1;
    // The writer may have settled for another type.
    ImageSpec actual = output.out->spec();
    actual.nchannels = spec.nchannels;
    // Of the formats that are written, these keep a profile.
    static const char *const profiled[] = {"jpeg", "png", "tiff"};
    const int colours[3] = {0, grey ? 0 : 1, 2};
    std::unique_ptr<hf_icc> profile;
    for (const char *name : profiled)
        if (!strcmp(name, output.out->format_name()) && is_integer(actual.format))
            profile = read_profile(spec, colours);
    const std::vector<float> pixels = interleave(v, planes, actual, alpha, profile.get());
    return output.write(TypeDesc::FLOAT, pixels.data(), made);
}

}  // namespace

void hf_oiio_prepare(void)
{
    OIIO::get_string_attribute("format_list");
}

void hf_oiio_use_file(int fd)
{
    source = fd;
}

int hf_oiio_bits(const hf_oiio *o)
{
    const TypeDesc type = o->spec.format;
    return is_integer(type) ? (int)type.basesize() * 8 : 0;
}

void hf_oiio_size(const hf_oiio *o, int *width, int *height)
{
    *width = o->spec.width;
    *height = o->spec.height;
}

int hf_oiio_open(hf_oiio **out, const char *path, const char *depth_channel, hf_io_views *views, hf_io_error *err)
{
    return guarded(path, err, [&] {
        Input input;
        if (open_input(input, path, err) || check_spec(input.in->spec(), path, err))
            return -1;
        OIIO::attribute("threads", 1);
        hf_oiio *o = *out = new hf_oiio{path, input.in->spec(), {-1, -1, -1, -1}, -1, nullptr};
        find_colour(o->spec, o->colour);
        o->profile = read_profile(o->spec, o->colour);
        o->depth = find_depth(o->spec, depth_channel);
        if (o->colour[0] < 0)
            return 0;
        struct hf_io_view *v = hf_io_add_view(views);
        if (!v)
            return hf_io_fail(err, "%s: out of memory", path);
        fill_view(v, o);
        return 0;
    });
}

void hf_oiio_close(hf_oiio *oiio)
{
    delete oiio;
}

void hf_oiio_channels(const hf_oiio *oiio, char *buf, size_t size)
{
    for (const std::string &name : oiio->spec.channelnames)
        hf_io_list(buf, size, nullptr, name.c_str(), "");
}

int hf_oiio_read_colour(hf_oiio *o, float *const planes[4], hf_io_error *err)
{
    return guarded(o->path, err, [&] { return read_colour(o, planes, err); });
}

int hf_oiio_read_depth(hf_oiio *o, float *depth, hf_io_error *err)
{
    return guarded(o->path, err, [&] {
        Input input;
        return open_input(input, o->path, err) ? -1 : read_channel(input, o, o->depth, depth, err);
    });
}

int hf_oiio_read_depth_only(hf_oiio *o, const char *depth_channel, const struct hf_io_view *view, float *depth,
                            hf_io_error *err)
{
    return guarded(o->path, err, [&] {
        const ImageSpec &spec = o->spec;
        int c = find_depth(spec, depth_channel);
        if (c < 0 && !depth_channel)
            c = spec.nchannels == 1 ? 0 : o->colour[0];
        if (c < 0)
            return hf_io_fail(err, "%s: no depth channel %s", o->path, depth_channel ? depth_channel : "Z, *depth*, R");
        if (spec.width != view->width || spec.height != view->height)
            return hf_io_fail(err, "%s: %d x %d pixels, and %d x %d were asked for", o->path, spec.width, spec.height,
                              view->width, view->height);
        Input input;
        return open_input(input, o->path, err) ? -1 : read_channel(input, o, c, depth, err);
    });
}

int hf_oiio_check_format(const char *path, hf_io_error *err)
{
    return guarded(path, err, [&] { return check_format(ImageOutput::create(path).get(), path, err); });
}

int hf_oiio_write(hf_io_bytes *made, const hf_oiio_picture *picture, hf_io_error *err)
{
    return guarded(picture->path, err, [&] { return write_picture(made, picture, err); });
}
