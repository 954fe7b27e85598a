// SPDX-License-Identifier: BSD-3-Clause
#include "tools/io/oiio/sandbox.h"

#include <errno.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#if HF_HAVE_SECCOMP
#include <sched.h>
#include <seccomp.h>
#include <sys/mman.h>

// System calls of reading a file, computing in memory and on threads, and answering through a socket.
static const int allowed[] = {
    // clang-format off
    SCMP_SYS(read), SCMP_SYS(readv), SCMP_SYS(pread64), SCMP_SYS(write), SCMP_SYS(writev), SCMP_SYS(pwrite64),
    SCMP_SYS(lseek), SCMP_SYS(_llseek), SCMP_SYS(close), SCMP_SYS(dup), SCMP_SYS(fcntl), SCMP_SYS(fcntl64),
    SCMP_SYS(fadvise64), SCMP_SYS(ftruncate), SCMP_SYS(memfd_create),
    SCMP_SYS(open), SCMP_SYS(openat), SCMP_SYS(stat), SCMP_SYS(lstat), SCMP_SYS(fstat), SCMP_SYS(newfstatat),
    SCMP_SYS(statx), SCMP_SYS(access), SCMP_SYS(faccessat), SCMP_SYS(faccessat2), SCMP_SYS(fstatfs), SCMP_SYS(getdents64),
    SCMP_SYS(munmap), SCMP_SYS(mremap), SCMP_SYS(madvise), SCMP_SYS(brk),
    SCMP_SYS(futex), SCMP_SYS(set_robust_list), SCMP_SYS(rseq), SCMP_SYS(sched_yield), SCMP_SYS(sched_getaffinity),
    SCMP_SYS(rt_sigaction), SCMP_SYS(rt_sigprocmask), SCMP_SYS(rt_sigreturn), SCMP_SYS(sigaltstack),
    SCMP_SYS(getpid), SCMP_SYS(gettid), SCMP_SYS(getuid), SCMP_SYS(geteuid), SCMP_SYS(getgid), SCMP_SYS(getegid),
    SCMP_SYS(uname), SCMP_SYS(sysinfo), SCMP_SYS(getcwd), SCMP_SYS(getrandom), SCMP_SYS(getrusage), SCMP_SYS(getcpu),
    SCMP_SYS(getrlimit), SCMP_SYS(setrlimit),
    SCMP_SYS(clock_gettime), SCMP_SYS(clock_getres), SCMP_SYS(clock_nanosleep), SCMP_SYS(nanosleep),
    SCMP_SYS(gettimeofday), SCMP_SYS(time), SCMP_SYS(times),
    SCMP_SYS(restart_syscall), SCMP_SYS(exit), SCMP_SYS(exit_group),
    // clang-format on
};

// Those that are allowed with some arguments: threads, but no processes; memory, but no new code; signals to and limits of
// this process alone; answers to who asked, and to nobody else.
static int allow_some(scmp_filter_ctx filter)
{
    const scmp_datum_t self = (scmp_datum_t)getpid();
    return seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(clone), 1,
                            SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, CLONE_THREAD)) ||
           seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0) ||  // its flags cannot be seen
           seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(mmap), 1, SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0)) ||
           seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(mprotect), 1, SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0)) ||
           seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(tgkill), 1, SCMP_A0(SCMP_CMP_EQ, self)) ||
           seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(prlimit64), 1, SCMP_A0(SCMP_CMP_EQ, 0)) ||
           seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(sendto), 1, SCMP_A4(SCMP_CMP_EQ, 0));
}

static int give_up_calls(void)
{
    // What is not allowed fails as if it were not permitted, and libraries go on without.
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
    int failed = filter ? allow_some(filter) : -1;
    for (size_t i = 0; i < sizeof(allowed) / sizeof(allowed[0]) && !failed; i++)
        if (allowed[i] >= 0)  // of this processor
            failed = seccomp_rule_add(filter, SCMP_ACT_ALLOW, allowed[i], 0);
    if (!failed)
        failed = seccomp_load(filter);
    if (filter)
        seccomp_release(filter);
    return failed ? 0 : HF_SANDBOX_CALLS;
}
#else
static int give_up_calls(void)
{
    return 0;
}
#endif

#if HF_HAVE_LANDLOCK
#include <linux/landlock.h>

// As the kernel of the newest version below has it; older ones know its first fields.
struct ruleset {
    uint64_t files, network, scoped;
};

// All rights of each version of Landlock, of which some came later.
static struct ruleset all_rights(int version, size_t *size)
{
    struct ruleset r = {.files = version >= 5 ? 0xffff : version >= 3 ? 0x7fff : version >= 2 ? 0x3fff : 0x1fff};
    r.network = version >= 4 ? 3 : 0;
    r.scoped = version >= 6 ? 3 : 0;
    *size = version >= 6 ? 24 : version >= 4 ? 16 : 8;
    return r;
}

static int give_up_files(int file)
{
    const int version = (int)syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
    size_t size;
    const struct ruleset rights = all_rights(version, &size);
    if (version < 1)
        return 0;
    const int rules = (int)syscall(SYS_landlock_create_ruleset, &rights, size, 0);
    if (rules < 0)
        return 0;
    const struct landlock_path_beneath_attr read = {.allowed_access = LANDLOCK_ACCESS_FS_READ_FILE, .parent_fd = file};
    int failed = file >= 0 && syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &read, 0);
    if (!failed)
        failed = prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) || syscall(SYS_landlock_restrict_self, rules, 0);
    close(rules);
    return failed ? 0 : HF_SANDBOX_FILES;
}
#else
static int give_up_files(int file)
{
    (void)file;
    return 0;
}
#endif

int hf_sandbox_enter(int file)
{
    const int files = give_up_files(file);
    return files | give_up_calls();
}
