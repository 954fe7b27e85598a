// SPDX-License-Identifier: BSD-3-Clause
// Structs of other sizes than the library's own, as programs that were compiled with other headers give them. What the library
// fills: no byte beyond size is written, and bytes that it does not know become 0. What it reads: what lies beyond its own
// bytes must be 0. Sizes below the first release's are refused, and so are reserved words that are not 0.
#include <string.h>

#include "hyperfocal/inspect.h"
#include "support/check.h"

enum { SIDE = 16, MORE = 64, ROOM = 1024, CANARY = 0xa5, TOO_LARGE = 65537 };

static float pixels[SIDE][SIDE][4], distances[SIDE][SIDE];
static struct hf_context *c;
static struct hf_message said;  // by the last call, where it can say something

// Memory for a struct of any size, with canaries behind it.
struct room {
    _Alignas(16) unsigned char bytes[ROOM];
};

static struct room room_of(const void *contents, size_t own, size_t size)
{
    struct room r;
    memset(r.bytes, CANARY, sizeof r.bytes);
    if (contents)
        memcpy(r.bytes, contents, own);
    memcpy(r.bytes, &size, sizeof size);
    return r;
}

// How many of the bytes from `from` up to `to` are other than v.
static int others(const struct room *r, size_t from, size_t to, unsigned char v)
{
    int n = 0;
    for (size_t i = from; i < to; i++)
        n += r->bytes[i] != v;
    return n;
}

static struct hf_image image(void)
{
    return (struct hf_image){.size = sizeof(struct hf_image),
                             .width = SIDE,
                             .height = SIDE,
                             .format = HF_FORMAT_RGBA32F,
                             .data = {pixels},
                             .stride = {sizeof pixels[0]}};
}

static struct hf_depth depth(void)
{
    return (struct hf_depth){.size = sizeof(struct hf_depth), .data = distances, .stride = sizeof distances[0]};
}

// The result of a function of the context, and what it said.
static int heard(int err)
{
    hf_get_problem(c, &said);
    return err;
}

// ---- what the library fills

static int report_of_frame(void *p)
{
    return heard(hf_get_report(c, p));
}

static int report_of_plan(void *p)
{
    const struct hf_image m = image();
    const struct hf_depth d = depth();
    return heard(hf_plan(c, &m, &m, &d, NULL, p));
}

static int params_used(void *p)
{
    return heard(hf_get_used(c, p, NULL));
}

static int resolved_used(void *p)
{
    return heard(hf_get_used(c, NULL, p));
}

static int params_resolved(void *p)
{
    const struct hf_depth d = depth();
    return hf_resolve(SIDE, SIDE, &d, NULL, p, NULL, &said);
}

static int resolved_resolved(void *p)
{
    const struct hf_depth d = depth();
    return hf_resolve(SIDE, SIDE, &d, NULL, NULL, p, &said);
}

static int params_initial(void *p)
{
    return hf_params_init(p, *(const size_t *)p);
}

static int choice_of_quality(void *p)
{
    struct hf_params params = hf_default_params();
    return hf_choose_quality(SIDE, NULL, &params, HF_QUALITY_HIGH, p, &said);
}

static int choice_of_error(void *p)
{
    struct hf_params params = hf_default_params();
    return hf_choose_error(SIDE, NULL, &params, 0.01f, p, &said);
}

static int message_of_context(void *p)
{
    return hf_get_problem(c, p);
}

static int message_of_resolve(void *p)
{
    const struct hf_depth d = depth();
    return hf_resolve(SIDE, SIDE, &d, NULL, NULL, NULL, p);
}

static int message_of_depth(void *p)
{
    const struct hf_depth d = depth();
    float z;
    return hf_depth_at(&d, SIDE, SIDE, 1, 1, &z, p);
}

static int message_of_choice(void *p)
{
    struct hf_params params = hf_default_params();
    return hf_choose_quality(SIDE, NULL, &params, HF_QUALITY_HIGH, NULL, p);
}

static int read_regions(struct hf_region *colour, struct hf_region *of_depth)
{
    const struct hf_region part = {.size = sizeof part, .x = 4, .y = 4, .width = 8, .height = 4};
    const struct hf_image m = image();
    const struct hf_depth d = depth();
    return heard(hf_region_reads(c, &m, &m, &d, NULL, &part, colour, of_depth));
}

