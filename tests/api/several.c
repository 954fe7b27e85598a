// SPDX-License-Identifier: BSD-3-Clause
// Several pictures with depth in one call: what hf_render_layers takes and refuses, and what must not change a picture.
#include <math.h>
#include <string.h>

#include "support/check.h"
#include "hyperfocal/layers.h"

enum { W = 150, H = 101, N = W * H };

struct picture {
    float rgba[4 * N], z[N];
    struct hf_image image;
    struct hf_depth depth;
};

static void make(struct picture *p)
{
    p->image = (struct hf_image){.size = sizeof p->image,
                                 .width = W,
                                 .height = H,
                                 .format = HF_FORMAT_RGBA32F,
                                 .data = {p->rgba},
                                 .stride = {W * 4 * sizeof(float)}};
    p->depth = (struct hf_depth){.size = sizeof p->depth, .data = p->z, .stride = W * sizeof(float)};
}

static void set(struct picture *p, int x, int y, float r, float g, float b, float a, float z)
{
    float *c = p->rgba + 4 * (y * W + x);
    c[0] = a * r;
    c[1] = a * g;
    c[2] = a * b;
    c[3] = a;
    p->z[y * W + x] = z;
}

static struct hf_layer layer_of(const struct picture *p, enum hf_layer_kind kind)
{
    return (struct hf_layer){.size = sizeof(struct hf_layer), .kind = kind, .image = &p->image, .depth = &p->depth};
}

static struct picture front, back, whole, nothing, peel, out[2];
static struct hf_context *context;
static struct hf_params params;

// A near bar with soft edges before a far wall that is green where the bar hides it and blue elsewhere.
static void paint(void)
{
    struct picture *const all[] = {&front, &back, &whole, &nothing, &peel, &out[0], &out[1]};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        make(all[i]);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            const float a = fminf(fmaxf(9.5f - fabsf((float)x - W / 2.0f), 0), 1);
            const int hidden = a > 0;
            set(&front, x, y, 0.8f, 0.1f, 0.1f, a, a > 0 ? 2 : INFINITY);
            set(&back, x, y, 0, hidden, !hidden, 1, 20);
            set(&nothing, x, y, 0, 0, 0, 0, 3);
            set(&whole, x, y, 0.8f * a, 0.1f * a + (1 - a) * hidden, 0.1f * a + (1 - a) * !hidden, 1,
                a >= 0.5f ? 2 : 20);
            set(&peel, x, y, 0, hidden, !hidden, a, 20);
        }
}

static int render(struct picture *to, const struct hf_layer *layers, int count)
{
    memset(to->rgba, 0, sizeof to->rgba);
    return hf_render_layers(context, &to->image, layers, count, &params, NULL);
}

static int same(void)
{
    return !memcmp(out[0].rgba, out[1].rgba, sizeof out[0].rgba);
}

// The green of the middle row: what the bar hides, so a lens alone can bring it out.
static double green(const struct picture *p)
{
    double sum = 0;
    for (int x = 0; x < W; x++)
        sum += (double)p->rgba[4 * (H / 2 * W + x) + 1];
    return sum;
}

static void test_neutral(void)
{
    const struct hf_layer one[] = {layer_of(&whole, HF_LAYER_WHOLE)},
                          two[] = {layer_of(&front, HF_LAYER_WHOLE), layer_of(&back, HF_LAYER_WHOLE)},
                          turned[] = {two[1], two[0]}, more[] = {two[0], layer_of(&nothing, HF_LAYER_WHOLE), two[1]};
    CHECK_INT(render(&out[0], one, 1), HF_OK);
    CHECK_INT(hf_render(context, &out[1].image, &whole.image, &whole.depth, &params), HF_OK);
    CHECK_MSG(same(), "one layer is not hf_render");
    CHECK_INT(render(&out[0], two, 2), HF_OK);
    CHECK_INT(render(&out[1], turned, 2), HF_OK);
    CHECK_MSG(same(), "the order of layers counts");
    CHECK_INT(render(&out[1], more, 3), HF_OK);
    CHECK_MSG(same(), "a layer of alpha 0 counts");
}

