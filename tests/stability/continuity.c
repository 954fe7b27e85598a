// SPDX-License-Identifier: BSD-3-Clause
// Parameters that move in tiny steps must move the picture in tiny steps. The worst step is halved until nothing lies
// between its ends, or twenty times: the remaining change is a jump.
#include "stability/stability.h"

#include <stdlib.h>

#include "support/check.h"

enum { WIDTH = 64, HEIGHT = 44, HALVINGS = 20 };

enum pull { PULL_FOCUS, PULL_RANGE, PULL_STRENGTH, PULL_DOLLY, PULL_RADIUS, PULLS };
static const struct {
    const char *name;
    double from, to;
} pulls[PULLS] = {
    {"a focus pull: worst jump, 8-bit codes", 14, 26},    {"a range pull: worst jump, 8-bit codes", 2, 30},
    {"a strength pull: worst jump, 8-bit codes", 0, 1},   {"a dolly: worst jump, 8-bit codes", 0, 12},
    {"a radius ramp: worst jump, 8-bit codes", 0.01, 18},
};

// A pull: some depths stay, some move; all else is the subject's.
struct pulling {
    const struct run *r;
    const struct scene *s;
    struct picture *moved;
    enum pull pull;
};

// The published demo switches two things abruptly that other variants fade in. First, its far maximum includes any
// neighbour that begins to be far, and its upsampling includes the next ones: two quads in all. Second, its near colour
// is the mean of all taps where the blurred near CoC is over 0, and the quad's own elsewhere. So a quad that just begins to be near switches all
// quads within reach of its maximum and its blur, m each. The quads beside those have at most (4 m + 1) / (2 m + 1)^2
// of a blurred CoC, 25 / 169 at m = 6 (windows shifted by one along both axes have all but that many in common); their
// maximum includes the changed colour, and upsampling spreads it by one quad. The marks count the far quads up to two away,
// and those with a blurred near CoC.
static float *demo_marks(const struct picture *depth, const struct hf_params *p)
{
    enum { W = WIDTH / 2, H = HEIGHT / 2 };
    const int reach = 2 * (int)ceilf(p->max_radius / 2);
    float *marks = calloc(samples_of(depth), sizeof *marks);
    char far[H][W] = {{0}}, near[H][W] = {{0}};
    for (int i = 0; i < W * H; i++) {
        const float z = depth->plane[0][2 * (i / W) * WIDTH + 2 * (i % W)];
        far[i / W][i % W] = z > p->focus;
        for (int y = i / W - reach; z < p->focus && y <= i / W + reach; y++)
            for (int x = i % W - reach; x <= i % W + reach; x++)
                if (x >= 0 && y >= 0 && x < W && y < H)
                    near[y][x] = 1;
    }
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        for (int k = 0; k < 25; k++) {
            const int x = i % WIDTH / 2 + k % 5 - 2, y = i / WIDTH / 2 + k / 5 - 2;
            if (x >= 0 && y >= 0 && x < W && y < H)
                marks[i] += (float)(far[y][x] + 32 * near[y][x]);
        }
    return marks;
}

static struct picture at(void *cookie, double t)
{
    const struct pulling *w = cookie;
    struct hf_params p = w->r->subject->params;
    const float v = (float)t;
    struct hf_depth depth = picture_depth(&w->s->depth);
    if (w->pull == PULL_FOCUS)
        p.focus = v;
    if (w->pull == PULL_RANGE)
        p.range.distance = v;
    if (w->pull == PULL_STRENGTH)
        p.range.strength = v;
    if (w->pull == PULL_RADIUS)
        p.max_radius = v;
    if (w->pull == PULL_DOLLY) {
        for (size_t i = 0; i < samples_of(w->moved); i++)
            w->moved->plane[0][i] = w->s->depth.plane[0][i] + v;
        depth.data = w->moved->plane[0];
    }
    struct picture out = render(w->r->c, &w->s->colour, &depth, &p);
    if (p.chapter.faithful)
        out.plane[3] = demo_marks(w->pull == PULL_DOLLY ? w->moved : &w->s->depth, &p);
    return out;
}

// ---- bounds ----

// A radius of 12 moves by 12 / 10 of what the focus moves, by some units in the last place of 30: 1e-5 pixels. A sample
// depends on it most at a radius of one pixel, where it moves four times as fast as with a range of 1, and the sRGB
// curve makes 12.92 * 255 codes of 1: 0.13. Nobody sees half a code.
static const double FLOAT_STEP = 0.5;

