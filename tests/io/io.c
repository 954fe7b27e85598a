// SPDX-License-Identifier: BSD-3-Clause
// The programs' picture files. The test makes small EXR files with OpenEXRCore, sends them through hf_io_write, and
// compares output and input channel by channel and byte by byte; then it tries random bytes. With HF_SHARED=DIR it also
// tries the stereo pictures in DIR/images/beachball; HF_SEED=N changes the random bytes.
#include <stdlib.h>

#include "io/tests.h"

int main(void)
{
    // In memory if possible: every written file is synced, which takes a disk a while.
    char memory[] = "/dev/shm/hyperfocal-io-XXXXXX", disk[] = "/tmp/hyperfocal-io-XXXXXX", command[100];
    folder = mkdtemp(memory);
    if (!folder)
        folder = mkdtemp(disk);
    if (!folder)
        return CHECK_SKIP;
    if (getenv("HF_SEED"))
        seed = strtoull(getenv("HF_SEED"), NULL, 0);
    printf("seed %llu\n", (unsigned long long)seed);
    if (hf_io_threads_open(&threads, 3))
        return CHECK_SKIP;
    test_half();
    test_half_rows();
    test_zip();
    test_stages();
    test_compressions();
    test_single_part_views();
    test_parts();
    test_names();
    test_layers();
    test_grow();
    test_unsupported();
    test_errors();
    full_disk(in_folder("views.exr"), in_folder("full.exr"));
    test_huge_header();
    test_claims();
    test_swapped_chunks();
    test_growing();
    test_planes();
    test_depth_file_sizes();
    test_depth_edges();
    test_formats();
    test_signals();
    test_strays();
    test_buffer();
    test_rubbish(in_folder("views.exr"));
    test_rubbish(in_folder("parts.exr"));
    test_rubbish(in_folder("odd.exr"));
    test_shared();
    snprintf(command, sizeof(command), "rm -rf %s", folder);
    if (system(command))
        printf("cannot remove %s\n", folder);
    hf_io_threads_close(&threads);
    return check_report();
}
