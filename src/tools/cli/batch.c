// SPDX-License-Identifier: BSD-3-Clause
// One worker makes a frame from beginning to end, and plan.h says how many workers there are. So frames wait only for
// the disk, and their bits do not depend on the number of workers. The workers share the threads equally.
#include "tools/cli/batch.h"

#include <errno.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "tools/cli/frame.h"
#include "tools/cli/guessed.h"
#include "tools/cli/log.h"
#include "tools/cli/plan.h"
#include "tools/cli/progress.h"
#include "tools/cli/resume.h"
#include "tools/cli/room.h"
#include "tools/cli/summary.h"
#include "tools/cli/warn.h"
#include "tools/common/machine.h"
#include "tools/common/report.h"

enum { MAX_STEPS = 16 };
static const double GIB = 1024. * 1024 * 1024;

struct batch {
    const struct cli_args *args;
    const struct cli_shot *shot;
    struct cli_plan plan;
    struct cli_session *sessions;
    int workers, threads;          // sessions, and threads of each
    int at_once, threads_of_each;  // the same for most of the frames
    int next;                      // the first job that is not done yet
    struct cli_progress progress;
    struct cli_log log;
    atomic_int stop;               // after an error
    atomic_int bad_arguments;      // frames that failed because of the command line
    atomic_int chosen[MAX_STEPS];  // frames by step of the time budget
    atomic_int missed[2];          // [0]: frames over the time budget; [1]: of these, at the cheapest step
    struct cli_guess *guesses;     // --guessed: of each frame the view of which most was guessed
    int measuring;                 // one frame at a time, to measure its memory:
    double frame_bytes;
    int helped;  // another process reads or writes the frames
    struct cli_room room;
};

static volatile sig_atomic_t stop_signal;
static struct timespec stop_time;
static volatile sig_atomic_t told_nothing;  // --quiet

// May be called in a signal handler.
static void tell(const char *text)
{
    static const char clear[] = "\r\033[K";
    ssize_t ignored = 0;
    if (told_nothing)
        return;
    if (atomic_load(&tool_bar_shown))
        ignored = write(STDERR_FILENO, clear, sizeof(clear) - 1);
    ignored = write(STDERR_FILENO, text, strlen(text));
    (void)ignored;
}

// The first signal lets the frames in work finish. A second one removes half-written files and ends the process.
// Programs such as timeout signal both the process and its group, so a signal within 0.3 s counts as the first.
static void on_signal(int number)
{
    struct timespec now;
    const int code = errno;
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (!stop_signal) {
        stop_time = now;
        stop_signal = number;
        tell("hyperfocal: finishing the frames in work; a second signal stops at once\n");
    } else if ((double)(now.tv_sec - stop_time.tv_sec) + 1e-9 * (double)(now.tv_nsec - stop_time.tv_nsec) > 0.3) {
        tell("hyperfocal: stopped; the same command with --resume makes the other frames\n");
        hf_io_end_by_signal(number);
    }
    errno = code;
}

static void watch_signals(int quiet)
{
    static const int numbers[] = {SIGINT, SIGTERM};
    struct sigaction was, ours = {.sa_handler = on_signal, .sa_flags = SA_RESTART};
    sigemptyset(&ours.sa_mask);
    // Neither signal interrupts the handler of the other.
    for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++)
        sigaddset(&ours.sa_mask, numbers[i]);
    stop_signal = 0;
    told_nothing = quiet;
    // The shot goes on when the reader of our messages closes the pipe.
    signal(SIGPIPE, SIG_IGN);
    for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++)
        // A signal that our parent set to be ignored stays ignored.
        if (!sigaction(numbers[i], NULL, &was) && was.sa_handler != SIG_IGN)
            sigaction(numbers[i], &ours, NULL);
}

static double peak_memory(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) ? 0 : 1024. * (double)usage.ru_maxrss;
}

// Wait for memory. The session's library context may have been given up for other frames meanwhile.
static int enter_room(struct batch *b, int worker, const struct cli_frame *frame, struct cli_record *record,
                      struct tool_error *error)
{
    struct cli_session *session = &b->sessions[worker];
    const double start = tool_now_ms();
    cli_room_enter(&b->room, worker, frame);
    record->waited_ms = tool_now_ms() - start;
    if (session->context)
        return 0;
    cli_session_close(session);
    return cli_session_open(session, b->args, b->threads, error);
}

