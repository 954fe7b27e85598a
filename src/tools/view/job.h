// SPDX-License-Identifier: BSD-3-Clause
// The command that the window stands for: copied as a line, run to save a picture or a shot.
#ifndef HF_VIEW_JOB_H
#define HF_VIEW_JOB_H

#include "tools/view/app.h"

// Put the command line on the clipboard.
void view_job_copy(struct view_app *app);
// Ask for a name and write what the command writes.
void view_job_save(struct view_app *app);
// The same without asking.
void view_job_save_as(struct view_app *app, const char *path);
// Ask for a pattern and run the command over all frames; the same without asking.
void view_job_shot(struct view_app *app);
void view_job_shot_as(struct view_app *app, const char *pattern);
void view_job_pause(struct view_app *app, int paused);
void view_job_cancel(struct view_app *app);
// 1, and a sentence in the window, if a command runs.
int view_job_runs(struct view_app *app);
// A name or pattern to write to, to be freed with g_free.
char *view_job_output(const struct view_app *app);

// The bar that shows a running command; text NULL: none runs.
GtkWidget *view_job_bar(struct view_app *app);
void view_job_show(struct view_app *app, const char *text, double done);

#endif
