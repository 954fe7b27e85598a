// SPDX-License-Identifier: BSD-3-Clause
#include "base/thread.h"

#include <process.h>
#include <stdint.h>
#include <windows.h>

_Static_assert(sizeof(SRWLOCK) == sizeof(struct hf_lock) && sizeof(CONDITION_VARIABLE) == sizeof(struct hf_condition),
               "size of a lock and of a condition");

static SRWLOCK *srw(struct hf_lock *lock)
{
    return (SRWLOCK *)&lock->srw;
}

static CONDITION_VARIABLE *variable(struct hf_condition *condition)
{
    return (CONDITION_VARIABLE *)&condition->variable;
}

void hf_lock_open(struct hf_lock *lock)
{
    InitializeSRWLock(srw(lock));
}

// These locks and conditions own no resource, so nothing is freed.
void hf_lock_close(struct hf_lock *lock)
{
    (void)lock;
}

void hf_lock_take(struct hf_lock *lock)
{
    AcquireSRWLockExclusive(srw(lock));
}

void hf_lock_release(struct hf_lock *lock)
{
    ReleaseSRWLockExclusive(srw(lock));
}

void hf_condition_open(struct hf_condition *condition)
{
    InitializeConditionVariable(variable(condition));
}

void hf_condition_close(struct hf_condition *condition)
{
    (void)condition;
}

void hf_condition_wait(struct hf_condition *condition, struct hf_lock *lock)
{
    SleepConditionVariableSRW(variable(condition), srw(lock), INFINITE, 0);
}

void hf_condition_wake(struct hf_condition *condition)
{
    WakeConditionVariable(variable(condition));
}

void hf_condition_wake_all(struct hf_condition *condition)
{
    WakeAllConditionVariable(variable(condition));
}

static unsigned __stdcall run(void *arg)
{
    const struct hf_thread *thread = arg;
    thread->run(thread->arg);
    return 0;
}

// _beginthreadex instead of CreateThread, so that the C library frees what it allocates for the thread.
int hf_thread_start(struct hf_thread *thread, void (*function)(void *arg), void *arg)
{
    thread->run = function;
    thread->arg = arg;
    thread->handle = (void *)_beginthreadex(NULL, 0, run, thread, 0, NULL);
    return thread->handle ? 0 : -1;
}

void hf_thread_join(struct hf_thread *thread)
{
    WaitForSingleObject(thread->handle, INFINITE);
    CloseHandle(thread->handle);
}

void hf_thread_yield(void)
{
    SwitchToThread();
}