// A renderer's depth of an edge's pixel may be that of nothing. Its surface is the one beside it.
static void test_edges(void)
{
    struct hf_layer two[] = {layer_of(&front, HF_LAYER_WHOLE), layer_of(&back, HF_LAYER_WHOLE)};
    int soft = 0;
    CHECK_INT(render(&out[0], two, 2), HF_OK);
    peel = front;
    make(&peel);
    for (int i = 0; i < N; i++)
        if (peel.rgba[4 * i + 3] > 0 && peel.rgba[4 * i + 3] < 1) {
            peel.z[i] = i % 2 ? INFINITY : 1e10f;
            soft++;
        }
    CHECK(soft > 0);
    two[0] = layer_of(&peel, HF_LAYER_WHOLE);
    CHECK_INT(render(&out[1], two, 2), HF_OK);
    CHECK_MSG(same(), "edges without a depth");
    paint();
}

// Where the two have the same blur, none or the most, the nearer one is still before the other.
static void test_same_blur(void)
{
    const struct hf_layer two[] = {layer_of(&front, HF_LAYER_WHOLE), layer_of(&back, HF_LAYER_WHOLE)},
                          turned[] = {two[1], two[0]};
    const struct hf_params was = params;
    for (int i = 0; i < 3; i++) {
        params.model = i == 1 ? HF_MODEL_RANGE : HF_MODEL_LENS;
        params.range = (struct hf_range_params){
            .distance = 1, .strength = 1, .near_begin = 30, .near_end = 40, .far_begin = 50, .far_end = 60};
        params.max_radius = i == 0 ? HF_DERIVE : i == 1 ? 5 : 0;
        params.focus = i == 0 ? 1e6f : 45;
        CHECK_INT(render(&out[0], two, 2), HF_OK);
        CHECK_INT(render(&out[1], turned, 2), HF_OK);
        CHECK_MSG(same(), "order counts where blur is equal, %d", i);
        const float *middle = out[0].rgba + 4 * (H / 2 * W + W / 2);
        CHECK_MSG(middle[0] > middle[1] + 0.3f, "the bar is behind, %d: %g, %g", i, middle[0], middle[1]);
    }
    params = was;
}

// The share of light that was guessed, at pixel x of the middle row.
static float guessed_at(const struct picture *p, int x)
{
    return p->rgba[4 * (H / 2 * W + x)];
}

// The report has the mean of the shares, each to a 2^-24th.
static void check_report_of(const struct picture *p)
{
    struct hf_report report = {.size = sizeof report};
    double sum = 0;
    for (int i = 0; i < N; i++)
        sum += p->rgba[4 * i];
    CHECK_INT(hf_get_report(context, &report), HF_OK);
    CHECK_MSG(fabs(report.guessed - sum / N) <= 0x1p-24, "the report has %g, the picture %g", report.guessed, sum / N);
}

static int render_guessed(struct picture *to, const struct hf_layer *layers, int count)
{
    params.layers.guessed = 1;
    const int status = render(to, layers, count);
    params.layers.guessed = 0;
    check_report_of(to);
    return status;
}

