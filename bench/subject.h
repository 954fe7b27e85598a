// SPDX-License-Identifier: BSD-3-Clause
// A context, and the pictures that it is measured on.
#ifndef HF_BENCH_SUBJECT_H
#define HF_BENCH_SUBJECT_H

#include "args.h"
#include "measure.h"
#include "scene.h"

// Open the library and pack the scene. log keeps the last sentence that the library says. Close the subject even after
// an error. Returns 0, or -1 with *error filled.
int bench_subject_open(struct bench_subject *s, const struct bench_args *args, const struct bench_scene *scene,
                       struct tool_error *log, struct tool_error *error);
// Let it be seen through a camera's lens.
void bench_subject_lens(struct bench_subject *subject, const struct bench_camera *camera);
void bench_subject_close(struct bench_subject *s);

#endif
