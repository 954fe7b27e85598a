// SPDX-License-Identifier: BSD-3-Clause
// oiio.h for builds without OpenImageIO.
#include "io/oiio/oiio.h"

static int absent(const char *path, struct hf_io_error *err)
{
    return hf_io_fail(err,
                      "%s: this build reads and writes only EXR without DWA compression (built without "
                      "OpenImageIO)",
                      path);
}

int hf_oiio_available(void)
{
    return 0;
}

int hf_oiio_open(struct hf_oiio **out, const char *path, const char *depth_channel, struct hf_io_views *views,
                 struct hf_io_error *err)
{
    (void)depth_channel, (void)views;
    *out = NULL;
    return absent(path, err);
}

void hf_oiio_close(struct hf_oiio *oiio)
{
    (void)oiio;
}

void hf_oiio_channels(const struct hf_oiio *oiio, char *buf, size_t size)
{
    (void)oiio, (void)buf, (void)size;
}

int hf_oiio_read_colour(struct hf_oiio *oiio, float *const planes[4], struct hf_io_error *err)
{
    (void)oiio, (void)planes;
    return absent("", err);
}

int hf_oiio_read_depth(struct hf_oiio *oiio, float *depth, struct hf_io_error *err)
{
    (void)oiio, (void)depth;
    return absent("", err);
}

int hf_oiio_read_depth_only(struct hf_oiio *oiio, const char *depth_channel, const struct hf_io_view *view,
                            float *depth, struct hf_io_error *err)
{
    (void)oiio, (void)depth_channel, (void)view, (void)depth;
    return absent("", err);
}

int hf_oiio_write(struct hf_out *out, const struct hf_oiio *source, const struct hf_io_view *view,
                  const float *const planes[4], const char *compression, struct hf_io_error *err)
{
    (void)source, (void)view, (void)planes, (void)compression;
    return absent(out->path, err);
}

int hf_oiio_read_samples(const char *path, int part, struct hf_io_samples *s, struct hf_io_error *err)
{
    (void)part, (void)s;
    return absent(path, err);
}

int hf_oiio_write_samples(struct hf_out *out, const struct hf_io_samples *s, const char *compression, float level,
                          struct hf_io_error *err)
{
    (void)s, (void)compression, (void)level;
    return absent(out->path, err);
}