static int make_frame(struct batch *b, struct cli_frame *frame, int worker, const struct cli_args *args,
                      struct cli_record *record, struct tool_error *error)
{
    struct cli_session *session = &b->sessions[worker];
    const struct cli_stamp *stamp = record->stamp;
    int status = cli_frame_open(frame, args, &session->run, error);
    if (!status)
        status = enter_room(b, worker, frame, record, error);
    if (!status)
        status = cli_frame_setup(frame, error);
    if (!status)
        status = cli_frame_render(frame, session, error);
    if (!status)
        status = cli_frame_encode(frame, stamp->texts, CLI_STAMP_TEXTS, error);
    return status ? status : cli_frame_save(frame, error);
}

// The text that the progress line shows about a finished frame.
static void describe(const struct cli_frame *frame, const struct tool_report *report, double ms, char *text,
                     size_t size)
{
    const struct cli_setup *setup = &frame->views[0].setup;
    int n = snprintf(text, size, "%.2f s", ms / 1000);
    if (setup->focus_from && setup->params.focus != HF_DERIVE)
        n += snprintf(text + n, size - (size_t)n, ", focus %.4g", setup->params.focus);
    if (report->all.budget_step)
        snprintf(text + n, size - (size_t)n, ", for the budget %s (step %d)", report->inner.budget_options,
                 report->all.budget_step);
}

static void finish(struct batch *b, struct cli_frame *frame, const struct cli_session *session, struct cli_record *r,
                   const char *why)
{
    struct tool_report report = {0};
    char text[256] = "";
    const char *shown = text;
    switch (r->status) {
    case CLI_FRAME_DONE:
        tool_report_get(session->context, &report);
        r->report = &report;
        // The process's peak may come from an earlier look at the shot, so this frame's memory is calculated.
        if (b->measuring) {
            b->frame_bytes = cli_plan_frame_bytes(frame, (double)report.all.memory_held);
            b->helped = hf_io_is_helped(frame->file, frame->args->output, frame->args->compression);
        }
        describe(frame, &report, r->ms, text, sizeof(text));
        atomic_fetch_add(&b->chosen[report.all.budget_step < MAX_STEPS ? report.all.budget_step : MAX_STEPS - 1], 1);
        for (int i = 0; i < frame->view_count; i++)
            if (cli_missed_budget(&frame->views[i])) {
                atomic_fetch_add(&b->missed[0], 1);
                atomic_fetch_add(&b->missed[1], report.all.budget_step + 1 == report.all.budget_steps);
                break;
            }
        for (int i = 0; i < frame->view_count; i++) {
            struct cli_guess *most = &b->guesses[r->job - b->shot->jobs.list];
            *most = frame->views[i].guess.share > most->share ? frame->views[i].guess : *most;
        }
        for (int s = 0; s < CLI_STAGES; s++)
            atomic_fetch_add(&b->progress.us[s], (long long)(1000 * frame->ms[s]));
        atomic_fetch_add(&b->progress.rendered, 1);
        atomic_fetch_add(&b->progress.done, 1);
        break;
    case CLI_FRAME_SKIPPED:
        shown = "is there already";
        atomic_fetch_add(&b->progress.skipped, 1);
        break;
    case CLI_FRAME_FAILED:
        r->why = why;
        shown = "failed";
        atomic_fetch_add(&b->progress.failed, 1);
        tool_print_line("%s", why);
        if (b->args->stop_on_error)
            atomic_store(&b->stop, 1);
        break;
    }
    cli_log_frame(&b->log, r);
    cli_progress_frame(&b->progress, frame->args->output, shown);
}

static void run_job(void *arg, int i, int worker)
{
    struct batch *b = arg;
    struct cli_session *session = &b->sessions[worker];
    struct cli_args args;
    struct cli_stamp stamp;
    struct tool_error error = {""};
    i += b->next;
    if (atomic_load(&b->stop) || stop_signal)
        return;
    cli_plan_args(&b->plan, i, &args);
    struct cli_frame frame = {.args = &args};
    struct cli_record record = {.job = &b->shot->jobs.list[i], .frame = &frame};
    const double start = tool_now_ms();
    int status = cli_stamp_make(&stamp, &args) ? tool_fail(&error, CLI_ALL_FAILED, "%s: out of memory", args.input) : 0;
    record.stamp = &stamp;
    if (!status && args.resume && cli_stamp_fits(&stamp, args.output)) {
        record.status = CLI_FRAME_SKIPPED;
    } else if (!status) {
        status = make_frame(b, &frame, worker, &args, &record, &error);
        frame.args = &args;
        if (!status)
            cli_print_summary(&frame, cli_print_warnings(&frame));
    }
    if (status) {
        record.status = CLI_FRAME_FAILED;
        atomic_fetch_add(&b->bad_arguments, status == CLI_BAD_ARGUMENTS);
    }
    record.ms = tool_now_ms() - start;
    finish(b, &frame, session, &record, error.text);
    // A context that room.h took away has no report, and neither has a frame that failed.
    struct hf_report report = {.size = sizeof(report)};
    if (record.status == CLI_FRAME_DONE)
        hf_get_report(session->context, &report);
    const double held = record.status == CLI_FRAME_DONE ? (double)report.memory_held : -1,
                 size = cli_room_pixels(&frame);
    cli_frame_close(&frame);
    cli_room_leave(&b->room, worker, size, held);
    cli_stamp_free(&stamp);
}

