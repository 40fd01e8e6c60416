// A report for people: one HTML file that needs neither network nor other files. It is built as a JSON tree, which the
// page (html/report.html, .css, .js) shows; see docs/comparing.md. Text is never interpreted as HTML.
#ifndef OCTALUX_CLI_HTML_REPORT_H
#define OCTALUX_CLI_HTML_REPORT_H

#include <octalux/render.h>

#include <cjson/cJSON.h>

// The command line as a shell takes it, "octalux compare 'a b.exr' ..."; to be freed. argv[0] is the command's name, or
// that of a program of its own.
char *command_text(int argc, char **argv);

// A report made by `command`, and sections in it: a heading, what there is to know, and the command that made what the
// section holds; both may be NULL.
cJSON *html_report_begin(const char *title, const char *command);
cJSON *html_report_section(cJSON *report, const char *heading, const char *note, const char *command);

// A table: give it columns, then rows of as many cells, by cJSON_AddItemToArray. Numbers are those of --json;
// null is a number that is not finite.
cJSON *html_report_table(cJSON *section, const char *caption);
void html_report_column(cJSON *table, const char *name, const char *note);
cJSON *html_report_row(cJSON *table);

// An <svg> (plot.h), which is freed.
void html_report_plot(cJSON *section, const char *caption, char *svg);

// A frame holds pictures of one size that are laid over each other, and is one of a section's tabs. A picture keeps its
// range of light, multiplied by `exposure`, in half floats of 7 bits of mantissa. Maps are FLIP of every pixel
// (olx_compare_perceptual), and the squared error over the mean square of the reference, whose mean is the relative
// MSE. The pictures of the first two names are those that the divider parts; any number of pictures and maps may
// follow.
cJSON *html_report_frame(cJSON *section, const char *name, const olx_image *image);
olx_result html_report_picture(cJSON *frame, const char *name, const olx_image *image, olx_layer layer, float exposure);
olx_result html_report_flip(cJSON *frame, const char *name, const float *flip_map);
olx_result html_report_squares(cJSON *frame, const char *name, const olx_image *image, const olx_image *reference,
                               olx_layer layer);
// Declares the last `count` maps to belong to the picture of that name: they are shown while it is left of the divider.
void html_report_maps_of(cJSON *frame, int count, const char *picture);
// A number that is shown beside the frame's pictures.
void html_report_fact(cJSON *frame, const char *name, double value);

// Write the file and release the report. EXIT_DONE, or EXIT_FAILED after a line that says why.
int html_report_write(const char *command, cJSON *report, const char *path);

// What the parts above are made of: a new object at the end of the array `key` of `parent`, and bytes as base64.
cJSON *html_report_append(cJSON *parent, const char *key);
cJSON *html_report_bytes(const uint8_t *bytes, size_t size_bytes);

#endif
