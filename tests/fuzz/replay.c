// SPDX-License-Identifier: BSD-3-Clause
// Runs a fuzz target without libFuzzer: on every file of the given folders, so that inputs that once broke it are tried
// everywhere, and on random bytes, as often as asked.
//
//     fuzz-NAME [--random COUNT [SEED]] [FOLDER|FILE...]
#include <dirent.h>
#include <signal.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include "fuzz/fuzz.h"
#include "support/check.h"

// The current input, printed if it crashes or takes longer than this, in seconds of processor time.
enum { MOST_SECONDS = 30 };
static char now[4200];

static void say_which(int signal_number)
{
    static const char slow[] = "takes too long: ";
    if (signal_number == SIGPROF && write(2, slow, sizeof slow - 1) < 0)
        _exit(1);
    if (write(2, now, strlen(now)) < 0)
        _exit(1);
    signal(SIGABRT, SIG_DFL);
    abort();
}

static void watch(void)
{
#ifdef ADDRESS_SANITIZER
    static const int signals[] = {SIGABRT, SIGPROF};  // targets have handlers of their own for the others
#else
    static const int signals[] = {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGPROF};
#endif
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        signal(signals[i], say_which);
}

static int try_bytes(const uint8_t *data, size_t size)
{
    const struct itimerval most = {.it_value.tv_sec = MOST_SECONDS};
    setitimer(ITIMER_PROF, &most, NULL);
    return LLVMFuzzerTestOneInput(data, size);
}

static void run_file(const char *path)
{
    snprintf(now, sizeof now, "%s\n", path);
    FILE *f = fopen(path, "rb");
    if (!CHECK_MSG(f != NULL, "%s cannot be read", path))
        return;
    static uint8_t data[1 << 20];
    const size_t size = fread(data, 1, sizeof data, f);
    fclose(f);
    uint8_t *exact = malloc(size ? size : 1);  // an exact copy, so that reading past the end is noticed
    memcpy(exact, data, size);
    CHECK_MSG(try_bytes(exact, size) == 0, "%s", path);
    free(exact);
}

// Half of the inputs avoid the ends of a byte's range, where targets put rare choices, so that more calls are accepted.
static void run_random(long count, uint32_t seed)
{
    static uint8_t data[1024];
    double slowest = 0;
    uint32_t slowest_one = seed;
    for (uint32_t i = seed; i != seed + (uint32_t)count; i++) {
        uint32_t state = i * 2654435761u;
        const uint32_t calm = i % 4 == 0 ? 1 : i % 4 == 1 ? 16 : 256;
        for (size_t k = 0; k < sizeof data; k++) {
            state = state * 1664525u + 1013904223u;
            const uint32_t bits = state >> 8;
            data[k] = (uint8_t)(k > 1 && bits % calm ? 60 + (bits >> 8) % 195 : bits >> 8);
        }
        snprintf(now, sizeof now, "--random 1 %u\n", i);
        fuzz_small = i / 4 % 8 != 0;
        const clock_t from = clock();
        if (try_bytes(data, sizeof data))
            CHECK_MSG(0, "seed %u", i);
        const double seconds = (double)(clock() - from) / CLOCKS_PER_SEC;
        if (seconds > slowest)
            slowest = seconds, slowest_one = i;
    }
    fuzz_small = 0;
    printf("%ld made up from %u on; the slowest, %u, took %.1f s\n", count, seed, slowest_one, slowest);
    CHECK(count > 0);
}

int main(int argc, char **argv)
{
    int first = 1;
    watch();
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
    if (fuzz_told)
        fuzz_told();
    return check_report();
}
