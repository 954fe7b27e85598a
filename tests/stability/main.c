// SPDX-License-Identifier: BSD-3-Clause
// Runs the cases of stability.h as a test.
//
// With --full, or with HF_LONG in the environment, all of them.
//
//     stability [--full] [--seed N] [--engine NAME] [--only GROUP] [--isa NAME]
#include <stdlib.h>
#include <string.h>

#include "stability/stability.h"
#include "support/check.h"

static enum hf_isa isa_of(const char *name)
{
    for (int isa = HF_ISA_SCALAR; isa <= HF_ISA_NEON; isa++)
        if (!strcmp(name, hf_isa_name((enum hf_isa)isa)))
            return (enum hf_isa)isa;
    return HF_ISA_AUTO;
}

int main(int argc, char **argv)
{
    struct stability_options o = {.seed = 1, .full = check_long()};
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : "";
        if (!strcmp(argv[i], "--full")) {
            o.full = 1;
            continue;
        } else if (!strcmp(argv[i], "--seed"))
            o.seed = (unsigned)strtoul(value, NULL, 0);
        else if (!strcmp(argv[i], "--engine"))
            o.engine = value;
        else if (!strcmp(argv[i], "--only"))
            o.only = value;
        else if (!strcmp(argv[i], "--isa") && isa_of(value) != HF_ISA_AUTO)
            o.isa = isa_of(value);
        else {
            fprintf(stderr, "usage: %s [--full] [--seed N] [--engine NAME] [--only GROUP] [--isa NAME]\n", argv[0]);
            return 2;
        }
        i++;
    }
    printf("seed %u\n", o.seed);
    CHECK(stability_run(&o) == 0);
    const int failed = stability_print(stdout);
    printf("\n%d rows keep their bounds, %d fail\n", stability_passed(), failed);
    CHECK_INT(failed, 0);
    for (int i = 0; i < stability_passed(); i++)
        CHECK(1);
    return check_report();
}
