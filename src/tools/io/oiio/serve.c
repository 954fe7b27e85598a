// SPDX-License-Identifier: BSD-3-Clause
// hyperfocal-oiio, the helper program: it loads OpenImageIO once and then makes a child for every job, with limits of
// its own, in a sandbox (sandbox.h). A file that crashes a reader, or makes it ask for endless memory or time, ends that
// child and nothing else; one that takes the child over gains nothing by it.
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "tools/common/standard.h"
#include "tools/io/oiio/sandbox.h"
#include "tools/io/oiio/wire.h"

struct job {
    int fd;    // the socket
    int file;  // the one to read; -1: none
    char path[HF_WIRE_PATH];
    struct hf_io_views views;
    struct hf_oiio *oiio;
};

// Of this process; opened before the sandbox closes.
static int status_file = -1;

static long long data_kilobytes(void)
{
    char text[8192];
    long long kb = 0;
    const ssize_t n = pread(status_file, text, sizeof(text) - 1, 0);
    text[n > 0 ? n : 0] = 0;
    const char *line = strstr(text, "VmData:");
    return line && sscanf(line, "VmData: %lld", &kb) == 1 ? kb : 0;
}

static void lower(int what, unsigned long long to)
{
    struct rlimit r;
    getrlimit(what, &r);
    r.rlim_cur = to < r.rlim_max ? to : r.rlim_max;
    setrlimit(what, &r);
}

// More memory than this beyond what the process has, and more seconds of computing beyond what it used, are not to be
// had: 384 MB and 3 s, and what the picture's size and the file's justify.
static void set_limits(uint64_t picture_bytes, uint64_t file_bytes)
{
    const uint64_t work = picture_bytes < 256 * file_bytes ? picture_bytes : 256 * file_bytes;
    struct rusage used;
    getrusage(RUSAGE_SELF, &used);
    lower(RLIMIT_CORE, 0);
    lower(RLIMIT_DATA,
          (unsigned long long)data_kilobytes() * 1024 + ((uint64_t)384 << 20) + 2 * file_bytes + picture_bytes);
    lower(RLIMIT_CPU,
          (unsigned long long)used.ru_utime.tv_sec + (unsigned long long)used.ru_stime.tv_sec + 4 + work / 5000000);
}

static uint64_t file_size(const struct job *job)
{
    struct stat st;
    return fstat(job->file, &st) ? 0 : (uint64_t)st.st_size;
}

static uint64_t plane_bytes(const struct hf_io_view *v)
{
    return (uint64_t)v->width * (uint64_t)v->height * sizeof(float);
}

static int send_reply(const struct job *job, struct hf_wire_reply *r, const void *data)
{
    if (r->status)
        r->size = 0;
    return hf_wire_put(job->fd, r, sizeof(*r)) || (r->size && hf_wire_put(job->fd, data, r->size)) ? -1 : 0;
}

static int serve_open(struct job *job, const struct hf_wire_request *q)
{
    static struct hf_wire_reply r;
    memcpy(job->path, q->path, sizeof(job->path));
    set_limits(0, file_size(job));
    r.status = job->oiio ? hf_io_fail(&r.err, "%s: opened twice", q->path)
                         : hf_oiio_open(&job->oiio, job->path, q->has_name ? q->name : NULL, &job->views, &r.err);
    if (!r.status) {
        hf_oiio_channels(job->oiio, r.channels, sizeof(r.channels));
        r.bits = hf_oiio_bits(job->oiio);
        hf_oiio_size(job->oiio, &r.width, &r.height);
        r.has_view = job->views.count > 0;
        if (r.has_view)
            r.view = job->views.view[0];
    }
    return send_reply(job, &r, NULL);
}