static const char *half_a_code(const struct run *r)
{
    const struct hf_params *p = &r->subject->params;
    return p->engine == HF_ENGINE_CHAPTER && p->chapter.faithful
               ? "faithful: half a code, beside what the demo changes at once, which is left out; see continuity.c"
               : "half a code: what the smallest step of a float can make, see continuity.c";
}

// By how many codes a colour of 0.05 .. 1, as in calm_scene(), may fall when it moves by that part towards another one
// and is truncated that often to 5 bits after the leading one, as blue is.
static double fall(double part, int truncations)
{
    double most = 0;
    for (int i = 0; i <= 950; i++) {
        const double c = 0.05 + i * 1e-3, to = fmax(0.05, c - part * 0.95) * pow(1 - 1.0 / 32, truncations);
        most = fmax(most, display_code(c) - display_code(to));
    }
    return most;
}

static int is_packed(const struct hf_params *p)
{
    return (p->engine == HF_ENGINE_GATHER && p->gather.storage == HF_STORAGE_PACKED) ||
           (p->engine == HF_ENGINE_CHAPTER && p->chapter.storage == HF_STORAGE_PACKED);
}

// The largest jump allowed from t on, and the reason.
static double allowed(const struct run *r, enum pull pull, double t, const char **why)
{
    const struct hf_params *p = &r->subject->params;
    const int taps = p->engine == HF_ENGINE_CHAPTER, packed = is_packed(p), chapters = taps && p->chapter.faithful;
    // CoC is stored in bytes: one step of a pixel's own far CoC, and one of the near mean. A field is truncated when it
    // is stored, and so is the result. Where there is a maximum, far neighbours enter it by four times their CoC, up to
    // a quarter, at a pixel of no more: one byte more. Near colour and its maximum enter by eight times the mean's
    // bytes, up to an eighth, at a half-resolution pixel with at most 9/16 of the picture's weight. Means of neighbours
    // differ by at most 1 / (2 h + 1), for a radius of 2 h; half of that plus the eighth is the largest part there: 8 *
    // 9/16 * (1/8 + 1/6) = 1.32 bytes at h = 1, and less for all others, twice.
    double part = packed ? (taps ? 2 + 1 + 2 * 1.32 : 2) / 255.0 : 0;
    *why = packed ? "packed: steps of an 8-bit CoC, 2 or for a maximum 5.64, and two truncations to 5 bits"
                  : half_a_code(r);
    if (chapters && pull == PULL_RADIUS) {
        // The near maximum and its mean are 2 m + 1 wide, m = ceil(radius / 2), as in the chapter: from a straight edge
        // on, the mean falls as 1 - d / (2 m + 1), so the next m changes it by at most 2 / (2 m + 3). From N to N + 1
        // rings, every fourth pixel, eight taps and the centre stay the same: 9 of 1 + 4 (N + 1) (N + 2).
        const double m = round(t / 2), n = round(t / 4);
        *why = "faithful: the chapter's near CoC reaches whole pixels, its rings are whole; see continuity.c";
        if (fabs(t - 2 * m) < 1e-4)
            part += m < 1 ? 1 : 2 / (2 * m + 3);
        if (fabs(t - 4 * n) < 1e-4)
            part += 1 - 9 / (1 + 4 * (n + 1) * (n + 2));
    }
    return part > 0 ? fall(part, packed ? 2 : 0) : FLOAT_STEP;
}

static void pulled(const struct run *r, enum pull pull, const struct scene *s, const char *scene)
{
    const int steps = r->full ? 1000 : 120;
    struct picture moved = picture_copy(&s->depth);
    struct pulling w = {r, s, &moved, pull};
    const struct large_steps large = large_steps(at, display_distance, &w, pulls[pull].from, pulls[pull].to, steps);
    const char *why;
    for (int k = 0; k < LARGE_STEPS; k++) {
        if (large.change[k] <= 0.5)
            continue;
        double from = large.place[k], to = from + large.width;
        const double left = step_left(at, display_distance, &w, HALVINGS, &from, &to);
        const double bound = allowed(r, pull, from, &why);
        see(r, pulls[pull].name, why, left, bound, "%s, at %.9g (step %.3g)", scene, from, large.change[k]);
    }
    see(r, pulls[pull].name, half_a_code(r), 0, FLOAT_STEP, "%s", scene);
    picture_free(&moved);
}

