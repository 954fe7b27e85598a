// SPDX-License-Identifier: BSD-3-Clause
// Temporary files: each grows beside the file whose place it will take. Its writer holds a lock on it (flock) until it is
// renamed, so that other processes can tell a file that is being written from one whose writer has died.
#ifndef HF_IO_TEMP_H
#define HF_IO_TEMP_H

#include <sys/types.h>

// Create a temporary file in target's folder, with target's extension, and lock it. Returns its descriptor, and in *name
// a name that hf_temp_forget frees; or -1 with errno set, and *name NULL.
int hf_temp_create(const char *target, mode_t mode, char **name);
// The file was renamed or removed: a signal need not remove it any more. name may be NULL.
void hf_temp_forget(char *name);

// Remove the temporary files in a folder whose writers have died, and return how many. A file stays while its lock is held.
// One that another machine wrote stays for an hour after it last grew, as not every file system shares its locks.
int hf_temp_remove_strays(const char *folder);

// SIGTERM, SIGINT, SIGHUP, SIGPIPE and SIGXCPU remove the temporary files, then do what they do.
void hf_temp_catch_signals(void);
// The same at once, from a signal's handler: remove them, then do what the signal does.
void hf_temp_end_by_signal(int number);

#endif