static void close_sessions(struct batch *b)
{
    for (int i = 0; i < b->workers && b->sessions; i++)
        cli_session_close(&b->sessions[i]);
    free(b->sessions);
    b->sessions = NULL;
    b->workers = 0;
}

static int open_sessions(struct batch *b, int workers, int threads, struct tool_error *error)
{
    close_sessions(b);
    b->sessions = calloc((size_t)workers, sizeof(*b->sessions));
    if (!b->sessions)
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", b->args->input);
    for (; b->workers < workers; b->workers++) {
        const int status = cli_session_open(&b->sessions[b->workers], b->args, threads, error);
        if (status)
            return status;
    }
    b->threads = hf_context_threads(b->sessions[0].context);
    if (cli_room_workers(&b->room, b->sessions, workers))
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", b->args->input);
    return 0;
}

// Make frames one at a time until one succeeds and shows how much memory a frame takes.
static void run_first(struct batch *b)
{
    const double before = peak_memory();
    const int count = b->shot->jobs.count;
    b->measuring = 1;
    while (b->next < count && !atomic_load(&b->progress.rendered) && !atomic_load(&b->stop) && !stop_signal) {
        run_job(b, 0, 0);
        b->next++;
    }
    b->measuring = 0;
    b->frame_bytes = fmax(peak_memory() - before, b->frame_bytes);
}

// The time in which frames waited for the disk, divided by the time in which they were computed.
static double waiting(const struct cli_progress *p)
{
    const double computing = (double)(p->us[CLI_DECODE] + p->us[CLI_DEFOCUS] + p->us[CLI_ENCODE]);
    return computing > 0 ? (double)(p->us[CLI_READ] + p->us[CLI_WRITE]) / computing : 0;
}

// Make the next `count` frames, `workers` of them at once.
static int run_some(struct batch *b, int count, int workers, struct tool_error *error)
{
    const int threads = cli_plan_threads(b->args) / workers;
    struct hf_io_run run = {0};
    if (workers != b->workers) {
        const int status = open_sessions(b, workers, threads > 1 ? threads : 1, error);
        if (status)
            return status;
    }
    if (workers > 1)
        hf_io_threads_open(&run, workers);
    hf_io_run(&run, count, run_job, b);
    hf_io_threads_close(&run);
    b->next += count;
    return 0;
}

static int run_rest(struct batch *b, struct tool_error *error)
{
    const int left = b->shot->jobs.count - b->next, threads = cli_plan_threads(b->args);
    b->at_once = b->workers;
    b->threads_of_each = b->threads;
    if (left <= 0)
        return 0;
    const int workers =
        cli_plan_workers(b->args, left, b->helped, waiting(&b->progress) / b->threads, b->room.base, b->frame_bytes);
    // If the last round has fewer frames than workers, each of its frames gets more threads.
    const int last = left % workers, alone = last && threads / last > 1 && threads / last > threads / workers;
    int status = run_some(b, alone ? left - last : left, workers, error);
    b->at_once = b->workers;
    b->threads_of_each = b->threads;
    if (!status && alone)
        status = run_some(b, last, last, error);
    return status;
}

static const char *plural(int count)
{
    return count == 1 ? "" : "s";
}

// The frame of which most was guessed, and what would help.
static void print_guessed(const struct batch *b)
{
    const struct cli_jobs *jobs = &b->shot->jobs;
    int most = 0;
    double sum = 0;
    char about[80], text[256];
    for (int i = 0; i < jobs->count; i++) {
        sum += b->guesses[i].share;
        most = b->guesses[i].share > b->guesses[most].share ? i : most;
    }
    snprintf(about, sizeof(about), ", %.2g %% of all frames", 100 * sum / b->progress.done);
    cli_guessed_sentence(&b->guesses[most], about, text, sizeof(text));
    if (jobs->list[most].numbered)
        tool_print_line("frame %d: %s", jobs->list[most].frame, text);
    else
        tool_print_line("%s: %s", jobs->list[most].input, text);
}