// One picture guesses beside the bar and at the frame's border; with the wall known the border is left, and nothing
// where all is sharp.
static void test_guessed(void)
{
    const struct hf_layer two[] = {layer_of(&front, HF_LAYER_WHOLE), layer_of(&back, HF_LAYER_WHOLE)},
                          one[] = {layer_of(&whole, HF_LAYER_WHOLE)};
    const int beside = W / 2 - 9, between = W / 4;
    int outside = 0;
    CHECK_INT(render_guessed(&out[0], one, 1), HF_OK);
    for (int i = 0; i < 4 * N; i++)
        outside += !(out[0].rgba[i] >= 0 && out[0].rgba[i] <= 1) || (i % 4 == 3 && out[0].rgba[i] != 1);
    CHECK_INT(outside, 0);
    // DRAFT fills in nothing that objects hide.
    const int fills = params.layers.quality != HF_LAYERS_DRAFT;
    CHECK_MSG(guessed_at(&out[0], beside) > 0.1f || !fills, "beside the bar %g", guessed_at(&out[0], beside));
    CHECK_MSG(guessed_at(&out[0], 0) > 0.02f && guessed_at(&out[0], W - 1) > 0.02f, "at the border %g, %g",
              guessed_at(&out[0], 0), guessed_at(&out[0], W - 1));
    // What is left is roundings of a share of 1.
    CHECK_MSG(guessed_at(&out[0], between) <= 1e-5f, "between them %g", guessed_at(&out[0], between));
    CHECK_INT(render_guessed(&out[1], two, 2), HF_OK);
    CHECK_MSG(guessed_at(&out[1], beside) < 0.02f, "with the wall known %g", guessed_at(&out[1], beside));
    CHECK_MSG(guessed_at(&out[1], 0) > 0.02f, "with the wall known, at the border %g", guessed_at(&out[1], 0));
    const struct hf_params was = params;
    params.focus = 20;
    params.lens.f_number = 1000;
    CHECK_INT(render_guessed(&out[0], one, 1), HF_OK);
    CHECK_MSG(guessed_at(&out[0], between) <= 1e-5f, "in focus %g", guessed_at(&out[0], between));
    params.max_radius = 0;
    CHECK_INT(render_guessed(&out[0], one, 1), HF_OK);
    CHECK_MSG(guessed_at(&out[0], beside) == 0, "without blur %g", guessed_at(&out[0], beside));
    params = was;
}

// A budget that nothing keeps may choose cheaper settings, but only of engines that take several pictures.
static void test_budget(void)
{
    const struct hf_layer two[] = {layer_of(&front, HF_LAYER_WHOLE), layer_of(&back, HF_LAYER_WHOLE)};
    params.run.budget_ms = 1e-6f;
    for (int i = 0; i < 6; i++)
        CHECK_INT(render(&out[0], two, 2), HF_OK);
    params.run.budget_ms = 0;
}

// The green of a row by rays: through the point u of the lens a pixel sees each surface r u beside itself. near, far: radii
// of a bar of half-width `half` and of the wall, which is green only where the bar hides it.
static double green_by_rays(double near, double far, double half)
{
    enum { POINTS = 400 };
    double sum = 0, all = 0;
    for (int i = 0; i < POINTS; i++) {
        const double u = (i + 0.5) / POINTS * 2 - 1, weight = sqrt(1 - u * u);
        for (int x = 0; x < W; x++)
            sum += fabs(x - W / 2 + near * u) >= half && fabs(x - W / 2 + far * u) < half ? weight : 0;
        all += weight;
    }
    return sum / all;
}

// What the bar hides is seen beside it: here all that is green, as the bar's edges are hard. One picture cannot know it.
// Slices and fields know only how much of a hidden place is covered, and not from where: they show 0.64 to 0.73 of it.
// Best, which goes through points of the lens, shows all.
static void test_hidden(void)
{
    const float near = -8, far = 6;
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            const int bar = abs(x - W / 2) < 10;
            set(&front, x, y, 0.8f, 0, 0, (float)bar, near);
            set(&back, x, y, 0, (float)bar, (float)!bar, 1, far);
            set(&whole, x, y, bar ? 0.8f : 0, 0, (float)!bar, 1, bar ? near : far);
            set(&peel, x, y, 0, 1, 0, (float)bar, far);
        }
    const struct hf_layer two[] = {layer_of(&front, HF_LAYER_WHOLE), layer_of(&back, HF_LAYER_WHOLE)},
                          peels[] = {layer_of(&whole, HF_LAYER_WHOLE), layer_of(&peel, HF_LAYER_PEEL)};
    struct picture *const all[] = {&front, &back, &whole, &peel};
    const double want = green_by_rays((double)near, (double)far, 9.5);
    for (int i = 0; i < 4; i++)
        all[i]->depth.type = HF_DEPTH_COC;
    params.max_radius = 12;
    CHECK_INT(render(&out[0], peels, 1), HF_OK);
    CHECK_MSG(green(&out[0]) <= 0, "one picture has %g of what the bar hides", green(&out[0]));
    CHECK_INT(render(&out[0], two, 2), HF_OK);
    CHECK_MSG(fabs(green(&out[0]) / want - 1) < 0.4, "layers: %g of what the bar hides, rays %g", green(&out[0]), want);
    CHECK_INT(render(&out[0], peels, 2), HF_OK);
    CHECK_MSG(fabs(green(&out[0]) / want - 1) < 0.4, "peels: %g of what the bar hides, rays %g", green(&out[0]), want);
    params.max_radius = HF_DERIVE;
    paint();
}

