// SPDX-License-Identifier: BSD-3-Clause
// oiio.h for builds without OpenImageIO.
#include "io/oiio.h"

static int absent(const char *path, struct hf_io_error *err)
{
    return hf_io_fail(err,
                      "%s: this build reads and writes only EXR without DWA compression (built without "
                      "OpenImageIO)",
                      path);
}

int hf_io_has_oiio(void)
{
    return 0;
}

int hf_oiio_open(struct hf_io_file *file, const char *depth_channel, struct hf_io_error *err)
{
    (void)depth_channel;
    return absent(file->path, err);
}

void hf_oiio_close(struct hf_oiio *oiio)
{
    (void)oiio;
}

void hf_oiio_channels(const struct hf_oiio *oiio, char *buf, size_t size)
{
    (void)oiio, (void)buf, (void)size;
}

int hf_oiio_read_colour(struct hf_io_file *file, float *planes[4], struct hf_io_error *err)
{
    (void)planes;
    return absent(file->path, err);
}

int hf_oiio_read_depth(struct hf_io_file *file, float *depth, struct hf_io_error *err)
{
    (void)depth;
    return absent(file->path, err);
}

int hf_oiio_read_depth_only(struct hf_io_file *file, const char *depth_channel, const struct hf_io_view *view,
                            float *depth, struct hf_io_error *err)
{
    (void)depth_channel, (void)view, (void)depth;
    return absent(file->path, err);
}

int hf_oiio_write(struct hf_out *out, const struct hf_io_file *source, const struct hf_io_view *view,
                  const float *const planes[4], const char *compression, struct hf_io_error *err)
{
    (void)source, (void)view, (void)planes, (void)compression;
    return absent(out->path, err);
}

int hf_oiio_read_samples(const char *path, int part, struct hf_oiio_samples *s, struct hf_io_error *err)
{
    (void)part, (void)s;
    return absent(path, err);
}

int hf_oiio_write_samples(struct hf_out *out, const struct hf_oiio_samples *s, const char *compression, float level,
                          struct hf_io_error *err)
{
    (void)s, (void)compression, (void)level;
    return absent(out->path, err);
}
