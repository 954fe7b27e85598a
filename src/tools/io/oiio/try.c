// SPDX-License-Identifier: BSD-3-Clause
// A test of the sandbox from inside: code that took the helper over would try this.
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tools/io/oiio/sandbox.h"

static int passed, failed;

// Printed by write(), as nothing else is sure to be possible.
static void check(const char *what, int ok)
{
    char line[200];
    passed += ok != 0;
    failed += ok == 0;
    const int n = snprintf(line, sizeof(line), "FAILED: %s (%s)\n", what, strerror(errno));
    if (!ok && write(STDOUT_FILENO, line, (size_t)n) != n)
        _exit(1);
}

// -1 or NULL as the result of what must not be possible, for lack of permission.
static int refused(long result)
{
    return result < 0 && (errno == EPERM || errno == EACCES);
}

static int refused_or_absent(long result)
{
    return refused(result) || (result < 0 && errno == ENOSYS);
}

static void try_files(const char *file, const char *other)
{
    char beside[4096];
    snprintf(beside, sizeof(beside), "%s.new", other);
    check("to read another file", refused(open(other, O_RDONLY)));
    check("to write another file", refused(open(other, O_WRONLY)));
    check("to write the file that was handed over", refused(open(file, O_WRONLY)));
    check("to cut it off", refused(truncate(file, 0)));
    check("to create a file", refused(open(beside, O_WRONLY | O_CREAT, 0666)));
    check("to create one by creat()", refused(creat(beside, 0666)));
    check("to list a directory", refused(open("/", O_RDONLY | O_DIRECTORY)));
    check("to remove a file", refused(unlink(other)));
    check("to rename a file", refused(rename(other, beside)));
    check("to link a file", refused(link(other, beside)));
    check("to link to a file", refused(symlink(other, beside)));
    check("to make a directory", refused(mkdir(beside, 0777)));
    check("to change a mode", refused(chmod(other, 0777)));
    check("to change the mode of the file that was handed over", refused(fchmodat(AT_FDCWD, file, 0777, 0)));
    check("to change an owner", refused(chown(other, 1, 1)));
    check("to go elsewhere", refused(chdir("/")));
    check("to change the root", refused(chroot("/")));
    check("to read /proc/self/mem", refused(open("/proc/self/mem", O_RDWR)));
}

static void try_others(void)
{
    char *const argv[] = {"true", NULL}, *const none[] = {NULL};
    struct rlimit limit = {0};
    check("the internet", refused(socket(AF_INET, SOCK_STREAM, 0)));
    check("datagrams", refused(socket(AF_INET6, SOCK_DGRAM, 0)));
    check("sockets of this machine", refused(socket(AF_UNIX, SOCK_STREAM, 0)));
    check("to run a program", refused(execve("/bin/true", argv, none)));
    const pid_t pid = fork();
    if (pid == 0)
        _exit(0);
    check("to make a process", refused_or_absent(pid));
    check("to end another process", refused(kill(getppid(), SIGKILL)));
    check("to limit another process", refused(prlimit(getppid(), RLIMIT_NOFILE, &limit, NULL)));
    check("to look into another process", refused(ptrace(PTRACE_ATTACH, getppid(), NULL, NULL)));
    void *code = mmap(NULL, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    check("to make code", refused(code == MAP_FAILED ? -1 : 0));
    code = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    check("memory", code != MAP_FAILED);
    check("to make code of data", refused(mprotect(code, 4096, PROT_READ | PROT_EXEC)));
}

static void *nothing(void *arg)
{
    return arg;
}

static void try_allowed(int fd, const char *file)
{
    char byte;
    pthread_t thread;
    check("to read the file that was handed over", pread(fd, &byte, 1, 0) == 1);
    const int by_name = open(file, O_RDONLY);
    check("to read it by its name", by_name >= 0 && read(by_name, &byte, 1) == 1);
    void *memory = malloc((size_t)64 << 20);
    check("to have memory", memory != NULL);
    free(memory);
    check("to have threads", !pthread_create(&thread, NULL, nothing, NULL) && !pthread_join(thread, NULL));
    char name[64];
    const int made = memfd_create("picture", MFD_CLOEXEC);
    snprintf(name, sizeof(name), "/proc/self/fd/%d", made);
    const int again = open(name, O_RDWR | O_TRUNC);
    check("to write a file in memory by its name", made >= 0 && again >= 0 && write(again, "x", 1) == 1);
}

static int try_all(const char *file, const char *other)
{
    const int fd = open(file, O_RDONLY | O_CLOEXEC);
    const int in_force = hf_sandbox_enter(fd);
    if (in_force != HF_SANDBOX_ALL) {
        printf("skipped: no %s in this kernel or build\n", in_force & HF_SANDBOX_CALLS ? "Landlock" : "seccomp");
        fflush(stdout);
        return 77;
    }
    try_files(file, other);
    try_others();
    try_allowed(fd, file);
    char line[64];
    const int n = snprintf(line, sizeof(line), "%d passed, %d failed\n", passed, failed);
    return write(STDOUT_FILENO, line, (size_t)n) != n || failed || !passed;
}

static int make_file(const char *path)
{
    const int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    const int bad = fd < 0 || write(fd, "text", 4) != 4;
    return fd >= 0 && close(fd) ? -1 : -bad;
}

int hf_sandbox_try(void)
{
    char folder[] = "/tmp/hyperfocal-XXXXXX", file[64], other[64], beside[64];
    int status = 0;
    if (!mkdtemp(folder))
        return 1;
    snprintf(file, sizeof(file), "%s/file", folder);
    snprintf(other, sizeof(other), "%s/other", folder);
    snprintf(beside, sizeof(beside), "%s/other.new", folder);
    const int made = !make_file(file) && !make_file(other);
    const pid_t pid = made ? fork() : -1;
    if (pid == 0)
        _exit(try_all(file, other));
    const int ended = pid > 0 && waitpid(pid, &status, 0) == pid && WIFEXITED(status);
    unlink(file);
    unlink(other);
    unlink(beside);
    rmdir(folder);
    return ended ? WEXITSTATUS(status) : 1;
}
