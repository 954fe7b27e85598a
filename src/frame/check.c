// SPDX-License-Identifier: BSD-3-Clause
#include "frame/check.h"

#include <stdio.h>

#include "pixel/depth_rows.h"
#include "pixel/format.h"
#include "pixel/unorm.h"

// Whether a stride is at least as long as a row, upwards or downwards.
static int strides(ptrdiff_t stride, size_t row)
{
    return stride >= (ptrdiff_t)row || stride <= -(ptrdiff_t)row;
}

// columns: pixels of a row that there is memory for.
static int check_image(const struct hf_image *m, const char *name, int columns, struct hf_message *message)
{
    char argument[64];
    if (!m)
        return hf_bad(message, name, "is NULL");
    if (m->width < 1 || m->height < 1 || m->width > HF_MAX_SIZE || m->height > HF_MAX_SIZE)
        return hf_bad(message, name, "is %d x %d pixels; each side must be 1 to %d", m->width, m->height, HF_MAX_SIZE);
    snprintf(argument, sizeof argument, "%s.format", name);
    if (hf_check_value(argument, (int)m->format, 0, HF_FORMAT_COUNT - 1, message))
        return HF_ERR_ARG;
    snprintf(argument, sizeof argument, "%s.transfer", name);
    if (hf_check_value(argument, (int)m->transfer, 0, HF_TRANSFER_SRGB, message))
        return HF_ERR_ARG;
    if (m->transfer != HF_TRANSFER_LINEAR && !hf_unorm(m->format))
        return hf_bad(message, argument, "is sRGB, which only formats of whole numbers can be");
    for (int i = 0; i < hf_plane_count(m); i++) {
        snprintf(argument, sizeof argument, "%s.data[%d]", name, i);
        if (!m->data[i])
            return hf_bad(message, argument, "is NULL");
        snprintf(argument, sizeof argument, "%s.stride[%d]", name, i);
        if (!strides(m->stride[i], hf_row_bytes(m->format, columns)) && m->height > 1)
            return hf_bad(message, argument, "is %lld bytes, less than the %zu of a row", (long long)m->stride[i],
                          hf_row_bytes(m->format, columns));
    }
    return HF_OK;
}

int hf_check_image(const struct hf_image *m, const char *name, struct hf_message *message)
{
    return check_image(m, name, m ? m->width : 0, message);
}

// Check the meaning of depth values, also if there are no values yet.
int hf_check_depth_type(const struct hf_depth *d, struct hf_message *message)
{
    if (!d)
        return hf_bad(message, "depth", "is NULL");
    if (hf_check_value("depth.format", (int)d->format, 0, HF_DEPTH_FORMAT_COUNT - 1, message) ||
        hf_check_value("depth.type", (int)d->type, 0, HF_DEPTH_COC, message))
        return HF_ERR_ARG;
    const int ndc = d->type == HF_DEPTH_NDC_D3D || d->type == HF_DEPTH_NDC_GL || d->type == HF_DEPTH_NDC_REVERSED;
    if (ndc && !(d->near_plane > 0 && d->near_plane < d->far_plane && hf_is_finite(d->near_plane)))
        return hf_bad(message, "depth.near_plane", "is %g and the far plane %g; they must be 0 < near < far",
                      d->near_plane, d->far_plane);
    if (d->type == HF_DEPTH_RAY &&
        !(d->focal_px > 0 && hf_is_finite(d->focal_px) && hf_is_finite(d->center_x) && hf_is_finite(d->center_y)))
        return hf_bad(message, "depth.focal_px", "is %g and the centre (%g, %g); it must be > 0, and all finite",
                      d->focal_px, d->center_x, d->center_y);
    return HF_OK;
}

int hf_check_depth(const struct hf_depth *d, int width, struct hf_message *message)
{
    const int err = hf_check_depth_type(d, message);
    if (err)
        return err;
    if (!d->data)
        return hf_bad(message, "depth.data", "is NULL");
    const size_t row = (size_t)width * hf_depth_bytes(d->format);
    if (!strides(d->stride, row))
        return hf_bad(message, "depth.stride", "is %lld bytes, less than the %zu of a row", (long long)d->stride, row);
    return HF_OK;
}

int hf_check_images(const struct hf_image *dst, const struct hf_image *src, const struct hf_region *region,
                    struct hf_message *message)
{
    // A region that is not valid is reported later.
    const int part = region && dst && region->width > 0 && region->width < dst->width;
    const int columns = part ? region->width : dst ? dst->width : 0;
    if (hf_check_image(src, "src", message) || check_image(dst, "dst", columns, message))
        return HF_ERR_ARG;
    if (src->width != dst->width || src->height != dst->height)
        return hf_bad(message, "dst", "is %d x %d pixels and src %d x %d; both must have the same size", dst->width,
                      dst->height, src->width, src->height);
    return HF_OK;
}
