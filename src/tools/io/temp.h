// SPDX-License-Identifier: BSD-3-Clause
// Temporary files: each grows beside the file that it will replace. Its writer holds a lock on it (flock) until it is
// renamed, so other processes can tell a file that is being written from one whose writer has died.
#ifndef HF_IO_TEMP_H
#define HF_IO_TEMP_H

#include <sys/types.h>

// Create and lock a temporary file in target's folder, with target's extension. Returns its descriptor, and in *name a
// name that hf_temp_forget frees; or -1 with errno set, and *name NULL.
int hf_temp_create(const char *target, mode_t mode, char **name);
// Call when the file was renamed or removed: a signal handler need not remove it any more. name may be NULL.
void hf_temp_forget(char *name);

// Remove the temporary files in a folder whose writers have died; returns how many. A file stays while its lock is
// held. Another machine's file stays for an hour after it last grew, because not every file system shares its locks.
int hf_temp_remove_strays(const char *folder);

// After this, SIGTERM, SIGINT, SIGHUP, SIGPIPE and SIGXCPU remove the temporary files before they take effect.
void hf_temp_catch_signals(void);
// Do the same at once, from a signal handler: remove the files, then let the signal take effect.
void hf_temp_end_by_signal(int number);

#endif
