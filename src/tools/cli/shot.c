// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/shot.h"

#include "tools/cli/args.h"
#include "tools/cli/clash.h"
#include "tools/cli/farm.h"
#include "tools/cli/pattern.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct maker {
    struct cli_shot *shot;
    const struct cli_shot_request *request;
    struct tool_error *error;
    int places;  // places given to frames so far
};

// The file names, or patterns, of one INPUT and one view. digits: how many a lone # stands for in the input;
// depth_digits: in the depth file.
struct names {
    char *input, *output, *depth_file, **others;
    int digits, depth_digits;
};

static int no_memory(const struct maker *m)
{
    return tool_fail(m->error, CLI_ALL_FAILED, "%s: out of memory", m->request->inputs[0]);
}

static void free_list(char **list, int count)
{
    for (int i = 0; i < count && list; i++)
        free(list[i]);
    free(list);
}

static void free_job(const struct cli_shot *shot, struct cli_job *job)
{
    free(job->input);
    free(job->output);
    free(job->depth_file);
    free_list(job->others, shot->other_count);
}

static void free_jobs(const struct cli_shot *shot, struct cli_jobs *jobs)
{
    for (int i = 0; i < jobs->count; i++)
        free_job(shot, &jobs->list[i]);
    free(jobs->list);
    *jobs = (struct cli_jobs){0};
}

void cli_shot_free(struct cli_shot *shot)
{
    free_jobs(shot, &shot->jobs);
    free_jobs(shot, &shot->around);
}

// A name that exists as a file means that file, even if it looks like a pattern.
static int is_pattern(const char *name)
{
    return (cli_pattern_has_frame(name) || cli_pattern_has_view(name)) && access(name, F_OK);
}

// The name for a frame: the pattern with the number filled in, or unchanged if the frame has no number. Sets *failed
// without memory.
static char *name_of(const char *pattern, const struct cli_job *job, int digits, int *failed)
{
    if (!pattern)
        return NULL;
    char *name = job->numbered ? cli_pattern_fill(pattern, job->frame, digits) : strdup(pattern);
    *failed |= !name;
    return name;
}

// The further pictures of a frame. A lone # stands for as many digits as in INPUT.
static char **others_of(const struct maker *m, const struct names *names, const struct cli_job *job, int *failed)
{
    const int count = m->shot->other_count;
    char **list = count ? calloc((size_t)count, sizeof(*list)) : NULL;
    *failed |= count && !list;
    for (int i = 0; i < count && list; i++)
        list[i] = name_of(names->others[i], job, names->digits, failed);
    return list;
}

static int add_job(const struct maker *m, struct cli_jobs *jobs, const struct names *names, struct cli_job job)
{
    const size_t n = (size_t)jobs->count;
    int failed = 0;
    if ((n & (n - 1)) == 0) {  // room for a power of two
        struct cli_job *list = realloc(jobs->list, (n ? 2 * n : 1) * sizeof(*list));
        if (!list)
            return no_memory(m);
        jobs->list = list;
    }
    job.input = is_pattern(names->input) ? name_of(names->input, &job, names->digits, &failed) : strdup(names->input);
    job.output = jobs == &m->shot->jobs ? name_of(names->output, &job, names->digits, &failed) : NULL;
    job.depth_file = name_of(names->depth_file, &job, names->depth_digits, &failed);
    job.others = others_of(m, names, &job, &failed);
    jobs->list[jobs->count++] = job;
    return failed || !job.input ? no_memory(m) : 0;
}

// A file of a list; its number is the last in its name.
static int add_file(struct maker *m, const char *input)
{
    const struct cli_shot_request *r = m->request;
    struct names names = {.input = (char *)input,
                          .output = (char *)r->output,
                          .depth_file = (char *)r->depth_file,
                          .others = (char **)r->others};
    struct cli_job job = {.place = m->places++};
    job.numbered = cli_name_number(input, &job.frame, &names.digits);
    names.depth_digits = names.digits;
    if (!job.numbered && r->input_count > 1 && r->output && cli_pattern_has_frame(r->output))
        return tool_fail(m->error, CLI_BAD_ARGUMENTS, "%s has no number in its name for the place in OUTPUT %s", input,
                         r->output);
    const int status = add_job(m, &m->shot->jobs, &names, job);
    return status ? status : add_job(m, &m->shot->around, &names, job);
}

