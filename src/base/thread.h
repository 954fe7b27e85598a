// SPDX-License-Identifier: BSD-3-Clause
// Threads, locks and conditions of the operating system: thread_posix.c, thread_windows.c.
#ifndef HF_THREAD_H
#define HF_THREAD_H

#ifdef _WIN32
// A SRWLOCK, a CONDITION_VARIABLE and a HANDLE are a pointer each. Declared so, headers need not include windows.h.
struct hf_lock {
    void *srw;
};
struct hf_condition {
    void *variable;
};
struct hf_thread {
    void *handle, (*run)(void *arg), *arg;
};
#else
#include <pthread.h>
struct hf_lock {
    pthread_mutex_t mutex;
};
struct hf_condition {
    pthread_cond_t cond;
};
struct hf_thread {
    pthread_t id;
    void (*run)(void *arg), *arg;
};
#endif

void hf_lock_open(struct hf_lock *lock);
void hf_lock_close(struct hf_lock *lock);
void hf_lock_take(struct hf_lock *lock);
void hf_lock_release(struct hf_lock *lock);

void hf_condition_open(struct hf_condition *condition);
void hf_condition_close(struct hf_condition *condition);
// Releases the lock while it waits. It may return without a call of wake.
void hf_condition_wait(struct hf_condition *condition, struct hf_lock *lock);
void hf_condition_wake(struct hf_condition *condition);      // one thread that waits
void hf_condition_wake_all(struct hf_condition *condition);  // all of them

// Runs run(arg) in a new thread. *thread must not move until hf_thread_join, which waits until the thread ends. Returns
// 0, or -1 if the system starts no more threads.
int hf_thread_start(struct hf_thread *thread, void (*run)(void *arg), void *arg);
void hf_thread_join(struct hf_thread *thread);
// Let another thread have the processor.
void hf_thread_yield(void);

#endif
