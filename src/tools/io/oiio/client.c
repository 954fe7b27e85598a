// SPDX-License-Identifier: BSD-3-Clause
// The program's side of the helper: starts it when the first file needs it, and asks. What it answers is not trusted
// further than what a file says: it may have been taken over by one.
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "tools/io/oiio/sandbox.h"
#include "tools/io/oiio/wire.h"

#define HELPER "hyperfocal-oiio"

enum { GREETING_MS = 120000 };

struct hf_oiio {
    const char *path;
    int fd;
    int bits, width, height;
    struct hf_io_view view;
    char channels[2048];
};

// The folder of the program, and where from there the helper may be: installed, built.
static int find_helper(char *path, size_t size)
{
    static const char *const folders[] = {"", "../libexec/hyperfocal/", "../io/", "../src/tools/io/",
                                          "../../src/tools/io/"};
    char self[HF_WIRE_PATH];
    const ssize_t n = readlink("/proc/self/exe", self, sizeof(self) - 1);
    char *slash;
    self[n > 0 ? n : 0] = 0;
    slash = strrchr(self, '/');
    for (size_t i = 0; HF_HAVE_OIIO && slash && i < sizeof(folders) / sizeof(folders[0]); i++) {
        const int length = snprintf(path, size, "%.*s%s" HELPER, (int)(slash - self + 1), self, folders[i]);
        if (length > 0 && (size_t)length < size && !access(path, X_OK))
            return 0;
    }
    return -1;
}

int hf_oiio_available(void)
{
    char path[HF_WIRE_PATH + 64];
    return !find_helper(path, sizeof(path));
}

// ---- the helper's process: one for the program, found by its control socket

static atomic_flag starting = ATOMIC_FLAG_INIT;
static int control = -1;
static pid_t helper;               // its process, 0: none; under `starting`
static char other[HF_WIRE_HELLO];  // what a helper of another build said, under `starting`

// Is the helper of our build? Loading its libraries may take long on a busy machine or from a slow disk, so it is asked:
// one of a build that does not answer yet takes the question for a job without a socket, and ends at once.
static int greet(int fd)
{
    char own[HF_WIRE_HELLO] = "", hello[HF_WIRE_HELLO] = "";
    struct pollfd ready = {.fd = fd, .events = POLLIN};
    int n;
    if (send(fd, "?", 1, MSG_NOSIGNAL) != 1)
        return -1;
    do {
        n = poll(&ready, 1, GREETING_MS);
    } while (n < 0 && errno == EINTR);
    const ssize_t size = n > 0 ? recv(fd, hello, sizeof(hello) - 1, 0) : 0;
    hf_wire_hello(own);
    if (size > 0 && !strcmp(own, hello))
        return 0;
    // It ended: that is no matter of versions.
    if (n > 0 && size <= 0)
        return -1;
    for (char *c = hello; *c; c++)
        *c = (unsigned char)*c < 0x20 ? '?' : *c;
    snprintf(other, sizeof(other), "%s", hello[0] ? hello : "unknown");
    return -1;
}

// Let go of a helper that ended or does not answer: it does not stay as a zombie.
static void end_helper(void)
{
    if (control >= 0)
        close(control);
    control = -1;
    if (helper > 0) {
        kill(helper, SIGKILL);
        while (waitpid(helper, NULL, 0) < 0 && errno == EINTR) {
        }
    }
    helper = 0;
}

static int start_helper(void)
{
    extern char **environ;
    char path[HF_WIRE_PATH + 64], *argv[] = {HELPER, NULL};
    posix_spawn_file_actions_t actions;
    int pair[2], failed;
    if (find_helper(path, sizeof(path)) || socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair))
        return -1;
    failed = posix_spawn_file_actions_init(&actions);
    if (!failed) {
        failed = posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", 0, 0) ||
                 posix_spawn_file_actions_adddup2(&actions, 0, 2) || posix_spawn_file_actions_adddup2(&actions, 0, 1) ||
                 posix_spawn_file_actions_adddup2(&actions, pair[1], HF_WIRE_CONTROL) ||
                 posix_spawn(&helper, path, &actions, NULL, argv, environ);
        posix_spawn_file_actions_destroy(&actions);
    }
    close(pair[1]);
    control = pair[0];
    helper = failed ? 0 : helper;
    if (!failed && !greet(pair[0]))
        return 0;
    end_helper();
    return -1;
}

