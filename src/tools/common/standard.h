// SPDX-License-Identifier: BSD-3-Clause
// Descriptors 0 to 2: the first thing in every program's main.
#ifndef HF_TOOL_STANDARD_H
#define HF_TOOL_STANDARD_H

// Open those that are closed, or the next file that is opened gets the number: a message would be written into a picture.
// What is written to such a descriptor is still an error.
void tool_open_standard(void);

#endif
