// SPDX-License-Identifier: BSD-3-Clause
#include "base/thread.h"

#include <sched.h>
#include <stddef.h>

void hf_lock_open(struct hf_lock *lock)
{
    pthread_mutex_init(&lock->mutex, NULL);
}

void hf_lock_close(struct hf_lock *lock)
{
    pthread_mutex_destroy(&lock->mutex);
}

void hf_lock_take(struct hf_lock *lock)
{
    pthread_mutex_lock(&lock->mutex);
}

void hf_lock_release(struct hf_lock *lock)
{
    pthread_mutex_unlock(&lock->mutex);
}

void hf_condition_open(struct hf_condition *condition)
{
    pthread_cond_init(&condition->cond, NULL);
}

void hf_condition_close(struct hf_condition *condition)
{
    pthread_cond_destroy(&condition->cond);
}

void hf_condition_wait(struct hf_condition *condition, struct hf_lock *lock)
{
    pthread_cond_wait(&condition->cond, &lock->mutex);
}

void hf_condition_wake(struct hf_condition *condition)
{
    pthread_cond_signal(&condition->cond);
}

void hf_condition_wake_all(struct hf_condition *condition)
{
    pthread_cond_broadcast(&condition->cond);
}

static void *run(void *arg)
{
    const struct hf_thread *thread = arg;
    thread->run(thread->arg);
    return NULL;
}

int hf_thread_start(struct hf_thread *thread, void (*function)(void *arg), void *arg)
{
    thread->run = function;
    thread->arg = arg;
    return pthread_create(&thread->id, NULL, run, thread) ? -1 : 0;
}

void hf_thread_join(struct hf_thread *thread)
{
    pthread_join(thread->id, NULL);
}

void hf_thread_yield(void)
{
    sched_yield();
}