// Hand the helper a job's socket and, unless it is -1, the file to read.
static int send_socket(int fd, int file)
{
    const int fds[2] = {fd, file};
    const size_t size = file >= 0 ? sizeof(fds) : sizeof(int);
    char byte = 0, buf[CMSG_SPACE(sizeof(fds))] = {0};
    struct iovec part = {&byte, 1};
    struct msghdr m = {.msg_iov = &part, .msg_iovlen = 1, .msg_control = buf, .msg_controllen = CMSG_SPACE(size)};
    struct cmsghdr *c = CMSG_FIRSTHDR(&m);
    c->cmsg_level = SOL_SOCKET;
    c->cmsg_type = SCM_RIGHTS;
    c->cmsg_len = CMSG_LEN(size);
    memcpy(CMSG_DATA(c), fds, size);
    return control >= 0 && sendmsg(control, &m, MSG_NOSIGNAL) == 1 ? 0 : -1;
}

// Hand the helper, which is started if it does not run, a socket. 0 or -1; version is what one of another build said.
static int give_socket(int fd, int file, char version[HF_WIRE_HELLO])
{
    while (atomic_flag_test_and_set(&starting))
        usleep(100);
    int status = send_socket(fd, file);
    if (status) {
        end_helper();
        other[0] = 0;
        status = start_helper() ? -1 : send_socket(fd, file);
    }
    memcpy(version, other, HF_WIRE_HELLO);
    atomic_flag_clear(&starting);
    return status;
}

static int fail_start(const char *path, const char *version, struct hf_io_error *err)
{
    char own[HF_WIRE_HELLO];
    hf_wire_hello(own);
    if (version[0])
        return hf_io_fail(err,
                          "%s: " HELPER " is of version %s, but this program of %s: install both from the same build",
                          path, version, own);
    hf_io_fail(err, "%s: cannot start " HELPER ", which reads and writes this format", path);
    return hf_io_may_pass(err);
}

static atomic_int in_force = -1;  // of the last job's sandbox; -1: there was no job

const char *hf_oiio_sandbox(void)
{
    switch (atomic_load(&in_force)) {
    case 0:
        return HELPER " has no sandbox here (neither seccomp nor Landlock): a harmful file could do what you may do";
    case HF_SANDBOX_CALLS:
        return HELPER "'s sandbox has no Landlock here: a harmful file could read and write the files that you may";
    case HF_SANDBOX_FILES:
        return HELPER "'s sandbox has no seccomp here: a harmful file could reach the network and other processes";
    default:
        return NULL;
    }
}

// A socket to a fresh child of the helper's, which may read `file` (-1: none). The child says one byte, what its sandbox
// is; without it the helper ended before it had made the child, no file was touched, and another helper is tried.
static int begin_job(const char *path, int file, struct hf_io_error *err)
{
    char version[HF_WIRE_HELLO] = "", byte;
    for (int tries = 0; tries < 3; tries++) {
        int pair[2];
        if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair)) {
            hf_io_fail(err, "%s: cannot talk to " HELPER ": %s", path, strerror(errno));
            return hf_io_may_pass(err);
        }
        const int status = give_socket(pair[1], file, version);
        close(pair[1]);
        if (!status && !hf_wire_get(pair[0], &byte, 1)) {
            atomic_store(&in_force, byte);
            return pair[0];
        }
        close(pair[0]);
        if (status)
            break;
    }
    return fail_start(path, version, err);
}

// The socket of a job about path, which reads that file if `reads`.
static int new_job(const char *path, bool reads, struct hf_io_error *err)
{
    if (!hf_oiio_available())
        return hf_io_fail(err,
                          "%s: only EXR without DWA compression can be read and written here (" HELPER
                          ", which does the rest, is not there: built without OpenImageIO)",
                          path);
    const int file = reads ? open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK) : -1;
    if (reads && file < 0)
        return hf_io_fail(err, "%s: cannot open: %s", path, strerror(errno));
    const int fd = begin_job(path, file, err);
    if (file >= 0)
        close(file);
    return fd;
}

// ---- asking

static int gone(const char *path, struct hf_io_error *err)
{
    hf_io_fail(err, "%s: truncated or corrupt, or far too large: its reader crashed or ran out of its limits", path);
    return hf_io_may_pass(err);
}