static int region_of_colour(void *p)
{
    return read_regions(p, NULL);
}

static int region_of_depth(void *p)
{
    return read_regions(NULL, p);
}

static int inspected_report(void *p)
{
    return heard(hf_inspect_get_report(c, p));
}

static int inspected_pass(void *p)
{
    return heard(hf_inspect_get_pass(c, 0, p));
}

static int inspected_choice(void *p)
{
    const struct hf_params params = hf_default_params();
    return hf_inspect_get_choice(SIDE, NULL, &params, HF_QUALITY_HIGH, 0, p);
}

// A struct that the library fills. Its last field ends where the struct does: a field of a later release would else lie in
// padding, where an older program's bytes are of any value. The least size that it takes is that of the first release,
// which ends with the field `first`.
static const struct output {
    const char *call, *type;
    int says;  // 1: it can say why it fails
    size_t least, end, own;
    int (*fill)(void *p);
} outputs[] = {
#define END(type, field) (offsetof(struct type, field) + sizeof((struct type *)0)->field)
#define GROWN(fill, says, type, first, last)                                                                           \
    {                                                                                                                  \
#fill, #type, says, END(type, first), END(type, last), sizeof(struct type), fill                               \
    }
#define OUTPUT(fill, says, type, last) GROWN(fill, says, type, last, last)
    GROWN(report_of_frame, 1, hf_report, clamped, guessed),
    GROWN(report_of_plan, 1, hf_report, clamped, guessed),
    OUTPUT(params_used, 1, hf_params, run),
    OUTPUT(params_resolved, 1, hf_params, run),
    OUTPUT(params_initial, 0, hf_params, run),
    OUTPUT(resolved_used, 1, hf_resolved, reserved),
    OUTPUT(resolved_resolved, 1, hf_resolved, reserved),
    OUTPUT(choice_of_quality, 1, hf_choice, why),
    OUTPUT(choice_of_error, 1, hf_choice, why),
    OUTPUT(message_of_context, 0, hf_message, sentence),
    OUTPUT(message_of_resolve, 0, hf_message, sentence),
    OUTPUT(message_of_depth, 0, hf_message, sentence),
    OUTPUT(message_of_choice, 0, hf_message, sentence),
    OUTPUT(region_of_colour, 1, hf_region, height),
    OUTPUT(region_of_depth, 1, hf_region, height),
    OUTPUT(inspected_report, 1, hf_inspect_report, budget_options),
    OUTPUT(inspected_pass, 1, hf_inspect_pass, ms),
    OUTPUT(inspected_choice, 0, hf_inspect_choice, measured),
#undef OUTPUT
#undef GROWN
#undef END
};

static void refuse(const struct output *o, size_t size)
{
    struct room r = room_of(NULL, 0, size);
    const struct room before = r;
    said = (struct hf_message){.size = sizeof said};
    CHECK_MSG(o->fill(r.bytes) == HF_ERR_ARG, "%s takes the size %zu", o->call, size);
    CHECK_MSG(memcmp(&r, &before, sizeof r) == 0, "%s writes into a struct of the size %zu", o->call, size);
    CHECK_MSG(!o->says || (said.error == HF_ERR_ARG && strstr(said.sentence, o->type)),
              "%s with the size %zu says '%s'", o->call, size, said.sentence);
}

static void fill(const struct output *o, const struct room *want, size_t size)
{
    struct room r = room_of(NULL, 0, size);
    const size_t known = size < o->own ? size : o->own;
    CHECK_MSG(o->fill(r.bytes) == HF_OK, "%s refuses the size %zu: %s", o->call, size, said.sentence);
    CHECK_MSG(memcmp(r.bytes, &size, sizeof size) == 0, "%s changes the size %zu", o->call, size);
    CHECK_MSG(memcmp(r.bytes + sizeof size, want->bytes + sizeof size, known - sizeof size) == 0,
              "%s fills the size %zu with something else", o->call, size);
    CHECK_MSG(!others(&r, known, size, 0), "%s leaves bytes of the size %zu", o->call, size);
    CHECK_MSG(!others(&r, size, sizeof r, CANARY), "%s writes beyond the size %zu", o->call, size);
}