static int check_places(const struct maker *m, const char *input)
{
    const struct cli_shot_request *r = m->request;
    const int pattern = is_pattern(input);
    const int in = pattern && cli_pattern_has_view(input), out = r->output && cli_pattern_has_view(r->output);
    const int in_frame = pattern && cli_pattern_has_frame(input);
    if (in && !r->views)
        return tool_fail(m->error, CLI_BAD_ARGUMENTS,
                         "INPUT %s has a place for the view's name, so --views must name them: --views left,right",
                         input);
    if (in && r->output && !out && strchr(r->views, ','))
        return tool_fail(
            m->error, CLI_BAD_ARGUMENTS,
            "INPUT %s has a place for the view's name, but OUTPUT %s has none: all views would be one file", input,
            r->output);
    if (!in && out && !pattern && r->input_count == 1)
        return tool_fail(
            m->error, CLI_BAD_ARGUMENTS,
            "OUTPUT %s has a place for the view's name, but INPUT %s is one file, and so is OUTPUT with all "
            "of its views; for a file with one of them name it in --views and -o",
            r->output, input);
    if (!in && out && (pattern || r->input_count > 1))
        return tool_fail(m->error, CLI_BAD_ARGUMENTS,
                         "OUTPUT %s has a place for the view's name, but INPUT %s has none", r->output, input);
    if (r->input_count > 1 && !in_frame && r->output && !cli_pattern_has_frame(r->output))
        return tool_fail(
            m->error, CLI_BAD_ARGUMENTS,
            "there are %d INPUTs, %s and %s%s, so OUTPUT %s needs a place for the frame number, such as ####: "
            "all would be one file",
            r->input_count, r->inputs[0], r->inputs[1], r->input_count > 2 ? " and so on" : "", r->output);
    if (in_frame && r->output && !cli_pattern_has_frame(r->output))
        return tool_fail(m->error, CLI_BAD_ARGUMENTS,
                         "OUTPUT %s has no place for the frame number, such as ####: all frames would be one file",
                         r->output);
    if (r->frames && !in_frame)
        return tool_fail(m->error, CLI_BAD_ARGUMENTS,
                         "--frames %s is of use only with a place for the number, such as ####, in INPUT, not with %s",
                         r->frames, input);
    return 0;
}

// Find which frames of a pattern exist, and how many digits they have.
static int look(struct maker *m, struct names *names, struct cli_frames *found)
{
    struct cli_frames depths;
    struct tool_error ignored;
    const int status = cli_pattern_scan(names->input, found, &names->digits, m->error);
    names->depth_digits = names->digits;
    if (status && !m->request->frames)
        return status;
    if (!m->request->frames && !found->count)
        return tool_fail(m->error, CLI_BAD_ARGUMENTS, "%s: there is no such file", names->input);
    int digits;
    if (!names->depth_file || cli_pattern_scan(names->depth_file, &depths, &digits, &ignored))
        return 0;
    if (depths.count)
        names->depth_digits = digits;
    cli_frames_free(&depths);
    return 0;
}

// The frames of a pattern, of one view.
static int add_frames(struct maker *m, struct names *names, int view)
{
    struct cli_frames found = {0}, asked = {0};
    int status = look(m, names, &found);
    if (!status && m->request->frames && cli_frames_parse(&asked, m->request->frames, m->error))
        status = CLI_BAD_ARGUMENTS;
    if (!status && !m->shot->missing)
        m->shot->missing = m->request->frames ? cli_frames_missing(&asked, &found, m->shot->gaps, sizeof(m->shot->gaps))
                                              : cli_frames_gaps(&found, m->shot->gaps, sizeof(m->shot->gaps));
    if (m->shot->missing < 0)
        status = no_memory(m);
    const struct cli_frames *wanted = m->request->frames ? &asked : &found;
    for (int i = 0; i < wanted->count && !status; i++)
        status = add_job(m, &m->shot->jobs, names,
                         (struct cli_job){wanted->list[i], 1, m->places + i, view >= 0, view, NULL, NULL, NULL, NULL});
    for (int i = 0; i < found.count && !status; i++)
        status = add_job(m, &m->shot->around, names,
                         (struct cli_job){found.list[i], 1, 0, view >= 0, view, NULL, NULL, NULL, NULL});
    cli_frames_free(&found);
    cli_frames_free(&asked);
    return status;
}

