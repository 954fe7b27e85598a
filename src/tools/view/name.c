// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/name.h"

GtkWidget *view_drawing(void)
{
    return g_object_new(GTK_TYPE_DRAWING_AREA, "accessible-role", GTK_ACCESSIBLE_ROLE_IMG, NULL);
}

void view_name(GtkWidget *widget, const char *name)
{
    gtk_accessible_update_property(GTK_ACCESSIBLE(widget), GTK_ACCESSIBLE_PROPERTY_LABEL, name, -1);
}

void view_name_choice(GtkWidget *down, const char *name)
{
    view_name(down, name);
    view_name(gtk_widget_get_first_child(down), name);
}