static int serve_colour(struct job *job, const struct hf_wire_request *q)
{
    struct hf_wire_reply r = {.status = -1};
    float *planes[4] = {0}, *memory = NULL;
    int n = 0;
    if (job->views.count) {
        const struct hf_io_view *v = &job->views.view[0];
        const size_t size = (size_t)v->width * (size_t)v->height;
        set_limits(12 * plane_bytes(v), file_size(job));
        for (int k = 0; k < 4; k++)
            n += (q->planes >> k & 1) && v->colour[k][0];
        memory = hf_io_alloc((size_t)n * size * sizeof(float) + 1);
        for (int k = 0, i = 0; k < 4 && memory; k++)
            if ((q->planes >> k & 1) && v->colour[k][0])
                planes[k] = memory + (size_t)i++ * size;
        r.size = (uint64_t)n * plane_bytes(v);
        r.status = memory ? hf_oiio_read_colour(job->oiio, planes, &r.err)
                          : hf_io_fail(&r.err, "%s: out of memory", job->path);
    }
    const int status = send_reply(job, &r, memory);
    free(memory);
    return status;
}

static int serve_depth(struct job *job, const struct hf_wire_request *q)
{
    struct hf_wire_reply r = {.status = -1};
    const bool own = q->op == HF_WIRE_DEPTH;
    const struct hf_io_view *v = !own ? &q->view : job->views.count ? &job->views.view[0] : NULL;
    float *memory = NULL;
    if (job->oiio && v) {
        set_limits(12 * plane_bytes(v), file_size(job));
        memory = hf_io_alloc(plane_bytes(v) + 1);
        r.size = plane_bytes(v);
        r.status = !memory ? hf_io_fail(&r.err, "%s: out of memory", job->path)
                   : own   ? hf_oiio_read_depth(job->oiio, memory, &r.err)
                           : hf_oiio_read_depth_only(job->oiio, q->has_name ? q->name : NULL, v, memory, &r.err);
    }
    const int status = send_reply(job, &r, memory);
    free(memory);
    return status;
}

static int serve_format(struct job *job, const struct hf_wire_request *q)
{
    struct hf_wire_reply r = {0};
    r.status = hf_oiio_check_format(q->path, &r.err);
    return send_reply(job, &r, NULL);
}

static int serve_write(struct job *job, const struct hf_wire_request *q)
{
    struct hf_wire_reply r = {0};
    struct hf_oiio_picture p = {.path = q->path,
                                .view = &q->view,
                                .bits = q->bits,
                                .compression = q->has_name ? q->name : NULL,
                                .source = q->source[0] ? q->source : NULL};
    const size_t size = plane_bytes(&q->view);
    float *memory = hf_io_alloc(4 * size + 1);
    struct hf_io_bytes made = {0};
    r.status = memory ? 0 : hf_io_fail(&r.err, "%s: out of memory", q->path);
    for (int k = 0; k < 4 && memory; k++) {
        float *plane = memory + (size_t)k * size / sizeof(float);
        p.planes[k] = q->planes >> k & 1 ? plane : NULL;
        if (p.planes[k] && hf_wire_get(job->fd, plane, size))
            return -1;
    }
    if (!r.status)
        r.status = hf_oiio_write(&made, &p, &r.err);
    r.size = made.size;
    const int status = send_reply(job, &r, made.data);
    free(made.data);
    free(memory);
    return status;
}

static int serve_samples(struct job *job, const struct hf_wire_request *q)
{
    struct hf_wire_reply r = {0};
    struct hf_io_samples s = q->samples;
    struct hf_wire_name name;
    static char names[HF_WIRE_CHANNELS][sizeof(name.text)];
    static const char *pointers[HF_WIRE_CHANNELS];
    static uint8_t types[HF_WIRE_CHANNELS];
    struct hf_io_bytes made = {0};
    for (int c = 0; c < s.channel_count; c++) {
        if (hf_wire_get(job->fd, &name, sizeof(name)))
            return -1;
        memcpy(names[c], name.text, sizeof(names[c]));
        pointers[c] = names[c];
        types[c] = name.type;
    }
    const size_t size = (size_t)s.height * s.row_bytes;
    s.names = pointers;
    s.types = types;
    s.data = hf_io_alloc(size + 1);
    r.status = s.data ? 0 : hf_io_fail(&r.err, "%s: out of memory", q->path);
    if (!r.status && q->op == HF_WIRE_READ) {
        set_limits(4 * size + ((uint64_t)256 << 20), file_size(job));
        r.status = hf_oiio_read_samples(q->path, q->part, &s, &r.err);
        r.size = size;
    } else if (!r.status) {
        if (hf_wire_get(job->fd, s.data, size))
            return -1;
        r.status = hf_oiio_write_samples(&made, q->path, &s, q->name, q->level, &r.err);
        r.size = made.size;
    }
    const int status = send_reply(job, &r, made.data ? made.data : s.data);
    free(made.data);
    free(s.data);
    return status;
}

