// SPDX-License-Identifier: BSD-3-Clause
// The ground of this folder: what went wrong, in one sentence.
#ifndef HF_IO_ERROR_H
#define HF_IO_ERROR_H

enum { HF_IO_MESSAGE = 512 };

// What went wrong, one sentence that names the file and, where there is one, the channel and the value. It holds no
// control characters, whatever the names in a file are.
struct hf_io_error {
    char message[HF_IO_MESSAGE];
    int may_pass;  // the cause may pass, and another try succeed: a process that could not be started, or was killed
};

#ifdef __cplusplus
extern "C" {
#endif

// Fill err (which may be NULL) and return -1, so that "return hf_io_fail(...)" reads well.
int hf_io_fail(struct hf_io_error *err, const char *format, ...) __attribute__((format(printf, 2, 3)));
// Say that the cause of what was just said may pass. Returns -1.
int hf_io_may_pass(struct hf_io_error *err);

#ifdef __cplusplus
}
#endif

#endif
