// SPDX-License-Identifier: BSD-3-Clause
// Tables of keys. The first byte says how to interpolate between them.
#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "tools/cli/keys.h"
#include "fuzz/fuzz.h"

// A column is sorted, and values between two keys lie between theirs, except for roundings of the cubic.
static void check_column(const struct cli_keys *keys, enum cli_key key)
{
    const struct cli_keyed *k = keys->column[key].keys;
    const int n = keys->column[key].count;
    for (int i = 0; i < n; i++) {
        MUST(isfinite(k[i].frame) && isfinite(k[i].value));
        MUST(cli_keys_at(keys, key, k[i].frame) == k[i].value);
        if (!i)
            continue;
        MUST(k[i].frame > k[i - 1].frame);
        const double least = fmin(k[i].value, k[i - 1].value), most = fmax(k[i].value, k[i - 1].value);
        const double slack = 1e-9 * fmax(fabs(least), fabs(most)) + 1e-290;
        for (int part = 1; part < 8; part++) {
            const double at = k[i - 1].frame + (k[i].frame - k[i - 1].frame) * part / 8;
            const double v = cli_keys_at(keys, key, at);
            MUST(v >= least - slack && v <= most + slack);
        }
    }
    if (n) {
        MUST(cli_keys_at(keys, key, -1e12) == k[0].value);
        MUST(cli_keys_at(keys, key, 1e12) == k[n - 1].value);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (!size)
        return 0;
    const int fd = memfd_create("keys", 0);
    MUST(fd >= 0 && write(fd, data + 1, size - 1) == (ssize_t)(size - 1));
    char path[32];
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    struct cli_keys keys;
    struct tool_error error = {""};
    const int status = cli_keys_load(&keys, path, data[0] & 1, &error);
    MUST((status == 0) == (error.text[0] == 0));
    int any = 0;
    for (int c = 0; c < CLI_KEY_COUNT; c++) {
        any |= keys.column[c].count;
        MUST(status == 0 || (!keys.column[c].keys && !keys.column[c].count));
        check_column(&keys, (enum cli_key)c);
    }
    MUST(status != 0 || any);
    MUST(keys.column[CLI_KEY_FOCUS_X].count == keys.column[CLI_KEY_FOCUS_Y].count);
    cli_keys_free(&keys);
    close(fd);
    return 0;
}