static void print_summary(struct batch *b)
{
    const struct cli_progress *p = &b->progress;
    const int done = p->done, skipped = p->skipped, failed = p->failed;
    const double seconds = (tool_now_ms() - p->start) / 1000;
    double all = 0;
    char shares[128] = "";
    for (int s = 0; s < CLI_STAGES; s++)
        all += (double)p->us[s];
    for (int s = 0; s < CLI_STAGES && all > 0; s++)
        snprintf(shares + strlen(shares), sizeof(shares) - strlen(shares), "%s%s %.0f %%", s ? ", " : "",
                 cli_stage_names[s], 100 * (double)p->us[s] / all);
    tool_print_line("%d done, %d there already, %d failed of %d frame%s in %.2f s (%.2f frames/s)", done, skipped,
                    failed, p->total, plural(p->total), seconds, seconds > 0 ? done / seconds : 0);
    if (done)
        tool_print_line("%d at a time on %d thread%s each, peak memory %.0f MiB; %s", b->at_once, b->threads_of_each,
                        plural(b->threads_of_each), peak_memory() / GIB * 1024, shares);
    if (done && b->args->guessed)
        print_guessed(b);
    for (int s = 0; s < MAX_STEPS && b->args->params.run.budget_ms > 0; s++)
        if (b->chosen[s])
            tool_print_line("--budget-ms %g: %d frame%s %s%.0d", b->args->params.run.budget_ms, (int)b->chosen[s],
                            plural(b->chosen[s]), s ? "at step " : "as asked for", s);
    if (b->missed[0])
        tool_print_line("--budget-ms %g: %d frame%s took longer%s", b->args->params.run.budget_ms, (int)b->missed[0],
                        plural(b->missed[0]), b->missed[1] ? ", and nothing cheaper blurs as far as is asked for" : "");
    if (done + skipped + failed < p->total)
        tool_print_line("stopped%s; the same command with --resume makes the other %d frame%s",
                        stop_signal ? " by a signal" : "", p->total - done - skipped,
                        plural(p->total - done - skipped));
}

static int exit_code(const struct batch *b)
{
    const struct cli_progress *p = &b->progress;
    const int good = p->done + p->skipped;
    if (good == p->total)
        return CLI_DONE;
    if (good)
        return CLI_SOME_FAILED;
    return p->failed && b->bad_arguments == p->failed ? CLI_BAD_ARGUMENTS : CLI_ALL_FAILED;
}

// Keep freed memory in the process, so that the next frame reuses it. New pages would have to be cleared by the system
// first, which takes a quarter of the time of an uncompressed shot.
static void keep_memory(void)
{
#ifdef __GLIBC__
    mallopt(M_ARENA_MAX, 1);
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, -1);
#endif
}

int cli_batch_wanted(const struct cli_args *args, const struct cli_shot *shot)
{
    return shot->sequence || args->resume || args->log_file || args->keys || args->chunk;
}

int cli_batch(int argc, char **argv, const struct cli_args *args, const struct cli_shot *shot, struct tool_error *error)
{
    struct batch b = {.args = args, .shot = shot};
    error->text[0] = '\0';
    keep_memory();
    b.guesses = calloc((size_t)shot->jobs.count + 1, sizeof(*b.guesses));
    if (!b.guesses)
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", args->input);
    cli_room_open(&b.room, cli_plan_memory_limit(args));
    int status = cli_plan_open(&b.plan, args, shot, error);
    if (!status)
        status = cli_log_open(&b.log, args->log_file, argc, argv, shot->jobs.count, error);
    if (!status)
        status = open_sessions(&b, 1, cli_plan_threads(args), error);
    if (!status) {
        const int strays = args->resume ? cli_remove_strays(shot) : 0;
        if (strays)
            tool_print_line("files left by killed processes: %d removed", strays);
        watch_signals(args->quiet);
        cli_progress_begin(&b.progress, shot->jobs.count, args->quiet);
        run_first(&b);
        status = run_rest(&b, error);
        cli_progress_end(&b.progress);
        if (!args->quiet)
            print_summary(&b);
        if (args->verbose)
            cli_print_sandbox();
        cli_log_end(&b.log, &b.progress, b.at_once, b.missed[0], peak_memory());
        if (!status)
            status = exit_code(&b);
    }
    struct tool_error lost = {""};
    const int log_status = cli_log_close(&b.log, &lost);
    if (log_status && !error->text[0]) {
        *error = lost;
        status = status ? status : log_status;
    }
    close_sessions(&b);
    cli_room_close(&b.room);
    cli_plan_close(&b.plan);
    free(b.guesses);
    return status;
}