static void check_output(const struct output *o)
{
    struct room want = room_of(NULL, 0, o->own);
    CHECK_MSG(o->own == o->end, "struct %s ends with padding", o->type);
    CHECK_MSG(o->fill(want.bytes) == HF_OK, "%s fails: %s", o->call, said.sentence);
    for (size_t size = 0; size < o->least; size++)
        refuse(o, size);
    for (size_t size = o->least; size <= o->own + MORE; size++)
        fill(o, &want, size);
    refuse(o, TOO_LARGE);
    refuse(o, (size_t)-1);
}

// ---- what the library reads

static void hear(void *cookie, const struct hf_message *message)
{
    (void)cookie;
    said = *message;
}

static int open_with(const void *p)
{
    struct hf_context *other;
    const int err = hf_open(&other, p);
    hf_close(&other);
    return err;
}

static int render_with(const struct hf_image *dst, const struct hf_image *src, const struct hf_depth *of,
                       const struct hf_params *params, const struct hf_region *region)
{
    const struct hf_image m = image();
    const struct hf_depth d = depth();
    return heard(hf_render_region(c, dst ? dst : &m, src ? src : &m, of ? of : &d, params, region));
}

static int render_src(const void *p)
{
    return render_with(NULL, p, NULL, NULL, NULL);
}

static int render_dst(const void *p)
{
    return render_with(p, NULL, NULL, NULL, NULL);
}

static int render_depth(const void *p)
{
    return render_with(NULL, NULL, p, NULL, NULL);
}

static int render_params(const void *p)
{
    return render_with(NULL, NULL, NULL, p, NULL);
}

static int render_picture(const void *p)
{
    struct hf_params params = hf_default_params();
    params.engine = HF_ENGINE_SCATTER;
    params.aperture.picture = p;
    return render_with(NULL, NULL, NULL, &params, NULL);
}

static int render_region(const void *p)
{
    return render_with(NULL, NULL, NULL, NULL, p);
}

static int read_depth(const void *p)
{
    float z;
    return hf_depth_at(p, SIDE, SIDE, 1, 1, &z, &said);
}

static int resolve_depth(const void *p)
{
    return hf_resolve(SIDE, SIDE, p, NULL, NULL, NULL, &said);
}

static int resolve_params(const void *p)
{
    const struct hf_depth d = depth();
    return hf_resolve(SIDE, SIDE, &d, p, NULL, NULL, &said);
}

static int choose_depth(const void *p)
{
    struct hf_params params = hf_default_params();
    return hf_choose_quality(SIDE, p, &params, HF_QUALITY_HIGH, NULL, &said);
}

static int choose_params(const void *p)
{
    struct room r;
    memcpy(&r, p, sizeof r);
    return hf_choose_quality(SIDE, NULL, (struct hf_params *)r.bytes, HF_QUALITY_HIGH, NULL, &said);
}

struct input {
    const char *call, *argument, *type;
    const void *right;
    size_t own;
    int (*give)(const void *p);
};

static void refuse_input(const struct input *in, const struct room *r, const char *text)
{
    const size_t size = *(const size_t *)r->bytes;
    said = (struct hf_message){.size = sizeof said};
    CHECK_MSG(in->give(r->bytes) == HF_ERR_ARG, "%s takes what is wrong at the size %zu", in->call, size);
    // hf_open looks for no log in a config whose size no release can have.
    const int silent = strcmp(in->type, "hf_config") == 0 && (size < in->own || size > in->own + MORE);
    CHECK_MSG(silent ? !*said.sentence
                     : strcmp(said.argument, in->argument) == 0 && strstr(said.sentence, text) != NULL,
              "%s with the size %zu says of '%s': '%s'", in->call, size, said.argument, said.sentence);
}

// A larger struct: with zeros, then with each of its further bytes set.
static void check_larger(const struct input *in, size_t more)
{
    struct room r = room_of(in->right, in->own, in->own + more);
    memset(r.bytes + in->own, 0, more);
    CHECK_MSG(in->give(r.bytes) == HF_OK, "%s refuses %zu more bytes of 0: %s", in->call, more, said.sentence);
    for (size_t i = 0; i < more; i++) {
        r.bytes[in->own + i] = 1;
        refuse_input(in, &r, "newer library");
        r.bytes[in->own + i] = 0;
    }
}