static void set_name(struct hf_wire_request *q, const char *name)
{
    q->has_name = name != NULL;
    if (name)
        snprintf(q->name, sizeof(q->name), "%s", name);
}

static int set_path(struct hf_wire_request *q, const char *path, struct hf_io_error *err)
{
    return snprintf(q->path, sizeof(q->path), "%s", path) < (int)sizeof(q->path)
               ? 0
               : hf_io_fail(err, "%s: the name is too long", path);
}

// Sentences that come from the helper end, and hold no control characters.
static int get_reply(int fd, const char *path, struct hf_wire_reply *r, struct hf_io_error *err)
{
    if (hf_wire_get(fd, r, sizeof(*r)))
        return gone(path, err);
    r->err.message[sizeof(r->err.message) - 1] = 0;
    if (r->status)
        return hf_io_fail(err, "%s", r->err.message[0] ? r->err.message : "OpenImageIO failed");
    return 0;
}

static void end_text(char *text, size_t size)
{
    text[size - 1] = 0;
}

static int check_reply(struct hf_oiio *o, struct hf_wire_reply *r, struct hf_io_error *err)
{
    struct hf_io_view *v = &r->view;
    end_text(r->channels, sizeof(r->channels));
    end_text(v->name, sizeof(v->name));
    end_text(v->depth, sizeof(v->depth));
    for (int k = 0; k < 4; k++)
        end_text(v->colour[k], sizeof(v->colour[k]));
    snprintf(o->channels, sizeof(o->channels), "%s", r->channels);
    o->bits = r->bits;
    o->width = r->width;
    o->height = r->height;
    const struct hf_io_box whole = {0, 0, r->width, r->height};
    if (hf_io_check_window(o->path, "picture", whole, err))
        return -1;
    if (!r->has_view)
        return 0;
    v->part = 0;
    v->depth_part = v->depth[0] ? 0 : -1;
    o->view = *v;
    return hf_io_check_window(o->path, "picture", v->data_window, err) ||
                   hf_io_check_window(o->path, "display window", v->display_window, err) ||
                   v->data_window.x1 - v->data_window.x0 != v->width ||
                   v->data_window.y1 - v->data_window.y0 != v->height
               ? -1
               : 0;
}

int hf_oiio_open(struct hf_oiio **out, const char *path, const char *depth_channel, struct hf_io_views *views,
                 struct hf_io_error *err)
{
    struct hf_oiio *o = calloc(1, sizeof(*o));
    struct hf_wire_request *q = calloc(1, sizeof(*q));
    struct hf_wire_reply *r = calloc(1, sizeof(*r));
    int status = o && q && r ? set_path(q, path, err) : hf_io_fail(err, "%s: out of memory", path);
    if (o) {
        o->path = path;
        o->fd = status ? -1 : new_job(path, true, err);
        status = o->fd < 0 ? -1 : status;
    }
    if (!status) {
        q->op = HF_WIRE_OPEN;
        set_name(q, depth_channel);
        status = hf_wire_put(o->fd, q, sizeof(*q)) ? gone(path, err) : get_reply(o->fd, path, r, err);
    }
    if (!status)
        status = check_reply(o, r, err);
    if (!status && r->has_view) {
        struct hf_io_view *v = hf_io_add_view(views);
        if (v)
            *v = o->view;
        else
            status = hf_io_fail(err, "%s: out of memory", path);
    }
    if (status) {
        hf_oiio_close(o);
        o = NULL;
    }
    free(q);
    free(r);
    *out = o;
    return status;
}

void hf_oiio_close(struct hf_oiio *o)
{
    if (!o)
        return;
    if (o->fd >= 0)
        close(o->fd);
    free(o);
}

void hf_oiio_channels(const struct hf_oiio *o, char *buf, size_t size)
{
    snprintf(buf, size, "%s", o->channels);
}

int hf_oiio_bits(const struct hf_oiio *o)
{
    return o->bits;
}

void hf_oiio_size(const struct hf_oiio *o, int *width, int *height)
{
    *width = o->width;
    *height = o->height;
}

