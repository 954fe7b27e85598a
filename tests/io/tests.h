// SPDX-License-Identifier: BSD-3-Clause
// The tests of the picture files, by subject.
#ifndef HF_TESTS_IO_TESTS_H
#define HF_TESTS_IO_TESTS_H

#include "io/trip.h"

// Reads and writes all of a file; whatever is in it, nothing may crash. Returns whether all went well.
bool survive(const char *path, const char *target);

void test_single_part_views(void);
void test_parts(void);
void test_names(void);
void test_layers(void);
void test_grow(void);
void test_compressions(void);
void test_unsupported(void);
void test_errors(void);
void full_disk(const char *source, const char *target);
void test_rubbish(const char *path);
void test_huge_header(void);
void test_claims(void);
void test_swapped_chunks(void);
void test_growing(void);
void test_planes(void);
void test_depth_file_sizes(void);
void test_depth_edges(void);
void test_formats(void);
void test_half(void);
void test_half_rows(void);
void test_zip(void);
void test_stages(void);
void test_signals(void);
void test_strays(void);
void test_buffer(void);
void test_shared(void);

#endif
