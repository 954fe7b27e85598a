// SPDX-License-Identifier: BSD-3-Clause
// The lowest floor of this folder: an error, as one sentence.
#ifndef HF_IO_ERROR_H
#define HF_IO_ERROR_H

enum { HF_IO_MESSAGE = 512 };

// One sentence that names the file and, where there is one, the channel and the value. It contains no control
// characters, whatever names a file has.
struct hf_io_error {
    char message[HF_IO_MESSAGE];
    int may_pass;  // the cause may pass and another try succeed: a process could not be started, or was killed
};

#ifdef __cplusplus
extern "C" {
#endif

// Fill err (which may be NULL) and return -1, so that "return hf_io_fail(...)" reads well.
int hf_io_fail(struct hf_io_error *err, const char *format, ...) __attribute__((format(printf, 2, 3)));
// Note that the cause of the last error may pass. Returns -1.
int hf_io_may_pass(struct hf_io_error *err);

#ifdef __cplusplus
}
#endif

#endif
