// SPDX-License-Identifier: BSD-3-Clause
// A window from which the file that its argument names can be dragged. It says when it is there, and when a drag begins.
#include <stdio.h>

#include <gtk/gtk.h>

static void on_begin(GtkDragSource *source, GdkDrag *drag, gpointer data)
{
    (void)source;
    (void)drag;
    (void)data;
    puts("drag");
    fflush(stdout);
}

static void on_map(GtkWidget *window, gpointer data)
{
    (void)window;
    (void)data;
    puts("window");
    fflush(stdout);
}

int main(int argc, char **argv)
{
    if (argc != 2 || !gtk_init_check())
        return 1;
    GtkWidget *window = gtk_window_new();
    GFile *file = g_file_new_for_path(argv[1]);
    GdkFileList *files = gdk_file_list_new_from_array(&file, 1);
    GtkDragSource *source = gtk_drag_source_new();
    GdkContentProvider *content = gdk_content_provider_new_typed(GDK_TYPE_FILE_LIST, files);
    gtk_drag_source_set_content(source, content);
    g_signal_connect(source, "drag-begin", G_CALLBACK(on_begin), NULL);
    gtk_widget_add_controller(window, GTK_EVENT_CONTROLLER(source));
    gtk_window_set_title(GTK_WINDOW(window), "drag");
    g_signal_connect(window, "map", G_CALLBACK(on_map), NULL);
    gtk_window_set_default_size(GTK_WINDOW(window), 200, 200);
    gtk_window_present(GTK_WINDOW(window));
    for (;;)
        g_main_context_iteration(NULL, TRUE);
}
