// SPDX-License-Identifier: BSD-3-Clause
// What a child of the helper gives up before it touches a file that may be damaged on purpose: other files, the network,
// other programs, new processes.
#ifndef HF_IO_SANDBOX_H
#define HF_IO_SANDBOX_H

enum {
    HF_SANDBOX_CALLS = 1,  // seccomp: only the system calls that decoding needs
    HF_SANDBOX_FILES = 2,  // Landlock: of all files only the one that was handed over, for reading
    HF_SANDBOX_ALL = HF_SANDBOX_CALLS | HF_SANDBOX_FILES,
};

// Give all of it up, as far as this build and this kernel can, and return what is in force. file is the descriptor of the
// file that may still be opened, by its name too; -1: none.
int hf_sandbox_enter(int file);

// In a process of its own, enter the sandbox and try everything that it forbids, and what it must allow. Prints what was not
// as it should be, and "N passed, N failed". Returns an exit code; 77 without a sandbox.
int hf_sandbox_try(void);

#endif