// Behind the bar a part of the wall opens on something farther, which no lens sees past the bar. What a lens sees of
// the wall beside that part, in the same 2 x 2 pixels, must not go with it: the wall is in focus there, so the
// opening changes nothing outside of itself but for 64 roundings of sums in the slices and what a mean of 2 x 2
// pixels takes along, below 2 %.
static void test_opening(void)
{
    const struct hf_layer two[] = {layer_of(&whole, HF_LAYER_WHOLE), layer_of(&peel, HF_LAYER_PEEL)};
    const int from = W / 2 - 2, to = W / 2 + 3;
    params.lens.f_number = 0.05f;
    for (int open = 0; open < 2; open++) {
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++) {
                const float a = front.rgba[4 * (y * W + x) + 3];
                const int hole = open && x >= from && x < to;
                set(&whole, x, y, 0.8f * a, 0.1f * a + (1 - a) * 0.7f, 0.1f * a + (1 - a) * 0.7f, 1, a >= 0.5f ? 2 : 6);
                set(&peel, x, y, 0, 0.7f, 0.7f, a, hole ? 60 : 6);
            }
        CHECK_INT(render(&out[open], two, 2), HF_OK);
    }
    float most = 0;
    for (int y = 8; y < H - 8; y++)
        for (int x = from - 4; x < to + 4; x++)
            if (x < from || x >= to)
                for (int c = 0; c < 3; c++) {
                    const int at = 4 * (y * W + x) + c;
                    most = fmaxf(fabsf(out[0].rgba[at] - out[1].rgba[at]), most);
                }
    CHECK_MSG(most < 0.02f, "a hidden opening changes what is beside it by %g", most);
    params.lens.f_number = 0.5f;
    paint();
}

// Where all surfaces have one colour and fill the frame, so has the result: to 64 roundings of sums in the slices.
static void test_constant(void)
{
    static struct picture a, b;
    make(&a);
    make(&b);
    for (int i = 0; i < N; i++) {
        set(&a, i % W, i / W, 0.5f, 0.5f, 0.5f, i % W / 20 % 2 ? 1 : 0, 2);
        set(&b, i % W, i / W, 0.5f, 0.5f, 0.5f, 1, i / W > H / 2 ? 20 : 6);
    }
    const struct hf_layer two[] = {layer_of(&a, HF_LAYER_WHOLE), layer_of(&b, HF_LAYER_WHOLE)};
    CHECK_INT(render(&out[0], two, 2), HF_OK);
    float off = 0;
    for (int i = 0; i < 4 * N; i++)
        off = fmaxf(fabsf(out[0].rgba[i] - (i % 4 == 3 ? 1 : 0.5f)), off);
    CHECK_MSG(off <= 64 * 1.2e-7f, "a constant scene is off by %g", off);
}

static void test_region(void)
{
    const struct hf_layer two[] = {layer_of(&front, HF_LAYER_WHOLE), layer_of(&back, HF_LAYER_WHOLE)};
    const struct hf_region part = {.size = sizeof part, .x = 40, .y = 20, .width = 50, .height = 33};
    CHECK_INT(render(&out[0], two, 2), HF_OK);
    memset(out[1].rgba, 0, sizeof out[1].rgba);
    CHECK_INT(hf_render_layers(context, &out[1].image, two, 2, &params, &part), HF_OK);
    int other = 0;
    for (int i = 0; i < 4 * N; i++) {
        const int x = i / 4 % W, y = i / 4 / W, in = x >= 40 && x < 90 && y >= 20 && y < 53;
        other += memcmp(&out[1].rgba[i], in ? &out[0].rgba[i] : &(float){0}, sizeof(float)) != 0;
    }
    CHECK_INT(other, 0);
}