// Steps that 120 samples of a pull may miss: where the first quad becomes far, and where there is one more level of the
// gather's kernels or of hidden samples.
static void known_places(const struct run *r, const struct scene *s, const char *scene)
{
    static const struct {
        enum pull pull;
        double from, to;
    } places[] = {{PULL_FOCUS, 20.84, 20.845},
                  {PULL_STRENGTH, 0.666, 0.668},
                  {PULL_RANGE, 6.06318, 6.0643},
                  {PULL_RADIUS, 15.99, 16.01},
                  {PULL_RADIUS, 16.55, 16.56}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        struct pulling w = {r, s, NULL, places[i].pull};
        double from = places[i].from, to = places[i].to;
        const char *why;
        const double left = step_left(at, display_distance, &w, HALVINGS, &from, &to),
                     bound = allowed(r, places[i].pull, from, &why);
        see(r, pulls[places[i].pull].name, why, left, bound, "%s, at %.9g", scene, from);
    }
}

// A floor through the focus, a wall behind and a bar in front.
static struct scene stage(const struct run *r)
{
    struct scene s = calm_scene(r->seed, WIDTH, HEIGHT, 3);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const int x = i % WIDTH, y = i / WIDTH;
        s.depth.plane[0][i] = y < HEIGHT / 2 ? 34 : 12 + 16 * (float)(x + 2 * y) / (WIDTH + 2 * HEIGHT);
        if (x >= 22 && x < 27)
            s.depth.plane[0][i] = 15.5f;
    }
    return s;
}

// From the copy at radius 0 to the least blur.
static void first_blur(const struct run *r, const struct scene *s)
{
    struct pulling w = {r, s, NULL, PULL_RADIUS};
    struct picture none = at(&w, 0), least = at(&w, 1e-6);
    const int packed = is_packed(&r->subject->params);
    see(r, "radius 0 and the least above it: jump, 8-bit codes",
        packed ? "packed: two truncations to 5 bits, of the colour when it is read and of the result"
               : "half a code: what the smallest step of a float can make, see continuity.c",
        display_distance(&none, &least), packed ? fall(0, 2) : FLOAT_STEP, "radius 1e-6");
    picture_free(&none);
    picture_free(&least);
}

// ---- flicker ----

// Draw a square light of 1.4 pixels by the area that it covers of each pixel.
static void draw_light(struct picture *p, double left, double top, double side, float value)
{
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++) {
            const double w = fmin(x + 1, left + side) - fmax(x, left), h = fmin(y + 1, top + side) - fmax(y, top);
            for (int c = 0; c < 3; c++)
                p->plane[c][y * p->width + x] = w > 0 && h > 0 ? (float)(value * w * h) : 0;
        }
}

// The energy of a light behind the focus that moves 0.1 pixel a frame: its variation relative to its mean.
static void moving_light(const struct run *r)
{
    double least = INFINITY, most = 0;
    struct picture colour = picture_new(WIDTH, HEIGHT, 3), radii = picture_new(WIDTH, HEIGHT, 1);
    picture_fill(&radii, 0, STABILITY_RADIUS);
    const struct hf_depth depth = picture_radii(&radii);
    for (int i = 0; i < 40; i++) {
        draw_light(&colour, 30.03 + 0.1 * i, 20.55, 1.4, 100);
        struct picture out = render(r->c, &colour, &depth, &r->subject->params);
        double sum = 0;
        for (size_t k = 0; k < samples_of(&out); k++)
            sum += out.plane[1][k];
        least = fmin(least, sum);
        most = fmax(most, sum);
        picture_free(&out);
    }
    if (r->subject->promises & KEEPS_ENERGY)
        see(r, "flicker of a light moving 0.1 pixel a frame, of its energy",
            "1e-5 of the energy, as of one light; sampling every second pixel makes 2", (most - least) / most * 2,
            2e-5 + 12 * r->subject->step, "40 frames");
    else
        see(r, "flicker of a light moving 0.1 pixel a frame under the max fill, of its energy",
            "less than sampling every second pixel, which makes 2", (most - least) / most * 2, 1.99, "40 frames");
    picture_free(&colour);
    picture_free(&radii);
}

void continuity_cases(const struct run *r)
{
    // Other tests compare instruction sets with the C; here they would only cost time.
    if (!r->full && !r->widest)
        return;
    struct scene s = stage(r);
    for (int pull = 0; pull < PULLS; pull++)
        pulled(r, (enum pull)pull, &s, "floor, wall and bar");
    known_places(r, &s, "floor, wall and bar");
    // The gaussian's blur does not follow from the radius; only 0 means a copy.
    if (r->subject->params.engine != HF_ENGINE_GAUSSIAN)
        first_blur(r, &s);
    scene_free(&s);
    moving_light(r);
}
