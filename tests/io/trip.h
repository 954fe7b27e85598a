// SPDX-License-Identifier: BSD-3-Clause
// Opens a file, gives it new colours, and checks the result.
#ifndef HF_TESTS_IO_TRIP_H
#define HF_TESTS_IO_TRIP_H

#include "io/files.h"

extern struct hf_io_run threads;  // the threads that round trips run on

struct planes {
    float *p[4];
};

struct planes make_planes(const struct hf_io_view *v, int *too_large);
void free_planes(struct planes *planes);
// Write new colours for all views of a file, and check that nothing else changed.
void round_trip(const char *path, const char *compression, bool half, bool exact);
struct part usual_part(exr_storage_t storage, exr_compression_t compression, exr_lineorder_t order);
struct hf_io_file *open_or_complain(const char *path, const char *depth, int views);
void check_view(const struct hf_io_file *f, int i, const char *name, int part, const char *red, int depth_part,
                const char *depth);
int rewrite(const char *path, const char *target, struct hf_io_error *err);
void expect_error(int status, const struct hf_io_error *err, const char *part);

#endif
