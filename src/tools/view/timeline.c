// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/timeline.h"

int view_timeline_key_state(struct view_app *app, const char *option)
{
    (void)app;
    (void)option;
    return -1;
}

void view_timeline_toggle(struct view_app *app, const char *option)
{
    (void)app;
    (void)option;
}

void view_timeline_follow(struct view_app *app, const char *option)
{
    (void)app;
    (void)option;
}