// Ask for planes of the size of a view; those that are not NULL are filled.
static int ask_planes(struct hf_oiio *o, struct hf_wire_request *q, float *const planes[4], int width, int height,
                      struct hf_io_error *err)
{
    struct hf_wire_reply *r = calloc(1, sizeof(*r));
    const size_t size = (size_t)width * (size_t)height * sizeof(float);
    size_t want = 0;
    for (int k = 0; k < 4; k++)
        want += planes[k] ? size : 0;
    int status = !r                                  ? hf_io_fail(err, "%s: out of memory", o->path)
                 : hf_wire_put(o->fd, q, sizeof(*q)) ? gone(o->path, err)
                                                     : get_reply(o->fd, o->path, r, err);
    if (!status && r->size != want)
        status = gone(o->path, err);
    for (int k = 0; k < 4 && !status; k++)
        if (planes[k] && hf_wire_get(o->fd, planes[k], size))
            status = gone(o->path, err);
    free(r);
    return status;
}

int hf_oiio_read_colour(struct hf_oiio *o, float *const planes[4], struct hf_io_error *err)
{
    struct hf_wire_request *q = calloc(1, sizeof(*q));
    float *there[4];
    if (!q)
        return hf_io_fail(err, "%s: out of memory", o->path);
    q->op = HF_WIRE_COLOUR;
    for (int k = 0; k < 4; k++) {
        there[k] = o->view.colour[k][0] ? planes[k] : NULL;
        q->planes |= (there[k] ? 1u : 0) << k;
    }
    const int status = ask_planes(o, q, there, o->view.width, o->view.height, err);
    free(q);
    return status;
}

static int ask_depth(struct hf_oiio *o, enum hf_wire_op op, const char *name, const struct hf_io_view *view,
                     float *depth, struct hf_io_error *err)
{
    struct hf_wire_request *q = calloc(1, sizeof(*q));
    float *const planes[4] = {depth, NULL, NULL, NULL};
    if (!q)
        return hf_io_fail(err, "%s: out of memory", o->path);
    q->op = op;
    q->view = *view;
    set_name(q, name);
    const int status = ask_planes(o, q, planes, view->width, view->height, err);
    free(q);
    return status;
}

int hf_oiio_read_depth(struct hf_oiio *o, float *depth, struct hf_io_error *err)
{
    return ask_depth(o, HF_WIRE_DEPTH, NULL, &o->view, depth, err);
}

int hf_oiio_read_depth_only(struct hf_oiio *o, const char *depth_channel, const struct hf_io_view *view, float *depth,
                            struct hf_io_error *err)
{
    return ask_depth(o, HF_WIRE_DEPTH_ONLY, depth_channel, view, depth, err);
}

int hf_oiio_check_format(const char *path, struct hf_io_error *err)
{
    struct hf_wire_request *q = calloc(1, sizeof(*q));
    struct hf_wire_reply *r = calloc(1, sizeof(*r));
    int status = q && r ? set_path(q, path, err) : hf_io_fail(err, "%s: out of memory", path);
    const int fd = status ? -1 : new_job(path, false, err);
    status = fd < 0 ? -1 : status;
    if (!status) {
        q->op = HF_WIRE_FORMAT;
        status = hf_wire_put(fd, q, sizeof(*q)) ? gone(path, err) : get_reply(fd, path, r, err);
    }
    if (fd >= 0)
        close(fd);
    free(q);
    free(r);
    return status;
}

// The file that the helper made.
static int get_file(int fd, const char *path, struct hf_io_bytes *made, struct hf_io_error *err)
{
    struct hf_wire_reply *r = calloc(1, sizeof(*r));
    int status = r ? 0 : hf_io_fail(err, "%s: out of memory", path);
    if (!status && hf_wire_get(fd, r, sizeof(*r)))
        status = hf_io_fail(err, "%s: cannot write: the writer of this format crashed or ran out of its limits", path);
    if (!status && r->status) {
        end_text(r->err.message, sizeof(r->err.message));
        status = hf_io_fail(err, "%s", r->err.message);
    }
    if (!status) {
        made->size = r->size;
        made->data = malloc(r->size + 1);
        if (!made->data)
            status = hf_io_fail(err, "%s: out of memory", path);
        else if (hf_wire_get(fd, made->data, made->size))
            status = hf_io_fail(err, "%s: cannot write: the writer of this format crashed", path);
    }
    if (status) {
        free(made->data);
        *made = (struct hf_io_bytes){0};
    }
    free(r);
    return status;
}

