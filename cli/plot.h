// Plots as SVG text, coloured by the style sheet of the page that contains them (html/report.css).
#ifndef OCTALUX_CLI_PLOT_H
#define OCTALUX_CLI_PLOT_H

#include <stdbool.h>
#include <stdint.h>

typedef struct plot_series {
  const char *name;
  const double *x, *y; // values that are not finite, or not above 0 on a logarithmic axis, leave a gap
  uint32_t count;
} plot_series;

typedef struct line_plot {
  const char *x_label, *y_label;
  bool log_x, log_y;
  bool markers; // draw a dot at every value
  const plot_series *series;
  uint32_t series_count;
} line_plot;

// Horizontal bars: one row per name, with one bar per series.
typedef struct bar_plot {
  const char *label; // quantity that the bars show
  const char *const *names;
  uint32_t name_count;
  const plot_series *series; // y holds name_count values; x is not used
  uint32_t series_count;
} bar_plot;

// Returns the text of an <svg>, which the caller frees; NULL when memory runs out.
char *plot_lines(const line_plot *plot);
char *plot_bars(const bar_plot *plot);

#endif
