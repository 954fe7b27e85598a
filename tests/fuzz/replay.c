// SPDX-License-Identifier: BSD-3-Clause
// A target without libFuzzer: runs it on every file of the folders named, so that inputs that once broke it are tried
// everywhere.
//
//     fuzz-NAME FOLDER|FILE...
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

int main(int argc, char **argv)
{
    for (int i = 1; i < argc; i++) {
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