int hf_oiio_write(struct hf_io_bytes *made, const struct hf_oiio_picture *p, struct hf_io_error *err)
{
    struct hf_wire_request *q = calloc(1, sizeof(*q));
    const size_t size = (size_t)p->view->width * (size_t)p->view->height * sizeof(float);
    int fd = -1, status = q ? set_path(q, p->path, err) : hf_io_fail(err, "%s: out of memory", p->path);
    *made = (struct hf_io_bytes){0};
    if (!status) {
        // Without the source, which may have gone since, its texts are lost and no more.
        const bool source = p->source && !access(p->source, R_OK);
        fd = new_job(source ? p->source : p->path, source, err);
        status = fd < 0 ? -1 : 0;
    }
    if (!status) {
        q->op = HF_WIRE_WRITE;
        q->view = *p->view;
        q->bits = p->bits;
        set_name(q, p->compression);
        snprintf(q->source, sizeof(q->source), "%s", p->source ? p->source : "");
        for (int k = 0; k < 4; k++)
            q->planes |= (p->planes[k] ? 1u : 0) << k;
        int sent = hf_wire_put(fd, q, sizeof(*q));
        for (int k = 0; k < 4 && !sent; k++)
            sent = p->planes[k] ? hf_wire_put(fd, p->planes[k], size) : 0;
        status = get_file(fd, p->path, made, err);
    }
    if (fd >= 0)
        close(fd);
    free(q);
    return status;
}

// Open a job about samples and send what describes them.
static int ask_samples(const char *path, struct hf_wire_request *q, const struct hf_io_samples *s,
                       struct hf_io_error *err)
{
    if (s->channel_count > HF_WIRE_CHANNELS)
        return hf_io_fail(err, "%s: %d channels in a part compressed by DWA are more than the %d that can be read",
                          path, s->channel_count, HF_WIRE_CHANNELS);
    if (set_path(q, path, err))
        return -1;
    const int fd = new_job(path, q->op == HF_WIRE_READ, err);
    if (fd < 0)
        return -1;
    q->samples = *s;
    int sent = hf_wire_put(fd, q, sizeof(*q));
    for (int c = 0; c < s->channel_count && !sent; c++) {
        struct hf_wire_name name = {.type = s->types[c]};
        snprintf(name.text, sizeof(name.text), "%s", s->names[c]);
        sent = hf_wire_put(fd, &name, sizeof(name));
    }
    if (!sent)
        return fd;
    close(fd);
    return gone(path, err);
}

int hf_oiio_read_samples(const char *path, int part, struct hf_io_samples *s, struct hf_io_error *err)
{
    struct hf_wire_request *q = calloc(1, sizeof(*q));
    struct hf_wire_reply *r = calloc(1, sizeof(*r));
    int fd = -1, status = q && r ? 0 : hf_io_fail(err, "%s: out of memory", path);
    if (!status) {
        q->op = HF_WIRE_READ;
        q->part = part;
        fd = ask_samples(path, q, s, err);
        status = fd < 0 ? -1 : get_reply(fd, path, r, err);
    }
    if (!status && (r->size != (size_t)s->height * s->row_bytes || hf_wire_get(fd, s->data, r->size)))
        status = gone(path, err);
    if (fd >= 0)
        close(fd);
    free(q);
    free(r);
    return status;
}

int hf_oiio_write_samples(struct hf_io_bytes *made, const char *path, const struct hf_io_samples *s,
                          const char *compression, float level, struct hf_io_error *err)
{
    struct hf_wire_request *q = calloc(1, sizeof(*q));
    int fd = -1, status = q ? 0 : hf_io_fail(err, "%s: out of memory", path);
    *made = (struct hf_io_bytes){0};
    if (!status) {
        q->op = HF_WIRE_MAKE;
        q->level = level;
        set_name(q, compression);
        fd = ask_samples(path, q, s, err);
        status = fd < 0 ? -1 : 0;
    }
    if (!status) {
        hf_wire_put(fd, s->data, (size_t)s->height * s->row_bytes);  // if that fails, so does the answer
        status = get_file(fd, path, made, err);
    }
    if (fd >= 0)
        close(fd);
    free(q);
    return status;
}
