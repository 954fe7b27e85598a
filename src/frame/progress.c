// SPDX-License-Identifier: BSD-3-Clause
#include "frame/progress.h"

void hf_progress_start(struct hf_progress *p, const struct hf_progress_call *call, atomic_int *stop, int any_thread)
{
    p->call = *call;
    p->stop = stop;
    p->any_thread = any_thread;
    p->from = p->to = p->next = 0;
    p->all = 0;
    atomic_flag_clear(&p->calling);
    atomic_init(&p->done, 0);
    for (int i = 0; i < HF_MAX_PASSES; i++)
        p->pass[i] = 0;
}

void hf_progress_stage(struct hf_progress *p, int to, uint64_t all)
{
    p->from = p->to;
    p->to = to;
    p->all = all;
    atomic_store_explicit(&p->done, 0, memory_order_relaxed);
}

static void tell(struct hf_progress *p)
{
    const uint64_t done = atomic_load_explicit(&p->done, memory_order_relaxed);
    const double part = done < p->all ? (double)done / (double)p->all : 1;
    const int now = p->from + (int)(part * (p->to - p->from));
    // 100 is reported only when everything is stored.
    if (now < p->next || now > 99)
        return;
    p->next = now + 1;
    if (p->call.fn(p->call.cookie, (float)now / 100))
        atomic_store_explicit(p->stop, 1, memory_order_relaxed);
}

void hf_progress_add(struct hf_progress *p, int worker, uint64_t units)
{
    if (!p->call.fn)
        return;
    atomic_fetch_add_explicit(&p->done, units, memory_order_relaxed);
    if (hf_stopped(p->stop) || (worker != 0 && !p->any_thread) ||
        atomic_flag_test_and_set_explicit(&p->calling, memory_order_acquire))
        return;
    tell(p);
    atomic_flag_clear_explicit(&p->calling, memory_order_release);
}

void hf_progress_end(const struct hf_progress *p)
{
    if (p->call.fn)
        p->call.fn(p->call.cookie, 1);
}
