// SPDX-License-Identifier: BSD-3-Clause
// Descriptors 0 to 2. Every program's main begins with this.
#ifndef HF_TOOL_STANDARD_H
#define HF_TOOL_STANDARD_H

// Open those that are closed. Otherwise the next opened file would get the number, and a message would be written into
// a picture. Writing to such a descriptor is still an error.
void tool_open_standard(void);

#endif