// The patterns of further pictures, with the view's name filled in; NULL without memory, or if there are none.
static char **others_in_view(const struct cli_shot_request *r, const char *view)
{
    char **list = r->other_count ? calloc((size_t)r->other_count, sizeof(*list)) : NULL;
    for (int i = 0; i < r->other_count && list; i++)
        if (!(list[i] = cli_pattern_view(r->others[i], view))) {
            free_list(list, i);
            return NULL;
        }
    return list;
}

// Add the jobs of a pattern: those of each view in turn if the pattern has a place for the view, else once.
static int add_pattern(struct maker *m, const char *input)
{
    const struct cli_shot_request *r = m->request;
    const int most = m->shot->jobs.count;
    const int views = cli_pattern_has_view(input);
    int status = 0, more = 1, number = views ? 0 : -1;  // -1: the files hold all views
    for (const char *view = views ? r->views : ""; more && !status;) {
        char *name = strndup(view, strcspn(view, ","));
        struct names n = {.input = name ? cli_pattern_view(input, name) : NULL};
        n.output = name && r->output ? cli_pattern_view(r->output, name) : NULL;
        n.depth_file = name && r->depth_file ? cli_pattern_view(r->depth_file, name) : NULL;
        n.others = name ? others_in_view(r, name) : NULL;
        const int whole =
            n.input && !n.output == !r->output && !n.depth_file == !r->depth_file && !n.others == !r->other_count;
        if (!whole)
            status = no_memory(m);
        else if (cli_pattern_has_frame(n.input))
            status = add_frames(m, &n, number);
        else
            status = add_job(m, &m->shot->jobs, &n,
                             (struct cli_job){.place = m->places, .view_file = views, .view = number});
        number++;
        more = view[strcspn(view, ",")] == ',';
        view += strcspn(view, ",") + 1;
        free(n.input);
        free(n.output);
        free(n.depth_file);
        free_list(n.others, r->other_count);
        free(name);
    }
    for (int i = most; i < m->shot->jobs.count; i++)
        if (m->places <= m->shot->jobs.list[i].place)
            m->places = m->shot->jobs.list[i].place + 1;
    return status;
}

static int by_place(const void *a, const void *b)
{
    const struct cli_job *x = a, *y = b;
    return x->place != y->place ? (x->place > y->place) - (x->place < y->place) : x->view - y->view;
}

// Keep only the frames that --chunk gives to this process.
static int cut(struct maker *m)
{
    struct cli_jobs *jobs = &m->shot->jobs;
    int part, parts, kept = 0;
    if (!m->request->chunk)
        return 0;
    if (cli_chunk_parse(m->request->chunk, &part, &parts, m->error))
        return CLI_BAD_ARGUMENTS;
    const long long from = (long long)m->places * part / parts, to = (long long)m->places * (part + 1) / parts;
    for (int i = 0; i < jobs->count; i++) {
        if (jobs->list[i].place >= from && jobs->list[i].place < to) {
            const struct cli_job job = jobs->list[i];
            jobs->list[i] = jobs->list[kept];
            jobs->list[kept++] = job;
        }
    }
    for (int i = kept; i < jobs->count; i++)
        free_job(m->shot, &jobs->list[i]);
    jobs->count = kept;
    return 0;
}

int cli_shot_make(struct cli_shot *shot, const struct cli_shot_request *request, struct tool_error *error)
{
    struct maker m = {.shot = shot, .request = request, .error = error};
    *shot = (struct cli_shot){.sequence = request->input_count > 1,
                              .other_count = request->other_count,
                              .other_option = request->other_option};
    int status = 0;
    for (int i = 0; i < request->input_count && !status; i++) {
        const char *input = request->inputs[i];
        status = check_places(&m, input);
        if (!status && is_pattern(input)) {
            shot->sequence = 1;
            status = add_pattern(&m, input);
        } else if (!status) {
            status = add_file(&m, input);
        }
    }
    if (!status && shot->jobs.count)
        qsort(shot->jobs.list, (size_t)shot->jobs.count, sizeof(*shot->jobs.list), by_place);
    if (!status && request->output && shot->sequence)
        status = cli_check_clashes(shot, request->log_file, error);
    return status ? status : cut(&m);
}
