// SPDX-License-Identifier: BSD-3-Clause
// What menus, buttons and keys do.
#ifndef HF_VIEW_ACTIONS_H
#define HF_VIEW_ACTIONS_H

#include "tools/view/app.h"

// Add the actions and their keys to the window.
void view_actions_add(struct view_app *app);
GMenuModel *view_actions_menu(void);
// Which of them can be used now.
void view_actions_refresh(struct view_app *app);

#endif