// All requests of one job, until the program closes the socket.
static void serve(int fd, int file)
{
    static struct job job;
    static struct hf_wire_request q;
    status_file = open("/proc/self/status", O_RDONLY | O_CLOEXEC);
    hf_oiio_use_file(file);
    const char in_force = (char)hf_sandbox_enter(file);
    int status = hf_wire_put(fd, &in_force, 1);  // the job has a process: what ends from here on is the file's fault
    job.fd = fd;
    job.file = file;
    while (!status && !hf_wire_get(fd, &q, sizeof(q))) {
        switch ((enum hf_wire_op)q.op) {
        case HF_WIRE_OPEN:
            status = serve_open(&job, &q);
            break;
        case HF_WIRE_COLOUR:
            status = serve_colour(&job, &q);
            break;
        case HF_WIRE_DEPTH:
        case HF_WIRE_DEPTH_ONLY:
            status = serve_depth(&job, &q);
            break;
        case HF_WIRE_FORMAT:
            status = serve_format(&job, &q);
            break;
        case HF_WIRE_WRITE:
            status = serve_write(&job, &q);
            break;
        case HF_WIRE_READ:
        case HF_WIRE_MAKE:
            status = serve_samples(&job, &q);
            break;
        }
    }
}

// The socket of the next job, or -1 when the program has ended; *file is the file to read, or -1.
static int next_job(int *file)
{
    char byte, control[CMSG_SPACE(2 * sizeof(int))];
    struct iovec part = {&byte, 1};
    struct msghdr m = {.msg_iov = &part, .msg_iovlen = 1, .msg_control = control, .msg_controllen = sizeof(control)};
    ssize_t n;
    do {
        n = recvmsg(HF_WIRE_CONTROL, &m, MSG_CMSG_CLOEXEC);
    } while (n < 0 && errno == EINTR);
    const struct cmsghdr *c = n > 0 ? CMSG_FIRSTHDR(&m) : NULL;
    int fds[2] = {-1, -1};
    if (c && c->cmsg_level == SOL_SOCKET && c->cmsg_type == SCM_RIGHTS)
        memcpy(fds, CMSG_DATA(c), c->cmsg_len > CMSG_LEN(sizeof(int)) ? sizeof(fds) : sizeof(int));
    *file = fds[1];
    return fds[0];
}

int main(int argc, char **argv)
{
    tool_open_standard();
    if (argc == 2 && !strcmp(argv[1], "--try-sandbox"))
        return hf_sandbox_try();
    // A terminal's Ctrl-C goes to the program, which decides; when it ends, so do we. SIGXFSZ kills: a writer that
    // does not look at what write() returns must not succeed.
    signal(SIGINT, SIG_IGN);
    signal(SIGHUP, SIG_IGN);
    signal(SIGPIPE, SIG_IGN);
    signal(SIGCHLD, SIG_IGN);
    signal(SIGXFSZ, SIG_DFL);
    char hello[HF_WIRE_HELLO] = "", question;
    hf_wire_hello(hello);
    if (recv(HF_WIRE_CONTROL, &question, 1, 0) != 1 ||
        send(HF_WIRE_CONTROL, hello, sizeof(hello), MSG_NOSIGNAL) != (ssize_t)sizeof(hello))
        return 1;
    hf_oiio_prepare();
    for (int fd, file; (fd = next_job(&file)) >= 0;) {
        if (fork() == 0) {
            close(HF_WIRE_CONTROL);
            serve(fd, file);
            _exit(0);
        }
        close(fd);
        if (file >= 0)
            close(file);
    }
    return 0;
}
