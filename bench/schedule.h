// SPDX-License-Identifier: BSD-3-Clause
// How long a frame takes on a machine that is not here: its tasks, measured one by one, are given to as many threads as one
// likes, in the order in which the library gives them out.
#ifndef HF_BENCH_SCHEDULE_H
#define HF_BENCH_SCHEDULE_H

// A step of a frame. Threads that are free take its tasks one by one, in their order. The next step begins when the last
// task has ended: a barrier.
struct bench_step {
    int count;
    double *ms;     // of each task on a thread of its own
    double before;  // milliseconds that one thread works alone before the step
    double bytes;   // that the step moves to and from memory
};

struct bench_schedule {
    int count;
    struct bench_step *steps;
    double after;  // milliseconds that one thread works alone after the last step
};

struct bench_node {
    int threads;
    int socket;        // threads that share a socket's memory
    double bandwidth;  // bytes per millisecond of a socket
    // Milliseconds of a barrier: to wake the threads and to hear from the last one; there is none with one thread.
    double barrier, barrier_thread;
};

// What keeps a frame from taking the sum of its tasks over the number of threads.
enum bench_limit {
    BENCH_LIMIT_ALONE,      // work of one thread between the steps
    BENCH_LIMIT_FIRST,      // threads idle at the end of the first step, the sweep over the input
    BENCH_LIMIT_LONGEST,    // a later step lasts as long as its longest task
    BENCH_LIMIT_UNEVEN,     // threads idle at the end of a later step that no single task explains
    BENCH_LIMIT_BARRIERS,   // starting and ending steps
    BENCH_LIMIT_BANDWIDTH,  // the threads wait for memory
    BENCH_LIMITS,
};
extern const char *const bench_limit_names[BENCH_LIMITS];

struct bench_expected {
    double ms;                  // of the frame
    double ideal;               // the sum of all tasks over the number of threads
    double lost[BENCH_LIMITS];  // these and ideal add up to ms
    enum bench_limit most;      // the largest of them
};

struct bench_expected bench_expect(const struct bench_schedule *s, const struct bench_node *node);

#endif