static void check_input(const struct input *in)
{
    for (size_t size = 0; size < in->own; size++) {
        const struct room r = room_of(in->right, in->own, size);
        refuse_input(in, &r, in->type);
    }
    for (size_t more = 0; more <= MORE; more += more < 9 ? 1 : 11)
        check_larger(in, more);
    const struct room r = room_of(in->right, in->own, TOO_LARGE), wild = room_of(in->right, in->own, (size_t)-1);
    refuse_input(in, &r, in->type);
    refuse_input(in, &wild, in->type);
}

static void inputs(void)
{
    const struct hf_config config = {.size = sizeof config, .threads = 1, .log = hear};
    const struct hf_image m = image();
    const struct hf_depth d = depth();
    const struct hf_params p = hf_default_params();
    const struct hf_region part = {.size = sizeof part, .x = 4, .y = 4, .width = 8, .height = 4};
    const struct input all[] = {
        {"open_with", "config", "hf_config", &config, sizeof config, open_with},
        {"render_src", "src", "hf_image", &m, sizeof m, render_src},
        {"render_dst", "dst", "hf_image", &m, sizeof m, render_dst},
        {"render_picture", "aperture.picture", "hf_image", &m, sizeof m, render_picture},
        {"render_depth", "depth", "hf_depth", &d, sizeof d, render_depth},
        {"read_depth", "depth", "hf_depth", &d, sizeof d, read_depth},
        {"resolve_depth", "depth", "hf_depth", &d, sizeof d, resolve_depth},
        {"choose_depth", "depth", "hf_depth", &d, sizeof d, choose_depth},
        {"render_params", "params", "hf_params", &p, sizeof p, render_params},
        {"resolve_params", "params", "hf_params", &p, sizeof p, resolve_params},
        {"choose_params", "params", "hf_params", &p, sizeof p, choose_params},
        {"render_region", "region", "hf_region", &part, sizeof part, render_region},
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        check_input(&all[i]);
}

// ---- reserved words

static void check_reserved(const char *name, struct hf_params *p, uint32_t *words, size_t bytes)
{
    for (size_t i = 0; i < bytes / sizeof *words; i++) {
        words[i] = 1u << 31 >> i;
        CHECK_MSG(render_params(p) == HF_ERR_ARG, "hf_render takes word %zu of %s", i, name);
        CHECK_MSG(strcmp(said.argument, name) == 0, "word %zu of %s: '%s'", i, name, said.sentence);
        CHECK_MSG(resolve_params(p) == HF_ERR_ARG, "hf_resolve takes word %zu of %s", i, name);
        CHECK_MSG(strcmp(said.argument, name) == 0, "word %zu of %s: '%s'", i, name, said.sentence);
        words[i] = 0;
    }
    CHECK_INT(resolve_params(p), HF_OK);
}

static void reserved(void)
{
    struct hf_params p = hf_default_params();
    struct hf_depth d = depth();
#define GROUP(group) check_reserved(#group ".reserved", &p, p.group.reserved, sizeof p.group.reserved)
    GROUP(range), GROUP(lens), GROUP(aperture), GROUP(highlight), GROUP(view), GROUP(gather), GROUP(chapter);
    GROUP(hexagon), GROUP(scatter), GROUP(gaussian), GROUP(layers), GROUP(run);
#undef GROUP
    d.reserved = 1;
    CHECK_INT(render_depth(&d), HF_ERR_ARG);
    CHECK_MSG(strcmp(said.argument, "depth.reserved") == 0, "'%s'", said.sentence);
    CHECK_INT(resolve_depth(&d), HF_ERR_ARG);
    CHECK_MSG(strcmp(said.argument, "depth.reserved") == 0, "'%s'", said.sentence);
}

int main(void)
{
    said.size = sizeof said;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            distances[y][x] = y < SIDE / 2 ? 10 : 20;
            for (int i = 0; i < 4; i++)
                pixels[y][x][i] = 1;
        }
    const struct hf_config config = {.size = sizeof config, .threads = 1};
    if (!CHECK_INT(hf_open(&c, &config), HF_OK))
        return check_report();
    inputs();
    reserved();
    for (size_t i = 0; i < sizeof outputs / sizeof *outputs; i++) {
        CHECK_INT(render_with(NULL, NULL, NULL, NULL, NULL), HF_OK);
        check_output(&outputs[i]);
    }
    hf_close(&c);
    return check_report();
}