// A near slope that fills all but the left edge of the picture, before a known surface in focus; its blur leaves some of that open.
// Most tiles see nothing that they could guess from, and show what is known all the same: the bits are those of other tiles.
static void test_tiles(void)
{
    static struct picture near, known;
    const struct hf_config config = {.size = sizeof config, .threads = 1, .tile_width = 16, .tile_height = 16};
    const struct hf_params lens = params;
    struct hf_context *const large = context;
    make(&near);
    make(&known);
    for (int i = 0; i < N; i++) {
        const int x = i % W;
        set(&near, x, i / W, 0.8f, 0.1f, 0.1f, 1, x < 4 ? 6 : 4 - (float)x / 75);
        set(&known, x, i / W, 0, 1, (float)(i % 7) / 7, 1, 6);
    }
    params.model = HF_MODEL_RANGE;
    params.range.distance = 4;
    params.max_radius = 6;
    const struct hf_layer two[] = {layer_of(&near, HF_LAYER_WHOLE), layer_of(&known, HF_LAYER_PEEL)};
    CHECK_INT(render(&out[0], two, 2), HF_OK);
    if (CHECK_INT(hf_open(&context, &config), HF_OK)) {
        CHECK_INT(render(&out[1], two, 2), HF_OK);
        CHECK(same());
        hf_close(&context);
    }
    context = large;
    params = lens;
}

// 1 if the call is refused with a sentence that holds a word.
static int refused(const struct hf_layer *layers, int count, const char *word)
{
    struct hf_message why = {.size = sizeof why};
    return render(&out[0], layers, count) == HF_ERR_ARG && hf_get_problem(context, &why) == HF_OK &&
           strstr(why.sentence, word) != NULL;
}

static void test_refused(void)
{
    struct hf_layer two[] = {layer_of(&whole, HF_LAYER_WHOLE), layer_of(&peel, HF_LAYER_PEEL)};
    CHECK(refused(NULL, 1, "layers"));
    CHECK(refused(two, 0, "count"));
    CHECK(refused(two, 65, "count"));
    CHECK(refused(two + 1, 1, "layers[0]"));
    two[1].reserved = 1;
    CHECK(refused(two, 2, "layers[1]"));
    two[1] = layer_of(&peel, (enum hf_layer_kind)7);
    CHECK(refused(two, 2, "layers[1]"));
    two[1] = layer_of(&peel, HF_LAYER_PEEL);
    two[1].depth = NULL;
    CHECK(refused(two, 2, "layers[1]"));
    two[1].depth = &peel.depth;
    peel.image.width--;
    CHECK(refused(two, 2, "layers[1]"));
    peel.image.width++;
    params.engine = HF_ENGINE_GATHER;
    CHECK(refused(two, 2, "gather"));
    params.engine = HF_ENGINE_LAYERS;
}

int main(void)
{
    const struct hf_config config = {.size = sizeof config, .threads = 2};
    params = hf_default_params();
    params.engine = HF_ENGINE_LAYERS;
    params.model = HF_MODEL_LENS;
    params.focus = 6;
    params.lens.f_number = 0.5f;
    params.lens.focal_length_mm = 30;
    if (!CHECK_INT(hf_open(&context, &config), HF_OK))
        return check_report();
    paint();
    for (int quality = HF_LAYERS_STANDARD; quality <= HF_LAYERS_BEST; quality++) {
        params.layers.quality = (enum hf_layers_quality)quality;
        test_neutral();
        test_edges();
        test_hidden();
        test_constant();
        test_region();
        test_tiles();
        test_guessed();
    }
    params.layers.quality = HF_LAYERS_STANDARD;
    params.engine = HF_ENGINE_SCATTER;
    for (int half = 0; half < 2; half++) {
        params.scatter.resolution = half ? HF_RESOLUTION_HALF : HF_RESOLUTION_FULL;
        test_neutral();
        test_edges();
        test_hidden();
        test_constant();
        test_region();
        test_tiles();
        test_same_blur();
    }
    params.engine = HF_ENGINE_LAYERS;
    test_opening();
    test_same_blur();
    test_budget();
    test_refused();
    hf_close(&context);
    return check_report();
}
