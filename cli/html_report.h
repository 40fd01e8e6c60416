// A self-contained HTML report: one file that needs neither a network nor other files. It is built as a JSON tree,
// which the page (html/report.html, .css, .js) displays; see docs/comparing.md. Text is never interpreted as HTML.
#ifndef OCTALUX_CLI_HTML_REPORT_H
#define OCTALUX_CLI_HTML_REPORT_H

#include <octalux/render.h>

#include <cjson/cJSON.h>

// Formats the command line for a shell, such as "octalux compare 'a b.exr' ..."; the caller frees it. argv[0] is the
// command's name, or that of a separate program.
char *command_text(int argc, char **argv);

// Begin a report made by `command`, and a section in it: a heading, an explanation, and the command that produced the
// section's content; the last two may be NULL.
cJSON *html_report_begin(const char *title, const char *command);
cJSON *html_report_section(cJSON *report, const char *heading, const char *note, const char *command);

// Adds a table. Append columns, then rows of as many cells, by cJSON_AddItemToArray. Numbers are those of --json; null
// is a number that is not finite.
cJSON *html_report_table(cJSON *section, const char *caption);
void html_report_column(cJSON *table, const char *name, const char *note);
cJSON *html_report_row(cJSON *table);

// Adds an <svg> (plot.h), and frees it.
void html_report_plot(cJSON *section, const char *caption, char *svg);

// Adds a frame of images of one size that are laid over each other, as one of a section's tabs. An image keeps its
// range of light, multiplied by `exposure`, in half floats with 7 bits of mantissa. Maps are per-pixel FLIP
// (olx_compare_perceptual), and the squared error over the mean square of the reference, whose mean is the relative
// MSE. The divider separates the images of the first two names; any number of images and maps may follow.
cJSON *html_report_frame(cJSON *section, const char *name, const olx_image *image);
olx_result html_report_picture(cJSON *frame, const char *name, const olx_image *image, olx_layer layer, float exposure);
olx_result html_report_flip(cJSON *frame, const char *name, const float *flip_map);
olx_result html_report_squares(cJSON *frame, const char *name, const olx_image *image, const olx_image *reference,
                               olx_layer layer);
// Assigns the last `count` maps to the image of that name: they are shown while it is left of the divider.
void html_report_maps_of(cJSON *frame, int count, const char *picture);
// Adds a number that is shown beside the frame's images.
void html_report_fact(cJSON *frame, const char *name, double value);

// Writes the file and releases the report. Returns EXIT_DONE, or EXIT_FAILED after a line with the reason.
int html_report_write(const char *command, cJSON *report, const char *path);

// Building blocks of reports: append a new object to the array `key` of `parent`, and encode bytes as Base64.
cJSON *html_report_append(cJSON *parent, const char *key);
cJSON *html_report_bytes(const uint8_t *bytes, size_t size_bytes);

#endif
