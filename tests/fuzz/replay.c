// SPDX-License-Identifier: BSD-3-Clause
// A target without libFuzzer: runs it on every file of the folders named, so that inputs that once broke it are tried
// everywhere, and on bytes made up, as often as is said.
//
//     fuzz-NAME [--random COUNT [SEED]] [FOLDER|FILE...]
#include <dirent.h>
#include <string.h>

#include "fuzz/fuzz.h"
#include "support/check.h"

static void run_file(const char *path)
{
    FILE *f = fopen(path, "rb");
    if (!CHECK_MSG(f != NULL, "%s cannot be read", path))
        return;
    static uint8_t data[1 << 20];
    const size_t size = fread(data, 1, sizeof data, f);
    fclose(f);
    uint8_t *exact = malloc(size ? size : 1);  // so that reading past the end is noticed
    memcpy(exact, data, size);
    CHECK_MSG(LLVMFuzzerTestOneInput(exact, size) == 0, "%s", path);
    free(exact);
}

// Half of them avoid the ends of a byte's range, where targets keep what is rare: then more is accepted.
static void run_random(long count, uint32_t seed)
{
    static uint8_t data[512];
    for (long i = 0; i < count; i++) {
        uint32_t state = seed + (uint32_t)i * 2654435761u;
        const uint32_t calm = i % 4 == 0 ? 1 : i % 4 == 1 ? 16 : 256;
        for (size_t k = 0; k < sizeof data; k++) {
            state = state * 1664525u + 1013904223u;
            const uint32_t bits = state >> 8;
            data[k] = (uint8_t)(k > 1 && bits % calm ? 60 + (bits >> 8) % 195 : bits >> 8);
        }
        if (LLVMFuzzerTestOneInput(data, sizeof data))
            CHECK_MSG(0, "seed %u", seed + (uint32_t)i);
    }
    printf("%ld made up from %u on\n", count, seed);
    CHECK(count > 0);
}

int main(int argc, char **argv)
{
    int first = 1;
    if (argc > 2 && !strcmp(argv[1], "--random")) {
        const int seeded = argc > 3 && argv[3][0] >= '0' && argv[3][0] <= '9';
        run_random(strtol(argv[2], NULL, 10), seeded ? (uint32_t)strtoul(argv[3], NULL, 10) : 1);
        first = seeded ? 4 : 3;
    }
    for (int i = first; i < argc; i++) {
        DIR *folder = opendir(argv[i]);
        if (!folder) {
            run_file(argv[i]);
            continue;
        }
        for (const struct dirent *e; (e = readdir(folder));) {
            char path[4096];
            snprintf(path, sizeof path, "%s/%s", argv[i], e->d_name);
            if (e->d_name[0] != '.')
                run_file(path);
        }
        closedir(folder);
    }
    return check_report();
}
